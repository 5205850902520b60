"""Trials as netCDF files: they open in any netCDF tool and by `xarray.open_dataset`.

A checksum covers the whole file, so a damaged one is refused and not half read; a file that another program edited has
lost it, and is taken as it is.
"""

# netCDF4 types what it reads as Any, by the nature of the format: this module turns that into arrays and texts.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import hashlib
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from laticauda.errors import TrialFileError
from laticauda.files import read_bytes
from laticauda.trial import Format
from laticauda.trial.dataset import MARK, packed

if TYPE_CHECKING:
    import xarray

# Behind the end of the HDF5 data, where netCDF does not look, stand this and the SHA-256 of all before it. The check
# comes first, because HDF5 itself may hang on a single wrong bit. Programs that edit a file in place cut this off.
SEAL = b"\nlaticauda sha256 "
SEAL_LENGTH = len(SEAL) + 64


class NetCdfFile(Format):
    """The Dataset as it is."""

    called: ClassVar[str] = "nc"
    title: ClassVar[str] = "netCDF"

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write the file of a trial with its checksum; see `Format.write`."""
        no_fill = {name: {"_FillValue": None} for name, one in dataset.variables.items() if one.dtype == np.float64}
        try:
            dataset.to_netcdf(path, engine="netcdf4", encoding=no_fill)
        except RuntimeError as error:  # netCDF's, with no more of a reason: most likely the disk is full
            raise OSError(f"{error}; is the disk full?") from error
        with path.open("rb+") as sealed:
            total = hashlib.sha256(sealed.read())
            sealed.write(SEAL + total.hexdigest().encode())

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """The trial in a file; see `Format.read`."""
        content = read_bytes(path)
        try:
            found = _decoded(_unsealed(content))
        except (OSError, RuntimeError, AttributeError) as error:  # what netCDF raises at bytes that make no sense
            raise TrialFileError(f"Cannot load {path}: it is no netCDF file, or it is damaged.") from error
        if MARK not in found.attrs:
            raise TrialFileError(f"Cannot load {path}: it is a netCDF file, but no trial of laticauda.")
        return found


def _unsealed(content: bytes) -> bytes:
    """The content without its seal, if it has one; raises ValueError if the seal is broken."""
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

    # From memory: what the file system has to say was said when the bytes were read.
    with netCDF4.Dataset("trial.nc", mode="r", memory=content) as file:
        found = xarray.open_dataset(NetCDF4DataStore(file), decode_cf=False).load()
        if found.attrs.get(MARK) == 1:
            found.attrs["state_arrays"] = _state(file, found.attrs)
    return found


def _state(file: Any, attributes: Any) -> dict[str, Any]:
    """The arrays of the state, which files of format 1 have in a group."""
    kinds: dict[str, str] = json.loads(attributes["state"])
    group = file.groups["state"]
    group.set_auto_mask(False)
    for name in kinds:
        if name not in group.variables:
            raise KeyError(f"state/{name}")
    return {name: packed(np.asarray(group[name][...]).astype(kind)) for name, kind in kinds.items()}
