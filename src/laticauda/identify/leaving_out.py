"""Prediction of data that a fit did not see: refits without a measurement or a group."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from laticauda.identify import fitting
from laticauda.identify.model import predict, scaled_jacobian
from laticauda.identify.problem import Problem
from laticauda.identify.result import Fit
from laticauda.models.simulate import Progress, silent
from laticauda.values import BadArgument, check_choice

BY = ("measurement", "group")
"""What can be left out at a time."""
_SMALLEST_SINGULAR_VALUE = 1e-7
"""Singular values of the Jacobian below this share of the largest are rounding errors [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LeftOut:
    """Predictions of every measurement by a fit that did not see it."""

    by: str
    """What was left out at a time: one `measurement` or one `group`."""
    fit: Fit
    """The fit to all measurements."""
    predictions: Float[np.ndarray, " n_data"]
    """Predictions in the order of `Fit.predictions`.

    They are nan where the other measurements do not determine what they need.
    """
    values: Float[np.ndarray, "n_left_out n_unknowns"]
    """Identified values of each refit."""

    def percentage_error(self, figure: str = "forward_velocity") -> float:
        """Return the mean of |predicted - measured| / measured for a figure [%].

        It is nan if one value cannot be predicted.

        Args:
            figure: Name of the figure.
        """
        return self.fit.percentage_error(figure, self.predictions)


def leave_out(fit: Fit, by: str = "measurement", *, progress: Progress = silent) -> LeftOut:
    """Refit without each measurement, or without each group, and predict what was left out.

    The start state of a trial left out is taken from the fit to all, the only source for it.

    Args:
        fit: The fit to all; each refit starts from its values.
        by: measurement or group.
        progress: Called with the finished fraction.

    Raises:
        ValueError: If there is nothing left to fit to.
    """
    problem = fit.problem
    check_choice("by", by, BY)
    names = names_to_leave_out(problem, by)
    different_names = list(dict.fromkeys(names))
    if len(different_names) < 2:
        rule = f"must leave something to fit to, got `{by}`: all measurements are of `{names[0]}`"
        raise BadArgument("by", rule)
    predictions = np.full(problem.observed.size, np.nan)
    values: list[np.ndarray] = []
    for n_done, name in enumerate(different_names, start=1):
        left_out = [i for i, own_name in enumerate(names) if own_name == name]
        refit_values = _refit_without(fit, left_out)
        values.append(refit_values)
        if _is_determined_without(problem, left_out):
            predicted = predict(problem.part(left_out), refit_values).values
            predictions[np.isin(problem.owner, left_out)] = predicted
        progress(n_done / len(different_names))
    return LeftOut(by=by, fit=fit, predictions=predictions, values=np.array(values))


def names_to_leave_out(problem: Problem, by: str) -> list[str]:
    """Return what each measurement is left out with: its name, or its group.

    Args:
        problem: The problem.
        by: measurement or group.
    """
    if by == "measurement":
        return [measurement.name for measurement in problem.measurements]
    return list(problem.groups)


def _refit_without(fit: Fit, left_out: Sequence[int]) -> np.ndarray:
    """Return the values of a fit without some measurements.

    Starts that only they have are those of the fit to all.
    """
    remaining = fit.problem.part(_remaining(fit.problem, left_out))
    refit = fitting.solve(remaining, replace(fit.method, n_starts=1), start=fit.best)
    is_lost = _is_start_of(fit.problem, left_out) & ~remaining.depends_on.any(axis=0)
    return np.where(is_lost, fit.best, refit.best)


def _is_determined_without(problem: Problem, left_out: Sequence[int]) -> bool:
    """Return whether the other measurements, or priors, say something about all that is needed."""
    has_no_prior = np.array([unknown.prior is None for unknown in problem.unknowns])
    is_needed = problem.depends_on[left_out].any(axis=0)
    remaining = problem.depends_on[_remaining(problem, left_out)]
    is_seen = remaining.any(axis=0) | _is_start_of(problem, left_out)
    return not np.any(is_needed & ~is_seen & has_no_prior)


def _remaining(problem: Problem, left_out: Sequence[int]) -> list[int]:
    return [i for i in range(len(problem.measurements)) if i not in left_out]


def _is_start_of(problem: Problem, indices: Sequence[int]) -> np.ndarray:
    """Return which unknowns are start states of these measurements."""
    is_start = np.array([unknown.is_start for unknown in problem.unknowns])
    return problem.depends_on[indices].any(axis=0) & is_start


def linear_leave_one_out(fit: Fit) -> Float[np.ndarray, " n_data"]:
    """Predict every single number from the others with the linearized model, without any refit.

    With the leverage h, the diagonal of H = J (J^T J)^-1 J^T, the residual r of a number used in
    the fit becomes r / (1 - h) if that number is left out. The rows of the priors are among those
    of J, because priors are never left out. The noise is that of the fit, as if it were known
    beforehand, and all residuals count by their squares: with a robust loss, this is only an
    approximation.

    Args:
        fit: The fit.
    """
    problem = fit.problem
    data_rows = scaled_jacobian(problem, fit.best, fit.used_noise_factor)
    jacobian = np.concatenate([data_rows, problem.prior_slopes(fit.best)])
    # The columns of the basis that count span what J can reach, so that H is basis @ basis.T.
    basis, singular_values, _ = np.linalg.svd(jacobian, full_matrices=False)
    counts = singular_values > _SMALLEST_SINGULAR_VALUE * singular_values[0]
    basis_of_data = basis[: problem.observed.size, counts]
    leverage = np.sum(basis_of_data**2, axis=1)
    residuals = fit.predictions - problem.observed
    return problem.observed + residuals / (1.0 - leverage)
