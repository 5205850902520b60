from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.spatial import KDTree

import laticauda as lc
from laticauda.motion.gaits import Wave
from laticauda.robot import Robot
from laticauda.robot.parameters import adjust
from laticauda.studies.point_trials import swim_points
from laticauda.trials import feasibility

GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)


def with_actuators(robot: Robot, **changes: float | bool) -> Robot:
    joints = tuple(
        replace(joint, actuator=replace(joint.actuator, **changes)) for joint in robot.joints
    )
    return replace(robot, joints=joints)


@pytest.fixture(scope="module")
def trial() -> lc.Trial:
    return lc.swim("mamba-fin", GAIT, 8.0)


def test_the_figures_are_those_of_the_samples_after_the_first_cycle(trial: lc.Trial):
    assert trial.period is not None
    late = trial.time >= trial.period
    for name in ("angle", "rate", "torque"):
        values = getattr(trial, f"joint_{name}")
        assert getattr(trial, f"peak_joint_{name}") == np.abs(values[late]).max()
    actuator = trial.robot.joints[0].actuator
    duty = trial.joint_torque / actuator.stall_torque + trial.joint_rate / actuator.no_load_speed
    assert trial.utilization == pytest.approx(np.abs(duty[late]).max(), rel=1e-12)


def test_a_run_of_less_than_a_cycle_and_a_half_counts_as_a_whole():
    short = lc.swim("mamba", GAIT, 2.0)
    assert short.peak_joint_rate == np.abs(short.joint_rate).max()


def test_an_actuator_that_has_just_what_is_needed_can_and_a_little_less_cannot(trial: lc.Trial):
    late = trial.time >= (trial.period or 0.0)
    speed = trial.robot.joints[0].actuator.no_load_speed
    # On the torque-speed line |u| = u_stall (1 - rate/speed), along u.
    needed = np.abs(trial.joint_torque) / (
        1.0 - np.sign(trial.joint_torque) * trial.joint_rate / speed
    )
    for share, problems in ((1.001, 0), (0.999, 1)):
        robot = with_actuators(trial.robot, stall_torque=share * needed[late].max())
        found = feasibility.judge_feasibility(robot, trial, trial.period)
        assert len(found.problems) == problems
        assert (found.figures["utilization"] > 1.0) == bool(problems)


def test_the_sentence_names_the_joint_what_it_needs_and_what_it_has(trial: lc.Trial):
    weak = feasibility.judge_feasibility(
        with_actuators(trial.robot, stall_torque=0.5), trial, trial.period
    )
    (sentence,) = weak.problems
    assert (
        sentence.startswith("joint ")
        and " N m at " in sentence
        and "; its servo has 0." in sentence
    )
    slow = feasibility.judge_feasibility(
        with_actuators(trial.robot, stall_torque=500, no_load_speed=0.5), trial, trial.period
    )
    assert slow.figures["utilization"] > 1.0 and slow.problems[0].endswith(
        ("its servo does 28.6", "its servo has 0")
    )


def test_a_joint_that_the_water_turns_faster_than_its_motor_is_braked_and_not_beyond_it(
    trial: lc.Trial,
):
    fast = replace(trial, joint_rate=20.0 + 0.0 * trial.joint_rate)
    braked = replace(fast, joint_torque=-0.5 + 0.0 * trial.joint_torque)
    driven = replace(fast, joint_torque=0.1 + 0.0 * trial.joint_torque)
    robot = with_actuators(trial.robot, stall_torque=0.3, no_load_speed=15.0)
    assert not feasibility.judge_feasibility(robot, braked, trial.period).problems
    figures = feasibility.judge_feasibility(robot, braked, trial.period).figures
    assert figures["utilization"] < 1.0
    assert feasibility.judge_feasibility(robot, driven, trial.period).problems


