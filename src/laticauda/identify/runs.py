"""Results of the runs of all measurements, and the series that are taken from their logs."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from laticauda.identify.measurements import Measurement
from laticauda.identify.problem import Problem
from laticauda.identify.sensing import RunResults, measured_values
from laticauda.scenarios import Scenario


@dataclass(frozen=True, kw_only=True, eq=False)
class Point:
    """A problem at given values of its unknowns."""

    problem: Problem
    """Measurements and unknowns."""
    values: Float[np.ndarray, " n_unknowns"]
    """Values of the unknowns."""

    @cached_property
    def scenarios(self) -> tuple[Scenario, ...]:
        """Scenario of each measurement at these values."""
        return self.problem.scenarios_at(self.values)


@dataclass(frozen=True, kw_only=True, eq=False)
class SimulatedRuns:
    """Results of the runs of all measurements, filled in kind by kind."""

    results: list[RunResults]
    """Results of each measurement's run."""
    failures: dict[str, str]
    """Status of each run that diverged, by name of the measurement."""

    @classmethod
    def of_problem(cls, problem: Problem) -> "SimulatedRuns":
        """Return one with nothing computed yet."""
        return cls(results=[RunResults() for _ in problem.measurements], failures={})


def shown_values(problem: Problem, runs: SimulatedRuns, values: np.ndarray) -> np.ndarray:
    """Return what the sensors would show of all runs, in the order of `Problem.observed`.

    Args:
        problem: Measurements and unknowns.
        runs: Results of the runs.
        values: Values of the unknowns, for those of the sensors.
    """
    parts: list[np.ndarray] = []
    for i, measurement in enumerate(problem.measurements):
        parts.append(measured_values(measurement, runs.results[i], problem.nuisance(i, values)))
    return np.concatenate(parts)


def swimming(problem: Problem) -> list[int]:
    """Return the indices of the measurements in which the robot swam or coasted."""
    return [i for i, measurement in enumerate(problem.measurements) if measurement.tow is None]


def logged_series(measurement: Measurement) -> Iterable[str]:
    """Return the series to take from a log: those measured, and the heading for trackers."""
    return dict.fromkeys(("heading", *measurement.series))


def data_of_measurements(problem: Problem) -> Sequence[np.ndarray]:
    """Return, for each measurement, the indices of its numbers in the data."""
    return [np.flatnonzero(problem.owner == i) for i in range(len(problem.measurements))]
