"""A series: every setting several times, the mean and the scatter, and the runs that were rejected, with the reason."""

import csv
import io
import itertools
import math
import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from laticauda import files, robot
from laticauda.operate.files import SeriesFile
from laticauda.operate.session import Result
from laticauda.operate.settings import Operation

COLUMNS = ("gait", "config", "alpha_deg", "omega_deg_s", "delta_deg", "v_m_s", "P_avg_W")
KINDS = {"lateral_undulation": "LU", "eel_like": "EEL"}
FIGURES: dict[str, tuple[str, int, int] | None] = {
    "forward_velocity": ("v [m/s]", 20, 4),
    "electrical_power": ("P above idle [W]", 20, 2),
    "total_power": ("P total [W]", 18, 2),
    "convergence_time": None,
    "steady_error": ("p_y RMS [m]", 20, 4),
}
"""Figures of a setting, and where the table has them: title, width and digits."""
Run = Callable[[Operation, Path], Result]
Place = Callable[[Operation, int], None]


@dataclass(frozen=True, kw_only=True, eq=False)
class Repeats:
    """All runs of one setting."""

    operation: Operation
    """What was to be run."""
    results: tuple[Result, ...]
    """In their order, the rejected ones too."""

    @property
    def accepted(self) -> tuple[Result, ...]:
        """The runs that count."""
        return tuple(result for result in self.results if result.accepted and result.trial is not None)

    def figure(self, name: str) -> tuple[float, float | None] | None:
        """Mean and standard deviation of a figure of the summary; one run has no deviation, and none gives None.

        Args:
            name: As in `Result.summary`.
        """
        known = [value for result in self.accepted if (value := result.summary().get(name)) is not None]
        return mean_and_deviation(known) if known else None


@dataclass(frozen=True, kw_only=True, eq=False)
class Series:
    """What became of a series."""

    file: SeriesFile
    """What was to be run."""
    settings: tuple[Repeats, ...]
    """In the order of the file."""
    folder: Path
    """Trials, recordings and the table of repeats."""

    @property
    def is_complete(self) -> bool:
        """Whether every setting has its repeats."""
        repeats = [len(setting.accepted) for setting in self.settings]
        return len(repeats) == len(self.file.trials) and all(n >= self.file.repeats for n in repeats)

    def summary(self) -> dict[str, Any]:
        """Everything by name, ready for JSON."""
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
        """Mean and scatter per setting, and why runs were rejected."""
        shown = [(name, *column) for name, column in FIGURES.items() if column is not None]
        lines = [f"{'setting':<34}{'runs':>5}" + "".join(f"{title:>{width}}" for _, title, width, _ in shown)]
        for setting in self.settings:
            figures = (f"{_shown(setting.figure(name), digits):>{width}}" for name, _, width, digits in shown)
            runs = f"{len(setting.accepted)}/{self.file.repeats}"
            lines.append(f"{setting.operation.name:<34}{runs:>5}" + "".join(figures))
        for result in (result for setting in self.settings for result in setting.results):
            lines += [] if result.accepted else [f"rejected: {result.name}: {result.reason}"]
            lines += [f"{result.name}: {result.aftermath}"] if result.aftermath else []
        lines.append(f"for `laticauda reproduce --repeats`: {self.folder / 'repeats.csv'}")
        return "\n".join(lines)


def mean_and_deviation(values: Sequence[float]) -> tuple[float, float | None]:
    """Mean and standard deviation of some values; one has no deviation."""
    return statistics.fmean(values), statistics.stdev(values) if len(values) > 1 else None


def run_series(series: SeriesFile, folder: Path, run: Run, *, place: Place | None = None) -> Series:
    """Run every setting until it has its repeats, or has been rejected too often.

    The folder holds trials (``.nc``) and recordings (``.mcap``) run by run, and ``repeats.csv``, which is brought up to
    date after every run. A series that was stopped goes on where it was: runs whose trial is there are not done again.

    Args:
        series: What to run.
        folder: Where everything goes.
        run: Operates once, into a folder.
        place: Called before every run, with the setting and the number of the run, for somebody to put the robot there.

    Returns:
        What became of it. Once the operator stops a run by key, the series ends there.

    Raises:
        StorageFailed: If the table cannot be written.
    """
    found: dict[str, list[Result]] = {}
    settings: list[Repeats] = []
    for operation, number in itertools.product(series.trials, range(1, series.repeats + series.retries + 1)):
        results = found.setdefault(operation.name, [])
        if sum(result.accepted for result in results) >= series.repeats:
            continue
        one = replace(operation, name=f"{operation.name}-{number}")
        result = _stored(one, folder)
        if result is None:
            if place is not None:
                place(operation, number)
            result = run(one, folder)
        results.append(result)
        begun = [each for each in series.trials if each.name in found]
        settings = [Repeats(operation=each, results=tuple(found[each.name])) for each in begun]
        _write_repeats(folder, settings)
        if not result.accepted and "the operator" in result.reason:
            break
    return Series(file=series, settings=tuple(settings), folder=folder)


def _stored(operation: Operation, folder: Path) -> Result | None:
    """An accepted run of an earlier call; None if there is none."""
    from laticauda.logs import load_trial

    path = folder / f"{operation.name}.nc"
    if not path.exists():
        return None
    trial = load_trial(path)
    if not trial.succeeded:
        return None
    idle, voltage = (trial.settings.get(name) for name in ("idle_current", "supply_voltage"))
    return Result(
        name=operation.name,
        accepted=True,
        reason="Taken from its file.",
        trial=trial,
        idle_current=float(idle) if isinstance(idle, float | int) else None,
        supply_voltage=float(voltage) if isinstance(voltage, float | int) else None,
    )


def _write_repeats(folder: Path, settings: list[Repeats]) -> None:
    """The table that `laticauda reproduce --repeats` reads: one row per accepted run."""
    rows: list[tuple[object, ...]] = []
    for setting in settings:
        gait = setting.operation.gait
        if gait.kind not in KINDS:
            continue
        config = "fin" if robot.load_robot(setting.operation.robot).caudal_fin is not None else "nofin"
        angles = [round(math.degrees(value), 9) for value in (gait.amplitude, gait.frequency, gait.phase_shift)]
        for result in setting.accepted:
            summary = result.summary()
            power = summary.get("electrical_power")
            velocity = summary["forward_velocity"]
            rows.append((KINDS[gait.kind], config, *angles, velocity, "" if power is None else power))
    text = io.StringIO(newline="")
    csv.writer(text).writerows([COLUMNS, *rows])
    files.local(folder).mkdir(parents=True, exist_ok=True)
    files.write(folder / "repeats.csv", text.getvalue())


def _shown(figure: tuple[float, float | None] | None, digits: int) -> str:
    if figure is None:
        return "-"
    mean, deviation = figure
    return f"{mean:.{digits}f}" + ("" if deviation is None else f" ± {deviation:.{digits}f}")
