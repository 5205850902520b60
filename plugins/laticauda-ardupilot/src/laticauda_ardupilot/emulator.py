"""Stands for ArduPilot, which cannot be had everywhere: the other side of the protocol, with a pilot of PID loops.

    python -m laticauda_ardupilot.emulator --port 9002 --heading-deg 30 --depth 0.8

It is written to the published description of the protocol, and reads answers as the real parser
does: numbers are looked for behind the text of their key. It flies as a frame with three motors
(SimpleROV-3), whose outputs mix thrust and turning, and holds heading and depth.
"""

import argparse
import json
import math
import socket
import time
from collections.abc import Sequence
from dataclasses import dataclass, field

from laticauda_ardupilot.packets import ServoPacket, write_servo_packet

RESENDS_AFTER = 1.0
"""Time without an answer after which a packet is sent again [s, wall clock]."""
NEEDED_KEYS = ("timestamp", "gyro", "accel_body", "position", "velocity")
TRIM = 1500
"""Pulse of a motor that stands still [us]."""
SPAN = 400
"""Change of the pulse to full thrust [us]."""


class NotUnderstood(ValueError):
    """An answer lacks something that ArduPilot needs, and where it stops."""


def find_numbers(text: str, key: str, section: str = "") -> list[float] | None:
    """Return the numbers behind a key; None if it is not there.

    Args:
        text: One line of an answer.
        key: The key.
        section: Key of the table around it; "" for the line itself.
    """
    begin = text.find(section)
    if begin < 0:
        return None
    begin = text.find(f'"{key}"', begin)
    if begin < 0:
        return None
    value = text[begin + len(key) + 2 :].removeprefix(":")
    end = value.find("]") if value.startswith("[") else _first_of(value, ",}")
    try:
        return [float(number) for number in value[:end].removeprefix("[").split(",")]
    except ValueError:  # a blank before the bracket is enough
        return None


def _first_of(text: str, letters: str) -> int:
    """Return where the first of some letters is in a text."""
    return min(text.find(letter) for letter in letters if letter in text)


def read_answer(data: bytes) -> dict[str, list[float]]:
    """Return the numbers in the last whole line of an answer.

    Args:
        data: The datagram.

    Raises:
        NotUnderstood: If there is no whole line, or it lacks what is needed.
    """
    lines = data.decode("ascii").split("\n")
    if len(lines) < 3 or not lines[-2]:
        raise NotUnderstood("an answer must stand between line feeds")
    text = lines[-2]
    numbers = dict[str, list[float]]()
    for key in (*NEEDED_KEYS, "attitude", "quaternion", *(f"rng_{i}" for i in range(1, 7))):
        section = '"imu"' if key in ("gyro", "accel_body") else ""
        values = find_numbers(text, key, section)
        if values is not None:
            numbers[key] = values
        elif key in NEEDED_KEYS:
            raise NotUnderstood(f"did not find the key {key}")
    if "attitude" not in numbers and "quaternion" not in numbers:
        raise NotUnderstood("did not find the key attitude or quaternion")
    for key in ("voltage", "current"):
        values = find_numbers(text, key, '"battery"')
        if values is not None:
            numbers[key] = values
    return numbers


@dataclass
class Ardupilot:
    """One side of the protocol: what it sends, and what it makes of answers; without sockets."""

    frame_rate: int = 400
    """`SIM_RATE_HZ` [Hz]."""
    n_channels: int = 16
    """16, or 32 with `SERVO_32_ENABLE`."""
    frame_count: int = 0
    """Number of the frame whose answer it waits for."""
    time: float = 0.0
    """Its own time: the sum of all steps of the answers' time [s]."""
    n_backward: int = 0
    """Answers whose time was before that of the last one."""
    longest_step: float = 0.0
    """Largest step of time from one answer to the next [s]."""
    _last_timestamp: float = field(default=0.0, repr=False)

    def packet(self, pwm: Sequence[int]) -> bytes:
        """Return the packet of the frame.

        Args:
            pwm: Pulses of the first outputs; the others have none [us].
        """
        outputs = (*pwm, *[0] * (self.n_channels - len(pwm)))
        return write_servo_packet(
            ServoPacket(frame_rate=self.frame_rate, frame_count=self.frame_count, pwm=outputs)
        )

    def receive(self, data: bytes) -> dict[str, list[float]]:
        """Take an answer, and go on to the next frame.

        Args:
            data: The datagram.

        Raises:
            NotUnderstood: If it lacks what is needed.
        """
        numbers = read_answer(data)
        (timestamp,) = numbers["timestamp"]
        step = timestamp - self._last_timestamp
        if step < 0.0:
            self.n_backward += 1
        self.time += max(step, 0.0)
        self.longest_step = max(self.longest_step, step)
        self._last_timestamp = timestamp
        self.frame_count += 1
        return numbers


