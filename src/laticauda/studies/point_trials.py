"""The trials of a study: one scenario at many points, each with other values of some of its numbers.

Which values the numbers may take, the scenario of each point, its figures, and the words and units
with which figures are stored.
"""

import itertools
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from jaxtyping import Shaped

import laticauda as lc
from laticauda.models.simulate import (
    UNITS,
    change_parameters,
    check_whole,
    described,
    look_up,
    of_figure,
    run_columns,
    scenarios_at as scenarios_at,
)
from laticauda.models.simulate.numbers import check_disjoint, list_parameters
from laticauda.scenarios import telling, warn_of_doubt
from laticauda.studies.sampling import Table
from laticauda.trials import LOAD_FIGURES, water_moves
from laticauda.trials.feasibility import NEEDS
from laticauda.values import BadArgument, check_instance, codec, extensions, packaging

Column = Shaped[np.ndarray, " n_points"]
Progress = Callable[[int, int], None]
"""Called periodically with the number of runs done and the total."""

FIGURES_NOT_STORED = ("positive_power", "x", "y", "heading")
"""Figures of a batch that no study needs."""
FIGURES = (*(name for name in UNITS if name not in FIGURES_NOT_STORED), *NEEDS)
"""Figures that are stored for every trial."""
QUANTITIES = (*FIGURES, "succeeded")
"""All that is stored for every trial."""
ALL_FIGURES = (*FIGURES, *LOAD_FIGURES)
"""The same with the figures of what joints carry, which are stored if they are asked for."""
LABELS = {
    name: f"{name.replace('_', ' ')} [{getattr(lc.Trial, name).unit or '-'}]"
    for name in ALL_FIGURES
}
"""The figures in words, with their units, as shown in tables and on axes."""
THROUGH_WATER = {
    "forward_velocity": "speed_through_water",
    "steady_velocity": "steady_speed_through_water",
}
"""Speeds through the water by those over ground, which a current makes without any swimming."""
COSTS = ("mechanical_power", "net_power", "mean_power", "cost_of_transport", *LOAD_FIGURES)
"""Figures of which the smallest is best; of all others, the largest."""
MOST_CORNERS = 256
"""Corners of the ranges that are tried; more are not worth the time."""


def quantities_of(*, loads: bool) -> tuple[str, ...]:
    """Return the names of all that is stored for every trial.

    Args:
        loads: Whether the figures of what joints carry are stored, too.
    """
    if loads:
        return (*ALL_FIGURES, "succeeded")
    return QUANTITIES


def swum_figure(name: str, scenario: lc.Scenario, varied: Iterable[str] = ()) -> str:
    """Return a figure by which trials are ranked: where the water moves, a speed is that through it.

    The fastest over ground would be the gait that leaves most to the current.

    Args:
        name: Name of a figure.
        scenario: What the trials share.
        varied: Names of the parameters that differ between them.
    """
    if moves_water(scenario, varied):
        return THROUGH_WATER.get(name, name)
    return name


def moves_water(scenario: lc.Scenario, varied: Iterable[str] = ()) -> bool:
    """Return whether the water moves in some trials.

    Args:
        scenario: What the trials share.
        varied: Names of the parameters that differ between them.
    """
    has_current = any(name.startswith("water.current") for name in varied)
    return has_current or water_moves(scenario.environment)


def check_scenario(scenario: lc.Scenario) -> None:
    """Reject a scenario that cannot be changed point by point.

    Raises:
        ValueError: If it is not a scenario, or not of the planar model.
    """
    check_instance("scenario", scenario, lc.Scenario)
    check_instance("scenario.model", scenario.model, lc.Planar)


def definition_of(scenario: lc.Scenario) -> dict[str, Any]:
    """Return everything of a scenario that the results depend on, for a file."""
    plain = codec.encode(scenario, lc.Scenario)
    plain["robot"].pop("description", None)
    return {"laticauda": packaging.__version__, **plain}


def attributes_of(scenario: lc.Scenario) -> dict[str, Any]:
    """Return the attributes that describe the scenario of stored results."""
    return {
        "Conventions": "CF-1.11",
        # No date, so that the same sweep gives the same bits.
        "history": f"made by laticauda {packaging.__version__}",
        "robot": scenario.robot.name,
        "gait": scenario.gait.kind,
        "environment": scenario.environment.name,
        "duration": scenario.duration,
        "joints": extensions.name_of(type(scenario.model.joints)),
        "laticauda": packaging.__version__,
    }


