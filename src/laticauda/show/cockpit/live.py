"""A simulation driven by the wall clock, with its data for plotting and saving; no page is needed."""

import math
import threading
from dataclasses import replace
from typing import Unpack

import numpy as np

from laticauda.robot import kinematics
from laticauda.scenarios import Experiment, Scenario, interfaces
from laticauda.show.cockpit.buffer import RingBuffer
from laticauda.show.cockpit.changes import Changes, adapt_scenario
from laticauda.show.cockpit.simulation import TICK, Simulation, begin_simulation
from laticauda.trials import Trial
from laticauda.values import check_within, packaging, series

PLOTTED = 60.0
"""Duration shown in the plots [s]."""
RECORDED = 600.0
"""Duration of the run that is kept for saving [s]."""
MOST_TICKS = 200
"""Ticks in one call at most; time lost by a stopped clock is not made up [-]."""
SLOWEST = 0.1
"""Smallest speed of time [-]."""
FASTEST = 8.0
"""Largest speed of time [-]."""


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
        self._time_owed = 0.0
        self.paused = False
        """Whether the simulation is paused."""
        self.link_forces = False
        """Whether the force on every link is also computed."""
        self.lag = 0.0
        """Total time that was skipped because the computer could not keep up [s]."""
        self._plots = RingBuffer(round(PLOTTED / TICK))
        self._record = RingBuffer(round(RECORDED / TICK))
        self._latest = self._read_sample()

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
        self._speed = check_within("speed", value, SLOWEST, FASTEST)

    # ---- what it has simulated -------------------------------------------------------------------

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
            earlier = self._record.last()
            columns: dict[str, np.ndarray] = {}
            for name, value in _recorded_series(self._latest).items():
                newest = value[None]
                columns[name] = np.concatenate((earlier.get(name, newest[:0]), newest))
            return series.log_of(columns), self.simulation

    def trial(self) -> Trial:
        """Return the run since the scenario was last changed, at most the last ten minutes of it.

        If that covers the whole simulation, the trial contains a scenario, which can be run again;
        for this, time advances to the next control instant. Otherwise it contains an experiment.

        Raises:
            ValueError: If no time has passed since then.
        """
        with self._lock:
            self._advance_to_control_instant()
            log, simulation = self.record()
        if len(log.time) < 2:
            raise ValueError(
                "There is no run to save yet: the settings have only just been changed."
            )
        has_failed = simulation.failure is not None
        state = {} if has_failed else simulation.plant.pack(simulation.state)
        return Trial(
            **vars(log),
            scenario=_run_of_record(log, simulation),
            version=packaging.__version__,
            status=simulation.failure or "The run reached its end.",
            succeeded=not has_failed,
            state=state,
        )

    def _advance_to_control_instant(self) -> None:
        if not math.isfinite(self.scenario.controller.interval):
            return
        while self.simulation.ticks % self.simulation.control_ticks:
            if self.simulation.failure is not None:
                return
            self._tick(forces=False)

    # ---- what it is told -------------------------------------------------------------------------

    def advance(self, wall: float) -> int:
        """Advance the simulation.

        Args:
            wall: Elapsed time of the wall clock [s].

        Returns:
            Number of ticks simulated.
        """
        with self._lock:
            if self.paused or self.simulation.failure is not None:
                self._time_owed = 0.0
                return 0
            n_ticks = self._take_due_ticks(wall)
            for tick in range(n_ticks):
                is_last = tick == n_ticks - 1
                self._tick(forces=self.link_forces and is_last)
                if self.simulation.failure is not None:
                    break
            return n_ticks

    def _take_due_ticks(self, wall: float) -> int:
        """Return how many ticks are due after some time of the wall clock [s]; a fraction of a tick stays owed."""
        self._time_owed += wall * self._speed
        n_ticks = int(self._time_owed / TICK + 1e-9)
        self._time_owed -= n_ticks * TICK
        if n_ticks > MOST_TICKS:
            self.lag += (n_ticks - MOST_TICKS) * TICK
            return MOST_TICKS
        return n_ticks

    def change(self, scenario: Scenario) -> None:
        """Switch to another scenario from now on; see `laticauda.show.cockpit.simulation.Simulation.switch_to`.

        Args:
            scenario: The new scenario.

        Raises:
            ValueError: If the scenario is inconsistent; everything then continues unchanged.
        """
        with self._lock:
            if scenario == self.scenario:
                return
            self.simulation = self.simulation.switch_to(scenario)
            self._record.clear()
            self._latest = self._read_sample()

    def alter(self, **changes: Unpack[Changes]) -> None:
        """Call `change` with the scenario that `changes.adapt_scenario` returns for `changes`.

        Args:
            changes: Fields to change: `robot`, `gait`, `joints`, `environment`, `current` [m/s],
                `path` and the other fields of `laticauda.show.cockpit.changes.Changes`.
        """
        with self._lock:
            self.change(adapt_scenario(self.scenario, **changes))

    def reset(self) -> None:
        """Restart with the current scenario, at its original start."""
        with self._lock:
            self.simulation = begin_simulation(self.scenario, before=self.scenario)
            self._plots.clear()
            self._record.clear()
            self._time_owed = 0.0
            self._latest = self._read_sample()

    # ---- one tick --------------------------------------------------------------------------------

    def _tick(self, *, forces: bool) -> None:
        before = self._latest
        self.simulation, log = self.simulation.advance(link_forces=forces)
        if self.simulation.failure is not None:
            return
        # A sample is the end of a tick; the controller's signals at that instant belong to the next
        # tick.
        signals = {**before.signals, **log.at(0).signals}
        self._record.append(_recorded_series(replace(before, signals=signals)))
        self._latest = log.at(-1)
        self._plots.append(_plotted_row(before, self._latest, self.simulation))

    def _read_sample(self) -> series.Log:
        """Return the first sample of a simulation that was just created or changed, without advancing time."""
        _, log = self.simulation.advance()
        return log.at(0)


