"""A fin of finite span in the planar model: against an unsteady vortex lattice, and in all ways of running it."""

from dataclasses import replace

import campaign_scripts
import numpy as np
import pytest

import laticauda as lc
from laticauda.models.planar import rows
from laticauda.models.planar.model import PlanarPlant
from laticauda.models.simulate import compute_sensitivities
from laticauda.robot import (
    CaudalFin,
    Joint,
    Module,
    Robot,
    Section,
    fin_plate,
    load_robot,
    load_water,
    wake_mass,
)
from laticauda.water.fluid.edges import plate_functions

GAIT = lc.lateral_undulation(
    amplitude=np.deg2rad(30), frequency=np.deg2rad(130), phase_shift=np.deg2rad(40)
)
WATER = replace(
    load_water("paper-lateral"), added_mass_form="kirchhoff", trailing_edge="finite-span"
)
FINNED = load_robot("mamba-fin")
BROAD = replace(
    FINNED,
    name="broad",
    caudal_fin=CaudalFin(length=0.06, height=0.2, opening_length=0.0, added_mass=1.0),
)
LOW = replace(BROAD.modules[0], section=Section(half_height=0.009, half_width=0.009))
"""So low that the fin behind it is a free plate."""
DRIVEN = replace(BROAD, name="driven", caudal_fin=replace(BROAD.caudal_fin, joint=Joint()))


# ---- the lattice ---------------------------------------------------------------------------------


def test_the_loads_of_a_rigid_plate_are_those_of_the_unsteady_lattice_on_the_whole_map():
    points = campaign_scripts.campaign("edge_map").errors()
    thrust, side, moment = np.array([point[3:] for point in points]).T
    assert thrust.size == 252
    assert thrust.mean() <= 0.017
    assert thrust.max() <= 0.10
    assert side.mean() <= 0.013
    assert side.max() <= 0.06
    assert moment.mean() <= 0.010
    assert moment.max() <= 0.05


def test_loads_behind_another_plate_are_those_of_the_unsteady_lattice_within_what_the_page_says():
    points = campaign_scripts.campaign("edge_map").errors_of_shapes(behind=True)
    thrust, side, moment = np.array([point[3:] for point in points]).T
    assert thrust.size == 111
    assert thrust.mean() <= 0.05
    assert np.quantile(thrust, 0.9) <= 0.15
    assert side.mean() <= 0.10
    assert moment.mean() <= 0.13
    heave = np.array([point[3:] for point in points if point.motion == "heave"])
    assert heave[:, 0].max() <= 0.08
    assert heave[:, 1].max() <= 0.07


def test_loads_of_swept_tapered_and_forked_plates_are_those_of_the_unsteady_lattice():
    points = campaign_scripts.campaign("edge_map").errors_of_shapes(behind=False)
    thrust, side, moment = np.array([point[3:] for point in points]).T
    assert thrust.size == 60
    assert thrust.mean() <= 0.04
    assert thrust.max() <= 0.13
    assert side.mean() <= 0.025
    assert side.max() <= 0.07
    assert moment.mean() <= 0.025
    assert moment.max() <= 0.07


# ---- slender and bodies --------------------------------------------------------------------------


def test_a_body_that_ends_in_an_edge_keeps_lighthills_law_to_the_last_bit():
    robot = load_robot("amphibot")
    finite = lc.swim(robot, GAIT, duration=5.0, environment=WATER)
    elongated = lc.swim(
        robot, GAIT, duration=5.0, environment=replace(WATER, trailing_edge="elongated")
    )
    assert np.array_equal(finite.center_of_mass, elongated.center_of_mass)


def test_a_long_thin_fin_swims_as_with_lighthills_law():
    thin = replace(
        FINNED, caudal_fin=replace(FINNED.caudal_fin, height=0.01, thickness=1e-3, added_mass=10.0)
    )
    paths = [
        lc.swim(
            thin, GAIT, duration=5.0, environment=replace(WATER, trailing_edge=edge)
        ).center_of_mass
        for edge in ("finite-span", "elongated")
    ]
    assert np.abs(paths[0] - paths[1]).max() < 2e-3 * np.abs(paths[1]).max()


def test_the_strips_of_a_fin_have_the_mass_and_the_inertia_of_the_plate():
    free = replaced_fin(length=0.07, opening_length=0.01)
    strips = lc.models.planar.PlanarPlant(robot=free, environment=WATER).coefficients.fin
    slender = wake_mass(free, WATER) * 0.06
    arm = strips.position + 0.04
    assert strips.mu_n.sum() == pytest.approx(0.2543 * slender, rel=2e-3)  # h/c = 3.33
    inertia = strips.lambda_1.sum() + strips.mu_n @ (arm * arm)
    assert inertia == pytest.approx(0.10636 * slender * 0.06**2 / 12.0, rel=5e-3)


