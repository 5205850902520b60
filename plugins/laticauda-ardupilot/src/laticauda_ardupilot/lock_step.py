"""Lock step: which packet advances time, and what is answered to all others.

ArduPilot sends a packet, waits for the answer, and only then goes on; if none comes for one second
(ten, says its readme), it sends the same packet again. A network may lose, double or delay packets in
both directions. Therefore:

- A frame that is new advances time by one frame, however many were lost before it.
- The same frame again, soon: the network doubled it. No answer: a second one would be taken for that
  of the next frame, and from then on all answers would be one frame old.
- The same frame again, later: the answer was lost. The same answer again; time stands still.
- An older frame: it is late. No answer.
- Frame 0 from another port: ArduPilot was restarted. The robot starts again at once.
- An older frame from the same port, repeatedly, and nothing else in between: the same, a little later.

Nothing here knows of sockets, and the clock is an argument, so that tests can send packets in any
order at any time.
"""

import time
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Protocol

from laticauda_ardupilot.packets import (
    SensorReading,
    ServoPacket,
    read_servo_packet,
    write_sensor_line,
)

REPEAT_AFTER = 0.3
"""Time after an answer from which the same frame asks for it again; before, it is a copy [s, wall clock]."""
QUIET_AFTER = 1.0
"""Silence after which another port may take over in the middle of a run [s, wall clock]."""
RESTART_AFTER = 1.5
"""Time for which one old frame must be all that comes, to count as a restart: ArduPilot that waits repeats itself
every second [s, wall clock]."""


class Steps(Protocol):
    """What is stepped: a `Vehicle`, or a double of it in tests."""

    def reset(self) -> None:
        """Start again."""
        ...

    def step(self, pwm: tuple[int, ...], duration: float) -> SensorReading:
        """Advance by `duration` [s] under servo outputs `pwm` [us]."""
        ...


@dataclass(kw_only=True)
class Counts:
    """How many packets of each kind came."""

    frames: int = 0
    """That advanced time."""
    missed: int = 0
    """That never came, by the gaps in their numbers."""
    repeated: int = 0
    """Whose answer was sent again."""
    doubled: int = 0
    """That came twice at once."""
    late: int = 0
    """That were older than others before them, or of a program that was replaced."""
    invalid: int = 0
    """That are no servo packets."""
    resets: int = 0
    """With which the run began again."""


class LockStep:
    """Answers packets; only a new frame advances time.

    Args:
        vehicle: What is stepped.
        clock: Returns the time on the wall [s].
    """

    def __init__(self, vehicle: Steps, clock: Callable[[], float] = time.monotonic) -> None:
        self._vehicle = vehicle
        self._clock = clock
        self.counts = Counts()
        """How many packets of each kind came so far."""
        self._sender: Hashable = None
        self._former_senders = set[Hashable]()
        self._last_count = -1
        self._answer = b""
        self._answered_at = 0.0
        self._old_count = -1
        self._old_count_since = 0.0

    def answer(self, data: bytes, sender: Hashable) -> bytes | None:
        """Return the answer to a datagram, to be sent to where it came from; None: there is none.

        Args:
            data: The datagram.
            sender: Address that it came from.

        Raises:
            SimulationFailed: If the motion diverged.
        """
        packet = read_servo_packet(data)
        if packet is None:
            self.counts.invalid += 1
            return None
        if sender != self._sender:
            return self._answer_other(packet, sender)
        if packet.frame_count > self._last_count:
            return self._advance(packet)
        if packet.frame_count == self._last_count:
            return self._repeat()
        if self._is_restart(packet):
            self._reset()
            return self._advance(packet)
        self.counts.late += 1
        return None

    def _answer_other(self, packet: ServoPacket, sender: Hashable) -> bytes | None:
        """Answer a packet from an address that is not the last one."""
        is_first = self._sender is None
        is_quiet = self._time_since_answer() >= QUIET_AFTER
        is_restart = packet.frame_count <= self._last_count
        is_former = sender in self._former_senders
        if not is_first and not is_quiet and (is_former or not is_restart):
            self.counts.late += 1
            return None
        if not is_first:
            self._former_senders.add(self._sender)
            self._former_senders.discard(sender)
        self._sender = sender
        if is_restart:
            self._reset()
        return self._advance(packet)

    def _is_restart(self, packet: ServoPacket) -> bool:
        """Return whether an old frame from the same port has been all that came for some time."""
        now = self._clock()
        if packet.frame_count != self._old_count:
            self._old_count = packet.frame_count
            self._old_count_since = now
        return now - self._old_count_since >= RESTART_AFTER

    def _reset(self) -> None:
        self.counts.resets += 1
        self._vehicle.reset()
        self._last_count = -1

    def _advance(self, packet: ServoPacket) -> bytes:
        """Advance by one frame."""
        if self._last_count >= 0:
            self.counts.missed += packet.frame_count - self._last_count - 1
        self.counts.frames += 1
        self._last_count = packet.frame_count
        self._old_count = -1
        reading = self._vehicle.step(packet.pwm, 1.0 / packet.frame_rate)
        self._answer = write_sensor_line(reading)
        # After the step, which may be slow: packets that were sent again meanwhile are copies.
        self._answered_at = self._clock()
        return self._answer

    def _repeat(self) -> bytes | None:
        """Answer the last frame again, unless it is a copy."""
        self._old_count = -1
        if self._time_since_answer() < REPEAT_AFTER:
            self.counts.doubled += 1
            return None
        self.counts.repeated += 1
        self._answered_at = self._clock()
        return self._answer

    def _time_since_answer(self) -> float:
        return self._clock() - self._answered_at
