"""Choose the next trials that would say most about the unknowns: D-optimal design from the sensitivities.

Let y(x) be the predictions for trial i, with x the coordinates of the unknowns, and sigma the
standard deviations of its noise. The trial adds the information

    F_i = J^T J,    J = (dy/dx) / sigma,

and the covariance after several trials is the inverse of the total information, including that of
the present fit or of the priors. A design is built one trial at a time, each time with the trial
that raises the criterion most; then trials are exchanged for others as long as that raises it.
Federov, Theory of Optimal Experiments (1972); Atkinson, Donev, Tobias, Optimum Experimental
Designs, with SAS (2007).

Alternatively, `discriminate` chooses the next trials that would tell rival models apart (T-optimal
design). Let y be the predictions of a model m for some trials, in standard deviations of the noise,
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
    [1] H. Dette, V. B. Melas, R. Guchenko, Bayesian T-optimal discriminating designs, Ann. Stat. 43, 2015 (criterion of
        Atkinson and Fedorov, 1975, which was not consulted).
    [2] R. Guchenko, rodd: Optimal Discriminating Designs, manual of the R package, `tpopt`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from statistics import NormalDist

import numpy as np
from jaxtyping import Float

from laticauda.identify import identifiability, model, result
from laticauda.identify.candidates import rows_of
from laticauda.identify.measurements import Measurement
from laticauda.identify.problem import Problem
from laticauda.identify.unknowns import ResolvedUnknown
from laticauda.models.simulate.runner import Progress, silent
from laticauda.values.checks import check_choice, check_not_empty, check_whole_number
from laticauda.values.errors import BadArgument

CRITERIA = ("D", "A")
"""D: determinant of the information (volume of the region of possible values); A: mean variance."""
_FAINT = 1e-8  # information assumed where there is none, so that determinants exist
_ROUNDS = 20

Matrix = Float[np.ndarray, "n n"]


Judged = tuple[Measurement, Float[np.ndarray, " n"]]
"""A trial and the numbers by which it was judged."""


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
    """Trials in the order in which to do them, each with the standard deviations after it and all before it."""
    reasons: tuple[str, ...]
    """A sentence, with numbers, on what each trial contributes, and a final one on what swimming trials alone miss."""
    alone: tuple[Judged, ...]
    """Standard deviations after each candidate alone, best first."""
    swimming: Float[np.ndarray, " n_unknowns"] | None
    """Standard deviations after equally many swimming trials, the best; None if all candidates swim, or none [-]."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        return tuple(unknown.name for unknown in self.unknowns)

    @property
    def sigma(self) -> Float[np.ndarray, "n_steps n_unknowns"]:
        """Standard deviations after 0, 1, 2, ... trials [-]."""
        return np.array([self.before, *(sigma for _, sigma in self.steps)])


