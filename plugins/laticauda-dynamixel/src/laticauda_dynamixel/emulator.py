"""The modules of the virtual tank as such servos, at a pseudo-terminal, written to the vendor's e-Manual.

    python -m laticauda_dynamixel.emulator

A servo is a module of the tank whose firmware does what registers say; it knows neither heartbeats
nor time-outs of references, only the bus watchdog.
"""

import math
import os
import select
import struct
import time
import tty
from collections import deque
from contextlib import AbstractContextManager, suppress
from dataclasses import replace
from typing import Any, NamedTuple

import laticauda as lc
from laticauda.tank import lab
from laticauda.tank.protocol import (
    Heartbeat,
    JointState,
    NodeCommand,
    Order,
    Sync,
    decode,
    encode_references,
    to_frame,
)
from laticauda_dynamixel import packets
from laticauda_dynamixel.packets import BROADCAST, Instruction, Packet, Reader, Register

MODEL, FIRMWARE = 1020, 45
"""What an XM430-W350 answers to a ping."""
TABLE_SIZE = 147
"""Size of the control table [B]."""
RANGE_ERROR, ACCESS_ERROR = 0x04, 0x07
"""Errors of an answer: no such register, and a goal that is not taken."""
ALERT = 0x80
"""Bit of an answer's error: HARDWARE_ERROR is not 0."""
POSITION_MODE = 3
"""Value of OPERATING_MODE."""
FOR_EVER = 1e6
"""A servo goes on holding without references [s]."""
SYNC_COUNTS = 65536
"""How many values the counter of a `Sync` has."""


class ReadRequest(NamedTuple):
    """Registers that were asked for."""

    number: int
    """Of the servo."""
    register: int
    """The first of them."""
    size: int
    """How many bytes."""


