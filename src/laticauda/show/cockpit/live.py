"""A simulation driven by the wall clock, with its data for plotting and saving; no page is needed."""

import math
import threading
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Unpack

import numpy as np

from laticauda.robot import kinematics
from laticauda.scenarios import Experiment, Scenario, interfaces
from laticauda.show.cockpit.simulation import (
    TICK,
    Changes,
    Simulation,
    adapt_scenario,
    begin_simulation,
)
from laticauda.trials import Trial
from laticauda.values import packaging, series
from laticauda.values.checks import check_within

PLOTTED = 60.0  # duration shown in the plots [s]
RECORDED = 600.0  # duration of the run that is kept for saving [s]
MOST_TICKS = 200  # in one call; time lost by a stopped clock is not made up [-]
SPEEDS = (0.1, 8.0)  # of time [-]


class RingBuffer:
    """Fixed-size buffer of the last rows of named columns, each a number or an array of a fixed shape.

    Args:
        capacity: Number of rows that are kept [-].
    """

    def __init__(self, capacity: int) -> None:
        self.capacity = capacity
        self._columns: dict[str, np.ndarray] = {}
        self._end = 0

    def clear(self) -> None:
        """Remove all rows, and forget their shapes."""
        self._columns, self._end = {}, 0

    def append(self, row: Mapping[str, float | np.ndarray]) -> None:
        """Append a row; the oldest one is dropped if there is no room.

        Args:
            row: A value for every column; the first row defines the columns.
        """
        if not self._columns:
            self._columns = {
                name: np.empty((2 * self.capacity, *np.shape(value))) for name, value in row.items()
            }
        if (
            self._end == 2 * self.capacity
        ):  # the newer half moves to the front: rows stay contiguous
            for column in self._columns.values():
                column[: self.capacity] = column[self.capacity :]
            self._end = self.capacity
        for name, column in self._columns.items():
            column[self._end] = row[name]
        self._end += 1

    def last(self, step: int = 1) -> dict[str, np.ndarray]:
        """Return copies of the rows by column, oldest first.

        Args:
            step: Return every `step`-th row, including the newest.
        """
        first = max(self._end - self.capacity, 0)
        return {
            name: column[first : self._end][::-step][::-1].copy()
            for name, column in self._columns.items()
        }


