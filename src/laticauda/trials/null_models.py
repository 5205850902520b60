"""Null models: speeds predicted without physics, from the gait's name and frequency and the fin alone.

Each is fitted to measured speeds by least squares, all but the mean stride length of the logarithm.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from laticauda.motion.gaits import GAIT_WORDS, Gait
from laticauda.values.errors import BadArgument

Values = Float[np.ndarray, " n_rows"]
Design = Float[np.ndarray, "n_rows n_parameters"]


@dataclass(frozen=True, kw_only=True)
class Row:
    """What a null model knows about a row of a table of speeds."""

    gait: Gait
    """The commanded gait."""
    has_fin: bool
    """Whether the robot wore the caudal fin."""

    @property
    def group(self) -> str:
        """Name of the group that the row belongs to."""
        return group_name(self.gait.kind, self.has_fin)


def group_name(gait: str, has_fin: bool) -> str:
    """Return the name that tables and files use for one gait with one configuration of the robot.

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
    """Form of the fit: numeric columns fitted to the speeds, or to their logarithms."""

    columns: Callable[[Sequence[Row], Sequence[str]], Design]
    """The columns of given rows, from the names of all groups."""
    is_stride: bool = False
    """Whether speeds per cycle are fitted: v proportional to the frequency."""
    is_log: bool = True
    """Whether logarithms are fitted."""


NULL_MODELS = {
    "constant per group": _Form(_per_group),
    "constant + fin + eel": _Form(_fin_and_eel),
    "constant stride per group": _Form(_per_group, is_stride=True),
    "constant stride + fin + eel": _Form(_fin_and_eel, is_stride=True),
}
"""Models without physics: one number per group, or one number and two factors; also for the distance per cycle."""
MEAN_STRIDE = "mean stride per group"
PREDICTORS = {**NULL_MODELS, MEAN_STRIDE: _Form(_per_group, is_stride=True, is_log=False)}
"""The null models, and the constant stride with the arithmetic, not the geometric, mean of each group's strides."""


def _fitted(
    form: _Form, rows: Sequence[Row], measured: Values, others: Sequence[Row]
) -> tuple[Float[np.ndarray, " n_others"], int, bool]:
    """Predict other rows by least squares; also return the number of fitted parameters and whether the rows suffice."""
    groups = sorted({row.group for row in (*rows, *others)})
    known, asked = form.columns(rows, groups), form.columns(others, groups)
    units = [
        np.array([row.gait.frequency if form.is_stride else 1.0 for row in some])
        for some in (rows, others)
    ]
    speeds = measured / units[0]
    numbers, _, rank, _ = np.linalg.lstsq(known, np.log(speeds) if form.is_log else speeds)
    found = asked @ numbers
    return (
        (np.exp(found) if form.is_log else found) * units[1],
        int(rank),
        bool(rank == known.shape[1]),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class NullModel:
    """How well speeds are predicted without physics."""

    name: str
    """Name of the model, one of `NULL_MODELS`."""
    n_parameters: int
    """Number of fitted parameters."""
    speeds: Values
    """Predictions of the speeds that the model is fitted to [m/s]."""
    fitted: float
    """Mean absolute error of these predictions [%]."""
    left_out: float
    """The same with each row predicted from the others; nan if they do not suffice [%]."""
    group_left_out: float
    """The same with each group predicted from the others; nan if they do not suffice [%]."""


def compared(rows: Sequence[Row], measured: Values) -> tuple[NullModel, ...]:
    """Fit every null model to the same speeds, and evaluate it on speeds that were left out of the fit.

    Args:
        rows: The rows that the models are fitted to.
        measured: Their measured speeds [m/s].
    """
    groups = np.unique([row.group for row in rows], return_inverse=True)[1]
    found: list[NullModel] = []
    for name, form in NULL_MODELS.items():
        speeds, n_parameters, _ = _fitted(form, rows, measured, rows)
        others = [_left_out(form, rows, measured, by) for by in (np.arange(len(rows)), groups)]
        errors = [
            np.nan if np.any(np.isnan(values)) else mape(measured, values) for values in others
        ]
        how: Any = {
            "fitted": mape(measured, speeds),
            "left_out": errors[0],
            "group_left_out": errors[1],
        }
        found.append(NullModel(name=name, n_parameters=n_parameters, speeds=speeds, **how))
    return tuple(found)


def _left_out(
    form: _Form, rows: Sequence[Row], measured: Values, by: Int[np.ndarray, " n_rows"]
) -> Values:
    """Predict each speed from the rows with another number in `by`; nan where they do not suffice."""
    found = np.full(measured.size, np.nan)
    for number in np.unique(by):
        out = by == number
        if out.all():  # no rows are left to predict it from
            break
        kept, asked = (
            [row for row, mine in zip(rows, some, strict=True) if mine] for some in (~out, out)
        )
        speeds, _, suffices = _fitted(form, kept, measured[~out], asked)
        if suffices:
            found[out] = speeds
    return found


def predict(
    name: str, rows: Sequence[Row], measured: Values, others: Sequence[Row]
) -> tuple[Float[np.ndarray, " n_others"], int]:
    """Predict the speeds of rows other than those that a null model is fitted to.

    Args:
        name: One of `PREDICTORS`.
        rows: The rows that the model is fitted to; they must contain every group of the others.
        measured: Their measured speeds [m/s].
        others: The rows to predict.

    Returns:
        The predicted speeds [m/s], and the number of fitted parameters.

    Raises:
        ValueError: If the others contain a group that the rows do not contain.
    """
    unknown = sorted({row.group for row in others} - {row.group for row in rows})
    if unknown:
        raise BadArgument(
            "rows", f"must hold every group of `others`, got none of {', '.join(unknown)}"
        )
    speeds, n_fitted, _ = _fitted(PREDICTORS[name], rows, measured, others)
    return speeds, n_fitted


def mape(measured: Float[np.ndarray, " _"], predicted: Float[np.ndarray, " _"]) -> float:
    """Compute the mean absolute percentage error, 100 mean |predicted - measured| / measured [%].

    Args:
        measured: Measured values, all > 0.
        predicted: Predicted values, in the same unit.

    Raises:
        ValueError: If there are no values, the numbers of values differ, or a measured value is not
            > 0.
    """
    if measured.size == 0 or measured.shape != predicted.shape:
        raise BadArgument(
            "predicted", f"must have {measured.size} values, at least 1, got {predicted.size}"
        )
    if not np.all(measured > 0.0):
        raise BadArgument("measured", f"must be > 0, got {np.min(measured)}")
    return 100.0 * float(np.mean(np.abs(predicted - measured) / measured))
