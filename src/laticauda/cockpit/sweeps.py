"""A stored sweep as maps: read from the folder of `laticauda sweep`, or from one file that was made of it."""

# xarray's own annotations are partial: this module is the cockpit's door to it.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile

import numpy as np

from laticauda.cockpit.chart import Axis, Chart
from laticauda.errors import TrialFileError, one_of
from laticauda.studies import open_sweep
from laticauda.studies.trials import QUANTITIES

MOST_BYTES = 1 << 30  # of an archive, unpacked
DEFINITION = "sweep.json"  # in the folder of a sweep
NO_SWEEP = "it is no sweep of laticauda: `laticauda sweep` makes a folder; pack it as .zip, or save it as .nc"


@dataclass(frozen=True, kw_only=True, eq=False)
class StoredSweep:
    """Many trials that somebody ran before."""

    name: str
    """Of the file or folder."""
    about: Mapping[str, str]
    """What all trials share: robot, gait, environment, joints."""
    axes: tuple[Axis, ...]
    """What differs."""
    values: Mapping[str, np.ndarray]
    """By quantity: over the axes of a grid, else one per point."""

    @property
    def is_grid(self) -> bool:
        """Whether there is every combination of the axes' values."""
        return next(iter(self.values.values())).ndim == len(self.axes) > 1

    @property
    def spanning(self) -> tuple[str, ...]:
        """The axes that a map can have: those with two values or more."""
        return tuple(axis.name for axis in self.axes if len(set(axis.values)) > 1)

    def chart(self, quantity: str, x: str, y: str, at: Mapping[str, int] | None = None) -> Chart:
        """A map of it.

        Args:
            quantity: One of `values`.
            x: Name of the axis from left to right.
            y: Name of the axis upward.
            at: Which value of every other axis of a grid, by its number; the first if it is not given.

        Raises:
            ValueError: If there is no such quantity or axis.
        """
        known = {axis.name: axis for axis in self.axes}
        values = self.values[one_of("quantity", quantity, tuple(self.values))]
        for name, chosen in (("x", x), ("y", y)):
            one_of(name, chosen, tuple(known))
        title = title_of(quantity)
        others = [axis for axis in self.axes if axis.name not in (x, y)]
        if not self.is_grid:
            rest = {axis.name: axis.values for axis in others}
            return Chart(x=known[x], y=known[y], values=values, title=title, others=rest)
        at = at or {}
        cut = values[tuple(slice(None) if a.name in (x, y) else at.get(a.name, 0) for a in self.axes)]
        names = [axis.name for axis in self.axes]
        plane = cut.T if names.index(x) < names.index(y) else cut
        fixed = {axis.name: (axis.values[at.get(axis.name, 0)],) for axis in others}
        return Chart(x=known[x], y=known[y], values=plane, title=title, others=fixed)


def title_of(quantity: str) -> str:
    """What a quantity of a sweep is called, with its unit."""
    unit = QUANTITIES[quantity][0]
    return f"{quantity.replace('_', ' ').capitalize()} [{'-' if unit == '1' else unit}]"


def read_sweep(path: Path, name: str) -> StoredSweep:
    """The sweep in a folder, a zipped folder or a netCDF file.

    Args:
        path: Where it is.
        name: What the user calls it, for messages.

    Raises:
        TrialFileError: If it is none, or has no two numbers to span a map.
        MissingExtra: If it is in Zarr's format, and zarr is not installed.
    """
    try:
        if path.is_dir():
            return _stored(open_sweep(path), name)
        import xarray

        with xarray.open_dataset(path, engine="netcdf4") as dataset:
            return _stored(dataset, name)
    except (ValueError, KeyError, OSError) as error:
        raise TrialFileError(f"Cannot load {name}: {error}".replace(str(path), name)) from error


def unpacked(path: Path, folder: Path, name: str) -> Path:
    """The folder of a sweep that was packed as .zip.

    Args:
        path: The archive.
        folder: Where it may be unpacked.
        name: What the user calls it, for messages.

    Raises:
        TrialFileError: If it is no archive, or has no sweep in it.
    """
    try:
        with ZipFile(path) as archive:
            if sum(item.file_size for item in archive.infolist()) > MOST_BYTES:
                raise TrialFileError(f"Cannot load {name}: unpacked it is larger than {MOST_BYTES >> 20} MB.")
            archive.extractall(folder)
    except (BadZipFile, OSError) as error:
        raise TrialFileError(f"Cannot load {name}: {error}.") from error
    found = sorted(folder.rglob(DEFINITION))
    if not found:
        raise TrialFileError(f"Cannot load {name}: {NO_SWEEP}.")
    return found[0].parent


def is_sweep(path: Path) -> bool:
    """Whether a netCDF file looks like one, and not like a trial."""
    import xarray

    try:
        with xarray.open_dataset(path, engine="netcdf4") as dataset:
            return "forward_velocity" in dataset and "center_of_mass" not in dataset
    except (ValueError, OSError):
        return False


def _stored(dataset: Any, name: str) -> StoredSweep:
    quantities = [quantity for quantity in QUANTITIES if quantity in dataset and quantity != "succeeded"]
    if not quantities:
        raise ValueError(f"{NO_SWEEP}.")
    dims = dataset[quantities[0]].dims
    # A grid has a dimension per number that is swept; lists and samples have one dimension and the numbers along it.
    is_grid = all(dim in dataset.coords for dim in dims)
    dataset = dataset.sortby(list(dims)) if is_grid else dataset
    names = [str(name) for name in (dims if is_grid else dataset.coords)]
    axes = tuple(
        Axis(
            name=one,
            unit="" if (unit := str(dataset[one].attrs.get("units", ""))) == "1" else unit,
            values=tuple(np.asarray(dataset[one], dtype=float).ravel().tolist()),
        )
        for one in names
    )
    about = {key: str(dataset.attrs[key]) for key in ("robot", "gait", "environment", "joints") if key in dataset.attrs}
    values = {quantity: np.asarray(dataset[quantity], dtype=float) for quantity in quantities}
    found = StoredSweep(name=name, about=about, axes=axes, values=values)
    if len(found.spanning) < 2:
        listed = ", ".join(axis.name for axis in axes) or "nothing"
        raise ValueError(f"a map needs two numbers that differ from trial to trial; this sweep is over {listed}.")
    if not any(np.isfinite(one).any() for one in values.values()):
        raise ValueError("none of its trials has been run yet.")
    return found
