"""What a sweep is: one scenario at thousands to millions of points, cut into regions that are done in one go."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

import laticauda as lc
from laticauda.errors import whole
from laticauda.quantities import option, value
from laticauda.simulate.numbers import check_whole, parameters
from laticauda.studies import sampling, trials

# What a region should take on one core, and what a trial of ten links and 30 s takes there, roughly [s].
REGION_TIME = 1.5
TRIAL_TIME, DRIVEN_TIME = 0.35e-3, 5e-3
LEAST_SIZE, MOST_SIZE = 64, 16384


@value
class Sweep:
    """What to sweep: a scenario, and the points that change numbers of it.

    Raises:
        ValueError: If a field is out of its range, a parameter does not exist (the message has the nearest names), or
            a value is out of the parameter's range.

    Example:
        >>> import laticauda as lc
        >>> from laticauda.studies import Grid
        >>> gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> sweep = Sweep(
        ...     scenario=lc.scenario("mamba", gait),
        ...     points=Grid(values={"gait.amplitude": [0.3, 0.5], "water.normal_drag": [1.0, 1.5, 2.0]}),
        ... )
        >>> sweep.n_trials
        6
    """

    scenario: lc.Scenario = option("What all trials share; by the planar model")
    points: sampling.Points = option("Which points: `Grid`, `Rows` or `Samples`")

    def __post_init__(self) -> None:
        """Check what goes together."""
        trials.check_scenario(self.scenario)
        trials.check_ranges(self.scenario, self.points.ranges)
        if not isinstance(self.points, sampling.Samples):
            known = parameters(self.scenario)
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
            s = self.scenario
            cost = TRIAL_TIME if isinstance(s.model.joints, lc.Prescribed) else DRIVEN_TIME
            trial = cost * s.duration / 30.0 * s.robot.n_links / 10.0
            size = int(np.clip(REGION_TIME / trial, LEAST_SIZE, MOST_SIZE))
        return cut(self.points.shape, whole("region_size", size, 1))

    def tables(self, blocks: Iterable[tuple[slice, ...]]) -> Iterator[trials.Table]:
        """The points of some regions, one after the other.

        Args:
            blocks: In rising order.
        """
        known = parameters(self.scenario)
        return self.points.tables(blocks, [name for name in self.points.names if known[name].is_whole])

    def definition(self) -> dict[str, Any]:
        """All that its results depend on, for a file."""
        return {**trials.definition_of(self.scenario), "points": self.points.definition()}


@dataclass(frozen=True, kw_only=True)
class Regions:
    """All regions of a sweep; they are the chunks of its stored arrays."""

    shape: tuple[int, ...]
    """Of the sweep's points."""
    block: tuple[int, ...]
    """Of a region; those at the far ends may be smaller."""

    @property
    def grid(self) -> tuple[int, ...]:
        """Number of regions along every dimension."""
        return tuple(-(-n // size) for n, size in zip(self.shape, self.block, strict=True))

    @property
    def count(self) -> int:
        """Number of regions."""
        return math.prod(self.grid)

    def at(self, index: int) -> sampling.Block:
        """The block of one region.

        Args:
            index: Its number, the last dimension counting fastest.
        """
        places = np.unravel_index(index, self.grid)
        return tuple(
            slice(int(place) * size, min((int(place) + 1) * size, n))
            for place, size, n in zip(places, self.block, self.shape, strict=True)
        )

    def n_points(self, index: int) -> int:
        """Number of points in a region.

        Args:
            index: Its number.
        """
        return math.prod(extent(self.at(index)))


def extent(block: sampling.Block) -> tuple[int, ...]:
    """The shape of a block."""
    return tuple(part.stop - part.start for part in block)


def cut(shape: tuple[int, ...], size: int) -> Regions:
    """Regions of about `size` points: whole along the last dimensions, nearly equal pieces along the others.

    Args:
        shape: Of the sweep's points.
        size: Greatest number of points in a region.
    """
    room = size
    block: list[int] = []
    for n in reversed(shape):
        most = max(1, min(n, room))
        length = -(-n // -(-n // most))
        block.append(length)
        room //= length
    return Regions(shape=shape, block=tuple(reversed(block)))
