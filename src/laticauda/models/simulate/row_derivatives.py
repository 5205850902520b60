"""How a number enters a run: derivatives of everything from which the run's figures are computed.

These are the rows that the kernels read, and the robot's weight. A number enters them by a few short
formulas, whose slope is computed by differences of as high an order as they need, eighth at most:
to about 1e-13 for everything in a robot.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.models.dynamics.school import GAIT_PARAMETERS
from laticauda.models.planar.batch import COMMAND, FILTERED_COMMAND, Run
from laticauda.models.planar.model import PlanarPlant
from laticauda.scenarios import Scenario, Start
from laticauda.trials import metrics
from laticauda.values import add_up

Weights = Mapping[int, float]
"""Points of a difference, in steps from the value, and their weights."""

CENTRAL: Weights = {
    1: 4 / 5,
    -1: -4 / 5,
    2: -1 / 5,
    -2: 1 / 5,
    3: 4 / 105,
    -3: -4 / 105,
    4: -1 / 280,
    -4: 1 / 280,
}
"""Eighth order."""
WIDE: Weights = {2: 1 / 4, -2: -1 / 4}
"""Second order, enough for numbers that enter by polynomials of second degree, which most do."""
FOURTH: Weights = {1: 2 / 3, -1: -2 / 3, 2: -1 / 12, -2: 1 / 12}
"""Fourth order, to judge the sixth by."""
SIXTH: Weights = {1: 3 / 4, -1: -3 / 4, 2: -3 / 20, -2: 3 / 20, 3: 1 / 60, -3: -1 / 60}
"""Sixth order, enough for all numbers of most robots."""
ROUNDING = 8.0 * 2.0**-52
"""Share of a row to which a polynomial of second degree passes through its points [-]."""
SIXTH_IS_ENOUGH = 1e-9
"""Share of the derivative by which the fourth order may differ from the sixth, which then errs by 2e-13 [-]."""
FORWARD: Weights = {0: -25 / 12, 1: 4.0, 2: -3.0, 3: 4 / 3, 4: -1 / 4}
"""Fourth order, for a number at the lower end of its range."""
BACKWARD: Weights = {-point: -weight for point, weight in FORWARD.items()}
"""Fourth order, for a number at the upper end of its range."""
LINEAR: Weights = {1: 1 / 2, -1: -1 / 2}
"""For the numbers of a gait and of a start, which are rows themselves."""
STEP_SHARES = (2.0**-7, 2.0**-10, 2.0**-13)
"""The step as a share of the number [-]; the smaller ones are for numbers near the end of their range."""


@dataclass(frozen=True, kw_only=True)
class Number:
    """A variable number of a scenario's robot, gait or environment."""

    name: str
    """Name used in messages."""
    scenario: Scenario
    """Scenario that contains the number."""
    value: float
    """Value of the number in that scenario."""
    change: Callable[[float], Scenario]
    """Returns the scenario with another value; unaffected parts remain the same objects; ValueError if out of range."""
    start: Callable[[float], Start] | None = None
    """Returns the start of the run with another value; None: the start does not depend on the value."""
    wave_parameter: str | None = None
    """Name of the field of the gait, one of `GAIT_PARAMETERS`, if `change` changes that alone; None: it changes other
    things."""

    @property
    def is_of_motion(self) -> bool:
        """Whether it is a number of the gait or of the start."""
        if self.start is not None:
            return True
        return self.change(self.value).gait is not self.scenario.gait


class RowDerivative(NamedTuple):
    """Derivative of what a run's figures are computed from, per unit of a number."""

    rows: Float[np.ndarray, " rows"]
    """Of the rows that the kernels read."""
    weight: float
    """Of the robot's weight, see `carried_weight`."""
    needs_extras: bool
    """Whether the kernels must compute loads that may be 0 at the number's value, see `Layout.has_extras`."""


def differentiate_wave(run: Run, parameter: str) -> RowDerivative:
    """Return what `differentiate_rows` does for a parameter of the gait's wave, which is a row itself.

    Args:
        run: The run; its references are not held.
        parameter: One of `GAIT_PARAMETERS`.
    """
    place = GAIT_PARAMETERS.index(parameter)
    changes = np.zeros(run.n_rows)
    changes[COMMAND.start + place] = 1.0
    if place < len(FILTERED_COMMAND):
        # The run begins with the wave that is commanded.
        changes[FILTERED_COMMAND[place]] = 1.0
    return RowDerivative(rows=changes, weight=0.0, needs_extras=run.plant.layout.has_extras)


class _RunInput(NamedTuple):
    """What a run's figures are computed from."""

    rows: Float[np.ndarray, " rows"]
    """The rows that the kernels read."""
    weight: float
    """The robot's weight, see `carried_weight` [N]."""
    has_extras: bool
    """Whether the kernels compute all loads, see `Layout.has_extras`."""


def differentiate_rows(run: Run, number: Number, central: Weights) -> RowDerivative:
    """Differentiate everything from which a run's figures are computed.

    Args:
        run: The run.
        number: The number with respect to which it is differentiated.
        central: The difference to use unless the number is at an end of its range.

    Raises:
        ValueError: If the number cannot change to either side.
    """
    magnitude = 1.0
    if number.value:
        magnitude = 2.0 ** math.floor(math.log2(abs(number.value)))
    refusal: ValueError | None = None
    for weights in (central, FORWARD, BACKWARD):
        for share in STEP_SHARES:
            step = share * magnitude
            try:
                derivative = _difference(run, number, weights, step)
            except ValueError as error:
                refusal = error
                continue
            if derivative is not None:
                return derivative
    reason = ", but the number of fin strips depends on it there."
    if refusal is not None:
        reason = f": {refusal}"
    rule = "`parameters` must be numbers that can vary slightly"
    raise ValueError(f"{rule}; `{number.name}` is {number.value:g}{reason}")


