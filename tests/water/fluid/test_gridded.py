"""Flows on grids: interpolation of any order of axes, files and Datasets, what lies beyond, what is refused."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
import xarray
from flow_laws import Moving
from scipy.interpolate import RegularGridInterpolator

import laticauda as lc
from laticauda.connect.fmu import export_fmu
from laticauda.models.simulate import compute_sensitivities
from laticauda.robot import load_robot, load_water
from laticauda.values.codec import decode, encode
from laticauda.water.fluid.flow import Flow, FunctionFlow
from laticauda.water.fluid.gridded import Gridded, to_dataset

GAIT = lc.Gait(amplitude=0.5, frequency=2.2, phase_shift=0.7)
WATER = load_water("paper-lateral")
WAVY = FunctionFlow(
    function=lambda x, y, z, t: (
        np.sin(x + 0.3 * t) * np.cos(0.7 * y) * np.exp(z),
        np.cos(0.5 * x) * np.sin(y - t) * np.exp(2.0 * z),
        np.sin(x * y) * np.cos(t + z),
    )
)
RNG = np.random.default_rng(1)
POINTS = RNG.uniform((-1.0, -1.0, -1.0), (1.0, 1.0, 0.0), (40, 3))
TIMES = RNG.uniform(0.0, 2.0, 40)


def on(n):
    """The wavy flow on n nodes along every axis."""
    ends = {"time": (0.0, 2.0), "z": (-1.0, 0.0), "y": (-1.0, 1.0), "x": (-1.0, 1.0)}
    return to_dataset(WAVY, **{name: np.linspace(*end, n) for name, end in ends.items()})


def test_values_between_the_nodes_are_those_of_scipys_multilinear_interpolation():
    dataset = on(7)
    axes = [dataset[name].values for name in ("time", "z", "y", "x")]
    known = RegularGridInterpolator(
        axes, np.stack([dataset[name].values for name in "uvw"], axis=-1)
    )
    found = Gridded(source=dataset).velocity(POINTS, TIMES)
    assert found == pytest.approx(known(np.column_stack([TIMES, POINTS[:, ::-1]])), abs=1e-14)


def test_a_flow_written_to_a_grid_converges_with_the_square_of_the_steps_and_its_gradients_with_the_steps():
    known, errors = WAVY.motion(*POINTS.T, TIMES), []
    for n in (5, 9, 17):
        found = Gridded(source=on(n)).motion(*POINTS.T, TIMES)
        of = [np.square(a - b).mean() for a, b in zip(found, known, strict=True)]
        errors.append([np.sqrt(sum(of[:3])), np.sqrt(sum(of[3:15]))])
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders[:, 0] == pytest.approx(2.0, abs=0.2)
    assert orders[:, 1] == pytest.approx(1.0, abs=0.2)


def test_a_complex_step_goes_along_with_the_gradient_of_the_cell():
    flow, (x, y, z), t = Gridded(source=on(5)), POINTS[0], TIMES[0]
    motion = flow.motion(x, y, z, t)
    assert np.imag(flow.motion(x + 1e-30j, y, z, t)[:3]) / 1e-30 == pytest.approx(
        motion[6:15:3], rel=1e-12
    )
    assert np.imag(flow.motion(x, y, z, t + 1e-30j)[:3]) / 1e-30 == pytest.approx(
        motion[3:6], rel=1e-12
    )


def shear(**axes):
    """Water whose velocity is linear in place and time, which a grid holds exactly."""
    flow = FunctionFlow(
        function=lambda x, y, z, t: (0.05 + 0.02 * y + 0.001 * t, -0.03 + 0.01 * x + 0.02 * z, 0.0)
    )
    return Gridded(source=to_dataset(flow, **axes))


AXES = {
    "time": [0.0, 2.0, 4.0],
    "z": [-1.0, 0.0],
    "y": [-3.0, 0.0, 3.0],
    "x": [-3.0, -1.0, 1.0, 3.0],
}


SHEAR = Moving(
    v_x=0.05, v_y=-0.03, shear=0.02, swing=0.01, gain=0.001, veer=0.02
)  # the same by its formula


def swum(flow, duration=4.0, **settings):
    """A trial in it."""
    return lc.swim("mamba", GAIT, duration, environment=replace(WATER, current=flow), **settings)


def test_a_robot_swims_in_a_linear_flow_on_a_grid_as_in_its_formula_alone_and_side_by_side():
    flow, other = shear(**AXES), shear(**{**AXES, "x": [-3.0, 0.0, 3.0]})
    alone, known = swum(flow), swum(SHEAR)
    assert np.abs(alone.center_of_mass - known.center_of_mass).max() < 1e-12
    assert alone.status == "The run reached its end."
    ends = lc.swim_many(
        [replace(alone.scenario, environment=replace(WATER, current=one)) for one in (flow, other)]
    )
    assert np.array_equal(ends.center_of_mass[0], alone.center_of_mass[-1])
    assert ends.center_of_mass[1] == pytest.approx(ends.center_of_mass[0], abs=1e-12)


def test_the_plane_and_space_agree_in_it():
    """In water that turns about the vertical alone: the plane knows of no other rotation."""
    flow = Gridded(source=on(9).isel(z=4).drop_vars("w"), start=0.5, outside="hold")
    water = replace(
        WATER, current=flow, added_mass_form="kirchhoff", tangential_added_mass=0.1, depth=0.2
    )
    settings = {"dt": 0.01, "start": lc.Start(center_of_mass=(0.1, 0.1)), "environment": water}
    plane, space = (
        lc.swim("mamba", GAIT, 1.5, model=model, **settings) for model in ("planar", "spatial")
    )
    distance = np.linalg.norm(plane.center_of_mass[-1] - plane.center_of_mass[0])
    assert np.abs(plane.center_of_mass - space.center_of_mass[:, :2]).max() < 1e-3 * distance


def test_a_run_that_is_cut_in_the_middle_goes_on_with_the_same_bits():
    whole, first = swum(shear(**AXES)), swum(shear(**AXES), 2.0)
    second = lc.resume(lc.build_plant(whole.scenario), first, 2.0)
    assert np.array_equal(second.center_of_mass[-1], whole.center_of_mass[-1])


def test_a_plant_that_goes_to_another_process_reads_the_tables_there():
    body, begun = lc.build_plant(swum(shear(**AXES), 1.0).scenario), lc.Command(gait=GAIT)
    state = body.init(lc.Start(), begun)
    known = body.march(state, begun, 1.0, 0.1)[0]
    stored = pickle.dumps(body)
    del body
    assert np.array_equal(
        pickle.loads(stored).march(state, begun, 1.0, 0.1)[0].values, known.values
    )


def test_derivatives_go_through_the_tables():
    flow = shear(**{**AXES, "time": [0.0, 4.0]})
    settings = {
        "environments": replace(WATER, current=flow),
        "names": ["gait.amplitude", "gait.frequency"],
    }
    found = compute_sensitivities(load_robot("mamba"), GAIT, 4.0, **settings)
    settings["environments"] = replace(WATER, current=SHEAR)
    known = compute_sensitivities(load_robot("mamba"), GAIT, 4.0, **settings)
    np.testing.assert_allclose(found.jacobian, known.jacobian, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    ("duration", "options", "until"),
    [
        (4.0, {}, None),
        (5.0, {}, 4.0),
        (5.0, {"start": 1.0}, 3.0),
        (4.0, {"start": -1.0}, 0.0),
        (5.0, {"beyond": "hold"}, None),
    ],
)
def test_a_run_ends_where_the_times_of_a_grid_end_as_a_rule(duration, options, until):
    trial = swum(replace(shear(**AXES), **options), duration, sample_interval=0.1)
    assert trial.succeeded == (until is None)
    if until is not None:
        assert trial.time[-1] == pytest.approx(until, abs=0.11)
        assert "unless it left its water: a flow on a grid is known for time from" in trial.status


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_a_run_ends_where_a_robot_leaves_the_grid_as_a_rule(model):
    flow = shear(**{**AXES, "x": [-3.0, 0.1]})
    settings = {"model": model, "sample_interval": 0.1}
    gone = swum(flow, 3.0, **settings)
    assert not gone.succeeded
    assert "left its water" in gone.status
    assert gone.center_of_mass[-1, 0] < 0.1
    assert swum(replace(flow, outside="hold"), 3.0, **settings).succeeded


def test_beyond_the_grid_the_edge_is_held_or_there_is_nothing_or_the_grid_again():
    steps = np.arange(4.0)
    values = ("x", np.array([0.1, 0.2, 0.4, 0.3]))
    dataset = xarray.Dataset({"u": values, "v": values}, {"x": steps})
    x = np.array([-1.5, -0.5, 3.0, 3.5, 4.0, 5.5])
    for outside, known, slope in (
        ("hold", [0.1, 0.1, 0.3, 0.3, 0.3, 0.3], [0.0, 0.0, -0.1, 0.0, 0.0, 0.0]),
        ("refuse", [0.1, 0.1, 0.3, 0.3, 0.3, 0.3], [0.0, 0.0, -0.1, 0.0, 0.0, 0.0]),
        ("zero", [0.0, 0.0, 0.3, 0.0, 0.0, 0.0], [0.0, 0.0, -0.1, 0.0, 0.0, 0.0]),
        ("periodic", [0.35, 0.2, 0.3, 0.2, 0.1, 0.3], [-0.1, -0.2, -0.2, -0.2, 0.1, 0.2]),
    ):
        motion = Gridded(source=dataset, outside=outside).motion(x, 0.0, 0.0, 0.0)
        assert motion.u == pytest.approx(known)
        assert motion.u_x == pytest.approx(slope)
        assert (
            np.isnan(motion.u_t).tolist() == ((x < 0.0) | (x > 3.0)).tolist()
            if outside == "refuse"
            else True
        )


def test_a_grid_comes_from_a_file_by_its_path_from_the_file_that_names_it(tmp_path):
    on(3).to_netcdf(tmp_path / "lake.nc")
    (tmp_path / "swim.toml").write_text(
        'kind = "scenario"\nrobot = "mamba"\nduration = 2.0\n[gait]\namplitude_deg = 30\nfrequency_deg_s = 90\n'
        'phase_shift_deg = 40\n[water]\nextends = "paper-eel"\ncurrent = {kind = "gridded", source = "lake.nc"}\n'
    )
    scenario = lc.load_scenario(tmp_path / "swim.toml")
    flow = scenario.environment.current
    assert flow.source == str(tmp_path / "lake.nc")
    assert flow.grid == Gridded(source=on(3)).grid
    table = encode(flow, Flow)
    assert decode(Flow, table) == flow
    assert hash(flow) == hash(decode(Flow, table))
    assert pickle.loads(pickle.dumps(flow)) == flow
    (tmp_path / "lake.nc").unlink()
    on(4).to_netcdf(tmp_path / "lake.nc")
    with pytest.raises(ValueError, match=r"`digest` must match .*lake.nc"):
        decode(Flow, table).grid  # noqa: B018


def test_a_trial_over_a_dataset_in_memory_is_stored_without_it(tmp_path):
    trial = swum(shear(**AXES), 1.0)
    with pytest.warns(
        UserWarning, match=r"`environment.current.source` is a Dataset in memory, which cannot"
    ):
        trial.save(tmp_path / "trial.nc")
    assert np.array_equal(lc.load_trial(tmp_path / "trial.nc").center_of_mass, trial.center_of_mass)


def test_what_reads_no_tables_refuses_it_by_name(tmp_path):
    scenario = lc.build_scenario("mamba", GAIT, environment=replace(WATER, current=shear(**AXES)))
    with pytest.raises(ValueError, match="`current` must not be a gridded flow"):
        export_fmu(tmp_path / "x.fmu", scenario)


def test_names_units_levels_and_dates_of_the_conventions_are_understood():
    u = np.arange(24.0).reshape(2, 3, 4)
    dims = ("time", "depth", "lon_m")
    dataset = xarray.Dataset(
        {
            "water_u": (dims, u, {"standard_name": "sea_water_x_velocity", "units": "cm s-1"}),
            "vo": (dims, 0.0 * u, {"units": "m s-1"}),
        },
        {
            "time": np.array(["2020-01-01", "2020-01-01T00:01"], dtype="datetime64[ns]"),
            "depth": [0.0, 1.0, 2.0],
            "lon_m": (
                "lon_m",
                [0.0, 1.0, 2.0, 3.0],
                {"standard_name": "projection_x_coordinate", "units": "km"},
            ),
        },
    )
    flow = Gridded(source=dataset)
    assert [axis.nodes for axis in flow.grid.axes] == [2, 3, 1, 4]
    assert flow.velocity(np.array([1500.0, 7.0, -1.25]), 30.0) == pytest.approx(
        [0.01 * (1.5 + 5.0 + 6.0), 0.0, 0.0]
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d.drop_vars("v"), "`source` must have variables `u` and `v`, .* got `u`, `w`"),
        (
            lambda d: d.where(d.x > -0.5),
            "`u` must be a number at all 81 nodes, got 27 gaps.* x = -1",
        ),
        (
            lambda d: d.assign_coords(x=("x", [0.0, 1.0, 2.0], {"units": "degrees_east"})),
            "`x` must be in .*degrees",
        ),
        (
            lambda d: d.assign_coords(x=[0.0, 2.0, 1.0]),
            "`x` must ascend or descend in equal steps, got steps from -1",
        ),
        (
            lambda d: d.assign_coords(x=[0.0, 1.0, 2.0 + 2**0.5]),
            "`x` must ascend .* from 1 to 2.4.*interp",
        ),
        (
            lambda d: d.expand_dims(member=2),
            "`u` must depend only on time, z .* got the dimension `member`",
        ),
        (lambda d: 3, "`source` must be"),
    ],
)
def test_what_is_no_flow_is_refused_by_name(change, message):
    with pytest.raises(ValueError, match=message):
        Gridded(source=change(on(3)))


def test_a_file_that_is_not_there_or_is_no_netcdf_is_refused(tmp_path):
    (tmp_path / "bad.nc").write_text("bad")
    for given, message in (
        ({"source": "no.nc"}, "No such file"),
        ({"source": str(tmp_path / "bad.nc")}, "NetCDF: Unknown file format"),
    ):
        with pytest.raises(ValueError, match=f"`source` must be .*{message}"):
            Gridded(**given)
