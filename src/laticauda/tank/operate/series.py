"""Series of runs: each setting repeated, with mean and scatter, and why runs were rejected."""

import math
import re
import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

from laticauda import robot
from laticauda.tank.operate.recording import log, to_trial
from laticauda.tank.operate.results import FIGURE_TEXTS, Result
from laticauda.tank.operate.session import kept_runs
from laticauda.tank.operate.settings import Operation, SeriesFile
from laticauda.trials import Trial
from laticauda.values import TrialFileError, files

COLUMNS = ("gait", "config", "alpha_deg", "omega_deg_s", "delta_deg", "v_m_s", "P_avg_W")
"""Columns of the table of repeats."""
GAIT_LABELS = {"lateral_undulation": "LU", "eel_like": "EEL"}
"""What the paper calls the gaits; runs of other gaits are not in the table of repeats."""
ANGLE_DIGITS = 9
"""Digits of the angles in that table, so that 30 deg in the trial file are 30."""


class FigureColumn(NamedTuple):
    """Column of a figure in the table of a series."""

    title: str
    """Title of the column."""
    width: int
    """Width in characters."""
    digits: int
    """Digits after the decimal point."""


FIGURES: dict[str, FigureColumn | None] = {
    name: FigureColumn(*column) if column else None
    for name, column in FIGURE_TEXTS["series"].items()
}
"""Figures of a setting, with their columns in the table; None: not in the table."""
Run = Callable[[Operation, Path], Result]
Place = Callable[[Operation, int], None]
Acknowledge = Callable[[Result], bool]
"""Function that asks whether somebody has looked at a robot that a fault has stopped."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Repeats:
    """All runs of one setting."""

    operation: Operation
    """Operation that was to be run."""
    results: tuple[Result, ...]
    """Results in the order of the runs, including the rejected ones."""

    @property
    def accepted(self) -> tuple[Result, ...]:
        """Results of the runs that count."""
        return tuple(
            result
            for result in self.results
            if result.accepted and result.trial is not None and result.trial.succeeded
        )

    def figure(self, name: str) -> tuple[float, float | None] | None:
        """Return mean and standard deviation of a figure; None without a run.

        One run has no deviation.

        Args:
            name: Name of a figure in `Result.summary`, such as `forward_velocity`.
        """
        values: list[float] = []
        for result in self.accepted:
            value = result.summary().get(name)
            if value is not None:
                values.append(value)
        if not values:
            return None
        return mean_and_deviation(values)


@dataclass(frozen=True, kw_only=True, eq=False)
class Series:
    """Outcome of a series."""

    file: SeriesFile
    """Series that was to be run."""
    settings: tuple[Repeats, ...]
    """Settings in the order of the file, with their runs."""
    folder: Path
    """Folder of the trials, the recordings and the table of repeats."""

    @property
    def is_complete(self) -> bool:
        """Whether every setting has all its repeats."""
        if len(self.settings) != len(self.file.trials):
            return False
        return all(len(setting.accepted) >= self.file.repeats for setting in self.settings)

    @property
    def repeats_file(self) -> Path:
        """Table of repeats."""
        return self.folder / "repeats.csv"

    def summary(self) -> dict[str, Any]:
        """Return everything by name, ready for JSON."""
        return {
            "name": self.file.name,
            "complete": self.is_complete,
            "repeats_file": str(self.repeats_file),
            "settings": [_summarize_setting(setting) for setting in self.settings],
        }

    def table(self) -> str:
        """Return a table of mean and scatter by setting, and the reasons of rejected runs."""
        columns = {name: column for name, column in FIGURES.items() if column is not None}
        titles = "".join(f"{column.title:>{column.width}}" for column in columns.values())
        lines = [f"{'setting':<34}{'runs':>5}{titles}"]
        for setting in self.settings:
            runs = f"{len(setting.accepted)}/{self.file.repeats}"
            line = f"{setting.operation.name:<34}{runs:>5}"
            for name, column in columns.items():
                figure = _format_figure(setting.figure(name), column.digits)
                line += f"{figure:>{column.width}}"
            lines.append(line)
        for setting in self.settings:
            lines += _list_problems(setting)
        lines.append(f"for `laticauda reproduce --repeats`: {self.repeats_file}")
        return "\n".join(lines)


def _summarize_setting(setting: Repeats) -> dict[str, Any]:
    return {
        "name": setting.operation.name,
        "accepted": len(setting.accepted),
        "rejected": [result.reason for result in setting.results if not result.accepted],
        **{name: setting.figure(name) for name in FIGURES},
        "aftermath": [result.aftermath for result in setting.results if result.aftermath],
    }


def _list_problems(setting: Repeats) -> list[str]:
    """Return why runs were rejected, and what happened after others, one a line."""
    lines: list[str] = []
    for result in setting.results:
        if not result.accepted:
            lines.append(f"rejected: {result.name}: {result.reason}")
        if result.aftermath:
            lines.append(f"{result.name}: {result.aftermath}")
    return lines


def mean_and_deviation(values: Sequence[float]) -> tuple[float, float | None]:
    """Return mean and standard deviation of some values; a single value has no deviation."""
    mean = statistics.fmean(values)
    if len(values) == 1:
        return mean, None
    return mean, statistics.stdev(values)


def run_series(
    series: SeriesFile,
    folder: Path,
    run: Run,
    *,
    place: Place = lambda _, number: None,
    acknowledge: Acknowledge = lambda _: False,
) -> Series:
    """Run every setting until it has all its repeats, or has been rejected too often.

    The folder holds the trial (``.nc``) and the recording (``.mcap``) of every run, and
    ``repeats.csv``, which is updated after every run. A series that was stopped, rejected or killed
    is continued: runs in the folder count as they ended, including a recording whose program was
    killed before it made a trial of it, and further runs take the next number.

    Args:
        series: Series to run.
        folder: Folder for all files.
        run: Function that operates once and writes into a folder.
        place: Called before every run with the setting and the number of the run, so that the robot
            can be placed.
        acknowledge: Called after a run that a fault has stopped: whether somebody has looked at the
            robot, and it may have torque again. By default nobody has.

    Returns:
        The outcome. The series ends early if the operator presses a key to stop, even after a run
        (`Result.stopped`), and if a fault is not acknowledged.

    Raises:
        StorageFailed: If the table cannot be written.
    """
    settings: list[Repeats] = []
    for operation in series.trials:
        earlier_numbers = _numbers_in_folder(operation.name, folder)
        earlier_results = [_read_result(operation, number, folder) for number in earlier_numbers]
        setting = Repeats(operation=operation, results=tuple(earlier_results))
        first = max(earlier_numbers, default=0) + 1
        last = first + series.repeats - len(setting.accepted) + series.retries
        for number in range(first, last):
            if len(setting.accepted) >= series.repeats:
                break
            place(operation, number)
            result = run(replace(operation, name=f"{operation.name}-{number}"), folder)
            setting = replace(setting, results=(*setting.results, result))
            _write_repeats(folder, [*settings, setting])
            if result.stopped or (result.needs_acknowledgment and not acknowledge(result)):
                return Series(file=series, settings=(*settings, setting), folder=folder)
        settings.append(setting)
    _write_repeats(folder, settings)
    return Series(file=series, settings=tuple(settings), folder=folder)


def _numbers_in_folder(name: str, folder: Path) -> list[int]:
    """Return the numbers of the runs of a setting that a folder holds, in ascending order."""
    numbers: list[int] = []
    for run_name in kept_runs(folder):
        match = re.fullmatch(rf"{re.escape(name)}-([1-9][0-9]*)", run_name)
        if match is not None:
            numbers.append(int(match[1]))
    return sorted(numbers)


def _read_result(operation: Operation, number: int, folder: Path) -> Result:
    """Return the result of a run of an earlier call; of a killed one, as far as it was recorded."""
    path = folder / f"{operation.name}-{number}.nc"
    try:
        trial = _read_trial(path)
    except TrialFileError as error:
        return Result(name=path.stem, accepted=False, reason=str(error), trial=None)
    return Result(
        name=path.stem,
        accepted=trial.succeeded,
        reason="Read from its file." if trial.succeeded else trial.status,
        trial=trial,
        idle_current=_number_or_none(trial.settings.get("idle_current")),
        supply_voltage=_number_or_none(trial.settings.get("supply_voltage")),
    )


def _read_trial(path: Path) -> Trial:
    """Return a trial from its file, or make it of the recording beside it."""
    from laticauda.trials.logs import load_trial

    if path.exists():
        return load_trial(path)
    trial = to_trial.trial_of(log.read_operation(path.with_suffix(".mcap")))
    trial.save(path)
    return trial


def _number_or_none(value: object) -> float | None:
    if isinstance(value, float | int):
        return float(value)
    return None


def _write_repeats(folder: Path, settings: Sequence[Repeats]) -> None:
    """Write the table that `laticauda reproduce --repeats` reads: one row per accepted run."""
    rows: list[tuple[object, ...]] = []
    for setting in settings:
        rows += _rows_of_repeats(setting)
    files.local(folder).mkdir(parents=True, exist_ok=True)
    files.write(folder / "repeats.csv", files.csv_text([COLUMNS, *rows]))


def _rows_of_repeats(setting: Repeats) -> list[tuple[object, ...]]:
    """Return the rows of one setting, in the order of `COLUMNS`."""
    gait = setting.operation.gait
    if gait.kind not in GAIT_LABELS:
        return []
    has_fin = robot.load_robot(setting.operation.robot).caudal_fin is not None
    config = "fin" if has_fin else "nofin"
    rows: list[tuple[object, ...]] = []
    for result in setting.accepted:
        summary = result.summary()
        rows.append(
            (
                GAIT_LABELS[gait.kind],
                config,
                _degrees(gait.amplitude),
                _degrees(gait.frequency),
                _degrees(gait.phase_shift),
                summary["forward_velocity"],
                summary.get("electrical_power"),
            )
        )
    return rows


def _degrees(angle: float) -> float:
    return round(math.degrees(angle), ANGLE_DIGITS)


def _format_figure(figure: tuple[float, float | None] | None, digits: int) -> str:
    """Return mean and deviation as text."""
    if figure is None:
        return "-"
    mean, deviation = figure
    if deviation is None:
        return f"{mean:.{digits}f}"
    return f"{mean:.{digits}f} ± {deviation:.{digits}f}"
