"""Trial files: the ending of a file's name says its format.

Every format but CSV keeps the whole trial, so that it loads back equal. A file appears whole or not at all: it is
written beside its place under another name and then moved there, over any older file of that name.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from laticauda.errors import TrialFileError
from laticauda.trial import flat
from laticauda.trial.layout import attributes, coordinates, variables
from laticauda.trial.trial import Trial
from laticauda.trial.writing import write_whole

if TYPE_CHECKING:
    import xarray

    from laticauda.trial.column_maps import ColumnMap


@dataclass(frozen=True, kw_only=True)
class Format:
    """One format of files."""

    ending: str
    """Of the file's name."""
    title: str
    """What it is, in words."""
    module: str
    """The module that reads and writes it; loaded when needed, for the library behind it."""
    write: str
    """The function that writes a trial to a path."""
    read: str | None
    """The function that reads it again; None where not all of a trial is kept."""


FORMATS = (
    Format(ending=".nc", title="netCDF", module="netcdf", write="write_netcdf", read="read_netcdf"),
    Format(ending=".mcap", title="MCAP, ROS 2", module="mcap_trials", write="write_mcap", read="read_mcap"),
    Format(ending=".parquet", title="Parquet", module="parquet", write="write_parquet", read="read_parquet"),
    Format(ending=".mat", title="MATLAB, GNU Octave", module="matlab", write="write_mat", read="read_mat"),
    Format(ending=".csv", title="CSV, time series only", module="files", write="store_csv", read=None),
)
"""What `save_trial` writes and `load_trial` reads."""


def save_trial(trial: Trial, path: str | Path) -> None:
    """Write a trial to a file, from which `load_trial` makes an equal one.

    The ending says the format, see `FORMATS`; any other one means netCDF. A CSV file holds the time series only. An
    older file of that name is replaced, but not before the new one is complete.

    Args:
        trial: Any trial, a failed one too.
        path: The file.

    Raises:
        TrialFileError: If the file cannot be written; the message has its name and the reason.
        MissingExtra: If the format needs a package that is not installed.
    """
    path = Path(path)
    form = _format(path)
    write: Callable[[Trial, Path], None] = getattr(_module(form), form.write)
    write_whole(path, lambda beside: write(trial, beside))


def load_trial(path: str | Path, columns: str | Path | ColumnMap | None = None) -> Trial:
    """Read a trial from a file that `save_trial` wrote, or make one of somebody's log.

    Args:
        path: The file.
        columns: What the columns of a log are: a column map or its TOML file, see `measuring.load_measured`; None for
            a file that laticauda wrote.

    Returns:
        A trial that `equals` the saved one, bit for bit.

    Raises:
        TrialFileError: If there is no such file, or it is no whole trial; the message has its name and the reason.
        MissingExtra: If the format needs a package that is not installed.
    """
    path = Path(path)
    if columns is not None:
        from laticauda.trial.measuring import load_measured

        return load_measured(path, columns)
    form = _format(path)
    try:
        if form.read is None:
            raise TrialFileError(
                f"Cannot load {path}: a {form.ending} file does not say what swam; give a column map "
                "(`columns`, on the command line --columns)."
            )
        read: Callable[[Path], Trial] = getattr(_module(form), form.read)
        return read(path)
    except TrialFileError:
        raise
    except OSError as error:
        raise TrialFileError(f"Cannot read {path}: {(error.strerror or str(error)).lower()}.") from error
    except KeyError as error:
        raise TrialFileError(f"Cannot load {path}: it has no `{error.args[0]}`.") from error
    except (ValueError, TypeError) as error:  # a text or an array that is not as it was written
        raise TrialFileError(f"Cannot load {path}: {error}") from error


def to_dataset(trial: Trial) -> xarray.Dataset:
    """A trial as an xarray Dataset: dimensions, units and names as in its file, without the plant's state.

    Args:
        trial: Any trial.
    """
    import xarray

    series = {
        variable.name: (variable.dimensions, values.copy(), {"units": variable.units, "long_name": variable.long_name})
        for variable, values in variables(trial)
    }
    return xarray.Dataset(series, coords=coordinates(trial), attrs=attributes(trial))


def write_csv(trial: Trial, path: str | Path) -> None:
    """Write the time series of a trial to a CSV file: one row per sample, one column per number.

    The first row names the columns with their units, as in `joint_angle_0 [rad]`; 0 is the tail.

    Args:
        trial: Any trial.
        path: The file; an older one of that name is replaced.

    Raises:
        TrialFileError: If the file cannot be written; the message has its name and the reason.
    """
    write_whole(Path(path), lambda beside: store_csv(trial, beside))


def store_csv(trial: Trial, path: Path) -> None:
    """Write the CSV file of `write_csv`, over what is there.

    Args:
        trial: Any trial.
        path: The file.
    """
    columns = flat.columns(trial)
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow([f"{column.name} [{column.unit}]" for column in columns])
    writer.writerows(np.stack([column.values for column in columns], axis=1).tolist())
    path.write_bytes(text.getvalue().encode())


def _format(path: Path) -> Format:
    ending = path.suffix.lower()
    return next((form for form in FORMATS if form.ending == ending), FORMATS[0])


def _module(form: Format) -> object:
    return import_module(f"laticauda.trial.{form.module}")
