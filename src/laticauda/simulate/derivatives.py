"""Derivatives of many trials' figures, each to one number of its robot, gait or environment.

The runs themselves are differentiated exactly: the kernels compute with a complex step (`laticauda.compiling.duals`).
How that number enters the kernels' rows is a matter of a few short formulas, and their slope comes from differences of
order eight, which are exact for polynomials of that degree: to some 1e-13 for all that a robot has.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from laticauda.interfaces import Command, Start
from laticauda.planar.batch import STEP, Run
from laticauda.planar.model import PlanarPlant
from laticauda.scenarios import Scenario
from laticauda.simulate.many import Look, collected
from laticauda.simulate.runner import Progress
from laticauda.trial import metrics

# Points of the differences, in steps, and their weights: of order eight; four at an end of what is allowed.
_MIDDLE = {1: 4 / 5, -1: -4 / 5, 2: -1 / 5, -2: 1 / 5, 3: 4 / 105, -3: -4 / 105, 4: -1 / 280, -4: 1 / 280}
_AHEAD = {0: -25 / 12, 1: 4.0, 2: -3.0, 3: 4 / 3, 4: -1 / 4}
_BEHIND = {-point: -weight for point, weight in _AHEAD.items()}
_LINE = {1: 1 / 2, -1: -1 / 2}  # the numbers of a gait and of a start are rows themselves
# A step as a share of the number. Smaller ones serve numbers near the end of what is allowed.
_SHARES = (2.0**-7, 2.0**-10, 2.0**-13)


@dataclass(frozen=True, kw_only=True)
class Number:
    """A number of a scenario's robot, gait or environment that may change."""

    name: str
    """What messages call it."""
    scenario: Scenario
    """Whose number it is."""
    value: float
    """What it is there."""
    change: Callable[[float], Scenario]
    """The scenario with another value: what it is not part of stays the same object; a ValueError if out of range."""
    start: Callable[[float], Start] | None = None
    """Where the run begins with another value; None: where it did."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Slopes:
    """Figures of many trials, and their derivatives, nan where a trial has none (see `Swims`)."""

    value: Mapping[str, Float[np.ndarray, " n_runs"]]
    """By the name of the figure."""
    slope: Mapping[str, Float[np.ndarray, " n_runs"]]
    """The same, to each run's number."""
    succeeded: Bool[np.ndarray, " n_runs"]
    """Whether the run reached its end."""
    status: tuple[str, ...]
    """How it ended."""


class _Entry(NamedTuple):
    """How a number enters a run."""

    rows: Float[np.ndarray, " rows"]
    weight: float
    has_extras: bool


def slopes(
    runs: Sequence[Run],
    numbers: Sequence[Number],
    duration: float,
    *,
    sample_interval: float = 0.05,
    threads: int | None = None,
    progress: Progress | None = None,
    look: Look | None = None,
    with_joints: bool = False,
) -> Slopes:
    """Figures of runs and their derivatives, run i to number i.

    Args:
        runs: From `laticauda.simulate.many.runs_of`; steps in time stay what they are there.
        numbers: What each is differentiated to.
        duration: See `swim_many` [s].
        sample_interval: See `swim_many` [s].
        threads: See `swim_many`.
        progress: See `swim_many`.
        look: See `laticauda.simulate.many.collected`; all numbers there are complex, see `laticauda.planar.batch`.
        with_joints: See there.

    Raises:
        ValueError: If a number cannot change on either side, or another argument is out of its range.
    """
    derived: list[Run] = []
    weights = np.empty(len(runs), dtype=complex)
    known: dict[tuple[int, str], _Entry] = {}
    extra_plants: dict[int, PlanarPlant] = {}
    for i, (run, number) in enumerate(zip(runs, numbers, strict=True)):
        key = id(run.plant), number.name
        of_gait = number.start is not None or number.change(number.value).gait is not number.scenario.gait
        entry = known.get(key) or _entry(run, number, (_LINE if of_gait else _MIDDLE, _AHEAD, _BEHIND))
        if not of_gait:  # the same for all gaits
            known[key] = entry
        plant = run.plant
        if entry.has_extras and not plant.layout.has_extras:
            plant = extra_plants.setdefault(id(plant), _with_extras(plant))
        derived.append(replace(run, plant=plant, slope=entry.rows))
        weights[i] = metrics.carried_weight(plant.robot, plant.environment) + 1j * STEP * entry.weight
    found = collected(
        derived, weights, duration, sample_interval, threads, progress, look=look, with_joints=with_joints
    )
    return Slopes(
        value={name: np.real(figure) for name, figure in found.figures.items()},
        slope={name: np.where(np.isnan(f), np.nan, np.imag(f) / STEP) for name, f in found.figures.items()},
        succeeded=found.succeeded,
        status=found.status,
    )


def _entry(run: Run, number: Number, differences: Sequence[Mapping[int, float]]) -> _Entry:
    """The derivative of all that the figures are made of: the kernels' rows, and the robot's weight."""
    size = 2.0 ** math.floor(math.log2(abs(number.value))) if number.value else 1.0
    refused: ValueError | None = None
    for points in differences:
        for share in _SHARES:
            step = share * size
            try:
                near = {point: _changed(run, number, point * step) for point in points}
            except ValueError as err:
                refused = err
                continue
            if len({entry.rows.size for entry in near.values()}) == 1 and near[max(near)].rows.size == run.rows.size:
                return _Entry(
                    rows=np.sum([weight / step * near[point].rows for point, weight in points.items()], axis=0),
                    weight=sum(weight / step * near[point].weight for point, weight in points.items()),
                    has_extras=any(entry.has_extras for entry in near.values()),
                )
    reason = f": {refused}" if refused else ", but the number of fin strips depends on it there."
    raise ValueError(
        f"`parameters` must be numbers that may change a little; `{number.name}` is {number.value:g}{reason}"
    )


def _changed(run: Run, number: Number, by: float) -> _Entry:
    """What a run's figures are made of when its number is another."""
    plant = run.plant
    after, before = number.change(number.value + by), number.scenario
    start = run.start if number.start is None else number.start(number.value + by)
    if any(getattr(after, name) is not getattr(before, name) for name in ("robot", "environment", "model")):
        settings = replace(plant.settings, joints=after.model.joints)
        plant = replace(plant, robot=after.robot, environment=after.environment, settings=settings)
    return _Entry(
        rows=replace(run, plant=plant, command=Command(gait=after.gait), start=start).rows,
        weight=metrics.carried_weight(plant.robot, plant.environment),
        has_extras=plant.layout.has_extras,
    )


def _with_extras(plant: PlanarPlant) -> PlanarPlant:
    """The same plant, whose kernels look for loads that are 0 now, because their derivatives are not."""
    wider = replace(plant)
    vars(wider)["layout"] = replace(plant.layout, has_extras=True)  # where the cached property would put it
    return wider
