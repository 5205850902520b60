"""Trials as .mat files for MATLAB and GNU Octave, by `scipy.io`."""

# What is read from a .mat file can be anything: this module turns it into arrays and texts.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import json
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from laticauda.errors import TrialFileError
from laticauda.extras import optional_import
from laticauda.files import read_bytes
from laticauda.trial import Format
from laticauda.trial.arrays import Samples
from laticauda.trial.dataset import assembled, variable

if TYPE_CHECKING:
    import xarray

TEXT = "laticauda_trial"
TEXTS = ("scenario", "status")


class MatFile(Format):
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
        content |= {name: _ascii(str(dataset.attrs[name])) for name in TEXTS}
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
    content = read_bytes(path)
    try:
        return library.loadmat(BytesIO(content))
    except NotImplementedError as error:
        message = "it is a .mat file of version 7.3; save it with `-v7` instead"
        raise TrialFileError(f"Cannot load {path}: {message}.") from error
    except Exception as error:  # scipy raises anything at bytes that make no sense
        raise TrialFileError(f"Cannot load {path}: it is no .mat file, or it is damaged.") from error


def _ascii(text: str) -> str:
    return text.encode("ascii", "backslashreplace").decode()


def _library() -> Any:
    return optional_import("Reading and writing .mat", "scipy", "logs", "scipy.io")
