"""Trials as Parquet files, the door of the package `pyarrow`: one column per number, units in the columns' metadata."""

# pyarrow has no types.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportMissingTypeStubs=false

from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.errors import MissingExtra, TrialFileError
from laticauda.trial import flat
from laticauda.trial.contents import Samples
from laticauda.trial.trial import Trial

KEY = b"laticauda_trial"


def write_parquet(trial: Trial, path: Path) -> None:
    """Write a trial as a Parquet file; pandas, Polars and DuckDB read its columns, `load_trial` all of it.

    Args:
        trial: Any trial.
        path: The file.

    Raises:
        MissingExtra: If pyarrow is not installed.
    """
    pyarrow = _door()
    columns = flat.columns(trial)
    fields = [pyarrow.field(one.name, pyarrow.float64(), metadata={"unit": one.unit}) for one in columns]
    schema = pyarrow.schema(fields, metadata={KEY: flat.text(trial).encode()})
    table = pyarrow.Table.from_arrays([pyarrow.array(one.values) for one in columns], schema=schema)
    pyarrow.parquet.write_table(table, path)


def read_parquet(path: Path) -> Trial:
    """The trial in a Parquet file, equal to what was written.

    Args:
        path: The file.

    Raises:
        MissingExtra: If pyarrow is not installed.
        TrialFileError: If it is no Parquet file, or no trial.
        KeyError: If a column is missing.
        OSError: If it cannot be read.
    """
    table = _table(path)
    text = (table.schema.metadata or {}).get(KEY)
    if text is None:
        raise TrialFileError(f"Cannot load {path}: it is a table, but no trial of laticauda; say what its columns are.")
    return flat.trial_of(_numbers(table), text.decode())


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
