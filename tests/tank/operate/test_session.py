"""Operator and virtual tank on real wires: a CAN bus, the vendor's motion-capture client, a serial line, threads."""

import itertools
import json
import math
import os
import signal
import subprocess
import sys
import threading
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

import laticauda as lc
from laticauda.control import Following
from laticauda.control.estimation import Learned, Learning
from laticauda.robot import Current
from laticauda.tank.lab import Fault, Lab, LabSettings, NodeSettings, Tank, VirtualRobot
from laticauda.tank.operate import Event, recorded_verdict_summary, rerun_learner
from laticauda.tank.operate.drivers import Clock, DeviceFailed
from laticauda.tank.operate.loop import run_loop
from laticauda.tank.operate.procedure.operator import Operator
from laticauda.tank.operate.procedure.state import OperatorState
from laticauda.tank.operate.recording.log import read_operation
from laticauda.tank.operate.recording.recorder import OperationRecorder, Sink
from laticauda.tank.operate.recording.to_trial import trial_of
from laticauda.tank.operate.series import run_series
from laticauda.tank.operate.session import format_summary, header_of, operate, result_of
from laticauda.tank.operate.settings import (
    Acceptance,
    Calibration,
    CaptureVolume,
    Connection,
    Limits,
    Operation,
    SeriesFile,
)
from laticauda.tank.operate.tank_devices import TankDevices, TankTime
from laticauda.tank.operate.terminal import Keys, print_events
from laticauda.tank.protocol import NodeState, bus_address
from laticauda.water.fluid.waves import Sea

GAIT = lc.lateral_undulation(
    amplitude=math.radians(20), frequency=math.radians(90), phase_shift=math.radians(40)
)
SLOW = Calibration(joint_zeros=True, idle_time=1.0, still_time=0.5)
ON = (NodeState.ACTIVE, NodeState.HOLD)
# A computer that is busy with other tests is late; that is not what is tested here.
PATIENT = Limits(
    straighten_time=1.0,
    max_lateness=2.0,
    joint_timeout=3.0,
    heartbeat_timeout=3.0,
    mocap_timeout=5.0,
)
WAITING = {"hold_after": 3.0, "limp_after": 4.0}  # modules that bear it, too [s]


def operation(**changes) -> Operation:
    usual = Operation(
        name="session",
        gait=GAIT,
        following=Following(),
        duration=2.0,
        rate=50.0,
        countdown=0.1,
        tank=CaptureVolume(volume_x=(-1.0, 11.0)),
        connection=Connection(meter_address="stepped"),
        supply_voltage=35.0,
        calibration=Calibration(joint_zeros=True, idle_time=0.5, still_time=0.5),
        limits=PATIENT,
    )
    return replace(usual, **changes)


def tank(*faults: Fault, current: Current = (0.0, 0.0), **nodes: float) -> Tank:
    robot, water = lc.load_robot("mamba"), replace(lc.load_water("paper-lateral"), current=current)
    world = VirtualRobot(robot, lc.build_plant(robot, water, joints="servo"))
    usual = NodeSettings(startup_time=0.2, calibration_time=0.2)
    return Tank(world, LabSettings(seed=1, nodes=replace(usual, **nodes)), faults)


def stepped(operator: Operator, tank: Tank, **how) -> OperatorState:
    """Operate a tank without wires until it is done: the last state."""
    return run_loop(operator, TankDevices(tank), longest=600.0, **how)[0]


def is_limp(tank: Tank) -> bool:
    return not any(node.state in ON for node in tank.nodes)


def at(addresses, channel: str) -> Connection:
    return Connection(
        bus_address=f"virtual:{channel}",
        mocap_address=f"{addresses.mocap_host}:{addresses.mocap_port}",
        meter_address=addresses.meter,
    )


# ---- on wires ------------------------------------------------------------------------------------


