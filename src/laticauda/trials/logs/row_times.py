"""Times of the rows of an external log, and which rows form the trial."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool

from laticauda.trials.arrays import Samples
from laticauda.trials.logs.column_maps import ColumnMap
from laticauda.values import BadArgument
from laticauda.values.tables import Table, check_increasing, check_sampling, read_times

SMALLEST_GAP_IN_STEPS = 3.0
"""Steps up to which the time between two samples is no gap, whatever the map allows."""


class TrialRows(NamedTuple):
    """The rows of a log that form the trial."""

    time: Samples
    """Their times since the start of the trial [s]."""
    is_included: Bool[np.ndarray, " n_rows"]
    """Whether each row of the file is one of them."""
    remark: str
    """How the times were recognized, if they do not simply count seconds; else ""."""


class _NamedTimes(NamedTuple):
    name: str
    """What the times are called in messages."""
    seconds: Samples
    """Times of all rows [s]."""
    remark: str


def select_rows(table: Table, column_map: ColumnMap) -> TrialRows:
    """Return the rows between the start and the stop that the map states, and their times.

    Args:
        table: The log.
        column_map: Meaning of its columns.

    Raises:
        ValueError: If times are missing, do not increase, have a long gap, or are in another unit.
    """
    sentences = [column for column in table.columns.values() if isinstance(column, str)]
    if not table.n_rows and sentences:
        raise ValueError(sentences[0])
    name, times, remark = _read_times(table, column_map)
    is_included = np.ones(table.n_rows, dtype=np.bool_)
    if column_map.start is not None:
        is_included &= times >= column_map.start
    if column_map.stop is not None:
        is_included &= times <= column_map.stop
    _check_count(name, times, n_included=int(np.count_nonzero(is_included)))
    included_times = times[is_included]
    row_numbers: Sequence[int] = ()
    if len(table.row_numbers):
        row_numbers = np.asarray(table.row_numbers)[is_included].tolist()
    check_increasing(name, included_times, row_numbers)
    check_sampling(name, included_times)
    _check_steps(name, included_times, column_map.longest_gap)
    # Time counts from the start requested by the user, or from the first row.
    start = column_map.start
    if start is None:
        start = float(included_times[0])
    return TrialRows(time=included_times - start, is_included=is_included, remark=remark)


def _read_times(table: Table, column_map: ColumnMap) -> _NamedTimes:
    """Return the times of all rows: from a column, or else from a rate stated in the map or the file."""
    column = column_map.time.column
    if column is not None:
        file_times = read_times(table, column, column_map.time.unit)
        return _NamedTimes(name=column, seconds=file_times.seconds, remark=file_times.remark)
    rate = column_map.time.rate
    if rate is None:
        rate = table.rate
    if rate is None:
        raise ValueError(
            "The map must say `time.column` or `time.rate`: the file does not state times of its rows."
        )
    if not rate > 0.0:
        raise ValueError(
            "The map must say `time.column` or `time.rate`: "
            f"the file states a rate of {rate:g} Hz, which gives its rows no times."
        )
    seconds = np.arange(table.n_rows) / rate
    return _NamedTimes(name="time", seconds=seconds, remark="")


def _check_count(name: str, times: Samples, n_included: int) -> None:
    if n_included >= 2:
        return
    if not times.size:
        raise ValueError(f"`{name}` must have at least 2 samples, got none.")
    raise ValueError(
        f"`{name}` must have at least 2 samples between `start` and `stop`, "
        f"got {n_included}; the file has {times.size} from {times[0]:g} s to {times[-1]:g} s."
    )


def _check_steps(name: str, times: Samples, longest_gap: float) -> None:
    """Reject times with a gap longer than the map allows [s]."""
    steps = np.diff(times)
    usual_step = float(np.median(steps))
    longest_step = float(np.max(steps))
    if longest_step > max(longest_gap, SMALLEST_GAP_IN_STEPS * usual_step):
        time_before = float(times[np.argmax(steps)])
        limit = f"must have no gap longer than `longest_gap` = {longest_gap:g} s"
        actual = f"got one of {longest_step:.4g} s after {time_before:.6g} s"
        raise BadArgument(name, f"{limit}, {actual}; cut it off with `start` and `stop`")
