"""Containers of numbers that trackers write: HDF5, NumPy's archives, and objects of Python that were pickled.

Nothing that a file names is imported or run: of pickled objects, only plain values and arrays of
numbers are built.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import io
import pickle
import zipfile
import zlib
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.values import HDF5_SIGNATURE, check_heaps, files, optional_import

NUMPY_SIGNATURE = b"\x93NUMPY"
"""First bytes of an array that NumPy saved."""
SAFE_GLOBALS = {
    ("_codecs", "encode"),
    ("numpy", "dtype"),
    ("numpy", "ndarray"),
    ("numpy._core.multiarray", "_reconstruct"),
    ("numpy._core.multiarray", "scalar"),
    ("numpy.core.multiarray", "_reconstruct"),
    ("numpy.core.multiarray", "scalar"),
}
"""Functions and classes that pickled arrays and numbers are made with."""


class Unread:
    """Stands for a pickled object of a class that is not read, such as a path."""

    def __init__(self, *arguments: object) -> None:
        """Ignore what the object was made of."""

    def __setstate__(self, state: object) -> None:
        """Ignore the state of the object."""


class PlainUnpickler(pickle.Unpickler):
    """Reads plain values and arrays of numbers; anything else becomes `Unread`."""

    def find_class(self, module_name: str, global_name: str) -> Any:
        """Return what builds an object; nothing but what is safe.

        Args:
            module_name: Module that the file names.
            global_name: Its class or function.
        """
        if (module_name, global_name) in SAFE_GLOBALS:
            return super().find_class(module_name, global_name)
        return Unread


def unpickle(content: bytes) -> Any:
    """Return plain values that were pickled.

    Args:
        content: The pickle.

    Raises:
        ValueError: If it is damaged.
    """
    try:
        return PlainUnpickler(io.BytesIO(content), encoding="latin1").load()
    except Exception as error:  # a damaged pickle raises anything
        raise ValueError("its pickled objects are damaged.") from error


@contextmanager
def open_hdf(path: Path) -> Generator[Any]:
    """Open a file of HDF5.

    Args:
        path: The file.

    Raises:
        ValueError: If it is damaged, or no such file.
        MissingExtra: If h5py is not installed.
    """
    h5py = optional_import("Reading HDF5 files", "h5py", "film")
    check_heaps(path)
    try:
        opened = h5py.File(path, "r")
    except OSError as error:
        raise ValueError("it is no HDF5 file, or damaged.") from error
    with opened as file:
        try:
            yield file
        except (RuntimeError, OSError, AttributeError, zlib.error) as error:
            raise ValueError(f"it is damaged: {error}") from error


def read_strings(dataset: Any) -> tuple[str, ...]:
    """Return the texts in a dataset of HDF5.

    Args:
        dataset: The dataset.
    """
    texts: list[str] = []
    for item in np.ravel(dataset[()]):
        if isinstance(item, bytes):
            texts.append(item.decode("utf-8", errors="replace"))
        else:
            texts.append(str(item))
    return tuple(texts)


def read_archive(path: Path) -> Mapping[str, np.ndarray]:
    """Return the arrays of numbers in an archive of NumPy by name; others are left out.

    Args:
        path: The .npz file.

    Raises:
        ValueError: If it is damaged, or no such file.
    """
    arrays: dict[str, np.ndarray] = {}
    try:
        # From bytes: NumPy does not close a file that turns out to be damaged.
        content = io.BytesIO(files.read_bytes(path))
        with np.load(content, allow_pickle=False) as archive:
            for name in archive.files:
                try:
                    arrays[name] = archive[name]
                except ValueError:  # an array of objects
                    continue
    except (zipfile.BadZipFile, zlib.error, EOFError, AttributeError, ValueError) as error:
        raise ValueError("it is no archive of NumPy, or damaged.") from error
    return arrays


def read_pickled_array(path: Path) -> Any:
    """Return the object in an array of NumPy with one object, or the array if it holds numbers.

    Args:
        path: The .npy file.

    Raises:
        ValueError: If it is damaged, or no such file.
    """
    content = io.BytesIO(files.read_bytes(path))
    try:
        version = np.lib.format.read_magic(content)
        read_header = np.lib.format.read_array_header_2_0
        if version == (1, 0):
            read_header = np.lib.format.read_array_header_1_0
        _shape, _is_fortran, kind = read_header(content)
    except Exception as error:  # a damaged header is Python that does not parse
        raise ValueError("it is no array of NumPy, or damaged.") from error
    if kind.hasobject:
        stored = unpickle(content.read())
        if isinstance(stored, np.ndarray) and stored.size == 1:
            return stored.item()
        return stored
    content.seek(0)
    return np.lib.format.read_array(content, allow_pickle=False)


def begins_with(path: Path, signature: bytes) -> bool:
    """Return whether a file begins with these bytes.

    Args:
        path: The file.
        signature: The bytes.
    """
    with path.open("rb") as file:
        return file.read(len(signature)) == signature


def is_hdf(path: Path) -> bool:
    """Return whether a file is one of HDF5.

    Args:
        path: The file.
    """
    return begins_with(path, HDF5_SIGNATURE)
