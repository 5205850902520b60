"""Trials at many points of a scenario's numbers: which points there may be, and what they come to."""

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from jaxtyping import Float, Shaped

import laticauda as lc
from laticauda import codec, extensions, packaging
from laticauda.errors import BadArgument, instance
from laticauda.simulate.batch_figures import Block, Run, joint_peaks
from laticauda.simulate.many import collected, runs_of
from laticauda.simulate.numbers import UNITS, changed, check_whole, look_up, parameters
from laticauda.trial.feasibility import NEEDS

Table = Float[np.ndarray, "n_points n_names"]
Column = Shaped[np.ndarray, " n_points"]

FIGURES = (*(name for name in UNITS if name not in ("positive_power", "x", "y", "heading")), *NEEDS)
"""Those that are kept of every trial."""
QUANTITIES = {name: (getattr(lc.Trial, name).unit or "1", getattr(lc.Trial, name).title) for name in FIGURES}
QUANTITIES["succeeded"] = ("", "whether the run reached its end")
"""What is kept of every trial: unit and title by name."""
# Of these the least is the best, of the others the greatest.
COSTS = ("mechanical_power", "net_power", "mean_power", "cost_of_transport")
_ROOTS = {"robot": "robot", "gait": "motion", "water": "environment", "ground": "environment"}
# More corners than this are not worth the time: every range's ends are tried in any case.
MOST_CORNERS = 256


def check_scenario(scenario: lc.Scenario) -> None:
    """Refuse a scenario that cannot be changed point by point.

    Raises:
        ValueError: If it is none, or is not of the planar model.
    """
    instance("scenario", scenario, lc.Scenario)
    instance("scenario.model", scenario.model, lc.Planar)


def definition_of(scenario: lc.Scenario) -> dict[str, Any]:
    """All of a scenario that the results depend on, for a file."""
    plain = codec.encode(scenario, lc.Scenario)
    plain["robot"].pop("description", None)
    return {"laticauda": packaging.__version__, **plain}


def attributes_of(scenario: lc.Scenario) -> dict[str, Any]:
    """What stands beside stored results about the scenario they are of."""
    return {
        "robot": scenario.robot.name,
        "gait": scenario.gait.kind,
        "environment": scenario.environment.name,
        "duration": scenario.duration,
        "joints": extensions.name_of(type(scenario.model.joints)),
        "laticauda": packaging.__version__,
    }


def check_ranges(scenario: lc.Scenario, ranges: Mapping[str, tuple[float, float]], argument: str = "points") -> None:
    """Refuse what cannot be swept, before any work is done.

    The ends of all ranges are tried, alone and together: fields have bounds, and some are bounds of others.

    Args:
        scenario: What all trials share.
        ranges: Least and greatest value by parameter.
        argument: Where they are from, for messages.

    Raises:
        ValueError: If there is no such parameter, or a value is out of its range; the message has its name.
    """
    known = parameters(scenario)
    for name, ends in ranges.items():
        parameter = look_up(name, known, argument)
        check_whole(parameter, np.array(ends))
    corners: Iterable[tuple[float, ...]] = itertools.product(*ranges.values())
    if 2 ** len(ranges) > MOST_CORNERS:
        corners = zip(*ranges.values(), strict=True)
    for corner in corners:
        values = dict(zip(ranges, corner, strict=True))
        try:
            other = changed(scenario, values)
            other.gait.joint_envelope(lc.plant(other).robot.planar().n_links)
        except ValueError as error:
            listed = ", ".join(f"{name} = {value:g}" for name, value in values.items())
            reason = str(error).replace("`", "")  # these are no arguments of the caller
            rule = f"must be within the bounds of what is swept, got {listed}: {reason.removesuffix('.')}"
            raise BadArgument(argument, rule) from error


def swim_points(
    scenario: lc.Scenario, names: tuple[str, ...], table: Table, threads: int | None = None
) -> dict[str, Column]:
    """Let the robots of some points swim.

    Args:
        scenario: What all trials share.
        names: Of the parameters, a column of the table each.
        table: The points, a row each.
        threads: See `laticauda.simulate.swim_many`.

    Returns:
        A value per point of every quantity in `QUANTITIES`; nan where a run blew up, or where there is none.
    """
    runs = runs_of(scenarios_at(scenario, names, table))
    joints = {name: np.full(len(runs), np.nan) for name in NEEDS}

    def look(mine: Sequence[Run], block: Block) -> None:
        for name, values in joint_peaks(mine, block).items():
            joints[name][block.index] = values

    interval = scenario.sample_interval
    found = collected(runs, scenario.duration, interval, threads, None, look=look, with_joints=True)
    kept = {name: np.where(found.succeeded & np.isfinite(values), values, np.nan) for name, values in joints.items()}
    return {**{name: found.figures[name] for name in FIGURES if name not in kept}, **kept, "succeeded": found.succeeded}


def scenarios_at(scenario: lc.Scenario, names: tuple[str, ...], table: Table) -> list[lc.Scenario]:
    """The scenario of every point; equal robots, gaits and environments are one object, made once.

    Args:
        scenario: What all trials share.
        names: Of the parameters, a column of the table each.
        table: The points, a row each.
    """
    roots = {root: [i for i, name in enumerate(names) if name.split(".")[0] == root] for root in _ROOTS}
    made: dict[tuple[str, tuple[float, ...]], Any] = {}

    def part(root: str, row: tuple[float, ...]) -> Any:
        own = tuple(row[i] for i in roots[root])
        if (root, own) not in made:
            values = dict(zip((names[i] for i in roots[root]), own, strict=True))
            made[root, own] = getattr(changed(scenario, values), _ROOTS[root])
        return made[root, own]

    used = [root for root in _ROOTS if roots[root]]
    rows = map(tuple, table.tolist())
    return [replace(scenario, **{_ROOTS[root]: part(root, row) for root in used}) for row in rows]


Progress = Callable[[int, int], None]
"""Called now and then with the number of runs done, and of all."""


def silent(done: int, total: int) -> None:
    """Progress that nobody wants to know."""
