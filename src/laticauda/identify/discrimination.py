"""Which next trials would tell rival models apart: a T-optimal choice.

Let y be what a model m predicts of some trials, in standard deviations of the noise, and y' what its rival m' does, J'
the derivatives of that to the coordinates of its unknowns, P' the information of its priors. Were m true, the rival
could be fitted to the trials but for

    T = min_x (y - y' - J' x)^T (y - y' - J' x) + x^T P' x

That is how much worse it would do in chi^2, and T/2 what its logarithmic Bayes factor against m loses by it on average
(Gaussian priors). T-optimal designs make it great, for several models a weighted sum of all pairs [1, 2]. With the
information of the columns (y - y', J') of all trials, priors added, it is what a Schur complement leaves of the first
one: information about the difference of the two models where the unknowns of the rival stay unknown. So it adds up as
all information does. Unlike in [1], the rival's unknowns are taken as near to where its predictions are linear.

The verdict of who has the smaller chi^2 is wrong with the chance Phi(-T^(1/2)/2). Chosen are the trials for which the
sum of exp(-T/8) over all pairs is least, to which these chances are bounded but for a factor (Bhattacharyya).

References:
    [1] H. Dette, V. B. Melas, R. Guchenko, Bayesian T-optimal discriminating designs, Ann. Stat. 43, 2015 (criterion of
        Atkinson and Fedorov, 1975, which was not read).
    [2] R. Guchenko, rodd: Optimal Discriminating Designs, manual of the R package, `tpopt`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from statistics import NormalDist

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument, whole
from laticauda.identify import design, identifiability
from laticauda.identify.candidates import rows_of
from laticauda.identify.measurements import Measurement
from laticauda.identify.problem import Problem
from laticauda.simulate.runner import Progress


@dataclass(frozen=True, kw_only=True, eq=False)
class Discrimination:
    """Trials that tell rival models apart, by T of every pair: the less of the two ways to take it [-]."""

    pairs: tuple[tuple[str, str], ...]
    """Every two models."""
    steps: tuple[design.Judged, ...]
    """The trials in the order in which they should be done, and T after each and all before it."""
    alone: tuple[design.Judged, ...]
    """Every candidate by itself, the best first."""


def wrong(distance: float) -> float:
    """Chance that the wrong one of two models has the smaller chi^2.

    Args:
        distance: T [-].
    """
    return NormalDist().cdf(-0.5 * distance**0.5)


def discriminate(
    rivals: Mapping[str, tuple[Problem, Sequence[Measurement]]], n_trials: int, *, progress: Progress | None = None
) -> Discrimination:
    """Choose the trials that would tell rival models apart.

    Args:
        rivals: By name: the unknowns of a model, at whose values it is judged, and the candidates as it has them: the
            same trials in all models, with the noise that the first one says.
        n_trials: How many are to be chosen; one may be chosen again.
        progress: Called with the share of the models that is judged.

    Raises:
        ValueError: If an argument is out of its range.
    """
    whole("n_trials", n_trials, 1)
    candidates: Sequence[Measurement] = next(iter(rivals.values()))[1] if rivals else ()
    if len(rivals) < 2 or not candidates:
        raise BadArgument("rivals", f"must be at least two models with candidates, got {len(rivals)}")
    seen: dict[str, list[tuple[np.ndarray, np.ndarray]]] = {}
    for name, (problem, same) in rivals.items():
        alike = [replace(a, figures=b.figures) for a, b in zip(same, candidates, strict=True)]
        seen[name] = rows_of(problem, alike, problem.start)
        if progress is not None:
            progress(len(seen) / len(rivals))
    pairs = tuple(combinations(rivals, 2))
    ways = [*pairs, *((rival, true) for true, rival in pairs)]
    size = 1 + max(len(problem.unknowns) for problem, _ in rivals.values())
    added, known = np.zeros((len(candidates), len(ways), size, size)), np.zeros((len(ways), size, size))
    for k, (true, rival) in enumerate(ways):
        problem = rivals[rival][0]
        n = 1 + len(problem.unknowns)
        known[k, 1:n, 1:n] = design.prior_information(problem, problem.start)
        for i, ((numbers, _), (others, rows)) in enumerate(zip(seen[true], seen[rival], strict=True)):
            columns = np.column_stack((numbers - others, rows))
            added[i, k, :n, :n] = identifiability.marginal(columns.T @ columns, range(n))

    def judged(one: Measurement, total: np.ndarray) -> design.Judged:
        return one, np.min(np.reshape(_distances(total), (2, -1)), axis=0)

    chosen = design.best_of(added, known, n_trials, lambda total: -_worst(_distances(total)))
    alone = [judged(one, known + information) for one, information in zip(candidates, added, strict=True)]
    totals = known + np.cumsum(added[chosen], axis=0)
    return Discrimination(
        pairs=pairs,
        steps=tuple(judged(candidates[i], total) for i, total in zip(chosen, totals, strict=True)),
        alone=tuple(sorted(alone, key=lambda one: _worst(one[1]))),
    )


def _distances(total: Float[np.ndarray, "n_ways n n"]) -> Float[np.ndarray, " n_ways"]:
    """T of every model and its rival."""
    return np.array([max(0.0, float(identifiability.marginal(one, [0])[0, 0])) for one in total])


def _worst(distances: Float[np.ndarray, " n"]) -> float:
    """Logarithm of what bounds the chance of a wrong verdict."""
    return float(np.logaddexp.reduce(-distances / 8.0))
