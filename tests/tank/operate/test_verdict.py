import math
from dataclasses import fields, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import laticauda as lc
from laticauda.control.estimation import (
    Estimate,
    JointSample,
    KinematicEstimator,
    PoseSample,
    ReferenceSample,
)
from laticauda.models.planar.model import PlanarPlant
from laticauda.robot.kinematics import Posture, turn
from laticauda.scenarios import Experiment
from laticauda.tank.operate import Event, Header, OperationLog, recorded_verdict_summary, verdict_of
from laticauda.tank.operate.recording.timing import Tick
from laticauda.tank.operate.settings import Acceptance
from laticauda.tank.operate.verdict import Verdict
from laticauda.tank.operate.verdict.check import Measurement, compare_with_limit
from laticauda.tank.operate.verdict.completeness import measure_missing_answers
from laticauda.tank.operate.verdict.model_run import swim_model
from laticauda.tank.operate.verdict.recorded_run import CycleMotion, RecordedRun
from laticauda.tank.operate.verdict.signals import range_so_far, swing_of
from laticauda.tank.operate.verdict.verdict import CHECKS
from laticauda.values import value_class

ROBOT, WATER = lc.load_robot("mamba"), lc.load_water("paper-lateral")
GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(120), phase_shift=math.radians(40)
)
PLANT = lc.build_plant(ROBOT, WATER, joints="servo")
CYCLES = 8
STEP = 0.02  # s
BEFORE = 3.0  # s


@pytest.fixture(scope="module")
def truth() -> lc.Trial:
    return swum()


@cache
def swum() -> lc.Trial:
    """A run of whole cycles, as it is sampled."""
    return lc.run(
        PLANT, lc.OpenLoop(command=lc.Command(gait=GAIT)), CYCLES * 3.0 + STEP, sample_interval=STEP
    )


def log_of(
    truth, *, angle=None, yaw=0.0, bent=0.0, moved=0.0, path=None, clock=0.0, unset=0, still=0.0
) -> OperationLog:
    """The recording of a perfect operation of that run.

    Args:
        truth: The run.
        angle: Other joint angles than the true ones.
        yaw: By which the marker body is turned on its module, over the samples.
        bent: By which the whole robot is turned, over the samples.
        moved: By which the water takes the robot to the left, over the samples.
        path: Other centers of mass than the true ones.
        clock: By which the cameras' clock goes away until the end.
        unset: Modules without a zero.
        still: Speed of the robot before the run.
    """
    n = len(truth.time)
    yaw, bent, moved = (np.broadcast_to(one, n) for one in (yaw, bent, moved))
    angle = truth.joint_angle if angle is None else angle
    path = truth.center_of_mass if path is None else path
    path = path + np.stack((np.zeros(n), moved), axis=1)
    links = truth.link_angle + bent[:, np.newaxis]
    markers = Posture(ROBOT, path, links).link_centers[:, 0]
    entries: list[object] = [
        Event(time=1.0, kind="calibrating", message="", data={"without_zero": unset})
    ]

    def estimate(time, k, aside=0.0):
        return Estimate(
            time=time,
            status="tracking",
            age=0.0,
            center_of_mass=path[k] + np.array((0.0, aside)),
            center_of_mass_velocity=np.zeros(2),
            heading=float(truth.heading[k] + bent[k] + yaw[k]),
            heading_rate=0.0,
            link_angle=links[k] + yaw[k],
            joint_angle=truth.joint_angle[k],
            joint_rate=truth.joint_rate[k],
        )

    for k in range(100):
        entries.append(estimate(BEFORE - 2.0 + 0.02 * k, 0, still * 0.02 * (k - 99)))
    entries.append(Event(time=BEFORE, kind="start", message="", data={"clock": 0.5}))
    for k in range(n):
        time = BEFORE + float(truth.time[k])
        entries.append(
            ReferenceSample(time=time, angle=truth.joint_angle_ref[k], frequency=GAIT.frequency)
        )
        entries.append(JointSample(time=time, angle=angle[k], rate=truth.joint_rate[k]))
        entries.append(Tick(due=time, began=time, sent=time))
        place = np.array([*markers[k], 0.0])
        entries.append(
            PoseSample(time=time, position=place, rotation=turn("yaw", links[k, 0] + yaw[k]))
        )
        entries.append(estimate(time, k))
    last = BEFORE + float(truth.time[-1])
    entries.append(
        Event(time=last, kind="stop", message="", data={"succeeded": True, "clock": 0.5 + clock})
    )
    header = Header(
        run=Experiment(robot=ROBOT, environment=WATER, gait=GAIT, notes={"rate": 1.0 / STEP}),
        estimator=KinematicEstimator(robot=ROBOT),
    )
    return OperationLog(
        path=Path("run.mcap"), header=header, version="", notes={}, entries=tuple(entries), lost=""
    )


def judged(log, plant=PLANT, **limits):
    return {one.name: one for one in verdict_of(log, Acceptance(**limits), plant).checks}


def test_a_perfect_run_passes_every_check_with_hardly_any_of_its_limits_used(truth):
    verdict = verdict_of(log_of(truth), Acceptance(), PLANT)
    assert verdict.reason == ""
    assert [one.outcome for one in verdict.checks] == ["ok"] * len(fields(Acceptance))
    assert max(one.share for one in verdict.checks) < 0.5
    summary = verdict.summary()
    assert summary["accepted"]
    assert summary["lines"][4].startswith("ok          joint error not explained by its servo: ")


