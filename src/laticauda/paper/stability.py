"""The stability map: over look-ahead distance and gain, where the loop settles on the path, and where it swings on.

The mean heading over the gait cycle is half a period late. How long a look-ahead distance, and how low a gain, that
takes is asked here, for both gaits without and with the fin; for the raw heading at one gain beside it.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from laticauda.control import LineOfSight, StraightLine
from laticauda.errors import BadArgument
from laticauda.interfaces import Start
from laticauda.packaging import __version__
from laticauda.paper.swimmers import Steering, Swimmer, how_made, in_water, long_enough, run_named, swimmers
from laticauda.quantities import option, quantity, value
from laticauda.studies.progress import Progress
from laticauda.trial import Trial
from laticauda.trial.contents import Setting
from laticauda.trial.following import mean_error

Grid = Float[np.ndarray, "n_distances n_gains"]

SETTLED, SWINGS, COMING = "settled", "limit cycle", "still coming"
BEHAVIORS = (SETTLED, SWINGS, COMING)
"""What a loop does: settles on the path, swings on about it, or is still on its way at the end of the run."""


@value
class StabilitySettings:
    """What the stability map runs: every look-ahead distance with every gain, for every swimmer."""

    look_ahead_distances: tuple[float, ...] = quantity(
        "m",
        "Delta, rising: half a link to twice the robot with its fin",
        gt=0.0,
        default=(0.09, 0.18, 0.36, 0.54, 0.9, 1.62, 3.24, 4.24),
    )
    gains: tuple[float, ...] = quantity(
        "", "k with the mean heading over the gait cycle, rising", gt=0.0, default=(0.1, 0.2, 0.3, 0.4, 0.6, 0.8)
    )
    raw_gains: tuple[float, ...] = quantity("", "k with the raw heading; none leaves it out", gt=0.0, default=(0.4,))
    paper: tuple[float, float] = quantity(
        "", "The paper's look-ahead distance [m] and gain [-], to be marked", default=(0.18, 0.4)
    )
    max_offset: float = quantity("rad", "Largest offset to either side", gt=0.0, default=math.radians(20.0))
    initial_cross_track_error: float = quantity("m", "Where every run begins, along it, at rest", default=0.5)
    duration: float = quantity("s", "Of every run", default=120.0)
    control_interval: float = quantity("s", "Between two control instants", gt=0.0, default=0.2)
    tolerance: float = quantity("m", "Largest rms of the mean error of a loop that has settled", gt=0.0, default=0.05)
    swimmers: tuple[Swimmer, ...] = option("Who swims: a map each", default_factory=swimmers)

    def __post_init__(self) -> None:
        """Check what has a range."""
        for name in ("look_ahead_distances", "gains", "raw_gains"):
            values = getattr(self, name)
            if any(after <= before for before, after in pairwise(values)):
                raise BadArgument(name, f"must rise, got {', '.join(f'{value:g}' for value in values)}")
        for name in ("look_ahead_distances", "gains", "swimmers"):
            if not getattr(self, name):
                raise BadArgument(name, "must hold at least one entry, got none")
        # Each third of the run must show a whole gait cycle.
        gaits = tuple(swimmer.gait for swimmer in self.swimmers)
        long_enough("duration", self.duration, gaits, 4.5)

    @property
    def n_runs(self) -> int:
        """How many runs the map takes [-]."""
        return len(self.swimmers) * len(self.look_ahead_distances) * (len(self.gains) + len(self.raw_gains))


@dataclass(frozen=True, kw_only=True, eq=False)
class Loops:
    """What loops of all look-ahead distances and some gains did."""

    gains: Float[np.ndarray, " n_gains"]
    """k [-]."""
    rms: Grid
    """Root mean square of the cycle-mean cross-track error over the last third of the run [m]."""
    rms_before: Grid
    """The same over the second third [m]."""
    forward_velocity: Grid
    """Equation (5): a loop that swings loses speed [m/s]."""
    tolerance: float
    """Largest `rms` of a loop that has settled [m]."""

    @property
    def behaviors(self) -> tuple[tuple[str, ...], ...]:
        """One of `BEHAVIORS` per look-ahead distance and gain; see `behavior`."""
        pairs = zip(self.rms.tolist(), self.rms_before.tolist(), strict=True)
        return tuple(
            tuple(behavior(last, before, self.tolerance) for last, before in zip(*row, strict=True)) for row in pairs
        )

    def shortest(self, look_ahead_distances: tuple[float, ...]) -> tuple[float | None, ...]:
        """By gain, the shortest look-ahead distance that settles and is longer than all that swing; None if none is.

        Args:
            look_ahead_distances: Those of the map [m].
        """
        found: list[float | None] = []
        for column in zip(*self.behaviors, strict=True):
            n_swinging = max((i + 1 for i, one in enumerate(column) if one == SWINGS), default=0)
            settled = (i for i, one in enumerate(column) if i >= n_swinging and one == SETTLED)
            at = next(settled, None)
            found.append(None if at is None else look_ahead_distances[at])
        return tuple(found)


@dataclass(frozen=True, kw_only=True, eq=False)
class StabilityMap:
    """The map of one swimmer."""

    swimmer: Swimmer
    """Who swam."""
    cycle_mean: Loops
    """With the mean heading over the gait cycle."""
    raw: Loops
    """With the raw heading, at its gains."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StabilityStudy:
    """What was run for the stability maps, and what came out."""

    settings: StabilitySettings
    """What was run."""
    how: Mapping[str, Setting]
    """How every run was computed: model, joints, dt [s], offset_bandwidth [rad/s], ramp [s]."""
    version: str
    """Version of laticauda that ran it."""
    maps: tuple[StabilityMap, ...]
    """One per swimmer of the settings."""