def labels_of(scenario: lc.Scenario, names: Iterable[str]) -> dict[str, dict[str, str]]:
    """Return the attributes of every stored parameter and quantity by name: description and unit.

    Args:
        scenario: What all trials share.
        names: Names of the stored parameters.
    """
    parameters = list_parameters(scenario)
    labels = {name: described(parameters[name].phrase, parameters[name].unit) for name in names}
    return labels | {name: of_figure(name) for name in quantities_of(loads=True)}


def check_ranges(
    scenario: lc.Scenario, ranges: Mapping[str, tuple[float, float]], argument: str = "points"
) -> None:
    """Reject ranges that cannot be swept, before any work is done.

    The ends of all ranges are tried, alone and together: fields have bounds, and some fields bound
    others.

    Args:
        scenario: What all trials share.
        ranges: Smallest and largest value of each parameter.
        argument: Name of the argument that they come from, for messages.

    Raises:
        ValueError: If there is no such parameter, or a value is out of its range; the message has
            its name.
    """
    parameters = list_parameters(scenario)
    for name, ends in ranges.items():
        parameter = look_up(name, parameters, argument)
        check_whole(parameter, np.array(ends))
    check_disjoint(ranges, argument)
    doubts: list[str] = []
    with telling(doubts.append):
        for corner in _corners_of(ranges):
            doubts.clear()  # ranges may begin at little; of what hardly is, the last corner tells
            _check_point(scenario, dict(zip(ranges, corner, strict=True)), argument)
    for doubt in doubts:
        warn_of_doubt(doubt)


def _corners_of(ranges: Mapping[str, tuple[float, float]]) -> Iterable[tuple[float, ...]]:
    """Return the corners of the box of all ranges, or only its two extreme ones if there are too many."""
    if 2 ** len(ranges) > MOST_CORNERS:
        return zip(*ranges.values(), strict=True)
    return itertools.product(*ranges.values())


def _check_point(scenario: lc.Scenario, values: Mapping[str, float], argument: str) -> None:
    """Reject a point at which the scenario's plant or gait cannot be made."""
    try:
        changed_scenario = change_parameters(scenario, values)
        n_links = lc.build_plant(changed_scenario).robot.planar().n_links
        changed_scenario.gait.joint_envelope(n_links)
    except ValueError as error:
        refused = _list_refused_alone(scenario, values) or values
        listed = ", ".join(f"{name} = {value:g}" for name, value in refused.items())
        reason = str(error).replace("`", "")  # these are no arguments of the caller
        raise BadArgument(
            argument,
            f"must be within the bounds of the parameters, got {listed}: {reason.removesuffix('.')}",
        ) from error


def _list_refused_alone(scenario: lc.Scenario, values: Mapping[str, float]) -> dict[str, float]:
    """Return the values that are out of range whatever the others are, by name."""
    refused: dict[str, float] = {}
    for name, value in values.items():
        try:
            change_parameters(scenario, {name: value})
        except ValueError:
            refused[name] = value
    return refused


def swim_points(
    scenario: lc.Scenario,
    names: tuple[str, ...],
    table: Table,
    threads: int | None = None,
    *,
    loads: bool = False,
) -> dict[str, Column]:
    """Simulate the trials of some points.

    Args:
        scenario: What all trials share.
        names: Names of the parameters, one per column of the table.
        table: The points, one per row.
        threads: Number of threads; None uses all cores available to this process.
        loads: Whether to compute the figures of what joints carry, too.

    Returns:
        One value per point of every quantity in `quantities_of`; nan where a run diverged, or where
        there is none.
    """
    columns = dict(zip(names, table.T, strict=True))
    batch, peaks, kept_loads = run_columns(
        scenario, columns, threads=threads, with_peaks=True, with_loads=loads
    )
    results: dict[str, Column] = {}
    for name in FIGURES:
        if name in peaks:
            is_known = batch.succeeded & np.isfinite(peaks[name])
            results[name] = np.where(is_known, peaks[name], np.nan)
        else:
            results[name] = batch.figures[name]
    if kept_loads is not None:
        results |= kept_loads.figures
    results["succeeded"] = batch.succeeded
    return results
