"""A trial from the table of an external log: units, axes, kinematics, gaps, rates and work."""

from collections.abc import Sequence
from importlib.metadata import version
from typing import Any

import numpy as np

from laticauda import robot, scenarios
from laticauda.robot import kinematics
from laticauda.trials import Trial, dataset, metrics
from laticauda.trials.arrays import Samples
from laticauda.trials.logs import tabular
from laticauda.trials.logs.column_maps import ColumnMap
from laticauda.trials.logs.map_sections import Power
from laticauda.trials.logs.measured_log import MeasuredLog
from laticauda.trials.logs.placing import measure_placement, read_joints
from laticauda.trials.logs.rates import differentiate_signal
from laticauda.trials.logs.row_times import select_rows
from laticauda.values import series
from laticauda.values.tables import Table

FASTEST = 5.0
"""Speed in robot lengths per second [1/s]; anything faster is in another unit."""
N_LISTED_COLUMNS = 4
"""Columns with gaps that the status of a trial lists by name at most."""
RATES = {
    "center_of_mass": "center_of_mass_velocity",
    "heading": "heading_rate",
    "joint_angle": "joint_rate",
}
"""Time series whose rate is part of a trial, with the name of the rate."""


def build_measured_trial(table: Table, column_map: ColumnMap, source: str) -> Trial:
    """Build a trial from an external log.

    What was not measured is listed in the trial's `not_measured`, and figures that need it raise an
    error. Positions and angles are used unchanged; their rates are the slopes of cubic fits over
    `smoothing`. Work is that of the measured torques, electrical work that of the measured power
    above idle (4).

    Args:
        table: The log.
        column_map: Meaning of its columns.
        source: Name of the log.

    Raises:
        ValueError: If a column is missing, time does not increase, values are missing over too long
            a time, or the stated units cannot be right; the message gives the column and the value.
    """
    notes = {"model": "measured", "source": source, "smoothing": column_map.smoothing}
    sections_of_position = (column_map.center_of_mass, column_map.body, column_map.ends)
    if all(section is None for section in sections_of_position):
        return _read_own_table(table, _describe_experiment(column_map, notes))
    rows = select_rows(table, column_map)
    log = MeasuredLog(
        table=table,
        column_map=column_map,
        rows=rows.is_included,
        time=rows.time,
        has_gap=np.zeros(rows.time.size, dtype=np.bool_),
    )
    if rows.remark:
        log.remarks.append(rows.remark)
    arrays = _read_series(log)
    if column_map.power is not None:
        arrays["electrical_work"] = _integrate_power(log, column_map.power)
    signals = {
        name: log.fill(column, log.read(column)) for name, column in column_map.signals.items()
    }
    notes["reading"] = _describe_reading(log)
    notes["filled_samples"] = int(np.count_nonzero(log.has_gap))
    return Trial.measured(
        arrays,
        signals=signals,
        scenario=_describe_experiment(column_map, notes),
        version=version("laticauda"),
        status=_describe_gaps(log),
    )


def _describe_experiment(column_map: ColumnMap, notes: dict[str, Any]) -> scenarios.Experiment:
    return scenarios.Experiment(
        robot=column_map.robot,
        gait=column_map.gait,
        environment=column_map.environment,
        notes=notes,
    )


# ---- time series ---------------------------------------------------------------------------------


def _read_series(log: MeasuredLog) -> dict[str, Any]:
    """Return the time series of the robot's motion, measured or derived, by their names in a trial."""
    chain = log.column_map.robot.planar()
    arrays: dict[str, Any] = {"time": log.time, **measure_placement(log, chain)}
    for section in log.column_map.joint_sections():
        arrays[section] = read_joints(log, section, chain)
    if "link_angle" in arrays and "joint_angle" not in arrays:
        arrays["joint_angle"] = kinematics.joint_angles(arrays["link_angle"])
    for name, rate_name in RATES.items():
        if name in arrays and rate_name not in arrays:
            arrays[rate_name] = differentiate_signal(
                log.time, arrays[name], window=log.column_map.smoothing
            )
    _check_plausible(arrays, chain)
    return arrays


