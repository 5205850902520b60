import math
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

import laticauda as lc
from laticauda.estimation import Estimate, JointSample, KinematicEstimator, PoseSample, ReferenceSample
from laticauda.kinematics import turn
from laticauda.operate import Event, Header, OperationLog, spoken, verdict_of
from laticauda.operate.settings import Acceptance
from laticauda.planar.model import PlanarPlant
from laticauda.scenarios import Experiment

ROBOT, WATER = lc.load_robot("mamba"), lc.load_water("paper-lateral")
GAIT = lc.lateral_undulation(amplitude=math.radians(30), frequency=math.radians(120), phase_shift=math.radians(40))
PLANT = lc.plant(ROBOT, WATER, joints="servo")
CYCLES = 8
STEP = 0.02  # s
BEFORE = 3.0  # s


@pytest.fixture(scope="module")
def truth():
    """A run of whole cycles, as it is sampled."""
    return lc.run(PLANT, lc.OpenLoop(command=lc.Command(gait=GAIT)), CYCLES * 3.0 + STEP, sample_interval=STEP)


def log_of(truth, *, angle=None, yaw=0.0, moved=0.0, clock=0.0, unset=0, still=0.0) -> OperationLog:
    """The recording of a perfect operation of that run.

    Args:
        truth: The run.
        angle: Other joint angles than the true ones.
        yaw: By which the marker body is turned, over the samples.
        moved: By which the water takes the robot to the left, over the samples.
        clock: By which the cameras' clock goes away until the end.
        unset: Modules without a zero.
        still: Speed of the robot before the run.
    """
    n = len(truth.time)
    yaw, moved = np.broadcast_to(yaw, n), np.broadcast_to(moved, n)
    angle = truth.joint_angle if angle is None else angle
    entries: list[object] = [Event(time=1.0, kind="calibrating", message="", data={"without_zero": unset})]

    def estimate(time, k, shift):
        return Estimate(
            time=time,
            status="tracking",
            age=0.0,
            center_of_mass=truth.center_of_mass[k] + np.array(shift),
            center_of_mass_velocity=np.zeros(2),
            heading=float(truth.heading[k] + yaw[k]),
            heading_rate=0.0,
            link_angle=truth.link_angle[k] + yaw[k],
            joint_angle=truth.joint_angle[k],
            joint_rate=truth.joint_rate[k],
        )

    for k in range(100):
        entries.append(estimate(BEFORE - 2.0 + 0.02 * k, 0, (0.0, still * 0.02 * (k - 99))))
    entries.append(Event(time=BEFORE, kind="start", message="", data={"clock": 0.5}))
    for k in range(n):
        time = BEFORE + float(truth.time[k])
        entries.append(ReferenceSample(time=time, angle=truth.joint_angle_ref[k], frequency=GAIT.frequency))
        entries.append(JointSample(time=time, angle=angle[k], rate=truth.joint_rate[k]))
        place = np.array([*truth.center_of_mass[k], 0.0])
        entries.append(PoseSample(time=time, position=place, rotation=turn("yaw", truth.link_angle[k, 0] + yaw[k])))
        entries.append(estimate(time, k, (0.0, moved[k])))
    last = BEFORE + float(truth.time[-1])
    entries.append(Event(time=last, kind="stop", message="", data={"succeeded": True, "clock": 0.5 + clock}))
    header = Header(
        run=Experiment(robot=ROBOT, environment=WATER, gait=GAIT), estimator=KinematicEstimator(robot=ROBOT)
    )
    return OperationLog(path=Path("run.mcap"), header=header, version="", notes={}, entries=tuple(entries), lost="")


def judged(log, plant=PLANT, **limits):
    return {one.name: one for one in verdict_of(log, Acceptance(**limits), plant).checks}


def test_a_perfect_run_passes_every_check_with_hardly_any_of_its_limits_used(truth):
    verdict = verdict_of(log_of(truth), Acceptance(), PLANT)
    assert verdict.reason == ""
    assert [one.word for one in verdict.checks] == ["ok"] * len(fields(Acceptance))
    assert max(one.share for one in verdict.checks) < 0.5
    summary = verdict.summary()
    assert summary["accepted"]
    assert summary["lines"][0].startswith("ok          a joint off what its servo can follow: ")


