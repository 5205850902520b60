"""What a sweep is: one robot, gait and water over thousands to millions of points."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.errors import instance, whole
from laticauda.packaging import __version__
from laticauda.simulate.numbers import check_whole
from laticauda.studies.regions import Regions, cut
from laticauda.studies.sampling import Grid, Points, Rows, Samples
from laticauda.studies.trials import Setup, check_ranges

if TYPE_CHECKING:
    from laticauda.studies.trials import Table

# What a region should take on one core, and what a trial of ten links and 30 s takes there, roughly [s].
REGION_TIME = 1.5
TRIAL_TIME = {"prescribed": 0.35e-3, "pd": 5e-3, "servo": 5e-3}
LEAST_SIZE, MOST_SIZE = 64, 16384


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep(Setup):
    """What to sweep: a setup, and the points that change numbers of it.

    Raises:
        ValueError: If a field is out of its range, a parameter does not exist (the message has the nearest names), or
            a value is out of the parameter's range.

    Example:
        >>> import laticauda as lc
        >>> sweep = Sweep(
        ...     robot=lc.load_robot("mamba"),
        ...     gait=lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7),
        ...     points=Grid(values={"gait.amplitude": [0.3, 0.5], "water.normal_drag": [1.0, 1.5, 2.0]}),
        ... )
        >>> sweep.n_trials
        6
    """

    points: Points
    """Which points: `Grid`, `Rows` or `Samples`."""

    def __post_init__(self) -> None:
        """Check every field once."""
        super().__post_init__()
        instance("points", self.points, Grid, Rows, Samples)
        check_ranges(self, self.points.ranges)
        if not isinstance(self.points, Samples):
            known = self.known()
            for name in self.points.names:
                check_whole(known[name], self.points.values[name])

    @property
    def n_trials(self) -> int:
        """Number of trials."""
        return int(np.prod(self.points.shape, dtype=np.int64))

    def regions(self, size: int | None = None) -> Regions:
        """The sweep in pieces of about a second of work: the order of the work and of the files.

        Args:
            size: Greatest number of points in a region; None takes one by what a trial costs.
        """
        if size is None:
            trial = TRIAL_TIME[self.joints] * self.duration / 30.0 * self.robot.n_links / 10.0
            size = int(np.clip(REGION_TIME / trial, LEAST_SIZE, MOST_SIZE))
        return cut(self.points.shape, whole("region_size", size, 1))

    def tables(self, blocks: Iterable[tuple[slice, ...]]) -> Iterator[Table]:
        """The points of some regions, one after the other.

        Args:
            blocks: In rising order.
        """
        known = self.known()
        return self.points.tables(blocks, [name for name in self.points.names if known[name].is_whole])

    def definition(self) -> dict[str, Any]:
        """All that its results depend on, for a file."""
        plain = dataclasses.asdict(self.setup)
        del plain["robot"]["description"]
        return {"laticauda": __version__, **plain, "points": self.points.definition()}