def _plotted_row(
    before: series.Log, now: series.Log, simulation: Simulation
) -> dict[str, float | np.ndarray]:
    """Return what is plotted of a tick, from the samples at its two ends."""
    angles = now.joint_angle
    tail = 0
    middle = angles.size // 2
    head = angles.size - 1
    return {
        "time": simulation.time,
        "speed": float(np.linalg.norm(now.center_of_mass_velocity[:2])),
        "power": _work_between(before, now) / TICK,
        "cross_track_error": simulation.cross_track_error,
        "heading": math.degrees(now.heading),
        **read_tilt(now),
        "joint_tail": _angle_deg(angles, tail),
        "joint_middle": _angle_deg(angles, middle),
        "joint_head": _angle_deg(angles, head),
    }


def _work_between(before: series.Log, now: series.Log) -> float:
    """Return the work between two samples, electrical if it is known [J]."""
    if now.electrical_work is not None and before.electrical_work is not None:
        return float(now.electrical_work - before.electrical_work)
    return float(now.work[0] - before.work[0])


def _angle_deg(angles: np.ndarray, joint: int) -> float:
    """Return the angle of a joint; 0 for a robot without joints [deg]."""
    if angles.size == 0:
        return 0.0
    return math.degrees(angles[joint])


def read_tilt(sample: series.Log) -> dict[str, float]:
    """Return depth [m], pitch and roll [deg] of a spatial sample: positive down, and left side up; nan in the plane."""
    if sample.center_of_mass.size == 2:
        return {"depth": math.nan, "pitch": math.nan, "roll": math.nan}
    quaternion = [float(sample.signals[name]) for name in interfaces.ORIENTATION]
    _, left, up = kinematics.from_quaternion(*quaternion)[2]
    return {
        "depth": -float(sample.center_of_mass[2]),
        "pitch": math.degrees(sample.signals["pitch"]),
        "roll": math.degrees(math.atan2(left, up)),
    }


def _recorded_series(sample: series.Log) -> dict[str, np.ndarray]:
    """Return the series that are recorded of a sample."""
    without_loads = replace(
        sample, link_force=None, joint_force=None, joint_moment=None, water_force=None
    )
    return without_loads.series()


def _run_of_record(log: series.Log, simulation: Simulation) -> Scenario | Experiment:
    """Return the scenario of a record if it can be run again, otherwise what the record is of."""
    plant = simulation.plant
    scenario = simulation.scenario
    is_whole = len(log.time) == simulation.ticks + 1
    if is_whole and simulation.has_interval:
        return replace(
            scenario,
            robot=plant.robot,
            environment=plant.environment,
            model=plant.settings,
            duration=simulation.ticks * TICK,
            sample_interval=TICK,
        )
    return Experiment(
        gait=scenario.gait,
        robot=plant.robot,
        environment=plant.environment,
        model=plant.settings,
    )
