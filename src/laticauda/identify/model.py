"""Model predictions of the measurements, and their derivatives with respect to the unknowns.

How a measurement is predicted depends on what was done, each in a module of its own:

    planar_runs    swimming, planar model: all trials in a batch, derivatives with a complex step
    spatial_runs   swimming, 3D twin: trial by trial, derivatives by finite differences
    tow_runs       tows: loads in closed form, derivatives by finite differences
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from jaxtyping import Float

from laticauda.identify import planar_runs, spatial_runs, tow_runs
from laticauda.identify.problem import Problem
from laticauda.identify.runs import SimulatedRuns, shown_values
from laticauda.scenarios import Planar, Scenario

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
    scenarios = problem.scenarios_at(values)
    runs = _simulate(problem, scenarios)
    if isinstance(problem.model, Planar):
        differentiate = partial(_planar_jacobian, problem, scenarios, values, runs)
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


def _simulate(problem: Problem, scenarios: tuple[Scenario, ...]) -> SimulatedRuns:
    """Compute what was done in every measurement at the given scenarios."""
    runs = SimulatedRuns.of_problem(problem)
    tow_runs.compute_loads(problem, scenarios, runs)
    if isinstance(problem.model, Planar):
        planar_runs.simulate(problem, scenarios, runs)
    else:
        spatial_runs.simulate(problem, scenarios, runs)
    return runs


def _planar_jacobian(
    problem: Problem, scenarios: tuple[Scenario, ...], values: Values, runs: SimulatedRuns
) -> Jacobian:
    """Compute the Jacobian for each pair of a measurement and an unknown on which it depends."""
    jacobian = np.zeros((problem.owner.size, len(problem.unknowns)))
    planar_runs.differentiate_sensors(problem, values, runs, jacobian)
    tow_runs.differentiate_loads(problem, scenarios, values, jacobian)
    planar_runs.differentiate_runs(problem, scenarios, values, jacobian)
    return jacobian


def _difference_jacobian(problem: Problem, values: Values) -> Jacobian:
    """Compute the Jacobian of the 3D twin by central differences."""
    columns: list[np.ndarray] = []
    for k, unknown in enumerate(problem.unknowns):
        value = float(values[k])
        step = DIFFERENCE * unknown.slope(value) * unknown.size
        low = max(value - step, unknown.lower)
        high = min(value + step, unknown.upper)
        predictions_at_low = _predict_with(problem, values, k, low)
        predictions_at_high = _predict_with(problem, values, k, high)
        columns.append((predictions_at_high - predictions_at_low) / (high - low))
    return np.stack(columns, axis=1)


def _predict_with(problem: Problem, values: Values, k: int, value: float) -> np.ndarray:
    """Predict all measurements with another value of one unknown."""
    changed = values.copy()
    changed[k] = value
    runs = _simulate(problem, problem.scenarios_at(changed))
    return shown_values(problem, runs, changed)
