"""Trials as netCDF files, which open in any netCDF tool and with `xarray.open_dataset`.

A checksum covers the whole file, so that a damaged file is rejected rather than half read; a file
edited by another program has lost its checksum, and is accepted as it is.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportMissingTypeStubs=false

import hashlib
from collections.abc import Hashable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from laticauda.trials import Format
from laticauda.trials.dataset import MARK, read_epoch
from laticauda.values import files

if TYPE_CHECKING:
    import xarray

SEAL = b"\nlaticauda sha256 "
"""Mark after the HDF5 data, where netCDF does not look; the SHA-256 of everything before it follows.

The check comes first, because HDF5 itself may hang on a single wrong bit. Programs that edit a file
in place remove both.
"""
SEAL_LENGTH = len(SEAL) + 64
"""Length of the mark and the checksum [bytes]."""

NAMES_OF_TEXTS = {"axis": "axes", "direction": "directions"}
"""Dimensions with texts for places: their names in the file."""
SIZE_OF_PROBE = 1 << 16
"""Number of bytes at least that are written to find out why a file cannot be [bytes]."""


class NetCdfFile(Format):
    """The Dataset, unchanged."""

    called: ClassVar[str] = "nc"
    title: ClassVar[str] = "netCDF"

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write the file of a trial with its checksum; see `Format.write`."""
        encoding = {
            name: {"_FillValue": None}
            for name, variable in dataset.variables.items()
            if variable.dtype == np.float64
        }
        # Under the CF conventions no text variable may share its name with a dimension, and time is
        # a date.
        dataset = dataset.rename_dims(
            {name: plural for name, plural in NAMES_OF_TEXTS.items() if name in dataset.dims}
        )
        microseconds = read_epoch(dataset.attrs) // 1000
        start = str(np.datetime64(microseconds, "us")).replace("T", " ")
        dataset["time"].attrs |= {
            "standard_name": "time",
            "units": f"seconds since {start}",
        }
        write_dataset(dataset, path, encoding)
        with path.open("rb+") as file:
            checksum = hashlib.sha256(file.read())
            file.write(SEAL + checksum.hexdigest().encode())

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """Read the trial in a file; see `Format.read`."""
        content = files.read_bytes(path)
        try:
            dataset = _decode(_remove_seal(content))
        except (OSError, RuntimeError, AttributeError) as error:  # from netCDF, for invalid bytes
            raise ValueError("it is not a netCDF file, or it is damaged.") from error
        if MARK not in dataset.attrs:
            raise ValueError("it is a netCDF file, but not a trial of laticauda.")
        return dataset


def write_dataset(
    dataset: "xarray.Dataset", path: Path, encoding: Mapping[Hashable, Mapping[str, Any]]
) -> None:
    """Write a Dataset to a netCDF file.

    Args:
        dataset: The Dataset.
        path: Path of the file.
        encoding: How variables are stored, by name.

    Raises:
        OSError: If the file cannot be written.
    """
    try:
        dataset.to_netcdf(path, engine="netcdf4", encoding=encoding)
    except (RuntimeError, PermissionError) as error:
        # netCDF does not state the reason, or a wrong one. Who writes as much to the same file is
        # told it by the system.
        path.write_bytes(bytes(max(dataset.nbytes, SIZE_OF_PROBE)))
        if isinstance(error, PermissionError):
            raise
        raise OSError(f"{error}; is the disk full?") from error


def _remove_seal(content: bytes) -> bytes:
    """Return the content without its seal, if it has one; raises ValueError if the seal is broken."""
    body = content[:-SEAL_LENGTH]
    seal = content[-SEAL_LENGTH:]
    if not seal.startswith(SEAL):
        return content
    checksum = hashlib.sha256(body).hexdigest().encode()
    if seal[len(SEAL) :] != checksum:
        raise ValueError("it is damaged: its checksum is wrong.")
    return body


def _decode(content: bytes) -> "xarray.Dataset":
    import netCDF4
    import xarray
    from xarray.backends import NetCDF4DataStore

    # Read from memory: errors of the file system were raised when the bytes were read.
    with netCDF4.Dataset("trial.nc", mode="r", memory=content) as file:
        store = NetCDF4DataStore(file)
        dataset = xarray.open_dataset(store, decode_times=False, mask_and_scale=False).load()
    renamed = {plural: name for name, plural in NAMES_OF_TEXTS.items() if plural in dataset.dims}
    return dataset.swap_dims(renamed)
