"""Which of many candidates to choose, by any criterion that grows with their information."""

from collections.abc import Callable, Sequence

import numpy as np

from laticauda.identify.identifiability import Information

CRITERIA = ("D", "A")
"""D: determinant of the information (volume of the region of possible values); A: mean variance."""
FAINT = 1e-8
"""Information assumed where there is none, so that determinants exist [-]."""
_N_EXCHANGES = 20
"""Rounds in which trials are exchanged at most."""
_BETTER = 1e-9
"""Rise of the criterion below which an exchange is not worth it: rounding errors [-]."""

Score = Callable[[np.ndarray], float]
"""Function of the total information that a choice maximizes."""


def score_of(criterion: str, names: Sequence[str]) -> Score:
    """Return the function of the information to maximize.

    Args:
        criterion: One of `CRITERIA`, or the name of an unknown, for its standard deviation alone.
        names: Names of the unknowns.
    """

    def log_volume(information: Information) -> float:
        regular = information + FAINT * np.eye(len(information))
        _, log_determinant = np.linalg.slogdet(regular)
        return 0.5 * float(log_determinant)

    def log_sharpness(information: Information) -> float:
        variances = np.diag(np.linalg.inv(information + FAINT * np.eye(len(information))))
        if criterion == "A":
            variance = np.mean(variances)
        else:
            variance = variances[names.index(criterion)]
        return -0.5 * float(np.log(variance))

    if criterion == "D":
        return log_volume
    return log_sharpness


def best_of(added: np.ndarray, known: np.ndarray, n_trials: int, score: Score) -> list[int]:
    """Return the indices of the best candidates, best first.

    They are selected greedily, then by exchange, then ordered greedily.

    Args:
        added: Information of each candidate.
        known: Information known beforehand.
        n_trials: Number of trials to select.
        score: Function to maximize.
    """
    greedy_choice = _choose_greedily(added, known, n_trials, score)
    chosen = _exchange(greedy_choice, added, known, score)
    return _order_best_first(chosen, added, known, score, preferred=greedy_choice[0])


def _choose_greedily(
    added: np.ndarray, known: np.ndarray, n_trials: int, score: Score
) -> list[int]:
    """Choose one trial after the other, each time the one that raises the score most."""
    chosen: list[int] = []
    for _ in range(n_trials):
        total = _total(added, known, chosen)
        scores = [score(total + information) for information in added]
        chosen.append(int(np.argmax(scores)))
    return chosen


def _exchange(
    greedy_choice: Sequence[int], added: np.ndarray, known: np.ndarray, score: Score
) -> list[int]:
    """Exchange single trials for others as long as that raises the score."""
    chosen = list(greedy_choice)
    for _ in range(_N_EXCHANGES):
        is_better = False
        for position in range(len(chosen)):
            without_it = _total(added, known, chosen[:position] + chosen[position + 1 :])
            scores = np.array([score(without_it + information) for information in added])
            best = int(np.argmax(scores))
            if scores[best] > scores[chosen[position]] + _BETTER:
                chosen[position] = best
                is_better = True
        if not is_better:
            break
    return chosen


def _order_best_first(
    chosen: Sequence[int], added: np.ndarray, known: np.ndarray, score: Score, *, preferred: int
) -> list[int]:
    """Order trials such that the first ones say most; together they say the same in any order."""
    ordered: list[int] = []
    remaining = list(chosen)
    total = known
    while remaining:
        ranks = [(score(total + added[i]), i == preferred) for i in remaining]
        best = remaining.pop(ranks.index(max(ranks)))
        ordered.append(best)
        total = total + added[best]
    return ordered


def _total(added: np.ndarray, known: np.ndarray, chosen: Sequence[int]) -> np.ndarray:
    """Return the information after the chosen trials."""
    of_trials = np.zeros_like(known)
    for i in chosen:
        of_trials = of_trials + added[i]
    return known + of_trials
