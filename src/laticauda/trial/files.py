"""Trial files: netCDF to keep and load back equal, CSV for spreadsheets, xarray Datasets in memory.

A file appears whole or not at all: it is written beside its place under another name and then moved there, over any
older file of that name. A netCDF file opens in any netCDF tool and by `xarray.open_dataset`; the plant's state, for a
restart, is in its group `state`. A checksum covers the whole file, so a damaged one is refused and not half read; a
file that another program edited has lost it, and is taken as it is.
"""

# netCDF4 types what it reads as Any, by the nature of the format: this module turns that into arrays and texts.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import csv
import hashlib
import io
import os
import uuid
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.errors import TrialFileError
from laticauda.trial.layout import AXES, FORMAT, MARK, attributes, coordinates, trial_from, variables
from laticauda.trial.trial import Trial

if TYPE_CHECKING:
    import netCDF4
    import xarray

# Behind the end of the HDF5 data, where netCDF does not look, stand this and the SHA-256 of all before it. The check
# comes first, because HDF5 itself may hang on a single wrong bit. Programs that edit a file in place cut this off.
SEAL = b"\nlaticauda sha256 "
SEAL_LENGTH = len(SEAL) + 64


def save_trial(trial: Trial, path: str | Path) -> None:
    """Write a trial to a netCDF file, from which `load_trial` makes an equal one.

    An older file of that name is replaced, but not before the new one is complete.

    Args:
        trial: Any trial, a failed one too.
        path: The file, usually ending in .nc.

    Raises:
        TrialFileError: If the file cannot be written; the message has its name and the reason.
    """
    _write_whole(Path(path), lambda beside: _store(trial, beside))


def load_trial(path: str | Path) -> Trial:
    """Read a trial from the netCDF file that `save_trial` wrote.

    Args:
        path: The file.

    Returns:
        A trial that `equals` the saved one, bit for bit.

    Raises:
        TrialFileError: If there is no such file, or it is no whole trial; the message has its name and the reason.
    """
    path = Path(path)
    try:
        content = path.read_bytes()
    except OSError as error:
        raise TrialFileError(f"Cannot read {path}: {(error.strerror or str(error)).lower()}.") from error
    try:
        return _decoded(content)
    except (OSError, RuntimeError, AttributeError) as error:  # what netCDF raises at bytes that make no sense
        raise TrialFileError(f"Cannot load {path}: it is no netCDF file, or it is damaged.") from error
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
    header: list[str] = []
    columns: list[np.ndarray] = []
    for variable, values in variables(trial):
        inner = variable.dimensions[1:]
        for index in np.ndindex(values.shape[1:]):
            suffix = "".join(f"_{AXES[i] if name == 'axis' else i}" for name, i in zip(inner, index, strict=True))
            header.append(f"{variable.name}{suffix} [{variable.units}]")
            columns.append(values[(slice(None), *index)])
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(header)
    writer.writerows(np.stack(columns, axis=1).tolist())
    content = text.getvalue().encode()
    _write_whole(Path(path), lambda beside: beside.write_bytes(content))


def _store(trial: Trial, path: Path) -> None:
    """Write the netCDF file of a trial, over what is there."""
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


def _write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Put at `path` what `write` makes of an empty file, whole or not at all."""
    # In the same folder, or it could not be moved there in one step.
    beside = path.with_name(f".{path.name}.{uuid.uuid4().hex[:8]}.part")
    try:
        try:
            beside.touch(exist_ok=False)
            write(beside)
            with beside.open("rb+") as file:
                os.fsync(file.fileno())  # or a power cut could leave the new name with nothing in it
            beside.replace(path)
        finally:
            beside.unlink(missing_ok=True)
    except OSError as error:
        raise TrialFileError(f"Cannot write {path}: {(error.strerror or str(error)).lower()}.") from error
    except RuntimeError as error:  # netCDF's, with no more of a reason: most likely the disk is full
        raise TrialFileError(f"Cannot write {path}: {error}; is the disk full?") from error
