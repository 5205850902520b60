"""What many scores come to: means, the interquartile mean, and intervals by the stratified bootstrap.

[1] R. Agarwal et al., Deep reinforcement learning at the edge of the statistical precipice, NeurIPS 2021.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

REPEATS, SEED = 2000, 0
LEVEL = 0.95
"""Of the intervals."""
Numbers = NDArray[np.float64]


class Estimate(NamedTuple):
    """A number and the interval around it."""

    value: float
    """[-]."""
    low: float
    """[-]."""
    high: float
    """[-]."""


def interquartile_mean(values: Numbers) -> float:
    """The mean of what is left without the lowest and the highest quarter, each rounded down to whole values [1].

    Args:
        values: In any order and shape.

    Example:
        >>> interquartile_mean(np.array([0.0, 1.0, 2.0, 90.0]))
        1.5
    """
    ordered = np.sort(values, axis=None)
    cut = ordered.size // 4
    return float(ordered[cut : ordered.size - cut].mean())


def matrix(part: Mapping[str, Any]) -> Numbers:
    """Scores of a scenario: a row for each run, a column for each episode.

    Args:
        part: An entry of `scenarios` in a score file.
    """
    found: list[Mapping[str, Any]] = part["results"]
    runs = 1 + max(one["run"] for one in found)
    return np.array([[one["score"] for one in found if one["run"] == run] for run in range(runs)])


def resampled(scores: Numbers, generator: np.random.Generator) -> Numbers:
    """Scores of a scenario as they might have come out: other runs; of a method that has one run, other episodes.

    Args:
        scores: A row for each run.
        generator: Of random numbers.
    """
    axis = 0 if len(scores) > 1 else 1
    return generator.choice(scores, scores.shape[axis], axis=axis)


def over_runs(scenarios: Sequence[Numbers]) -> float:
    """The interquartile mean of all runs in all scenarios; what a run scores in a scenario is the mean of its episodes.

    Args:
        scenarios: Scores of each, a row for each run.
    """
    return interquartile_mean(np.concatenate([scores.mean(axis=1) for scores in scenarios]))


def mean(scenarios: Sequence[Numbers]) -> float:
    """The mean of all scores of one scenario or of several; arguments as for `over_runs`."""
    return float(np.mean([scores.mean() for scores in scenarios]))


def estimate(scenarios: Sequence[Numbers], of: Callable[[Sequence[Numbers]], float]) -> Estimate:
    """A number of scores, with its percentile interval; every scenario is resampled on its own [1].

    Args:
        scenarios: Scores of each, a row for each run.
        of: What is to be known of them.
    """
    generator = np.random.default_rng(SEED)
    others = [of([resampled(scores, generator) for scores in scenarios]) for _ in range(REPEATS)]
    low, high = np.quantile(others, [0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL])
    return Estimate(of(scenarios), float(low), float(high))
