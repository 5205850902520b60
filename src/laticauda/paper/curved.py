"""A curved path: a smooth curve through waypoints, followed with and without the fin to its end."""

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from laticauda.control import LineOfSight, Spline
from laticauda.interfaces import Observation, Start
from laticauda.paper.runs import Runs, Steering, Swimmer, long_enough
from laticauda.paper.settings import swimmers
from laticauda.quantities import option, quantity, value
from laticauda.scenarios import Model
from laticauda.trial import Trial
from laticauda.trial.cycles import CycleMean, cycle_mean
from laticauda.trial.following import mean_error

Waypoints = tuple[tuple[float, float], ...]


def curved_law() -> Steering:
    """Line of sight at the paper's gains, raw heading."""
    guidance = LineOfSight(look_ahead_distance=0.18)
    return Steering(name="the paper's gains", guidance=guidance, gain=0.4, max_offset=math.radians(20.0))


@value
class CurvedSettings:
    """Every swimmer along one curve."""

    waypoints: Waypoints = option(
        "What the curve goes through; x and y in world axes",
        default=((0.0, 0.0), (2.0, 1.0), (4.0, 0.0), (6.0, -1.0), (8.0, 0.0)),
    )
    law: Steering = option("How every swimmer is steered", default_factory=curved_law)
    most_duration: float = quantity("s", "After which a run ends before the end of the curve", gt=0.0, default=150.0)
    control_interval: float = quantity("s", "Between two control instants", gt=0.0, default=0.1)
    swimmers: tuple[Swimmer, ...] = option("Who swims, from the begin of the curve, at rest", default_factory=swimmers)

    def __post_init__(self) -> None:
        """Check what has a range."""
        _ = self.path  # a curve that cannot be is refused now
        gaits = tuple(swimmer.gait for swimmer in self.swimmers)
        long_enough("most_duration", self.most_duration, gaits, 2.0)

    @property
    def path(self) -> Spline:
        """The curve."""
        return Spline(waypoints=self.waypoints)

    @property
    def tightest_radius(self) -> float:
        """Smallest radius of curvature of the curve [m]."""
        path = self.path
        steps = np.diff(path.points(np.linspace(0.0, path.length, 2001)), axis=0)
        turns = np.abs(np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))))
        sharpest = float(np.max(turns)) / (path.length / 2000.0)
        return 1.0 / sharpest if sharpest > 1e-9 else math.inf

    @property
    def n_runs(self) -> int:
        """How many runs it takes [-]."""
        return len(self.swimmers)


@dataclass(frozen=True, kw_only=True, eq=False)
class CurvedRun:
    """What one swimmer did on the curve."""

    swimmer: Swimmer
    """Who swam."""
    trial: Trial
    """The run."""
    reached_end: bool
    """Whether it came past the end of the curve."""
    error: CycleMean
    """The cycle-mean cross-track error over time [s], [m]."""
    along: Float[np.ndarray, " n_middles"]
    """Cycle mean of how far along the curve it was then [m]."""
    rms: float
    """Root mean square of the error [m]."""
    largest: float
    """The largest of it to either side, without sign [m]."""


def curved_run(settings: CurvedSettings, swimmer: Swimmer, model: Model, runs: Runs) -> CurvedRun:
    """One swimmer along the curve.

    Args:
        settings: The curve, and how it is followed.
        swimmer: Who swims.
        model: By which model.
        runs: What runs it.

    Raises:
        SimulationFailed: If the run blows up; the message says which.
    """
    path = settings.path
    end = path.points(np.array([path.length - 1e-3, path.length]))
    begin = path.points(np.array([0.0, 1e-3]))

    def is_past_the_end(observation: Observation) -> bool:
        return float((observation.center_of_mass[:2] - end[1]) @ (end[1] - end[0])) >= 0.0

    ahead = begin[1] - begin[0]
    x, y = begin[0]
    start = Start(center_of_mass=(float(x), float(y)), heading=math.atan2(float(ahead[1]), float(ahead[0])))
    controller = settings.law.controller(swimmer.gait, path, settings.control_interval)
    scenario = replace(swimmer, motion=controller, model=model, start=start, duration=settings.most_duration)
    trial = runs.swim(f"{swimmer.name}, along a curve", scenario, until=is_past_the_end)
    assert trial.period is not None
    error = mean_error(trial.time, trial.signals["cross_track_error"], trial.period)
    along = trial.signals["along_track_distance"]
    rate = np.asarray(np.gradient(along, trial.time), dtype=np.float64)
    return CurvedRun(
        swimmer=swimmer,
        trial=trial,
        reached_end=trial.duration < settings.most_duration - 0.5 * settings.control_interval,
        error=error,
        along=np.asarray(cycle_mean(trial.time, along, rate, trial.period).value),
        rms=math.sqrt(float(np.mean(error.value**2))),
        largest=float(np.max(np.abs(error.value))),
    )
