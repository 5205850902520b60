"""Regions of a sweep: pieces that are computed in one go, and are the chunks of its stored arrays."""

import math
from typing import TypeAlias

import numpy as np

from laticauda.values import quantity, value_class

Block: TypeAlias = tuple[slice, ...]
"""One slice per dimension of a sweep's points."""


@value_class
class Regions:
    """All regions of a sweep; they are the chunks of its stored arrays."""

    shape: tuple[int, ...] = quantity("", "Shape of the sweep's points", ge=1)
    block: tuple[int, ...] = quantity(
        "", "Size of a region; those at the far ends may be smaller", ge=1
    )

    @property
    def grid(self) -> tuple[int, ...]:
        """Number of regions along each dimension."""
        counts: list[int] = []
        for n, size in zip(self.shape, self.block, strict=True):
            counts.append(math.ceil(n / size))
        return tuple(counts)

    @property
    def count(self) -> int:
        """Number of regions."""
        return math.prod(self.grid)

    def at(self, index: int) -> Block:
        """Return the block of one region.

        Args:
            index: Index of the region, with the last dimension varying fastest.
        """
        positions = np.unravel_index(index, self.grid)
        parts: list[slice] = []
        for position, size, n in zip(positions, self.block, self.shape, strict=True):
            start = int(position) * size
            stop = min(start + size, n)
            parts.append(slice(start, stop))
        return tuple(parts)

    def n_points(self, index: int) -> int:
        """Return the number of points in a region.

        Args:
            index: Index of the region.
        """
        return math.prod(block_shape(self.at(index)))


def block_shape(block: Block) -> tuple[int, ...]:
    """Return the shape of a block."""
    return tuple(part.stop - part.start for part in block)


def divide_regions(shape: tuple[int, ...], size: int) -> Regions:
    """Form regions of about `size` points: whole along the last dimensions, nearly equal pieces along the others.

    Args:
        shape: Shape of the sweep's points.
        size: Maximum number of points in a region.
    """
    remaining_size = size
    lengths: list[int] = []
    for n in reversed(shape):
        longest = max(1, min(n, remaining_size))
        n_pieces = math.ceil(n / longest)
        length = math.ceil(n / n_pieces)
        lengths.append(length)
        remaining_size //= length
    return Regions(shape=shape, block=tuple(reversed(lengths)))
