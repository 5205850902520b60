"""Columns in, columns out: `swim_many` without an object per trial, and what sweeps and optimizations take from it."""

import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.control import HeadingController, LineOfSight, PathFollowing, StraightLine
from laticauda.models.simulate import change_parameters, joint_peaks, run_batch, runs_of, silent
from laticauda.models.simulate.many import COLUMNS_AT_ONCE
from laticauda.models.simulate.table_run import run_columns
from laticauda.motion.joints import JointLaw
from laticauda.studies.point_trials import swim_points
from laticauda.trials.feasibility import NEEDS
from laticauda.values import quantity, value_class
from laticauda.water.fluid.uniform import LinearShear

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
SHORT = lc.build_scenario("mamba", GAIT, 5.0)
WAVES = {
    "gait.amplitude": (0.1, 1.3),
    "gait.frequency": (0.0, 6.0),
    "gait.phase_shift": (-1.0, 1.5),
    "gait.offset": (-0.3, 0.3),
}


def random_columns(n, **choices):
    rng = np.random.default_rng(n)
    columns = {name: rng.uniform(*ends, n) for name, ends in WAVES.items()}
    for name, values in choices.items():
        columns[name.replace("__", ".")] = rng.choice(values, n)
    return columns


def scenarios_of(scenario, columns):
    rows = zip(*columns.values(), strict=True)
    return [change_parameters(scenario, dict(zip(columns, row, strict=True))) for row in rows]


def one_by_one(scenarios):
    """Return figures and peaks as they are computed with an object per trial."""
    runs = runs_of(scenarios)
    peaks = {name: np.full(len(runs), np.nan) for name in NEEDS}

    def keep(block_runs, block):
        for name, values in joint_peaks(block_runs, block).items():
            peaks[name][block.index] = values

    first = scenarios[0]
    batch = run_batch(
        runs,
        first.duration,
        first.sample_interval,
        threads=1,
        progress=silent,
        observe=keep,
        with_joints=True,
    )
    return batch, peaks


@pytest.mark.parametrize(
    ("scenario", "choices"),
    [
        (SHORT, {}),
        (replace(SHORT, duration=16.0), {"water__normal_drag": [1.0, 1.5]}),
        (lc.build_scenario("mamba-fin", GAIT, 12.0), {"water__current_x": [0.0, 0.05]}),
        (lc.build_scenario("mamba", GAIT, 4.0, joints="servo"), {"robot__n_links": [6.0, 8.0]}),
        (lc.build_scenario("mamba", GAIT, 4.0, environment=lc.load_ground("viscous")), {}),
    ],
    ids=["waves", "drag", "fin in a current", "links", "ground"],
)
def test_columns_have_the_bits_of_trials_that_are_objects(scenario, choices):
    columns = random_columns(19, **choices)
    batch, peaks, _ = run_columns(scenario, columns, threads=2, with_peaks=True)
    alone, peaks_alone = one_by_one(scenarios_of(scenario, columns))
    assert (batch.succeeded.tolist(), batch.status) == (alone.succeeded.tolist(), alone.status)
    for name, values in alone.figures.items():
        np.testing.assert_array_equal(batch.figures[name], values, name)
    for name, values in peaks_alone.items():
        well = alone.succeeded
        np.testing.assert_array_equal(peaks[name][well], values[well], name)


@pytest.mark.filterwarnings("ignore::laticauda.values.ImplausibleWarning")
def test_scenarios_in_any_mixture_have_the_bits_of_runs_that_are_objects():
    eel = lc.eel_like(amplitude=0.4, frequency=2.5, phase_shift=0.6)
    fin = lc.build_scenario("mamba-fin", GAIT, 5.0)
    turned = replace(
        SHORT,
        start=lc.Start(heading=1.0),
        motion=replace(GAIT, phases=(0.3,) * 8),
    )
    scenarios = [
        *scenarios_of(SHORT, random_columns(9, water__normal_drag=[1.0, 1.5])),
        *scenarios_of(SHORT, random_columns(5)),
        *scenarios_of(replace(SHORT, motion=eel), random_columns(5)),
        *scenarios_of(fin, random_columns(5)),
        *scenarios_of(turned, random_columns(5)),
    ]
    mixed = [scenarios[i] for i in np.random.default_rng(1).permutation(len(scenarios))]
    swims = lc.swim_many(mixed, feasibility=True)
    alone, peaks = one_by_one(mixed)
    assert swims.status == alone.status
    for name in ("heading", "mean_power", "steady_velocity", "forward_velocity"):
        np.testing.assert_array_equal(getattr(swims, name), alone.figures[name])
    np.testing.assert_array_equal(
        swims.utilization, np.where(alone.succeeded, peaks["utilization"], np.nan)
    )


def test_a_flow_and_dry_friction_go_the_longer_way_to_the_same_bits():
    water = replace(lc.load_water("paper-lateral"), current=LinearShear(speed=0.1))
    robot = lc.load_robot("mamba")
    rough = replace(robot.joints[0].actuator, friction_torque=0.1)
    stiff = replace(robot, joints=tuple(replace(joint, actuator=rough) for joint in robot.joints))
    for scenario in (replace(SHORT, environment=water), replace(SHORT, robot=stiff)):
        columns = random_columns(9)
        batch, peaks, _ = run_columns(scenario, columns, threads=1, with_peaks=True)
        alone, peaks_alone = one_by_one(scenarios_of(scenario, columns))
        np.testing.assert_array_equal(batch.figures["x"], alone.figures["x"])
        np.testing.assert_array_equal(peaks["utilization"], peaks_alone["utilization"])


