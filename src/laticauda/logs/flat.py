"""A trial as a flat table, one column per number, for formats that know nothing else."""

import itertools
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from laticauda.trial.arrays import Samples
from laticauda.trial.dataset import AXES, assembled, variable

if TYPE_CHECKING:
    import xarray


def columns(dataset: "xarray.Dataset") -> Iterator[tuple[str, str, Samples]]:
    """All time series of a trial as single columns, time first: name, as `joint_angle_0` of the tail, unit, values.

    Args:
        dataset: The trial.
    """
    for name, series in dataset.variables.items():
        if series.dims[:1] != ("time",):
            continue
        for index in np.ndindex(series.shape[1:]):
            ends = (f"_{AXES[i] if of == 'axis' else i}" for of, i in zip(series.dims[1:], index, strict=True))
            yield f"{name}{''.join(ends)}", series.attrs["units"], series.values[(slice(None), *index)]


def dataset_of(table: Mapping[str, Samples], attributes: Mapping[str, Any]) -> "xarray.Dataset":
    """The trial again.

    Args:
        table: Its columns by name.
        attributes: Of its Dataset.

    Raises:
        KeyError: If a column or an entry is missing.
        ValueError: If anything is not as it was written.
    """
    return assembled(lambda name: series(table, name), attributes)


def series(table: Mapping[str, Samples], name: str) -> Float[np.ndarray, "n_samples ..."]:
    """One time series from its columns.

    Args:
        table: Columns by name.
        name: Of the time series.

    Raises:
        KeyError: If it has no column.
    """
    return _stacked(table, name, variable(name).dimensions[1:])


def _stacked(table: Mapping[str, Samples], name: str, dimensions: tuple[str, ...]) -> Float[np.ndarray, "..."]:
    if not dimensions:
        return table[name]
    found: list[Float[np.ndarray, ...]] = []
    for end in AXES if dimensions[0] == "axis" else itertools.count():
        try:
            found.append(_stacked(table, f"{name}_{end}", dimensions[1:]))
        except KeyError:
            break
    if not found and dimensions != ("joint",):  # a robot of one link has no joint
        raise KeyError(name)
    return np.stack(found, axis=1) if found else np.empty((len(table["time"]), 0))
