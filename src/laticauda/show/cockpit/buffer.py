"""The last rows of a growing table."""

from collections.abc import Mapping

import numpy as np


class RingBuffer:
    """Fixed-size buffer of the last rows of named columns, each a number or an array of a fixed shape.

    Args:
        capacity: Number of rows that are kept [-].
    """

    def __init__(self, capacity: int) -> None:
        self.capacity = capacity
        self._columns: dict[str, np.ndarray] = {}
        self._end = 0

    def clear(self) -> None:
        """Remove all rows, and forget their shapes."""
        self._columns = {}
        self._end = 0

    def append(self, row: Mapping[str, float | np.ndarray]) -> None:
        """Append a row; the oldest one is dropped if there is no room.

        Args:
            row: A value for every column; the first row defines the columns.
        """
        room = 2 * self.capacity
        if not self._columns:
            for name, value in row.items():
                self._columns[name] = np.empty((room, *np.shape(value)))
        if self._end == room:
            self._drop_older_half()
        for name, column in self._columns.items():
            column[self._end] = row[name]
        self._end += 1

    def _drop_older_half(self) -> None:
        """Move the newer half to the front, so that the rows stay contiguous."""
        for column in self._columns.values():
            column[: self.capacity] = column[self.capacity :]
        self._end = self.capacity

    def last(self, step: int = 1) -> dict[str, np.ndarray]:
        """Return copies of the rows by column, oldest first.

        Args:
            step: Return every `step`-th row, including the newest.
        """
        begin = max(self._end - self.capacity, 0)
        copies: dict[str, np.ndarray] = {}
        for name, column in self._columns.items():
            newest_first = column[begin : self._end][::-step]
            copies[name] = newest_first[::-1].copy()
        return copies
