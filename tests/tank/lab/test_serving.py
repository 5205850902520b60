import subprocess
import sys
import time

import pytest
import serial
from lab_parts import EXACT, make_tank
from mamba_dbc import FILE
from patience import LONG, running

from laticauda.scenarios.interfaces import Start
from laticauda.tank.lab import Fault, Lab, assist
from laticauda.tank.protocol import (
    CommandReply,
    Heartbeat,
    JointState,
    NodeCommand,
    Order,
    Sync,
    bus_address,
    encode_references,
    from_frame,
    meter,
    open_bus,
    to_frame,
)


@pytest.fixture
def lab():
    return Lab(make_tank(), bus=bus_address("virtual:test_serving"), port=0, speed=4.0)


def heard(bus, kind, count):
    """Messages of a kind, as many as are waited for; fewer only after much too long a time."""
    until = time.monotonic() + 20.0
    found = []
    while len(found) < count and time.monotonic() < until:
        frame = bus.recv(0.1)
        message = None if frame is None else from_frame(frame)
        if isinstance(message, kind):
            found.append(message)
    return found


def test_a_lab_answers_on_all_of_its_wires(lab):
    with lab as addresses, open_bus(addresses.bus) as bus:
        assert len(heard(bus, Heartbeat, 90)) == 90
        bus.send(to_frame(NodeCommand(order=Order.ENABLE)))
        assert len(heard(bus, CommandReply, 18)) == 18
        for message in encode_references([0.1] * 18):
            bus.send(to_frame(message))
        bus.send(to_frame(Sync(counter=1)))
        assert {m.node for m in heard(bus, JointState, 18)} == set(range(1, 19))
        with serial.Serial(addresses.meter, meter.BAUD_RATE, timeout=2.0) as line:
            line.write(meter.encode_question("ID"))
            assert line.read_until(b"\r") == b"0\r"
            assert line.read_until(b"\r").startswith(b"FLUKE 289,")
            line.write(b"\xff\x00garbage\r")
            assert line.read_until(b"\r") == b"1\r"
        assert lab.call(lambda tank: tank.time) > 0.3


def test_time_goes_on_at_the_speed_that_was_asked_for_or_the_lag_is_told(lab):
    lab.open()
    try:
        began = time.monotonic()
        lab.run(2.0)
        assert lab.tank.time == pytest.approx(2.0)
        assert time.monotonic() - began > 0.99 * (2.0 + lab.lag) / 4.0  # never faster
    finally:
        lab.close()


def test_a_lab_that_cannot_keep_up_receives_all_frames_that_are_there_before_its_next_step():
    slow = Lab(make_tank(), bus=bus_address("virtual:test_slow"), port=0, speed=1e6)
    addresses = slow.open()
    try:
        with open_bus(addresses.bus) as bus:
            slow.run(3.0)  # its nodes have started
            for _ in range(40):
                bus.send(to_frame(Sync(counter=1)))
            slow.run(2.0 * slow.tank.settings.step)
            assert len(heard(bus, JointState, 40 * 18)) == 40 * 18
    finally:
        slow.close()


def test_a_lab_that_had_to_wait_tells_how_late_it_was(lab):
    with lab:
        lab.call(lambda tank: time.sleep(0.1))
        time.sleep(0.1)
    assert lab.behind > 0.3  # at four times the speed


def test_foreign_frames_do_nothing(lab):
    import can

    lab.tank.advance(0.3)
    with lab as addresses, open_bus(addresses.bus) as bus:
        bus.send(can.Message(arbitration_id=0x12345, data=b"x", is_extended_id=True))
        bus.send(
            can.Message(arbitration_id=0x180, is_extended_id=False, is_remote_frame=True, dlc=2)
        )
        bus.send(can.Message(arbitration_id=0x180, data=b"x" * 8, is_extended_id=False))
        bus.send(to_frame(Sync(counter=1)))
        assert len(heard(bus, JointState, 18)) == 18


def test_another_process_reads_the_bus_with_the_file_and_no_laticauda():
    lab = Lab(make_tank(), bus=bus_address("udp_multicast:239.74.163.98:43197"), port=0)
    code = (
        "import sys, can, cantools; db = cantools.database.load_file(sys.argv[1]); found = {}\n"
        "with can.Bus(interface='udp_multicast', channel='239.74.163.98', port=43197, hop_limit=0) as bus:\n"
        "    print('listening', flush=True)\n"
        "    for _ in range(60):\n"
        "        m = bus.recv(2.0)\n"
        "        kind = db.get_message_by_frame_id(m.arbitration_id)\n"
        "        found[kind.name] = kind.decode(m.data)\n"
        "print(found['Heartbeat07']['State'], 'laticauda' in sys.modules)"
    )
    lab.tank.advance(0.5)
    lab.tank.sent()
    with running([sys.executable, "-c", code, FILE], stdout=subprocess.PIPE) as listener:
        assert listener.stdout is not None
        assert listener.stdout.readline() == "listening\n"
        with lab:
            rest = listener.communicate(timeout=LONG)[0]
    assert rest == "READY False\n"


def test_the_person_at_the_tank_does_what_a_line_says():
    tank = make_tank(EXACT)
    assert assist(tank, "leak node=3 duration=2") == "leak at node 3: water in a module"
    tank.advance(0.05)
    assert [fault.kind for fault in tank.faults.present] == ["leak"]
    assert assist(tank, "clear") == "no faults"
    assert assist(tank, "carry 1 -0.5 90") == "the robot lies straight at 1 -0.5 m, heading 90 deg"
    assert (
        assist(tank, "truth")
        == "time 0.05 s, center of mass 1.0000 -0.5000 -0.1500 m, heading 90.00 deg"
    )
    assert "Lines: a fault (frame_loss, " in assist(tank, "help")
    with pytest.raises(
        ValueError,
        match=r"`carry` must have three numbers, x y \[m\] and heading \[deg\], and in space a depth \[m\], got '1 2'",
    ):
        assist(tank, "carry 1 2")
    with pytest.raises(ValueError, match="did you mean `leak`"):
        assist(tank, "leek")


def test_work_and_time_go_on_when_the_robot_is_carried():
    tank = make_tank(EXACT)
    tank.advance(0.3)
    tank.carry(Start(center_of_mass=(2.0, 0.0)))
    tank.inject(Fault(kind="body_lost", time=10.0))
    tank.advance(0.3)
    assert tank.truth.time == pytest.approx(0.6, abs=1e-4)
    assert tank.electronics.supply_current * tank.electronics.voltage == pytest.approx(41.3)
