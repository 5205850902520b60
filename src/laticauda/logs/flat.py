"""A trial as a flat table, one column per number, and a text: for formats that know nothing else."""

import itertools
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from laticauda.trial.arrays import Samples
from laticauda.trial.dataset import AXES, assembled, variable

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True, kw_only=True, eq=False)
class Column:
    """One column of the table."""

    name: str
    """As `joint_angle_0`; 0 is the tail."""
    unit: str
    """SI unit, in the notation of UDUNITS."""
    values: Samples
    """One number per sample."""


def columns(dataset: "xarray.Dataset") -> Iterator[Column]:
    """All time series of a trial as single columns, time first.

    Args:
        dataset: The trial.
    """
    for name, series in dataset.variables.items():
        if series.dims[:1] != ("time",):
            continue
        for index in np.ndindex(series.shape[1:]):
            ends = (f"_{AXES[i] if of == 'axis' else i}" for of, i in zip(series.dims[1:], index, strict=True))
            values = series.values[(slice(None), *index)]
            yield Column(name=f"{name}{''.join(ends)}", unit=series.attrs["units"], values=values)


def text(dataset: "xarray.Dataset") -> str:
    """Everything of a trial that is no time series, as one JSON text in ASCII.

    Args:
        dataset: The trial.
    """
    return json.dumps(dataset.attrs)


def dataset_of(table: Mapping[str, Samples], text: str) -> "xarray.Dataset":
    """The trial again.

    Args:
        table: Its columns by name.
        text: As `text` made it.

    Raises:
        KeyError: If a column or an entry is missing.
        ValueError: If anything is not as it was written.
    """
    return assembled(lambda name: series(table, name), json.loads(text))


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
