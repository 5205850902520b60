"""Trials as netCDF files: they open in any netCDF tool and by `xarray.open_dataset`.

The plant's state, for a restart, is in the group `state`. A checksum covers the whole file, so a damaged one is refused
and not half read; a file that another program edited has lost it, and is taken as it is.
"""

# netCDF4 types what it reads as Any, by the nature of the format: this module turns that into arrays and texts.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.errors import TrialFileError
from laticauda.trial.layout import FORMAT, MARK, attributes, coordinates, trial_from, variables
from laticauda.trial.trial import Trial

if TYPE_CHECKING:
    import netCDF4

# Behind the end of the HDF5 data, where netCDF does not look, stand this and the SHA-256 of all before it. The check
# comes first, because HDF5 itself may hang on a single wrong bit. Programs that edit a file in place cut this off.
SEAL = b"\nlaticauda sha256 "
SEAL_LENGTH = len(SEAL) + 64


def write_netcdf(trial: Trial, path: Path) -> None:
    """Write the netCDF file of a trial, over what is there.

    Args:
        trial: Any trial.
        path: The file.
    """
    import netCDF4

    index = coordinates(trial)
    with netCDF4.Dataset(path, mode="w", format="NETCDF4") as file:
        file.createDimension("time", trial.time.size)
        for name, values in index.items():
            file.createDimension(name, values.size)
            file.createVariable(name, str if values.dtype == object else "i4", (name,))[:] = values
        for variable, values in variables(trial):
            stored = file.createVariable(variable.name, "f8", variable.dimensions, fill_value=False)
            stored[:] = values
            stored.setncatts({"units": variable.units, "long_name": variable.long_name})
        state = file.createGroup("state")
        for name, values in trial.state.items():
            _store_state(state, name, values)
        file.setncatts(attributes(trial))
    with path.open("rb+") as sealed:
        total = hashlib.sha256(sealed.read())
        sealed.write(SEAL + total.hexdigest().encode())


def read_netcdf(path: Path) -> Trial:
    """The trial in a netCDF file; an equal one to what was written.

    Args:
        path: The file.

    Raises:
        TrialFileError: If it is no netCDF file.
        KeyError: If something is missing from it.
        ValueError: If what it says is no trial, or it is damaged.
        OSError: If it cannot be read.
    """
    content = path.read_bytes()
    try:
        return _decoded(content)
    except (OSError, RuntimeError, AttributeError) as error:  # what netCDF raises at bytes that make no sense
        raise TrialFileError(f"Cannot load {path}: it is no netCDF file, or it is damaged.") from error


def _store_state(group: netCDF4.Group, name: str, values: np.ndarray) -> None:
    plain = values.astype(np.int8) if values.dtype == np.bool_ else values  # netCDF has no truth values
    dimensions = tuple(f"{name}_{i}" for i in range(values.ndim))
    for dimension, size in zip(dimensions, values.shape, strict=True):
        group.createDimension(dimension, size)
    group.createVariable(name, plain.dtype.str, dimensions, fill_value=False)[...] = plain


def _unsealed(content: bytes) -> bytes:
    """The content without its seal, if it has one; raises ValueError if the seal is broken."""
    body, seal = content[:-SEAL_LENGTH], content[-SEAL_LENGTH:]
    if not seal.startswith(SEAL):
        return content
    if seal[len(SEAL) :] != hashlib.sha256(body).hexdigest().encode():
        raise ValueError("it is damaged: its checksum is wrong.")
    return body


def _decoded(content: bytes) -> Trial:
    """The trial whose file has these bytes.

    Raises:
        KeyError: If a variable or an attribute is missing.
        OSError, RuntimeError, AttributeError: If netCDF cannot make sense of the bytes.
        ValueError: If what they say is no trial.
    """
    import netCDF4

    # From memory: what the file system has to say was said when the bytes were read.
    with netCDF4.Dataset("trial.nc", mode="r", memory=_unsealed(content)) as file:
        file.set_auto_mask(False)
        texts: dict[str, Any] = {name: file.getncattr(name) for name in file.ncattrs()}
        if MARK not in texts:
            raise ValueError("it is a netCDF file, but no trial of laticauda.")
        if texts[MARK] != FORMAT:
            raise ValueError(f"it has format {texts[MARK]}, and this version of laticauda reads format {FORMAT}.")

        def read(name: str) -> np.ndarray:
            try:
                return np.asarray(file[name][...])
            except IndexError:
                raise KeyError(name) from None

        return trial_from(read, texts)