class Servos(AbstractContextManager["Servos"]):
    """Stands for the CAN bus of a `laticauda.tank.lab.Lab`.

    Args:
        n: How many servos there are.
    """

    def __init__(self, n: int) -> None:
        self.tables = {number: bytearray(TABLE_SIZE) for number in range(1, n + 1)}
        for table in self.tables.values():
            struct.pack_into("<H", table, 0, MODEL)
            table[Register.OPERATING_MODE] = POSITION_MODE
            struct.pack_into("<i", table, Register.GOAL_POSITION, packets.MIDDLE)
        self._ours, self._theirs = os.openpty()
        tty.setraw(self._theirs)
        os.set_blocking(self._ours, False)
        self.path = os.ttyname(self._theirs)
        self._reader = Reader()
        self._to_tank = deque[Any]()
        self._unanswered = deque[Packet]()
        self._heard_at = time.monotonic()
        self._counter = 0

    # ---- as the lab sees it ----------------------------------------------------------------------

    def recv(self, timeout: float | None = None) -> Any:
        """Return the next frame for the modules; a read is answered after they have measured."""
        if not self._to_tank and self._unanswered:
            self._answer(self._unanswered.popleft())
        if not self._to_tank and select.select([self._ours], [], [], timeout)[0]:
            with suppress(OSError):  # nobody has the other end open
                for packet in self._reader.feed(os.read(self._ours, 65536)):
                    self._heard_at = time.monotonic()
                    self._obey(packet)
        self._watch()
        if not self._to_tank:
            return None
        return to_frame(self._to_tank.popleft())

    def send(self, frame: Any, timeout: float | None = None) -> None:
        """Put what a module says into the registers of its servo."""
        message = decode(frame.arbitration_id, bytes(frame.data))
        if isinstance(message, JointState) and message.node in self.tables:
            _store_measurement(self.tables[message.node], message)
        elif isinstance(message, Heartbeat) and message.node in self.tables:
            _store_condition(self.tables[message.node], message)

    def __exit__(self, *_: object) -> None:
        """Hang up."""
        for end in (self._ours, self._theirs):
            os.close(end)

    # ---- as the line sees it ---------------------------------------------------------------------

    def _obey(self, packet: Packet) -> None:
        """Do what a packet asks for."""
        numbers = self._addressed(packet.number)
        match packet.instruction:
            case Instruction.PING:
                for number in numbers:
                    self._reply(number, struct.pack("<HB", MODEL, FIRMWARE))
            case Instruction.READ | Instruction.SYNC_READ | Instruction.BULK_READ:
                self._unanswered.append(packet)
                self._measure()
            case Instruction.WRITE if len(packet.data) > 2:
                self._write_same(numbers, packet)
                self._measure()
            case Instruction.SYNC_WRITE if len(packet.data) > 4:
                self._write_each(packet.data)
                self._measure()
            case Instruction.REBOOT:
                for number in numbers:
                    self._reboot(number)
            case _:
                pass

    def _addressed(self, number: int) -> list[int]:
        """Return the numbers of the servos that a packet's number means."""
        if number == BROADCAST:
            return list(self.tables)
        if number in self.tables:
            return [number]
        return []

    def _write_same(self, numbers: list[int], packet: Packet) -> None:
        (register,) = struct.unpack_from("<H", packet.data)
        for number in numbers:
            error = self._write(number, register, packet.data[2:])
            if packet.number != BROADCAST:
                self._reply(number, error=error)

    def _write_each(self, data: bytes) -> None:
        register, size = struct.unpack_from("<HH", data)
        for start in range(4, len(data) - size, size + 1):
            number = data[start]
            if number in self.tables:
                self._write(number, register, data[start + 1 : start + 1 + size])

    def _reboot(self, number: int) -> None:
        table = self.tables[number]
        table[Register.HARDWARE_ERROR] = 0
        table[Register.TORQUE_ENABLE] = 0
        self._to_tank.append(NodeCommand(order=Order.CLEAR, node=number))
        self._to_tank.append(NodeCommand(order=Order.DISABLE, node=number))
        self._reply(number)

    def _write(self, number: int, register: int, data: bytes) -> int:
        """Set registers, do what they say, and return the error."""
        table = self.tables[number]
        written = range(register, register + len(data))
        if written.stop > TABLE_SIZE:
            return RANGE_ERROR
        if Register.GOAL_POSITION in written and table[Register.BUS_WATCHDOG] == packets.TRIPPED:
            return ACCESS_ERROR
        was_on = bool(table[Register.TORQUE_ENABLE])
        table[written.start : written.stop] = data
        if Register.TORQUE_ENABLE in written:
            self._switch(number, was_on=was_on)
        return 0

    def _switch(self, number: int, *, was_on: bool) -> None:
        """Switch a module as TORQUE_ENABLE says; with an error of the hardware, it stays off."""
        table = self.tables[number]
        is_on = bool(table[Register.TORQUE_ENABLE]) and not table[Register.HARDWARE_ERROR]
        table[Register.TORQUE_ENABLE] = is_on
        if is_on and not was_on:
            self._to_tank.append(NodeCommand(order=Order.ENABLE, node=number))
        elif was_on and not is_on:
            self._to_tank.append(NodeCommand(order=Order.DISABLE, node=number))

    def _measure(self) -> None:
        """Let the modules take up all goals, and measure."""
        if not self.tables:
            return
        goals = list[float]()
        for table in self.tables.values():
            (steps,) = struct.unpack_from("<i", table, Register.GOAL_POSITION)
            goals.append(packets.angle_of_steps(steps))
        self._to_tank += encode_references(goals)
        self._to_tank.append(Sync(counter=self._counter))
        self._counter = (self._counter + 1) % SYNC_COUNTS

    def _answer(self, packet: Packet) -> None:
        """Reply with the registers that a packet asks for."""
        for request in _requests_of(packet):
            if request.number not in self.tables:
                continue
            end = request.register + request.size
            if end > TABLE_SIZE:
                self._reply(request.number, error=RANGE_ERROR)
                continue
            values = self.tables[request.number][request.register : end]
            self._reply(request.number, bytes(values))

    def _reply(self, number: int, data: bytes = b"", error: int = 0) -> None:
        if self.tables[number][Register.HARDWARE_ERROR]:
            error |= ALERT
        status = Packet(number, Instruction.STATUS, bytes([error]) + data)
        with suppress(OSError):  # nobody reads, and the line is full
            os.write(self._ours, packets.encode_packet(status))

    def _watch(self) -> None:
        """Servos that nobody has spoken to for too long stay where they are, and take no goals."""
        silence = time.monotonic() - self._heard_at
        for table in self.tables.values():
            patience = table[Register.BUS_WATCHDOG]
            is_armed = 0 < patience < 128
            if is_armed and silence > patience * packets.WATCHDOG:
                table[Register.BUS_WATCHDOG] = packets.TRIPPED
                (position,) = struct.unpack_from("<i", table, Register.PRESENT_POSITION)
                struct.pack_into("<i", table, Register.GOAL_POSITION, position)
                self._measure()


