"""Laws of the whole tick, on a rig that does as it is told; the virtual tank comes in test_session.py."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from tank.operate.rig import CAMERAS_AHEAD, Rig, Run, run_of

import laticauda as lc
from laticauda.control import Following
from laticauda.control.estimation import ReferenceSample
from laticauda.motion.gaits import Generator
from laticauda.tank.operate.procedure import preparing
from laticauda.tank.operate.procedure.operator import Operator
from laticauda.tank.operate.procedure.state import Outputs
from laticauda.tank.operate.safety.supervisor import BY_EVENT, REQUESTS, Supervisor
from laticauda.tank.operate.settings import (
    Calibration,
    CaptureVolume,
    Connection,
    Limits,
    Operation,
    Placement,
)
from laticauda.tank.protocol import EmergencyStop, NodeCommand, NodeState, Order, References, Sync

GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(90), phase_shift=math.radians(40)
)
QUICK = Calibration(idle_time=0.2, still_time=0.3)


def operation(**changes) -> Operation:
    usual = Operation(
        name="test",
        gait=GAIT,
        following=Following(),
        duration=2.0,
        rate=25.0,
        estimator="kinematics",
        countdown=0.1,
        connection=Connection(meter_address="there"),
        supply_voltage=35.0,
        calibration=QUICK,
        limits=Limits(straighten_time=1.0),
    )
    return replace(usual, **changes)


def running(**changes) -> Run:
    run = run_of(Operator(operation=operation(**changes)))
    run.until("running")
    return run


def test_an_operation_goes_through_its_phases_and_ends_limp_in_idle():
    run = running()
    run.until("done")
    assert run.state.supervisor.state == "idle"
    assert run.rig.is_limp
    assert run.state.begun is not None and run.state.ended is not None
    assert run.state.ended - run.state.begun == pytest.approx(2.0, abs=0.05)
    phases = [event.message for event in run.events if event.kind == "phase"]
    words = [phases[0].split(" -> ")[0], *(phase.split(" -> ")[1] for phase in phases)]
    assert words == [
        "connecting",
        "checking",
        "calibrating",
        "idle_current",
        "settling",
        "countdown",
        "running",
        "stopping",
        "done",
    ]


def test_the_start_is_logged_and_the_current_of_the_run_is_none_at_rest():
    run = running()
    run.until("done")
    assert run.state.prepared.start == pytest.approx((1.0, 0.5, 0.1), abs=1e-3)
    assert run.state.idle.mean == pytest.approx(1.18)
    assert any("p_y(0) = 0.5000 m" in event.message for event in run.events)


def references(run, generator: Generator, gait: lc.Gait):
    """Every sample of 80 ticks of a run, with the state in which the generator, stepped along, is at its time."""
    begun = run.state.begun
    assert begun is not None
    run.tick(80)
    state = generator.init(gait)
    for sample in run.samples:
        if isinstance(sample, ReferenceSample) and sample.time > begun + 1e-9:
            state = generator.step(state, gait, sample.time - begun - state.time)
            yield sample, state


def test_the_references_of_the_run_are_those_of_the_one_generator():
    generator = Generator(n_links=9, bandwidth=25.0, ramp=3.0)
    for sample, state in references(running(following=None, rate=100.0), generator, GAIT):
        assert sample.angle == pytest.approx(generator.joints(state, GAIT)[0], abs=1e-12)


def test_the_sync_comes_last_and_the_references_before_it():
    run = running()
    kinds = [type(message) for message in run.outputs.messages]
    assert kinds == [References, References, Sync]
    assert [m.group for m in run.outputs.messages if isinstance(m, References)] == [0, 1]


def test_path_following_steers_towards_the_path():
    run = running(duration=30.0)
    run.tick(150)
    signals = run.operator.reference_source.signals(run.state.reference)
    assert signals["cross_track_error"] > 0.4
    assert signals["offset"] < 0.0


def test_pitch_joints_get_the_references_of_the_gaits_second_wave():
    gait = replace(
        GAIT, pitch=lc.Wave(amplitude=0.1, frequency=2.0, phase_shift=0.6, phase=1.5, offset=0.02)
    )
    run = running(robot="mamba-modules", gait=gait, following=None, rate=100.0)
    begun = run.state.begun
    assert begun is not None
    run.tick(80)
    samples = [s for s in run.samples if isinstance(s, ReferenceSample) and s.time > begun + 1e-9]
    axes = tuple(joint.axis for joint in lc.load_robot("mamba-modules").joints)
    generator = Generator(n_links=19, axes=axes, bandwidth=25.0, ramp=3.0)
    state = generator.init(gait)
    for sample in samples:
        state = generator.step(state, gait, sample.time - begun - state.time)
        assert sample.angle == pytest.approx(generator.joints(state, gait)[0], abs=1e-12)
    assert np.abs(samples[-1].angle[1::2]).max() > 1e-3


DRIVEN_FIN = """
kind = "robot"
extends = "mamba-fin"
name = "mamba-driven"

