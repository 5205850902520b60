"""Packets of the Dynamixel protocol 2.0, and the registers of the X series that are used here.

References:
    ROBOTIS e-Manual, "DYNAMIXEL Protocol 2.0", and the control table of the X series.
"""

import math
import struct
from enum import IntEnum
from typing import NamedTuple

HEADER = b"\xff\xff\xfd\x00"
BROADCAST = 0xFE
LONGEST = 4096  # a length beyond it is noise


class Instruction(IntEnum):
    """What a packet is for."""

    PING = 0x01
    READ = 0x02
    WRITE = 0x03
    REBOOT = 0x08
    STATUS = 0x55
    SYNC_READ = 0x82
    SYNC_WRITE = 0x83
    BULK_READ = 0x92


class Register(IntEnum):
    """Address of a number in a servo of the X series."""

    OPERATING_MODE = 11
    TORQUE_ENABLE = 64
    HARDWARE_ERROR = 70
    BUS_WATCHDOG = 98
    GOAL_POSITION = 116
    PRESENT_CURRENT = 126
    PRESENT_VELOCITY = 128
    PRESENT_POSITION = 132
    PRESENT_VOLTAGE = 144
    PRESENT_TEMPERATURE = 146


MEASURED = struct.Struct("<hii8xHB")
"""From PRESENT_CURRENT on: current, velocity, position, two trajectories, voltage, temperature."""
MIDDLE, TURN = 2048, 4096  # of the position
VELOCITY = 0.229 * 2.0 * math.pi / 60.0  # [rad/s]
CURRENT = 0.00269  # [A]
VOLTAGE = 0.1  # [V]
WATCHDOG = 0.02  # [s]
TRIPPED = 0xFF  # what BUS_WATCHDOG says then
OVERHEATING, OVERLOAD = 0x04, 0x20  # of HARDWARE_ERROR


class Packet(NamedTuple):
    """One packet, either way."""

    number: int
    """Of the servo."""
    instruction: int
    """STATUS: it is an answer, whose data begin with an error."""
    data: bytes


def _table() -> tuple[int, ...]:
    found: list[int] = []
    for byte in range(256):
        crc = byte << 8
        for _ in range(8):
            crc = (crc << 1) ^ (0x8005 if crc & 0x8000 else 0)
        found.append(crc & 0xFFFF)
    return tuple(found)


_CRC = _table()


def crc16(data: bytes) -> int:
    """The checksum: CRC-16 of the polynomial 0x8005 from 0 on, most significant bit first."""
    crc = 0
    for byte in data:
        crc = (crc << 8 & 0xFFFF) ^ _CRC[crc >> 8 ^ byte]
    return crc


def encoded(packet: Packet) -> bytes:
    """A packet as it goes over the line."""
    body = (bytes([packet.instruction]) + packet.data).replace(b"\xff\xff\xfd", b"\xff\xff\xfd\xfd")
    whole = HEADER + struct.pack("<BH", packet.number, len(body) + 2) + body
    return whole + struct.pack("<H", crc16(whole))


class Reader:
    """Finds packets in what comes over the line, whatever else there is."""

    def __init__(self) -> None:
        self._waiting = b""

    def feed(self, data: bytes) -> list[Packet]:
        """The packets that are complete with these bytes.

        Args:
            data: What came.
        """
        found: list[Packet] = []
        self._waiting += data
        while (start := self._waiting.find(HEADER)) >= 0:
            self._waiting = self._waiting[start:]
            if len(self._waiting) < 7:
                return found
            number, length = struct.unpack_from("<BH", self._waiting, 4)
            if not 3 <= length <= LONGEST:
                self._waiting = self._waiting[1:]
                continue
            whole = self._waiting[: 7 + length]
            if len(whole) < 7 + length:
                return found
            if struct.unpack("<H", whole[-2:])[0] != crc16(whole[:-2]):
                self._waiting = self._waiting[1:]
                continue
            body = whole[7:-2].replace(b"\xff\xff\xfd\xfd", b"\xff\xff\xfd")
            found.append(Packet(number, body[0], body[1:]))
            self._waiting = self._waiting[len(whole) :]
        self._waiting = self._waiting[-3:]  # a header may have begun
        return found
