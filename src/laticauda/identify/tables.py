"""Measurements from tables of speeds: the paper's Table 1, or your own."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

import laticauda as lc
from laticauda.identify.measurements import Measurement
from laticauda.scenarios import build_scenario
from laticauda.trials import MeasuredTrials, measured, null_models
from laticauda.values import (
    RobotFileError,
    SkippedRowsWarning,
    TrialFileError,
    check_choice,
    check_positive,
    warn_caller,
)

TABLE_SIGMA = 0.05
"""Default noise of a table's numbers, as a fraction of each value; the paper states none [-]."""
TABLE_SELECTED_FROM = 3
"""Assumed number of equally good settings from which a starred row of Table 1 was selected [-]."""
FIGURES = ("forward_velocity", "mean_power")
"""Figures that a table can hold."""
WORDS_OF_FIGURES = {"forward_velocity": "speed", "mean_power": "power"}
"""What people call them."""
MOST_LISTED = 20
"""Rows that a message lists at most."""
_LONGEST_STRIDE = 2.0
"""Distance per cycle that no swimmer exceeds, in body lengths [-]."""


def from_table1(
    figure: str = "forward_velocity",
    *,
    sigma: float = TABLE_SIGMA,
    selected_from: int = TABLE_SELECTED_FROM,
) -> tuple[Measurement, ...]:
    """Return the paper's Table 1: Mamba, with and without its fin, 30 s from standstill.

    The paper states no noise. Each row is given the same relative noise, which is best regarded as
    a guess and estimated from the residuals (`noise="estimated"`). Starred rows are the maxima of
    sweeps.

    Args:
        figure: forward_velocity or mean_power.
        sigma: Standard deviation of the noise as a fraction of the value [-].
        selected_from: Number of about equally good settings from which a starred row was selected
            as the best [-].

    Raises:
        ValueError: If an argument is out of its range.
    """
    check_choice("figure", figure, FIGURES)
    check_positive("sigma", sigma)
    load_robot = cache(lc.load_robot)
    rows: list[Measurement] = []
    for trial in MeasuredTrials.named("table1")().trials():
        value = getattr(trial, figure)
        if value is None:
            continue
        row = Measurement(
            name=_name(trial.gait, trial.has_fin),
            scenario=build_scenario(load_robot(trial.robot), trial.gait),
            figures={figure: (value, sigma * value)},
            selected_from=selected_from if trial.is_maximum else 1,
            assumed=_assumed_noise(figure, sigma, _Number(value=value, sigma=None)),
        )
        rows.append(row)
    return tuple(rows)


def from_table(
    file: str | Path,
    figure: str = "forward_velocity",
    *,
    sigma: float = TABLE_SIGMA,
    robot: str = "mamba",
    columns: Mapping[str, str] | None = None,
) -> tuple[Measurement, ...]:
    """Read speeds or powers from a CSV file with one row per trial.

    `laticauda.trials.measured` describes its columns.

    Args:
        file: Path of the file.
        figure: forward_velocity or mean_power; rows that lack it are skipped, with a warning.
        sigma: Standard deviation of the noise as a fraction of the value, for rows that do not
            state their own [-].
        robot: Robot in rows that do not name one, a preset or a TOML file.
        columns: Names in the file by ours, for columns that it calls otherwise, such as
            ``{"v_m_s": "Speed"}``.

    Warns:
        SkippedRowsWarning: If rows lack the figure.

    Raises:
        TrialFileError: If anything in it is invalid.
        ValueError: If an argument is out of its range.
    """
    check_positive("sigma", sigma)
    check_choice("figure", figure, FIGURES)
    load_swimmer = cache(_load_swimmer)
    n_of_name = Counter[str]()
    measurements: list[Measurement] = []
    rows = measured.load_numbered_speeds(file, columns)
    empty_rows: list[int] = []
    too_fast: dict[int, str] = {}
    for row_number, row in rows.items():
        number = _number_in(row, figure)
        if number.value is None:
            empty_rows.append(row_number)
            continue
        swimmer = load_swimmer(row.robot or robot, row.config)
        gait = row.motion
        doubt = _doubt_stride(row, swimmer)
        if doubt:
            too_fast[row_number] = doubt
            continue
        name = _name(gait, swimmer.caudal_fin is not None)
        n_of_name[name] += 1
        if n_of_name[name] > 1:
            name = f"{name} ({n_of_name[name]})"
        measurement = Measurement(
            name=name,
            scenario=build_scenario(swimmer, gait, row.duration_s),
            figures={figure: (number.value, number.sigma or sigma * number.value)},
            selected_from=row.selected_from,
            assumed=_assumed_noise(figure, sigma, number),
        )
        measurements.append(measurement)
    if too_fast:
        first = next(iter(too_fast))
        raise TrialFileError(f"{file}: {_list_rows(list(too_fast))}: {too_fast[first]}")
    if not measurements:
        raise TrialFileError(f"{file}: none of its rows has a {figure.replace('_', ' ')}.")
    if empty_rows:
        _warn_of_empty(file, figure, empty_rows, n_rows=len(rows))
    return tuple(measurements)