@pytest.mark.filterwarnings("ignore::laticauda.values.ImplausibleWarning")
def test_trials_that_diverge_say_when_and_leave_no_figures():
    wild = lc.build_scenario("mamba", GAIT, 6.0, joints="pd", dt=0.05)
    columns = {"gait.frequency": [2.0, 60.0, 3.0], "gait.amplitude": [0.3, 1.4, 0.3]}
    swims = lc.swim_many(wild, columns=columns, feasibility=True)
    trials = [lc.swim(scenario) for scenario in scenarios_of(wild, columns)]
    assert swims.succeeded.tolist() == [True, False, True]
    assert swims.status == tuple(trial.status for trial in trials)
    assert np.isnan([swims.forward_velocity[1], swims.heading[1], swims.utilization[1]]).all()
    np.testing.assert_allclose(swims.heading[::2], [trial.heading[-1] for trial in trials[::2]])


@pytest.mark.filterwarnings("ignore::laticauda.values.ImplausibleWarning")
def test_swim_many_with_columns_is_swim_many_with_scenarios(monkeypatch):
    columns = random_columns(21, water__normal_drag=[1.0, 1.5])
    monkeypatch.setattr("laticauda.models.simulate.many.COLUMNS_AT_ONCE", 8)
    shares: list[float] = []
    swims = lc.swim_many(SHORT, columns=columns, feasibility=True, progress=shares.append)
    same = lc.swim_many(scenarios_of(SHORT, columns), feasibility=True)
    for name, values in vars(same).items():
        np.testing.assert_array_equal(getattr(swims, name), values, name)
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)
    assert COLUMNS_AT_ONCE > 8


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({}, "`columns` must hold at least one parameter, got none"),
        ({"gait.amplitud": [0.1]}, r"`columns` must name numbers of .*`gait.amplitude`"),
        (
            {"gait.amplitude": [0.1], "gait.offset": [0.1, 0.2]},
            "`columns` must be flat lists of equal length",
        ),
        ({"gait.amplitude": [[0.1, 0.2]]}, "`columns` must be flat lists of equal length"),
        (
            {"gait.amplitude": [0.1, "b"]},
            "`columns` must hold a list of numbers for every name, got .* for `gait.amplitude`",
        ),
        (
            {"gait.amplitude": [0.1, -0.2]},
            "`amplitude` must be between 0 and 3.14159 rad, got -0.2",
        ),
        ({"water.normal_drag": [1.0, math.nan]}, "`normal_drag` must be a finite number"),
        ({"robot.n_links": [8.5]}, "`robot.n_links` must be a whole number, got 8.5"),
    ],
)
def test_columns_that_cannot_be_swum_are_named(columns, message):
    with pytest.raises(ValueError, match=message):
        lc.swim_many(SHORT, columns=columns)


def test_a_scenario_alone_needs_columns():
    with pytest.raises(
        ValueError, match="must be a list of scenarios, or a scenario with `columns`"
    ):
        lc.swim_many(SHORT)


def test_columns_need_a_scenario_alone():
    columns = {"gait.amplitude": [0.1]}
    with pytest.raises(ValueError, match="`robots` must be of class Scenario, got"):
        lc.swim_many("mamba", columns=columns)
    with pytest.raises(ValueError, match="`columns` must be given with a scenario alone"):
        lc.swim_many(SHORT, GAIT, columns=columns)
    with pytest.raises(ValueError, match=r"`robots\.model` must be of class Planar, got Spatial"):
        lc.swim_many(replace(SHORT, model=lc.Spatial()), columns=columns)


def test_numbers_of_a_controller_are_columns_too_and_its_gait_stays_steered():
    follower = PathFollowing(
        gait=GAIT,
        path=StraightLine(point=(0.0, 0.5)),
        guidance=LineOfSight(look_ahead_distance=0.5),
        heading=HeadingController(gain=0.4, max_offset=0.2),
    )
    scenario = replace(SHORT, motion=follower)
    columns = {
        "controller.guidance.look_ahead_distance": np.array([0.3, 0.6]),
        "gait.amplitude": np.array([0.4, 0.5]),
    }
    swims = lc.swim_many(scenario, columns=columns)
    for i, distance in enumerate((0.3, 0.6)):
        changed = replace(
            follower,
            gait=replace(GAIT, amplitude=float(columns["gait.amplitude"][i])),
            guidance=LineOfSight(look_ahead_distance=distance),
        )
        trial = lc.swim(replace(scenario, motion=changed))
        np.testing.assert_allclose(swims.center_of_mass[i], trial.center_of_mass[-1], atol=1e-12)


@pytest.fixture
def spring_law():
    """A law of one's own, known by its name during one test: a spring to the reference, and a damper to its rate."""

    @value_class
    class SweptSpring(JointLaw):
        stiffness: float = quantity("N m/rad", "k", gt=0.0, default=30.0)

        def __call__(self, angle, rate, reference, reference_rate, reference_acceleration, drive):
            torque = self.stiffness * (reference - angle) + 3.0 * (reference_rate - rate)
            return torque, self.stiffness, 3.0

    yield SweptSpring
    del JointLaw._members["swept-spring"]


def test_a_sweep_changes_the_numbers_of_a_joint_law(spring_law):
    scenario = lc.build_scenario("mamba", GAIT, 3.0, joints=spring_law(stiffness=25.0))
    table = np.array([[10.0], [60.0]])
    found = swim_points(scenario, ("joints.stiffness",), table)["mechanical_power"]
    stiff = lc.build_scenario("mamba", GAIT, 3.0, joints=spring_law(stiffness=60.0))
    assert found[1] == pytest.approx(lc.swim(stiff).mechanical_power, rel=1e-12)
    assert found[0] != found[1]
