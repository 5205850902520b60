"""Choose the next trials that would say most about the unknowns (D-optimal design).

Let y(x) be the predictions for trial i, with x the coordinates of the unknowns, and sigma the
standard deviations of its noise. The trial adds the information

    F_i = J^T J,    J = (dy/dx) / sigma,

and the covariance after several trials is the inverse of the total information, including that of
the present fit or of the priors. A design is built one trial at a time, each time with the trial
that raises the criterion most; then trials are exchanged for others as long as that raises it.
Federov, Theory of Optimal Experiments (1972); Atkinson, Donev, Tobias, Optimum Experimental
Designs, with SAS (2007). Trials that tell rival models apart are chosen by
`laticauda.identify.discrimination`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.identify.identifiability import Information
from laticauda.identify.measurements import Measurement
from laticauda.identify.problem import Problem
from laticauda.identify.reasons import describe_contribution, describe_missed
from laticauda.identify.selection import CRITERIA, Score, best_of, score_of
from laticauda.identify.trial_information import deviations_after, information_of, prior_information
from laticauda.identify.unknowns import ResolvedUnknown
from laticauda.models.simulate import Progress, silent
from laticauda.values import (
    BadArgument,
    check_choice,
    check_not_empty,
    check_whole_number,
    show_value,
)
from laticauda.values.packaging import renamed_names


class Judged(NamedTuple):
    """A trial and the numbers by which it was judged."""

    trial: Measurement
    """The trial."""
    numbers: Float[np.ndarray, " n"]
    """Standard deviations of the unknowns after it, or T of every pair of models [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Design:
    """Recommended next trials, best first, and what they are expected to determine.

    Standard deviations are relative to the unknown's value or to its size, and inf where nothing is
    known [-].
    """

    unknowns: tuple[ResolvedUnknown, ...]
    """Unknowns to be identified."""
    values: Float[np.ndarray, " n_unknowns"]
    """Values of the unknowns at which the trials were judged."""
    criterion: str
    """One of `CRITERIA`, or `sigma of` and the name of an unknown."""
    before: Float[np.ndarray, " n_unknowns"]
    """Standard deviations without any of the trials [-]."""
    steps: tuple[Judged, ...]
    """Trials in the order in which to do them, with the standard deviations after each."""
    reasons: tuple[str, ...]
    """A sentence on what each trial contributes, and a last one on what swimming trials miss."""
    alone: tuple[Judged, ...]
    """Standard deviations after each candidate alone, best first."""
    swimming: Float[np.ndarray, " n_unknowns"] | None
    """Standard deviations after equally many swimming trials, the best [-].

    None if all candidates swim, or none.
    """

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        return tuple(unknown.name for unknown in self.unknowns)

    @property
    def sigma(self) -> Float[np.ndarray, "n_steps n_unknowns"]:
        """Standard deviations after 0, 1, 2, ... trials [-]."""
        return np.array([self.before, *(step.numbers for step in self.steps)])


def design_experiment(
    problem: Problem,
    candidates: Sequence[Measurement],
    n_trials: int,
    *,
    values: Float[np.ndarray, " n_unknowns"] | None = None,
    information: Information | None = None,
    criterion: str = "D",
    progress: Progress = silent,
) -> Design:
    """Choose the trials that would reduce the uncertainty most.

    Args:
        problem: Provides the unknowns; its measurements are ignored in favor of `information`.
        candidates: Possible trials; each may be chosen more than once.
        n_trials: Number of trials to choose.
        values: Values of the unknowns at which the trials are judged; None: the starting values of
            their search.
        information: Existing information with respect to the coordinates: `known_from` a fit; None:
            the priors.
        criterion: D, A, or the name of an unknown, for its standard deviation alone.
        progress: Called with the fraction of the candidates judged.

    Raises:
        ValueError: If an argument is out of its range.
    """
    check_whole_number("n_trials", n_trials, 1)
    check_not_empty("candidates", candidates, "trial")
    names = problem.names
    check_choice("criterion", criterion, (*CRITERIA, *names))
    if values is None:
        values = problem.start
    _check_shape("values", values, (len(names),))
    if information is None:
        information = prior_information(problem, values)
    _check_shape("information", information, (len(names), len(names)))
    scale = np.outer(problem.sizes, problem.sizes)
    added = information_of(problem, candidates, values, progress) * scale
    known = information * scale
    score = score_of(criterion, names)
    chosen = best_of(added, known, n_trials, score)
    totals = np.cumsum([known, *added[chosen]], axis=0)
    deviations = [deviations_after(total) for total in totals]
    steps: list[Judged] = []
    reasons: list[str] = []
    for n_before, i in enumerate(chosen):
        trial = candidates[i]
        contribution = describe_contribution(problem.unknowns, totals[n_before], added[i])
        steps.append(Judged(trial=trial, numbers=deviations[n_before + 1]))
        reasons.append(f"{n_before + 1}. {trial.name} {contribution}.")
    swimming = _after_best_swims(candidates, added, known, n_trials, score)
    if swimming is not None:
        reasons.append(describe_missed(names, n_trials, swimming, deviations[-1]))
    return Design(
        unknowns=problem.unknowns,
        values=values,
        criterion=criterion if criterion in CRITERIA else f"sigma of {criterion}",
        before=deviations[0],
        steps=tuple(steps),
        reasons=tuple(reasons),
        alone=_judge_alone(candidates, added, known, score),
        swimming=swimming,
    )


def _judge_alone(
    candidates: Sequence[Measurement], added: np.ndarray, known: Information, score: Score
) -> tuple[Judged, ...]:
    """Return the standard deviations after each candidate alone, best first."""
    best_first = sorted(range(len(candidates)), key=lambda i: -score(known + added[i]))
    return tuple(
        Judged(trial=candidates[i], numbers=deviations_after(known + added[i])) for i in best_first
    )


def _check_shape(name: str, numbers: np.ndarray, shape: tuple[int, ...]) -> None:
    """Reject numbers that are not one for each unknown, or one for each pair of them."""
    if np.shape(numbers) != shape:
        rule = f"must be an array of {' x '.join(map(str, shape))} numbers"
        raise BadArgument(name, f"{rule}, got {show_value(numbers)}")


def _after_best_swims(
    candidates: Sequence[Measurement],
    added: np.ndarray,
    known: Information,
    n_trials: int,
    score: Score,
) -> np.ndarray | None:
    """Return the standard deviations after the best swimming trials; None if all or none swim."""
    swims = [i for i, candidate in enumerate(candidates) if candidate.swims]
    if not swims or len(swims) == len(candidates):
        return None
    added_by_swims = added[swims]
    chosen = best_of(added_by_swims, known, n_trials, score)
    return deviations_after(known + np.sum(added_by_swims[chosen], axis=0))


# Names of 0.2, for one release.
__getattr__ = renamed_names(__name__, {"design": "design_experiment"})
