"""Uncertainty of a run's figures: their values at the ends of the intervals that contain its coefficients."""

import math
from collections.abc import Callable, Mapping
from operator import attrgetter
from typing import Any

from laticauda import robot, scenarios
from laticauda.errors import BadArgument, check_choice
from laticauda.simulate.numbers import change_parameters
from laticauda.simulate.runner import swim
from laticauda.trial import Trial

Interval = tuple[float, float]
Figures = Callable[[Trial], Mapping[str, float]]


def intervals_of(scenario: scenarios.Scenario) -> Mapping[str, Interval]:
    """Return the intervals of the numbers in a scenario's water that are the textbook's for its robot, by name.

    Args:
        scenario: Scenario of a run; numbers that were changed are taken as known.

    Raises:
        ValueError: If no number is the textbook's.
    """
    book, water = robot.textbook_water(scenario.robot), scenario.environment
    found: dict[str, Interval] = {}
    if isinstance(water, robot.Water) and type(water.drag) is type(book.water.drag):
        for name, interval in book.intervals.items():
            number = attrgetter(name.removeprefix("water."))
            if number(water) == number(book.water):
                found[name] = interval
    if not found:
        raise BadArgument(
            "water", f"must be the textbook's, whose numbers have intervals, got {water.name!r}"
        )
    return found


def figure_intervals(
    trial: Trial, intervals: Mapping[str, Interval] | None = None, figures: Figures | None = None
) -> dict[str, Interval]:
    """Compute the range of a run's figures if the numbers of its scenario may lie anywhere in their intervals.

    Each number is set to either end while the others stay unchanged; the resulting changes are
    added in quadrature, upward and downward changes separately. This is valid if the numbers are
    independent and act nearly linearly, and says nothing about what the model itself omits (see the
    theory page on textbook water).

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
        SimulationFailed: If a run blows up.
    """
    scenario: Any = trial.scenario
    if not isinstance(scenario, scenarios.Scenario):
        raise BadArgument(
            "trial", "must be a simulated run, which can be run again with other coefficients"
        )
    ends, of = intervals_of(scenario) if intervals is None else intervals, figures or _figures
    runs = [
        [of(swim(change_parameters(scenario, {name: end}), throw=True)) for end in pair]
        for name, pair in ends.items()
    ]
    found: dict[str, Interval] = {}
    for name, value in of(trial).items():
        if all(name in run for pair in runs for run in pair):
            steps = [[run[name] - value for run in pair] for pair in runs]
            less, more = (
                math.hypot(*(choose(0.0, *pair) for pair in steps)) for choose in (min, max)
            )
            found[name] = value - less, value + more
    return found


def widen_by_textbook_error(interval: Interval, kind: str) -> Interval:
    """Adjust an interval of `spread` for the errors of the textbook water itself observed so far, on one robot.

    Args:
        interval: Interval of a figure.
        kind: Kind of motion: swimming, gliding, turning or starting; see `laticauda.robot.SEEN`.
    """
    less, more = robot.SEEN[check_choice("kind", kind, tuple(robot.SEEN))]
    return interval[0] / (1.0 + more), interval[1] / (1.0 + less)


def _figures(trial: Trial) -> dict[str, float]:
    return {name: float(one) for name, one in trial.figures()[0].items() if isinstance(one, float)}
