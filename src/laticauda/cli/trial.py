"""Stored trials: `laticauda view`, a film or a picture; `laticauda trial show | compare | plot | convert`."""

from collections.abc import Sequence
from typing import Annotated

import laticauda as lc
from laticauda.cli import command, flags, report, tables
from laticauda.cli.output_files import check_output, list_endings
from laticauda.cli.trial_output import Filming
from laticauda.show import figures
from laticauda.trials import ComparedFigure, Format, logs, note_differences
from laticauda.values import BadArgument, TrialFileError, option, quantity, value_class

TRIAL = (
    "The trial, as `laticauda swim --save` or `trial convert` wrote it, or a log (with --columns)"
)


@value_class
class View(Filming):
    """Show a stored trial in 3D: in MuJoCo's window, or as a film or a picture if there is no screen.

    A planar trial is shown as it was: the 3D robot takes its postures.

    For example: laticauda view run.nc --still run.png
    """

    file: flags.FileArgument = option("The trial, as `laticauda swim --save` wrote it")
    still: Annotated[flags.File, flags.OutputFile((".png",))] = option(
        "Write a picture (.png)", default=None
    )
    time: float | None = quantity("s", "Time of the picture; the end if omitted", default=None)
    speed: float = quantity("", "Playback speed as a multiple of real time", gt=0.0, default=1.0)
    beside: flags.Files = option(
        "Trials of other robots in the same scene, in the film or picture too", default=()
    )

    def run(self) -> command.Outcome:
        """Show or write."""
        if self.time is not None and self.still is None:
            raise BadArgument("time", "must be given with --still: it is the time of the picture")
        trial = lc.load_trial(self.file)
        beside = [lc.load_trial(file) for file in self.beside]
        self._write_still(trial, beside)
        self.write_film(trial, self.speed, beside)
        if self.video is None and self.still is None:
            from laticauda.show.pictures import show_in_window

            show_in_window(trial, speed=self.speed)
        facts = {"file": self.file, "video": self.video, "still": self.still}
        return command.Outcome(facts=facts, text=self._describe_result(trial))

    def draws_robot(self) -> bool:
        """Return whether anything is written for which size and camera count: a film, or a picture."""
        return self.video is not None or self.still is not None

    def _write_still(self, trial: lc.Trial, beside: Sequence[lc.Trial]) -> None:
        """Write the picture if requested."""
        if self.still is None:
            return
        from laticauda.show.pictures import write_still

        write_still(trial, self.still, self.film, time=self.time, beside=beside)

    def _describe_result(self, trial: lc.Trial) -> str:
        if not self.still:
            duration = trial.time[-1] - trial.time[0]
            return f"{_mark_failed(self.video or self.file, trial)}: {duration:g} s shown"
        if self.time is None:
            return f"{self.still}: at the end"
        return f"{self.still}: at {self.time:g} s"


@value_class
class OfTrials(command.Command):
    """A command about stored trials."""

    columns: flags.File = option(
        "TOML file that describes a foreign log's columns (CSV, C3D, .mat, ...)", default=None
    )


@value_class
class Show(OfTrials, Filming):
    """Print the figures of a stored trial, and film it.

    For example: laticauda trial show run.nc
    """

    file: flags.FileArgument = option(TRIAL)

    def run(self) -> command.Outcome:
        """Read."""
        trial = lc.load_trial(self.file, self.columns)
        self.write_film(trial)
        first_line = f"made     {trial.created} with laticauda {trial.version}"
        text = f"{first_line}\n{report.describe_trial(trial)}"
        return command.Outcome(facts=report.facts_of_trial(trial), text=text)


@value_class
class Compare(OfTrials):
    """Print the figures of stored trials side by side, with their differences from the first.

    For example: laticauda trial compare bare.nc fin.nc
    """

    files: flags.FileArguments = option(
        "Two or more trials, the reference first; foreign logs need --columns", default=()
    )

    def run(self) -> command.Outcome:
        """Read and compare."""
        trials = [_load(file, self.columns) for file in self.files]
        rows = lc.compare(trials)
        notes = note_differences(trials, self.files)
        facts_of_figures = {row.figure.name: _facts_of_figure(row) for row in rows}
        facts = {
            "trials": self.files,
            "status": [trial.status for trial in trials],
            "succeeded": [trial.succeeded for trial in trials],
            "notes": notes,
            "figures": facts_of_figures,
        }
        names = [_mark_failed(*pair) for pair in zip(self.files, trials, strict=True)]
        text = _table_of_comparison(names, rows)
        if notes:
            text = f"{report.wrap_notes(notes)}\n\n{text}"
        return command.Outcome(facts=facts, text=text)


