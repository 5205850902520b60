"""Choose the next trials that would tell rival models apart (T-optimal design).

Let y be the predictions of a model m for some trials, in standard deviations of the noise,
y' those of its rival m', J' the derivatives of y' with respect to the coordinates of its unknowns,
and P' the information of its priors. If m were true, the rival could be fitted to the trials except
for

    T = min_x (y - y' - J' x)^T (y - y' - J' x) + x^T P' x

T is the excess chi^2 of the rival, and T/2 the average loss that it causes in the rival's log Bayes
factor against m (Gaussian priors). T-optimal designs maximize T or, for several models, a weighted
sum over all pairs [1, 2]. T is also the Schur complement of the first column in the information of
the columns (y - y', J') of all trials, priors added: the information about the difference between
the two models while the rival's unknowns stay unknown. This information adds up like any other.
Unlike in [1], the rival's unknowns are assumed close enough for its predictions to be linear.

Choosing the model with the smaller chi^2 is wrong with probability Phi(-T^(1/2)/2). The chosen
trials minimize the sum of exp(-T/8) over all pairs, which bounds these probabilities up to a factor
(Bhattacharyya).

References:
    [1] H. Dette, V. B. Melas, R. Guchenko, Bayesian T-optimal discriminating designs, Ann. Stat.
        43, 2015 (criterion of Atkinson and Fedorov, 1975, which was not consulted).
    [2] R. Guchenko, rodd: Optimal Discriminating Designs, manual of the R package, `tpopt`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from statistics import NormalDist
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.identify.design import Judged
from laticauda.identify.identifiability import marginal
from laticauda.identify.measurements import Measurement
from laticauda.identify.problem import Problem
from laticauda.identify.selection import best_of
from laticauda.identify.trial_information import (
    CandidateRows,
    predict_candidates,
    prior_information,
)
from laticauda.models.simulate import Progress, silent
from laticauda.values import BadArgument, check_whole_number


class Rival(NamedTuple):
    """A model that might be true, and the trials as it sees them."""

    problem: Problem
    """Its unknowns; the model is judged at their starting values."""
    candidates: Sequence[Measurement]
    """Possible trials: the same in all models, each in this model's water."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Discrimination:
    """Trials that tell rival models apart, judged by T of every pair, the smaller of both ways."""

    pairs: tuple[tuple[str, str], ...]
    """All pairs of models."""
    steps: tuple[Judged, ...]
    """Trials in the order in which to do them, each with T after it and all before it."""
    alone: tuple[Judged, ...]
    """Each candidate alone, best first."""


def misidentification_probability(distance: float) -> float:
    """Return the probability that the wrong one of two models has the smaller chi^2.

    Args:
        distance: T [-].
    """
    return NormalDist().cdf(-0.5 * distance**0.5)


def discriminate(
    rivals: Mapping[str, Rival | tuple[Problem, Sequence[Measurement]]],
    n_trials: int,
    *,
    progress: Progress = silent,
) -> Discrimination:
    """Choose the trials that would tell rival models apart.

    Args:
        rivals: The models by name, or problem and candidates of each. What is measured of a trial,
            and its noise, is what the first model's candidate states.
        n_trials: Number of trials to choose; each may be chosen more than once.
        progress: Called with the fraction of the models judged.

    Raises:
        ValueError: If an argument is out of its range.
    """
    check_whole_number("n_trials", n_trials, 1)
    models = {name: Rival(*rival) for name, rival in rivals.items()}
    candidates = _candidates_of_first(models)
    rows_by_model: dict[str, list[CandidateRows]] = {}
    for name, model in models.items():
        measured_alike = [
            replace(own, figures=first.figures, time=first.time, series=first.series)
            for own, first in zip(model.candidates, candidates, strict=True)
        ]
        rows_by_model[name] = predict_candidates(model.problem, measured_alike, model.problem.start)
        progress(len(rows_by_model) / len(models))
    problems = {name: model.problem for name, model in models.items()}
    pairs = tuple(combinations(models, 2))
    comparisons = _both_ways(pairs)
    added = _added_information(comparisons, problems, rows_by_model)
    known = _known_information(comparisons, problems)

    def score(total: np.ndarray) -> float:
        return -_log_bound_of_mistake(_distances(total))

    chosen = best_of(added, known, n_trials, score)
    totals = known + np.cumsum(added[chosen], axis=0)
    steps: list[Judged] = []
    for i, total in zip(chosen, totals, strict=True):
        distances = _smaller_distances(pairs, comparisons, total)
        steps.append(Judged(trial=candidates[i], numbers=distances))
    alone: list[Judged] = []
    for candidate, own_information in zip(candidates, added, strict=True):
        distances = _smaller_distances(pairs, comparisons, known + own_information)
        alone.append(Judged(trial=candidate, numbers=distances))
    alone.sort(key=lambda judged: _log_bound_of_mistake(judged.numbers))
    return Discrimination(pairs=pairs, steps=tuple(steps), alone=tuple(alone))


