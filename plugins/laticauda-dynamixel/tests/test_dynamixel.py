"""The driver and the vendor's own client, at the same emulator."""

import math
import struct
from dataclasses import replace
from pathlib import Path

import pytest
from patience import complaints, until
from trials import run_trial

import laticauda as lc
from laticauda.tank import lab
from laticauda.tank.operate.drivers import Clock, DeviceFailed, contract, driver_named
from laticauda.tank.protocol import (
    Heartbeat,
    JointState,
    NodeCommand,
    NodeState,
    Order,
    encode_references,
)
from laticauda_dynamixel.emulator import Servos, tank_of_servos
from laticauda_dynamixel.packets import MIDDLE, OVERHEATING, TRIPPED, Register

N = 8


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    """A driver and servos that wait longer for a computer that is busy with other tests."""
    longer_times = {
        "HOLD_AFTER": 1.5,
        "LIMP_AFTER": 2.5,
        "WATCHDOG": 100,
        "ANSWER_TIME": 2.0,
        "PING_TIME": 6.0,
        "SILENCE": 1.0,
    }
    for name, longer_time in longer_times.items():
        monkeypatch.setattr(f"laticauda_dynamixel.driver.{name}", longer_time)


@pytest.fixture
def servos():
    """A tank whose modules are servos, with time going on."""
    tank = tank_of_servos()
    servos = Servos(len(tank.nodes))
    servos.lab = lab.Lab(tank, bus=servos, port=0)
    with servos.lab:
        yield servos


def open_driver(servos):
    driver_class = driver_named("bus", "dynamixel", servos.path)
    return driver_class(servos.path, Clock())


def heartbeats_once(driver, condition, messages=()) -> dict[int, Heartbeat]:
    """The last heartbeats of all servos, once a condition on them holds."""
    heartbeats: dict[int, Heartbeat] = {}

    def do_they_meet_it() -> bool:
        heard, _ = contract.listen(driver, driver._clock, 0.1, messages=messages)
        for item in heard:
            if isinstance(item.value, Heartbeat):
                heartbeats[item.value.node] = item.value
        return len(heartbeats) == N and condition(heartbeats)

    until(do_they_meet_it)
    return heartbeats


def angles(driver) -> dict[int, float]:
    """The last angles that the servos told."""
    heard, _ = contract.listen(driver, driver._clock, 0.1)
    states = [item.value for item in heard if isinstance(item.value, JointState)]
    return {state.node: state.angle for state in states}


ENABLE = NodeCommand(order=Order.ENABLE)


def test_it_keeps_the_contract(servos, monkeypatch):
    problems = complaints(
        monkeypatch,
        "bus",
        f"dynamixel@{servos.path}",
        absent="dynamixel@/dev/nothing",
        duration=1.0,
        moves=True,
    )
    assert problems == ()


def test_servos_go_where_references_say_and_are_limp_after_close(servos):
    with open_driver(servos) as driver:

        def are_there(_) -> bool:
            truth = servos.lab.call(lambda tank: tank.truth.joint_angle)
            return bool(max(abs(truth - 0.1)) < 0.03)

        heartbeats_once(driver, are_there, messages=(ENABLE, *encode_references([0.1] * N)))

    def is_any_on() -> bool:
        return servos.lab.call(lambda tank: any(node.is_on for node in tank.nodes))

    until(lambda: not is_any_on())


def test_servos_stop_by_themselves_where_the_program_dies(servos):
    with open_driver(servos) as driver:
        heartbeats_once(
            driver,
            lambda heartbeats: heartbeats[1].state.is_on,
            messages=(ENABLE, *encode_references([0.2] * N)),
        )
        driver._ended.set()  # its thread is no more
        driver._thread.join()
        tables = servos.tables.values()
        until(lambda: {table[Register.BUS_WATCHDOG] for table in tables} == {TRIPPED})
        driver._port.close()


def test_an_error_of_the_hardware_is_a_fault_until_it_is_cleared_by_a_reboot(servos):
    with open_driver(servos) as driver:
        servos.tables[3][Register.HARDWARE_ERROR] = OVERHEATING
        heartbeats = heartbeats_once(
            driver,
            lambda heartbeats: heartbeats[3].state == NodeState.FAULT and heartbeats[2].state.is_on,
            messages=(ENABLE, *encode_references([0.0] * N)),
        )
        assert heartbeats[3].over_temperature
        driver.send((NodeCommand(order=Order.CLEAR),))
        heartbeats_once(driver, lambda heartbeats: heartbeats[3].state == NodeState.READY)


