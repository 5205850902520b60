"""Trials as .mat files for MATLAB and GNU Octave, and columns of .mat files of any writer.

Files are read and written with `scipy.io`. Invalid bytes may crash scipy or make it hang, so it
reads in a separate process, which returns plain arrays.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportMissingTypeStubs=false

import io
import json
import struct
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from laticauda.trials import Format
from laticauda.trials.arrays import Samples
from laticauda.trials.dataset import assembled, describe_series
from laticauda.values import files, optional_import

if TYPE_CHECKING:
    import xarray

ATTRIBUTES = "laticauda_trial"
"""Variable that holds everything in a trial that is no time series, as JSON."""
TEXTS = ("scenario", "status")
"""Texts of a trial that also are variables of their own, for people to read."""


class MatFile(Format):
    """After ``load run.mat`` there is one variable per time series, with time along its rows.

    For example, ``joint_angle(:, 1)`` is the angle of the tail-most joint and ``units.joint_angle``
    its unit; ``scenario`` and ``status`` are texts.
    """

    called: ClassVar[str] = "mat"
    title: ClassVar[str] = "MATLAB, GNU Octave"

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write a trial as a .mat file of version 5; see `Format.write`."""
        content: dict[str, Any] = {}
        units: dict[str, str] = {}
        for name, variable in dataset.variables.items():
            if variable.dims[:1] == ("time",):
                content[str(name)] = variable.values
                units[str(name)] = variable.attrs["units"]
        content["units"] = units
        # To Octave, texts are bytes: non-ASCII characters are escaped here, and kept in the text
        # that is read back.
        for name in TEXTS:
            text = str(dataset.attrs[name])
            content[name] = text.encode("ascii", "backslashreplace").decode()
        content[ATTRIBUTES] = json.dumps(dataset.attrs)
        with path.open("wb") as file:
            _import_scipy().savemat(file, content, long_field_names=True, oned_as="column")

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """Read the trial in a .mat file; see `Format.read`."""
        variables = _read_variables(path)
        if ATTRIBUTES not in variables:
            raise ValueError("it is not a trial of laticauda; give a column map.")

        def read_series(name: str) -> Any:
            values = variables[name]
            # In MATLAB every array has at least two axes.
            if describe_series(name).dimensions == ("time",):
                return values.reshape(-1)
            return values

        return assembled(read_series, json.loads(str(variables[ATTRIBUTES].item())))


def read_mat_columns(path: Path) -> dict[str, Samples]:
    """Return the numeric columns of a .mat file of any writer; those of a matrix `a` are named `a_0`, `a_1` and so on.

    Args:
        path: The file.

    Raises:
        MissingExtra: If scipy is not installed.
        ValueError: If the file is not a .mat file.
        OSError: If the file cannot be read.
    """
    columns: dict[str, Samples] = {}
    for name, values in _read_variables(path).items():
        is_number = isinstance(values, np.ndarray) and values.dtype.kind in "iuf"
        if not is_number or values.ndim != 2:
            continue
        numbers = np.asarray(values, dtype=np.float64)
        if 1 in numbers.shape:
            columns[name] = numbers.reshape(-1)
            continue
        for i, column in enumerate(numbers.T):
            columns[f"{name}_{i}"] = column
    return columns


# ---- the separate process ------------------------------------------------------------------------

_PATIENCE = 60.0
"""Time after which a file that is not yet read counts as damaged [s]."""
_NOT_MAT = "it is not a .mat file, or it is damaged."
_MAT_4_HEADER = "5i"
"""Of a variable in a file of version 4: kind, rows, columns, whether it is complex, length of its name."""
_READER = """
import io, sys, numpy, scipy.io
variables = scipy.io.loadmat(io.BytesIO(sys.stdin.buffer.read()))
arrays = {}
for name, values in variables.items():
    if isinstance(values, numpy.ndarray) and values.dtype.kind in "iufU":
        arrays[f"_{name}"] = values
numpy.savez(sys.stdout.buffer, **arrays)
"""
"""Program of the process: numbers and texts of a .mat file, as .npz; with a _ no name is that of an argument."""


def _read_variables(path: Path) -> dict[str, Any]:
    """Return the arrays of numbers and texts in a .mat file, by name."""
    _import_scipy()
    content = files.read_bytes(path)
    if not _begins_like_mat(content):  # starting the process takes a third of a second
        raise ValueError(_NOT_MAT)
    try:
        process = subprocess.run(
            [sys.executable, "-P", "-c", _READER],
            input=content,
            capture_output=True,
            check=False,
            timeout=_PATIENCE,
        )
    except subprocess.TimeoutExpired:
        raise ValueError(f"it is damaged: reading it takes longer than {_PATIENCE:g} s.") from None
    if b"NotImplementedError" in process.stderr:
        raise ValueError("it is a .mat file of version 7.3; save it with `-v7` instead.")
    if process.returncode:
        raise ValueError(_NOT_MAT)
    arrays = np.load(io.BytesIO(process.stdout))
    return {name.removeprefix("_"): values for name, values in arrays.items()}


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


def _import_scipy() -> Any:
    return optional_import("Reading and writing .mat", "scipy", "logs", "scipy.io")
