"""Beyond the paper: a current across the path, a curved path, and open-loop turning. Simulation only.

The current is what line of sight alone cannot hold against; what the integral does about it is seen beside it. The
curve is followed with and without the fin to its end.
"""

import math
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from laticauda.control import IntegralLineOfSight, LineOfSight, Spline
from laticauda.errors import BadArgument, within
from laticauda.interfaces import Observation, Start
from laticauda.paper.runs import Runs, SteeredRun, Steering, Study, Swimmer, long_enough
from laticauda.paper.settings import path_following_settings, swimmers
from laticauda.quantities import option, quantity, value

Numbers = Float[np.ndarray, " n_offsets"]
CURVES = ("turning_rate", "path_speed", "mechanical_power")


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

    def holds(self, run: SteeredRun) -> bool:
        """Whether a law held the path: its mean error over the last third is within the tolerance.

        Args:
            run: With that law.
        """
        return abs(run.mean_error) < self.tolerance


def drift_run(settings: DriftSettings, law: Steering, runs: Runs) -> SteeredRun:
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
    drifting = replace(swimmer, environment=water, model=runs.model, duration=settings.duration)
    return runs.follow(f"{swimmer.name}, in a current, {law.name}", drifting, law, settings.control_interval)


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


def curved_run(settings: CurvedSettings, swimmer: Swimmer, runs: Runs) -> SteeredRun:
    """One swimmer along the curve, to its end if the time suffices.

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
    there = replace(swimmer, model=runs.model, start=start, duration=settings.most_duration)
    name = f"{swimmer.name}, along a curve"
    return runs.follow(name, there, settings.law, settings.control_interval, path, until=is_past_the_end)


@value
class TurningSettings:
    """Every offset, for every swimmer."""

    offsets: tuple[float, ...] = quantity(
        "rad", "phi_0, rising", gt=0.0, default=tuple(math.radians(value) for value in range(2, 21, 2))
    )
    duration: float = quantity("s", "Of every run, which begins straight and at rest", gt=0.0, default=60.0)
    swimmers: tuple[Swimmer, ...] = option("Who swims: a curve each", default_factory=swimmers)

    def __post_init__(self) -> None:
        """Check what has a range."""
        offsets = self.offsets
        if not offsets or any(after <= before for before, after in pairwise(offsets)):
            raise BadArgument("offsets", f"must hold at least one value [rad] and rise, got {self.offsets}")
        # A turning rate takes two cycles after the transient, which is 10 s or a third of the run.
        longest = max((2.0 * math.pi / one.gait.frequency for one in self.swimmers), default=1.0)
        within("duration", self.duration, max(10.0 + 2.0 * longest, 3.0 * longest), 1e5, "s")


@dataclass(frozen=True, kw_only=True, eq=False)
class TurningCurve:
    """How one swimmer turned, by offset."""

    swimmer: Swimmer
    """Who swam."""
    offset: Numbers
    """phi_0, rising [rad]."""
    turning_rate: Numbers
    """Slope of the cycle-mean heading over the steady part, positive to the left [rad/s]."""
    path_speed: Numbers
    """Length of the center of mass's path / time [m/s]."""
    mechanical_power: Numbers
    """Mean of sum |u phi'| [W]."""

    @property
    def radius(self) -> Numbers:
        """Of the turn, path speed / |turning rate| [m]."""
        return self.path_speed / np.abs(self.turning_rate)


def turning_curve(settings: TurningSettings, swimmer: Swimmer, runs: Runs) -> TurningCurve:
    """One swimmer at every offset.

    Args:
        settings: What is run.
        swimmer: Who swims.
        runs: What runs it.

    Raises:
        SimulationFailed: If a run blows up; the message says which.
    """
    usual = replace(swimmer, model=runs.model, duration=settings.duration)
    turns = {offset: replace(usual, motion=replace(swimmer.gait, offset=offset)) for offset in settings.offsets}
    trials = [runs.swim(f"{swimmer.name}, offset {math.degrees(at):.3g} deg", turn) for at, turn in turns.items()]
    found = {name: np.array([getattr(one, name) for one in trials]) for name in CURVES}
    return TurningCurve(swimmer=swimmer, offset=np.array(settings.offsets), **found)


@dataclass(frozen=True, kw_only=True)
class BeyondSettings:
    """What is run beyond the paper."""

    drift: DriftSettings = field(default_factory=DriftSettings)
    """A current across the path."""
    curved: CurvedSettings = field(default_factory=CurvedSettings)
    """A curved path."""
    turning: TurningSettings = field(default_factory=TurningSettings)
    """Turns with a constant offset."""

    @property
    def n_runs(self) -> int:
        """How many runs all of it takes [-]."""
        turns = len(self.turning.offsets) * len(self.turning.swimmers)
        return len(self.drift.laws) + len(self.curved.swimmers) + turns


@dataclass(frozen=True, kw_only=True, eq=False)
class BeyondStudy(Study[BeyondSettings]):
    """What was run beyond the paper, and what came out."""

    drift: tuple[SteeredRun, ...]
    """One per law."""
    curved: tuple[SteeredRun, ...]
    """One per swimmer."""
    turning: tuple[TurningCurve, ...]
    """One per swimmer."""

    usual = BeyondSettings

    @classmethod
    def by_runs(cls, settings: BeyondSettings, runs: Runs) -> "BeyondStudy":
        """What comes out of `settings`, swum by `runs`."""
        runs.n_runs = settings.n_runs
        return BeyondStudy(
            settings=settings,
            how=runs.how,
            drift=tuple(drift_run(settings.drift, law, runs) for law in settings.drift.laws),
            curved=tuple(curved_run(settings.curved, one, runs) for one in settings.curved.swimmers),
            turning=tuple(turning_curve(settings.turning, one, runs) for one in settings.turning.swimmers),
        )


run_beyond = BeyondStudy.run