def _check_plausible(arrays: dict[str, Any], chain: robot.Robot) -> None:
    """Reject values that only a wrong unit can explain."""
    speed = float(np.median(np.linalg.norm(arrays["center_of_mass_velocity"], axis=1)))
    if speed > FASTEST * chain.length:
        raise ValueError(
            f"The robot of {chain.length:.3g} m must swim at most {FASTEST:g} lengths per second, got {speed:.3g} m/s; "
            "is `length_unit` mm?"
        )


def _integrate_power(log: MeasuredLog, meter: Power) -> Samples:
    """Return the electrical work above idle (4) [J]."""
    if meter.column is not None:
        column = meter.column
        power = log.read(column)
    else:
        assert meter.current is not None
        column = meter.current
        power = log.read(column) * _read_voltage(log, meter)
    idle_power = meter.idle
    if idle_power is None:
        idle_power = log.column_map.robot.idle_power
    return metrics.cumulative_integral(log.time, log.fill(column, power) - idle_power)


def _read_voltage(log: MeasuredLog, meter: Power) -> Samples | float:
    """Return the voltage of each sample, or the constant one [V]."""
    assert meter.voltage is not None
    if isinstance(meter.voltage, str):
        return log.read(meter.voltage)
    return meter.voltage


def _describe_reading(log: MeasuredLog) -> str:
    """Return in one line what was read: rows, span, and all that was not taken as the file says it."""
    n_rows = f"{log.time.size} of {log.table.n_rows} rows"
    span = f"from {log.time[0]:.6g} to {log.time[-1]:.6g} s"
    return "; ".join([f"{n_rows}, {span}", *log.table.remarks, *log.remarks, *log.empty_cells])


def _describe_gaps(log: MeasuredLog) -> str:
    if not log.filled_columns:
        return " ".join(["Measured, without gaps.", *_sentences(log.remarks)])
    n_samples_with_gap = int(np.count_nonzero(log.has_gap))
    columns = sorted(set(log.filled_columns))
    n_not_listed = len(columns) - N_LISTED_COLUMNS
    listed = ", ".join(columns[:N_LISTED_COLUMNS])
    if n_not_listed > 0:
        listed += f" and {n_not_listed} more"
    gaps = (
        f"Measured; {n_samples_with_gap} of {log.time.size} samples had gaps in {listed}, "
        "filled by straight lines."
    )
    return " ".join([gaps, *_sentences(log.remarks)])


def _sentences(remarks: Sequence[str]) -> list[str]:
    return [f"{remark[0].upper()}{remark[1:]}." for remark in remarks]


# ---- tables that laticauda wrote -----------------------------------------------------------------


def _read_own_table(table: Table, experiment: scenarios.Experiment) -> Trial:
    """Read a CSV file that laticauda wrote: every number unchanged, with robot and gait from the map."""
    columns: dict[str, Samples] = {}
    for name_and_unit, values in table.columns.items():
        if not isinstance(values, str):
            name = name_and_unit.split(" [")[0]
            columns[name] = values
    if "center_of_mass_x" not in columns:
        raise ValueError(
            "The map must have `body`, `center_of_mass` or `ends`: it does not say where the robot was."
        )
    try:
        arrays = {name: tabular.assemble_series(columns, name) for name in dataset.PLAIN}
        arrays["work"] = np.stack([columns[name] for name in dataset.WORK], axis=1)
    except KeyError as error:
        raise ValueError(f"The file has no column `{error.args[0]}`.") from error
    for name, values in columns.items():
        if name == dataset.ELECTRICAL or name.startswith(series.SIGNAL):
            arrays[name] = values
    log = series.log_of(arrays)
    return Trial(**vars(log), scenario=experiment, version=version("laticauda"))
