"""Series of runs: each setting repeated, with mean and scatter, and the rejected runs with the reasons."""

import math
import re
import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from laticauda import robot
from laticauda.tank.operate.recording import log, to_trial
from laticauda.tank.operate.session import TOLD, Result, kept_runs
from laticauda.tank.operate.settings import Operation, SeriesFile
from laticauda.values import files
from laticauda.values.errors import TrialFileError

COLUMNS = ("gait", "config", "alpha_deg", "omega_deg_s", "delta_deg", "v_m_s", "P_avg_W")
KINDS = {"lateral_undulation": "LU", "eel_like": "EEL"}
FIGURES: dict[str, tuple[str, int, int] | None] = {
    name: one or None for name, one in TOLD["series"].items()
}
"""Figures of a setting, with title, width and digits of their column in the table; None: not in the table."""
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
            result for result in self.results if result.accepted and result.trial is not None
        )

    def figure(self, name: str) -> tuple[float, float | None] | None:
        """Return mean and standard deviation of a figure; one run has no deviation, and no runs give None.

        Args:
            name: Name of a figure in `Result.summary`, such as `forward_velocity`.
        """
        known = [
            value for result in self.accepted if (value := result.summary().get(name)) is not None
        ]
        return mean_and_deviation(known) if known else None


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
        repeats = [len(setting.accepted) for setting in self.settings]
        return len(repeats) == len(self.file.trials) and all(
            n >= self.file.repeats for n in repeats
        )

    def summary(self) -> dict[str, Any]:
        """Return everything by name, ready for JSON."""
        return {
            "name": self.file.name,
            "complete": self.is_complete,
            "repeats_file": str(self.folder / "repeats.csv"),
            "settings": [
                {
                    "name": setting.operation.name,
                    "accepted": len(setting.accepted),
                    "rejected": [r.reason for r in setting.results if not r.accepted],
                    **{name: setting.figure(name) for name in FIGURES},
                    "aftermath": [r.aftermath for r in setting.results if r.aftermath],
                }
                for setting in self.settings
            ],
        }

    def table(self) -> str:
        """Return a table of mean and scatter per setting, and the reasons why runs were rejected."""
        shown = [(name, *column) for name, column in FIGURES.items() if column is not None]
        lines = [
            f"{'setting':<34}{'runs':>5}"
            + "".join(f"{title:>{width}}" for _, title, width, _ in shown)
        ]
        for setting in self.settings:
            figures = (
                f"{_shown(setting.figure(name), digits):>{width}}"
                for name, _, width, digits in shown
            )
            runs = f"{len(setting.accepted)}/{self.file.repeats}"
            lines.append(f"{setting.operation.name:<34}{runs:>5}" + "".join(figures))
        for result in (result for setting in self.settings for result in setting.results):
            lines += [] if result.accepted else [f"rejected: {result.name}: {result.reason}"]
            lines += [f"{result.name}: {result.aftermath}"] if result.aftermath else []
        lines.append(f"for `laticauda reproduce --repeats`: {self.folder / 'repeats.csv'}")
        return "\n".join(lines)


def mean_and_deviation(values: Sequence[float]) -> tuple[float, float | None]:
    """Return mean and standard deviation of some values; a single value has no deviation."""
    return statistics.fmean(values), statistics.stdev(values) if len(values) > 1 else None


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
        earlier = {
            number: _stored(operation, number, folder)
            for number in _numbers(operation.name, folder)
        }
        setting = Repeats(operation=operation, results=tuple(earlier.values()))
        first = max(earlier, default=0) + 1
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


def _numbers(name: str, folder: Path) -> list[int]:
    """Return the numbers of the runs of a setting that a folder holds."""
    found = (re.fullmatch(rf"{re.escape(name)}-([1-9][0-9]*)", run) for run in kept_runs(folder))
    return sorted(int(match[1]) for match in found if match is not None)


def _stored(operation: Operation, number: int, folder: Path) -> Result:
    """Return the result of a run of an earlier call; of a killed one, as far as its recording goes."""
    from laticauda.trials.logs import load_trial

    path = folder / f"{operation.name}-{number}.nc"
    try:
        if path.exists():
            trial = load_trial(path)
        else:
            trial = to_trial.trial_of(log.read_operation(path.with_suffix(".mcap")))
            trial.save(path)
    except TrialFileError as error:
        return Result(name=path.stem, accepted=False, reason=str(error), trial=None)
    noted = {name: trial.settings.get(name) for name in ("idle_current", "supply_voltage")}
    electric: dict[str, Any] = {
        name: float(one) for name, one in noted.items() if isinstance(one, float | int)
    }
    return Result(
        name=path.stem,
        accepted=trial.succeeded,
        reason="Read from its file." if trial.succeeded else trial.status,
        trial=trial,
        **electric,
    )


def _write_repeats(folder: Path, settings: list[Repeats]) -> None:
    """Write the table that `laticauda reproduce --repeats` reads, with one row per accepted run."""
    rows: list[tuple[object, ...]] = []
    for setting in settings:
        gait = setting.operation.gait
        if gait.kind not in KINDS:
            continue
        config = (
            "fin" if robot.load_robot(setting.operation.robot).caudal_fin is not None else "nofin"
        )
        angles = [
            round(math.degrees(value), 9)
            for value in (gait.amplitude, gait.frequency, gait.phase_shift)
        ]
        for result in setting.accepted:
            summary = result.summary()
            figures = summary["forward_velocity"], summary.get("electrical_power")
            rows.append((KINDS[gait.kind], config, *angles, *figures))
    files.local(folder).mkdir(parents=True, exist_ok=True)
    files.write(folder / "repeats.csv", files.csv_text([COLUMNS, *rows]))


def _shown(figure: tuple[float, float | None] | None, digits: int) -> str:
    if figure is None:
        return "-"
    mean, deviation = figure
    return f"{mean:.{digits}f}" + ("" if deviation is None else f" ± {deviation:.{digits}f}")