def _difference(run: Run, number: Number, weights: Weights, step: float) -> RowDerivative | None:
    """Return the difference of what figures are computed from; None if the count of the rows changes.

    Raises:
        ValueError: If a value is out of the number's range.
    """
    points = _Points(run, number, step)
    if weights is CENTRAL:
        derivative = _of_low_order(points)
        if derivative is not None:
            return derivative
    points.compute(weights)
    if not points.have_rows_of_run:
        return None
    return _weighted_sum(points.inputs, weights, step)


class _Points:
    """What a run's figures are computed from at several values of a number, in steps from its own."""

    def __init__(self, run: Run, number: Number, step: float) -> None:
        self.run = run
        self.number = number
        self.step = step
        self.inputs: dict[int, _RunInput] = {}
        """At the points that were asked for."""

    def compute(self, points: Iterable[int]) -> None:
        """Compute the inputs at points where they are not known yet.

        Raises:
            ValueError: If a value is out of the number's range.
        """
        for point in points:
            if point not in self.inputs:
                self.inputs[point] = _input_after(self.run, self.number, point * self.step)

    @property
    def have_rows_of_run(self) -> bool:
        """Whether there are as many rows at all points as at the number's own value."""
        n_rows = {run_input.rows.size for run_input in self.inputs.values()}
        return n_rows == {self.run.n_rows}


def _of_low_order(points: _Points) -> RowDerivative | None:
    """Return the derivative if a difference of second or sixth order is right to rounding; else None."""
    points.compute((1, 2, -2))
    if not points.have_rows_of_run:
        return None
    if _are_of_second_degree(points):
        return _weighted_sum(points.inputs, WIDE, points.step)
    points.compute(SIXTH)
    if not points.have_rows_of_run:
        return None
    sixth = _weighted_sum(points.inputs, SIXTH, points.step)
    fourth = _weighted_sum(points.inputs, FOURTH, points.step)
    rounding = ROUNDING / points.step * _size_of(points)
    allowed = SIXTH_IS_ENOUGH * np.abs(_numbers_of(sixth)) + rounding
    if np.any(np.abs(_numbers_of(fourth) - _numbers_of(sixth)) > allowed):
        return None
    return sixth


def _are_of_second_degree(points: _Points) -> bool:
    """Return whether the polynomial of second degree through three points passes through a fourth, to rounding."""
    own = _numbers_of(_input_of(points.run))
    near, ahead, behind = (_numbers_of(points.inputs[point]) for point in (1, 2, -2))
    expected = own + (ahead - behind) / 4.0 + (ahead + behind - 2.0 * own) / 8.0
    return not np.any(np.abs(near - expected) > ROUNDING * _size_of(points))


def _size_of(points: _Points) -> Float[np.ndarray, " n_numbers"]:
    """Return the size of all numbers that are differentiated."""
    ahead, behind = (np.abs(_numbers_of(points.inputs[point])) for point in (2, -2))
    return np.maximum(ahead, behind)


def _numbers_of(source: "_RunInput | RowDerivative") -> Float[np.ndarray, " n_numbers"]:
    """Return the rows and the weight, or their derivatives, in one array."""
    return np.append(source.rows, source.weight)


def _weighted_sum(inputs: Mapping[int, _RunInput], weights: Weights, step: float) -> RowDerivative:
    """Return the difference of inputs at several points divided by the step between them."""
    rows = [weight / step * inputs[point].rows for point, weight in weights.items()]
    return RowDerivative(
        rows=np.sum(rows, axis=0),
        weight=add_up(weight / step * inputs[point].weight for point, weight in weights.items()),
        needs_extras=any(run_input.has_extras for run_input in inputs.values()),
    )


def _input_after(run: Run, number: Number, change: float) -> _RunInput:
    """Return what a run's figures are computed from when its number changes."""
    scenario = number.change(number.value + change)
    start = run.start
    if number.start is not None:
        start = number.start(number.value + change)
    plant = _plant_after(run.plant, before=number.scenario, after=scenario)
    command = run.command
    if scenario.gait is not number.scenario.gait:
        # All else of the command stays: thrusts, held references, switched-off motors. Numbers that are
        # not of the gait may be shared by runs with other gaits than that of their scenario.
        command = replace(run.command, gait=scenario.gait)
    return _input_of(replace(run, plant=plant, command=command, start=start))


def _input_of(run: Run) -> _RunInput:
    """Return what a run's figures are computed from."""
    plant = run.plant
    return _RunInput(
        rows=run.rows,
        weight=metrics.carried_weight(plant.robot, plant.environment),
        has_extras=plant.layout.has_extras,
    )


def _plant_after(plant: PlanarPlant, *, before: Scenario, after: Scenario) -> PlanarPlant:
    """Return the plant of a changed scenario, with its settings filled in; the same if nothing of it changed."""
    is_same = (
        after.robot is before.robot
        and after.environment is before.environment
        and after.model is before.model
    )
    if is_same:
        return plant
    settings = replace(plant.settings, joints=after.model.joints)
    return replace(plant, robot=after.robot, environment=after.environment, settings=settings)
