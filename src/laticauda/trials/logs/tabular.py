"""Trials as flat tables, with one column per number: CSV for spreadsheets, and Parquet.

Parquet needs the package `pyarrow`.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportMissingTypeStubs=false

import itertools
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.trials import Format
from laticauda.trials.arrays import Samples
from laticauda.trials.dataset import AXES, assembled, describe_series
from laticauda.values import DIRECTIONS, files, optional_import

if TYPE_CHECKING:
    import xarray

NAMED_PLACES = {"axis": AXES, "direction": DIRECTIONS}
"""Dimensions whose places have names in those of columns."""
KEY = b"laticauda_trial"
"""Key of a Parquet file under which everything in a trial that is no time series is stored, as JSON."""


class TableColumn(NamedTuple):
    """One column of a flat table."""

    name: str
    """Such as `joint_angle_0`; 0 is the tail."""
    unit: str
    values: Samples


class CsvFile(Format):
    """Columns are named like `joint_angle_0 [rad]`; 0 is the tail."""

    called: ClassVar[str] = "csv"
    title: ClassVar[str] = "CSV, time series only"
    is_whole: ClassVar[bool] = False

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write the time series; see `Format.write`."""
        text = format_csv(list(flatten_columns(dataset)))
        path.write_bytes(text.encode())


class ParquetFile(Format):
    """Pandas, Polars and DuckDB read its columns; `load_trial` reads everything."""

    called: ClassVar[str] = "parquet"
    title: ClassVar[str] = "Parquet"

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write a trial as a Parquet file; see `Format.write`."""
        pyarrow = _import_pyarrow()
        columns = list(flatten_columns(dataset))
        fields = [
            pyarrow.field(column.name, pyarrow.float64(), metadata={"unit": column.unit})
            for column in columns
        ]
        arrays = [pyarrow.array(column.values) for column in columns]
        attributes = json.dumps(dataset.attrs).encode()
        schema = pyarrow.schema(fields, metadata={KEY: attributes})
        table = pyarrow.Table.from_arrays(arrays, schema=schema)
        pyarrow.parquet.write_table(table, path)

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """Read the trial in a Parquet file; see `Format.read`."""
        table = _read_parquet(path)
        metadata = table.schema.metadata or {}
        attributes = metadata.get(KEY)
        if attributes is None:
            raise ValueError("it is a table, but not a trial of laticauda; give a column map.")
        columns = _numeric_columns(table)
        return assembled(lambda name: assemble_series(columns, name), json.loads(attributes))


def read_parquet_columns(path: Path) -> dict[str, Samples]:
    """Return the numeric columns of a Parquet file of any writer; missing values are nan.

    Args:
        path: The file.

    Raises:
        MissingExtra: If pyarrow is not installed.
        ValueError: If the file is not a Parquet file.
        OSError: If the file cannot be read.
    """
    table = _read_parquet(path)
    names = list(table.column_names)
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"it must name every column once, got `{name}` twice.")
    return _numeric_columns(table)


def _numeric_columns(table: Any) -> dict[str, Samples]:
    types = _import_pyarrow().types
    columns: dict[str, Samples] = {}
    for name, column in zip(table.column_names, table.columns, strict=True):
        is_number = types.is_floating(column.type) or types.is_integer(column.type)
        if is_number or types.is_boolean(column.type):
            columns[name] = np.asarray(column.to_numpy(), dtype=np.float64)
    return columns


def _read_parquet(path: Path) -> Any:
    pyarrow = _import_pyarrow()
    content = files.read_bytes(path)
    try:
        return pyarrow.parquet.read_table(pyarrow.BufferReader(content))
    except (pyarrow.ArrowException, OSError) as error:
        raise ValueError("it is not a Parquet file, or it is damaged.") from error


def _import_pyarrow() -> Any:
    optional_import("Reading and writing Parquet", "pyarrow", "logs", "pyarrow.parquet")
    return optional_import("Reading and writing Parquet", "pyarrow", "logs")


def format_csv(columns: Sequence[TableColumn]) -> str:
    """Return the text of a CSV file: names with units in the first line, numbers in all others.

    Args:
        columns: Columns, all of the same length.
    """
    header = [f"{column.name} [{column.unit}]" for column in columns]
    numbers = np.stack([column.values for column in columns], axis=1)
    return files.csv_text([header, *numbers.tolist()])


def flatten_columns(dataset: "xarray.Dataset") -> Iterator[TableColumn]:
    """Yield all time series of a trial as single columns, time first.

    Args:
        dataset: The trial.
    """
    for name, series in dataset.variables.items():
        if series.dims[:1] != ("time",):
            continue
        for index in np.ndindex(series.shape[1:]):
            yield TableColumn(
                name=f"{name}{_suffix_of(series.dims[1:], index)}",
                unit=series.attrs["units"],
                values=series.values[(slice(None), *index)],
            )


def _suffix_of(dimensions: Sequence[object], index: Sequence[int]) -> str:
    """Return what the name of a column ends with: `_x` for an axis, `_0` for the tail."""
    suffix = ""
    for dimension, i in zip(dimensions, index, strict=True):
        if dimension in NAMED_PLACES:
            suffix += f"_{NAMED_PLACES[str(dimension)][i]}"
        else:
            suffix += f"_{i}"
    return suffix


def assemble_series(table: Mapping[str, Samples], name: str) -> Float[np.ndarray, "n_samples ..."]:
    """Assemble one time series from its columns.

    Args:
        table: Columns by name.
        name: Name of the time series.

    Raises:
        KeyError: If the series has no column.
    """
    return _stack_columns(table, name, describe_series(name).dimensions[1:])


def _stack_columns(
    table: Mapping[str, Samples], name: str, dimensions: tuple[str, ...]
) -> Float[np.ndarray, "..."]:
    """Stack the columns `name` and a suffix for every dimension after time, outermost first."""
    if not dimensions:
        return table[name]
    suffixes: Iterable[object] = NAMED_PLACES.get(dimensions[0], itertools.count())
    parts: list[Float[np.ndarray, ...]] = []
    for suffix in suffixes:
        try:
            part = _stack_columns(table, f"{name}_{suffix}", dimensions[1:])
        except KeyError:  # there are no more columns
            break
        parts.append(part)
    if parts:
        return np.stack(parts, axis=1)
    if dimensions == ("joint",):  # a robot with one link has no joints
        return np.empty((len(table["time"]), 0))
    if dimensions == ("joint", "direction"):
        return np.empty((len(table["time"]), 0, len(DIRECTIONS)))
    raise KeyError(name)
