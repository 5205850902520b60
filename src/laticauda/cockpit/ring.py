"""The newest samples of a log, in arrays that never grow."""

from collections.abc import Mapping

import numpy as np


class Ring:
    """Keeps the last `capacity` rows of named columns, each a number or an array of a fixed shape.

    Args:
        capacity: How many rows are kept [-].
    """

    def __init__(self, capacity: int) -> None:
        self.capacity = capacity
        self._columns: dict[str, np.ndarray] = {}
        self._end = 0

    def __len__(self) -> int:
        """How many rows it holds."""
        return min(self._end, self.capacity)

    def clear(self) -> None:
        """Forget all rows, and their shapes."""
        self._columns, self._end = {}, 0

    def append(self, row: Mapping[str, float | np.ndarray]) -> None:
        """Add a row; the oldest one goes if there is no room.

        Args:
            row: A value for every column; the first row says which there are.
        """
        if not self._columns:
            self._columns = {name: np.empty((2 * self.capacity, *np.shape(value))) for name, value in row.items()}
        if self._end == 2 * self.capacity:  # the newer half moves to the front: rows stay in one piece
            for column in self._columns.values():
                column[: self.capacity] = column[self.capacity :]
            self._end = self.capacity
        for name, column in self._columns.items():
            column[self._end] = row[name]
        self._end += 1

    def last(self, n: int | None = None, step: int = 1) -> dict[str, np.ndarray]:
        """Copies of the newest rows by column, oldest first.

        Args:
            n: How many rows at most; None: all.
            step: Every how many-th of them, the newest included.
        """
        n = len(self) if n is None else min(n, len(self))
        return {name: column[self._end - n : self._end][::-step][::-1].copy() for name, column in self._columns.items()}