def test_an_operation_over_wires_ends_as_a_trial_with_both_powers(tmp_path: Path):
    threads = set(threading.enumerate())
    lab = Lab(tank(**WAITING), bus=bus_address("virtual:session-a"), port=0)
    with lab as addresses:
        # On a busy computer, cameras answer late, and modules.
        patient = Acceptance(pose_age=3.0, longest_silence=3.0, missing_in_run=0.9)
        what = operation(
            connection=at(addresses, "session-a"), rate=20.0, calibration=SLOW, acceptance=patient
        )
        result = operate(what, tmp_path, clock=Clock())
        assert lab.call(is_limp)
    assert result.accepted, result.reason
    assert result.trial is not None
    assert lc.load_trial(tmp_path / "session.nc").equals(result.trial)
    summary = json.loads(json.dumps(result.summary()))
    tick = (
        1.0 / 20.0
    )  # by which the first and the last estimate may each be inside the run, and ticks are not exact
    assert 2.0 - 3.0 * tick <= summary["duration"] < 2.0 + tick + PATIENT.max_lateness
    assert summary["total_power"] - summary["electrical_power"] == pytest.approx(
        35 * summary["idle_current"]
    )
    assert summary["idle_current"] == pytest.approx(1.18, abs=0.05)
    assert summary["timing"]["ticks"] > 50
    assert read_operation(tmp_path / "session.mcap").timing.summary() == result.timing.summary()
    assert "forward velocity (5)" in format_summary(summary)
    assert {thread.name for thread in threading.enumerate() if thread not in threads} == set()


def test_ctrl_c_straightens_and_stops_the_robot(tmp_path: Path):
    lab = Lab(tank(**WAITING), bus=bus_address("virtual:session-b"), port=0)
    keys, pressed = Keys(), []

    def show(state, outputs):
        if state.begun is not None and state.now - state.begun > 0.5 and not pressed:
            pressed.append(True)
            os.kill(os.getpid(), signal.SIGINT)

    with lab as addresses, keys:
        what = operation(
            connection=at(addresses, "session-b"), rate=20.0, calibration=SLOW, duration=30.0
        )
        what = replace(what, limits=replace(PATIENT, straighten_time=4.0))
        result = operate(what, tmp_path, clock=Clock(), keys=keys, show=show)
        assert lab.call(is_limp)
        assert lab.call(lambda tank: abs(tank.truth.joint_angle).max()) < math.radians(6)
    assert not result.accepted
    assert result.reason == "The run was ended: the operator stopped the run."


def test_devices_that_are_not_there_are_named_and_nothing_is_left_open(tmp_path: Path):
    threads = set(threading.enumerate())
    what = operation(connection=Connection(bus_address="virtual:x", mocap_address="127.0.0.1:1"))
    with pytest.raises(DeviceFailed, match=r"motion capture at 127\.0\.0\.1:1 cannot be reached"):
        operate(what, tmp_path)
    assert set(threading.enumerate()) <= threads


PROGRAM = [sys.executable, "-c", "from laticauda.cli import main; raise SystemExit(main())"]


