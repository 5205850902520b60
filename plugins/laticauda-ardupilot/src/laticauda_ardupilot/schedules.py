"""Random networks between ArduPilot's double and the lock step, in time that nobody waits for.

    python -m laticauda_ardupilot.schedules 10000

A schedule is one run over a network that loses, doubles and delays packets in both directions.
"""

import heapq
import random
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from laticauda_ardupilot.emulator import RESENDS_AFTER, Ardupilot
from laticauda_ardupilot.lock_step import LockStep, Steps
from laticauda_ardupilot.packets import SensorReading

PATIENCE = 600.0
"""Time after which a run is said to hang [s]."""
FRAME_RATES = (50, 200, 400, 1000)
"""Rates among which ArduPilot changes [Hz]."""
SHARE_OF_RATE_CHANGES = 0.05
"""Share of frames after which it does [-]."""
FIRST_PULSE = 1000
"""Pulse of the first frame; that of every frame is one longer than that of the one before [us]."""
NOWHERE = np.zeros(3)
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


@dataclass
class Clockwork:
    """Stands for a vehicle: it has only a time, and remembers its steps."""

    robot: Steps | None = None
    """A vehicle that does each step, too, and whose readings are told."""
    time: float = 0.0
    """[s]."""
    pulses: list[int] = field(default_factory=list[int])
    """First pulse of every step [us]."""
    durations: list[float] = field(default_factory=list[float])
    """Duration of every step [s]."""

    def reset(self) -> None:
        """Start again."""
        self.time = 0.0
        self.pulses = []
        self.durations = []

    def step(self, pwm: tuple[int, ...], duration: float) -> SensorReading:
        """Advance time, and remember the step.

        Args:
            pwm: Pulses [us].
            duration: Duration [s].
        """
        self.time += duration
        self.pulses.append(pwm[0])
        self.durations.append(duration)
        if self.robot is not None:
            return self.robot.step(pwm, duration)
        return SensorReading(
            time=self.time,
            gyro=NOWHERE,
            acceleration=NOWHERE,
            position=NOWHERE,
            velocity=NOWHERE,
            attitude=NOWHERE,
            quaternion=UPRIGHT,
        )


@dataclass(frozen=True, kw_only=True)
class Network:
    """What a network does to packets, in either direction."""

    loss: float
    """Share of packets that are lost."""
    doubling: float
    """Share of the others of which a copy arrives, too."""
    lateness: float
    """Share of packets and copies that are late."""
    latest: float
    """Delay of a late one at most [s]."""

    def delays(self, rng: random.Random) -> list[float]:
        """Return after how long the packet and its copy arrive; nothing if it is lost [s].

        Args:
            rng: Chance.
        """
        if rng.random() < self.loss:
            return []
        n_copies = 2 if rng.random() < self.doubling else 1
        return [self._delay(rng) for _ in range(n_copies)]

    def _delay(self, rng: random.Random) -> float:
        if rng.random() < self.lateness:
            return rng.uniform(0.0, self.latest)
        return rng.uniform(1e-4, 2e-3)


class HangError(AssertionError):
    """ArduPilot waits for ever."""


class Schedule:
    """A run of a number of frames over a random network.

    Args:
        seed: Of all that is random.
        n_frames: Frames whose answers ArduPilot needs.
        robot: What is stepped in place of a clockwork, which then only remembers the steps.
    """

    def __init__(self, seed: int, n_frames: int = 12, robot: Steps | None = None) -> None:
        self._rng = random.Random(seed)
        self.network = Network(
            loss=self._rng.uniform(0.0, 0.4),
            doubling=self._rng.uniform(0.0, 0.4),
            lateness=self._rng.uniform(0.0, 0.3),
            latest=self._rng.choice((0.02, 0.2, 0.9)),
        )
        self._n_frames = n_frames
        self.vehicle = Clockwork(robot=robot)
        self.lock_step = LockStep(self.vehicle, clock=lambda: self.now)
        self.ardupilot = Ardupilot(
            frame_rate=self._rng.choice(FRAME_RATES), n_channels=self._rng.choice((16, 32))
        )
        self.now = 0.0
        """Time of the network [s]."""
        self._port = 1
        self._events: list[tuple[float, int, Callable[[], None]]] = []
        self._n_events = 0
        self._n_sent = 0

    def run(self) -> "Schedule":
        """Run until all frames are answered.

        Raises:
            HangError: If that never happens.
        """
        self._send()
        while self.ardupilot.frame_count < self._n_frames:
            if self.now > PATIENCE:
                raise HangError(f"frame {self.ardupilot.frame_count} is never answered")
            self.now, _, happen = heapq.heappop(self._events)
            happen()
        return self

    def restart_ardupilot(self, *, same_port: bool) -> None:
        """Start ArduPilot anew; what is on its way stays on its way.

        Args:
            same_port: Whether it sends from the port that it had before.
        """
        self.ardupilot = Ardupilot()
        if not same_port:
            self._port += 1

    def _later(self, delay: float, happen: Callable[[], None]) -> None:
        self._n_events += 1
        heapq.heappush(self._events, (self.now + delay, self._n_events, happen))

    def _send(self) -> None:
        """Send the packet of the frame, whose pulse says which one it is."""
        data = self.ardupilot.packet((FIRST_PULSE + self.ardupilot.frame_count,))
        port = self._port
        for delay in self.network.delays(self._rng):
            self._later(delay, lambda: self._reach_robot(data, port))
        self._n_sent += 1
        number = self._n_sent
        self._later(RESENDS_AFTER, lambda: self._send_again(number))

    def _send_again(self, number: int) -> None:
        """Send the packet again, unless another was sent since."""
        if number == self._n_sent:
            self._send()

    def _reach_robot(self, data: bytes, port: int) -> None:
        answer = self.lock_step.answer(data, port)
        if answer is None:
            return
        for delay in self.network.delays(self._rng):
            self._later(delay, lambda: self._reach_ardupilot(answer, port))

    def _reach_ardupilot(self, answer: bytes, port: int) -> None:
        if port != self._port:  # the program that it is for has ended
            return
        self.ardupilot.receive(answer)
        if self._rng.random() < SHARE_OF_RATE_CHANGES:
            self.ardupilot.frame_rate = self._rng.choice(FRAME_RATES)
        self._send()


def main(n_schedules: int) -> None:
    """Run schedules, and print what happened in them.

    Args:
        n_schedules: How many.
    """
    totals = Counter[str]()
    for seed in range(n_schedules):
        schedule = Schedule(seed).run()
        pulses = schedule.vehicle.pulses
        totals["out of order"] += pulses != sorted(set(pulses))
        totals.update(vars(schedule.lock_step.counts))
    print(f"{n_schedules} schedules, no hang; {dict(totals)}")


if __name__ == "__main__":
    main(int(sys.argv[1]))
