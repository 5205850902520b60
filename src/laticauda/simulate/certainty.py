"""How sure a run's figures are: what they become at the ends of the intervals in which its coefficients lie."""

import math
from collections.abc import Callable, Mapping
from operator import attrgetter
from typing import Any

from laticauda import robot, scenarios
from laticauda.errors import BadArgument, one_of
from laticauda.simulate.numbers import changed
from laticauda.simulate.runner import swim
from laticauda.trial import Trial

Interval = tuple[float, float]
Figures = Callable[[Trial], Mapping[str, float]]


def intervals_of(scenario: scenarios.Scenario) -> Mapping[str, Interval]:
    """The intervals of those numbers of a scenario's water that are the textbook's for its robot, by name.

    Args:
        scenario: Of a run; numbers that somebody has changed are taken as known.

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
        raise BadArgument("water", f"must be the textbook's, whose numbers have intervals, got {water.name!r}")
    return found


def spread(
    trial: Trial, intervals: Mapping[str, Interval] | None = None, figures: Figures | None = None
) -> dict[str, Interval]:
    """Between what the figures of a run lie, if the numbers of its scenario may lie anywhere in their intervals.

    Each number is set to either end while the others stay; what that changes adds in quadrature, upwards and downwards
    apart. That holds as far as the numbers are independent and act nearly linearly, and says nothing of what the model
    itself leaves out (see the theory page on textbook water).

    Args:
        trial: A simulated run; it is run again twice for each interval.
        intervals: By name as `parameters` has it; None: `intervals_of` its scenario.
        figures: Figures of one's own, from a trial to numbers by name; None: those of `Trial.figures`.

    Returns:
        The least and the most by the name of the figure, for all that are numbers in every run.

    Raises:
        ValueError: If the trial was not simulated, or there are no intervals.
        SimulationFailed: If a run blows up.
    """
    scenario: Any = trial.scenario
    if not isinstance(scenario, scenarios.Scenario):
        raise BadArgument("trial", "must be a simulated run, which can be run again at other coefficients")
    ends, of = intervals_of(scenario) if intervals is None else intervals, figures or _figures
    runs = [[of(swim(changed(scenario, {name: end}), throw=True)) for end in pair] for name, pair in ends.items()]
    found: dict[str, Interval] = {}
    for name, value in of(trial).items():
        if all(name in run for pair in runs for run in pair):
            steps = [[run[name] - value for run in pair] for pair in runs]
            less, more = (math.hypot(*(choose(0.0, *pair) for pair in steps)) for choose in (min, max))
            found[name] = value - less, value + more
    return found


def stated(interval: Interval, kind: str) -> Interval:
    """An interval of `spread` with what the textbook's water itself has missed so far, on one robot.

    Args:
        interval: Of a figure.
        kind: Of motion: swimming, gliding, turning or starting; see `laticauda.robot.SEEN`.
    """
    less, more = robot.SEEN[one_of("kind", kind, tuple(robot.SEEN))]
    return interval[0] / (1.0 + more), interval[1] / (1.0 + less)


def _figures(trial: Trial) -> dict[str, float]:
    return {name: float(one) for name, one in trial.figures()[0].items() if isinstance(one, float)}