def _store_measurement(table: bytearray, state: JointState) -> None:
    current = round(math.copysign(state.current, state.torque) / packets.CURRENT)
    velocity = round(state.rate / packets.VELOCITY)
    position = packets.steps_of_angle(state.angle)
    struct.pack_into("<hii", table, Register.PRESENT_CURRENT, current, velocity, position)


def _store_condition(table: bytearray, heartbeat: Heartbeat) -> None:
    voltage = round(heartbeat.voltage / packets.VOLTAGE)
    temperature = max(round(heartbeat.temperature), 0)
    struct.pack_into("<HB", table, Register.PRESENT_VOLTAGE, voltage, temperature)
    if heartbeat.over_temperature:
        table[Register.HARDWARE_ERROR] |= packets.OVERHEATING
    if heartbeat.over_current or heartbeat.stuck:
        table[Register.HARDWARE_ERROR] |= packets.OVERLOAD
    if table[Register.HARDWARE_ERROR]:
        table[Register.TORQUE_ENABLE] = 0


def _requests_of(packet: Packet) -> list[ReadRequest]:
    """Return what a packet asks for; nothing if it is too short."""
    data = packet.data
    if packet.instruction == Instruction.BULK_READ:
        return [
            ReadRequest(*struct.unpack_from("<BHH", data, start))
            for start in range(0, len(data) - 4, 5)
        ]
    if len(data) < 4:
        return []
    register, size = struct.unpack_from("<HH", data)
    if packet.instruction == Instruction.READ:
        return [ReadRequest(packet.number, register, size)]
    return [ReadRequest(number, register, size) for number in data[4:]]


def tank_of_servos(robot: str = "mamba", seed: int = 0) -> lab.Tank:
    """A tank whose modules have no time-outs, and angle sensors that know their zero.

    Args:
        robot: A preset.
        seed: Of all that is random.
    """
    settings = lab.LabSettings(seed=seed)
    nodes = replace(
        settings.nodes,
        hold_after=FOR_EVER,
        limp_after=FOR_EVER,
        startup_time=0.0,
        calibration_time=0.0,
        zero_error=0.0,
    )
    preset = lc.load_robot(robot)
    plant = lc.build_plant(preset, lc.load_water("paper-lateral"), joints="servo")
    body = lab.VirtualRobot(preset, plant)
    return lab.Tank(body, replace(settings, nodes=nodes))


def main() -> None:
    """A tank until Ctrl-C."""
    tank = tank_of_servos()
    servos = Servos(len(tank.nodes))
    virtual_lab = lab.Lab(tank, bus=servos)
    addresses = virtual_lab.open()
    mocap = f"{addresses.mocap_host}:{addresses.mocap_port}"
    print(f"dynamixel {servos.path} | qtm {mocap} | meter {addresses.meter}", flush=True)
    try:
        virtual_lab.run()
    except KeyboardInterrupt:
        virtual_lab.close()


if __name__ == "__main__":
    main()
