"""Trials as Parquet files, by the package `pyarrow`: one column per number, units in the columns' metadata."""

# pyarrow has no types.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportMissingTypeStubs=false

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from laticauda.errors import TrialFileError
from laticauda.extras import optional_import
from laticauda.logs import flat
from laticauda.trial import Format
from laticauda.trial.arrays import Samples

if TYPE_CHECKING:
    import xarray

KEY = b"laticauda_trial"


class ParquetFile(Format):
    """Pandas, Polars and DuckDB read its columns, `load_trial` all of it."""

    called: ClassVar[str] = "parquet"
    title: ClassVar[str] = "Parquet"

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write a trial as a Parquet file; see `Format.write`."""
        pyarrow = _library()
        columns = list(flat.columns(dataset))
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
        return flat.dataset_of(_numbers(table), json.loads(text))


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
    content = path.read_bytes()
    try:
        return pyarrow.parquet.read_table(pyarrow.BufferReader(content))
    except (pyarrow.ArrowException, OSError) as error:
        raise TrialFileError(f"Cannot load {path}: it is no Parquet file, or it is damaged.") from error


def _library() -> Any:
    optional_import("Reading and writing Parquet", "pyarrow", "logs", "pyarrow.parquet")
    return optional_import("Reading and writing Parquet", "pyarrow", "logs")
