"""Loads of tows as predictions of the measurements, and their derivatives by finite differences."""

from collections.abc import Sequence

import numpy as np

from laticauda.identify.problem import Problem
from laticauda.identify.resolving import with_tied
from laticauda.identify.runs import SimulatedRuns, data_of_measurements
from laticauda.identify.sensing import RunResults, measured_values
from laticauda.identify.towing import Tow
from laticauda.identify.unknowns import NUISANCE
from laticauda.models.simulate import change_parameters
from laticauda.scenarios import Scenario

DIFFERENCE = 2.0**-12
"""Step of the finite differences of a tow's loads, relative to the value [-]."""


def compute_loads(problem: Problem, scenarios: Sequence[Scenario], runs: SimulatedRuns) -> None:
    """Fill in the loads of all tows.

    Args:
        problem: Measurements and unknowns.
        scenarios: Scenario of each measurement, with the values of the unknowns.
        runs: Results to fill in.
    """
    for i, measurement in enumerate(problem.measurements):
        if measurement.tow is not None:
            runs.results[i].figures.update(measurement.tow.loads(scenarios[i]))


def differentiate_loads(
    problem: Problem, scenarios: Sequence[Scenario], values: np.ndarray, jacobian: np.ndarray
) -> None:
    """Fill in the derivatives of the loads of all tows, to second order.

    Args:
        problem: Measurements and unknowns.
        scenarios: Scenario of each measurement, with the values of the unknowns.
        values: Values of the unknowns.
        jacobian: Jacobian to fill in.
    """
    data_of = data_of_measurements(problem)
    for i, measurement in enumerate(problem.measurements):
        if measurement.tow is None:
            continue
        for k in np.flatnonzero(problem.depends_on[i]):
            if problem.unknowns[k].parameter.name not in NUISANCE:
                slope = _slope_of_loads(problem, measurement.tow, scenarios[i], values, i, int(k))
                jacobian[data_of[i], k] = slope


def _slope_of_loads(
    problem: Problem, tow: Tow, scenario: Scenario, values: np.ndarray, i: int, k: int
) -> np.ndarray:
    """Differentiate the loads of the tow of measurement i with respect to unknown k."""
    unknown = problem.unknowns[k]
    measurement = problem.measurements[i]
    value = float(values[k])

    def loads_with(changed_value: float) -> np.ndarray:
        numbers = with_tied(scenario, unknown.parameter.name, changed_value, unknown.tied)
        changed_scenario = change_parameters(scenario, numbers)
        results = RunResults(figures=dict(tow.loads(changed_scenario)))
        return measured_values(measurement, results, {})

    step = DIFFERENCE * (abs(value) or unknown.size)
    low = max(value - step, unknown.lower)
    high = min(value + step, unknown.upper)
    return (loads_with(high) - loads_with(low)) / (high - low)
