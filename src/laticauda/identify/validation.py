"""Can the model predict what it was not fitted to? Refits without one measurement or one group, beside null models."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.errors import one_of
from laticauda.gaits import GAIT_WORDS
from laticauda.identify.fitting import refitted
from laticauda.identify.model import predict
from laticauda.identify.result import Fit
from laticauda.identify.searching import slopes_of
from laticauda.simulate.runner import Progress
from laticauda.trial import null_models
from laticauda.trial.null_models import Row, left_out, mape

BY = ("measurement", "group")


@dataclass(frozen=True, kw_only=True, eq=False)
class LeftOut:
    """Every measurement as a fit predicts it that did not see it."""

    by: str
    """What was left out together: one `measurement` at a time, or one `group`."""
    fit: Fit
    """The fit to all."""
    predictions: Float[np.ndarray, " n_data"]
    """As `Fit.predictions`; nan where the others do not say what the prediction needs."""
    values: Float[np.ndarray, "n_left_out n_unknowns"]
    """What was identified each time."""

    def percentage_error(self, figure: str = "forward_velocity") -> float:
        """Mean of |predicted - measured| / measured over the measurements of a figure; nan if one cannot be predicted.

        Args:
            figure: Its name.
        """
        at = figure_places(self.fit, figure)
        if np.any(np.isnan(self.predictions[at])):
            return float("nan")
        return mape(self.fit.problem.observed[at], self.predictions[at])


@dataclass(frozen=True, kw_only=True)
class NullModel:
    """How well speeds are predicted without physics."""

    name: str
    """Which of `trial.null_models`."""
    n_parameters: int
    """How many numbers are fitted."""
    fitted: float
    """Mean error over the measurements that it is fitted to [%]."""
    left_out: float
    """The same with each one predicted by the others; nan if they do not suffice [%]."""
    group_left_out: float
    """The same with each group predicted by the others [%]."""


def leave_out(found: Fit, by: str = "measurement", *, progress: Progress | None = None) -> LeftOut:
    """Refit without each measurement, or without each group, and predict what was left out.

    Args:
        found: The fit to all; each refit begins at its values.
        by: measurement or group.
        progress: Called with the share that is finished.

    Raises:
        ValueError: If there is nothing left to fit to.
    """
    put = found.problem
    names = [m.name for m in put.measurements] if one_of("by", by, BY) == "measurement" else list(put.groups)
    different = list(dict.fromkeys(names))
    if len(different) < 2:
        raise ValueError(f"`by` must leave something to fit to, got `{by}`: all measurements are of `{names[0]}`.")
    predictions = np.full(put.observed.size, np.nan)
    values: list[np.ndarray] = []
    for number, name in enumerate(different):
        out = [i for i, other in enumerate(names) if other == name]
        rest = put.part([i for i in range(len(names)) if i not in out])
        refit = refitted(found, rest)
        values.append(np.array(list(refit.values.values())))
        if not _lacks(found, out, rest.moves):
            predictions[np.isin(put.owner, out)] = predict(put.part(out), values[-1]).values
        if progress is not None:
            progress((number + 1) / len(different))
    return LeftOut(by=by, fit=found, predictions=predictions, values=np.array(values))


def _lacks(found: Fit, out: Sequence[int], moves: np.ndarray) -> bool:
    """Whether what was left out depends on an unknown of which nothing else says anything."""
    put = found.problem
    without_prior = np.array([unknown.prior is None for unknown in put.unknowns])
    return bool(np.any(put.moves[list(out)].any(axis=0) & ~moves.any(axis=0) & without_prior))


def linear_leave_one_out(found: Fit) -> Float[np.ndarray, " n_data"]:
    """Predictions of every single number by the others, as the linearized model has them, without any refit.

    With the leverage h, the diagonal of H = J (J^T J)^-1 J^T, a residual r of a number that takes part in the fit is
    r / (1 - h) if it does not.

    Args:
        found: The fit.
    """
    put = found.problem
    values = np.array(list(found.values.values()))
    jacobian = predict(put, values, jacobian=True).jacobian
    assert jacobian is not None
    scaled = jacobian / put.sigma[:, np.newaxis]
    basis, strength, _ = np.linalg.svd(scaled * slopes_of(put, values), full_matrices=False)
    leverage = np.sum(basis[:, strength > 1e-7 * strength[0]] ** 2, axis=1)
    return put.observed + (found.predictions - put.observed) / (1.0 - leverage)


def compared_with_null_models(found: Fit) -> tuple[NullModel, ...]:
    """Null models fitted to the same speeds; none for gaits that they do not know, or without speeds.

    Args:
        found: The fit.
    """
    put = found.problem
    if not any("forward_velocity" in measurement.figures for measurement in put.measurements):
        return ()
    at = figure_places(found, "forward_velocity")
    settings = [put.settings[int(i)] for i in put.owner[at]]
    if any(setting.gait.kind not in GAIT_WORDS for setting in settings):
        return ()
    rows = [Row(gait=setting.gait, has_fin=setting.robot.caudal_fin is not None) for setting in settings]
    groups = sorted({row.group for row in rows})
    by_row, by_group = np.arange(len(rows)), np.array([groups.index(row.group) for row in rows])
    measured = put.observed[at]
    result: list[NullModel] = []
    for name in null_models.NULL_MODELS:
        columns, known = null_models.design(name, rows, groups)
        target = np.log(measured) - known
        fitted = np.exp(columns @ null_models.fit(columns, target) + known)
        errors = [_error(measured, np.exp(left_out(columns, target, by) + known)) for by in (by_row, by_group)]
        result.append(
            NullModel(
                name=name,
                n_parameters=int(np.linalg.matrix_rank(columns)),
                fitted=mape(measured, fitted),
                left_out=errors[0],
                group_left_out=errors[1],
            )
        )
    return tuple(result)


def _error(measured: np.ndarray, predicted: np.ndarray) -> float:
    return float("nan") if np.any(np.isnan(predicted)) else mape(measured, predicted)


def figure_places(found: Fit, figure: str) -> np.ndarray:
    """Where a figure of every measurement that has it stands among the data.

    Args:
        found: The fit.
        figure: Its name.

    Raises:
        ValueError: If no measurement has it.
    """
    put = found.problem
    places: list[int] = []
    for i, measurement in enumerate(put.measurements):
        if figure in measurement.figures:
            places.append(int(np.argmax(put.owner == i)) + list(measurement.figures).index(figure))
    if not places:
        raise ValueError(f"`figure` must be one that was measured, got {figure!r}.")
    return np.array(places)
