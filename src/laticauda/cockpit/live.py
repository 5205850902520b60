"""A world that lives by the clock on the wall, with what is plotted and saved of it; no page is needed."""

import math
import threading
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laticauda.cockpit.ring import Ring
from laticauda.cockpit.settings import Setting
from laticauda.cockpit.world import TICK, World, advance, altered, begin, cross_track_error
from laticauda.errors import within
from laticauda.interfaces import Log, Start
from laticauda.packaging import __version__
from laticauda.robot import has_power_model
from laticauda.trial import Trial, metrics

PLOTTED = 60.0  # what the plots show [s]
RECORDED = 600.0  # how much of the run is kept to be saved [s]
MOST_TICKS = 200  # in one call: a clock that stood still is not caught up with [-]
SPEEDS = (0.1, 8.0)  # of time [-]


@dataclass(frozen=True, kw_only=True, eq=False)
class Numbers:
    """Figures of the run since the setting was last changed; nan where there is none yet."""

    time: float
    """How long that is [s]."""
    forward_velocity: float
    """Equation (5) [m/s]."""
    cycle_velocity: float
    """Displacement over the last gait cycle, per second [m/s]."""
    mean_power: float
    """Electrical with servos or a power model, else mechanical [W]."""
    cost_of_transport: float
    """`mean_power` / (weight of the displaced water x `forward_velocity`) [-]."""
    cross_track_error: float
    """Distance from the path, positive to its left [m]."""
    heading: float
    """Mean link angle (6) [rad]."""


