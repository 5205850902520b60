"""Null models: speeds predicted without physics, from the gait's name and frequency and the fin alone.

Each is fitted to measured speeds by least squares, all but the mean stride length of the logarithm.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.motion.gaits import GAIT_WORDS, Gait
from laticauda.values import BadArgument

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
    if has_fin:
        return f"{GAIT_WORDS[gait]}, with fin"
    return f"{GAIT_WORDS[gait]}, without fin"


def _number_per_group(rows: Sequence[Row], groups: Sequence[str]) -> Design:
    """Return a column per group, 1 for its rows."""
    group_of_row = np.array([[row.group] for row in rows])
    return (group_of_row == np.array(groups)).astype(float)


def _fin_and_eel(rows: Sequence[Row], groups: Sequence[str]) -> Design:
    """Return a column of ones, one for the fin, and one for eel-like motion."""
    columns: list[tuple[float, float, float]] = []
    for row in rows:
        is_eel_like = row.gait.kind == "eel_like"
        columns.append((1.0, float(row.has_fin), float(is_eel_like)))
    return np.array(columns)


class _Form(NamedTuple):
    """Form of the fit: numeric columns fitted to the speeds, or to their logarithms."""

    columns: Callable[[Sequence[Row], Sequence[str]], Design]
    """The columns of given rows, from the names of all groups."""
    is_stride: bool = False
    """Whether speeds per cycle are fitted: v proportional to the frequency."""
    is_log: bool = True
    """Whether logarithms are fitted."""


NULL_MODELS = {
    "constant per group": _Form(_number_per_group),
    "constant + fin + eel": _Form(_fin_and_eel),
    "constant stride per group": _Form(_number_per_group, is_stride=True),
    "constant stride + fin + eel": _Form(_fin_and_eel, is_stride=True),
}
"""Models without physics: one number per group, or one number and two factors; also for the distance per cycle."""
MEAN_STRIDE = "mean stride per group"
PREDICTORS = {**NULL_MODELS, MEAN_STRIDE: _Form(_number_per_group, is_stride=True, is_log=False)}
"""The null models, and the constant stride with the arithmetic, not the geometric, mean of each group's strides."""


class _Prediction(NamedTuple):
    """Speeds of rows, predicted by a fit to others."""

    speeds: Values
    """Predicted speeds [m/s]."""
    n_fitted: int
    """Number of fitted parameters."""
    is_determined: bool
    """Whether the rows suffice for all parameters."""


def _predict(
    form: _Form, rows: Sequence[Row], measured: Values, wanted_rows: Sequence[Row]
) -> _Prediction:
    """Fit a form to the measured speeds of rows by least squares, and predict the wanted ones."""
    groups = sorted({row.group for row in (*rows, *wanted_rows)})
    design = form.columns(rows, groups)
    observations = measured / _speed_units(form, rows)
    if form.is_log:
        observations = np.log(observations)
    numbers, _, rank, _ = np.linalg.lstsq(design, observations)
    predictions = form.columns(wanted_rows, groups) @ numbers
    if form.is_log:
        predictions = np.exp(predictions)
    return _Prediction(
        speeds=predictions * _speed_units(form, wanted_rows),
        n_fitted=int(rank),
        is_determined=bool(rank == design.shape[1]),
    )


def _speed_units(form: _Form, rows: Sequence[Row]) -> Values:
    """Return what the speeds of rows are divided by: their frequencies, or 1."""
    if not form.is_stride:
        return np.ones(len(rows))
    return np.array([row.gait.frequency for row in rows])


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
    group_of_row = np.unique([row.group for row in rows], return_inverse=True)[1]
    each_row = np.arange(len(rows))
    models: list[NullModel] = []
    for name, form in NULL_MODELS.items():
        fit = _predict(form, rows, measured, rows)
        without_row = _predict_left_out(form, rows, measured, each_row)
        without_group = _predict_left_out(form, rows, measured, group_of_row)
        model = NullModel(
            name=name,
            n_parameters=fit.n_fitted,
            speeds=fit.speeds,
            fitted=mape(measured, fit.speeds),
            left_out=_error_if_complete(measured, without_row),
            group_left_out=_error_if_complete(measured, without_group),
        )
        models.append(model)
    return tuple(models)


def _predict_left_out(
    form: _Form, rows: Sequence[Row], measured: Values, by: Int[np.ndarray, " n_rows"]
) -> Values:
    """Predict each speed from the rows with another number in `by`; nan where they do not suffice."""
    speeds = np.full(measured.size, np.nan)
    for number in np.unique(by):
        is_left_out = by == number
        if is_left_out.all():  # no rows are left to predict it from
            break
        prediction = _predict(
            form,
            rows=_rows_where(~is_left_out, rows),
            measured=measured[~is_left_out],
            wanted_rows=_rows_where(is_left_out, rows),
        )
        if prediction.is_determined:
            speeds[is_left_out] = prediction.speeds
    return speeds


def _rows_where(is_chosen: Bool[np.ndarray, " n_rows"], rows: Sequence[Row]) -> list[Row]:
    return [rows[i] for i in np.flatnonzero(is_chosen).tolist()]


def _error_if_complete(measured: Values, predicted: Values) -> float:
    """Return the mean absolute error [%]; nan if a prediction is missing."""
    if np.any(np.isnan(predicted)):
        return np.nan
    return mape(measured, predicted)


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
    prediction = _predict(PREDICTORS[name], rows, measured, others)
    return prediction.speeds, prediction.n_fitted


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
