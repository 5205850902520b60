"""A sweep cut into regions: blocks of its points that are computed, stored and marked as done in one go."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from laticauda.studies.sampling import Block


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

    def at(self, index: int) -> Block:
        """The block of one region.

        Args:
            index: Its number, the last dimension counting fastest.
        """
        places = np.unravel_index(index, self.grid)
        return tuple(
            slice(int(place) * size, min((int(place) + 1) * size, n))
            for place, size, n in zip(places, self.block, self.shape, strict=True)
        )

    def blocks(self, indices: Iterable[int]) -> Iterator[Block]:
        """The blocks of some regions, one after the other.

        Args:
            indices: Their numbers.
        """
        return (self.at(index) for index in indices)

    def n_points(self, index: int) -> int:
        """Number of points in a region.

        Args:
            index: Its number.
        """
        return math.prod(extent(self.at(index)))


def extent(block: Block) -> tuple[int, ...]:
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