def test_a_joint_that_stands_still_is_named_after_one_cycle_and_the_run_is_rejected(truth):
    angle = truth.joint_angle.copy()
    angle[len(angle) // 2 :, 3] = angle[len(angle) // 2, 3]
    verdict = verdict_of(log_of(truth, angle=angle), Acceptance(), PLANT)
    found = verdict.checks[0]
    assert (found.name, found.word) == ("joint_error", "WRONG")
    assert found.says.endswith("module 4")
    assert CYCLES * 1.5 < found.since <= CYCLES * 1.5 + 6.0
    assert verdict.reason.startswith("The run is not right: a joint off what its servo can follow: ")


def test_a_servo_that_follows_better_than_the_model_is_right(truth):
    assert judged(log_of(truth, angle=truth.joint_angle_ref))["joint_error"].share < 0.2


@pytest.mark.parametrize("share", [0.5, 1.5])
def test_the_limit_is_what_decides(truth, share):
    angle = truth.joint_angle.copy()
    angle[:, 2] += math.radians(2.0)
    found = judged(log_of(truth, angle=angle), joint_error=math.radians(2.0) / share)["joint_error"]
    assert found.word == ("ok" if share < 1.0 else "WRONG")
    assert found.share == pytest.approx(share, rel=0.1)


def test_without_a_model_a_joint_may_lack_half_of_its_swing_and_no_more(truth):
    for swing, word in ((0.6, "ok"), (0.1, "WRONG")):
        found = judged(log_of(truth, angle=swing * truth.joint_angle_ref), plant=None)
        assert found["joint_error"].word == word
        assert found["swing_error"].word == found["turn_change"].word == "not checked"


def test_a_sensor_that_jumps_is_named_when_it_does(truth):
    angle = truth.joint_angle.copy()
    angle[500:, 5] += math.radians(4.0)
    found = judged(log_of(truth, angle=angle))["angle_jump"]
    assert found.word == "WRONG"
    assert found.says.endswith("module 6")
    assert found.since == pytest.approx(float(truth.time[500]), abs=1e-6)


def test_a_marker_body_that_turns_on_its_module_is_seen_at_once(truth):
    yaw = np.where(np.arange(len(truth.time)) < 600, 0.0, math.radians(5.0))
    found = judged(log_of(truth, yaw=yaw))["marker_jump"]
    assert found.value == pytest.approx(math.radians(5.0), abs=math.radians(0.5))
    assert 0.0 <= found.since - float(truth.time[600]) < 0.3


def test_water_that_begins_to_move_is_seen_as_sideslip(truth):
    moved = np.maximum(truth.time - 9.0, 0.0) * 0.03
    found = judged(log_of(truth, moved=moved))
    assert found["sideslip_change"].word == "WRONG"
    assert 9.0 < found["sideslip_change"].since <= 15.0
    assert found["joint_error"].word == found["swing_error"].word == "ok"


def test_a_marker_body_that_was_wrong_from_the_beginning_is_not_seen(truth):
    assert all(one.word == "ok" for one in judged(log_of(truth, yaw=0.05)).values())


@pytest.mark.parametrize(("drift", "word"), [(0.005, "ok"), (0.03, "WRONG"), (-0.03, "WRONG")])
def test_a_clock_that_goes_away_is_seen_at_the_end(truth, drift, word):
    assert judged(log_of(truth, clock=drift))["clock_drift"].word == word


def test_water_that_moved_before_the_run_and_modules_without_a_zero_are_told(truth):
    found = judged(log_of(truth, still=0.02, unset=3))
    assert (found["water_speed"].word, found["without_zero"].word) == ("WRONG", "noted")
    assert found["water_speed"].value == pytest.approx(0.02, rel=0.01)


def test_a_run_that_ended_within_its_first_cycle_is_not_checked_against_the_model(truth):
    log = log_of(truth)
    short = tuple(one for one in log.entries if one.time < BEFORE + 1.0)
    found = judged(replace(log, entries=(*short, Event(time=BEFORE + 1.0, kind="stop", message=""))))
    needs_no_cycle = {"pose_age", "water_speed", "without_zero"}
    assert {one.word for name, one in found.items() if name not in needs_no_cycle} == {"not checked"}


def test_a_recording_without_a_verdict_gets_one_by_the_usual_limits_and_one_that_has_it_keeps_it(truth):
    log = log_of(truth)
    assert spoken(log, lc.plant)["accepted"]
    said = {"accepted": False, "checks": [], "lines": ["WRONG"]}
    told = Event(time=99.0, kind="verdict", message="", data=said)
    assert spoken(replace(log, entries=(*log.entries, told)), lc.plant) == said


class Diverging(PlanarPlant):
    """A plant that diverges after 3 s."""

    def march(self, state, command, duration, sample_interval, *, link_forces=False):
        then, log, trouble = super().march(state, command, duration, sample_interval)
        return then, log, "diverged" if log.time[-1] > 3.0 else trouble


def words(found) -> dict[str, str]:
    return {name: one.word for name, one in found.items()}


NEEDS_A_MODEL = {"swing_error", "marker_jump", "speed_change", "sideslip_change", "model_speed", "turn_change"}


@pytest.mark.parametrize(
    "plant",
    [
        Diverging(robot=PLANT.robot, environment=PLANT.environment, settings=PLANT.settings),
        lc.plant(lc.load_robot("mamba-modules").planar(), WATER, joints="servo"),  # another number of joints
    ],
)
def test_without_a_model_that_fits_what_needs_one_is_not_checked(truth, plant):
    found = words(judged(log_of(truth), plant=plant))
    assert {name for name, word in found.items() if word == "not checked"} == NEEDS_A_MODEL
    assert found["angle_jump"] == "ok"


def without(log: OperationLog, *kinds: type) -> OperationLog:
    return replace(log, entries=tuple(one for one in log.entries if not isinstance(one, kinds)))


def test_what_was_not_recorded_is_not_checked(truth):
    log = log_of(truth)
    bare = judged(without(log, Estimate))
    assert {name for name, one in bare.items() if one.word != "not checked"} == {"without_zero", "clock_drift"}
    unseen = words(judged(without(log, PoseSample)))
    assert {name for name, word in unseen.items() if word == "not checked"} == NEEDS_A_MODEL
    begun = replace(log, entries=tuple(one for one in log.entries if one.time >= BEFORE))
    assert words(judged(begun))["water_speed"] == "not checked"
    no_rates = [replace(one, rate=None) if isinstance(one, JointSample) else one for one in log.entries]
    found = words(judged(replace(log, entries=tuple(no_rates))))
    assert [name for name, word in found.items() if word != "ok"] == ["angle_jump"]


def test_a_run_of_few_cycles_is_checked_but_for_its_turning(truth):
    log = log_of(truth)
    short = tuple(one for one in log.entries if one.time < BEFORE + 4 * 3.0 + 0.1)
    found = words(judged(replace(log, entries=(*short, Event(time=BEFORE + 12.1, kind="stop", message="")))))
    assert [name for name, word in found.items() if word == "not checked"] == ["turn_change", "clock_drift"]
