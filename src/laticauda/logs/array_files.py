"""Trials as files of arrays: netCDF, and .mat for MATLAB and GNU Octave (by `scipy.io`).

A netCDF file opens in any netCDF tool and by `xarray.open_dataset`. A checksum covers the whole file, so a damaged one
is refused and not half read; a file that another program edited has lost it, and is taken as it is.
"""

# What is read from such files can be anything, by their nature: this module turns it into arrays and texts.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import hashlib
import json
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from laticauda import files, trial
from laticauda.errors import TrialFileError
from laticauda.extras import optional_import
from laticauda.trial.arrays import Samples
from laticauda.trial.dataset import MARK, assembled, variable

if TYPE_CHECKING:
    import xarray


# Behind the end of the HDF5 data, where netCDF does not look, stand this and the SHA-256 of all before it. The check
# comes first, because HDF5 itself may hang on a single wrong bit. Programs that edit a file in place cut this off.
SEAL = b"\nlaticauda sha256 "
SEAL_LENGTH = len(SEAL) + 64


class NetCdfFile(trial.Format):
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
        content = files.read_bytes(path)
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
        return xarray.open_dataset(NetCDF4DataStore(file), decode_cf=False).load()


TEXT = "laticauda_trial"
TEXTS = ("scenario", "status")


class MatFile(trial.Format):
    """After ``load run.mat`` there is a variable per time series, time along its rows.

    So ``joint_angle(:, 1)`` is the tail-most joint's, ``units.joint_angle`` its unit; ``scenario`` and ``status`` are
    texts.
    """

    called: ClassVar[str] = "mat"
    title: ClassVar[str] = "MATLAB, GNU Octave"

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write a trial as a .mat file of version 5; see `Format.write`."""
        series = {str(name): one for name, one in dataset.variables.items() if one.dims[:1] == ("time",)}
        content: dict[str, Any] = {name: one.values for name, one in series.items()}
        content["units"] = {name: one.attrs["units"] for name, one in series.items()}
        # Its texts are bytes to Octave: what is not ASCII is escaped, and whole in the text that is read back.
        content |= {name: str(dataset.attrs[name]).encode("ascii", "backslashreplace").decode() for name in TEXTS}
        content[TEXT] = json.dumps(dataset.attrs)
        with path.open("wb") as file:
            _library().savemat(file, content, long_field_names=True, oned_as="column")

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """The trial in a .mat file; see `Format.read`."""
        content = _content(path)
        if TEXT not in content:
            raise TrialFileError(f"Cannot load {path}: it is no trial of laticauda; say what its columns are.")

        def read(name: str) -> Any:
            values = content[name]
            # To MATLAB every array has two axes at least.
            return values.reshape(-1) if variable(name).dimensions == ("time",) else values

        return assembled(read, json.loads(str(content[TEXT].item())))


def mat_columns(path: Path) -> dict[str, Samples]:
    """The columns of numbers in a .mat file of any writer: those of a matrix `a` are called `a_0`, `a_1` and so on.

    Args:
        path: The file.

    Raises:
        MissingExtra: If scipy is not installed.
        TrialFileError: If it is no .mat file.
        OSError: If it cannot be read.
    """
    found: dict[str, Samples] = {}
    for name, values in _content(path).items():
        if not isinstance(values, np.ndarray) or values.dtype.kind not in "iuf" or values.ndim != 2:
            continue
        if 1 in values.shape:
            found[name] = np.asarray(values, dtype=np.float64).reshape(-1)
        else:
            found |= {f"{name}_{i}": np.asarray(values[:, i], dtype=np.float64) for i in range(values.shape[1])}
    return found


def _content(path: Path) -> dict[str, Any]:
    library = _library()
    content = files.read_bytes(path)
    try:
        return library.loadmat(BytesIO(content))
    except NotImplementedError as error:
        message = "it is a .mat file of version 7.3; save it with `-v7` instead"
        raise TrialFileError(f"Cannot load {path}: {message}.") from error
    except Exception as error:  # scipy raises anything at bytes that make no sense
        raise TrialFileError(f"Cannot load {path}: it is no .mat file, or it is damaged.") from error


def _library() -> Any:
    return optional_import("Reading and writing .mat", "scipy", "logs", "scipy.io")
