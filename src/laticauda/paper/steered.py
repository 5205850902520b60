"""Steered beyond the paper: in a current across the path, and along a curve.

The current is what line of sight alone cannot hold against; what the integral does about it is seen beside it. The
curve is followed with and without the fin to its end.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from laticauda.control import IntegralLineOfSight, LineOfSight, Spline, StraightLine
from laticauda.interfaces import Observation, Start
from laticauda.paper.runs import Runs, Steering, Swimmer, long_enough
from laticauda.paper.settings import path_following_settings, swimmers
from laticauda.quantities import option, quantity, value
from laticauda.trial import Trial
from laticauda.trial.cycles import CycleMean, cycle_mean
from laticauda.trial.following import last_third_error, mean_error


def drift_laws() -> tuple[Steering, ...]:
    """Line of sight and its integral at the same gains, and line of sight at the paper's; all with the raw heading."""
    plain = LineOfSight(look_ahead_distance=1.62)
    integral = IntegralLineOfSight(look_ahead_distance=1.62, integral_gain=0.12)
    paper = path_following_settings().steering()
    limit = paper.max_offset
    return (
        Steering(name="line of sight", guidance=plain, gain=0.25, max_offset=limit),
        Steering(name="integral line of sight", guidance=integral, gain=0.25, max_offset=limit),
        replace(paper, name="line of sight, the paper's gains"),
    )


def _swimmer() -> Swimmer:
    """Lateral undulation with the fin."""
    return next(one for one in swimmers() if one.has_fin and one.gait.kind == "lateral_undulation")


@value
class DriftSettings:
    """One swimmer along the x axis in a current, steered by one law after the other."""

    swimmer: Swimmer = option("Who swims", default_factory=_swimmer)
    current: tuple[float, float] = quantity("m/s", "Velocity that the water moves to, world axes", default=(0.0, 0.05))
    laws: tuple[Steering, ...] = option("How it is steered: a run each", default_factory=drift_laws)
    duration: float = quantity("s", "Of every run, which begins on the path, along it and at rest", default=180.0)
    control_interval: float = quantity("s", "Between two control instants", gt=0.0, default=0.05)
    tolerance: float = quantity("m", "Largest mean error at the end of a law that holds", gt=0.0, default=0.05)

    def __post_init__(self) -> None:
        """Check what has a range."""
        long_enough("duration", self.duration, (self.swimmer,), 5.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class DriftRun:
    """What one law did in the current."""

    law: Steering
    """How it was steered."""
    trial: Trial
    """The run."""
    error: CycleMean
    """The cycle-mean cross-track error over time [s], [m]."""
    mean_error: float
    """Its mean over the last third of the run [m]."""
    rms_error: float
    """Its root mean square there: a swing about the path has little mean, and shows in this [m]."""
    largest_error: float
    """The largest of it on the way, with its sign [m]."""
    final_error: float
    """The last of it, around half a cycle before the end [m]."""
    tolerance: float
    """Largest mean error of a law that holds the path [m]."""

    @property
    def geometric_error(self) -> float:
        """What line of sight keeps in steady drift, where it heads for its point ahead: Delta tan(sideslip) [m].

        The integral takes this error off.
        """
        return self.law.guidance.look_ahead_distance * math.tan(self.trial.sideslip)

    @property
    def holds(self) -> bool:
        """Whether the mean error over the last third is within the tolerance."""
        return abs(self.mean_error) < self.tolerance


def drift_run(settings: DriftSettings, law: Steering, runs: Runs) -> DriftRun:
    """One law in the current.

    Args:
        settings: Who swims, in which current, for how long.
        law: How it is steered.
        runs: What runs it.

    Raises:
        SimulationFailed: If the run blows up; the message says which.
    """
    swimmer = settings.swimmer
    water = replace(swimmer.environment, current=settings.current)
    controller = law.controller(swimmer.gait, StraightLine(), settings.control_interval)
    scenario = replace(swimmer, motion=controller, environment=water, model=runs.model, duration=settings.duration)
    trial = runs.swim(f"{swimmer.name}, in a current, {law.name}", scenario)
    assert trial.period is not None
    measured = trial.time, trial.signals["cross_track_error"], trial.period
    error = mean_error(*measured)
    last = error.value[error.time >= 2.0 / 3.0 * trial.duration]
    return DriftRun(
        law=law,
        trial=trial,
        error=error,
        mean_error=last_third_error(*measured),
        rms_error=math.sqrt(float(np.mean(last * last))),
        largest_error=float(error.value[abs(error.value).argmax()]),
        final_error=float(error.value[-1]),
        tolerance=settings.tolerance,
    )


Waypoints = tuple[tuple[float, float], ...]


@value
class CurvedSettings:
    """Every swimmer along one curve."""

    waypoints: Waypoints = option(
        "What the curve goes through; x and y in world axes",
        default=((0.0, 0.0), (2.0, 1.0), (4.0, 0.0), (6.0, -1.0), (8.0, 0.0)),
    )
    law: Steering = option("How every swimmer is steered", default_factory=lambda: path_following_settings().steering())
    most_duration: float = quantity("s", "After which a run ends before the end of the curve", gt=0.0, default=150.0)
    control_interval: float = quantity("s", "Between two control instants", gt=0.0, default=0.1)
    swimmers: tuple[Swimmer, ...] = option("Who swims, from the begin of the curve, at rest", default_factory=swimmers)

    def __post_init__(self) -> None:
        """Check what has a range."""
        _ = self.path  # a curve that cannot be is refused now
        long_enough("most_duration", self.most_duration, self.swimmers, 2.0)

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


def curved_run(settings: CurvedSettings, swimmer: Swimmer, runs: Runs) -> CurvedRun:
    """One swimmer along the curve.

    Args:
        settings: The curve, and how it is followed.
        swimmer: Who swims.
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
    scenario = replace(swimmer, motion=controller, model=runs.model, start=start, duration=settings.most_duration)
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
