"""Packets of the Dynamixel protocol 2.0, and the registers of the X series that are used here.

References:
    ROBOTIS e-Manual, "DYNAMIXEL Protocol 2.0", and the control table of the X series.
"""

import math
import struct
from enum import IntEnum
from typing import NamedTuple

HEADER = b"\xff\xff\xfd\x00"
LIKE_A_HEADER, STUFFED = b"\xff\xff\xfd", b"\xff\xff\xfd\xfd"
"""Bytes of data that look like a header, and what goes over the line in their place."""
BROADCAST = 0xFE
HEAD_SIZE = 7
"""Size of header, number and length [B]."""
SHORTEST, LONGEST = 3, 4096
"""Lengths between which a packet's must be; any other is noise."""


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
MIDDLE = 2048
"""Steps at an angle of 0."""
TURN = 4096
"""Steps of a whole turn."""
VELOCITY = 0.229 * 2.0 * math.pi / 60.0
"""Unit of velocities [rad/s]."""
CURRENT = 0.00269
"""Unit of currents [A]."""
VOLTAGE = 0.1
"""Unit of voltages [V]."""
WATCHDOG = 0.02
"""Unit of the bus watchdog's time [s]."""
TRIPPED = 0xFF
"""Value of BUS_WATCHDOG after it has stopped the servo."""
OVERHEATING, OVERLOAD = 0x04, 0x20
"""Bits of HARDWARE_ERROR."""


def steps_of_angle(angle: float) -> int:
    """Return the position register's value at an angle.

    Args:
        angle: The angle [rad].
    """
    return round(angle * TURN / (2.0 * math.pi)) + MIDDLE


def angle_of_steps(steps: int) -> float:
    """Return the angle at a value of the position register [rad].

    Args:
        steps: The value.
    """
    return (steps - MIDDLE) * 2.0 * math.pi / TURN


class Packet(NamedTuple):
    """One packet, either way."""

    number: int
    """Of the servo."""
    instruction: int
    """STATUS: it is an answer, whose data begin with an error."""
    data: bytes


def _crc_of_byte(byte: int) -> int:
    crc = byte << 8
    for _ in range(8):
        is_top_bit_set = bool(crc & 0x8000)
        crc <<= 1
        if is_top_bit_set:
            crc ^= 0x8005
    return crc & 0xFFFF


_CRC = tuple(_crc_of_byte(byte) for byte in range(256))


def crc16(data: bytes) -> int:
    """The checksum: CRC-16 of the polynomial 0x8005 from 0 on, most significant bit first."""
    crc = 0
    for byte in data:
        crc = (crc << 8 & 0xFFFF) ^ _CRC[crc >> 8 ^ byte]
    return crc


def encode_packet(packet: Packet) -> bytes:
    """Return a packet as it goes over the line.

    Args:
        packet: The packet.
    """
    content = bytes([packet.instruction]) + packet.data
    stuffed = content.replace(LIKE_A_HEADER, STUFFED)
    message = HEADER + struct.pack("<BH", packet.number, len(stuffed) + 2) + stuffed
    return message + struct.pack("<H", crc16(message))


class Reader:
    """Finds packets in what comes over the line, whatever else there is."""

    def __init__(self) -> None:
        self._buffer = b""

    def feed(self, data: bytes) -> list[Packet]:
        """The packets that are complete with these bytes.

        Args:
            data: What came.
        """
        packets: list[Packet] = []
        self._buffer += data
        while (start := self._buffer.find(HEADER)) >= 0:
            self._buffer = self._buffer[start:]
            if len(self._buffer) < HEAD_SIZE:
                return packets
            number, length = struct.unpack_from("<BH", self._buffer, len(HEADER))
            if not SHORTEST <= length <= LONGEST:
                self._buffer = self._buffer[1:]
                continue
            size = HEAD_SIZE + length
            if len(self._buffer) < size:
                return packets
            message = self._buffer[:size]
            (checksum,) = struct.unpack("<H", message[-2:])
            if checksum != crc16(message[:-2]):
                self._buffer = self._buffer[1:]
                continue
            content = message[HEAD_SIZE:-2].replace(STUFFED, LIKE_A_HEADER)
            packets.append(Packet(number, content[0], content[1:]))
            self._buffer = self._buffer[size:]
        self._buffer = self._buffer[-3:]  # a header may have begun
        return packets
