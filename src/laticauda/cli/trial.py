"""`laticauda trial show | compare | convert`: stored trials."""

from collections.abc import Sequence

import laticauda as lc
from laticauda.cli import command, flags, report, tables, view
from laticauda.errors import TrialFileError
from laticauda.quantities import option, value
from laticauda.trial import ComparedFigure, Format

TRIAL = "The trial, as `laticauda swim --save` or `trial convert` wrote it, or a log (with --columns)"


@value
class OfTrials(command.Command):
    """A command about stored trials."""

    columns: flags.File = option("A TOML file of what a foreign log's columns are (CSV, C3D, .mat, ...)", default=None)


@value
class Show(OfTrials, view.Filming):
    """Print the figures of a stored trial, and film it.

    For example: laticauda trial show run.nc
    """

    file: flags.Input = option(TRIAL)

    def run(self) -> command.Outcome:
        """Read."""
        trial = lc.load_trial(self.file, self.columns)
        self.write_film(trial)
        made = f"made     {trial.created} with laticauda {trial.version}"
        return command.Outcome(facts=report.facts_of(trial), text=f"{made}\n{report.as_text(trial)}")


@value
class Compare(OfTrials):
    """Print the figures of stored trials side by side, with their differences to the first.

    For example: laticauda trial compare bare.nc fin.nc
    """

    files: flags.Inputs = option("Two trials or more, the reference first. Others' logs need --columns", default=())

    def run(self) -> command.Outcome:
        """Read and compare."""
        rows = lc.compare([_either(file, self.columns) for file in self.files])
        figures = {
            row.figure.name: {
                "unit": row.figure.unit,
                "values": row.values,
                "differences": row.differences,
                "differences_percent": row.differences_percent,
            }
            for row in rows
        }
        return command.Outcome(facts={"trials": self.files, "figures": figures}, text=_compared(self.files, rows))


@value
class Convert(OfTrials):
    """Write a stored trial in another format: MCAP for Foxglove and ROS 2, Parquet, .mat, netCDF, or a CSV table.

    For example: laticauda trial convert run.nc run.mcap
    """

    file: flags.Input = option(TRIAL)
    output: flags.Output = option("The file to write, or replace: .nc, .mcap, .parquet, .mat or .csv")

    def run(self) -> command.Outcome:
        """Read and write."""
        command.check_output("output", self.output, Format.endings())
        trial = lc.load_trial(self.file, self.columns)
        trial.save(self.output)
        n_samples = int(trial.time.size)
        facts = {"output": self.output, "n_samples": n_samples}
        return command.Outcome(facts=facts, text=f"{self.output}: {n_samples} samples")


def _compared(names: Sequence[str], rows: Sequence[ComparedFigure]) -> str:
    """A table with a figure a line and, per trial, its value and its difference to the first."""
    first, *others = names
    lines: list[list[str]] = [["", first, "", *(cell for name in others for cell in (name, "difference"))]]
    for row in rows:
        cells = [tables.read_in(value, row.figure.unit) for value in row.values]
        line = [row.figure.title, cells[0][0], cells[0][1]]
        for i, (shown, _) in enumerate(cells[1:], start=1):
            line += [shown, _difference(row, i)]
        lines.append(line)
    return tables.aligned(lines, right=(1, *range(3, len(lines[0]))))


def _difference(row: ComparedFigure, i: int) -> str:
    """The difference of trial `i` in percent, or in the figure's unit where percent would say nothing."""
    share, difference = row.differences_percent[i], row.differences[i]
    if share is not None or difference is None:
        return tables.percent(share)
    shown, unit = tables.read_in(difference, row.figure.unit)
    return f"{'' if shown.startswith('-') or shown == '0' else '+'}{shown} {unit}".rstrip()


def _either(file: str, columns: str | None) -> lc.Trial:
    """The trial in a file of ours, or in a log that the column map is for."""
    try:
        return lc.load_trial(file)
    except TrialFileError:
        if columns is None:
            raise
        return lc.load_trial(file, columns)