def test_what_adjoins_a_fin_ahead_decides_on_its_leading_edge():
    alone = fin_plate(replaced_fin(length=0.07, opening_length=0.01))
    behind = fin_plate(BROAD)  # a body of 0.11 m ahead of a fin of 0.2 m
    assert behind.mass > 1.5 * alone.mass
    assert behind.lift > alone.lift + 0.15
    assert behind.lift_center < 0.0
    assert fin_plate(DRIVEN).lift == pytest.approx(alone.lift)
    assert fin_plate(replace(BROAD, modules=(LOW, *BROAD.modules[1:]))).lift == pytest.approx(
        alone.lift
    )
    high = replaced_fin(height=0.05)
    assert fin_plate(high).lift == pytest.approx(1.0, abs=0.01)  # as high as what is ahead
    assert fin_plate(FINNED).lift == plate_functions(0.09 / 0.38).lift


def test_a_fin_that_bends_is_refused_with_the_laws_that_hold_for_it():
    soft = replace(FINNED.caudal_fin, n_hinges=2, flexural_rigidity=2.0)
    with pytest.raises(
        ValueError,
        match=r"`trailing_edge` must be `elongated` or `none` for a fin that bends "
        r"\(`caudal_fin.n_hinges` is 2\), because the law of a finite span is that of a rigid plate",
    ):
        lc.swim(replace(FINNED, caudal_fin=soft), GAIT, environment=WATER)


def test_a_stout_body_without_a_fin_is_refused():
    stout = Robot(
        name="stout",
        modules=(Module(length=0.1, mass=1.0, section=Section(half_height=0.1, half_width=0.1)),),
    )
    with pytest.raises(
        ValueError, match=r"for a body without a fin that is not slender \(its height is 2 times"
    ):
        PlanarPlant(robot=stout, environment=WATER)


def test_a_finite_span_requires_the_form_that_conserves_momentum():
    with pytest.raises(ValueError, match=r"unless `added_mass_form` is `kirchhoff`.*'finite-span'"):
        replace(WATER, added_mass_form="relative")


# ---- silhouettes ---------------------------------------------------------------------------------

RECTANGLE = ((0.0, 0.0), (0.0, 0.1), (0.06, 0.1), (0.06, 0.0))
FORKED = ((0.0, 0.0), (0.0, 0.02), (0.04, 0.1), (0.06, 0.1), (0.03, 0.0))


def shaped(corners, **changes):
    return replace(BROAD, caudal_fin=replace(BROAD.caudal_fin, silhouette=corners, **changes))


def test_a_silhouette_that_is_a_rectangle_has_the_numbers_of_the_table():
    free, shaped_and_free = (
        replace(robot, modules=(LOW, *robot.modules[1:])) for robot in (BROAD, shaped(RECTANGLE))
    )
    by_lattice = PlanarPlant(robot=shaped_and_free, environment=WATER).layout.template
    by_table = PlanarPlant(robot=free, environment=WATER).layout.template
    edge = slice(rows.EDGE, rows.EDGE_LAG + 1)
    assert by_lattice[edge] == pytest.approx(by_table[edge], rel=0.01)
    body = rows.HEADER_ROWS
    for row in (rows.INERTIA, rows.COUPLING, rows.MASS_N):
        assert by_lattice[body + row] == pytest.approx(by_table[body + row], rel=0.01)


def test_a_forked_fin_has_less_area_and_less_added_mass_and_swims():
    forked = shaped(FORKED)
    assert forked.caudal_fin.area == pytest.approx(2.0 * 0.0029)
    rectangular = PlanarPlant(robot=BROAD, environment=WATER).coefficients.fin
    strips = PlanarPlant(robot=forked, environment=WATER).coefficients.fin
    # That of a broad plate goes with the square of its chord, but that next to the body does not.
    assert 0.3 < strips.mu_n.sum() / rectangular.mu_n.sum() < 0.6
    assert np.all(strips.mu_n >= 0.0)
    share = strips.c_n.sum() / rectangular.c_n.sum()
    assert share == pytest.approx(forked.caudal_fin.area / BROAD.caudal_fin.area, rel=0.02)
    trial = lc.swim(forked, GAIT, duration=5.0, environment=WATER)
    assert trial.succeeded
    assert trial.forward_velocity > 0.01


def test_a_silhouette_is_read_from_the_robots_file(tmp_path):
    path = tmp_path / "forked.toml"
    path.write_text(lc.robot.to_toml(shaped(FORKED)), encoding="utf-8")
    assert load_robot(path).caudal_fin.silhouette == FORKED


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"silhouette": ((0.0, 0.0), (0.1, 0.1), (0.06, 0.0))}, "must be at least three corners"),
        ({"silhouette": ((0.0, 0.0), (0.06, 0.0))}, "must be at least three corners"),
        (
            {"silhouette": FORKED, "opening_length": 0.01},
            "must be None for a fin with an opening or hinges",
        ),
    ],
)
def test_a_silhouette_that_is_no_area_of_the_fin_is_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        replace(BROAD.caudal_fin, **changes)


