"""Trials from any file: one that laticauda wrote, or an external log with a column map.

The conversion from a table to a `Trial` covers units, axes, kinematics, gaps, rates and work.
"""

from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from laticauda import robot, scenarios, trials as trial
from laticauda.robot import kinematics
from laticauda.trials import dataset, metrics
from laticauda.trials.arrays import Samples, check_times
from laticauda.trials.logs import column_maps, tables, tabular
from laticauda.trials.logs.placing import Measured, joints_of, place_of
from laticauda.trials.logs.recording import failures_of
from laticauda.values import BadArgument, TrialFileError, files, series


def load_trial(
    path: str | Path, columns: str | Path | column_maps.ColumnMap | None = None
) -> trial.Trial:
    """Read a trial from a file that `Trial.save` wrote, or build one from an external log.

    A log is CSV, TSV, Parquet, .mat, C3D, or a TSV export of Qualisys Track Manager; the how-to
    "Bring your own measurements" explains what the trial takes from it.

    Args:
        path: The file; its extension sets the format.
        columns: Meaning of the columns of a log: a column map or its TOML file; None for a file
            that laticauda wrote.

    Returns:
        A trial; from a file that laticauda wrote, one that `equals` the saved one, bit for bit.

    Raises:
        TrialFileError: If there is no such file, or it is not a complete trial; for a log, if a
            column is missing, time does not increase, values are missing over too long a time, or
            the stated units cannot be right. The message gives the file's name and the reason.
        MissingExtra: If the format needs a package that is not installed.
    """
    path = files.local(path)
    if columns is not None:
        given = (
            columns
            if isinstance(columns, column_maps.ColumnMap)
            else column_maps.load_column_map(columns)
        )
        by = path if columns is given else f"{path} by {columns}"
        with failures_of(by):
            return measured_trial(
                read_table(path, given.separator, given.decimal), given, path.name
            )
    form = trial.Format.of(path)
    if not form.is_whole:
        raise TrialFileError(
            f"Cannot load {path}: a {path.suffix} file does not state the robot; give a column map "
            "(`columns`, on the command line --columns). Measured speeds are for `laticauda identify --table`."
        )
    with failures_of(path):
        return trial.Trial.from_dataset(form.read(path))


def read_table(path: Path, separator: str | None = None, decimal: str = ".") -> tables.Table:
    """Read a file of columns: CSV, TSV, QTM's TSV, C3D, Parquet, .mat.

    Args:
        path: The file; its extension sets the format, and its first line shows whether a table is
            QTM's.
        separator: Separator between the cells of a text file; detected if None.
        decimal: Decimal separator of a text file, point or comma.

    Raises:
        ValueError: If the content is invalid.
        OSError: If the file cannot be read.
        MissingExtra: If the format needs a package that is not installed.
    """
    ending = path.suffix.lower()
    if ending == ".c3d":
        return tables.read_c3d(path)
    if ending in (".parquet", ".mat"):
        return tables.Table(
            columns=tabular.parquet_columns(path)
            if ending == ".parquet"
            else tabular.mat_columns(path)
        )
    content = files.read_bytes(path)
    try:
        lines = content.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        lines = content.decode("latin-1").splitlines() if b"\x00" not in content else []
    if not lines:
        raise ValueError("it is not a text file of columns, or it is empty.")
    return (
        tables.qtm_table(lines)
        if lines[0].startswith("NO_OF_FRAMES")
        else tables.csv_table(lines, separator, decimal)
    )


# ---- measured trials -----------------------------------------------------------------------------

FASTEST = 5.0  # robot lengths per second; anything faster is in another unit
SLOWEST_SAMPLING = 1.0  # [s]; anything slower is in another unit
LARGEST_BEND = np.pi  # [rad]
ORDER = 3  # of the polynomials whose slopes are the rates

Columns = Float[np.ndarray, "n_samples n_columns"]


