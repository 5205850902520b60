"""Trials as Parquet files, the door of the package `pyarrow`: one column per number, units in the columns' metadata."""

# pyarrow has no types.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportMissingTypeStubs=false

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from laticauda.errors import MissingExtra, TrialFileError
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
        pyarrow = _door()
        columns = list(flat.columns(dataset))
        fields = [pyarrow.field(one.name, pyarrow.float64(), metadata={"unit": one.unit}) for one in columns]
        schema = pyarrow.schema(fields, metadata={KEY: flat.text(dataset).encode()})
        table = pyarrow.Table.from_arrays([pyarrow.array(one.values) for one in columns], schema=schema)
        pyarrow.parquet.write_table(table, path)

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """The trial in a Parquet file; see `Format.read`."""
        table = _table(path)
        text = (table.schema.metadata or {}).get(KEY)
        if text is None:
            message = "it is a table, but no trial of laticauda; say what its columns are"
            raise TrialFileError(f"Cannot load {path}: {message}.")
        return flat.dataset_of(_numbers(table), text.decode())


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
    types = _door().types
    found: dict[str, Samples] = {}
    for name, column in zip(table.column_names, table.columns, strict=True):
        kind = column.type
        if types.is_floating(kind) or types.is_integer(kind) or types.is_boolean(kind):
            found[name] = np.asarray(column.to_numpy(), dtype=np.float64)
    return found


def _table(path: Path) -> Any:
    pyarrow = _door()
    content = path.read_bytes()
    try:
        return pyarrow.parquet.read_table(pyarrow.BufferReader(content))
    except (pyarrow.ArrowException, OSError) as error:
        raise TrialFileError(f"Cannot load {path}: it is no Parquet file, or it is damaged.") from error


def _door() -> Any:
    try:
        import_module("pyarrow.parquet")
        return import_module("pyarrow")
    except ImportError as error:
        raise MissingExtra("Reading and writing Parquet", "pyarrow", "logs") from error