def design_experiment(
    problem: Problem,
    candidates: Sequence[Measurement],
    n_trials: int,
    *,
    values: Float[np.ndarray, " n_unknowns"] | None = None,
    information: Matrix | None = None,
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
    at = problem.start if values is None else values
    known = prior_information(problem, at) if information is None else information
    sizes = problem.sizes
    scale = np.outer(sizes, sizes)
    added = information_of(problem, candidates, at, progress) * scale
    score = _score(criterion, names)
    first = known * scale
    chosen = best_of(added, first, n_trials, score)
    totals = np.cumsum([first, *added[chosen]], axis=0)
    reasons = [
        f"{n}. {candidates[i].name} {_reason(problem.unknowns, so_far, added[i])}."
        for n, (i, so_far) in enumerate(zip(chosen, totals[:-1], strict=True), 1)
    ]
    sigma = [sigma_of(total) for total in totals]
    swimming = _swimming_alone(candidates, added, first, n_trials, score)
    order = sorted(range(len(candidates)), key=lambda i: -score(first + added[i]))
    return Design(
        unknowns=problem.unknowns,
        values=at,
        criterion=criterion if criterion in CRITERIA else f"sigma of {criterion}",
        before=sigma[0],
        steps=tuple(zip((candidates[i] for i in chosen), sigma[1:], strict=True)),
        reasons=(
            *reasons,
            *([] if swimming is None else [_missed(names, n_trials, swimming, sigma[-1])]),
        ),
        alone=tuple((candidates[i], sigma_of(first + added[i])) for i in order),
        swimming=swimming,
    )


def information_of(
    problem: Problem,
    candidates: Sequence[Measurement],
    values: Float[np.ndarray, " n_unknowns"],
    progress: Progress = silent,
) -> Float[np.ndarray, "n_candidates n_unknowns n_unknowns"]:
    """Return each candidate's information with respect to the coordinates; arguments as for `rows_of`."""
    found = [rows for _, rows in rows_of(problem, candidates, values, progress)]
    return np.array([identifiability.marginal(rows.T @ rows, range(values.size)) for rows in found])


def _swimming_alone(
    candidates: Sequence[Measurement],
    added: np.ndarray,
    known: Matrix,
    n_trials: int,
    score: Callable[[Matrix], float],
) -> np.ndarray | None:
    mine = [i for i, one in enumerate(candidates) if one.group == "swim"]
    if not mine or len(mine) == len(candidates):
        return None
    chosen = best_of(added[mine], known, n_trials, score)
    return sigma_of(known + np.sum(added[mine][chosen], axis=0))


def best_of(
    added: np.ndarray, known: np.ndarray, n_trials: int, score: Callable[[np.ndarray], float]
) -> list[int]:
    """Select candidates greedily, then by exchange, then order them greedily; return their indices in order.

    Args:
        added: Information of each candidate.
        known: Information known beforehand.
        n_trials: Number of trials to select.
        score: Function to maximize.
    """
    chosen: list[int] = []
    for _ in range(n_trials):
        total = known + sum((added[i] for i in chosen), np.zeros_like(known))
        chosen.append(int(np.argmax([score(total + one) for one in added])))
    greedy_first = chosen[0]
    for _ in range(_ROUNDS):
        is_better = False
        for place in range(n_trials):
            others = known + sum(
                (added[i] for k, i in enumerate(chosen) if k != place), np.zeros_like(known)
            )
            scores = np.array([score(others + one) for one in added])
            best = int(np.argmax(scores))
            if scores[best] > scores[chosen[place]] + 1e-9:
                chosen[place], is_better = best, True
        if not is_better:
            break
    # The order does not change the total information; best first shows the most.
    ordered: list[int] = []
    rest, total = list(chosen), known
    while rest:
        best = max(rest, key=lambda i: (score(total + added[i]), i == greedy_first))
        rest.remove(best)
        ordered.append(best)
        total = total + added[best]
    return ordered


def known_from(found: result.Fit) -> Matrix:
    """Return the information of a fit, priors included, with respect to the coordinates of its unknowns.

    Args:
        found: The fit.
    """
    factor = found.used_noise_factor if np.isfinite(found.used_noise_factor) else 1.0
    rows = model.scaled_jacobian(found.problem, found.best, factor)
    return rows.T @ rows + prior_information(found.problem, found.best)


def prior_information(problem: Problem, values: Float[np.ndarray, " n_unknowns"]) -> Matrix:
    """Return the information of the priors with respect to the coordinates.

    Args:
        problem: Provides the unknowns.
        values: Values of the unknowns.
    """
    rows = problem.prior_slopes(values)
    return rows.T @ rows


def sigma_of(information: Matrix) -> Float[np.ndarray, " n_unknowns"]:
    """Return the standard deviations of all unknowns, inf where nothing is known [-].

    Args:
        information: Information, in units of the sizes of the unknowns.
    """
    return identifiability.deviations(*identifiability.strengths(information))


def _score(criterion: str, names: Sequence[str]) -> Callable[[Matrix], float]:
    """Return the function to maximize."""

    def volume(information: Matrix) -> float:
        return 0.5 * float(np.linalg.slogdet(information + _FAINT * np.eye(len(information)))[1])

    def sharpness(information: Matrix) -> float:
        variances = np.diag(np.linalg.inv(information + _FAINT * np.eye(len(information))))
        return -0.5 * float(
            np.log(np.mean(variances) if criterion == "A" else variances[names.index(criterion)])
        )

    return volume if criterion == "D" else sharpness


def _reason(unknowns: Sequence[ResolvedUnknown], known: Matrix, added: Matrix) -> str:
    """Describe in words what a trial would contribute."""
    before, after = sigma_of(known), sigma_of(known + added)
    newly = [k for k in range(len(unknowns)) if before[k] >= identifiability.LIMIT > after[k]]
    if newly:
        words = [
            f"`{unknowns[k].name}` ({format_share(before[k])} before, {format_share(after[k])} after)"
            for k in newly
        ]
        return f"makes identifiable {' and '.join(words)}"
    finite = np.isfinite(before) & (before > 0.0)
    ratio = np.where(finite, after / np.where(finite, before, 1.0), 1.0)
    k = int(np.argmin(ratio))
    if ratio[k] <= 0.9:
        return f"shrinks most `{unknowns[k].name}`, from {format_share(before[k])} to {format_share(after[k])}"
    root = np.linalg.cholesky(known + _FAINT * np.eye(len(known)))
    half = np.linalg.solve(root, added)
    news = np.linalg.eigh(np.linalg.solve(root, half.T))[1][
        :, -1
    ]  # where it adds most to the known information
    return f"adds information on {identifiability.combination_of(root @ news, unknowns)}"


def _missed(names: Sequence[str], n: int, swimming: np.ndarray, after: np.ndarray) -> str:
    """Describe in numbers what straight trials contribute."""
    with np.errstate(invalid="ignore"):
        k = int(np.argmax(np.where(np.isfinite(swimming), swimming, 1e9) / after))
    words = f"After the best {n} swimming trials, `{names[k]}` is {format_share(swimming[k])}; after these {n}, "
    return f"{words}{format_share(after[k])}."


def format_share(sigma: float) -> str:
    """Format a relative standard deviation as text.

    Args:
        sigma: Relative standard deviation [-].
    """
    if not np.isfinite(sigma) or sigma > 10.0:
        return "unknown"
    return f"{100.0 * sigma:.2g} %" if sigma < 0.99 else f"{100.0 * sigma:.0f} %"


# ---- telling models apart ------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True, eq=False)
class Discrimination:
    """Trials that tell rival models apart, judged by T of every pair: the smaller of its two directions [-]."""

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
    rivals: Mapping[str, tuple[Problem, Sequence[Measurement]]],
    n_trials: int,
    *,
    progress: Progress = silent,
) -> Discrimination:
    """Choose the trials that would tell rival models apart.

    Args:
        rivals: For each model by name, its problem, judged at the starting values of the unknowns,
            and its version of
            the candidates: the same trials in all models, with the noise stated by the first.
        n_trials: Number of trials to choose; each may be chosen more than once.
        progress: Called with the fraction of the models judged.

    Raises:
        ValueError: If an argument is out of its range.
    """
    check_whole_number("n_trials", n_trials, 1)
    candidates: Sequence[Measurement] = next(iter(rivals.values()))[1] if rivals else ()
    if len(rivals) < 2 or not candidates:
        raise BadArgument(
            "rivals", f"must be at least two models with candidates, got {len(rivals)}"
        )
    seen: dict[str, list[tuple[np.ndarray, np.ndarray]]] = {}
    for name, (problem, same) in rivals.items():
        alike = [replace(a, figures=b.figures) for a, b in zip(same, candidates, strict=True)]
        seen[name] = rows_of(problem, alike, problem.start)
        progress(len(seen) / len(rivals))
    pairs = tuple(combinations(rivals, 2))
    ways = [*pairs, *((rival, true) for true, rival in pairs)]
    size = 1 + max(len(problem.unknowns) for problem, _ in rivals.values())
    added, known = (
        np.zeros((len(candidates), len(ways), size, size)),
        np.zeros((len(ways), size, size)),
    )
    for k, (true, rival) in enumerate(ways):
        problem = rivals[rival][0]
        n = 1 + len(problem.unknowns)
        known[k, 1:n, 1:n] = prior_information(problem, problem.start)
        for i, ((numbers, _), (others, rows)) in enumerate(
            zip(seen[true], seen[rival], strict=True)
        ):
            columns = np.column_stack((numbers - others, rows))
            added[i, k, :n, :n] = identifiability.marginal(columns.T @ columns, range(n))

    def judged(one: Measurement, total: np.ndarray) -> Judged:
        return one, np.min(np.reshape(_distances(total), (2, -1)), axis=0)

    chosen = best_of(added, known, n_trials, lambda total: -_worst(_distances(total)))
    alone = [
        judged(one, known + information) for one, information in zip(candidates, added, strict=True)
    ]
    totals = known + np.cumsum(added[chosen], axis=0)
    return Discrimination(
        pairs=pairs,
        steps=tuple(judged(candidates[i], total) for i, total in zip(chosen, totals, strict=True)),
        alone=tuple(sorted(alone, key=lambda one: _worst(one[1]))),
    )


def _distances(total: Float[np.ndarray, "n_ways n n"]) -> Float[np.ndarray, " n_ways"]:
    """Return T of every model and its rival."""
    return np.array([max(0.0, float(identifiability.marginal(one, [0])[0, 0])) for one in total])


def _worst(distances: Float[np.ndarray, " n"]) -> float:
    """Return the logarithm of the bound on the probability of a wrong verdict."""
    return float(np.logaddexp.reduce(-distances / 8.0))