def measured_trial(table: tables.Table, given: column_maps.ColumnMap, source: str) -> trial.Trial:
    """Build a trial from an external log.

    What was not measured is listed in the trial's `not_measured`, and figures that need it raise an
    error. Positions and angles are used unchanged; their rates are the slopes of cubic fits over
    `smoothing`. Work is that of the measured torques, electrical work that of the measured power
    above idle (4).

    Args:
        table: The log.
        given: Meaning of its columns.
        source: Name of the log.

    Raises:
        ValueError: If a column is missing, time does not increase, values are missing over too long
            a time, or the stated units cannot be right; the message gives the column and the value.
    """
    known: dict[str, Any] = {
        "robot": given.robot,
        "gait": given.gait,
        "environment": given.environment,
    }
    notes = {"model": "measured", "source": source, "smoothing": given.smoothing}
    if given.center_of_mass is None and given.body is None and given.ends is None:
        return _own_table(table, scenarios.Experiment(**known, notes=notes))
    time, rows = _time(table, given)
    log = Measured(table, given, rows, time, np.zeros(time.size, dtype=np.bool_))
    chain = given.robot.planar()
    arrays = {"time": time, **place_of(log, chain)}
    arrays |= {
        name: joints_of(log, name, chain)
        for name in column_maps.UNITS
        if getattr(given, name) is not None
    }
    _add_rates(arrays, given.smoothing)
    _check_plausible(arrays, chain)
    return trial.Trial.measured(
        {**arrays, "electrical_work": None if given.power is None else _electrical_work(log)},
        signals={
            name: log.whole(column, log.raw(column)) for name, column in given.signals.items()
        },
        scenario=scenarios.Experiment(
            **known, notes={**notes, "filled_samples": int(np.count_nonzero(log.lost))}
        ),
        version=version("laticauda"),
        status=_status(log),
    )


# ---- time ----------------------------------------------------------------------------------------


def _time(
    table: tables.Table, given: column_maps.ColumnMap
) -> tuple[Samples, Bool[np.ndarray, " n_rows"]]:
    """Return the time since the start of the trial [s], and the rows of the file that belong to it."""
    n = table.n_rows
    if given.time.column is not None:
        time, name = (
            column_maps.TIMES[given.time.unit] * table[given.time.column],
            given.time.column,
        )
    elif given.time.rate is not None or table.rate is not None:
        time, name = np.arange(n) / (given.time.rate or table.rate or 1.0), "time"
    else:
        raise ValueError(
            "The map must say `time.column` or `time.rate`: the file does not state times of its rows."
        )
    if not np.all(np.isfinite(time)):
        raise BadArgument(
            name,
            f"must hold numbers, but has none in its row {int(np.argmin(np.isfinite(time))) + 1}",
        )
    rows = np.ones(n, dtype=np.bool_)
    if given.start is not None:
        rows &= time >= given.start
    if given.stop is not None:
        rows &= time <= given.stop
    if np.count_nonzero(rows) < 2:
        raise ValueError(
            f"`{name}` must have at least 2 samples between `start` and `stop`, "
            f"got {np.count_nonzero(rows)}; the file has {n} from {time[0]:g} s to {time[-1]:g} s."
            if n
            else f"`{name}` must have at least 2 samples, got none."
        )
    kept = check_times(name, time[rows])
    step = float(np.median(np.diff(kept)))
    if step > SLOWEST_SAMPLING:
        raise ValueError(
            f"`{name}` must have steps of at most {SLOWEST_SAMPLING:g} s, got {step:g} s; is its unit ms?"
        )
    longest = float(np.max(np.diff(kept)))
    if longest > max(given.longest_gap, 3.0 * step):
        at = float(kept[np.argmax(np.diff(kept))])
        rule = f"must have no gap longer than `longest_gap` = {given.longest_gap:g} s, got one of {longest:.4g} s"
        raise BadArgument(name, f"{rule} after {at:.6g} s; cut it off with `start` and `stop`")
    # Time counts from the start requested by the user, or from the first row.
    return kept - (given.start if given.start is not None else float(kept[0])), rows


# ---- joints, rates, work -------------------------------------------------------------------------


def _add_rates(found: dict[str, Any], window: float) -> None:
    """Add what can be derived from a trial's arrays: joint angles from link angles, and rates over a time window."""
    if "link_angle" in found:
        found.setdefault("joint_angle", kinematics.joint_angles(found["link_angle"]))
    rates = {
        "center_of_mass": "center_of_mass_velocity",
        "heading": "heading_rate",
        "joint_angle": "joint_rate",
    }
    for name, its_rate in rates.items():
        if name in found and its_rate not in found:
            found[its_rate] = differentiate_signal(found["time"], found[name], window)


def _electrical_work(log: Measured) -> Samples:
    """Return the electrical work above idle (4) [J]."""
    given = log.column_map.power
    assert given is not None
    if given.column is not None:
        power = log.raw(given.column)
    else:
        assert given.current is not None
        voltage = log.raw(given.voltage) if isinstance(given.voltage, str) else given.voltage
        power = log.raw(given.current) * voltage
    idle = log.column_map.robot.idle_power if given.idle is None else given.idle
    return metrics.cumulative_integral(
        log.time, log.whole(given.column or given.current or "", power) - idle
    )


