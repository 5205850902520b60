"""The stability map: over look-ahead distance and gain, where the loop settles on the path, and where it swings on.

The mean heading over the gait cycle is half a period late. How long a look-ahead distance, and how low a gain, that
takes is asked here, for both gaits without and with the fin; for the raw heading at one gain beside it.
"""

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from jaxtyping import Float, Shaped

from laticauda.control import LineOfSight
from laticauda.errors import BadArgument
from laticauda.interfaces import Start
from laticauda.paper.runs import Runs, Steering, Study, Swimmer, long_enough
from laticauda.paper.settings import at_least_one, swimmers
from laticauda.quantities import option, quantity, value

Grid = Float[np.ndarray, "n_distances n_gains"]
Some = Float[np.ndarray, "*loops"]
Behaviors = Shaped[np.ndarray, "n_distances n_gains"]

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
        at_least_one(self, "look_ahead_distances", "gains", "swimmers")
        # Each third of the run must show a whole gait cycle.
        long_enough("duration", self.duration, self.swimmers, 4.5)

    @property
    def n_runs(self) -> int:
        """How many runs the map takes [-]."""
        return len(self.swimmers) * len(self.look_ahead_distances) * (len(self.gains) + len(self.raw_gains))


@dataclass(frozen=True, kw_only=True, eq=False)
class Loops:
    """The map of one swimmer with one heading: what its loops of all look-ahead distances and gains did."""

    swimmer: Swimmer
    """Who swam."""
    heading: str
    """Which one was used: cycle_mean or raw."""
    look_ahead_distances: Float[np.ndarray, " n_distances"]
    """Delta, rising [m]."""
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
    def behaviors(self) -> Behaviors:
        """One of `BEHAVIORS` per look-ahead distance and gain; see `behavior`."""
        return behavior(self.rms, self.rms_before, self.tolerance)

    @property
    def shortest(self) -> tuple[float | None, ...]:
        """By gain, the shortest look-ahead distance that settles and is longer than all that swing; None if none is."""
        found: list[float | None] = []
        for column in self.behaviors.T:
            n_swinging = int(np.max(np.flatnonzero(column == SWINGS), initial=-1)) + 1
            settled = self.look_ahead_distances[n_swinging:][column[n_swinging:] == SETTLED]
            found.append(float(settled[0]) if settled.size else None)
        return tuple(found)


@dataclass(frozen=True, kw_only=True, eq=False)
class StabilityStudy(Study[StabilitySettings]):
    """What was run for the stability maps, and what came out."""

    maps: tuple[Loops, ...]
    """Two per swimmer of the settings: with the mean heading over the gait cycle, and with the raw one."""

    usual = StabilitySettings

    @classmethod
    def by_runs(cls, settings: StabilitySettings, runs: Runs) -> "StabilityStudy":
        """What comes out of `settings`, swum by `runs`."""
        runs.n_runs = settings.n_runs
        gains = {"cycle_mean": settings.gains, "raw": settings.raw_gains}
        maps = [_loops(settings, one, *each, runs) for one in settings.swimmers for each in gains.items()]
        return StabilityStudy(settings=settings, how=runs.how, maps=tuple(maps))


run_stability = StabilityStudy.run


def behavior(rms: Some, rms_before: Some, tolerance: float) -> Shaped[np.ndarray, "*loops"]:
    """What loops do, by their cycle-mean cross-track error.

    One has settled if the error's root mean square over the last third of the run is below the tolerance. If not, it
    swings in a limit cycle, unless the mean square has at least halved since the second third: then it is still coming.

    Args:
        rms: Root mean square over the last third [m].
        rms_before: The same over the second third [m].
        tolerance: [m].

    Returns:
        One of `BEHAVIORS` per loop.

    Example:
        >>> behavior(np.array([0.07, 0.07, 0.04]), np.array([0.08, 0.2, 0.04]), 0.05).tolist()
        ['limit cycle', 'still coming', 'settled']
    """
    return np.where(rms < tolerance, SETTLED, np.where(rms * rms <= 0.5 * rms_before * rms_before, COMING, SWINGS))


def _loops(settings: StabilitySettings, swimmer: Swimmer, heading: str, gains: tuple[float, ...], runs: Runs) -> Loops:
    """Every look-ahead distance with every gain."""
    interval = settings.control_interval
    start = Start(center_of_mass=(0.0, settings.initial_cross_track_error))
    alike = replace(swimmer, model=runs.model, start=start, duration=settings.duration, sample_interval=interval)
    found = np.zeros((3, len(settings.look_ahead_distances), len(gains)))
    for i, distance in enumerate(settings.look_ahead_distances):
        for j, gain in enumerate(gains):
            name = f"{swimmer.name}, look-ahead distance {distance:g} m, gain {gain:g}, {heading} heading"
            guidance = LineOfSight(look_ahead_distance=distance)
            limits: dict[str, Any] = {"max_offset": settings.max_offset, "heading_estimate": heading}
            run = runs.follow(name, alike, Steering(name=name, guidance=guidance, gain=gain, **limits), interval)
            found[:, i, j] = run.rms(2.0), run.rms(1.0, 2.0), run.trial.forward_velocity
    rms, rms_before, velocity = found
    return Loops(
        swimmer=swimmer,
        heading=heading,
        look_ahead_distances=np.array(settings.look_ahead_distances),
        gains=np.array(gains),
        rms=rms,
        rms_before=rms_before,
        forward_velocity=velocity,
        tolerance=settings.tolerance,
    )
