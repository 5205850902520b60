"""Trials in files that other programs read: flat tables with one column per number, and arrays.

Tables are CSV for spreadsheets, and Parquet, which needs the package `pyarrow`. A netCDF file opens
in any netCDF tool and with `xarray.open_dataset`. A checksum covers the whole file, so that a
damaged file is rejected rather than half read; a file edited by another program has lost its
checksum, and is accepted as it is.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportMissingTypeStubs=false

import hashlib
import io
import itertools
import json
import struct
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from jaxtyping import Float

from laticauda import trials as trial
from laticauda.trials.arrays import Samples
from laticauda.trials.dataset import AXES, MARK, assembled, describe_series, read_epoch
from laticauda.values import files, optional_import

if TYPE_CHECKING:
    import xarray


Column = tuple[str, str, Samples]
KEY = b"laticauda_trial"


class CsvFile(trial.Format):
    """Columns are named like `joint_angle_0 [rad]`; 0 is the tail."""

    called: ClassVar[str] = "csv"
    title: ClassVar[str] = "CSV, time series only"
    is_whole: ClassVar[bool] = False

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write the time series; see `Format.write`."""
        path.write_bytes(csv_text(list(flat_columns(dataset))).encode())


class ParquetFile(trial.Format):
    """Pandas, Polars and DuckDB read its columns; `load_trial` reads everything."""

    called: ClassVar[str] = "parquet"
    title: ClassVar[str] = "Parquet"

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write a trial as a Parquet file; see `Format.write`."""
        pyarrow = _pyarrow()
        columns = list(flat_columns(dataset))
        fields = [
            pyarrow.field(name, pyarrow.float64(), metadata={"unit": unit})
            for name, unit, _ in columns
        ]
        schema = pyarrow.schema(fields, metadata={KEY: json.dumps(dataset.attrs).encode()})
        table = pyarrow.Table.from_arrays(
            [pyarrow.array(values) for _, _, values in columns], schema=schema
        )
        pyarrow.parquet.write_table(table, path)

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """Read the trial in a Parquet file; see `Format.read`."""
        table = _table(path)
        text = (table.schema.metadata or {}).get(KEY)
        if text is None:
            raise ValueError("it is a table, but not a trial of laticauda; give a column map.")
        found = _numbers(table)
        return assembled(lambda name: series(found, name), json.loads(text))


def parquet_columns(path: Path) -> dict[str, Samples]:
    """Return the numeric columns of a Parquet file of any writer; missing values are nan.

    Args:
        path: The file.

    Raises:
        MissingExtra: If pyarrow is not installed.
        ValueError: If the file is not a Parquet file.
        OSError: If the file cannot be read.
    """
    return _numbers(_table(path))


def _numbers(table: Any) -> dict[str, Samples]:
    types = _pyarrow().types
    found: dict[str, Samples] = {}
    for name, column in zip(table.column_names, table.columns, strict=True):
        kind = column.type
        if types.is_floating(kind) or types.is_integer(kind) or types.is_boolean(kind):
            found[name] = np.asarray(column.to_numpy(), dtype=np.float64)
    return found


def _table(path: Path) -> Any:
    pyarrow = _pyarrow()
    content = files.read_bytes(path)
    try:
        return pyarrow.parquet.read_table(pyarrow.BufferReader(content))
    except (pyarrow.ArrowException, OSError) as error:
        raise ValueError("it is not a Parquet file, or it is damaged.") from error


def _pyarrow() -> Any:
    optional_import("Reading and writing Parquet", "pyarrow", "logs", "pyarrow.parquet")
    return optional_import("Reading and writing Parquet", "pyarrow", "logs")


def csv_text(columns: Sequence[Column]) -> str:
    """Return the text of a CSV file: names with units in the first line, numbers in all others.

    Args:
        columns: Name, unit and values of each column.
    """
    heads = [f"{name} [{unit}]" for name, unit, _ in columns]
    return files.csv_text([heads, *np.stack([values for _, _, values in columns], axis=1).tolist()])


def flat_columns(dataset: "xarray.Dataset") -> Iterator[Column]:
    """Yield all time series of a trial as single columns, time first: name (tail: `joint_angle_0`), unit and values.

    Args:
        dataset: The trial.
    """
    for name, series in dataset.variables.items():
        if series.dims[:1] != ("time",):
            continue
        for index in np.ndindex(series.shape[1:]):
            ends = (
                f"_{AXES[i] if of == 'axis' else i}"
                for of, i in zip(series.dims[1:], index, strict=True)
            )
            yield (
                f"{name}{''.join(ends)}",
                series.attrs["units"],
                series.values[(slice(None), *index)],
            )


def series(table: Mapping[str, Samples], name: str) -> Float[np.ndarray, "n_samples ..."]:
    """Assemble one time series from its columns.

    Args:
        table: Columns by name.
        name: Name of the time series.

    Raises:
        KeyError: If the series has no column.
    """
    return _stacked(table, name, describe_series(name).dimensions[1:])


def _stacked(
    table: Mapping[str, Samples], name: str, dimensions: tuple[str, ...]
) -> Float[np.ndarray, "..."]:
    if not dimensions:
        return table[name]
    found: list[Float[np.ndarray, ...]] = []
    for end in AXES if dimensions[0] == "axis" else itertools.count():
        try:
            found.append(_stacked(table, f"{name}_{end}", dimensions[1:]))
        except KeyError:
            break
    if not found and dimensions != ("joint",):  # a robot with one link has no joints
        raise KeyError(name)
    return np.stack(found, axis=1) if found else np.empty((len(table["time"]), 0))


# ---- arrays: netCDF, and .mat for MATLAB and GNU Octave (with `scipy.io`) ------------------------

# This mark and the SHA-256 of everything before it follow the HDF5 data, where netCDF does not
# look. The check comes first, because HDF5 itself may hang on a single wrong bit. Programs that
# edit a file in place remove both.
SEAL = b"\nlaticauda sha256 "
SEAL_LENGTH = len(SEAL) + 64


class NetCdfFile(trial.Format):
    """The Dataset, unchanged."""

    called: ClassVar[str] = "nc"
    title: ClassVar[str] = "netCDF"

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write the file of a trial with its checksum; see `Format.write`."""
        no_fill = {
            name: {"_FillValue": None}
            for name, one in dataset.variables.items()
            if one.dtype == np.float64
        }
        # Under the CF conventions no text variable may share its name with a dimension, and time is
        # a date.
        dataset = dataset.rename_dims(axis="axes")
        zero = np.datetime64(read_epoch(dataset.attrs) // 1000, "us")
        dataset["time"].attrs |= {
            "standard_name": "time",
            "units": f"seconds since {str(zero).replace('T', ' ')}",
        }
        try:
            dataset.to_netcdf(path, engine="netcdf4", encoding=no_fill)
        except RuntimeError as error:  # netCDF states no other reason: most likely the disk is full
            raise OSError(f"{error}; is the disk full?") from error
        with path.open("rb+") as sealed:
            total = hashlib.sha256(sealed.read())
            sealed.write(SEAL + total.hexdigest().encode())

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """Read the trial in a file; see `Format.read`."""
        content = files.read_bytes(path)
        try:
            found = _decoded(_unsealed(content))
        except (
            OSError,
            RuntimeError,
            AttributeError,
        ) as error:  # raised by netCDF for invalid bytes
            raise ValueError("it is not a netCDF file, or it is damaged.") from error
        if MARK not in found.attrs:
            raise ValueError("it is a netCDF file, but not a trial of laticauda.")
        return found


def _unsealed(content: bytes) -> bytes:
    """Return the content without its seal, if it has one; raises ValueError if the seal is broken."""
    body, seal = content[:-SEAL_LENGTH], content[-SEAL_LENGTH:]
    if not seal.startswith(SEAL):
        return content
    if seal[len(SEAL) :] != hashlib.sha256(body).hexdigest().encode():
        raise ValueError("it is damaged: its checksum is wrong.")
    return body


def _decoded(content: bytes) -> "xarray.Dataset":
    import netCDF4
    import xarray
    from xarray.backends import NetCDF4DataStore

    # Read from memory: errors of the file system were raised when the bytes were read.
    with netCDF4.Dataset("trial.nc", mode="r", memory=content) as file:
        found = xarray.open_dataset(
            NetCDF4DataStore(file), decode_times=False, mask_and_scale=False
        ).load()
    return found.swap_dims(axes="axis") if "axes" in found.dims else found


TEXT = "laticauda_trial"
TEXTS = ("scenario", "status")


class MatFile(trial.Format):
    """After ``load run.mat`` there is one variable per time series, with time along its rows.

    For example, ``joint_angle(:, 1)`` is the angle of the tail-most joint and ``units.joint_angle``
    its unit; ``scenario`` and ``status`` are texts.
    """

    called: ClassVar[str] = "mat"
    title: ClassVar[str] = "MATLAB, GNU Octave"

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write a trial as a .mat file of version 5; see `Format.write`."""
        series = {
            str(name): one for name, one in dataset.variables.items() if one.dims[:1] == ("time",)
        }
        content: dict[str, Any] = {name: one.values for name, one in series.items()}
        content["units"] = {name: one.attrs["units"] for name, one in series.items()}
        # To Octave, texts are bytes: non-ASCII characters are escaped here, and kept in the text
        # that is read back.
        content |= {
            name: str(dataset.attrs[name]).encode("ascii", "backslashreplace").decode()
            for name in TEXTS
        }
        content[TEXT] = json.dumps(dataset.attrs)
        with path.open("wb") as file:
            _scipy().savemat(file, content, long_field_names=True, oned_as="column")

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """Read the trial in a .mat file; see `Format.read`."""
        content = _content(path)
        if TEXT not in content:
            raise ValueError("it is not a trial of laticauda; give a column map.")

        def read(name: str) -> Any:
            values = content[name]
            # In MATLAB every array has at least two axes.
            return values.reshape(-1) if describe_series(name).dimensions == ("time",) else values

        return assembled(read, json.loads(str(content[TEXT].item())))


def mat_columns(path: Path) -> dict[str, Samples]:
    """Return the numeric columns of a .mat file of any writer; those of a matrix `a` are named `a_0`, `a_1` and so on.

    Args:
        path: The file.

    Raises:
        MissingExtra: If scipy is not installed.
        ValueError: If the file is not a .mat file.
        OSError: If the file cannot be read.
    """
    found: dict[str, Samples] = {}
    for name, values in _content(path).items():
        if not isinstance(values, np.ndarray) or values.dtype.kind not in "iuf" or values.ndim != 2:
            continue
        if 1 in values.shape:
            found[name] = np.asarray(values, dtype=np.float64).reshape(-1)
        else:
            found |= {
                f"{name}_{i}": np.asarray(values[:, i], dtype=np.float64)
                for i in range(values.shape[1])
            }
    return found


# Invalid bytes may crash scipy or make it hang, so it runs in a separate process, which returns
# plain arrays.
_PATIENCE = 60.0
_NO_MAT = "it is not a .mat file, or it is damaged."
_MAT_4_HEADER = "5i"
"""Of a variable in a file of version 4: kind, rows, columns, whether it is complex, length of its name."""
_READER = """
import io, sys, numpy, scipy.io
found = scipy.io.loadmat(io.BytesIO(sys.stdin.buffer.read()))
kept = {f"_{name}": one for name, one in found.items() if isinstance(one, numpy.ndarray) and one.dtype.kind in "iufU"}
numpy.savez(sys.stdout.buffer, **kept)
"""


def _content(path: Path) -> dict[str, Any]:
    _scipy()
    words = [sys.executable, "-P", "-c", _READER]
    content = files.read_bytes(path)
    if not _begins_like_mat(content):  # starting the process takes a third of a second
        raise ValueError(_NO_MAT)
    try:
        done = subprocess.run(
            words, input=content, capture_output=True, check=False, timeout=_PATIENCE
        )
    except subprocess.TimeoutExpired:
        raise ValueError(f"it is damaged: reading it takes longer than {_PATIENCE:g} s.") from None
    if b"NotImplementedError" in done.stderr:
        raise ValueError("it is a .mat file of version 7.3; save it with `-v7` instead.")
    if done.returncode:
        raise ValueError(_NO_MAT)
    return {name[1:]: one for name, one in np.load(io.BytesIO(done.stdout)).items()}


def _begins_like_mat(content: bytes) -> bool:
    """Return whether the first bytes are those of a .mat file, of version 4 or a later one."""
    if content[126:128] in (b"IM", b"MI"):
        return True
    if len(content) < struct.calcsize(_MAT_4_HEADER):
        return False
    for byte_order in "<>":
        kind, n_rows, n_columns, is_complex, name_length = struct.unpack_from(
            byte_order + _MAT_4_HEADER, content
        )
        is_sensible = 0 <= kind < 5000 and n_rows >= 0 and n_columns >= 0 and name_length > 0
        if is_sensible and is_complex in (0, 1):
            return True
    return False


def _scipy() -> Any:
    return optional_import("Reading and writing .mat", "scipy", "logs", "scipy.io")
