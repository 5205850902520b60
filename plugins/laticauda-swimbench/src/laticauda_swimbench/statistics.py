"""Summaries of many scores: means, the interquartile mean, and intervals from the stratified bootstrap.

[1] R. Agarwal et al., Deep reinforcement learning at the edge of the statistical precipice, NeurIPS
2021.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

REPEATS = 2000
"""How many times scores are resampled."""
SEED = 0
"""Seed of the resampling."""
LEVEL = 0.95
"""Level of the intervals."""
Numbers = NDArray[np.float64]


class Estimate(NamedTuple):
    """A number and the interval around it."""

    value: float
    """The number [-]."""
    low: float
    """Lower end of the interval [-]."""
    high: float
    """Upper end of the interval [-]."""


def interquartile_mean(values: Numbers) -> float:
    """Return the mean without the lowest and the highest quarter, each rounded down to whole values [1].

    Args:
        values: Values in any order and shape.

    Example:
        >>> interquartile_mean(np.array([0.0, 1.0, 2.0, 90.0]))
        1.5
    """
    ordered = np.sort(values, axis=None)
    cut = ordered.size // 4
    return float(ordered[cut : ordered.size - cut].mean())


def matrix(part: Mapping[str, Any]) -> Numbers:
    """Return the scores of a scenario: one row per run, one column per episode.

    Args:
        part: Entry of `scenarios` in a score file.
    """
    results: list[Mapping[str, Any]] = part["results"]
    n_runs = 1 + max(result["run"] for result in results)
    rows: list[list[float]] = []
    for run in range(n_runs):
        rows.append([result["score"] for result in results if result["run"] == run])
    return np.array(rows)


def resample(scores: Numbers, generator: np.random.Generator) -> Numbers:
    """Return resampled scores of a scenario: other runs or, for a method with one run, other episodes.

    Args:
        scores: Scores, one row per run.
        generator: Random number generator.
    """
    has_one_run = len(scores) == 1
    axis = int(has_one_run)
    return generator.choice(scores, scores.shape[axis], axis=axis)


def over_runs(scenarios: Sequence[Numbers]) -> float:
    """Return the interquartile mean of all runs in all scenarios; a run's score in one is the mean of its episodes.

    Args:
        scenarios: Scores of each scenario, one row per run.
    """
    return interquartile_mean(np.concatenate([scores.mean(axis=1) for scores in scenarios]))


def mean(scenarios: Sequence[Numbers]) -> float:
    """Return the mean of all scores of one or several scenarios; arguments as for `over_runs`."""
    return float(np.mean([scores.mean() for scores in scenarios]))


def estimate(scenarios: Sequence[Numbers], of: Callable[[Sequence[Numbers]], float]) -> Estimate:
    """Return a statistic of scores with its percentile interval; every scenario is resampled separately [1].

    Args:
        scenarios: Scores of each scenario, one row per run.
        of: Function that returns the statistic.
    """
    generator = np.random.default_rng(SEED)
    statistics: list[float] = []
    for _ in range(REPEATS):
        samples = [resample(scores, generator) for scores in scenarios]
        statistics.append(of(samples))
    low, high = np.quantile(statistics, [0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL])
    return Estimate(of(scenarios), float(low), float(high))