@value_class
class Plot(OfTrials):
    """Draw a stored trial: path, speed, joint angles and torques; or the paths and speeds of several in one figure.

    For example: laticauda trial plot bare.nc fin.nc --output both.png
    """

    files: flags.FileArguments = option(
        "One or more trials, in any format that `trial show` reads", default=()
    )
    output: Annotated[flags.RequiredFile, flags.PICTURES] = option(
        "Picture to write or replace: .png, .pdf or .svg"
    )

    def run(self) -> command.Outcome:
        """Read and draw."""
        if not self.files:
            raise BadArgument("files", "must name one or more trials")
        trials = [_load(file, self.columns) for file in self.files]
        if len(trials) == 1:
            figure = trials[0].plot()
        else:
            figure = figures.plot_overlay(trials, self.files)
        figures.save_figure(figure, self.output)
        names = [_mark_failed(*pair) for pair in zip(self.files, trials, strict=True)]
        facts = {
            "trials": self.files,
            "output": self.output,
            "succeeded": [trial.succeeded for trial in trials],
        }
        return command.Outcome(facts=facts, text=f"{self.output}: {', '.join(names)}")


@value_class
class Convert(OfTrials):
    """Write a stored trial in another format: MCAP for Foxglove and ROS 2, Parquet, .mat, netCDF, or a CSV table.

    An output whose name ends in / is a folder for rosbag2, into which recordings of operations can
    be converted, too.

    For example: laticauda trial convert run.nc run.mcap
    """

    file: flags.FileArgument = option(TRIAL)
    output: flags.OutputArgument = option(
        f"File to write or replace: {list_endings(Format.endings())}; or a new FOLDER/"
    )

    def run(self) -> command.Outcome:
        """Read and write."""
        if self.output.endswith("/"):
            return self._write_bag()
        check_output("output", self.output, Format.endings())
        trial = lc.load_trial(self.file, self.columns)
        trial.save(self.output)
        n_samples = int(trial.time.size)
        facts = {"output": self.output, "n_samples": n_samples}
        return command.Outcome(facts=facts, text=f"{self.output}: {n_samples} samples")

    def _write_bag(self) -> command.Outcome:
        """Write a folder for rosbag2; a recording of an operation keeps all of its messages."""
        if self.columns is None and self.file.endswith(".mcap"):
            logs.write_bag(self.file, self.output)
        else:
            logs.write_bag(lc.load_trial(self.file, self.columns), self.output)
        text = f"{self.output}: a folder for rosbag2"
        return command.Outcome(facts={"output": self.output}, text=text)


def _mark_failed(name: str, trial: lc.Trial) -> str:
    """Return the name of a trial, marked if it failed."""
    if trial.succeeded:
        return name
    return f"{name} FAILED"


def _facts_of_figure(row: ComparedFigure) -> dict[str, object]:
    return {
        "unit": row.figure.unit,
        "values": row.values,
        "differences": row.differences,
        "differences_percent": row.differences_percent,
    }


def _table_of_comparison(names: Sequence[str], rows: Sequence[ComparedFigure]) -> str:
    """Return a table with one figure per line and, for each trial, its value and its difference from the first."""
    reference, *compared = names
    heads = ["", reference, ""]
    for name in compared:
        heads += [name, "difference"]
    lines = [heads, *map(_line_of_comparison, rows)]
    return tables.align_columns(lines, right=(1, *range(3, len(heads))))


def _line_of_comparison(row: ComparedFigure) -> list[str]:
    first, *compared = [tables.format_figure(value, row.figure.unit) for value in row.values]
    line = [row.figure.title, first.number, first.unit]
    for i, figure in enumerate(compared, start=1):
        line += [figure.number, _format_difference(row, i)]
    return line


def _format_difference(row: ComparedFigure, i: int) -> str:
    """Return the difference of trial `i` in percent, or in the figure's unit where a percentage is meaningless."""
    share, difference = row.differences_percent[i], row.differences[i]
    if share is not None or difference is None:
        return tables.format_percent(share)
    number, unit = tables.format_figure(difference, row.figure.unit)
    if number != "0" and not number.startswith("-"):
        number = f"+{number}"
    return f"{number} {unit}".rstrip()


def _load(file: str, columns: str | None) -> lc.Trial:
    """Return the trial in a laticauda file, or in a log to which the column map applies."""
    try:
        return lc.load_trial(file)
    except TrialFileError:
        if columns is None:
            raise
        return lc.load_trial(file, columns)
