"""Which lane of the kernels does which run of a batch.

A run without a slope has a lane of its own. Runs that differ in their slopes alone share one, up to
MOST_SLOPES of them: their numbers are computed once, and their derivatives beside each other.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from jaxtyping import Float, Inexact, Int

from laticauda.compiling.lane_types import SLOPES, VALUE, dual_row

WIDTH = 8
"""Runs side by side. They fill an AVX-512 register; other processors use two or four registers for the
same numbers, and 16 lanes are no faster."""
STEP = 2.0**-100
"""Step of the derivatives: far below rounding, and a power of two, so that scaling by it changes no digits."""
MOST_SLOPES = 2
"""Derivatives that a lane carries at most: with more, the numbers of a block leave the processor's nearest cache."""


def aligned(shape: tuple[int, ...], kind: Any) -> np.ndarray:
    """Return an array of zeros that is aligned to the size of a vector register.

    Args:
        shape: Shape of the array.
        kind: Type of its numbers, or of the rows of kernels (`lane_types.dual_row`).
    """
    size = int(np.prod(shape)) * np.dtype(kind).itemsize // 8
    raw: np.ndarray = np.zeros(size + 8)
    first = -raw.__array_interface__["data"][0] % 64 // 8
    return cast(np.ndarray, raw[first : first + size].view(kind)).reshape(shape)


def values_of(lanes: np.ndarray) -> np.ndarray:
    """Return the values of rows or samples, without their derivatives.

    Args:
        lanes: Rows or samples as the kernels have them.
    """
    if lanes.dtype.names is None:
        return lanes
    return lanes[VALUE]


@dataclass(frozen=True, kw_only=True, eq=False)
class LanesOfRuns:
    """How the numbers of a block's runs lie in lanes."""

    lane: Int[np.ndarray, " n_runs"]
    """Lane of each run; lanes beyond the last repeat it."""
    place: Int[np.ndarray, " n_runs"]
    """Place of the run's derivative among those of its lane."""
    n_slopes: int
    """Derivatives of a lane; 0: the numbers are floats."""

    @classmethod
    def of(cls, lanes: Sequence[Sequence[Any]], n_slopes: int) -> "LanesOfRuns":
        """Return how runs lie of which some share a lane.

        Args:
            lanes: The runs of every lane, up to WIDTH lanes.
            n_slopes: Derivatives of a lane; 0: none.
        """
        sizes = [len(lane) for lane in lanes]
        return cls(
            lane=np.repeat(np.arange(len(lanes)), sizes),
            place=np.concatenate([np.arange(size) for size in sizes]),
            n_slopes=n_slopes,
        )

    @property
    def n_lanes(self) -> int:
        """Number of lanes that differ."""
        return int(self.lane[-1]) + 1

    def room(self, *shape: int) -> np.ndarray:
        """Return an array of zeros for rows or samples.

        Args:
            shape: Shape of the array, without the lanes.
        """
        if self.n_slopes == 0:
            return aligned((*shape, WIDTH), float)
        return aligned(shape, dual_row(WIDTH, self.n_slopes))

    def fill(
        self,
        columns: Float[np.ndarray, "n_rows n_lanes"],
        slopes: Sequence[Float[np.ndarray, " n_rows"]] = (),
    ) -> np.ndarray:
        """Return the rows of runs.

        Args:
            columns: Rows of one run of every lane.
            slopes: Derivatives of the rows of every run, if it has any.
        """
        lanes = self.room(len(columns))
        values = values_of(lanes)
        values[:, : self.n_lanes] = columns
        values[:, self.n_lanes :] = columns[:, -1:]
        for lane, place, slope in zip(self.lane, self.place, slopes, strict=self.n_slopes > 0):
            lanes[SLOPES][:, place, lane] = STEP * slope
        if self.n_slopes > 0:
            lanes[SLOPES][..., self.n_lanes :] = lanes[SLOPES][..., self.n_lanes - 1, np.newaxis]
        return lanes

    def numbers(self, lanes: np.ndarray) -> Inexact[np.ndarray, "*any n_runs"]:
        """Return the numbers of runs, complex if they have slopes.

        Args:
            lanes: Rows or samples as the kernels have them.
        """
        if self.n_slopes == 0:
            return lanes[..., : self.n_lanes]
        all_slopes = lanes[SLOPES].reshape(*lanes.shape, self.n_slopes * WIDTH)
        numbers = np.empty((*lanes.shape, self.lane.size), dtype=complex)
        numbers.real = np.take(lanes[VALUE], self.lane, axis=-1)
        numbers.imag = np.take(all_slopes, self.place * WIDTH + self.lane, axis=-1)
        return numbers

    def numbers_at(
        self, samples: np.ndarray, index: Int[np.ndarray, " n_runs"]
    ) -> Inexact[np.ndarray, "n_rows n_runs"]:
        """Return one sample of every run, complex if the runs have slopes.

        Args:
            samples: Samples as the kernels have them.
            index: Index of the sample of each run.
        """
        numbers = values_of(samples)[index, :, self.lane].T
        if self.n_slopes == 0:
            return numbers
        return numbers + 1j * samples[SLOPES][index, :, self.place, self.lane].T


def lanes_of_single_runs(n_runs: int) -> LanesOfRuns:
    """Return how runs lie of which each has a lane of its own, and none a slope.

    Args:
        n_runs: Number of runs.
    """
    return LanesOfRuns(lane=np.arange(n_runs), place=np.zeros(n_runs, dtype=int), n_slopes=0)


def blocks_of(lanes: Sequence[Sequence[int]], size: int) -> Iterator[Sequence[Sequence[int]]]:
    """Yield lanes, so many at a time.

    Args:
        lanes: The runs of every lane.
        size: Number of lanes.
    """
    for first in range(0, len(lanes), size):
        yield lanes[first : first + size]