@dataclass
class Loop:
    """A PID loop whose output is limited to 1."""

    p: float
    """Output per error."""
    i: float
    """Output per integral of the error."""
    d: float
    """Output per rate."""
    _integral: float = field(default=0.0, repr=False)

    def output(self, error: float, *, rate: float, duration: float) -> float:
        """Return the output, from -1 to 1.

        Args:
            error: Wanted minus measured.
            rate: Rate of what is measured.
            duration: Time since the last output [s].
        """
        self._integral = _limited(self._integral + self.i * error * duration)
        return _limited(self.p * error + self._integral - self.d * rate)


@dataclass
class Pilot:
    """Holds heading and depth by PID loops, with constant thrust forward."""

    heading: float
    """Wanted heading, clockwise from north [rad]."""
    depth: float
    """Wanted depth [m]."""
    forward: float = 0.6
    """Share of the full thrust."""
    _heading_loop: Loop = field(default_factory=lambda: Loop(p=1.0, i=0.1, d=0.3), repr=False)
    _depth_loop: Loop = field(default_factory=lambda: Loop(p=3.0, i=0.3, d=8.0), repr=False)

    def motors(self, numbers: dict[str, list[float]], duration: float) -> tuple[int, int, int]:
        """Return the pulses of the three motors: right, left, vertical [us].

        Args:
            numbers: The last answer.
            duration: Time since the answer before [s].
        """
        heading = numbers["attitude"][2]
        depth = numbers["position"][2]
        heading_error = math.remainder(self.heading - heading, math.tau)
        yaw = self._heading_loop.output(heading_error, rate=numbers["gyro"][2], duration=duration)
        down = self._depth_loop.output(
            self.depth - depth, rate=numbers["velocity"][2], duration=duration
        )
        return _pulse(self.forward - yaw), _pulse(self.forward + yaw), _pulse(down)


def _limited(share: float) -> float:
    return min(max(share, -1.0), 1.0)


def _pulse(share: float) -> int:
    """Return the pulse for a share of the full thrust, from -1 to 1 [us]."""
    return TRIM + round(SPAN * _limited(share))


def _largest(errors: list[float]) -> float:
    """Return the largest magnitude."""
    return max(abs(error) for error in errors)


def fly(
    ardupilot: Ardupilot, pilot: Pilot, address: tuple[str, int], duration: float
) -> list[dict[str, list[float]]]:
    """Fly for some time; return what was read in every frame.

    Args:
        ardupilot: The protocol.
        pilot: Decides the pulses.
        address: Host and port of the simulation.
        duration: Duration, in its own time [s].
    """
    readings: list[dict[str, list[float]]] = []
    pwm = (TRIM, TRIM, TRIM)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.settimeout(RESENDS_AFTER)
        while ardupilot.time < duration - 0.5 / ardupilot.frame_rate:
            time_before = ardupilot.time
            link.sendto(ardupilot.packet(pwm), address)
            try:
                data = link.recv(65536)
            except TimeoutError:
                continue
            numbers = ardupilot.receive(data)
            readings.append(numbers)
            pwm = pilot.motors(numbers, ardupilot.time - time_before)
    return readings


def main(words: Sequence[str] | None = None) -> None:
    """Fly, and print how well heading and depth were held, as JSON."""
    parser = argparse.ArgumentParser(prog="laticauda_ardupilot.emulator", description=__doc__)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=9002)
    parser.add_argument("--rate", type=int, default=400, help="SIM_RATE_HZ")
    parser.add_argument("--channels", type=int, choices=(16, 32), default=16)
    parser.add_argument("--heading-deg", type=float, default=30.0)
    parser.add_argument("--depth", type=float, default=0.8, help="m")
    parser.add_argument("--duration", type=float, default=60.0, help="s")
    arguments = parser.parse_args(words)
    ardupilot = Ardupilot(frame_rate=arguments.rate, n_channels=arguments.channels)
    pilot = Pilot(heading=math.radians(arguments.heading_deg), depth=arguments.depth)
    begin = time.monotonic()
    readings = fly(ardupilot, pilot, (arguments.host, arguments.port), arguments.duration)
    summary = {
        "frames": len(readings),
        "seconds": ardupilot.time,
        "seconds_of_wall_clock": time.monotonic() - begin,
        **summarize(readings, pilot),
    }
    print(json.dumps(summary))


def summarize(readings: list[dict[str, list[float]]], pilot: Pilot) -> dict[str, float | None]:
    """Return how well heading and depth were held in the last third of a flight, and where it ended.

    Args:
        readings: What was read in every frame.
        pilot: What was to be held.
    """
    heading_errors: list[float] = []
    depth_errors: list[float] = []
    for numbers in readings[-len(readings) // 3 :]:
        heading = numbers["attitude"][2]
        heading_errors.append(math.remainder(pilot.heading - heading, math.tau))
        depth_errors.append(pilot.depth - numbers["position"][2])
    last = readings[-1]
    north, east, _ = last["position"]
    return {
        "largest_heading_error_deg": math.degrees(_largest(heading_errors)),
        "largest_depth_error_m": _largest(depth_errors),
        "north_m": north,
        "east_m": east,
        "battery_V": last.get("voltage", [None])[0],
    }


if __name__ == "__main__":
    main()
