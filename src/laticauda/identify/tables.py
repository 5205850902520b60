"""Measurements from tables of speeds: the paper's Table 1, or your own."""

from collections import Counter
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

import laticauda as lc
from laticauda.identify.measurements import Measurement
from laticauda.scenarios import build_scenario
from laticauda.trials import MeasuredTrials, measured, null_models
from laticauda.values.checks import check_choice, check_positive
from laticauda.values.errors import RobotFileError, TrialFileError

TABLE_SIGMA = 0.05
"""Default noise of a table's numbers, as a fraction of each value; the paper states none [-]."""
TABLE_SELECTED_FROM = 3
"""Assumed number of equally good settings from which a starred row of Table 1 was selected as the best [-]."""
FIGURES = ("forward_velocity", "mean_power")
_LONGEST_STRIDE = 2.0  # of any swimmer, in body lengths


def from_table1(
    figure: str = "forward_velocity",
    *,
    sigma: float = TABLE_SIGMA,
    selected_from: int = TABLE_SELECTED_FROM,
) -> tuple[Measurement, ...]:
    """Return the rows of the paper's Table 1: Mamba, with and without its fin, 30 s from standstill.

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
    robots = cache(lc.load_robot)
    return tuple(
        Measurement(
            name=_name(trial.gait, trial.has_fin),
            scenario=build_scenario(robots(trial.robot), trial.gait),
            figures={figure: (value, sigma * value)},
            selected_from=selected_from if trial.is_maximum else 1,
        )
        for trial in MeasuredTrials.named("table1")().trials()
        if (value := getattr(trial, figure)) is not None
    )


def from_table(
    file: str | Path,
    figure: str = "forward_velocity",
    *,
    sigma: float = TABLE_SIGMA,
    robot: str = "mamba",
) -> tuple[Measurement, ...]:
    """Read speeds or powers from a CSV file with one row per trial; `laticauda.trials.measured` describes its columns.

    Args:
        file: Path of the file.
        figure: forward_velocity or mean_power; rows that lack it are skipped.
        sigma: Standard deviation of the noise as a fraction of the value, for rows that do not
            state their own [-].
        robot: Robot in rows that do not name one, a preset or a TOML file.

    Raises:
        TrialFileError: If anything in it is invalid.
        ValueError: If an argument is out of its range.
    """
    check_positive("sigma", sigma)
    is_speed = check_choice("figure", figure, FIGURES) == FIGURES[0]
    robots, seen, found = cache(_robot), Counter[str](), list[Measurement]()
    for row in measured.load_speeds(file):
        value, own = (row.v_m_s, row.v_sigma_m_s) if is_speed else (row.P_avg_W, row.P_sigma_W)
        if value is None:
            continue
        swam, gait = robots(row.robot or robot, row.config), row.motion
        stride = 2.0 * np.pi * (row.v_m_s or 0.0) / gait.frequency / swam.length
        if stride > _LONGEST_STRIDE:
            raise TrialFileError(
                f"{file}: `v_m_s` of {row.v_m_s:g} at `omega_deg_s` of {row.omega_deg_s:g} is {stride:.3g} lengths of "
                f"`{swam.name}` per cycle, more than anything swims; is one in another unit, such as cm/s, rad/s or Hz?"
            )
        name = _name(gait, swam.caudal_fin is not None)
        seen[name] += 1
        found.append(
            Measurement(
                name=name if seen[name] == 1 else f"{name} ({seen[name]})",
                scenario=build_scenario(swam, gait, row.duration_s),
                figures={figure: (value, own or sigma * value)},
                selected_from=row.selected_from,
            )
        )
    if not found:
        raise TrialFileError(f"{file}: none of its rows has a {figure.replace('_', ' ')}.")
    return tuple(found)


def _robot(name: str, config: str | None) -> lc.Robot:
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
    """Format amplitude, frequency and phase shift in degrees, as in names of measurements: 30/130/40."""
    return "/".join(
        f"{np.degrees(number):.0f}" for number in (gait.amplitude, gait.frequency, gait.phase_shift)
    )
