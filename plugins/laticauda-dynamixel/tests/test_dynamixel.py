"""The driver and the vendor's own client, at the same emulator."""

import math
import struct
import time
from pathlib import Path

import pytest
from trials import swum

import laticauda as lc
from laticauda import lab
from laticauda.operate.drivers import Clock, DeviceFailed, contract, driver_named
from laticauda.protocol import Heartbeat, NodeCommand, NodeState, Order, references
from laticauda_dynamixel.emulator import Servos, tank_of_servos
from laticauda_dynamixel.packets import MIDDLE, OVERHEATING, TRIPPED, Register

N = 8


@pytest.fixture
def servos():
    """A tank whose modules are servos, with time going on."""
    tank = tank_of_servos()
    servos = Servos(len(tank.nodes))
    servos.lab = lab.Lab(tank, bus=servos, port=0)
    with servos.lab:
        yield servos


def made(servos):
    return driver_named("bus", "dynamixel", servos.path)(servos.path, Clock())


def states(driver, **how) -> dict[int, Heartbeat]:
    """The last heartbeats after some time."""
    found, _ = contract.listen(driver, driver._clock, how.pop("duration", 0.4), **how)
    return {one.value.node: one.value for one in found if isinstance(one.value, Heartbeat)}


ON = NodeCommand(order=Order.ENABLE)


def test_it_keeps_the_contract(servos):
    assert (
        contract.broken("bus", f"dynamixel@{servos.path}", absent="dynamixel@/dev/nothing", duration=1, moves=True)
        == ()
    )


def test_servos_go_where_references_say(servos):
    with made(servos) as driver:
        states(driver, messages=(ON, *references([0.1] * N)), duration=1.0)
        assert servos.lab.call(lambda tank: tank.truth.joint_angle) == pytest.approx([0.1] * N, abs=0.03)
    end = time.monotonic() + 3.0
    while (on := servos.lab.call(lambda tank: any(node.is_on for node in tank.nodes))) and time.monotonic() < end:
        time.sleep(0.01)
    assert not on, "limp after `close`"


def test_servos_stop_by_themselves_where_the_program_dies(servos):
    with made(servos) as driver:
        states(driver, messages=(ON, *references([0.2] * N)), duration=0.3)
        driver._ended.set()  # its thread is no more
        driver._thread.join()
        time.sleep(0.8)
        assert {table[Register.BUS_WATCHDOG] for table in servos.tables.values()} == {TRIPPED}
        driver._port.close()


def test_an_error_of_the_hardware_is_a_fault_until_it_is_cleared_by_a_reboot(servos):
    with made(servos) as driver:
        servos.tables[3][Register.HARDWARE_ERROR] = OVERHEATING
        found = states(driver, messages=(ON,))
        assert (found[3].state, found[3].over_temperature) == (NodeState.FAULT, True)
        assert found[2].state.is_on
        driver.send((NodeCommand(order=Order.CLEAR),))
        assert states(driver)[3].state == NodeState.READY


def test_a_zero_that_is_set_counts(servos):
    with made(servos) as driver:
        states(driver)
        driver.send((NodeCommand(order=Order.SET_ZERO, node=2, angle=0.3),))
        found, _ = contract.listen(driver, driver._clock, 0.3)
        angles = {one.value.node: one.value.angle for one in found if hasattr(one.value, "angle")}
        assert (angles[1], angles[2]) == (pytest.approx(0.0, abs=0.03), pytest.approx(0.3, abs=0.03))


def test_what_is_not_as_it_must_be_is_refused_with_what_to_check(servos):
    servos.tables[2][Register.OPERATING_MODE] = 1
    with pytest.raises(DeviceFailed, match=r"Servos \[2\] must be in a mode that controls the position"):
        made(servos)
    servos.tables[9] = servos.tables.pop(2)
    with pytest.raises(DeviceFailed, match=r"the numbers 1, 2, ... from the tail on, got \[1, 3"):
        made(servos)
    servos.tables.clear()
    with pytest.raises(DeviceFailed, match=r"No servo answers at .*check power, cable, and that its baud rate"):
        made(servos)
    with pytest.raises(ValueError, match="`bus_address` must be PORT or PORT:BAUD_RATE, got '/dev/x:fast'"):
        driver_named("bus", "dynamixel", "/dev/x:fast")


def test_the_vendors_own_client_reads_and_writes_the_emulator(servos, monkeypatch):
    sdk = pytest.importorskip("dynamixel_sdk", reason="the vendor's client is not installed: pip install dynamixel-sdk")
    monkeypatch.setattr(sdk.port_handler, "LATENCY_TIMER", 1000)  # it waits 34 ms for an answer: not on a busy computer
    port, handler = sdk.PortHandler(servos.path), sdk.PacketHandler(2.0)
    assert port.openPort()
    try:
        assert port.setBaudRate(1_000_000)
        found, result = handler.broadcastPing(port)
        assert result == sdk.COMM_SUCCESS
        assert sorted(found) == list(range(1, N + 1))
        assert handler.ping(port, 1)[:2] == (1020, sdk.COMM_SUCCESS)
        assert handler.write1ByteTxRx(port, 1, Register.TORQUE_ENABLE, 1) == (sdk.COMM_SUCCESS, 0)
        goals = sdk.GroupSyncWrite(port, handler, Register.GOAL_POSITION, 4)
        assert all(goals.addParam(number, struct.pack("<i", MIDDLE + 100)) for number in (1, 2))
        assert goals.txPacket() == sdk.COMM_SUCCESS
        time.sleep(1.0)
        sync = sdk.GroupSyncRead(port, handler, Register.PRESENT_POSITION, 4)
        bulk = sdk.GroupBulkRead(port, handler)
        for number in (1, 2):
            assert sync.addParam(number)
            assert bulk.addParam(number, Register.PRESENT_VOLTAGE, 3)
        assert sync.txRxPacket() == sdk.COMM_SUCCESS
        assert sync.getData(1, Register.PRESENT_POSITION, 4) == pytest.approx(MIDDLE + 100, abs=25)
        assert sync.getData(2, Register.PRESENT_POSITION, 4) < MIDDLE + 50, "its torque is off"
        assert bulk.txRxPacket() == sdk.COMM_SUCCESS
        assert bulk.getData(2, Register.PRESENT_VOLTAGE, 2) == pytest.approx(350, abs=5)
    finally:
        port.closePort()


def test_a_whole_trial_runs_over_it(tmp_path: Path, monkeypatch):
    for name, patient in {"HOLD_AFTER": 3.0, "LIMP_AFTER": 4.0, "WATCHDOG": 127}.items():  # on a busy computer
        monkeypatch.setattr(f"laticauda_dynamixel.driver.{name}", patient)
    tank = tank_of_servos()
    servos = Servos(len(tank.nodes))
    result = swum(lab.Lab(tank, bus=servos, port=0), tmp_path, bus=f"dynamixel@{servos.path}")
    assert result.accepted, result.reason
    trial = lc.load_trial(tmp_path / "whole.nc")
    assert trial.forward_velocity > 0.0
    assert math.radians(10) < abs(trial.joint_angle).max() < math.radians(25)
