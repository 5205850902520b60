"""Formats of trial files: each is one class in one module, known by the ending of its files.

A file appears whole or not at all, over any older file of that name: see `laticauda.files.write`.
"""

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from laticauda.extensions import Extensible
from laticauda.files import write

if TYPE_CHECKING:
    import xarray

_OURS = {
    "nc": "laticauda.logs.tabular",
    "mcap": "laticauda.logs.mcap_trials",
    "parquet": "laticauda.logs.tabular",
    "mat": "laticauda.logs.tabular",
    "csv": "laticauda.logs.tabular",
}


class Format(Extensible, group="formats", homes=_OURS):
    """How the Dataset of a trial is written to files of one ending, and read from them.

    class Zarr(Format):          # known by its entry point in the group `laticauda.formats`, or once it is imported
        called = "zarr"          # the ending, without its point
    """

    title: ClassVar[str] = ""
    """What it is, in words."""
    is_whole: ClassVar[bool] = True
    """Whether all of a trial is kept, so that it can be read again."""

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write a trial to an empty file.

        Args:
            dataset: The trial, see `Trial.to_dataset`.
            path: The file; its name need not have the ending.

        Raises:
            MissingExtra: If a package is not installed.
            OSError: If the file cannot be written.
        """
        raise NotImplementedError

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """The Dataset that was written, with all its numbers and attributes.

        Args:
            path: The file.

        Raises:
            MissingExtra: If a package is not installed.
            TrialFileError: If it is no such file.
            KeyError: If something is missing from it.
            ValueError: If what it says is no trial, or it is damaged.
            OSError: If it cannot be read.
        """
        raise NotImplementedError

    @classmethod
    def of(cls, path: Path) -> "type[Format]":
        """The format of a file by the ending of its name; netCDF if that is none's.

        Args:
            path: The file; it need not exist.
        """
        ending = path.suffix.lower().removeprefix(".")
        return cls.named(ending if ending in cls.names() else "nc")

    @classmethod
    def endings(cls) -> tuple[str, ...]:
        """The endings of all formats, as ".nc"."""
        return tuple(f".{name}" for name in cls.names())


def save(dataset: "xarray.Dataset", path: Path, ending: str | None = None) -> None:
    """Write a trial to a file.

    Args:
        dataset: The trial.
        path: The file.
        ending: Of its format; None: that of its name.

    Raises:
        StorageFailed: If the file cannot be written; the message has its name and the reason.
        MissingExtra: If the format needs a package that is not installed.
    """
    form = Format.of(path) if ending is None else Format.named(ending)
    write(path, lambda beside: form.write(dataset, beside))
