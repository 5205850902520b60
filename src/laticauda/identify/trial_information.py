"""What trials would say about the unknowns: their information, of candidates, fits and priors.

All information is with respect to the coordinates of the unknowns, in standard deviations of the
noise: F = J^T J with the Jacobian J of the predictions.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from laticauda.identify.identifiability import (
    Information,
    compute_deviations,
    compute_spectrum,
    marginal,
)
from laticauda.identify.measurements import Measurement
from laticauda.identify.model import predict, scaled_jacobian
from laticauda.identify.problem import Problem, other_measurements, with_starts
from laticauda.identify.result import Fit
from laticauda.models.simulate import Progress, silent

_N_AT_ONCE = 64
"""Candidates that are simulated in one batch."""

Values = Float[np.ndarray, " n_unknowns"]


class CandidateRows(NamedTuple):
    """What one candidate would measure, in standard deviations of the noise."""

    numbers: Float[np.ndarray, " n_numbers"]
    """Predicted numbers; 0 for the priors on its start, which follow them."""
    jacobian: Float[np.ndarray, "n_numbers n_coordinates"]
    """Their derivatives by the coordinates of the unknowns, followed by those of its start."""
    is_yielded: Bool[np.ndarray, " n_numbers"]
    """Whether the run yields the number.

    A run may be too short for a figure, such as a steady velocity. Number and derivatives are then
    0: such a figure adds no information.
    """


def predict_candidates(
    problem: Problem,
    candidates: Sequence[Measurement],
    values: Values,
    progress: Progress = silent,
) -> list[CandidateRows]:
    """Predict each candidate's numbers and their derivatives with respect to the coordinates.

    The start of a candidate is unknown as in a fit, with rows for the priors on it.

    Args:
        problem: Provides the unknowns.
        candidates: The trials.
        values: Values of the unknowns.
        progress: Called with the finished fraction.

    Raises:
        ValueError: If a candidate cannot be simulated.
    """
    rows: list[CandidateRows] = []
    for begin in range(0, len(candidates), _N_AT_ONCE):
        rows += _predict_batch(problem, candidates[begin : begin + _N_AT_ONCE], values)
        progress(len(rows) / len(candidates))
    return rows


def _predict_batch(
    problem: Problem, candidates: Sequence[Measurement], values: Values
) -> list[CandidateRows]:
    """Predict some candidates at once.

    The unknowns of the batch are those of the problem, then the starts of all candidates. Of each
    candidate, only its own starts are returned: it depends on no others.
    """
    n_unknowns = values.size
    batch = with_starts(other_measurements(problem, candidates))
    values_and_starts = np.concatenate([values, batch.start[n_unknowns:]])
    predicted = predict(batch, values_and_starts)
    for name, status in predicted.failures.items():
        raise ValueError(
            f"`candidates` must be trials that can be simulated, got `{name}`: {status}"
        )
    numbers = predicted.values / batch.sigma
    jacobian = scaled_jacobian(batch, values_and_starts, predicted=predicted)
    is_yielded = np.isfinite(numbers) & np.all(np.isfinite(jacobian), axis=1)
    numbers[~is_yielded] = 0.0
    jacobian[~is_yielded] = 0.0
    prior_rows = batch.prior_slopes(values_and_starts)
    rows: list[CandidateRows] = []
    for i in range(len(candidates)):
        is_own_number = batch.owner == i
        # The columns of one candidate: the unknowns of the problem, then the starts of this trial.
        own_starts = n_unknowns + np.flatnonzero(batch.depends_on[i, n_unknowns:])
        columns = np.concatenate([np.arange(n_unknowns), own_starts])
        # Its rows: its numbers, then the priors on these starts.
        is_prior_of_own_start = np.any(prior_rows[:, own_starts] != 0.0, axis=1)
        own_priors = prior_rows[is_prior_of_own_start]
        n_priors = len(own_priors)
        own_jacobian = np.concatenate([jacobian[is_own_number], own_priors])
        own_rows = CandidateRows(
            numbers=np.concatenate([numbers[is_own_number], np.zeros(n_priors)]),
            jacobian=own_jacobian[:, columns],
            is_yielded=np.concatenate([is_yielded[is_own_number], np.ones(n_priors, dtype=bool)]),
        )
        rows.append(own_rows)
    return rows


def information_of(
    problem: Problem,
    candidates: Sequence[Measurement],
    values: Values,
    progress: Progress = silent,
) -> Float[np.ndarray, "n_candidates n_unknowns n_unknowns"]:
    """Return each candidate's information; arguments as for `predict_candidates`."""
    information: list[np.ndarray] = []
    for rows in predict_candidates(problem, candidates, values, progress):
        with_start = rows.jacobian.T @ rows.jacobian
        information.append(marginal(with_start, range(values.size)))
    return np.array(information)


def known_from(fit: Fit) -> Information:
    """Return the information of a fit about its unknowns, priors included.

    Args:
        fit: The fit.
    """
    jacobian = scaled_jacobian(fit.problem, fit.best, fit.used_noise_factor)
    return jacobian.T @ jacobian + prior_information(fit.problem, fit.best)


def prior_information(problem: Problem, values: Values) -> Information:
    """Return the information of the priors with respect to the coordinates.

    Args:
        problem: Provides the unknowns.
        values: Values of the unknowns.
    """
    rows = problem.prior_slopes(values)
    return rows.T @ rows


def deviations_after(information: Information) -> Float[np.ndarray, " n_unknowns"]:
    """Return the standard deviations of all unknowns, inf where nothing is known [-].

    Args:
        information: Information, in units of the sizes of the unknowns.
    """
    return compute_deviations(compute_spectrum(information))
