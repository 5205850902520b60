"""How the references were found: CMA-ES searches for the gait and integral law of a scenario, in separate episodes."""

import math
from collections.abc import Callable
from typing import Any

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


def _numbers(one: Challenge, at: np.ndarray) -> dict[str, float]:
    """Return gait and law at a point of the unit cube."""
    task = one.tasks[0]
    share = np.clip(at, 0.0, 1.0).tolist()
    gait = {
        each.name: each.low + s * (each.high - each.low)
        for each, s in zip(task.actions[:3], share, strict=False)
    }
    law = {
        name: math.exp(math.log(low) + s * math.log(high / low))
        for (name, (low, high)), s in zip(LAWS.items(), share[3:], strict=True)
    }
    return {**gait, **law, "max_offset": task.max_offset}


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
    one, seeds = challenge(name), tuple(range(TUNING, TUNING + EPISODES))

    def cost(at: np.ndarray) -> float:
        numbers = _numbers(one, at)
        found = results(name, _method(numbers), seeds)
        outside = float(np.sum((at - np.clip(at, 0.0, 1.0)) ** 2))
        return -float(np.mean([each["objective"] for each in found])) + outside

    how: dict[str, Any] = {"seed": seed, "maxfevals": evaluations, "verbose": -9, "popsize": 10}
    strategy = cma.CMAEvolutionStrategy([0.5, 0.5, 0.5, 0.4, 0.4, 0.5], 0.25, how)
    while not strategy.stop():
        points = strategy.ask()
        strategy.tell(points, [cost(np.asarray(point)) for point in points])
        tell(
            f"{name}: {strategy.result.evaluations} evaluations, J = {-strategy.result.fbest:.5f} m/s"
        )
    return _numbers(one, np.asarray(strategy.result.xbest))


def _method(numbers: dict[str, float]) -> Method:
    return Method(name="searched", kind="law", sha256="", pilot=law_pilot(numbers))


def ends(name: str, numbers: dict[str, float]) -> tuple[float, float]:
    """Return J_0 and J_1 of a scenario: means of the open loop and the reference over the scored episodes [m/s].

    Args:
        name: Name of the scenario.
        numbers: Numbers of the reference.
    """
    found = [results(name, each) for each in (method("open-loop"), _method(numbers))]
    first, second = (float(np.mean([each["objective"] for each in one])) for one in found)
    return first, second
