"""The part of an external log that forms a trial: its columns in SI units, with their gaps filled."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float

from laticauda.trials.arrays import Samples
from laticauda.trials.logs.column_maps import ColumnMap
from laticauda.trials.logs.map_sections import ANGLES, LENGTHS
from laticauda.trials.logs.tables import Table
from laticauda.values import BadArgument

SMALLEST_EXCESS = 1e-9
"""A gap is too long if it exceeds the longest allowed one by this, relative to it."""
ADVICE = "cut it off with `start` and `stop`, or fill it by hand"


@dataclass
class MeasuredLog:
    """The part of a table that forms the trial, and a record of what had to be filled in."""

    table: Table
    """The whole file."""
    column_map: ColumnMap
    """Meaning of its columns."""
    rows: Bool[np.ndarray, " n_rows"]
    """Whether each row of the table belongs to the trial."""
    time: Samples
    """Time since the start of the trial [s]."""
    has_gap: Bool[np.ndarray, " n_samples"]
    """Whether any quantity had a gap at each sample; updated by `fill`."""
    filled_columns: list[str] = field(default_factory=list[str])
    """Names of the quantities that had a gap; updated by `fill`."""

    def read(self, name: str) -> Samples:
        """Return the column `name` as it is in the file, including its gaps."""
        return self.table[name][self.rows]

    def fill(self, name: str, values: Samples) -> Samples:
        """Return the `values` of the quantity `name` with gaps filled, and record the gaps."""
        time_in_file = self.time + (self.column_map.start or 0.0)
        filled, is_missing = fill_gaps(name, time_in_file, values, self.column_map.longest_gap)
        if np.any(is_missing):
            self.filled_columns.append(name)
            self.has_gap |= is_missing
        return filled

    def read_lengths(
        self, names: Sequence[str], unit: str | None
    ) -> Float[np.ndarray, "n_samples n_columns"]:
        """Return the columns `names` as lengths [m], including gaps; `unit` if the map states it."""
        columns: list[Samples] = []
        for name in names:
            factor = LENGTHS[self._find_unit(name, unit, LENGTHS)]
            columns.append(factor * self.read(name))
        return np.stack(columns, axis=1)

    def read_angle(self, name: str, unit: str | None) -> Samples:
        """Return the column `name` as angles [rad], including gaps; `unit` if the map states it."""
        return ANGLES[self._find_unit(name, unit, ANGLES)] * self.read(name)

    def _find_unit(self, name: str, unit_in_map: str | None, units: Mapping[str, float]) -> str:
        """Return the unit that the map states for a column, else that of the file, else the default."""
        default = next(iter(units))
        unit = unit_in_map or self.table.units.get(name) or default
        if unit not in units:
            raise ValueError(
                f"Column `{name}` must be in {', '.join(units)}, but the file says {unit!r}."
            )
        return unit


def fill_gaps(
    name: str, time: Samples, signal: Float[np.ndarray, " n_samples"], longest: float
) -> tuple[Samples, Bool[np.ndarray, " n_samples"]]:
    """Fill the gaps of a signal by linear interpolation.

    Args:
        name: Name of the signal, for the error message.
        time: Times of the samples [s].
        signal: Values; nan where missing.
        longest: Longest time over which values may be missing [s].

    Returns:
        The values, and which of them were missing.

    Raises:
        ValueError: If values are missing over a longer time, or at either end.
    """
    is_missing = ~np.isfinite(signal)
    if not np.any(is_missing):
        return signal, is_missing
    known_samples = np.flatnonzero(~is_missing)
    known_times = time[known_samples]
    if not known_samples.size:
        rule = f"must hold numbers, but it holds none from {time[0]:g} s to {time[-1]:g} s"
        raise BadArgument(name, rule)
    if is_missing[0]:
        rule = f"must hold numbers at both ends, but it begins at {known_times[0]:.6g} s"
        raise BadArgument(name, f"{rule}; {ADVICE}")
    if is_missing[-1]:
        rule = f"must hold numbers at both ends, but it ends at {known_times[-1]:.6g} s"
        raise BadArgument(name, f"{rule}; {ADVICE}")
    steps = np.diff(known_times)
    is_gap = np.diff(known_samples) > 1
    longest_gap = int(np.argmax(np.where(is_gap, steps, 0.0)))
    if steps[longest_gap] > longest * (1.0 + SMALLEST_EXCESS):
        begin = known_times[longest_gap]
        end = known_times[longest_gap + 1]
        limit = f"must have no gap longer than `longest_gap` = {longest:g} s"
        length = f"got one of {steps[longest_gap]:.4g} s from {begin:.6g} s to {end:.6g} s"
        raise BadArgument(name, f"{limit}, {length}; {ADVICE}")
    return np.interp(time, known_times, signal[known_samples]), is_missing
