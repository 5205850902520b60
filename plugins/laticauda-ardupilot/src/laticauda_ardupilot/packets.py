"""The two messages of ArduPilot's JSON SITL protocol: servo outputs as bytes, sensor readings as a line of JSON.

References:
    ArduPilot, `libraries/SITL/examples/JSON/readme.md`, "JSON Simulation Format".
"""

import json
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

MAGIC_OF_CHANNELS = {16: 18458, 32: 29569}
"""First number of a servo packet, by its number of channels; 32 if `SERVO_32_ENABLE` is 1."""
FORMATS = {
    magic: struct.Struct(f"<HHI{n_channels}H") for n_channels, magic in MAGIC_OF_CHANNELS.items()
}
"""Magic, frame rate, frame count and pulse widths, by the magic."""
LONGEST_PACKET = max(form.size for form in FORMATS.values())
"""Bytes of a servo packet at most."""
LARGEST_COUNT = 2**32 - 1
"""Largest frame count that fits into a packet."""
MOST_RANGES = 6
"""Rangefinders that the protocol has room for."""
NO_RETURN = 1000.0
"""Distance that is sent where a rangefinder hits nothing; ArduPilot knows no infinity [m]."""


@dataclass(frozen=True, kw_only=True)
class ServoPacket:
    """What ArduPilot sends in one frame."""

    frame_rate: int
    """Frames per second: the simulation advances by one over it [Hz]."""
    frame_count: int
    """Number of the frame; begins at 0 when ArduPilot is started."""
    pwm: tuple[int, ...]
    """Pulse width of every servo output, 0 if it has none [us]."""


def read_servo_packet(data: bytes) -> ServoPacket | None:
    """Return the packet in the bytes of a datagram; None if they are none.

    Args:
        data: The datagram.
    """
    if len(data) < 2:
        return None
    (magic,) = struct.unpack_from("<H", data)
    form = FORMATS.get(magic)
    if form is None or len(data) != form.size:
        return None
    _, frame_rate, frame_count, *pwm = form.unpack(data)
    if frame_rate == 0:
        return None
    return ServoPacket(frame_rate=frame_rate, frame_count=frame_count, pwm=tuple(pwm))


def write_servo_packet(packet: ServoPacket) -> bytes:
    """Return the bytes of a packet, as ArduPilot sends them.

    Args:
        packet: The packet, with 16 or 32 channels.
    """
    magic = MAGIC_OF_CHANNELS[len(packet.pwm)]
    return FORMATS[magic].pack(magic, packet.frame_rate, packet.frame_count, *packet.pwm)


@dataclass(frozen=True, kw_only=True)
class SensorReading:
    """What the simulation answers: axes north, east, down of the earth; forward, right, down of the body."""

    time: float
    """Time of the simulation [s]."""
    gyro: Float[np.ndarray, " 3"]
    """Angular velocity, body axes [rad/s]."""
    acceleration: Float[np.ndarray, " 3"]
    """Specific force, which at rest is gravity's reaction, upward; body axes [m/s^2]."""
    position: Float[np.ndarray, " 3"]
    """North, east, and down from the surface [m]."""
    velocity: Float[np.ndarray, " 3"]
    """North, east, down [m/s]."""
    attitude: Float[np.ndarray, " 3"]
    """Roll, pitch, yaw [rad]."""
    quaternion: Float[np.ndarray, " 4"]
    """The attitude as w, x, y, z [-]."""
    ranges: tuple[float, ...] = ()
    """Distance that each rangefinder measures, infinite without a return [m]."""
    voltage: float | None = None
    """Voltage of the battery; None: there is no battery [V]."""
    current: float | None = None
    """Current out of the battery [A]."""


def write_sensor_line(reading: SensorReading) -> bytes:
    """Return a reading as ArduPilot reads it: JSON without blanks between line feeds.

    Its parser is not a general one: it finds keys as texts, and numbers right behind the colon.

    Args:
        reading: The reading.
    """
    message: dict[str, Any] = {
        "timestamp": reading.time,
        "imu": {
            "gyro": reading.gyro.tolist(),
            "accel_body": reading.acceleration.tolist(),
        },
        "position": reading.position.tolist(),
        "attitude": reading.attitude.tolist(),
        "quaternion": reading.quaternion.tolist(),
        "velocity": reading.velocity.tolist(),
    }
    for number, distance in enumerate(reading.ranges, start=1):
        message[f"rng_{number}"] = min(float(distance), NO_RETURN)
    if reading.voltage is not None:
        message["battery"] = {"voltage": reading.voltage, "current": reading.current}
    text = json.dumps(message, separators=(",", ":"), allow_nan=False)
    return f"\n{text}\n".encode("ascii")