def test_a_zero_that_is_set_counts(servos):
    with open_driver(servos) as driver:
        until(lambda: len(angles(driver)) == N)
        driver.send((NodeCommand(order=Order.SET_ZERO, node=2, angle=0.3),))
        until(lambda: angles(driver).get(2) == pytest.approx(0.3, abs=0.03))
        until(lambda: 1 in angles(driver))  # answers of all servos come one by one
        assert angles(driver)[1] == pytest.approx(0.0, abs=0.03)


def test_what_is_not_as_it_must_be_is_refused_with_what_to_check(servos):
    servos.tables[2][Register.OPERATING_MODE] = 1
    with pytest.raises(DeviceFailed, match=r"Servos \[2\] must be in a position-control mode"):
        open_driver(servos)
    servos.tables[9] = servos.tables.pop(2)
    with pytest.raises(DeviceFailed, match=r"be numbered 1, 2, ... from the tail on, got \[1, 3"):
        open_driver(servos)
    servos.tables.clear()
    with pytest.raises(
        DeviceFailed, match=r"No servo answers at .*check power and cable, and that the baud rate"
    ):
        open_driver(servos)
    with pytest.raises(
        ValueError, match="`bus_address` must be PORT or PORT:BAUD_RATE, got '/dev/x:fast'"
    ):
        driver_named("bus", "dynamixel", "/dev/x:fast")


def test_the_vendors_own_client_reads_and_writes_the_emulator(servos, monkeypatch):
    sdk = pytest.importorskip(
        "dynamixel_sdk", reason="the vendor's client is not installed: pip install dynamixel-sdk"
    )
    monkeypatch.setattr(
        sdk.port_handler, "LATENCY_TIMER", 1000
    )  # it waits 34 ms for an answer: not on a busy computer
    port, handler = sdk.PortHandler(servos.path), sdk.PacketHandler(2.0)
    assert port.openPort()
    try:
        assert port.setBaudRate(1_000_000)
        answers, result = handler.broadcastPing(port)
        assert result == sdk.COMM_SUCCESS
        assert sorted(answers) == list(range(1, N + 1))
        assert handler.ping(port, 1)[:2] == (1020, sdk.COMM_SUCCESS)
        assert handler.write1ByteTxRx(port, 1, Register.TORQUE_ENABLE, 1) == (sdk.COMM_SUCCESS, 0)
        goals = sdk.GroupSyncWrite(port, handler, Register.GOAL_POSITION, 4)
        assert all(goals.addParam(number, struct.pack("<i", MIDDLE + 100)) for number in (1, 2))
        assert goals.txPacket() == sdk.COMM_SUCCESS
        sync = sdk.GroupSyncRead(port, handler, Register.PRESENT_POSITION, 4)
        bulk = sdk.GroupBulkRead(port, handler)
        for number in (1, 2):
            assert sync.addParam(number)
            assert bulk.addParam(number, Register.PRESENT_VOLTAGE, 3)

        def has_moved() -> bool:
            assert sync.txRxPacket() == sdk.COMM_SUCCESS
            return sync.getData(1, Register.PRESENT_POSITION, 4) == pytest.approx(
                MIDDLE + 100, abs=25
            )

        until(has_moved)
        assert sync.getData(2, Register.PRESENT_POSITION, 4) < MIDDLE + 50, "its torque is off"
        assert bulk.txRxPacket() == sdk.COMM_SUCCESS
        assert bulk.getData(2, Register.PRESENT_VOLTAGE, 2) == pytest.approx(350, abs=5)
    finally:
        port.closePort()


def test_a_whole_trial_runs_over_it(tmp_path: Path, monkeypatch):
    # A computer that is busy with other tests is late.
    monkeypatch.setattr("laticauda_dynamixel.driver.WATCHDOG", 0)
    monkeypatch.setattr("laticauda_dynamixel.driver.HOLD_AFTER", 100.0)
    monkeypatch.setattr("laticauda_dynamixel.driver.LIMP_AFTER", 100.0)
    monkeypatch.setattr("laticauda.tank.operate.safety.limits.SPIN_UP", 15.0)
    tank = tank_of_servos()
    for node in tank.nodes:  # references that are late jump, and jumps take current
        node.settings = replace(node.settings, current_limit=100.0, stuck_time=100.0)
    servos = Servos(len(tank.nodes))
    result = run_trial(lab.Lab(tank, bus=servos, port=0), tmp_path, bus=f"dynamixel@{servos.path}")
    assert result.accepted, result.reason
    trial = lc.load_trial(tmp_path / "whole.nc")
    assert trial.forward_velocity > 0.0
    assert math.radians(10) < abs(trial.joint_angle).max() < math.radians(40)
