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
from typing import Any

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

MODEL, FIRMWARE = 1020, 45  # XM430-W350
SIZE = 147  # of the control table
RANGE_ERROR, LENGTH_ERROR, ACCESS_ERROR, ALERT = 0x04, 0x05, 0x07, 0x80
FOR_EVER = 1e6  # s; a servo goes on holding without references


class Servos(AbstractContextManager["Servos"]):
    """Stands for the CAN bus of a `laticauda.tank.lab.Lab`.

    Args:
        n: How many servos there are.
    """

    def __init__(self, n: int) -> None:
        self.tables = {number: bytearray(SIZE) for number in range(1, n + 1)}
        for table in self.tables.values():
            struct.pack_into("<H", table, 0, MODEL)
            table[Register.OPERATING_MODE] = 3
            struct.pack_into("<i", table, Register.GOAL_POSITION, packets.MIDDLE)
        self._ours, self._theirs = os.openpty()
        tty.setraw(self._theirs)
        os.set_blocking(self._ours, False)
        self.path = os.ttyname(self._theirs)
        self._reader, self._to_tank, self._unanswered = Reader(), deque[Any](), deque[Packet]()
        self._heard, self._counter = time.monotonic(), 0

    # ---- as the lab sees it ----------------------------------------------------------------------

    def recv(self, timeout: float | None = None) -> Any:
        """The next frame for the modules; a read is answered after they have measured."""
        if not self._to_tank and self._unanswered:
            self._answer(self._unanswered.popleft())
        if not self._to_tank and select.select([self._ours], [], [], timeout)[0]:
            with suppress(OSError):  # nobody has the other end open
                for packet in self._reader.feed(os.read(self._ours, 65536)):
                    self._heard = time.monotonic()
                    self._take(packet)
        self._watch()
        return to_frame(self._to_tank.popleft()) if self._to_tank else None

    def send(self, frame: Any, timeout: float | None = None) -> None:
        """What a module says is what the registers of its servo hold."""
        said = decode(frame.arbitration_id, bytes(frame.data))
        if getattr(said, "node", None) not in self.tables:
            return
        if isinstance(said, JointState):
            steps = packets.MIDDLE + round(said.angle * packets.TURN / (2.0 * math.pi))
            current = math.copysign(said.current, said.torque)
            numbers = round(current / packets.CURRENT), round(said.rate / packets.VELOCITY), steps
            struct.pack_into("<hii", self.tables[said.node], Register.PRESENT_CURRENT, *numbers)
        elif isinstance(said, Heartbeat):
            table = self.tables[said.node]
            volts, warm = round(said.voltage / packets.VOLTAGE), max(round(said.temperature), 0)
            struct.pack_into("<HB", table, Register.PRESENT_VOLTAGE, volts, warm)
            error = packets.OVERHEATING * said.over_temperature
            table[Register.HARDWARE_ERROR] |= error | packets.OVERLOAD * (
                said.over_current or said.stuck
            )
            if table[Register.HARDWARE_ERROR]:
                table[Register.TORQUE_ENABLE] = 0

    def __exit__(self, *_: object) -> None:
        """Hang up."""
        for end in (self._ours, self._theirs):
            os.close(end)

    # ---- as the line sees it ---------------------------------------------------------------------

    def _take(self, packet: Packet) -> None:
        """An instruction."""
        number, kind, data = packet
        named = (
            list(self.tables) if number == BROADCAST else [number] if number in self.tables else []
        )
        if kind == Instruction.PING:
            for one in named:
                self._status(one, struct.pack("<HB", MODEL, FIRMWARE))
        elif kind in (Instruction.READ, Instruction.SYNC_READ, Instruction.BULK_READ):
            self._unanswered.append(packet)
            self._measure()
        elif kind == Instruction.WRITE and len(data) > 2:
            register = struct.unpack_from("<H", data)[0]
            for one in named:
                error = self._write(one, register, data[2:])
                if number != BROADCAST:
                    self._status(one, error=error)
            self._measure()
        elif kind == Instruction.SYNC_WRITE and len(data) > 4:
            register, size = struct.unpack_from("<HH", data)
            for at in range(4, len(data) - size, size + 1):
                if data[at] in self.tables:
                    self._write(data[at], register, data[at + 1 : at + 1 + size])
            self._measure()
        elif kind == Instruction.REBOOT:
            for one in named:
                self.tables[one][Register.TORQUE_ENABLE] = self.tables[one][
                    Register.HARDWARE_ERROR
                ] = 0
                self._to_tank += [
                    NodeCommand(order=order, node=one) for order in (Order.CLEAR, Order.DISABLE)
                ]
                self._status(one)

    def _write(self, number: int, register: int, data: bytes) -> int:
        """Set registers, and do what they say; returns the error."""
        table = self.tables[number]
        if register + len(data) > SIZE:
            return RANGE_ERROR
        is_goal = register <= Register.GOAL_POSITION < register + len(data)
        if is_goal and table[Register.BUS_WATCHDOG] == packets.TRIPPED:
            return ACCESS_ERROR
        if register <= Register.TORQUE_ENABLE < register + len(data):
            on = (
                bool(data[Register.TORQUE_ENABLE - register]) and not table[Register.HARDWARE_ERROR]
            )
            if on != bool(table[Register.TORQUE_ENABLE]):
                self._to_tank.append(
                    NodeCommand(order=Order.ENABLE if on else Order.DISABLE, node=number)
                )
            data = (
                data[: Register.TORQUE_ENABLE - register]
                + bytes([on])
                + data[Register.TORQUE_ENABLE - register + 1 :]
            )
        table[register : register + len(data)] = data
        return 0

    def _measure(self) -> None:
        """Let the modules take up all goals, and measure."""
        steps = [
            struct.unpack_from("<i", table, Register.GOAL_POSITION)[0]
            for table in self.tables.values()
        ]
        if not steps:
            return
        self._to_tank += encode_references(
            [(one - packets.MIDDLE) * 2.0 * math.pi / packets.TURN for one in steps]
        )
        self._to_tank.append(Sync(counter=self._counter))
        self._counter = (self._counter + 1) % 65536

    def _answer(self, packet: Packet) -> None:
        """What was read."""
        number, kind, data = packet
        if kind == Instruction.BULK_READ:
            wanted = [struct.unpack_from("<BHH", data, at) for at in range(0, len(data) - 4, 5)]
        elif len(data) < 4:
            return
        else:
            register, size = struct.unpack_from("<HH", data)
            numbers = data[4:] if kind == Instruction.SYNC_READ else [number]
            wanted = [(one, register, size) for one in numbers]
        for one, register, size in wanted:
            if one in self.tables:
                fits = register + size <= SIZE
                found = bytes(self.tables[one][register : register + size]) if fits else b""
                self._status(one, found, 0 if fits else RANGE_ERROR)

    def _status(self, number: int, data: bytes = b"", error: int = 0) -> None:
        error |= ALERT if self.tables[number][Register.HARDWARE_ERROR] else 0
        with suppress(OSError):  # nobody reads, and the line is full
            os.write(
                self._ours,
                packets.encoded(Packet(number, Instruction.STATUS, bytes([error]) + data)),
            )

    def _watch(self) -> None:
        """Servos that nobody has spoken to for too long stay where they are, and take no goals."""
        silent = time.monotonic() - self._heard
        for table in self.tables.values():
            if (
                0 < table[Register.BUS_WATCHDOG] < 128
                and silent > table[Register.BUS_WATCHDOG] * packets.WATCHDOG
            ):
                table[Register.BUS_WATCHDOG] = packets.TRIPPED
                here = struct.unpack_from("<i", table, Register.PRESENT_POSITION)[0]
                struct.pack_into("<i", table, Register.GOAL_POSITION, here)
                self._measure()


def tank_of_servos(robot: str = "mamba", seed: int = 0) -> lab.Tank:
    """A tank whose modules have no time-outs, and angle sensors that know their zero.

    Args:
        robot: A preset.
        seed: Of all that is random.
    """
    usual = lab.LabSettings(seed=seed)
    nodes = replace(
        usual.nodes,
        hold_after=FOR_EVER,
        limp_after=FOR_EVER,
        startup_time=0.0,
        calibration_time=0.0,
        zero_error=0.0,
    )
    what = lc.load_robot(robot)
    body = lab.VirtualRobot(
        what, lc.build_plant(what, lc.load_water("paper-lateral"), joints="servo")
    )
    return lab.Tank(body, replace(usual, nodes=nodes))


def main() -> None:
    """A tank until Ctrl-C."""
    tank = tank_of_servos()
    servos = Servos(len(tank.nodes))
    served = lab.Lab(tank, bus=servos)
    addresses = served.open()
    place = f"{addresses.mocap_host}:{addresses.mocap_port}"
    print(f"dynamixel {servos.path} | qtm {place} | meter {addresses.meter}", flush=True)
    try:
        served.run()
    except KeyboardInterrupt:
        served.close()


if __name__ == "__main__":
    main()