@settings(max_examples=8, deadline=None)
@given(st.floats(0.2, 1.2), st.floats(1.0, 4.0))
def test_servos_never_give_more_than_they_have(amplitude: float, frequency: float):
    gait = lc.eel_like(amplitude=amplitude, frequency=frequency, phase_shift_deg=40)
    trial = lc.swim("mamba-fin", gait, 3.0, joints="servo")
    duty = feasibility.duty(
        [trial.chain], trial.joint_rate[..., np.newaxis], trial.joint_torque[..., np.newaxis]
    )
    assert np.abs(duty).max() <= 1.0 + feasibility.ROUNDING


@pytest.mark.parametrize("name", ["mamba-fin", "mamba-modules"])
def test_a_sweeps_row_says_what_the_trial_says(name: str):
    scenario = lc.build_scenario(name, GAIT, 6.0)
    table = np.radians([[20.0, 130.0], [60.0, 200.0], [170.0, 60.0]])
    found = swim_points(scenario, ("gait.amplitude", "gait.frequency"), table)
    for row, (amplitude, frequency) in enumerate(table):
        alone = lc.swim(
            replace(scenario, motion=replace(GAIT, amplitude=amplitude, frequency=frequency))
        )
        for figure in feasibility.NEEDS:
            # A row looks for links that cross in some postures only.
            rel = (
                0.02
                if feasibility.measure_overlap(alone.chain, alone.joint_angle)[0] > 1.0
                else 1e-6
            )
            assert found[figure][row] == pytest.approx(getattr(alone, figure), rel=rel), figure


def test_a_driven_fin_counts_in_rows_and_trials_alike():
    robot = lc.load_robot("mamba-fin")
    assert robot.caudal_fin is not None
    driven = replace(robot, caudal_fin=replace(robot.caudal_fin, joint=robot.joints[0]))
    gait = replace(GAIT, amplitude=0.1, fin=Wave(amplitude_deg=80, frequency_deg_s=130))
    scenario = lc.build_scenario(driven, gait, 6.0)
    trial = lc.swim(scenario)
    assert trial.feasibility.words.startswith("the fin's joint bends 80 of 90 deg")
    found = swim_points(scenario, ("gait.amplitude",), np.array([[0.1]]))
    assert found["utilization"][0] == pytest.approx(trial.utilization, rel=1e-6)


def test_the_twin_and_the_planar_model_say_the_same():
    gait = replace(GAIT, amplitude=radians(60))
    planar, spatial = (
        lc.swim("mamba-modules", gait, 6.0, model=model) for model in ("planar", "spatial")
    )
    assert spatial.peak_joint_angle == pytest.approx(planar.peak_joint_angle, rel=1e-3)
    assert spatial.utilization == pytest.approx(planar.utilization, rel=0.05)


def rectangles(robot: Robot, angle: np.ndarray) -> list[np.ndarray]:
    """Points in every link, close enough to find what overlaps by more than a few millimeters."""
    turned, joint, found = 0.0, np.zeros(2), list[np.ndarray]()
    for module, bend in zip(robot.modules, (0.0, *angle), strict=True):
        turned += bend
        along = np.array([np.cos(turned), np.sin(turned)])
        x, y = np.meshgrid(
            np.linspace(0, module.length, 40), np.linspace(-1, 1, 21) * module.section.half_width
        )
        found.append(joint + x[..., None] * along + y[..., None] * np.array([-along[1], along[0]]))
        joint = joint + module.length * along
    return [one.reshape(-1, 2) for one in found]