[caudal_fin.joint]
limit_deg = 90
"""


def test_a_driven_fin_is_the_node_behind_the_last_joint_and_follows_its_wave(tmp_path):
    (tmp_path / "driven.toml").write_text(DRIVEN_FIN)
    gait = replace(GAIT, fin=lc.Wave(amplitude=0.4, frequency=2.0, phase=0.2, offset=0.02))
    generator = Generator(n_links=9, bandwidth=25.0, ramp=3.0)
    run = running(robot=str(tmp_path / "driven.toml"), gait=gait, following=None, rate=100.0)
    samples = []
    for sample, state in references(run, generator, gait):
        samples.append(sample)
        assert sample.angle[8] == pytest.approx(generator.fin(state, gait)[0], abs=1e-12)
        assert sample.angle[:8] == pytest.approx(generator.joints(state, gait)[0], abs=1e-12)
    assert abs(samples[-1].angle[8]) > 0.03
    groups = [m for m in run.outputs.messages if isinstance(m, References)]
    assert [m.group for m in groups] == [0, 1, 2]
    assert groups[2].angles == (pytest.approx(run.state.reference.references[8]), 0.0, 0.0, 0.0)
    run.until("done")
    assert run.rig.angle[8] == pytest.approx(0.0, abs=0.07)


def test_a_robot_whose_fins_module_is_silent_is_not_operated(tmp_path):
    (tmp_path / "driven.toml").write_text(DRIVEN_FIN)
    run = run_of(Operator(operation=operation(robot=str(tmp_path / "driven.toml"))))
    run.rig.dead = {8}
    run.until("done")
    assert "Module 9 does not respond" in run.state.failure


def test_without_a_pitch_wave_pitch_joints_are_held_at_zero():
    run = running(robot="mamba-modules")
    run.tick(50)
    asked = run.state.reference.references
    assert asked.size == 18
    assert np.all(asked[1::2] == 0.0)
    assert np.any(asked[::2] != 0.0)


def test_the_clocks_are_matched_and_the_path_frame_is_placed_in_the_tank():
    run = run_of(
        Operator(operation=operation(tank=CaptureVolume(path_origin=(0.5, 0.2), path_heading=0.3)))
    )
    run.until("countdown")
    assert run.state.clock is not None and run.state.clock.offset == pytest.approx(CAMERAS_AHEAD)
    x, y, heading = run.state.prepared.start or (0, 0, 0)
    tank = run.operator.operation.tank
    assert tank.to_tank(np.array([x, y])) == pytest.approx([1.0, 0.5], abs=1e-3)
    assert heading == pytest.approx(0.1 - 0.3, abs=1e-3)


def test_a_marker_body_that_sits_askew_is_calibrated_from_the_straight_robot():
    run = run_of(Operator(operation=operation(calibration=replace(QUICK, straight_heading=0.1))))
    run.rig._frame = turned_frame(run.rig, 0.4)  # type: ignore[method-assign]
    run.until("countdown")
    assert run.state.prepared.marker_turned == pytest.approx(0.4, abs=1e-6)
    assert run.state.prepared.start == pytest.approx((1.0, 0.5, 0.1), abs=1e-3)


def turned_frame(rig: Rig, yaw: float):
    plain = rig._frame

    def frame():
        seen = plain()
        c, s = math.cos(yaw), math.sin(yaw)
        assert seen.rotation is not None
        return replace(
            seen, rotation=seen.rotation @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
        )

    return frame


def test_where_the_robot_lies_is_not_what_a_late_computer_guesses_over_the_gap():
    run = run_of(Operator(operation=operation()))
    while run.state.phase != "settling" or len(run.state.prepared.recent_poses) < 5:
        run.tick()
    guess = replace(run.state, estimate=replace(run.state.estimate, heading=0.5))
    period, now = 1.0 / run.operator.operation.rate, run.state.now
    punctual, _ = preparing.step(run.operator.operation, guess, now + 1.5 * period)
    late, _ = preparing.step(run.operator.operation, guess, now + 2.5 * period)
    assert punctual.prepared.recent_poses[-1].heading == 0.5
    assert late.prepared.recent_poses == run.state.prepared.recent_poses


def test_joint_zeros_are_sent_to_the_modules_when_the_robot_lies_straight():
    run = run_of(Operator(operation=operation(calibration=replace(QUICK, joint_zeros=True))))
    run.rig.angle[:] = 0.03
    told = []
    while run.state.phase != "settling":
        run.tick()
        told += [m for m in run.outputs.messages if isinstance(m, NodeCommand)]
    run.tick(5)
    told += [m for m in run.outputs.messages if isinstance(m, NodeCommand)]
    assert NodeCommand(order=Order.SET_ZERO) in told
    bent = run_of(Operator(operation=operation(calibration=replace(QUICK, joint_zeros=True))))
    bent.rig.angle[2] = 0.3
    bent.until("done")
    assert "module 3 reports 17.2 deg" in bent.state.failure
    assert bent.rig.is_limp


# ---- what speaks against a run -------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rig", "message"),
    [
        (
            {"dead": {4}},
            r"Module 5 does not respond on udp_multicast:.*check power, cable and node",
        ),
        ({"hears": False}, r"No module responds"),
        ({"sees": False}, r"The motion capture at 127\.0\.0\.1:22223 does not see a body"),
        (
            {"measures": False},
            r"The power meter at there is silent: check that it is on and connected",
        ),
        ({"leak": {2}}, r"Module 3 reports water inside: take the robot out"),
        ({"temperature": 80.0}, r"Module 1 is at 80 degC, limit 70: let it cool"),
    ],
)
def test_what_is_missing_or_wrong_is_said_and_the_robot_stays_limp(rig, message):
    run = run_of(Operator(operation=operation()), **rig)
    run.until("done")
    import re

    assert re.match(message, run.state.failure), run.state.failure
    assert not any(isinstance(s, ReferenceSample) for s in run.samples)


def test_a_module_that_still_calibrates_itself_is_waited_for_but_not_for_ever():
    run = run_of(Operator(operation=operation()))
    run.rig.states[3] = NodeState.CALIBRATING
    run.until("checking")
    run.tick(25)
    assert run.state.phase == "checking"
    run.rig.states[3] = NodeState.READY
    run.until("running")
    run = run_of(Operator(operation=operation()))
    run.rig.states[3] = NodeState.CALIBRATING
    run.until("done")
    assert run.state.failure == "Module 4 is still calibrating: wait, or restart it."
    assert run.rig.is_limp


def test_another_robot_than_that_of_the_file_is_not_started():
    operator = Operator(operation=operation())
    run = Run(
        operator=operator, rig=Rig(robot=lc.load_robot("mamba-modules")), state=operator.init()
    )
    run.until("done")
    assert run.state.failure == "Module 18 responds, but the robot has 8: check `robot`."
    assert run.rig.is_limp


def test_a_robot_that_lies_elsewhere_is_not_started():
    run = run_of(Operator(operation=operation(start=Placement(position=(0.0, 1.7), heading=0.1))))
    run.until("done")
    assert "put it at (0.00, 1.70) m, heading 6 deg" in run.state.failure
    assert run.rig.is_limp


def test_a_check_only_moves_nothing():
    run = run_of(Operator(operation=operation(), check_only=True))
    run.until("done")
    assert run.state.failure == ""
    assert not any(isinstance(s, ReferenceSample) for s in run.samples)


def test_faults_that_somebody_has_looked_at_are_cleared_first():
    fault = [NodeState.FAULT] * 8
    run = run_of(Operator(operation=operation()))
    run.rig.states = list(fault)
    run.until("done")
    assert "is in its fault state" in run.state.failure
    run = run_of(Operator(operation=operation(), clears=True))
    run.rig.states = list(fault)
    run.until("running")


# ---- what stops a run ----------------------------------------------------------------------------

SWITCHES = {
    "leak": {"leak": {3}},
    "over_temperature": {"temperature": 90.0},
    "over_current": {"current": 6.0},
    "joint_error": {"stuck": {2}},
    "lost_heartbeat": {"dead": {5}},
    "lost_mocap": {"sees": False},
}


@pytest.mark.parametrize("event", SWITCHES)
def test_what_goes_wrong_in_a_run_stops_it_within_the_stated_time(event):
    run = running(
        duration=30.0, limits=Limits(straighten_time=1.0, joint_error_time=0.3, max_joint_error=0.2)
    )
    run.tick(40)
    for name, value in SWITCHES[event].items():
        setattr(run.rig, name, value)
    while event not in run.log:
        run.tick()
        assert run.rig.time < 20.0, run.log
    seen = run.rig.time
    within = run.operator.supervisor.within(BY_EVENT[event].action)
    while not run.rig.is_limp:
        run.tick()
        assert run.rig.time < seen + 10.0
    assert run.rig.time - seen <= within + 0.1
    run.until("done")
    assert run.state.supervisor.state == "fault"
    assert run.state.begun is not None


def test_the_operators_key_straightens_first():
    run = running(duration=30.0)
    run.tick(
        60,
    )
    run.tick(1, operator_key="by test")
    while not run.state.is_done:
        run.tick(1, operator_key="by test")
    assert run.state.supervisor.state == "idle"
    assert np.max(np.abs(run.rig.angle)) < math.radians(4)
    assert run.rig.is_limp


def test_the_second_key_is_an_emergency_stop_at_that_very_tick():
    run = running(duration=30.0)
    run.tick(40)
    run.tick(2, operator_key="x")
    run.tick(1, operator_key="x", emergency_key="y")
    assert EmergencyStop(reason=1) in run.outputs.messages
    assert not any(isinstance(message, References) for message in run.outputs.messages)


def test_the_run_ends_before_the_edge_of_the_measuring_volume():
    run = running(duration=60.0, tank=CaptureVolume(volume_x=(0.0, 2.0)))
    run.until("done")
    assert "edge" in run.log
    assert run.state.supervisor.state == "idle"
    assert run.rig.position[0] < 2.0


def test_a_late_computer_stops_the_run():
    run = running(duration=30.0)
    run.tick(20)
    for _ in range(10):  # 0.4 s in which the operator does nothing
        run.rig.advance(0.04, ())
    run.tick(2)
    assert "late_loop" in run.log
    run.until("done")
    assert run.rig.is_limp


def test_a_silent_meter_lets_the_run_end_and_is_noted():
    run = running(duration=8.0)
    run.rig.measures = False
    run.until("done")
    assert run.state.supervisor.state == "idle"
    assert run.state.notes and run.state.notes[0].startswith("lost_meter")


def test_a_meter_that_is_silent_since_before_the_run_gives_it_no_power_either():
    run = run_of(Operator(operation=operation(duration=8.0, countdown=6.0)))
    run.until("countdown")
    run.rig.measures = False
    run.until("done")
    assert run.state.supervisor.state == "idle"
    assert run.state.lost_meter
    assert [note.split(":")[0] for note in run.state.notes] == ["lost_meter"]


def test_an_error_of_the_controller_or_of_the_estimation_stops_the_robot_and_not_the_program(
    monkeypatch,
):
    run = running(duration=30.0)

    def broken(*_):
        raise ZeroDivisionError("the controller divides by zero")

    monkeypatch.setattr(type(run.operator.reference_source), "decide", broken)
    run.until("done")
    assert run.state.supervisor.state == "fault"
    assert any("the controller divides by zero" in event.message for event in run.events)
    assert run.rig.is_limp


# ---- torque never returns without a person -------------------------------------------------------


def ticked_until_done(run: Run, patience: float = 30.0) -> None:
    """Tick until the operation is done and has been for a while; no motor comes on that was off."""
    end, was_limp, ticks_after = run.rig.time + patience, set[int](), 0
    while ticks_after < 50:
        was_limp |= {k for k, state in enumerate(run.rig.states) if not state.is_on}
        if run.state.is_done:
            run.rig.advance(0.04, run.outputs.messages)
            ticks_after += 1
        else:
            run.tick()
        returned = {k for k in was_limp if run.rig.states[k].is_on}
        assert not returned, f"torque returned at {run.rig.time:.2f} s: {run.log}"
        assert run.rig.time < end, run.log
    assert run.rig.is_limp


def frozen(run: Run, duration: float) -> None:
    """After what was sent last, nothing is heard of us; modules go limp by themselves if it is long enough."""
    run.rig.advance(0.04, run.outputs.messages)
    run.outputs = Outputs()
    for _ in range(round(duration / 0.04)):
        run.rig.advance(0.04, ())


@pytest.mark.parametrize("duration", [0.3, 0.7, 1.0, 1.3, 2.0, 15.0])
@pytest.mark.parametrize("moment", [0.1, 0.9, 2.3], ids=["at first", "in the run", "at its end"])
def test_after_a_freeze_no_motor_comes_on_that_went_limp(moment, duration):
    run = running(limits=Limits(straighten_time=3.0, max_lateness=20.0, heartbeat_timeout=20.0))
    run.tick(round(moment * 25.0))
    frozen(run, duration)
    ticked_until_done(run)
    if duration > 1.2:
        assert run.state.supervisor.state == "fault"
        assert "went_limp" in run.log


def test_a_freeze_while_motors_are_being_switched_on_does_not_switch_them_on_later():
    run = run_of(Operator(operation=operation(limits=Limits(max_lateness=20.0))))
    while run.state.supervisor.torque != "enable":
        run.tick()
    frozen(run, 1.6)
    assert run.rig.is_limp
    ticked_until_done(run)
    assert run.state.supervisor.cause == "went_limp"


@pytest.mark.parametrize("timeout", [0.5, 20.0])
@pytest.mark.parametrize("duration", [0.2, 0.6, 1.0, 1.3, 1.9, 3.0])
def test_a_cable_that_is_pulled_and_plugged_in_again_brings_no_motor_back(duration, timeout):
    patient = Limits(straighten_time=3.0, heartbeat_timeout=timeout, joint_timeout=timeout)
    run = running(duration=3.0, limits=patient)
    run.tick(20)
    run.rig.hears = False
    run.tick(round(duration * 25.0))
    run.rig.hears = True
    ticked_until_done(run)
    if duration > 1.2:
        assert run.state.supervisor.state == "fault"


@pytest.mark.parametrize("phase", ["settling", "running", "stopping"])
def test_a_module_that_restarts_makes_the_whole_robot_limp_at_once(phase):
    run = run_of(Operator(operation=operation()))
    run.until(phase)
    while phase == "settling" and run.state.supervisor.torque != "hold":
        run.tick()
    run.rig.states[3] = NodeState.STARTUP
    run.tick(4)  # heartbeats come every 0.1 s
    assert "went_limp" in run.log
    assert run.state.supervisor.torque == "off"
    ticked_until_done(run)
    assert run.state.supervisor.state == "fault"


def test_every_request_of_the_table_is_made_in_a_normal_run(monkeypatch):
    made, step = set(), Supervisor.step

    def noted(self, state, now, events, **seen):
        made.update(events)
        return step(self, state, now, events, **seen)

    monkeypatch.setattr(Supervisor, "step", noted)
    running().until("done")
    assert made >= set(REQUESTS)


def test_what_went_limp_moves_again_only_in_a_new_operation_with_all_its_checks():
    run = running(duration=30.0)
    run.rig.states[3] = NodeState.LIMP
    run.until("done")
    assert (run.state.supervisor.state, run.state.supervisor.cause) == ("fault", "went_limp")
    run.tick(50)  # as long as this program lives
    assert (run.state.supervisor.state, run.rig.is_limp) == ("fault", True)
    anew = Run(operator=run.operator, rig=run.rig, state=run.operator.init())
    anew.until("done")
    phases = [event.message for event in anew.events if event.kind == "phase"]
    assert phases[0] == "connecting -> checking" and "countdown -> running" in phases
    assert anew.state.supervisor.state == "idle"


def test_an_order_to_switch_on_that_is_lost_is_repeated_and_every_one_is_recorded():
    run = run_of(Operator(operation=operation()))
    while run.state.supervisor.torque != "enable":
        run.tick()
    run.rig.hears = False
    run.tick(3)
    run.rig.hears = True
    run.until("done")
    told = [event.message for event in run.events if event.kind == "torque"]
    again = "enable again: module 1, 2, 3, 4, 5, 6, 7, 8 is off"
    assert told == ["off -> enable", again, "enable -> hold", "hold -> off"]


def test_motors_that_say_that_they_are_off_are_told_so_all_the_same_when_torque_ends():
    run = run_of(Operator(operation=operation()))
    run.rig.lazy = set(range(8))
    while run.state.supervisor.torque != "enable":
        run.tick()
    while run.state.supervisor.torque != "off":
        run.tick()
    assert NodeCommand(order=Order.DISABLE) in run.outputs.messages


def test_a_run_waits_for_the_last_motor_and_is_given_up_without_it():
    run = run_of(Operator(operation=operation()))
    run.rig.lazy = {6}
    run.until("done")
    assert run.state.begun is None
    assert "module_fault" in run.log
    assert run.rig.is_limp


@settings(max_examples=5)
@given(
    st.lists(st.sampled_from([*SWITCHES, "hears", "tick"]), min_size=1, max_size=4),
    st.integers(0, 75),
)
def test_whatever_goes_wrong_whenever_the_robot_ends_limp_and_no_exception_comes_out(wrong, first):
    run = run_of(
        Operator(operation=operation(duration=3.0, calibration=replace(QUICK, patience=5.0)))
    )
    run.tick(first)
    for event in wrong:
        for name, value in SWITCHES.get(
            event, {"hears": False} if event == "hears" else {}
        ).items():
            setattr(run.rig, name, value)
        run.tick(10)
    while not run.state.is_done:
        run.tick()
        assert run.rig.time < 40.0, (run.state.phase, run.log)
    for _ in range(50):
        run.rig.advance(0.04, ())
    assert run.rig.is_limp