class Live:
    """One simulation in real time; may be used from any thread.

    Args:
        scenario: Initial scenario, including its start; its duration is ignored.

    Raises:
        ValueError: If the scenario is inconsistent, or a page cannot show it.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._lock = threading.RLock()
        self.simulation: Simulation = begin_simulation(scenario)
        """Current simulation."""
        self._speed = 1.0
        self._debt = 0.0
        self.paused = False
        """Whether the simulation is paused."""
        self.link_forces = False
        """Whether the force on every link is also computed."""
        self.lag = 0.0
        """Total time that was skipped because the computer could not keep up [s]."""
        self._plots = RingBuffer(round(PLOTTED / TICK))
        self._record = RingBuffer(round(RECORDED / TICK))
        self._latest = self._sample()

    @property
    def scenario(self) -> Scenario:
        """Current scenario."""
        return self.simulation.scenario

    @property
    def speed(self) -> float:
        """Simulated seconds per second of the wall clock [-]."""
        return self._speed

    @speed.setter
    def speed(self, value: float) -> None:
        self._speed = check_within("speed", value, *SPEEDS)

    def latest(self) -> series.Log:
        """Return the newest sample, without a time axis."""
        return self._latest

    def plots(self, step: int = 1) -> dict[str, np.ndarray]:
        """Return time, speed, power, cross_track_error, heading, depth, pitch, roll and three joint angles for plots.

        Args:
            step: Return every `step`-th sample.
        """
        with self._lock:
            return self._plots.last(step)

    def record(self) -> tuple[series.Log, Simulation]:
        """Return the samples since the last change of the scenario, at most ten minutes, and the current simulation."""
        with self._lock:
            before, now = self._record.last(), _series(self._latest)
            log = {
                name: np.concatenate((before.get(name, one[None][:0]), one[None]))
                for name, one in now.items()
            }
            return series.log_of(log), self.simulation

    def advance(self, wall: float) -> int:
        """Advance the simulation.

        Args:
            wall: Elapsed time of the wall clock [s].

        Returns:
            Number of ticks simulated.
        """
        with self._lock:
            if self.paused or self.simulation.failure is not None:
                self._debt = 0.0
                return 0
            self._debt += wall * self._speed
            n = int(self._debt / TICK + 1e-9)
            self._debt -= n * TICK
            if n > MOST_TICKS:
                self.lag += (n - MOST_TICKS) * TICK
                n = MOST_TICKS
            for k in range(n):
                self._tick(forces=self.link_forces and k == n - 1)
                if self.simulation.failure is not None:
                    break
            return n

    def change(self, scenario: Scenario) -> None:
        """Switch to another scenario from now on; see `laticauda.show.cockpit.simulation.Simulation.altered`.

        Args:
            scenario: The new scenario.

        Raises:
            ValueError: If the scenario is inconsistent; everything then continues unchanged.
        """
        with self._lock:
            if scenario == self.scenario:
                return
            self.simulation = self.simulation.altered(scenario)
            self._record.clear()
            self._latest = self._sample()

    def alter(self, **changes: Unpack[Changes]) -> None:
        """Call `change` with the scenario that `simulation.adapt_scenario` returns for `changes`.

        Args:
            changes: Fields to change: `robot`, `gait`, `joints`, `environment`, `current` [m/s],
                `path` and the other fields of `laticauda.show.cockpit.simulation.Changes`.
        """
        with self._lock:
            self.change(adapt_scenario(self.scenario, **changes))

    def reset(self) -> None:
        """Restart with the current scenario, at its original start."""
        with self._lock:
            self.simulation = begin_simulation(self.scenario)
            self._plots.clear()
            self._record.clear()
            self._debt = 0.0
            self._latest = self._sample()

    def trial(self) -> Trial:
        """Return the run since the scenario was last changed, at most the last ten minutes of it.

        If that covers the whole simulation, the trial contains a scenario, which can be run again;
        for this, time advances to the next control instant. Otherwise it contains an experiment.

        Raises:
            ValueError: If no time has passed since then.
        """
        with self._lock:
            controller = self.scenario.controller
            while (
                math.isfinite(controller.interval)
                and self.simulation.ticks % self.simulation.control_ticks
            ):
                if self.simulation.failure is not None:
                    break
                self._tick(forces=False)
            log, now = self.record()
        if len(log.time) < 2:
            raise ValueError(
                "There is no run to save yet: the settings have only just been changed."
            )
        swum = now.plant
        body: dict[str, Any] = {
            "robot": swum.robot,
            "environment": swum.environment,
            "model": swum.settings,
        }
        is_whole = len(log.time) == now.ticks + 1 and now.has_interval
        span = {"duration": now.ticks * TICK, "sample_interval": TICK}
        return Trial(
            **vars(log),
            scenario=replace(now.scenario, **body, **span)
            if is_whole
            else Experiment(gait=now.scenario.gait, **body),
            version=packaging.__version__,
            status=now.failure or "The run reached its end.",
            succeeded=now.failure is None,
            state=now.plant.pack(now.state) if now.failure is None else {},
        )

    def _tick(self, *, forces: bool) -> None:
        before = self._latest
        self.simulation, log = self.simulation.advance(link_forces=forces)
        if self.simulation.failure is not None:
            return
        # A sample is the end of a tick; the controller's signals at that instant belong to the next
        # tick.
        self._record.append(
            _series(replace(before, signals={**before.signals, **log.at(0).signals}))
        )
        self._latest = log.at(-1)
        self._plots.append(self._plotted(before))

    def _plotted(self, before: series.Log) -> dict[str, float | np.ndarray]:
        now, n = self._latest, self._latest.joint_angle.size
        if now.electrical_work is not None and before.electrical_work is not None:
            work = float(now.electrical_work - before.electrical_work)
        else:
            work = float(now.work[0] - before.work[0])
        row: dict[str, float | np.ndarray] = {
            "time": self.simulation.time,
            "speed": float(np.linalg.norm(now.center_of_mass_velocity[:2])),
            "power": work / TICK,
            "cross_track_error": self.simulation.cross_track_error,
            "heading": math.degrees(now.heading),
            **read_tilt(now),
        }
        for name, joint in (("tail", 0), ("middle", n // 2), ("head", n - 1)):
            row[f"joint_{name}"] = math.degrees(now.joint_angle[joint]) if n else 0.0
        return row

    def _sample(self) -> series.Log:
        """Return the first sample of a simulation that was just created or changed, without advancing time."""
        return self.simulation.advance()[1].at(0)


def read_tilt(sample: series.Log) -> dict[str, float]:
    """Return depth [m], pitch and roll [deg] of a spatial sample: positive down, and left side up; nan in the plane."""
    if sample.center_of_mass.size == 2:
        return dict.fromkeys(("depth", "pitch", "roll"), math.nan)
    left, up = kinematics.from_quaternion(
        *(float(sample.signals[name]) for name in interfaces.ORIENTATION)
    )[2, 1:]
    pitch = math.degrees(sample.signals["pitch"])
    return {
        "depth": -float(sample.center_of_mass[2]),
        "pitch": pitch,
        "roll": math.degrees(math.atan2(left, up)),
    }


def _series(sample: series.Log) -> dict[str, np.ndarray]:
    """Return the series that are recorded of a sample."""
    return replace(sample, link_force=None).series()
