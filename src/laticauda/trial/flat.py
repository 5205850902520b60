"""A trial as a flat table, one column per number, and as texts: for formats that know nothing else."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.trial.contents import AnyArray, Samples
from laticauda.trial.layout import AXES, FORMAT, MARK, attributes, trial_from, variable, variables
from laticauda.trial.trial import Trial


@dataclass(frozen=True, kw_only=True, eq=False)
class Column:
    """One column of the table."""

    name: str
    """As `joint_angle_0`; 0 is the tail."""
    unit: str
    """SI unit, in the notation of UDUNITS."""
    values: Samples
    """One number per sample."""


def columns(trial: Trial) -> list[Column]:
    """All time series of a trial as single columns, time first.

    Args:
        trial: Any trial.
    """
    found: list[Column] = []
    for described, values in variables(trial):
        for index in np.ndindex(values.shape[1:]):
            name = described.name + _suffix(described.dimensions[1:], index)
            found.append(Column(name=name, unit=described.units, values=values[(slice(None), *index)]))
    return found


def text(trial: Trial) -> str:
    """Everything of a trial that is no time series, as one JSON text in ASCII; the state is in it.

    Args:
        trial: Any trial.
    """
    state = {
        name: {"shape": values.shape, "bytes": base64.b64encode(values.tobytes()).decode()}
        for name, values in trial.state.items()
    }
    return json.dumps({**attributes(trial), "state_arrays": state})


def trial_of(table: Mapping[str, Samples], text: str) -> Trial:
    """The trial again.

    Args:
        table: Its columns by name.
        text: As `text` made it.

    Raises:
        KeyError: If a column or an entry is missing.
        ValueError: If anything is not as it was written.
    """
    return read_back(partial(assembled, table), text)


def read_back(read: Callable[[str], AnyArray], text: str) -> Trial:
    """The trial whose time series `read` gives by their names.

    Args:
        read: Gives the array of a time series by its name.
        text: As `text` made it.

    Raises:
        KeyError: If an entry is missing; `read` may raise its own.
        ValueError: If anything is not as it was written.
    """
    entries: dict[str, Any] = json.loads(text)
    if entries.get(MARK) != FORMAT:
        raise ValueError(f"it has format {entries.get(MARK)}, and this version of laticauda reads format {FORMAT}.")
    kinds: dict[str, str] = json.loads(entries["state"])

    def array(name: str) -> AnyArray:
        if not name.startswith("state/"):
            return read(name)
        stored = entries["state_arrays"][name.removeprefix("state/")]
        content = base64.b64decode(stored["bytes"])
        return np.frombuffer(content, kinds[name.removeprefix("state/")]).reshape(stored["shape"])

    return trial_from(array, entries)


def assembled(table: Mapping[str, Samples], name: str) -> Float[np.ndarray, "n_samples ..."]:
    """One time series from its columns.

    Args:
        table: Columns by name.
        name: Of the time series.

    Raises:
        KeyError: If it has no column.
    """
    dimensions = variable(name).dimensions[1:]
    sizes = tuple(_size(table, name, dimensions, axis) for axis in range(len(dimensions)))
    if dimensions[-1:] == ("axis",) and 0 in sizes:
        raise KeyError(name)
    found = np.empty((len(table["time"]), *sizes))
    for index in np.ndindex(sizes):
        found[(slice(None), *index)] = table[name + _suffix(dimensions, index)]
    return found


def _size(table: Mapping[str, Samples], name: str, dimensions: tuple[str, ...], axis: int) -> int:
    """How many columns there are along one axis."""

    def count() -> Iterator[int]:
        index = [0] * len(dimensions)
        limit = len(AXES) if dimensions[axis] == "axis" else None
        while (limit is None or index[axis] < limit) and name + _suffix(dimensions, tuple(index)) in table:
            yield 1
            index[axis] += 1

    return sum(count())


def _suffix(dimensions: tuple[str, ...], index: tuple[int, ...]) -> str:
    return "".join(f"_{AXES[i] if name == 'axis' else i}" for name, i in zip(dimensions, index, strict=True))
