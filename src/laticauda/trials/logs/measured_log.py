"""The part of an external log that forms a trial: its columns in SI units, with their gaps filled."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float

from laticauda.trials.arrays import Samples
from laticauda.trials.logs.column_maps import ColumnMap
from laticauda.values import BadArgument
from laticauda.values.tables import (
    ANGLES,
    LENGTHS,
    SMALLEST_SWING,
    Table,
    count_turns,
    find_lost_angles,
    find_lost_samples,
    split_unit,
    unit_in_name,
    unknown_unit,
)

SMALLEST_EXCESS = 1e-9
"""A gap is too long if it exceeds the longest allowed one by this, relative to it."""
N_LISTED_ROWS = 5
"""Rows with a gap that are listed at most."""
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
    empty_cells: list[str] = field(default_factory=list[str])
    """Rows in which quantities had no number; updated by `fill`."""
    was_lost: Bool[np.ndarray, " n_samples"] = field(init=False)
    """Whether the position was a constant that stands for a lost marker; updated by `read_positions`."""
    remarks: list[str] = field(default_factory=list[str])
    """What was not taken as the file says it; updated by `read_positions`, and others."""

    def __post_init__(self) -> None:
        """Begin with nothing lost."""
        self.was_lost = np.zeros(self.time.size, dtype=np.bool_)

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
            self._remember_rows(name, is_missing)
        return filled

    @property
    def row_numbers(self) -> list[int]:
        """Numbers in the file of the rows that belong to the trial; empty if the file has none."""
        if not len(self.table.row_numbers):
            return []
        return np.asarray(self.table.row_numbers)[self.rows].tolist()

    def _remember_rows(self, name: str, is_missing: Bool[np.ndarray, " n_samples"]) -> None:
        """Keep the rows in which a quantity has no number, as far as the file has rows."""
        row_numbers = self.row_numbers
        if not row_numbers:
            return
        missing = [row_numbers[int(i)] for i in np.flatnonzero(is_missing)]
        listed = ", ".join(map(str, missing[:N_LISTED_ROWS]))
        if len(missing) > N_LISTED_ROWS:
            listed += f" and {len(missing) - N_LISTED_ROWS} more"
        self.empty_cells.append(f"`{name}` filled in row {listed}")

    def read_lengths(
        self, names: Sequence[str], unit: str | None
    ) -> Float[np.ndarray, "n_samples n_columns"]:
        """Return the columns `names` as lengths [m], including gaps; `unit` if the map states it."""
        columns: list[Samples] = []
        for name in names:
            factor = LENGTHS[self.find_unit(name, unit, LENGTHS)]
            columns.append(factor * self.read(name))
        return np.stack(columns, axis=1)

    def read_positions(
        self, names: Sequence[str], unit: str | None, *, body_length: float
    ) -> Float[np.ndarray, "n_samples n_columns"]:
        """Return a position [m], nan where it is missing, or is a constant that stands for a lost marker."""
        position = self.read_lengths(names, unit)
        label = _name_of_point(names)
        lost = find_lost_samples(label, self.time, position, body_length=body_length)
        if lost.code is not None:
            code = ", ".join(f"{coordinate:g}" for coordinate in lost.code)
            self.remarks.append(f"`{label}` was lost in {lost.n_lost} samples, at ({code}) m")
            self.was_lost |= lost.is_lost
        return np.where(lost.is_lost[:, np.newaxis], np.nan, position)

    def read_heading(self, name: str, unit: str | None) -> Samples:
        """Return the column `name` as angles of a body [rad], nan where lost; `unit` if the map states it."""
        unit_of_angle = self.find_unit(name, unit, ANGLES)
        angle = ANGLES[unit_of_angle] * self.read(name)
        measured = self.without_lost_angles(name, angle)
        largest = float(np.max(np.abs(measured), initial=0.0, where=np.isfinite(measured)))
        if unit_of_angle == "deg" and 0.0 < largest < SMALLEST_SWING:
            reach = math.degrees(largest)
            self.remarks.append(f"`{name}` only reaches {reach:.3g} deg, as angles in rad would")
        n_turns = count_turns(measured)
        if n_turns:
            self.remarks.append(f"whole turns were taken out of `{name}` at {n_turns} samples")
        return measured

    def without_lost_angles(self, name: str, angle: Samples) -> Samples:
        """Return angles of a body [rad], nan where its position was lost, or a constant stands for a lost angle."""
        angle = np.where(self.was_lost, np.nan, angle)
        lost = find_lost_angles(name, self.time, angle)
        if lost.code is not None:
            n_lost = np.count_nonzero(lost.is_lost)
            code = math.degrees(lost.code)
            self.remarks.append(f"`{name}` was lost in {n_lost} samples, at {code:.4g} deg")
        return np.where(lost.is_lost, np.nan, angle)

    def find_unit(self, name: str, unit_in_map: str | None, units: Mapping[str, float]) -> str:
        """Return the unit that the map states for a column, else that of the file, else the default."""
        default = next(iter(units))
        unit = unit_in_map or self.table.unit_of(name) or unknown_unit(name) or default
        is_in_name = unit == unit_in_name(name) and split_unit(name)[1] is None
        if unit not in units and unit_in_map is None and is_in_name:
            unit = default  # the name only ends like a unit
        if unit not in units:
            raise ValueError(
                f"Column `{name}` must be in {', '.join(units)}, but the file says {unit!r}."
            )
        return unit


def _name_of_point(names: Sequence[str]) -> str:
    """Return what the names of coordinates have in common, such as `head` of `head X` and `head Y`."""
    first, *further_names = names
    n_common = 0
    while n_common < len(first) and all(
        name.startswith(first[: n_common + 1]) for name in further_names
    ):
        n_common += 1
    return first[:n_common].strip(" _.:") or ", ".join(names)


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
