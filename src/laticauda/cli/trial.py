"""`laticauda trial show | compare | convert`: stored trials."""

import json
from dataclasses import dataclass
from typing import Annotated

import tyro

from laticauda.cli.flags import Switch
from laticauda.cli.outputs import check_output


def _positional(metavar: str, hint: str = "(required)") -> object:
    return tyro.conf.arg(metavar=metavar, help_behavior_hint=hint)


@dataclass(frozen=True, kw_only=True)
class Show:
    """Print the figures of a stored trial.

    For example: laticauda trial show run.nc
    """

    file: Annotated[str, tyro.conf.Positional, _positional("FILE")]
    """The trial, as `laticauda swim --save` wrote it."""
    json: Switch = False
    """Print one JSON object in SI units."""

    def __call__(self) -> int:
        """Print, and return the exit status."""
        from laticauda.cli.report import as_json, as_text
        from laticauda.trial import load_trial

        trial = load_trial(self.file)
        if self.json:
            print(as_json(trial))
        else:
            print(f"made     {trial.created} with laticauda {trial.version}")
            print(as_text(trial))
        return 0


@dataclass(frozen=True, kw_only=True)
class Compare:
    """Print the figures of stored trials side by side, with their differences to the first.

    For example: laticauda trial compare bare.nc fin.nc
    """

    files: Annotated[tuple[str, ...], tyro.conf.Positional, _positional("FILES ...", "(two or more)")]
    """The trials; the one to compare with first."""
    json: Switch = False
    """Print one JSON object in SI units."""

    def __call__(self) -> int:
        """Print, and return the exit status."""
        from laticauda.cli.report import comparison_as_json, comparison_as_text
        from laticauda.trial import compare, load_trial

        rows = compare([load_trial(file) for file in self.files])
        write = comparison_as_json if self.json else comparison_as_text
        print(write(self.files, rows))
        return 0


@dataclass(frozen=True, kw_only=True)
class Convert:
    """Write the time series of a stored trial to a CSV file for a spreadsheet, one row per sample.

    For example: laticauda trial convert run.nc run.csv
    """

    file: Annotated[str, tyro.conf.Positional, _positional("FILE")]
    """The trial, as `laticauda swim --save` wrote it."""
    output: Annotated[str, tyro.conf.Positional, _positional("OUTPUT")]
    """The file to write (.csv); an older one is replaced."""
    json: Switch = False
    """Print one JSON object."""

    def __call__(self) -> int:
        """Write, and return the exit status."""
        from laticauda.trial import load_trial

        check_output("output", self.output, (".csv",))
        trial = load_trial(self.file)
        trial.to_csv(self.output)
        done = {"output": self.output, "n_samples": int(trial.time.size)}
        print(json.dumps(done) if self.json else f"{done['output']}: {done['n_samples']} samples")
        return 0
