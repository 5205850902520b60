"""How the references were found: CMA-ES searches for the gait and integral law of a scenario, in separate episodes."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from laticauda_gym.packages import needed
from laticauda_swimbench.challenges import Challenge, challenge
from laticauda_swimbench.methods import Method, law_pilot, method
from laticauda_swimbench.scoring import results

TUNING = 2_000_000
"""Seed of the search's first episode; no episode of the search is scored, nor learned from in training runs 1 to 18."""
EPISODES = 16
"""Episodes of a search; the references of `path` and `speed` were found in 24, as their files say."""
LAWS: dict[str, tuple[float, float]] = {
    "look_ahead_distance": (0.05, 2.0),
    "integral_gain": (1e-3, 0.1),
    "gain": (0.1, 2.0),
}
"""Ranges in which the numbers of the law are searched for, on a logarithmic scale [SI]."""


START = (0.5, 0.5, 0.5, 0.4, 0.4, 0.5)
"""Point of the unit cube at which a search begins."""
SPREAD = 0.25
"""Standard deviation of the first points around it."""
N_GAIT_NUMBERS = 3
"""How many coordinates of a point are the gait's; the others are the law's."""


def _numbers_at(challenge: Challenge, point: np.ndarray) -> dict[str, float]:
    """Return gait and law at a point of the unit cube."""
    task = challenge.tasks[0]
    shares = np.clip(point, 0.0, 1.0).tolist()
    numbers = dict[str, float]()
    gait_shares = shares[:N_GAIT_NUMBERS]
    for action, share in zip(task.actions[:N_GAIT_NUMBERS], gait_shares, strict=True):
        numbers[action.name] = action.low + share * (action.high - action.low)
    for (name, (low, high)), share in zip(LAWS.items(), shares[N_GAIT_NUMBERS:], strict=True):
        numbers[name] = math.exp(math.log(low) + share * math.log(high / low))
    return {**numbers, "max_offset": task.max_offset}


def search(
    name: str, evaluations: int, tell: Callable[[str], None], seed: int = 1
) -> dict[str, float]:
    """Return the numbers with the highest mean J in the tuning episodes.

    Args:
        name: Name of the scenario.
        evaluations: Number of passes over all tuning episodes.
        tell: Called now and then with a line of text.
        seed: Seed of the search.

    Raises:
        NotInstalled: If cma is not installed.
    """
    cma = needed("The search", "cma")
    searched = challenge(name)
    seeds = tuple(range(TUNING, TUNING + EPISODES))

    def cost(point: np.ndarray) -> float:
        method = _method_of(_numbers_at(searched, point))
        distance_outside = point - np.clip(point, 0.0, 1.0)
        return -_mean_objective(name, method, seeds) + float(np.sum(distance_outside**2))

    options: dict[str, Any] = {
        "seed": seed,
        "maxfevals": evaluations,
        "verbose": -9,
        "popsize": 10,
    }
    strategy = cma.CMAEvolutionStrategy(list(START), SPREAD, options)
    while not strategy.stop():
        points = strategy.ask()
        strategy.tell(points, [cost(np.asarray(point)) for point in points])
        best = -strategy.result.fbest
        tell(f"{name}: {strategy.result.evaluations} evaluations, J = {best:.5f} m/s")
    return _numbers_at(searched, np.asarray(strategy.result.xbest))


def _method_of(numbers: dict[str, float]) -> Method:
    return Method(name="searched", kind="law", sha256="", pilot=law_pilot(numbers))


def _mean_objective(name: str, method: Method, seeds: tuple[int, ...] | None = None) -> float:
    """Return the mean J of a method in episodes of a scenario [m/s]; seeds as for `results`."""
    objectives = [result["objective"] for result in results(name, method, seeds)]
    return float(np.mean(objectives))


class Ends(NamedTuple):
    """The two values of J between which a score goes from 0 to 1."""

    baseline: float
    """J_0, of the open loop [m/s]."""
    reference: float
    """J_1, of the reference [m/s]."""


def ends(name: str, numbers: dict[str, float]) -> Ends:
    """Return J_0 and J_1 of a scenario: means of the open loop and the reference over the scored episodes [m/s].

    Args:
        name: Name of the scenario.
        numbers: Numbers of the reference.
    """
    return Ends(
        baseline=_mean_objective(name, method("open-loop")),
        reference=_mean_objective(name, _method_of(numbers)),
    )
