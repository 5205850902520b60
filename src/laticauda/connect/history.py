"""Log of a client's world, of which the oldest samples are discarded."""

from collections import deque
from collections.abc import Sequence

import numpy as np

from laticauda.values import Log, check_choice

MOST_SAMPLES = 100_000
"""Samples in a log at most [-]."""

Series = dict[str, np.ndarray]
"""Quantities by name, with time as the first axis."""


class History:
    """Log of samples in pieces, of which the oldest are discarded if there are too many.

    Args:
        max_values: Maximum number of values kept [-].
    """

    def __init__(self, max_values: int) -> None:
        self._max_values = max_values
        self._pieces: deque[Series] = deque()
        self._n_samples = 0
        self.n_dropped = 0
        """Number of discarded samples [-]."""

    def append(self, log: Log) -> None:
        """Append samples, and discard the oldest pieces if necessary.

        Args:
            log: Samples after the last one.
        """
        self._pieces.append({name: np.array(values) for name, values in log.series().items()})
        self._n_samples += log.time.size
        while self._n_samples > self.capacity and len(self._pieces) > 1:
            oldest = self._pieces.popleft()
            n_samples = oldest["time"].size
            self._n_samples -= n_samples
            self.n_dropped += n_samples

    @property
    def width(self) -> int:
        """Number of values in a sample [-]."""
        return sum(values.size for values in self.last.values())

    @property
    def capacity(self) -> int:
        """Maximum number of samples kept [-]."""
        return min(MOST_SAMPLES, self._max_values // self.width)

    @property
    def last(self) -> Series:
        """Last sample of every quantity."""
        newest = self._pieces[-1]
        return {name: values[-1] for name, values in newest.items()}

    def select(self, names: Sequence[str], since: float) -> Series:
        """Return the named quantities after a given time.

        Args:
            names: Names of quantities of a sample (`Log`).
            since: Time after which samples are returned [s].

        Raises:
            ValueError: If there is no quantity with one of the names.
        """
        newest = self._pieces[-1]
        recent_pieces = [piece for piece in self._pieces if piece["time"][-1] > since]
        series: Series = {}
        for name in names:
            check_choice("series", name, tuple(newest))
            recent_values = [piece[name][piece["time"] > since] for piece in recent_pieces]
            if recent_values:
                series[name] = np.concatenate(recent_values)
            else:
                series[name] = newest[name][:0]
        return series