class Live:
    """One world on a clock; may be used from any thread.

    Args:
        setting: What swims how at first.
        start: Where; None: at the origin, along x.

    Raises:
        ValueError: If the setting does not go together.
    """

    def __init__(self, setting: Setting, start: Start | None = None) -> None:
        self._lock = threading.RLock()
        self._start = start
        self._world = begin(setting, start)
        self._speed = 1.0
        self._debt = 0.0
        self.paused = False
        """Whether time stands still."""
        self.link_forces = False
        """Whether the force on every link is computed too."""
        self.lag = 0.0
        """Time that was given up because the computer could not follow, in all [s]."""
        self._plots = Ring(round(PLOTTED / TICK))
        self._record = Ring(round(RECORDED / (2.0 * TICK)))
        self._latest: Log = {}
        self._look()

    @property
    def world(self) -> World:
        """The world as it is."""
        return self._world

    @property
    def setting(self) -> Setting:
        """What swims how."""
        return self._world.setting

    @property
    def speed(self) -> float:
        """Seconds of the world for one second on the wall [-]."""
        return self._speed

    @speed.setter
    def speed(self, value: float) -> None:
        self._speed = within("speed", value, *SPEEDS)

    def latest(self) -> Log:
        """The newest sample, by the names of `Trial`'s fields, without its time axis."""
        with self._lock:
            return dict(self._latest)

    def plots(self, step: int = 1) -> dict[str, np.ndarray]:
        """What is plotted: time, speed, power, cross_track_error, heading and three joint angles.

        Args:
            step: Every how many-th sample.
        """
        with self._lock:
            return self._plots.last(step=step)

    def advance(self, wall: float) -> int:
        """Let time pass.

        Args:
            wall: As much as passed on the wall [s].

        Returns:
            How many ticks the world made.
        """
        with self._lock:
            if self.paused or self._world.failure is not None:
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
                if self._world.failure is not None:
                    break
            return n

    def change(self, setting: Setting) -> None:
        """Swim otherwise from now on; see `laticauda.cockpit.world.altered`.

        Args:
            setting: As it is to be.

        Raises:
            ValueError: If it does not go together; everything goes on as it was then.
        """
        with self._lock:
            if setting == self.setting:
                return
            self._world = altered(self._world, setting)
            self._record.clear()
            self._look()

    def alter(self, **fields: Any) -> None:
        """`change` to the setting with other values of some fields, given as `fields`."""
        with self._lock:
            self.change(replace(self.setting, **fields))

    def reset(self) -> None:
        """Begin anew with the present setting, where it first began."""
        with self._lock:
            self._world = begin(self.setting, self._start)
            self._plots.clear()
            self._record.clear()
            self._debt = 0.0
            self._look()

    def numbers(self) -> Numbers:
        """The figures of the run since the setting was last changed."""
        with self._lock:
            record, world = self._record.last(), self._world
        time, place = record["time"], record["center_of_mass"]
        elapsed = float(time[-1] - time[0])
        nothing = math.nan
        velocity = power = cost = cycle = nothing
        if elapsed > 0.0:
            robot, joints = world.plant.robot, world.setting.joints
            work = record["electrical_work"] if has_power_model(robot, joints) else record["work"][:, 0]
            velocity = metrics.forward_velocity(time, place)
            power = metrics.mean_power(time, work)
            if velocity > 1e-6:
                weight = metrics.carried_weight(robot, world.setting.environment)
                cost = metrics.cost_of_transport(power, weight, velocity)
            cycle = _cycle_velocity(time, place, world.setting.gait.frequency)
        return Numbers(
            time=elapsed,
            forward_velocity=velocity,
            cycle_velocity=cycle,
            mean_power=power,
            cost_of_transport=cost,
            cross_track_error=cross_track_error(world),
            heading=float(self._latest["heading"]),
        )

    def trial(self) -> Trial:
        """The run since the setting was last changed, at most the last ten minutes of it.

        Raises:
            ValueError: If nothing has happened since then.
        """
        with self._lock:
            log, world = self._record.last(), self._world
        if len(log["time"]) < 2:
            raise ValueError("There is no run to save yet: the setting has only just been changed.")
        signals = {name[len("signal_") :]: log.pop(name) for name in list(log) if name.startswith("signal_")}
        followed = {} if world.controller is None else dict(world.controller.settings)
        return Trial(
            **log,  # pyright: ignore[reportArgumentType]  # the plant's names are Trial's own
            robot=world.plant.robot,
            gait=world.setting.gait,
            environment=world.plant.environment,
            settings={**followed, **world.plant.settings},
            signals=signals,
            version=__version__,
            status=world.failure or "The run reached its end.",
            succeeded=world.failure is None,
            state=world.plant.pack(world.state) if world.failure is None else {},
        )

    def _tick(self, *, forces: bool) -> None:
        before = self._latest
        self._world, log = advance(self._world, link_forces=forces)
        if self._world.failure is not None:
            return
        self._latest = {name: np.asarray(values[-1]) for name, values in log.items()}
        self._plots.append(self._plotted(before))
        if self._world.ticks % 2 == 0:
            self._keep()

    def _plotted(self, before: Log) -> dict[str, float | np.ndarray]:
        now, n = self._latest, self._latest["joint_angle"].size
        work = "electrical_work" if "electrical_work" in now and "electrical_work" in before else "work"
        done = np.atleast_1d(now[work] - before[work])[0] / TICK
        row: dict[str, float | np.ndarray] = {
            "time": self._world.time,
            "speed": float(np.linalg.norm(now["center_of_mass_velocity"][:2])),
            "power": float(done),
            "cross_track_error": cross_track_error(self._world),
            "heading": math.degrees(now["heading"]),
        }
        for name, joint in (("tail", 0), ("middle", n // 2), ("head", n - 1)):
            row[f"joint_{name}"] = math.degrees(now["joint_angle"][joint]) if n else 0.0
        return row

    def _keep(self) -> None:
        row = {name: value for name, value in self._latest.items() if not name.startswith("force_")}
        self._record.append(row)

    def _look(self) -> None:
        """Take a first sample of a world that has just been made or changed, without letting time pass."""
        _, log = advance(self._world)
        self._latest = {name: np.asarray(values[0]) for name, values in log.items()}
        self._keep()


def _cycle_velocity(time: np.ndarray, place: np.ndarray, frequency: float) -> float:
    """Displacement over the last cycle per second; nan before there is a whole one."""
    if frequency <= 0.0:
        return math.nan
    n = round(2.0 * math.pi / frequency / (2.0 * TICK))
    if n < 1 or n >= len(time):
        return math.nan
    return float(np.linalg.norm(place[-1] - place[-1 - n]) / (time[-1] - time[-1 - n]))