def test_a_joint_that_stands_still_is_named_after_one_cycle_and_the_run_is_rejected(truth):
    angle = truth.joint_angle.copy()
    angle[len(angle) // 2 :, 3] = angle[len(angle) // 2, 3]
    verdict = verdict_of(log_of(truth, angle=angle), Acceptance(), PLANT)
    found = verdict.checks[4]
    assert (found.name, found.outcome) == ("joint_error", "WRONG")
    assert found.description.endswith("module 4")
    assert CYCLES * 1.5 < found.since <= CYCLES * 1.5 + 6.0
    assert verdict.reason.startswith(
        "The run failed a check: joint error not explained by its servo: "
    )


def test_a_servo_that_follows_better_than_the_model_is_right(truth):
    assert judged(log_of(truth, angle=truth.joint_angle_ref))["joint_error"].share < 0.2


@pytest.mark.parametrize("share", [0.5, 1.5])
def test_the_limit_is_what_decides(truth, share):
    angle = truth.joint_angle.copy()
    angle[:, 2] += math.radians(2.0)
    found = judged(log_of(truth, angle=angle), joint_error=math.radians(2.0) / share)["joint_error"]
    assert found.outcome == ("ok" if share < 1.0 else "WRONG")
    assert found.share == pytest.approx(share, rel=0.1)


def test_without_a_model_a_joint_may_lack_half_of_its_swing_and_no_more(truth):
    for swing, word in ((0.6, "ok"), (0.1, "WRONG")):
        found = judged(log_of(truth, angle=swing * truth.joint_angle_ref), plant=None)
        assert found["joint_error"].outcome == word
        assert found["swing_error"].outcome == found["turn_change"].outcome == "not checked"


def test_without_a_model_a_servo_may_be_late_and_a_joint_that_is_bent_aside_is_wrong(truth):
    assert judged(log_of(truth), plant=None)["joint_error"].share < 0.7
    bent = truth.joint_angle + math.radians(5.0) * np.eye(truth.joint_angle.shape[1])[1]
    found = judged(log_of(truth, angle=bent), plant=None)["joint_error"]
    assert (found.outcome, found.description[-8:]) == ("WRONG", "module 2")


def test_a_sensor_that_jumps_is_named_when_it_does(truth):
    angle = truth.joint_angle.copy()
    angle[500:, 5] += math.radians(4.0)
    found = judged(log_of(truth, angle=angle))["angle_jump"]
    assert found.outcome == "WRONG"
    assert found.description.endswith("module 6")
    assert found.since == pytest.approx(float(truth.time[502]))  # when three of five answers say so


@pytest.mark.parametrize(("n_late", "word"), [(1, "ok"), (2, "ok"), (5, "WRONG")])
def test_answers_that_come_late_for_a_moment_are_no_jump(truth, n_late, word):
    rate = np.abs(truth.joint_rate[:, 1])
    k = 300 + int(rate[300:400].argmax())
    angle = truth.joint_angle.copy()
    angle[k : k + n_late, 1] += math.radians(10.0)  # as if it was 0.1 s late at 100 deg/s
    assert judged(log_of(truth, angle=angle))["angle_jump"].outcome == word


def test_a_sensor_that_jumps_while_its_module_does_not_answer_is_named(truth):
    angle = truth.joint_angle.copy()
    angle[500:, 5] += math.radians(4.0)
    angle[495:503, 5] = math.nan
    assert judged(log_of(truth, angle=angle))["angle_jump"].description.endswith("module 6")


@pytest.mark.parametrize(("every", "word"), [(2, "WRONG"), (3, "WRONG"), (4, "not checked")])
def test_of_answers_that_are_further_apart_than_60_ms_a_jump_is_not_told(truth, every, word):
    angle = truth.joint_angle.copy()
    angle[600:, 5] += math.radians(6.0)
    log = log_of(truth, angle=angle)
    entries = (
        one
        for one in log.entries
        if not isinstance(one, JointSample) or round(one.time / STEP) % every == 0
    )
    assert judged(replace(log, entries=tuple(entries)))["angle_jump"].outcome == word


@given(share=st.floats(0.2, 5.0))
@settings(max_examples=5)
def test_what_share_of_its_steps_a_rate_explains_does_not_matter(share):
    def shared(one):
        return replace(one, rate=one.rate * share) if isinstance(one, JointSample) else one

    log = log_of(swum())
    usual = judged(log, plant=None)["angle_jump"].value
    found = judged(replace(log, entries=tuple(map(shared, log.entries))), plant=None)[
        "angle_jump"
    ].value
    assert found == pytest.approx(usual, rel=1e-6, abs=1e-9)


def test_samples_that_all_have_the_same_time_tell_no_jump(truth):
    log = log_of(truth)
    entries = (
        replace(one, time=BEFORE) if isinstance(one, JointSample) else one for one in log.entries
    )
    assert (
        judged(replace(log, entries=tuple(entries)), plant=None)["angle_jump"].outcome
        == "not checked"
    )


def test_a_marker_body_that_turns_on_its_module_is_seen_at_once(truth):
    yaw = np.where(np.arange(len(truth.time)) < 600, 0.0, math.radians(5.0))
    found = judged(log_of(truth, yaw=yaw))["marker_jump"]
    assert found.value == pytest.approx(math.radians(5.0), abs=math.radians(0.5))
    assert 0.0 <= found.since - float(truth.time[600]) < 0.3


def test_water_that_begins_to_move_is_seen_as_sideslip(truth):
    moved = np.maximum(truth.time - 9.0, 0.0) * 0.03
    found = judged(log_of(truth, moved=moved))
    assert found["sideslip_change"].outcome == "WRONG"
    assert found["sideslip_change"].since == pytest.approx(
        12.0
    )  # when the first cycle in it is complete
    assert found["joint_error"].outcome == found["swing_error"].outcome == "ok"


def test_a_robot_that_is_seen_aside_for_a_moment_where_a_cycle_ends_has_not_changed(truth):
    aside = 0.04 * np.exp(-(((truth.time - 12.0) / 0.3) ** 2))  # a tenth of its way in a cycle
    assert judged(log_of(truth, moved=aside))["sideslip_change"].share < 0.5


def test_a_robot_that_slips_aside_while_it_starts_has_not_changed(truth):
    aside = 0.06 * np.minimum(truth.time / 3.0, 1.0)
    assert judged(log_of(truth, moved=aside))["sideslip_change"].share < 0.01


def test_a_run_whose_end_was_not_seen_is_rejected(truth):
    log, end = log_of(truth), BEFORE + float(truth.time[-1])
    late = tuple(
        replace(one, age=max(one.time - (end - 0.5), 0.0)) if isinstance(one, Estimate) else one
        for one in log.entries
    )
    found = judged(replace(log, entries=late))["pose_age"]
    assert (found.outcome, found.value) == ("WRONG", pytest.approx(0.5 - 3 * STEP))


def test_what_the_markers_do_before_the_run_does_not_count(truth):
    log = log_of(truth)
    first = next(one for one in log.entries if isinstance(one, PoseSample))
    turned = turn("yaw", float(truth.link_angle[0, 0]) + math.radians(20.0))
    before = [replace(first, time=BEFORE - STEP * k, rotation=turned) for k in range(50, 0, -1)]
    assert judged(replace(log, entries=(*before, *log.entries)))["marker_jump"].share < 0.2


def test_a_robot_that_moves_against_its_model_is_noted_as_one_that_hardly_moves(truth):
    back = 2.0 * truth.center_of_mass[0] - truth.center_of_mass
    found = judged(log_of(truth, path=back))["model_speed"]
    assert (found.outcome, found.value) == ("noted", pytest.approx(math.log(1000.0)))


def test_a_robot_that_sinks_before_its_run_says_nothing_of_a_current(truth):
    def sunk(one):
        place = np.array([*one.center_of_mass, -0.1 * one.time])
        return replace(one, center_of_mass=place, center_of_mass_velocity=np.zeros(3))

    log = log_of(truth)
    entries = tuple(sunk(one) if isinstance(one, Estimate) else one for one in log.entries)
    assert judged(replace(log, entries=entries), plant=None)["water_speed"].value < 1e-6


def test_a_marker_body_that_was_wrong_from_the_beginning_is_not_seen(truth):
    assert all(one.outcome == "ok" for one in judged(log_of(truth, yaw=0.05)).values())


@pytest.mark.parametrize(("drift", "word"), [(0.005, "ok"), (0.03, "WRONG"), (-0.03, "WRONG")])
def test_a_clock_that_goes_away_is_seen_at_the_end(truth, drift, word):
    assert judged(log_of(truth, clock=drift))["clock_drift"].outcome == word


def test_water_that_moved_before_the_run_and_modules_without_a_zero_are_told(truth):
    found = judged(log_of(truth, still=0.02, unset=3))
    assert (found["water_speed"].outcome, found["without_zero"].outcome) == ("WRONG", "noted")
    assert found["water_speed"].value == pytest.approx(0.02, rel=0.01)


def test_a_run_that_ended_within_its_first_cycle_is_not_checked_against_the_model(truth):
    log = log_of(truth)
    short = tuple(one for one in log.entries if one.time < BEFORE + 1.0)
    found = judged(
        replace(log, entries=(*short, Event(time=BEFORE + 1.0, kind="stop", message="")))
    )
    needs_no_cycle = {"angle_jump", "pose_age", "water_speed", "without_zero"}
    needs_no_cycle |= {"missing_in_run", "longest_silence"}
    assert {one.outcome for name, one in found.items() if name not in needs_no_cycle} == {
        "not checked"
    }


def test_a_sensor_that_jumps_within_the_first_cycle_rejects_the_run(truth):
    angle = truth.joint_angle.copy()
    angle[20:, 2] += math.radians(40.0)
    short = until_cycle(log_of(truth, angle=angle), 0.5, clock=0.5)
    found = verdict_of(short, Acceptance(), PLANT)
    assert "joint-angle jump not explained by its rate" in found.reason and found.reason.endswith(
        "module 3."
    )
    assert not verdict_of(until_cycle(log_of(truth), 0.5, clock=0.5), Acceptance(), PLANT).reason


def test_at_50_hz_eleven_answers_are_enough_for_a_jump(truth):
    angle = truth.joint_angle.copy()
    angle[6:, 2] += math.radians(40.0)
    for n_answers, word in ((10, "not checked"), (11, "WRONG")):
        short = until_cycle(log_of(truth, angle=angle), (n_answers - 1) * STEP / 3.0 + 1e-6)
        assert judged(short)["angle_jump"].outcome == word


@pytest.mark.parametrize(("n", "is_right"), [(0.5, False), (1.0, True)])
def test_a_run_that_came_to_an_edge_counts_only_if_a_cycle_was_whole(truth, n, is_right):
    log = until_cycle(log_of(truth), n, clock=0.5)
    edge = Event(time=log.entries[-1].time, kind="state", message="", data={"event": "edge"})
    found = verdict_of(replace(log, entries=(*log.entries, edge)), Acceptance(), PLANT)
    why = "The run failed a check: it reached an edge before a cycle was complete, so nothing confirms it."
    assert found.reason == ("" if is_right else why)
    assert found.summary()["accepted"] == is_right


def test_a_recording_without_a_verdict_gets_one_by_the_usual_limits_and_one_that_has_it_keeps_it(
    truth,
):
    log = log_of(truth)
    assert recorded_verdict_summary(log, lc.build_plant)["accepted"]
    said = {"accepted": False, "checks": [], "lines": ["WRONG"]}
    told = Event(time=99.0, kind="verdict", message="", data=said)
    later = replace(told, data=said | {"accepted": True})
    assert (
        recorded_verdict_summary(replace(log, entries=(*log.entries, told, later)), lc.build_plant)
        == said
    )


def compared(limits, name, begin, times, values, location=""):
    """The result of the check of that name for a measurement."""
    (check,) = (check for check in CHECKS if check.name == name)
    measurement = Measurement(times=np.array(times), values=values, location=location)
    return compare_with_limit(check, measurement, limits, begin)


def test_there_is_a_check_for_every_limit_in_the_same_order():
    assert [check.name for check in CHECKS] == [field.name for field in fields(Acceptance)]


def test_the_check_that_used_most_of_its_limit_is_the_reason():
    limits, times = Acceptance(), [2.0, 3.0]
    worst = {"angle_jump": 0.0, "joint_error": 0.06, "swing_error": 9.0}
    checks = (
        compared(limits, name, 1.0, times, np.array([0.0, value])) for name, value in worst.items()
    )
    assert Verdict(()).reason == ""
    found = Verdict(tuple(checks), is_cut=True)
    assert found.reason == f"The run failed a check: {found.checks[2].description}."
    assert [line[:11] for line in found.summary()["lines"]] == [
        "WRONG      ",
        "WRONG      ",
        "ok         ",
    ]
    assert "swing" in found.summary()["lines"][0]


def test_a_starved_computer_is_named_before_what_it_makes_look_wrong():
    limits, times = Acceptance(), [2.0, 3.0]

    def verdict(**worst):
        return Verdict(
            tuple(
                compared(limits, name, 1.0, times, np.array([0.0, value]))
                for name, value in worst.items()
            )
        )

    both = verdict(missing_answers=0.15, time_late=0.3, joint_error=0.2, clock_drift=0.03)
    assert both.reason == (
        "The run failed a check: share of a cycle's time by which this computer was late: "
        "0.3 of 0.1 (300 %), since 2.0 s. This may be why another one failed: "
        "drift of the cameras' clock against ours: 0.03 of 0.0002 s/s (15000 %), since 2.0 s."
    )
    assert verdict(time_late=0.3, missing_answers=0.5).reason == ""
    fast = verdict(time_late=0.05, model_speed=9.0, joint_error=0.2)
    assert fast.reason.startswith("The run failed a check: joint error")
    assert "may be why" not in fast.reason


def test_a_hole_that_rejects_a_run_is_named_before_all_else_and_alone_is_the_reason():
    limits, times = Acceptance(), [2.0, 3.0]

    def reason(**worst):
        checks = (
            compared(limits, name, 1.0, times, np.array([0.0, value]))
            for name, value in worst.items()
        )
        return Verdict(tuple(checks)).reason

    silence = (
        "longest time in the run without an answer of a module: 2 of 0.5 s (400 %), since 2.0 s."
    )
    assert reason(longest_silence=2.0) == f"The run failed a check: {silence}"
    assert reason(missing_answers=0.9, longest_silence=2.0) == f"The run failed a check: {silence}"
    both = reason(missing_answers=0.9, longest_silence=2.0, joint_error=0.06)
    assert both.startswith(f"The run failed a check: {silence} This may be why another one failed:")
    assert both.endswith(
        "joint error not explained by its servo: 3.44 of 3 deg (115 %), since 2.0 s."
    )


def late_log(truth, lateness, rate=1.0 / STEP) -> OperationLog:
    """A perfect run whose ticks began late by that much [s]."""
    log = log_of(truth)
    run = replace(log.header.run, notes={} if rate is None else {"rate": rate})
    due = BEFORE + truth.time
    punctual = without(log, Tick)
    ticks = [
        Tick(due=float(moment), began=float(moment + late), sent=float(moment + late))
        for moment, late in zip(due, lateness, strict=True)
    ]
    return replace(log, header=replace(log.header, run=run), entries=(*punctual.entries, *ticks))


def test_the_time_by_which_this_computer_was_late_is_noted_by_cycle(truth):
    lateness = np.full(len(truth.time), 0.9 * STEP)  # not missed
    found = judged(late_log(truth, lateness))["time_late"]
    assert (found.outcome, found.value) == ("ok", 0.0)
    lateness[(truth.time > 6.1) & (truth.time < 7.1)] = 2.0 * STEP  # 50 ticks of the third cycle
    found = judged(late_log(truth, lateness))["time_late"]
    assert found.outcome == "noted" and found.since == pytest.approx(9.0)
    n_late = np.count_nonzero(lateness > STEP)
    assert found.value == pytest.approx(n_late * 2.0 * STEP / 3.0)


def test_without_a_rate_or_a_whole_cycle_nothing_is_known_of_lateness(truth):
    lateness = np.full(len(truth.time), 2.0 * STEP)
    assert judged(late_log(truth, lateness, rate=None))["time_late"].outcome == "not checked"
    short = until_cycle(late_log(truth, lateness), 0.5)
    assert judged(short)["time_late"].outcome == "not checked"
    assert judged(short)["missing_answers"].outcome == "not checked"


def test_answers_that_did_not_come_are_noted_and_a_lone_module_is_named(truth):
    angle = truth.joint_angle.copy()
    is_silent = (truth.time > 6.0) & (truth.time <= 6.6)  # a fifth of the third cycle
    angle[is_silent, 3] = math.nan
    found = judged(log_of(truth, angle=angle))["missing_answers"]
    assert (found.outcome, found.since) == ("noted", pytest.approx(9.0))
    assert found.value == pytest.approx(0.2, abs=0.01)
    assert found.description.endswith("module 4")
    angle[is_silent] = math.nan
    found = judged(log_of(truth, angle=angle))["missing_answers"]
    assert found.value == pytest.approx(0.2, abs=0.01)
    assert "module" not in found.description.partition("(")[2]


def test_samples_that_were_not_recorded_are_answers_that_did_not_come(truth):
    log = log_of(truth)
    entries = tuple(
        entry
        for entry in log.entries
        if not (isinstance(entry, JointSample) and 8.0 < entry.time - BEFORE < 8.5)
    )
    found = judged(replace(log, entries=entries))["missing_answers"]
    assert (found.outcome, found.since) == ("noted", pytest.approx(9.0))
    assert found.value == pytest.approx(0.5 / 3.0, abs=0.02)
    assert judged(without(log, JointSample))["missing_answers"].outcome == "not checked"


def silent_log(truth, begin, end, module=slice(None)) -> OperationLog:
    """A perfect run of which some modules did not answer from a time to another [s since its begin]."""
    angle = truth.joint_angle.copy()
    angle[(truth.time > begin - 1e-9) & (truth.time < end - 1e-9), module] = math.nan
    return log_of(truth, angle=angle)


@pytest.mark.parametrize("is_recorded", [True, False])
def test_a_run_of_which_nobody_heard_the_robot_from_its_first_second_on_is_rejected(
    truth, is_recorded
):
    log = silent_log(truth, 0.84, math.inf)
    if not is_recorded:
        entries = [
            entry
            for entry in log.entries
            if not isinstance(entry, JointSample) or np.isfinite(entry.angle).any()
        ]
        log = replace(log, entries=tuple(entries))
    verdict = verdict_of(log, Acceptance(), PLANT)
    found = {check.name: check for check in verdict.checks}
    last = float(truth.time[-1])
    assert found["longest_silence"].value == pytest.approx(last - 0.82)
    assert found["missing_in_run"].value == pytest.approx(1.0 - 42 / len(truth.time))
    assert found["longest_silence"].since == found["missing_in_run"].since == pytest.approx(last)
    assert verdict.reason.startswith("The run failed a check: longest time in the run without")


@pytest.mark.parametrize(
    ("begin", "end", "silence"),
    [(0.0, 0.5, 0.5), (0.0, 0.52, 0.52), (9.0, 9.48, 0.5), (9.0, 9.5, 0.52), (23.52, 99.0, 0.52)],
)
def test_half_a_second_without_an_answer_is_all_that_is_allowed_also_at_both_ends(
    truth, begin, end, silence
):
    found = judged(silent_log(truth, begin, end, 4), longest_silence=0.51)["longest_silence"]
    assert found.value == pytest.approx(silence)
    assert found.outcome == ("ok" if silence < 0.51 else "WRONG")
    assert found.description.endswith("module 5")
    if found.since is not None:  # it is known when the module answers again, or the run ends
        assert found.since == pytest.approx(min(end, float(truth.time[-1])))


def test_a_silence_of_all_modules_names_none_of_them(truth):
    found = judged(silent_log(truth, 9.0, 10.0))
    assert found["longest_silence"].description.endswith("since 10.0 s")
    assert found["missing_in_run"].outcome == "ok"


@pytest.mark.parametrize(("n_silent", "outcome"), [(1, "ok"), (2, "WRONG")])
def test_a_module_that_answers_one_time_in_three_is_silent_for_no_long_time_but_rejects_the_run(
    truth, n_silent, outcome
):
    angle = truth.joint_angle.copy()
    angle[np.arange(len(angle)) % 3 < n_silent, 2] = math.nan
    found = judged(log_of(truth, angle=angle))
    assert found["missing_in_run"].value == pytest.approx(n_silent / 3.0, abs=0.001)
    assert found["missing_in_run"].outcome == outcome
    assert found["missing_in_run"].description.endswith("module 3")
    assert found["longest_silence"].value == pytest.approx((n_silent + 1) * STEP)


def test_of_a_run_without_any_answer_all_are_missing_and_without_references_none_were_due(truth):
    log = log_of(truth)
    found = judged(without(log, JointSample))
    assert found["missing_in_run"].value == 1.0
    assert found["longest_silence"].value == pytest.approx(float(truth.time[-1]))
    found = judged(without(log, ReferenceSample))
    assert words(found)["missing_in_run"] == words(found)["longest_silence"] == "not checked"


def test_answers_count_only_while_references_are_sent(truth):
    log = log_of(truth)
    entries = [
        entry
        for entry in log.entries
        if not isinstance(entry, ReferenceSample) or 5.0 < entry.time - BEFORE < 15.0
    ]
    angle_of_some = [
        replace(entry, angle=np.full_like(entry.angle, math.nan))
        if isinstance(entry, JointSample) and 7.0 < entry.time - BEFORE < 8.0
        else entry
        for entry in entries
    ]
    found = judged(replace(log, entries=tuple(angle_of_some)), plant=None)
    assert found["missing_in_run"].value == pytest.approx(0.1, abs=0.003)
    assert found["longest_silence"].value == pytest.approx(1.0, abs=0.03)


def test_of_a_robot_with_one_module_that_module_need_not_be_named(truth):
    angle = truth.joint_angle.copy()
    angle[truth.time > 20.0] = math.nan
    log = log_of(truth, angle=angle)
    entries = [
        replace(entry, angle=entry.angle[:1], rate=entry.rate[:1])
        if isinstance(entry, JointSample)
        else entry
        for entry in log.entries
    ]
    run = RecordedRun.of(replace(log, entries=tuple(entries)), None)
    found = measure_missing_answers(run)
    assert found.location == "" and found.values[-1] > 0.9


class Diverging(PlanarPlant):
    """A plant that diverges after 3 s."""

    def march(self, state, command, duration, sample_interval, *, link_forces=False):
        then, log, trouble = super().march(state, command, duration, sample_interval)
        return then, log, "diverged" if log.time[-1] > 3.0 else trouble


def words(found) -> dict[str, str]:
    return {name: one.outcome for name, one in found.items()}


NEEDS_A_MODEL = {
    "swing_error",
    "marker_jump",
    "speed_change",
    "sideslip_change",
    "model_speed",
    "turn_change",
}


@pytest.mark.parametrize(
    "plant",
    [
        Diverging(robot=PLANT.robot, environment=PLANT.environment, settings=PLANT.settings),
        lc.build_plant(
            lc.load_robot("mamba-modules").planar(), WATER, joints="servo"
        ),  # another number of joints
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
    assert {name for name, one in bare.items() if one.outcome != "not checked"} == {
        "missing_in_run",
        "longest_silence",
        "angle_jump",
        "without_zero",
        "clock_drift",
    }
    unseen = words(judged(without(log, PoseSample)))
    assert {name for name, word in unseen.items() if word == "not checked"} == NEEDS_A_MODEL
    no_rates = [
        replace(one, rate=None) if isinstance(one, JointSample) else one for one in log.entries
    ]
    begun = tuple(one for one in no_rates if one.time >= BEFORE)
    found = words(judged(replace(log, entries=begun)))
    assert [name for name, word in found.items() if word != "ok"] == [
        "angle_jump",
        "water_speed",
        "without_zero",
    ]


def test_a_run_of_few_cycles_is_checked_but_for_its_turning(truth):
    log = log_of(truth)
    short = tuple(one for one in log.entries if one.time < BEFORE + 4 * 3.0 + 0.1)
    found = words(
        judged(replace(log, entries=(*short, Event(time=BEFORE + 12.1, kind="stop", message=""))))
    )
    assert [name for name, word in found.items() if word == "not checked"] == [
        "turn_change",
        "clock_drift",
    ]


def test_a_check_says_how_much_of_its_limit_was_used_in_its_unit_since_when_and_where():
    times, limits = (
        [3.0, 4.0, 5.0],
        Acceptance(water_speed=0.01, joint_error=math.radians(3.0), without_zero=0.5),
    )
    found = compared(limits, "joint_error", 1.0, times, np.radians([1.0, 6.0, 4.5]), "module 2")
    assert (
        found.description
        == "joint error not explained by its servo: 6 of 3 deg (200 %), since 3.0 s; module 2"
    )
    assert (found.outcome, found.value, found.limit) == (
        "WRONG",
        math.radians(6.0),
        math.radians(3.0),
    )
    assert (found.share, found.since) == (pytest.approx(2.0), 3.0)
    found = compared(limits, "water_speed", 1.0, times, np.array([0.01, math.nan, 0.004]), "")
    assert (
        found.description == "drift of the straight robot before the run: 0.01 of 0.01 m/s (100 %)"
    )
    assert (found.outcome, found.since, found.share) == ("ok", None, 1.0)
    found = compared(limits, "without_zero", 1.0, times, np.array([0.0, 0.0, 2.0]), "")
    assert (found.outcome, found.since) == ("noted", 4.0)
    assert (
        found.description
        == "modules without a zero (`joint_zeros` sets them): 2 of 0.5 (400 %), since 4.0 s"
    )
    found = compared(limits, "without_zero", 1.0, times, np.full(3, math.nan), "")
    assert found == (
        "without_zero",
        None,
        0.5,
        None,
        None,
        "not checked",
        "modules without a zero (`joint_zeros` sets them)",
    )


def test_a_cycle_without_its_mean_and_slope_is_what_is_left_of_it():
    place = np.linspace(-1.0, 1.0, 201)
    wave = 0.3 * np.cos(4.0 * math.pi * place)
    assert swing_of(np.stack([wave, 2.0 * wave + 5.0, wave + 3.0 * place])) == pytest.approx(
        np.array([1.0, 2.0, 1.0]) * 0.3 / math.sqrt(2.0), rel=0.01
    )


def test_the_way_to_the_next_cycle_is_told_along_and_to_the_left_of_the_heading_of_both():
    heading = np.array([[0.0, 0.0], [2.0, 2.2], [-1.0, -1.0]])
    place = np.cumsum([5.0 + 6.0j, (0.3 + 0.1j) * np.exp(1.05j), (0.2 - 0.4j) * np.exp(0.55j)])
    center = np.stack([place.real, place.imag], axis=1)[:, np.newaxis] + np.array(
        [[[-0.3, 0.2], [0.3, -0.2]]]
    )
    motion = CycleMotion(center_of_mass=center, heading=heading)
    assert motion.advance == pytest.approx([0.3, 0.2])
    assert motion.sideslip == pytest.approx([0.1, -0.4])


def test_a_spread_is_what_has_changed_up_to_each_moment():
    assert range_so_far(np.array([1.0, 3.0, 2.0, 0.5])).tolist() == [0.0, 2.0, 2.0, 2.5]


def moved_log(truth, *, turned: float = 0.0, faster=1.0, bent=0.0) -> OperationLog:
    """The recording of a run in other axes, at another speed, or with a heading that goes away.

    Args:
        truth: The run.
        turned: All of it, about the origin.
        faster: How much further the center of mass goes at every sample.
        bent: By which it is turned about its center of mass, at every sample.
    """
    c, s = math.cos(turned), math.sin(turned)
    steps = np.diff(truth.center_of_mass, axis=0, prepend=truth.center_of_mass[:1])
    further = np.broadcast_to(faster, len(truth.time))[:, np.newaxis]
    path = truth.center_of_mass[0] + np.cumsum(further * steps, axis=0)
    return log_of(truth, bent=turned + bent, path=path @ np.array([[c, s], [-s, c]]))


NUMBERS = (
    "joint_error",
    "swing_error",
    "marker_jump",
    "speed_change",
    "sideslip_change",
    "turn_change",
    "model_speed",
)


def test_the_choice_of_world_axes_does_not_matter(truth):
    here, there = judged(log_of(truth)), judged(moved_log(truth, turned=2.0))
    for name in NUMBERS:
        assert there[name].value == pytest.approx(here[name].value, abs=2e-3), name
        assert there[name].outcome == "ok"


def test_a_robot_that_becomes_faster_is_seen_and_one_that_always_was_is_noted(truth):
    later = judged(moved_log(truth, faster=np.where(truth.time < 12.0, 1.0, 1.5)))["speed_change"]
    assert (later.outcome, later.value) == ("WRONG", pytest.approx(0.5, abs=0.05))
    assert 12.0 < later.since <= 15.1
    always = judged(moved_log(truth, faster=1.5))
    assert (always["speed_change"].outcome, always["model_speed"].outcome) == ("ok", "noted")
    assert always["model_speed"].value == pytest.approx(math.log(1.5), abs=0.05)
    assert always["model_speed"].since == pytest.approx(CYCLES * 3.0)


@value_class
class SwimThenGlide(lc.Controller[None]):
    """A gait that ends in time to glide for a while."""

    gait: lc.Gait = GAIT
    interval: float = 0.1

    def init(self):
        return None

    def step(self, state, observation):
        if observation.time < 12.0:
            return None, lc.Command(gait=GAIT)
        return None, lc.Command(gait=replace(GAIT, amplitude=0.0))


def test_a_robot_that_glides_as_its_model_does_has_not_changed():
    glided = lc.run(PLANT, SwimThenGlide(), 3.0 * CYCLES + STEP, sample_interval=STEP)
    speed = np.linalg.norm(glided.center_of_mass_velocity, axis=1)
    assert speed[-1] < 0.15 * np.median(speed)
    assert judged(log_of(glided))["speed_change"].share < 0.3


def test_a_robot_that_always_was_slower_is_noted(truth):
    found = judged(moved_log(truth, faster=0.5))["model_speed"]
    assert (found.outcome, found.value) == ("noted", pytest.approx(math.log(2.0), abs=0.05))


def test_a_robot_that_swims_backward_is_judged_like_one_that_swims_forward():
    gait = lc.lateral_undulation(
        amplitude=math.radians(30), frequency=GAIT.frequency, phase_shift=math.radians(-40)
    )
    back = lc.run(
        PLANT, lc.OpenLoop(command=lc.Command(gait=gait)), 3.0 * CYCLES + STEP, sample_interval=STEP
    )
    assert back.center_of_mass[-1, 0] < -0.5
    right, changed = (
        judged(log_of(back, moved=moved))
        for moved in (0.0, np.maximum(back.time - 9.0, 0.0) * 0.03)
    )
    assert max(right[name].share for name in NUMBERS) < 0.3
    assert changed["sideslip_change"].outcome == "WRONG"
    faster = judged(moved_log(back, faster=np.where(back.time < 12.0, 1.0, 1.5)))["speed_change"]
    assert (faster.outcome, faster.value) == ("WRONG", pytest.approx(0.5, abs=0.05))


def test_a_heading_that_begins_to_go_away_is_a_change_of_turning(truth):
    bent = np.maximum(truth.time - 12.0, 0.0) * math.radians(2.0) / 3.0  # 2 deg a cycle
    found = judged(moved_log(truth, bent=bent), turn_change=math.radians(0.7))["turn_change"]
    # Over five cycles: none of the first five of seven turns but the last, three of the last five.
    assert found.value == pytest.approx(math.radians(2.0 * 2.0 / 5.0), rel=0.1)
    assert found.outcome == "WRONG" and found.since > 15.0


def test_a_robot_that_steers_a_little_better_than_the_model_is_right_and_one_that_steers_much_better_is_not():
    follower = lc.Following().controller(GAIT)
    start = lc.Start(center_of_mass=(0.0, 1.0))
    steered = lc.run(PLANT, follower, 3.0 * CYCLES + STEP, start=start, sample_interval=STEP)
    turned = steered.heading - steered.heading[0]
    little, much = (
        judged(moved_log(steered, bent=share * turned))["turn_change"] for share in (0.08, 0.3)
    )
    assert (little.outcome, much.outcome) == ("ok", "WRONG")
    assert little.share < 0.3


def test_a_robot_that_turns_a_little_later_than_the_model_is_right_and_one_that_turns_much_later_is_not():
    follower = lc.Following().controller(GAIT)
    start = lc.Start(center_of_mass=(0.0, 1.0))
    steered = lc.run(PLANT, follower, 3.0 * CYCLES + STEP, start=start, sample_interval=STEP)

    def turn_change(delay):
        late = np.interp(steered.time - delay, steered.time, steered.heading)
        return judged(moved_log(steered, bent=late - steered.heading))["turn_change"]

    assert (turn_change(0.06).outcome, turn_change(0.5).outcome) == ("ok", "WRONG")
    assert turn_change(0.06).share < 0.4


def test_single_wrong_frames_are_no_change_where_cycles_end_either(truth):
    bent = np.zeros(len(truth.time))
    bent[np.searchsorted(truth.time, 12.0) : np.searchsorted(truth.time, 12.05)] = math.radians(8.0)
    found = judged(moved_log(truth, bent=bent))
    assert [found[name].outcome for name in NUMBERS] == ["ok"] * len(NUMBERS)
    assert max(found["turn_change"].share, found["sideslip_change"].share) < 0.1


def test_a_joint_that_does_the_opposite_of_its_servo_is_not_between_reference_and_model(truth):
    opposite = 2.0 * truth.joint_angle_ref - truth.joint_angle
    lag = (truth.joint_angle_ref - truth.joint_angle)[: 150 * CYCLES].reshape(CYCLES, 150, -1)
    beside = np.sqrt(np.mean(lag**2, axis=1)).max()  # of the worst cycle and joint
    assert judged(log_of(truth, angle=opposite))["joint_error"].value == pytest.approx(
        beside, rel=0.05
    )
    double = 2.0 * truth.joint_angle - truth.joint_angle_ref
    assert judged(log_of(truth, angle=double))["joint_error"].value == pytest.approx(
        beside, rel=0.05
    )


def test_what_has_gaps_is_judged_by_what_there_is(truth):
    log = log_of(truth)
    first = next(one for one in log.entries if isinstance(one, JointSample))
    some = [
        replace(one, rate=None) if one is first else one
        for one in log.entries
        if not (isinstance(one, PoseSample) and round(one.time / STEP) % 20)  # 0.4 s between frames
    ]
    found = words(judged(replace(log, entries=tuple(some))))
    assert found["angle_jump"] == found["marker_jump"] == "not checked"
    holes = [
        one for one in log.entries if not (isinstance(one, JointSample) and 8.0 < one.time < 8.5)
    ]
    assert words(judged(replace(log, entries=tuple(holes))))["angle_jump"] == "ok"


def test_half_way_between_reference_and_servo_is_right(truth):
    half = 0.5 * (truth.joint_angle + truth.joint_angle_ref)
    assert judged(log_of(truth, angle=half))["joint_error"].share < 0.3


def test_a_marker_body_may_turn_to_either_side_and_the_first_reference_may_have_no_frequency(truth):
    yaw = np.where(np.arange(len(truth.time)) < 600, 0.0, -math.radians(5.0))
    log = log_of(truth, yaw=yaw)
    first = next(one for one in log.entries if isinstance(one, ReferenceSample))
    entries = tuple(replace(one, frequency=0.0) if one is first else one for one in log.entries)
    found = judged(replace(log, entries=entries))
    assert found["marker_jump"].value == pytest.approx(math.radians(5.0), abs=math.radians(0.5))
    assert found["model_speed"].outcome == "ok"


def test_without_a_model_half_of_the_swing_about_an_offset_may_be_missing(truth):
    log = log_of(truth, angle=0.3 + 0.6 * truth.joint_angle_ref)
    entries = [
        replace(one, angle=one.angle + 0.3) if isinstance(one, ReferenceSample) else one
        for one in log.entries
    ]
    assert judged(replace(log, entries=tuple(entries)), plant=None)["joint_error"].share < 0.2


def until_cycle(log: OperationLog, n: float, clock: float = 0.52) -> OperationLog:
    """The same as if it had been stopped with the sample that ends a cycle."""
    end = BEFORE + 3.0 * n
    entries = tuple(one for one in log.entries if one.time <= end + 1e-9)
    return replace(
        log, entries=(*entries, Event(time=end, kind="stop", message="", data={"clock": clock}))
    )


def test_a_cycle_counts_with_its_last_sample_and_turning_from_six_of_them_on(truth):
    log = log_of(truth)
    two, less, six = (words(judged(until_cycle(log, n))) for n in (2.0, 2.0 - STEP / 3.0, 6.0))
    assert (two["speed_change"], less["speed_change"]) == ("ok", "not checked")
    assert (two["turn_change"], six["turn_change"]) == ("not checked", "ok")


def test_of_a_clock_a_second_counts_at_least(truth):
    drift = judged(until_cycle(log_of(truth), 0.1))["clock_drift"]
    assert drift.value == pytest.approx(0.01)


def test_how_long_a_cycle_is_the_references_say_from_whenever_they_have_a_frequency(
    truth, monkeypatch
):
    monkeypatch.setattr("laticauda.tank.operate.verdict.recorded_run.PERIOD_WITHOUT_GAIT", 20.0)
    log, first = log_of(truth), True
    entries = []
    for one in log.entries:
        if isinstance(one, ReferenceSample) and first:
            one, first = replace(one, frequency=0.0), False
        entries.append(one)
    assert words(judged(replace(log, entries=tuple(entries))))["turn_change"] == "ok"


def test_references_without_a_frequency_have_cycles_of_the_usual_length(truth, monkeypatch):
    monkeypatch.setattr("laticauda.tank.operate.verdict.recorded_run.PERIOD_WITHOUT_GAIT", 12.0)
    log = log_of(truth)
    still = [
        replace(one, frequency=0.0) if isinstance(one, ReferenceSample) else one
        for one in log.entries
    ]
    found = words(judged(replace(log, entries=tuple(still))))
    assert (found["speed_change"], found["turn_change"]) == ("ok", "not checked")


def test_the_only_cycle_of_a_short_run_is_compared_with_the_model_too(truth):
    angle = truth.joint_angle.copy()
    angle[:, 3] = 0.0
    found = verdict_of(until_cycle(log_of(truth, angle=angle), 1.2, clock=0.5), Acceptance(), PLANT)
    assert found.reason.startswith(
        "The run failed a check: joint error not explained by its servo: "
    )


def test_the_age_of_poses_is_that_of_the_whole_run(truth):
    log = log_of(truth)
    late = [replace(one, age=0.2) if isinstance(one, Estimate) else one for one in log.entries]
    found = judged(replace(log, entries=tuple(late)), pose_age=0.1)["pose_age"]
    assert (found.outcome, found.since) == ("WRONG", pytest.approx(3.0 * CYCLES, abs=STEP))


@pytest.mark.parametrize(("n", "word"), [(1, "not checked"), (2, "ok")])
def test_two_references_are_enough_for_a_model(truth, n, word):
    log, kept, entries = log_of(truth), 0, []
    for one in log.entries:
        kept += isinstance(one, ReferenceSample)
        if not isinstance(one, ReferenceSample) or kept <= n:
            entries.append(one)
    assert (
        words(judged(replace(log, entries=tuple(entries)), swing_error=1e9))["swing_error"] == word
    )


def test_frames_that_come_out_of_order_are_judged_in_theirs(truth):
    log = log_of(truth)
    first = [one.time for one in log.entries if isinstance(one, PoseSample)]
    swapped = {one: first[i ^ 1] for i, one in enumerate(first) if i < len(first) - 1}
    late = sorted(
        log.entries,
        key=lambda one: (
            swapped.get(one.time, one.time) if isinstance(one, PoseSample) else one.time
        ),
    )
    usual, found = judged(log), judged(replace(log, entries=tuple(late)))
    assert [found[name].value for name in NUMBERS] == pytest.approx(
        [usual[name].value for name in NUMBERS], abs=1e-9
    )


@pytest.mark.parametrize("n", [5, 14])
def test_a_handful_of_frames_says_nothing_of_the_markers(truth, n):
    log, kept, entries = log_of(truth), 0, []
    for one in log.entries:
        kept += isinstance(one, PoseSample)
        if not isinstance(one, PoseSample) or kept <= n:
            entries.append(one)
    found = words(judged(replace(log, entries=tuple(entries))))
    assert (found["marker_jump"], found["swing_error"]) == ("not checked", "not checked")


def rough_log(truth) -> OperationLog:
    """A run with noise, gaps and much that changes: every number of its verdict is one of its own."""
    random = np.random.default_rng(7)
    n, t = len(truth.time), truth.time
    angle = truth.joint_angle + random.normal(0.0, 0.004, truth.joint_angle.shape)
    angle[:, 4] *= 1.0 - 0.05 * t / t[-1]
    yaw, c, s = random.normal(0.0, 0.01, n), math.cos(2.0), math.sin(2.0)
    bent = 2.0 + 0.02 * np.sin(0.3 * t) + np.where(t < 13.0, 0.0, 0.03)
    path = (
        (1.0 + 0.1 * (t > 14.0))[:, np.newaxis] * truth.center_of_mass @ np.array([[c, s], [-s, c]])
    )
    changed = {"angle": angle, "yaw": yaw, "bent": bent, "moved": 0.002 * t**1.5, "path": path}
    log = log_of(truth, **changed, clock=0.013, unset=2, still=0.004)
    entries = []
    for one in log.entries:
        if isinstance(one, Estimate):
            k = round(max(one.time - BEFORE, 0.0) / STEP)
            one = replace(one, age=0.01 + 0.0001 * (k % 50))
        if isinstance(one, PoseSample) and random.random() < 0.2:
            continue
        if isinstance(one, JointSample) and 10.0 < one.time < 10.3:
            continue
        entries.append(one)
    return replace(log, entries=tuple(entries))


ROUGH = {
    "missing_answers": 14.0 / 150.0,
    "time_late": 0.0,
    "missing_in_run": 14.0 / 1202.0,
    "longest_silence": 0.3,
    "joint_error": 0.016149572181450578,
    "angle_jump": 0.017532609580963872,
    "marker_jump": 0.018159225162461823,
    "swing_error": 0.031186463193558084,
    "speed_change": 0.4288973486731893,
    "sideslip_change": 0.04687634373222461,
    "turn_change": 0.004649413448531873,
    "model_speed": 0.17560545631183264,
    "pose_age": 0.0146,
    "clock_drift": 0.013 / 24.02 - 0.01 / 24.02,
    "water_speed": 0.0039873201566111615,
    "without_zero": 2.0,
}
"""What the verdict said of it once everything else here held; at the steps of order 3 of 2026-11-30."""


def test_the_verdict_on_a_rough_run_stays_as_it_is(truth):
    verdict = verdict_of(rough_log(truth), Acceptance(), PLANT)
    assert {one.name: one.value for one in verdict.checks} == pytest.approx(ROUGH, rel=1e-6)
    assert [one.name for one in verdict.checks if one.outcome != "ok"] == [
        "speed_change",
        "without_zero",
    ]
    assert verdict.checks[8].since == pytest.approx(18.0)
    assert [one.description[-8:] for one in verdict.checks[4:6]] == ["module 5", "module 8"]
    bare = verdict_of(rough_log(truth), Acceptance(), None)
    assert bare.checks[4].value == pytest.approx(0.0028545589819866956, rel=1e-6)


def test_joint_zeros_that_are_set_shortly_before_the_run_are_no_drift_of_the_robot(truth):
    def calibrated(at):
        event = Event(time=at, kind="calibrating", message="", data={"without_zero": 0})
        log = log_of(truth, still=0.02)
        return judged(replace(log, entries=(event, *log.entries)))["water_speed"].outcome

    assert calibrated(BEFORE - 2.0) == "WRONG"
    assert calibrated(BEFORE - 1.0) == "not checked"


def test_the_model_moves_a_driven_fin_by_the_last_of_its_references(truth):
    bare = lc.load_robot("mamba-fin")
    fin = replace(bare.caudal_fin, joint=bare.joints[0])
    plant = lc.build_plant(replace(bare, caudal_fin=fin), WATER, joints="servo")
    n_joints = len(plant.robot.joints)
    log = log_of(truth)
    estimates = log.of_run(Estimate)

    def swim(fin_angle):
        references = [
            replace(sample, angle=np.append(sample.angle, fin_angle))
            for sample in log.of_run(ReferenceSample)[:40]
        ]
        columns = range(n_joints + 1)
        return swim_model(plant, estimates[0], references, columns, marker_link=0)

    straight, bent = swim(0.0), swim(0.3)
    assert straight.joint_angle.shape == bent.joint_angle.shape == (39, n_joints + 1)
    assert np.abs(straight.joint_angle[-1, -1]) < 0.1
    assert bent.joint_angle[-1, -1] == pytest.approx(0.3, abs=0.1)


def test_of_a_recording_without_a_start_no_cycle_is_checked(truth):
    log = log_of(truth)
    entries = tuple(
        entry
        for entry in log.entries
        if not (isinstance(entry, Event) and entry.kind in ("start", "stop"))
    )
    found = judged(replace(log, entries=entries))
    assert {name for name, check in found.items() if check.outcome != "not checked"} == {
        "missing_in_run",
        "longest_silence",
        "angle_jump",
        "pose_age",
        "without_zero",
    }