def _assumed_noise(figure: str, sigma: float, number: "_Number") -> str:
    """Return the sentence about noise that a table does not state; "" if it, or the caller, does."""
    if number.sigma or sigma != TABLE_SIGMA:
        return ""
    what = f"{WORDS_OF_FIGURES[figure]}s"
    return f"The table states no noise of its {what}: {100.0 * sigma:g} % of each was assumed."


class _Number(NamedTuple):
    """A number in a row, and the standard deviation of its noise, as far as the row states them."""

    value: float | None
    sigma: float | None


def _number_in(row: measured.SpeedTrial, figure: str) -> _Number:
    if figure == "forward_velocity":
        return _Number(value=row.v_m_s, sigma=row.v_sigma_m_s)
    return _Number(value=row.P_avg_W, sigma=row.P_sigma_W)


def _warn_of_empty(file: str | Path, figure: str, empty_rows: list[int], *, n_rows: int) -> None:
    """Say which rows are left out."""
    verb = "has"
    if len(empty_rows) > 1:
        verb = "have"
    noun = WORDS_OF_FIGURES[figure]
    message = (
        f"{file}: {len(empty_rows)} of {n_rows} rows {verb} no {noun}: {_list_rows(empty_rows)}"
    )
    warn_caller(message, SkippedRowsWarning)


def _list_rows(rows: Sequence[int]) -> str:
    """Return the numbers of rows as a message shows them."""
    if len(rows) == 1:
        return f"row {rows[0]}"
    listed = ", ".join(map(str, rows[:MOST_LISTED]))
    if len(rows) > MOST_LISTED:
        listed += ", ..."
    return f"rows {listed}"


def _doubt_stride(row: measured.SpeedTrial, robot: lc.Robot) -> str:
    """Return why nothing swims at a speed, which is mostly one in another unit; "" if something does."""
    speed = row.v_m_s or 0.0
    stride = 2.0 * np.pi * speed / row.motion.frequency / robot.length
    if stride <= _LONGEST_STRIDE:
        return ""
    return (
        f"`v_m_s` of {row.v_m_s:g} at `omega_deg_s` of {row.omega_deg_s:g} is "
        f"{stride:.3g} lengths of `{robot.name}` per cycle, more than anything swims; "
        "is one in another unit, such as cm/s, rad/s or Hz?"
    )


def _load_swimmer(name: str, config: str | None) -> lc.Robot:
    """Return the robot that swam; a preset without a fin has a counterpart preset with one."""
    robot = lc.load_robot(name)
    if config == "nofin":
        return replace(robot, caudal_fin=None)
    if config is None or robot.caudal_fin is not None:
        return robot
    try:
        return lc.load_robot(f"{name}-fin")
    except RobotFileError:
        raise TrialFileError(
            f"`config` must be nofin for `{name}`, which has no caudal fin."
        ) from None


def _name(gait: lc.Gait, has_fin: bool) -> str:
    return f"{null_models.group_name(gait.kind, has_fin)}, {setting_of(gait)}"


def setting_of(gait: lc.Gait) -> str:
    """Format amplitude, frequency and phase shift in degrees, as in names: 30/130/40."""
    setting = (gait.amplitude, gait.frequency, gait.phase_shift)
    return "/".join(f"{np.degrees(number):.0f}" for number in setting)