def behavior(rms: float, rms_before: float, tolerance: float) -> str:
    """What a loop does, by its cycle-mean cross-track error.

    It has settled if the error's root mean square over the last third of the run is below the tolerance. If not, it
    swings in a limit cycle, unless the mean square has at least halved since the second third: then it is still coming.

    Args:
        rms: Root mean square over the last third [m].
        rms_before: The same over the second third [m].
        tolerance: [m].

    Returns:
        One of `BEHAVIORS`.

    Example:
        >>> behavior(0.07, 0.08, 0.05), behavior(0.07, 0.2, 0.05), behavior(0.04, 0.04, 0.05)
        ('limit cycle', 'still coming', 'settled')
    """
    if rms < tolerance:
        return SETTLED
    return COMING if rms * rms <= 0.5 * rms_before * rms_before else SWINGS


def run_stability(
    settings: StabilitySettings | None = None,
    *,
    model: str = "planar",
    joints: str = "prescribed",
    offset_bandwidth: float = 10.0,
    progress: Progress | None = None,
) -> StabilityStudy:
    """Run every loop of the stability maps.

    Args:
        settings: None takes the defaults.
        model: See `laticauda.simulate.plant`.
        joints: See `laticauda.simulate.plant`.
        offset_bandwidth: See `laticauda.simulate.plant` [rad/s].
        progress: Called after every run with the number of runs done, and of all.

    Raises:
        ValueError: If an argument is out of its range.
        SimulationFailed: If a run blows up; the message says which.
    """
    settings = settings or StabilitySettings()
    how: dict[str, Setting] = {}
    n_done = 0

    def loops(swimmer: Swimmer, estimate: str, gains: tuple[float, ...]) -> Loops:
        nonlocal n_done
        body = in_water(swimmer, model=model, joints=joints, offset_bandwidth=offset_bandwidth)
        found = np.zeros((3, len(settings.look_ahead_distances), len(gains)))
        for i, distance in enumerate(settings.look_ahead_distances):
            for j, gain in enumerate(gains):
                name = f"{swimmer.name}, look-ahead distance {distance:g} m, gain {gain:g}, {estimate} heading"
                steering = Steering(
                    name=name,
                    guidance=LineOfSight(look_ahead_distance=distance),
                    gain=gain,
                    max_offset=settings.max_offset,
                    heading_estimate=estimate,
                )
                trial = run_named(
                    name,
                    body,
                    steering.controller(swimmer.gait, StraightLine(), settings.control_interval),
                    settings.duration,
                    start=Start(center_of_mass=(0.0, settings.initial_cross_track_error)),
                    sample_interval=settings.control_interval,
                )
                how.update(how_made(trial))
                found[:, i, j] = *_errors(trial), trial.forward_velocity
                n_done += 1
                if progress is not None:
                    progress(n_done, settings.n_runs)
        rms, rms_before, velocity = found
        return Loops(
            gains=np.array(gains),
            rms=rms,
            rms_before=rms_before,
            forward_velocity=velocity,
            tolerance=settings.tolerance,
        )

    maps = tuple(
        StabilityMap(
            swimmer=swimmer,
            cycle_mean=loops(swimmer, "cycle_mean", settings.gains),
            raw=loops(swimmer, "raw", settings.raw_gains),
        )
        for swimmer in settings.swimmers
    )
    return StabilityStudy(settings=settings, how=how, version=__version__, maps=maps)


def _errors(trial: Trial) -> tuple[float, float]:
    """Root mean square of the cycle-mean error over the last third of the run, and over the second [m]."""
    assert trial.period is not None
    time, error = mean_error(trial.time, trial.signals["cross_track_error"], trial.period)
    third = trial.duration / 3.0
    last, second = time >= 2.0 * third, (time >= third) & (time < 2.0 * third)
    squared = error * error
    return math.sqrt(float(np.mean(squared[last]))), math.sqrt(float(np.mean(squared[second])))
