"""`laticauda trial show | compare | convert`: stored trials."""

import json
from typing import TYPE_CHECKING

from laticauda.cli.flags import File, Input, Inputs, Output
from laticauda.cli.outputs import check_output
from laticauda.quantities import option, value

if TYPE_CHECKING:
    from laticauda.trial import Trial

COLUMNS = "What the columns of a log are, a TOML file: for CSV, TSV, C3D, Parquet and .mat of other programs"
TRIAL = "The trial, as `laticauda swim --save` or `trial convert` wrote it, or a log (with --columns)"


@value
class Show:
    """Print the figures of a stored trial.

    For example: laticauda trial show run.nc
    """

    file: Input = option(TRIAL)
    columns: File = option(COLUMNS, default=None)
    json: bool = option("Print one JSON object in SI units", default=False)

    def __call__(self) -> int:
        """Print, and return the exit status."""
        from laticauda.cli.report import as_json, as_text
        from laticauda.logs import load_trial

        trial = load_trial(self.file, self.columns)
        if self.json:
            print(as_json(trial))
        else:
            print(f"made     {trial.created} with laticauda {trial.version}")
            print(as_text(trial))
        return 0


@value
class Compare:
    """Print the figures of stored trials side by side, with their differences to the first.

    For example: laticauda trial compare bare.nc fin.nc
    """

    files: Inputs = option(
        "Two trials or more; the one to compare with first. Logs of other programs need --columns", default=()
    )
    columns: File = option(COLUMNS, default=None)
    json: bool = option("Print one JSON object in SI units", default=False)

    def __call__(self) -> int:
        """Print, and return the exit status."""
        from laticauda.cli.report import comparison_as_json, comparison_as_text
        from laticauda.trial import compare

        rows = compare([_either(file, self.columns) for file in self.files])
        write = comparison_as_json if self.json else comparison_as_text
        print(write(self.files, rows))
        return 0


@value
class Convert:
    """Write a stored trial in another format: MCAP for Foxglove and ROS 2, Parquet, .mat, netCDF, or a CSV table.

    For example: laticauda trial convert run.nc run.mcap
    """

    file: Input = option(TRIAL)
    output: Output = option(
        "The file to write; its ending says the format, .nc, .mcap, .parquet, .mat or .csv. An older one is replaced"
    )
    columns: File = option(COLUMNS, default=None)
    json: bool = option("Print one JSON object", default=False)

    def __call__(self) -> int:
        """Write, and return the exit status."""
        from laticauda.logs import load_trial
        from laticauda.trial import Format

        check_output("output", self.output, Format.endings())
        trial = load_trial(self.file, self.columns)
        trial.save(self.output)
        done = {"output": self.output, "n_samples": int(trial.time.size)}
        print(json.dumps(done) if self.json else f"{done['output']}: {done['n_samples']} samples")
        return 0


def _either(file: str, columns: str | None) -> "Trial":
    """The trial in a file of ours, or in a log that the column map is for."""
    from laticauda.errors import TrialFileError
    from laticauda.logs import load_trial

    if columns is None:
        return load_trial(file)
    try:
        return load_trial(file)
    except TrialFileError:
        return load_trial(file, columns)