def test_a_silhouette_needs_the_law_that_knows_it():
    with pytest.raises(
        ValueError, match="must be `finite-span` or `none` for a fin with a `silhouette`"
    ):
        PlanarPlant(robot=shaped(FORKED), environment=replace(WATER, trailing_edge="elongated"))


# ---- ways of running -----------------------------------------------------------------------------

ROBOTS = {
    "rigid": (BROAD, GAIT),
    "driven": (DRIVEN, replace(GAIT, fin=lc.Wave(amplitude=0.4, frequency=2.5))),
}
JOINTS = ("prescribed", "pd", "servo")


@pytest.mark.parametrize("joints", JOINTS)
@pytest.mark.parametrize("robot", ROBOTS)
def test_a_run_that_is_resumed_is_the_same_to_the_last_bit(robot, joints):
    robot, gait = ROBOTS[robot]
    plant = lc.build_plant(robot, WATER, joints=joints)
    command = lc.Command(gait=gait)
    start = plant.init(lc.Start(velocity=0.1), command)
    whole = plant.march(start, command, 2.0, 0.5)
    half = plant.march(start, command, 1.0, 0.5)
    kept = plant.unpack(plant.pack(half.state))
    assert abs(kept.values[rows.EDGE_MEMORY - rows.TIME]) > 1e-3
    rest = plant.march(kept, command, 1.0, 0.5)
    assert np.array_equal(rest.state.values, whole.state.values)


@pytest.mark.parametrize("joints", JOINTS)
def test_a_batch_is_the_single_runs(joints):
    gaits = [replace(GAIT, amplitude=amplitude) for amplitude in (0.2, 0.35, 0.5)]
    swims = lc.swim_many(BROAD, gaits, duration=4.0, environments=WATER, joints=joints)
    for k, gait in enumerate(gaits):
        single = lc.swim(BROAD, gait, duration=4.0, environment=WATER, joints=joints)
        np.testing.assert_allclose(swims.center_of_mass[k], single.center_of_mass[-1], rtol=1e-12)


DERIVED = {
    "robot.caudal_fin.height": lambda step: (replaced_fin(height=0.2 + step), WATER),
    "robot.caudal_fin.length": lambda step: (replaced_fin(length=0.06 + step), WATER),
    "water.density": lambda step: (BROAD, replace(WATER, density=1000.0 * (1.0 + step))),
}


def replaced_fin(**changes):
    return replace(BROAD, caudal_fin=replace(BROAD.caudal_fin, **changes))


@pytest.mark.parametrize("joints", ["prescribed", "servo"])
def test_derivatives_are_those_of_differences(joints):
    found = compute_sensitivities(
        BROAD, GAIT, 10.0, names=list(DERIVED), environments=WATER, joints=joints
    )
    # Differences are those of a function with small steps, where a servo's limit moves into another step.
    tolerance = 3e-3 if joints == "servo" else 1e-3
    for name, change in DERIVED.items():
        step = 1e-5
        ends = []
        for sign in (1.0, -1.0):
            robot, water = change(sign * step)
            trial = lc.swim(
                robot, GAIT, 10.0, environment=water, joints=joints, dt=found_dt(joints)
            )
            ends.append(trial.forward_velocity)
        scale = 1000.0 if name == "water.density" else 1.0
        expected = (ends[0] - ends[1]) / (2.0 * step * scale)
        assert found.of("forward_velocity", name)[0] == pytest.approx(expected, rel=tolerance), name


def found_dt(joints):
    """The step of the run whose derivatives are taken: differences must not change it."""
    return lc.build_plant(BROAD, WATER, joints=joints).dt


def test_halving_the_step_changes_nothing_worth_mentioning():
    ends = []
    for joints, dt in (
        ("prescribed", 0.025),
        ("prescribed", 0.0125),
        ("servo", 0.002),
        ("servo", 0.001),
    ):
        trial = lc.swim(BROAD, GAIT, duration=10.0, environment=WATER, joints=joints, dt=dt)
        ends.append(trial.center_of_mass[-1])
    length = np.linalg.norm(ends[1])
    assert np.linalg.norm(ends[0] - ends[1]) < 1e-4 * length
    assert np.linalg.norm(ends[2] - ends[3]) < 1e-4 * np.linalg.norm(ends[3])


def test_a_state_that_an_older_version_stored_continues_with_an_edge_that_remembers_nothing():
    plant = lc.build_plant(BROAD, WATER)
    command = lc.Command(gait=GAIT)
    state = plant.init(lc.Start(velocity=0.1), command)
    older = np.delete(state.values, rows.EDGE_MEMORY - rows.TIME)
    assert np.array_equal(plant.unpack({"planar": older}).values, state.values)
