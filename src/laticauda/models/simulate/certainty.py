"""Uncertainty of a run's figures: their values at the ends of the intervals of its coefficients."""

import math
from collections.abc import Callable, Iterable, Mapping
from operator import attrgetter
from typing import Any, NamedTuple

from laticauda import robot, scenarios
from laticauda.models.simulate.numbers import change_parameters
from laticauda.models.simulate.runner import swim
from laticauda.trials import ThrustError, Trial, thrust_error
from laticauda.values import BadArgument, RunFailed, check_choice

Interval = tuple[float, float]
"""Lower and upper bound."""
FiguresOf = Callable[[Trial], Mapping[str, float]]
"""Returns numbers of a trial by name."""


def intervals_of(scenario: scenarios.Scenario) -> Mapping[str, Interval]:
    """Return the intervals of the numbers in a scenario's water that are the textbook's for its robot, by name.

    Args:
        scenario: Scenario of a run; numbers that were changed are taken as known.

    Raises:
        ValueError: If no number is the textbook's.
    """
    textbook = robot.textbook_water(scenario.robot)
    water = scenario.environment
    intervals: dict[str, Interval] = {}
    if isinstance(water, robot.Water) and type(water.drag) is type(textbook.water.drag):
        for name, interval in textbook.intervals.items():
            value_in = attrgetter(name.removeprefix("water."))
            if value_in(water) == value_in(textbook.water):
                intervals[name] = interval
    if not intervals:
        rule = "must be the textbook's, whose numbers have intervals"
        raise BadArgument("water", f"{rule}, got {water.name!r}")
    return intervals


class _RunsAtEnds(NamedTuple):
    """Figures of the two runs with a number at either end of its interval, by name."""

    lower: Mapping[str, float]
    upper: Mapping[str, float]

    def have(self, name: str) -> bool:
        """Return whether both runs have a figure."""
        return name in self.lower and name in self.upper


def figure_intervals(
    trial: Trial, intervals: Mapping[str, Interval] | None = None, figures: FiguresOf | None = None
) -> dict[str, Interval]:
    """Compute the range of a run's figures if the numbers of its scenario may lie anywhere in their intervals.

    Each number is set to either end while the others stay unchanged; the resulting changes are
    added in quadrature, upward and downward changes separately. This is valid if the numbers are
    independent and act nearly linearly, and says nothing about what the model itself omits (see the
    theory page on textbook water). If the thrust of the edge is outside its law
    (`laticauda.trials.describe_edge`), its error is added in quadrature, as a share of each figure
    that depends on a coefficient.

    Args:
        trial: A simulated run; it is repeated twice for each interval.
        intervals: Intervals by parameter name, as in `parameters`; None: `intervals_of` its
            scenario.
        figures: Custom figures: a function from a trial to numbers by name; None: those of
            `Trial.figures`.

    Returns:
        Lower and upper bound by name, for all figures that are numbers in every run.

    Raises:
        ValueError: If the trial was not simulated, or there are no intervals.
        RunFailed: If the trial is of a run that failed.
        SimulationFailed: If a run blows up.
    """
    scenario: Any = trial.scenario
    if not isinstance(scenario, scenarios.Scenario):
        rule = "must be a simulated run, which can be run again with other coefficients"
        raise BadArgument("trial", rule)
    if not trial.succeeded:
        raise RunFailed(trial.status)
    if intervals is None:
        intervals = intervals_of(scenario)
    if figures is None:
        figures = _figures_with_a_value

    def figures_with(name: str, value: float) -> Mapping[str, float]:
        return figures(swim(change_parameters(scenario, {name: value}), throw=True))

    runs = [
        _RunsAtEnds(lower=figures_with(name, lowest), upper=figures_with(name, highest))
        for name, (lowest, highest) in intervals.items()
    ]
    error = thrust_error(trial)
    bounds: dict[str, Interval] = {}
    for name, value in figures(trial).items():
        if all(run.have(name) for run in runs):
            bounds[name] = _interval_around(value, name, runs)
            if error is not None:
                bounds[name] = _widened_by_thrust(bounds[name], value, error)
    return bounds


def _widened_by_thrust(interval: Interval, value: float, error: ThrustError) -> Interval:
    """Return the interval of a figure with the error of the thrust, as if the figure were proportional to it.

    A figure that depends on no coefficient, such as the duration, depends on no thrust.
    """
    lowest, highest = interval
    if lowest == highest:
        return interval
    ends = (value / (1.0 + error.highest), value / (1.0 + error.lowest))
    return (
        value - math.hypot(value - lowest, value - min(ends)),
        value + math.hypot(highest - value, max(ends) - value),
    )


def _interval_around(value: float, name: str, runs: Iterable[_RunsAtEnds]) -> Interval:
    """Return the bounds of a figure; each number can move it down, up, or at both ends one way."""
    decreases: list[float] = []
    increases: list[float] = []
    for run in runs:
        change_at_lower = run.lower[name] - value
        change_at_upper = run.upper[name] - value
        decreases.append(min(0.0, change_at_lower, change_at_upper))
        increases.append(max(0.0, change_at_lower, change_at_upper))
    return value - math.hypot(*decreases), value + math.hypot(*increases)


def widen_by_textbook_error(interval: Interval, kind: str) -> Interval:
    """Adjust an interval of `figure_intervals` for the errors of the textbook water itself, observed on one robot.

    An error is (model - measured) / measured; the measured value is therefore the model's divided by
    1 + error. The largest error belongs to the lower bound: there the model was too high.

    Args:
        interval: Interval of a figure.
        kind: Kind of motion: swimming, gliding, turning or starting; see `laticauda.robot.SEEN`.
    """
    smallest_error, largest_error = robot.SEEN[check_choice("kind", kind, tuple(robot.SEEN))]
    lowest, highest = interval
    return lowest / (1.0 + largest_error), highest / (1.0 + smallest_error)


def _figures_with_a_value(trial: Trial) -> dict[str, float]:
    """Return those figures of a trial that it has."""
    values, _ = trial.figures()
    return {name: float(value) for name, value in values.items() if isinstance(value, float)}
