"""Null models: speeds that are predicted without physics, from the gait's name and frequency and the fin alone.

Each is fitted to measured speeds by least squares of the logarithm.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from laticauda.errors import BadArgument
from laticauda.gaits import GAIT_WORDS, Gait

Values = Float[np.ndarray, " n_rows"]
Design = Float[np.ndarray, "n_rows n_parameters"]


@dataclass(frozen=True, kw_only=True)
class Row:
    """What a null model knows of a row of a table of speeds."""

    gait: Gait
    """What the joints were asked for."""
    has_fin: bool
    """Whether the robot wore the caudal fin."""

    @property
    def group(self) -> str:
        """Name of the part of the table that it is in."""
        return group_name(self.gait.kind, self.has_fin)


def group_name(gait: str, has_fin: bool) -> str:
    """What tables and files call one gait with one configuration of the robot.

    Args:
        gait: The gait's kind.
        has_fin: Whether the robot wears the caudal fin.
    """
    return f"{GAIT_WORDS[gait]}, {'with' if has_fin else 'without'} fin"


def _per_group(rows: Sequence[Row], groups: Sequence[str]) -> Design:
    return np.array([[float(row.group == name) for name in groups] for row in rows])


def _fin_and_eel(rows: Sequence[Row], groups: Sequence[str]) -> Design:
    return np.array([(1.0, float(row.has_fin), float(row.gait.kind == "eel_like")) for row in rows])


class _Form(NamedTuple):
    """What is fitted: columns of numbers to speeds, or to their logarithm."""

    columns: Callable[[Sequence[Row], Sequence[str]], Design]
    """Of rows, from the names of all groups."""
    is_stride: bool = False
    """Whether the speeds are those per cycle: v proportional to the frequency."""
    is_log: bool = True
    """Whether logarithms are fitted."""


NULL_MODELS = {
    "constant per group": _Form(_per_group),
    "constant + fin + eel": _Form(_fin_and_eel),
    "constant stride per group": _Form(_per_group, is_stride=True),
    "constant stride + fin + eel": _Form(_fin_and_eel, is_stride=True),
}
"""Speeds without physics: a number per group, or a number and two factors; and the same for the distance per cycle."""
MEAN_STRIDE = "mean stride per group"
PREDICTORS = {**NULL_MODELS, MEAN_STRIDE: _Form(_per_group, is_stride=True, is_log=False)}
"""The same, and the constant stride with the arithmetic mean of each group's strides instead of the geometric one."""


def _fitted(
    form: _Form, rows: Sequence[Row], measured: Values, others: Sequence[Row]
) -> tuple[Float[np.ndarray, " n_others"], int, bool]:
    """Speeds of other rows by least squares, how many numbers are fitted, and whether the rows suffice for all."""
    groups = sorted({row.group for row in (*rows, *others)})
    known, asked = form.columns(rows, groups), form.columns(others, groups)
    units = [np.array([row.gait.frequency if form.is_stride else 1.0 for row in some]) for some in (rows, others)]
    speeds = measured / units[0]
    numbers, _, rank, _ = np.linalg.lstsq(known, np.log(speeds) if form.is_log else speeds)
    found = asked @ numbers
    return (np.exp(found) if form.is_log else found) * units[1], int(rank), bool(rank == known.shape[1])


@dataclass(frozen=True, kw_only=True, eq=False)
class NullModel:
    """How well speeds are predicted without physics."""

    name: str
    """Which of `NULL_MODELS`."""
    n_parameters: int
    """How many numbers are fitted."""
    speeds: Values
    """What it says of the speeds that it is fitted to [m/s]."""
    fitted: float
    """Mean error over them [%]."""
    left_out: float
    """The same with each one predicted by the others; nan if they do not suffice [%]."""
    group_left_out: float
    """The same with each group predicted by the others [%]."""


def compared(rows: Sequence[Row], measured: Values) -> tuple[NullModel, ...]:
    """Every null model fitted to the same speeds, and how it does on those that were left out of the fit.

    Args:
        rows: What they are fitted to.
        measured: Their speeds [m/s].
    """
    groups = np.unique([row.group for row in rows], return_inverse=True)[1]
    found: list[NullModel] = []
    for name, form in NULL_MODELS.items():
        speeds, n_parameters, _ = _fitted(form, rows, measured, rows)
        others = [_left_out(form, rows, measured, by) for by in (np.arange(len(rows)), groups)]
        errors = [np.nan if np.any(np.isnan(values)) else mape(measured, values) for values in others]
        how: Any = {"fitted": mape(measured, speeds), "left_out": errors[0], "group_left_out": errors[1]}
        found.append(NullModel(name=name, n_parameters=n_parameters, speeds=speeds, **how))
    return tuple(found)


def _left_out(form: _Form, rows: Sequence[Row], measured: Values, by: Int[np.ndarray, " n_rows"]) -> Values:
    """Each speed as the rows with another number in `by` say it; nan where they do not suffice."""
    found = np.full(measured.size, np.nan)
    for number in np.unique(by):
        out = by == number
        if out.all():  # nothing is left to say it
            break
        kept, asked = ([row for row, mine in zip(rows, some, strict=True) if mine] for some in (~out, out))
        speeds, _, suffices = _fitted(form, kept, measured[~out], asked)
        if suffices:
            found[out] = speeds
    return found


def predict(
    name: str, rows: Sequence[Row], measured: Values, others: Sequence[Row]
) -> tuple[Float[np.ndarray, " n_others"], int]:
    """Speeds of other rows than those that a null model is fitted to.

    Args:
        name: One of `PREDICTORS`.
        rows: What it is fitted to; must hold every group of the others.
        measured: Their speeds [m/s].
        others: What it predicts.

    Returns:
        Their speeds [m/s], and how many numbers are fitted.

    Raises:
        ValueError: If the others hold a group that the rows do not hold.
    """
    unknown = sorted({row.group for row in others} - {row.group for row in rows})
    if unknown:
        raise BadArgument("rows", f"must hold every group of `others`, got none of {', '.join(unknown)}")
    speeds, n_fitted, _ = _fitted(PREDICTORS[name], rows, measured, others)
    return speeds, n_fitted


def mape(measured: Float[np.ndarray, " _"], predicted: Float[np.ndarray, " _"]) -> float:
    """Mean absolute percentage error, 100 mean |predicted - measured| / measured [%].

    Args:
        measured: All > 0.
        predicted: In the same unit.

    Raises:
        ValueError: If there is no value, the numbers of values differ, or a measured one is not > 0.
    """
    if measured.size == 0 or measured.shape != predicted.shape:
        raise BadArgument("predicted", f"must have {measured.size} values, at least 1, got {predicted.size}")
    if not np.all(measured > 0.0):
        raise BadArgument("measured", f"must be > 0, got {np.min(measured)}")
    return 100.0 * float(np.mean(np.abs(predicted - measured) / measured))