class _Comparison(NamedTuple):
    """One direction of a pair: could the rival explain trials of the true model?"""

    true: str
    """Name of the model m that is assumed to be true."""
    rival: str
    """Name of the model m' that is fitted to its trials."""


def _both_ways(pairs: Sequence[tuple[str, str]]) -> list[_Comparison]:
    """Return the comparisons of all pairs: with the first model as true, then the second."""
    forward = [_Comparison(true=first, rival=second) for first, second in pairs]
    backward = [_Comparison(true=second, rival=first) for first, second in pairs]
    return forward + backward


def _candidates_of_first(rivals: Mapping[str, Rival]) -> Sequence[Measurement]:
    """Return the candidates as the first model has them."""
    candidates: Sequence[Measurement] = ()
    if rivals:
        candidates = next(iter(rivals.values())).candidates
    if len(rivals) < 2 or not candidates:
        rule = f"must be at least two models with candidates, got {len(rivals)}"
        raise BadArgument("rivals", rule)
    for name, rival in rivals.items():
        if len(rival.candidates) != len(candidates):
            rule = f"must have {len(candidates)} candidates, as the first model has"
            raise BadArgument(f"rivals[{name}]", f"{rule}, got {len(rival.candidates)}")
    return candidates


def _size_of_information(problems: Mapping[str, Problem]) -> int:
    """Return the size of all information matrices; models with fewer unknowns leave zeros."""
    return 1 + max(len(problem.unknowns) for problem in problems.values())


def _known_information(
    comparisons: Sequence[_Comparison], problems: Mapping[str, Problem]
) -> Float[np.ndarray, "n_comparisons n n"]:
    """Return the information of the rivals' priors P'; the difference, which is first, has none."""
    size = _size_of_information(problems)
    known = np.zeros((len(comparisons), size, size))
    for k, comparison in enumerate(comparisons):
        problem = problems[comparison.rival]
        n_columns = 1 + len(problem.unknowns)
        known[k, 1:n_columns, 1:n_columns] = prior_information(problem, problem.start)
    return known


def _added_information(
    comparisons: Sequence[_Comparison],
    problems: Mapping[str, Problem],
    rows_by_model: Mapping[str, Sequence[CandidateRows]],
) -> Float[np.ndarray, "n_candidates n_comparisons n n"]:
    """Return, of every candidate and comparison, the information of the columns (y - y', J').

    A number that one of the two models does not yield tells nothing about them.
    """
    size = _size_of_information(problems)
    n_candidates = len(rows_by_model[comparisons[0].true])
    added = np.zeros((n_candidates, len(comparisons), size, size))
    for k, comparison in enumerate(comparisons):
        n_columns = 1 + len(problems[comparison.rival].unknowns)
        for i in range(n_candidates):
            of_true = rows_by_model[comparison.true][i]
            of_rival = rows_by_model[comparison.rival][i]
            difference = of_true.numbers - of_rival.numbers
            of_both = of_true.is_yielded & of_rival.is_yielded
            columns = np.column_stack((difference, of_rival.jacobian))[of_both]
            information = marginal(columns.T @ columns, range(n_columns))
            added[i, k, :n_columns, :n_columns] = information
    return added


def _smaller_distances(
    pairs: Sequence[tuple[str, str]], comparisons: Sequence[_Comparison], total: np.ndarray
) -> Float[np.ndarray, " n_pairs"]:
    """Return T of every pair: the smaller one of both ways."""
    distance_of = dict(zip(comparisons, _distances(total), strict=True))
    smaller_distances: list[float] = []
    for first, second in pairs:
        if_first_is_true = distance_of[_Comparison(true=first, rival=second)]
        if_second_is_true = distance_of[_Comparison(true=second, rival=first)]
        smaller_distances.append(min(if_first_is_true, if_second_is_true))
    return np.array(smaller_distances)


def _distances(
    total: Float[np.ndarray, "n_comparisons n n"],
) -> Float[np.ndarray, " n_comparisons"]:
    """Return T of every comparison, the Schur complement of the difference."""
    distances: list[float] = []
    for information in total:
        of_difference = float(marginal(information, [0])[0, 0])
        distances.append(max(0.0, of_difference))
    return np.array(distances)


def _log_bound_of_mistake(distances: Float[np.ndarray, " n"]) -> float:
    """Return the logarithm of the sum of exp(-T/8), which bounds the probability of a mistake."""
    return float(np.logaddexp.reduce(-distances / 8.0))