def nearest(some: np.ndarray, others: np.ndarray) -> float:
    """How far the nearest points of two sets are from each other."""
    return float(KDTree(others).query(some)[0].min())


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(-1.5, 1.5), min_size=8, max_size=8), st.floats(0.01, 0.08))
def test_links_overlap_where_points_of_theirs_do(angle: list[float], width: float):
    robot = lc.load_robot("mamba")
    section = replace(robot.modules[0].section, half_width=width)
    robot = replace(
        robot, modules=tuple(replace(module, section=section) for module in robot.modules)
    )
    share, i, j = feasibility.measure_overlap(robot, np.array([angle]))
    points = rectangles(robot, np.array(angle))
    far = [(a, b) for a in range(9) for b in range(a + 2, 9)]
    apart = min(nearest(points[a], points[b]) for a, b in far)
    if (
        apart < 1e-3 and share <= 1.0
    ):  # two of a grid's points that are that near lie in both, or at their edges
        assert share > 0.9
    if share > 1.1 and j > i + 1:
        assert apart < 0.012
    if apart > 0.012:
        assert share <= 1.0 or j == i + 1


def test_a_body_that_bites_its_tail_overlaps_and_a_straight_one_does_not():
    robot = lc.load_robot("mamba")
    straight, ring = np.zeros((1, 8)), np.full((1, 8), 2 * pi / 8)
    assert feasibility.measure_overlap(robot, straight)[0] < 1.0
    share, i, j = feasibility.measure_overlap(robot, np.concatenate((straight, ring, -ring)))
    assert share > 1.0 and (i, j) == (0, 8)
    assert feasibility.measure_overlap(robot, ring) == feasibility.measure_overlap(robot, -ring)


def test_neighbors_overlap_where_their_bend_leaves_them_no_room():
    robot = lc.load_robot("mamba")
    fold = 2 * np.arctan(0.09 / 0.05)  # half a link over half its width
    for bend, beyond in ((fold - 1e-3, False), (fold + 1e-3, True)):
        share, *pair = feasibility.measure_overlap(robot, np.array([[0, 0, bend, 0, 0, 0, 0, 0]]))
        assert (share > 1.0) == beyond
        assert not beyond or pair == [2, 3]


def test_a_trial_without_torques_says_what_it_knows(trial: lc.Trial):
    series = {
        name: getattr(trial, name)
        for name in ("time", "center_of_mass", "center_of_mass_velocity", "joint_angle")
    }
    measured = lc.Trial.measured(series, scenario=trial.scenario, version="1")
    assert measured.peak_joint_angle == trial.peak_joint_angle
    assert {"peak_joint_torque", "utilization"} <= measured.figures()[1].keys()
    words = measured.feasibility.words
    assert words.endswith(" deg, no joint rate was measured, no joint torque was measured")
    assert "needs" not in words and "turns" not in words
    assert feasibility.describe_ability(measured.chain, measured.feasibility) == words


def test_links_that_cross_are_looked_for_in_every_posture_where_there_are_no_more_than_may_be_looked_at():
    robot, ring = lc.load_robot("mamba"), np.full(8, 2 * pi / 8)
    angle = np.stack([0.8 * ring, ring, 0.8 * ring, 0.8 * ring])
    still, counts = np.zeros((4, 8, 1)), np.full((4, 1), True)
    found = feasibility.compute_peaks([robot], angle[..., np.newaxis], still, still, counts, most=4)
    assert found["utilization"][0] == feasibility.measure_overlap(robot, angle)[0] > 1.0


def test_a_motor_whose_numbers_are_not_stated_judges_nothing_and_stated_ones_do(trial: lc.Trial):
    unknown = with_actuators(trial.robot, stated=False, stall_torque=0.01, no_load_speed=0.01)
    found = feasibility.judge_feasibility(unknown, trial, trial.period)
    assert found.problems == ()
    assert found.words.endswith("no actuator is stated")
    assert found.figures["utilization"] == pytest.approx(
        trial.peak_joint_angle / trial.robot.joints[0].limit
    )
    assert feasibility.judge_feasibility(
        adjust(unknown, {"actuator": {"voltage": 7.0}}), trial, trial.period
    ).problems
    assert not any(
        joint.actuator.stated
        for name in ("amphibot", "chain")
        for joint in lc.load_robot(name).joints
    )