def differentiate_signal(
    time: Samples, signal: Float[np.ndarray, "n ..."], window: float
) -> Float[np.ndarray, "n ..."]:
    """Compute the slope of a signal: that of the cubic polynomial fitted over a window around each moment.

    This is a Savitzky-Golay filter, exact for cubic polynomials even at both ends, where the window
    is one-sided. It damps what is faster than about 1 / window. Unevenly spaced samples are first
    interpolated onto an even grid.

    Args:
        time: Times of the samples [s], strictly increasing.
        signal: Values at the samples.
        window: Length of the window [s]; it covers at least five samples, or all of them if there
            are fewer.

    Source:
        Savitzky and Golay, Analytical Chemistry 36 (1964) 1627.
    """
    n = time.size
    if n < 2:
        return np.zeros_like(signal)
    step = float(time[-1] - time[0]) / (n - 1)
    even = time[0] + step * np.arange(n)
    flat = signal.reshape(n, -1)
    is_even = bool(np.max(np.abs(even - time)) < 1e-3 * step)
    values = flat if is_even else interpolated(even, time, flat)
    width = 2 * max(round(0.5 * window / step), 2) + 1
    slope = _slopes(values, min(width, n)) / step
    if not is_even:
        slope = interpolated(time, even, slope)
    return slope.reshape(signal.shape)


def interpolated(
    at: Float[np.ndarray, "*at"], time: Samples, values: Columns
) -> Float[np.ndarray, "*at n_columns"]:
    """Interpolate linearly between known values, column by column; a column without known values stays nan.

    Args:
        at: Times at which values are wanted [s].
        time: Times of the samples, increasing [s].
        values: Values at the samples; nan where unknown.
    """
    found = np.full((*at.shape, values.shape[1]), np.nan)
    for i, column in enumerate(values.T):
        known = np.isfinite(column)
        if known.any():
            found[..., i] = np.interp(at, time[known], column[known])
    return found


def _slopes(values: Columns, width: int) -> Columns:
    """Compute the slopes per sample, with windows of `width` samples."""
    before, order = width // 2, min(ORDER, width - 1)
    at = np.arange(width) - 0.5 * (width - 1)
    fit = np.linalg.pinv(np.vander(at, order + 1, increasing=True))  # values -> coefficients
    powers = np.arange(1, order + 1)
    weights = (powers * at[:, np.newaxis] ** (powers - 1)) @ fit[
        1:
    ]  # of the values in a window, for each place in it
    windows = np.lib.stride_tricks.sliding_window_view(values, width, axis=0)
    begin, end = weights[:before] @ values[:width], weights[before + 1 :] @ values[-width:]
    return np.concatenate((begin, windows @ weights[before], end))


# ---- checks and texts ----------------------------------------------------------------------------


def _check_plausible(arrays: dict[str, Any], chain: robot.Robot) -> None:
    """Reject values that only a wrong unit can explain."""
    speed = float(np.median(np.linalg.norm(arrays["center_of_mass_velocity"], axis=1)))
    if speed > FASTEST * chain.length:
        raise ValueError(
            f"The robot of {chain.length:.3g} m must swim at most {FASTEST:g} lengths per second, got {speed:.3g} m/s; "
            "is `length_unit` mm?"
        )
    for name in ("joint_angle", "joint_angle_ref"):
        largest = float(np.max(np.abs(arrays.get(name, 0.0)), initial=0.0))
        if largest > LARGEST_BEND:
            raise ValueError(
                f"`{name}` must be between -pi and pi rad, got {largest:.4g} rad; is its `unit` deg?"
            )


def _status(log: Measured) -> str:
    if not log.filled_columns:
        return "Measured, without gaps."
    n, columns = int(np.count_nonzero(log.lost)), sorted(set(log.filled_columns))
    shown = ", ".join(columns[:4]) + (f" and {len(columns) - 4} more" if len(columns) > 4 else "")
    return (
        f"Measured; {n} of {log.time.size} samples had gaps in {shown}, filled by straight lines."
    )


# ---- tables that laticauda wrote -----------------------------------------------------------------


def _own_table(table: tables.Table, known: scenarios.Experiment) -> trial.Trial:
    """Read a CSV file that laticauda wrote: every number unchanged, with robot and gait from the map."""
    plain = {
        name.split(" [")[0]: values
        for name, values in table.columns.items()
        if not isinstance(values, str)
    }
    if "center_of_mass_x" not in plain:
        raise ValueError(
            "The map must have `body`, `center_of_mass` or `ends`: it does not say where the robot was."
        )
    try:
        arrays = {name: tabular.series(plain, name) for name in dataset.PLAIN}
        arrays["work"] = np.stack([plain[name] for name in dataset.WORK], axis=1)
    except KeyError as error:
        raise ValueError(f"The file has no column `{error.args[0]}`.") from error
    arrays |= {
        name: one
        for name, one in plain.items()
        if name == dataset.ELECTRICAL or name.startswith(series.SIGNAL)
    }
    return trial.Trial(**vars(series.log_of(arrays)), scenario=known, version=version("laticauda"))
