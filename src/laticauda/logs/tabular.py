"""Trials as flat tables, one column per number: CSV for a spreadsheet, Parquet by the package `pyarrow`."""

# pyarrow has no types.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportMissingTypeStubs=false

import csv
import io
import itertools
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from jaxtyping import Float

from laticauda import files, trial
from laticauda.errors import TrialFileError
from laticauda.extras import optional_import
from laticauda.trial.arrays import Samples
from laticauda.trial.dataset import AXES, assembled, variable

if TYPE_CHECKING:
    import xarray

Column = tuple[str, str, Samples]
KEY = b"laticauda_trial"


class CsvFile(trial.Format):
    """Columns are called as `joint_angle_0 [rad]`; 0 is the tail."""

    called: ClassVar[str] = "csv"
    title: ClassVar[str] = "CSV, time series only"
    is_whole: ClassVar[bool] = False

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write the time series; see `Format.write`."""
        path.write_bytes(csv_text(list(flat_columns(dataset))).encode())


class ParquetFile(trial.Format):
    """Pandas, Polars and DuckDB read its columns, `load_trial` all of it."""

    called: ClassVar[str] = "parquet"
    title: ClassVar[str] = "Parquet"

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write a trial as a Parquet file; see `Format.write`."""
        pyarrow = _library()
        columns = list(flat_columns(dataset))
        fields = [pyarrow.field(name, pyarrow.float64(), metadata={"unit": unit}) for name, unit, _ in columns]
        schema = pyarrow.schema(fields, metadata={KEY: json.dumps(dataset.attrs).encode()})
        table = pyarrow.Table.from_arrays([pyarrow.array(values) for _, _, values in columns], schema=schema)
        pyarrow.parquet.write_table(table, path)

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """The trial in a Parquet file; see `Format.read`."""
        table = _table(path)
        text = (table.schema.metadata or {}).get(KEY)
        if text is None:
            message = "it is a table, but no trial of laticauda; say what its columns are"
            raise TrialFileError(f"Cannot load {path}: {message}.")
        found = _numbers(table)
        return assembled(lambda name: series(found, name), json.loads(text))


def parquet_columns(path: Path) -> dict[str, Samples]:
    """The columns of numbers in a Parquet file of any writer; what is missing is nan.

    Args:
        path: The file.

    Raises:
        MissingExtra: If pyarrow is not installed.
        TrialFileError: If it is no Parquet file.
        OSError: If it cannot be read.
    """
    return _numbers(_table(path))


def _numbers(table: Any) -> dict[str, Samples]:
    types = _library().types
    found: dict[str, Samples] = {}
    for name, column in zip(table.column_names, table.columns, strict=True):
        kind = column.type
        if types.is_floating(kind) or types.is_integer(kind) or types.is_boolean(kind):
            found[name] = np.asarray(column.to_numpy(), dtype=np.float64)
    return found


def _table(path: Path) -> Any:
    pyarrow = _library()
    content = files.read_bytes(path)
    try:
        return pyarrow.parquet.read_table(pyarrow.BufferReader(content))
    except (pyarrow.ArrowException, OSError) as error:
        raise TrialFileError(f"Cannot load {path}: it is no Parquet file, or it is damaged.") from error


def _library() -> Any:
    optional_import("Reading and writing Parquet", "pyarrow", "logs", "pyarrow.parquet")
    return optional_import("Reading and writing Parquet", "pyarrow", "logs")


def csv_text(columns: Sequence[Column]) -> str:
    """A CSV file: names with their units in the first line, numbers in all others.

    Args:
        columns: Name, unit and values of each.
    """
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow([f"{name} [{unit}]" for name, unit, _ in columns])
    writer.writerows(np.stack([values for _, _, values in columns], axis=1).tolist())
    return text.getvalue()


def flat_columns(dataset: "xarray.Dataset") -> Iterator[Column]:
    """All time series of a trial as single columns, time first: name, as `joint_angle_0` of the tail, unit, values.

    Args:
        dataset: The trial.
    """
    for name, series in dataset.variables.items():
        if series.dims[:1] != ("time",):
            continue
        for index in np.ndindex(series.shape[1:]):
            ends = (f"_{AXES[i] if of == 'axis' else i}" for of, i in zip(series.dims[1:], index, strict=True))
            yield f"{name}{''.join(ends)}", series.attrs["units"], series.values[(slice(None), *index)]


def series(table: Mapping[str, Samples], name: str) -> Float[np.ndarray, "n_samples ..."]:
    """One time series from its columns.

    Args:
        table: Columns by name.
        name: Of the time series.

    Raises:
        KeyError: If it has no column.
    """
    return _stacked(table, name, variable(name).dimensions[1:])


def _stacked(table: Mapping[str, Samples], name: str, dimensions: tuple[str, ...]) -> Float[np.ndarray, "..."]:
    if not dimensions:
        return table[name]
    found: list[Float[np.ndarray, ...]] = []
    for end in AXES if dimensions[0] == "axis" else itertools.count():
        try:
            found.append(_stacked(table, f"{name}_{end}", dimensions[1:]))
        except KeyError:
            break
    if not found and dimensions != ("joint",):  # a robot of one link has no joint
        raise KeyError(name)
    return np.stack(found, axis=1) if found else np.empty((len(table["time"]), 0))