def test_a_killed_operator_leaves_a_robot_that_stops_by_itself(tmp_path: Path):
    group = f"239.74.163.{10 + os.getpid() % 200}"
    bus = f"udp_multicast:{group}:43231"
    words = ["lab", "--json", "--robot", "mamba", "--bus", bus, "--port", "0"]
    lab = subprocess.Popen(
        [*PROGRAM, *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    file = tmp_path / "trial.toml"
    file.write_text(
        'kind = "trial"\nname = "killed"\nduration = 60\nsupply_voltage = 35\nrate = 20\ncountdown = 0\n'
        "[gait]\namplitude_deg = 20\nfrequency_deg_s = 90\nphase_shift_deg = 40\n"
        "[calibration]\nidle_time = 0.2\nstill_time = 0.2\n"
        "joint_zeros = true\n[limits]\nmax_lateness = 3\njoint_timeout = 3\nheartbeat_timeout = 3\nmocap_timeout = 5\n"
        "[tank]\nvolume_x = [-1, 11]\n"
    )
    operator = None
    try:
        assert lab.stdout is not None
        where = json.loads(lab.stdout.readline())
        words = ["operate", str(file), "--no-dashboard", "--output", str(tmp_path), "--bus", bus]
        words += ["--mocap", where["qtm"], "--meter", where["meter"]]
        operator = subprocess.Popen([*PROGRAM, *words], stderr=subprocess.PIPE, text=True)
        assert operator.stderr is not None
        line = ""
        while "the run begins" not in line:
            line = operator.stderr.readline()
            assert line, "the operator ended before the run"
        states = watched(bus, until=lambda states: set(states.values()) == {NodeState.ACTIVE})
        assert len(states) == 8
        operator.send_signal(signal.SIGKILL)
        operator.wait(10)
        states = watched(
            bus, until=lambda states: not any(state in ON for state in states.values())
        )
        assert set(states.values()) == {NodeState.LIMP}
    finally:
        for process in (operator, lab):
            if process is not None:
                process.kill()
                process.wait(10)
                for pipe in (process.stdin, process.stdout, process.stderr):
                    if pipe is not None:
                        pipe.close()
    log = read_operation(tmp_path / "killed.mcap")
    assert any(event.kind == "start" for event in log.of(Event))


def watched(bus: str, until) -> dict[int, NodeState]:
    """The states of the modules by their heartbeats, once all are known and as is waited for."""
    from laticauda.tank.protocol import Heartbeat, from_frame, open_bus

    states: dict[int, NodeState] = {}
    end = time.monotonic() + 20.0
    with open_bus(bus_address(bus)) as listener:
        while time.monotonic() < end and not (len(states) == 8 and until(states)):
            frame = listener.recv(0.1)
            message = None if frame is None else from_frame(frame)
            if isinstance(message, Heartbeat):
                states[message.node] = message.state
    return states


# ---- without wires -------------------------------------------------------------------------------


def test_the_recording_of_a_stepped_operation_gives_the_same_estimates_and_commands_again(
    tmp_path: Path,
):
    from laticauda.control.estimation import Estimate
    from laticauda.tank.operate import rerun_controller, rerun_estimator

    operator = Operator(operation=operation(duration=1.0))
    path = tmp_path / "a.mcap"
    with OperationRecorder(path, header_of(operator)) as recorder:
        state = stepped(operator, tank(), sink=Sink(recorder))
    result = result_of(operator, state, path, None)
    assert result.accepted, result.reason
    log = read_operation(path)
    again = rerun_estimator(log)
    recorded = log.of(Estimate)
    assert len(again) == len(recorded) > 50
    assert all(
        (a.center_of_mass == b.center_of_mass).all() for a, b in zip(again, recorded, strict=True)
    )
    assert rerun_controller(log).n_different == 0


@pytest.mark.parametrize("rate", [20.0, 30.0])
def test_a_good_run_is_accepted_where_joints_end_their_steps_before_their_rates_are_asked_for(
    tmp_path: Path, rate
):
    """With few ticks per second a joint with little load has come to rest when it answers: its rate says too little."""
    what = operation(
        rate=rate,
        duration=4.0,
        following=None,
        calibration=Calibration(idle_time=0.5, still_time=2.0),
    )
    fine = tank()
    fine = Tank(fine.body, replace(fine.settings, step=0.002))
    result = operate(what, tmp_path, tank=fine, frames=False)
    assert result.verdict is not None
    share = {one.name: one.share for one in result.verdict.checks}["angle_jump"]
    assert result.accepted and share is not None and share < 0.5


@pytest.mark.parametrize("angle_jump", [math.radians(3.0), 1e-6], ids=["accepted", "rejected"])
def test_the_trial_is_that_of_the_complete_recording_and_its_check_is_announced(
    tmp_path: Path, angle_jump: float
):
    told = []
    what = operation(acceptance=Acceptance(angle_jump=angle_jump), duration=3.0, following=None)
    result = operate(
        what, tmp_path, tank=tank(), show=lambda state, outputs: told.extend(outputs.events)
    )
    assert result.trial is not None and result.accepted == result.trial.succeeded == (
        angle_jump > 1e-3
    )
    assert result.trial.equals(trial_of(read_operation(result.recording)))
    assert [(event.kind, event.message) for event in told][-1] == (
        "checking",
        "the run, from its recording",
    )


LEARNING = {
    "gait": lc.lateral_undulation(
        amplitude=math.radians(25), frequency=math.radians(180), phase_shift=math.radians(40)
    ),
    "following": None,
    "duration": 9.5,
    "estimator": "kinematics",
    "learning": Learning(unknown=("normal_drag",), window=20.0),
}


def test_what_is_learnt_meanwhile_is_shown_recorded_and_learnt_again_from_the_recording(
    tmp_path: Path, capsys
):
    what = operation(**LEARNING)
    model = lc.build_plant(what.body(), what.pool(), joints="servo")
    swum = tank(current=(0.007, 0.0))
    result = operate(what, tmp_path, tank=swum, twin=model, show=print_events, frames=False)
    assert result.accepted, result.reason
    log = read_operation(tmp_path / "session.mcap")
    found = log.of(Learned)
    assert [two.time - one.time for one, two in itertools.pairwise(found)] == pytest.approx(
        [1.0] * (len(found) - 1)
    )
    last = found[-1]
    assert list(last.value) == ["normal_drag", "play", "crab", "current_x", "current_y"]
    assert last.value["current_x"] == pytest.approx(0.007, abs=0.006)
    assert last.value["normal_drag"] == pytest.approx(what.pool().normal_drag, rel=0.2)
    assert last.deviation["normal_drag"] < 0.15 * last.value["normal_drag"]
    assert rerun_learner(log, lc.build_plant) == found
    assert capsys.readouterr().err.count("learned       normal drag") == len(found)
    assert f"  learned: {last.line}" in format_summary(result.summary())
    assert lc.load_trial(tmp_path / "session.nc").settings["learned"] == last.line


def test_nothing_is_learnt_unless_it_is_asked_for_and_never_without_a_model(tmp_path: Path):
    assert operation().learning is None
    with pytest.raises(ValueError, match="`twin` must be given with `learning`, got None"):
        operate(operation(**LEARNING), tmp_path, tank=tank())
    assert not list(tmp_path.iterdir())


@dataclass(frozen=True, kw_only=True, eq=False)
class Failing(Operator):
    """An operator whose tick has an error for some time."""

    fails: tuple[float, float]

    def tick(self, state, now, inputs):
        if self.fails[0] <= now < self.fails[1]:
            raise ZeroDivisionError("a slip")
        return super().tick(state, now, inputs)


def test_one_error_of_the_tick_stops_the_robot_and_not_the_program():
    swum = tank()
    state = stepped(Failing(operation=operation(duration=20.0), fails=(6.0, 6.01)), swum)
    assert state.begun is not None
    assert state.begun < 6.0
    assert state.stopped_by == "program_error"
    assert is_limp(swum)


def test_an_error_at_every_tick_gives_up_with_an_emergency_stop():
    swum = tank()
    with pytest.raises(
        RuntimeError, match="aborted with an emergency stop: ZeroDivisionError: a slip"
    ):
        stepped(Failing(operation=operation(duration=20.0), fails=(6.0, math.inf)), swum)
    assert {node.state for node in swum.nodes} == {NodeState.FAULT}


def test_ticks_that_a_computer_missed_are_not_made_up_for():
    class Sleepy(TankTime):
        def wait_until(self, moment):
            super().wait_until(moment + (1.0 if 5.0 <= moment < 5.02 else 0.0))

    swum, ticks = tank(), []
    what = Operator(operation=operation(duration=3.0))
    devices = TankDevices(swum, clock=Sleepy(swum))
    state, timing = run_loop(what, devices, show=lambda state, _: ticks.append(state.now))
    assert state.is_done
    assert timing is None  # a tank's time is never late by itself
    periods = np.diff(ticks)
    assert periods.max() == pytest.approx(1.02)
    assert periods.min() == pytest.approx(0.02)


def test_of_a_long_operation_the_last_ticks_are_kept_in_their_order(
    monkeypatch: pytest.MonkeyPatch,
):
    class Real(TankTime):
        is_real = True

    monkeypatch.setattr("laticauda.tank.operate.loop.MOST_TICKS", 30)
    swum, ticks = tank(), []
    devices = TankDevices(swum, clock=Real(swum))
    what = Operator(operation=operation(duration=1.0))
    _, timing = run_loop(what, devices, show=lambda state, _: ticks.append(state.now))
    assert timing is not None
    assert timing.times[:, 0] == pytest.approx(ticks[-30:])
    assert timing.period == pytest.approx(0.02)


def test_a_full_disk_stops_the_robot(tmp_path: Path):
    operator = Operator(operation=operation(duration=20.0))
    with OperationRecorder(tmp_path / "a.mcap", header_of(operator)) as recorder:
        sink = Sink(recorder)

        def show(state, outputs):
            if state.begun is not None and state.now - state.begun > 0.5:
                sink.trouble = "no space left on device"

        swum = tank()
        state = stepped(operator, swum, sink=sink, show=show)
    assert state.stopped_by == "recorder_failed"
    assert state.supervisor.state == "fault"
    assert is_limp(swum)


def test_the_vendors_faults_of_a_tank_are_seen_for_what_they_are():
    swum = tank(Fault(kind="leak", time=3.5, node=4))
    state = stepped(Operator(operation=operation(duration=10.0)), swum)
    assert state.stopped_by == "leak"
    assert is_limp(swum)


def test_a_servo_that_stalls_while_the_robot_straightens_out_of_a_hard_turn_is_no_fault():
    gait = lc.lateral_undulation(
        amplitude=math.radians(30),
        frequency=math.radians(90),
        phase_shift=math.radians(40),
        offset=math.radians(20),
    )
    turning = operation(
        robot="mamba-fin",
        gait=gait,
        following=None,
        duration=5.0,
        limits=Limits(),
        offset_bandwidth=2.0,
    )
    robot = turning.body()
    swum = Tank(
        VirtualRobot(robot, lc.build_plant(robot, turning.pool(), joints="servo")),
        LabSettings(seed=1),
    )
    stalled, longest = np.zeros(8), 0.0

    def show(state, outputs):
        nonlocal stalled, longest
        stands = (np.abs(swum.electronics.duty) >= 0.9) & (np.abs(swum.truth.joint_rate) < 0.1)
        stalled = np.where(stands, stalled + 0.02, 0.0)
        longest = max(longest, float(stalled.max()))

    state = stepped(Operator(operation=turning), swum, show=show)
    assert longest > 0.5  # as long as a module once took for a jam
    assert state.stopped_by == ""
    assert state.supervisor.state == "idle", state.supervisor.cause
    assert not any(node.flags & {"stuck", "over_current"} for node in swum.nodes)


def test_a_fault_after_the_run_takes_nothing_from_it_and_is_said():
    swum, operator = tank(), Operator(operation=operation(duration=1.0))

    def show(state, outputs):
        if state.ended is not None and not swum.faults.present:
            swum.inject(Fault(kind="over_temperature", time=swum.time, node=4))

    result = result_of(operator, stepped(operator, swum, show=show), None, None)
    assert result.accepted
    assert result.reason == "The run reached its end."
    assert (
        result.aftermath
        == "After the run, a module is too hot. Check the robot, then start with `--clear`."
    )
    assert result.aftermath in format_summary(result.summary())


class Jumping(Tank):
    """A tank whose cameras' clock falls back, once: their computer stood still, and time went on without it."""

    at, by = math.inf, 0.0
    dark = 0.0
    """How long before the jump nothing is sent [s]."""

    def captured(self):
        found = [
            frame
            for frame in super().captured()
            if not self.at - self.dark < frame.timestamp < self.at
        ]
        late = [
            replace(frame, timestamp=frame.timestamp - self.by)
            for frame in found
            if frame.timestamp >= self.at
        ]
        return [frame for frame in found if frame.timestamp < self.at] + late


def jumping(at: float, by: float, dark: float) -> Jumping:
    robot = lc.load_robot("mamba")
    world = VirtualRobot(
        robot, lc.build_plant(robot, lc.load_water("paper-lateral"), joints="servo")
    )
    swum = Jumping(
        world, LabSettings(seed=1, nodes=NodeSettings(startup_time=0.2, calibration_time=0.2))
    )
    swum.at, swum.by, swum.dark = at, by, dark
    return swum


USUAL = Limits(straighten_time=1.0)


def test_a_clock_of_the_cameras_that_jumps_while_the_robot_settles_delays_the_run_and_no_more():
    swum = jumping(2.3, 1.5, dark=0.6)
    state = stepped(Operator(operation=operation(duration=1.0, limits=USUAL)), swum)
    assert state.failure == ""
    assert state.begun is not None
    assert state.begun > 2.3
    assert state.stopped_by == ""


@pytest.mark.parametrize(("dark", "stopped_by"), [(0.6, ""), (2.5, "lost_mocap")])
def test_cameras_that_stand_still_in_a_run_are_bridged_or_stop_it(dark: float, stopped_by: str):
    swum = jumping(8.0, dark, dark=dark)
    gentle = operation(duration=8.0, limits=USUAL, offset_bandwidth=2.0)  # there is no twin
    state = stepped(Operator(operation=gentle), swum)
    assert state.stopped_by == stopped_by
    assert is_limp(swum)
    if not stopped_by:
        assert state.estimate is not None
        away = state.estimate.center_of_mass - swum.truth.center_of_mass[:2]
        assert math.hypot(*away) < 0.05


def test_a_twin_of_the_robot_says_where_it_is_in_the_tank(tmp_path: Path):
    plain = operation(duration=4.0, limits=USUAL)
    swum = tank()
    twin = lc.build_plant(plain.body(), plain.pool(), joints="servo")
    result = operate(plain, tmp_path, tank=swum, twin=twin, frames=False)
    assert result.accepted, result.reason
    assert result.trial is not None
    assert result.recording is not None
    assert read_operation(result.recording).header.twin is not None
    truth = swum.truth.center_of_mass[:2]
    assert (
        np.linalg.norm(result.trial.center_of_mass[-1] - truth) < 0.3
    )  # it coasted while it stopped


def test_a_run_of_the_identified_robot_is_judged_by_its_own_joint_law(tmp_path: Path):
    """By servos, a good run was rejected: "joint error not explained by its servo: 8.61 of 3 deg"."""
    identified = operation(parameters="mamba-identified", following=None, duration=9.0)
    robot, law = identified.body(), identified.joint_law()
    assert isinstance(law, lc.SpeedServo)
    body = lc.build_plant(robot, identified.pool(), joints=law)
    swum = Tank(VirtualRobot(robot, body), LabSettings(seed=1))
    twin = lc.build_plant(robot, identified.pool(), joints=law)
    result = operate(identified, tmp_path, tank=swum, twin=twin, frames=False)
    assert result.accepted, result.reason
    assert result.recording is not None
    log = read_operation(result.recording)
    assert log.header.joint_law == law
    assert log.header.run.robot == robot

    def joint_error_again(recorded):
        entries = tuple(entry for entry in recorded.entries if not is_verdict(entry))
        found = recorded_verdict_summary(replace(recorded, entries=entries), lc.build_plant)
        return next(check["value"] for check in found["checks"] if check["name"] == "joint_error")

    def is_verdict(entry):
        return isinstance(entry, Event) and entry.kind == "verdict"

    own = joint_error_again(log)
    by_servos = joint_error_again(replace(log, header=replace(log.header, joints=None)))
    assert math.degrees(own) < 1.0
    assert by_servos > 3.0 * own


def test_a_driven_fin_swims_in_the_tank_and_follows_its_wave(tmp_path: Path):
    text = 'kind = "robot"\nextends = "mamba-fin"\nname = "driven"\n[caudal_fin.joint]\nlimit_deg = 90\n'
    (tmp_path / "driven.toml").write_text(text)
    robot = lc.load_robot(tmp_path / "driven.toml")
    body = lc.build_plant(robot, lc.load_water("paper-lateral"), joints="servo")
    settings = LabSettings(seed=1, nodes=NodeSettings(startup_time=0.2, calibration_time=0.2))
    tank_ = Tank(VirtualRobot(robot, body), settings)
    assert [node.number for node in tank_.nodes] == list(range(1, 10))
    wave = lc.Wave(amplitude=0.4, frequency=GAIT.frequency, phase=0.7)
    what = operation(
        robot=str(tmp_path / "driven.toml"),
        gait=replace(GAIT, fin=wave),
        following=None,
        duration=8.0,
        ramp=1.0,
    )
    twin = lc.build_plant(robot, lc.load_water("paper-lateral"), joints="servo")
    result = operate(what, tmp_path, tank=tank_, twin=twin, frames=False)
    assert result.accepted, result.reason
    trial, truth = result.trial, tank_.body.trial("0")
    assert trial is not None
    angle, reference = trial.fin_angle[:, 0], trial.signals["fin_angle_ref"]
    late = trial.time > 3.0
    assert np.ptp(reference[late]) == pytest.approx(0.8, abs=0.05)
    assert np.abs(angle - reference)[late].max() < 0.25  # the servo lags
    assert 0.6 < np.ptp(truth.fin_angle[:, 0]) < 0.9
    assert trial.forward_velocity > 0.03
    assert np.linalg.norm(trial.center_of_mass[-1] - tank_.truth.center_of_mass[:2]) < 0.3
    assert lc.load_trial(tmp_path / "session.nc").equals(trial)


def test_the_meter_counts_the_electronics_of_a_robot_that_swims_not_of_one_that_lies_limp(tmp_path):
    swimming = operation(
        robot="mamba-fin",
        parameters="mamba-identified",
        gait=lc.lateral_undulation(
            amplitude=math.radians(30), frequency=math.radians(130), phase_shift=math.radians(40)
        ),
        following=None,
        duration=10.0,
        rate=100.0,
        ramp=1.0,
    )
    robot = swimming.body()
    plant = lc.build_plant(robot, swimming.pool(), joints=swimming.joint_law())
    tank_ = Tank(VirtualRobot(robot, plant), LabSettings(seed=1))
    result = operate(swimming, tmp_path, tank=tank_, twin=plant, frames=False)
    assert result.accepted, result.reason
    assert result.trial is not None
    simulated = lc.swim(
        robot,
        swimming.gait,
        environment=swimming.pool(),
        joints=swimming.joint_law(),
        duration=result.trial.duration,
        ramp=1.0,
    )
    assert result.idle_current == pytest.approx(robot.idle_power / 35.0, rel=0.01)
    assert simulated.electrical_power > 0.9 * robot.active_power > 80.0
    # The meter also counts what the cable takes, some 3 %.
    assert result.trial.electrical_power == pytest.approx(simulated.electrical_power, rel=0.05)
    total = result.summary()["total_power"]
    assert total == pytest.approx(simulated.electrical_power + robot.idle_power, rel=0.05)


SEA = Sea(significant_height=0.05, peak_period=1.2, components=4, seed=1)


def test_in_water_that_moves_a_run_begins_only_if_that_is_allowed_and_is_known_as_well():
    usual = Calibration(joint_zeros=True, idle_time=0.5, still_time=0.5, patience=3.0)
    refused = stepped(
        Operator(operation=operation(calibration=usual)), carried := tank(current=(0.05, 0.03))
    )
    assert "was not still" in refused.failure
    assert is_limp(carried)
    # The filter takes the water's speed for steady. By the moment at which the run begins, it is off
    # by 4 to 10 of its standard deviations of 1.5 mm in the current, and by 1 to 5 in the sea.
    for current, sure in (((0.05, 0.03), 12.0), (SEA, 10.0)):
        check_known(tank(current=current), replace(usual, still_speed=0.1), sure)


def check_known(swum, calibration, sure):
    """A run ends well, and the estimate is where the robot is, within so many standard deviations."""
    state = stepped(Operator(operation=operation(duration=4.0, calibration=calibration)), swum)
    assert not state.failure
    assert not state.stopped_by
    assert is_limp(swum)
    assert state.estimate is not None
    away = state.estimate.center_of_mass - swum.truth.center_of_mass[:2]
    assert math.hypot(*away) < sure * state.estimate.center_of_mass_std < 0.05


def test_modules_that_start_up_slowly_are_waited_for_and_take_their_zeros():
    slow = tank(startup_time=0.2, calibration_time=3.0)
    run_state = stepped(Operator(operation=operation(duration=1.0)), slow)
    assert not run_state.failure and not run_state.stopped_by
    assert not any("not_calibrated" in node.flags for node in slow.nodes)


# ---- a series goes on ----------------------------------------------------------------------------


def series(repeats: int = 2, retries: int = 1) -> SeriesFile:
    return SeriesFile(
        name="goes-on", repeats=repeats, retries=retries, trials=(operation(name="a"),)
    )


def in_the_tank(*faults: Fault):
    return lambda one, folder: operate(one, folder, tank=tank(*faults), frames=False)


def test_a_series_with_a_rejected_run_goes_on_at_the_next_number_and_loses_nothing(tmp_path: Path):
    leak = Fault(kind="leak", time=1.0, duration=60.0, node=3)
    first = run_series(series(repeats=1, retries=0), tmp_path, in_the_tank(leak))
    assert [one.accepted for one in first.settings[0].results] == [False]
    left = {path.name: path.read_bytes() for path in tmp_path.glob("a-1.*")}
    assert "a-1.mcap" in left
    again = run_series(series(repeats=1, retries=0), tmp_path, in_the_tank())
    assert again.is_complete
    assert [one.name for one in again.settings[0].results] == ["a-1", "a-2"]
    assert {path.name: path.read_bytes() for path in tmp_path.glob("a-1.*")}.items() >= left.items()


def test_a_run_whose_program_was_killed_before_its_trial_was_written_counts(tmp_path: Path):
    run_series(series(repeats=1), tmp_path, in_the_tank())
    kept = lc.load_trial(tmp_path / "a-1.nc")
    (tmp_path / "a-1.nc").unlink()  # as if it had been killed between the two files
    again = run_series(series(repeats=2), tmp_path, in_the_tank())
    assert [one.accepted for one in again.settings[0].results] == [True, True]
    np.testing.assert_array_equal(
        lc.load_trial(tmp_path / "a-1.nc").center_of_mass, kept.center_of_mass
    )


def test_a_run_that_was_killed_in_its_midst_is_rejected_and_done_again(tmp_path: Path):
    run_series(series(repeats=1), tmp_path, in_the_tank())
    (tmp_path / "a-1.nc").unlink()
    whole = (tmp_path / "a-1.mcap").read_bytes()
    (tmp_path / "a-1.mcap").write_bytes(whole[: len(whole) // 2])
    again = run_series(series(repeats=1), tmp_path, in_the_tank())
    assert [one.accepted for one in again.settings[0].results] == [False, True]
    assert (tmp_path / "a-1.mcap").read_bytes() == whole[: len(whole) // 2]
    assert "a-1" in again.table()


def test_a_single_run_that_is_repeated_finds_a_name_of_its_own(tmp_path: Path):
    short = operation(name="b", duration=0.3, following=None)
    names = [operate(short, tmp_path, tank=tank(), frames=False).name for _ in range(3)]
    assert names == ["b", "b-2", "b-3"]
    assert sorted(path.name for path in tmp_path.glob("*.mcap")) == [
        "b-2.mcap",
        "b-3.mcap",
        "b.mcap",
    ]
