"""Model predictions of the measurements, and their derivatives with respect to the unknowns.

How a measurement is predicted depends on what was done, each in a module of its own:

    planar_runs    swimming, planar model: all trials in a batch, derivatives with a complex step
    spatial_runs   swimming, 3D twin: trial by trial, derivatives by finite differences
    tow_runs       tows: loads in closed form, derivatives by finite differences
    remote_runs    swimming, on the workers of a cluster
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.identify import planar_runs, remote_runs, spatial_runs, tow_runs
from laticauda.identify.problem import Problem
from laticauda.identify.runs import Point, SimulatedRuns, shown_values
from laticauda.scenarios import Planar

DIFFERENCE = 1e-3
"""Step of the 3D twin's finite differences, as a fraction of a large change [-]."""

Values = Float[np.ndarray, " n_unknowns"]
Jacobian = Float[np.ndarray, "n_data n_unknowns"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Predicted:
    """Model predictions at given values of the unknowns."""

    values: Float[np.ndarray, " n_data"]
    """Predicted values, in the order of `Problem.observed`; nan where a run diverged."""
    failures: Mapping[str, str]
    """Status of each run that diverged, by name of the measurement."""
    differentiate: Callable[[], Jacobian]
    """Function that computes the `jacobian`."""

    @cached_property
    def jacobian(self) -> Jacobian:
        """Derivative of each value with respect to each unknown, computed on first access."""
        return self.differentiate()


def predict(problem: Problem, values: Values) -> Predicted:
    """Predict all measurements with the model.

    Args:
        problem: Measurements and unknowns.
        values: Values of the unknowns, in their units.
    """
    point = Point(problem=problem, values=values)
    (runs,) = _simulate([point])
    if isinstance(problem.model, Planar):
        differentiate = partial(_planar_jacobian, point, runs)
    else:
        differentiate = partial(_difference_jacobian, problem, values)
    return Predicted(
        values=shown_values(problem, runs, values),
        failures=runs.failures,
        differentiate=differentiate,
    )


def scaled_jacobian(
    problem: Problem, values: Values, factor: float = 1.0, predicted: Predicted | None = None
) -> Jacobian:
    """Compute the Jacobian with respect to the coordinates, in standard deviations.

    Args:
        problem: Measurements and unknowns.
        values: Values of the unknowns.
        factor: Factor applied to the stated noise.
        predicted: Prediction at these values, if already computed.
    """
    if predicted is None:
        predicted = predict(problem, values)
    noise = (factor * problem.sigma)[:, np.newaxis]
    return predicted.jacobian / noise * problem.slopes(values)


def _simulate(points: Sequence[Point]) -> list[SimulatedRuns]:
    """Compute what was done in every measurement, at each of some points."""
    runs_of_points = [SimulatedRuns.of_problem(point.problem) for point in points]
    for point, runs in zip(points, runs_of_points, strict=True):
        tow_runs.compute_loads(point.problem, point.scenarios, runs)
    if points[0].problem.client is not None:
        remote_runs.simulate(points, runs_of_points)
        return runs_of_points
    for point, runs in zip(points, runs_of_points, strict=True):
        if isinstance(point.problem.model, Planar):
            planar_runs.simulate(point.problem, point.scenarios, runs)
        else:
            spatial_runs.simulate(point.problem, point.scenarios, runs)
    return runs_of_points


def _planar_jacobian(point: Point, runs: SimulatedRuns) -> Jacobian:
    """Compute the Jacobian for each pair of a measurement and an unknown on which it depends."""
    problem, values = point.problem, point.values
    jacobian = np.zeros((problem.owner.size, len(problem.unknowns)))
    planar_runs.differentiate_sensors(problem, values, runs, jacobian)
    tow_runs.differentiate_loads(problem, point.scenarios, values, jacobian)
    if problem.client is not None:
        remote_runs.differentiate_runs(point, jacobian)
    else:
        planar_runs.differentiate_runs(problem, point.scenarios, values, jacobian)
    return jacobian


def _difference_jacobian(problem: Problem, values: Values) -> Jacobian:
    """Compute the Jacobian of the 3D twin by central differences."""
    jacobian = np.zeros((problem.owner.size, len(problem.unknowns)))
    differences = _list_differences(problem, values)
    if not differences:
        return jacobian
    points: list[Point] = []
    for difference in differences:
        points += (difference.low, difference.high)
    runs_of_points = _simulate(points)
    shown = [
        shown_values(point.problem, runs, point.values)
        for point, runs in zip(points, runs_of_points, strict=True)
    ]
    for difference, at_low, at_high in zip(differences, shown[::2], shown[1::2], strict=True):
        k = difference.unknown
        width = difference.high.values[k] - difference.low.values[k]
        numbers = np.isin(problem.owner, difference.measurements)
        jacobian[numbers, k] = (at_high - at_low) / width
    return jacobian


class _Difference(NamedTuple):
    """A central difference of all measurements that depend on an unknown."""

    unknown: int
    """Index of the unknown."""
    measurements: np.ndarray
    """Indices of the measurements."""
    low: Point
    """Where the unknown is smaller."""
    high: Point
    """Where it is larger."""


def _list_differences(problem: Problem, values: Values) -> list[_Difference]:
    """Return the difference for each unknown on which a measurement depends."""
    differences: list[_Difference] = []
    for k, unknown in enumerate(problem.unknowns):
        measurements = np.flatnonzero(problem.depends_on[:, k])
        if measurements.size == 0:
            continue
        dependents = problem.part(measurements.tolist())
        value = float(values[k])
        step = DIFFERENCE * unknown.slope(value) * unknown.size
        low = _with_value(values, k, max(value - step, unknown.lower))
        high = _with_value(values, k, min(value + step, unknown.upper))
        difference = _Difference(
            unknown=k,
            measurements=measurements,
            low=Point(problem=dependents, values=low),
            high=Point(problem=dependents, values=high),
        )
        differences.append(difference)
    return differences


def _with_value(values: Values, k: int, value: float) -> Values:
    """Return the values with another one of unknown k."""
    changed = values.copy()
    changed[k] = value
    return changed
