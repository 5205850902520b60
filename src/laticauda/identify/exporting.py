"""Identified values applied to a robot, a water, or a parameter file."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, cast

import numpy as np

import laticauda as lc
from laticauda.identify.problem import Problem
from laticauda.identify.unknowns import with_tied
from laticauda.models.simulate.numbers import change_parameters, list_parameters
from laticauda.robot.parameters import FIELDS_OF_ROBOT, GAITS, NAMES
from laticauda.values import extensions, quantities
from laticauda.values.errors import BadArgument

Changes = dict[str, dict[str, Any]]
Values = Mapping[str, float]


def applied(problem: Problem, values: Values, scenario: lc.Scenario, gait_kind: str) -> lc.Scenario:
    """Return a scenario with the values identified for a kind of gait.

    Args:
        problem: Problem that was fitted.
        values: Identified values, by the names of the unknowns.
        scenario: Scenario to change; numbers of parts that it does not have are skipped.
        gait_kind: Kind of gait whose own numbers override the general ones; "": only the general
            ones.
    """
    known = list_parameters(scenario, each=True)
    own = _for_gait(problem, values, gait_kind)
    return change_parameters(
        scenario, {name: value for name, value in own.items() if name in known}
    )


def as_parameters(problem: Problem, values: Values, name: str, title: str) -> lc.Parameters:
    """Return the identified values as a parameter file; see `Fit.parameters`."""
    bases = {
        s.gait.kind: s.environment
        for s in reversed(problem.scenarios)
        if isinstance(s.environment, lc.Water)
    }
    if not bases:
        raise BadArgument("measurements", "must be made in water for a parameter file, got ground")
    first = problem.scenarios[0].environment
    first = first if isinstance(first, lc.Water) else next(iter(bases.values()))
    base = problem.scenarios[0]

    def water(of: lc.Water, kind: str) -> lc.Water:
        return cast(
            lc.Water, applied(problem, values, replace(base, environment=of), kind).environment
        )

    common = water(first, "")
    own = {kind: water(bases.get(kind, first), kind) for kind in GAITS}
    joints = applied(problem, values, base, "").model.joints
    changes, own_changes = (
        _changes(problem, values, ""),
        {kind: _changes(problem, values, kind) for kind in GAITS},
    )
    return lc.Parameters(
        name=name,
        title=title,
        joints=joints
        if quantities.quantities_of(type(joints))
        else extensions.name_of(type(joints)),
        every_gait=common,
        own={
            kind: water for kind, water in own.items() if replace(water, name=common.name) != common
        },
        changes=changes,
        own_changes={kind: mine for kind, mine in own_changes.items() if mine != changes},
    )


def _for_gait(problem: Problem, values: Values, gait_kind: str) -> dict[str, float]:
    """Return values by name without scope: the general ones, overridden by those for a kind of gait."""
    chosen = [unknown for unknown in problem.unknowns if unknown.scope in ("", gait_kind)]
    chosen.sort(key=lambda unknown: unknown.scope != "")
    result: dict[str, float] = {}
    for unknown in chosen:
        at = int(np.argmax(problem.moves[:, problem.unknowns.index(unknown)]))
        base, name = problem.scenarios[at], unknown.parameter.name
        result |= with_tied(base, name, values[unknown.name], unknown.tied)
    return result


def _changes(problem: Problem, values: Values, gait_kind: str) -> Changes:
    """Return the changes to the robot that a parameter file can hold.

    Raises:
        ValueError: If a number of the robot was identified that it cannot hold.
    """
    result: Changes = {}
    for name, value in _for_gait(problem, values, gait_kind).items():
        if not name.startswith("robot."):
            continue
        way, _, last = name.rpartition(".")
        table = way.removeprefix("robot.").removeprefix("joint.")
        if (
            table not in NAMES
            or last.endswith(("_x", "_y"))
            or (table == "robot" and last not in FIELDS_OF_ROBOT)
        ):
            rule = f"must be numbers that a parameter file can hold, got `{name}`"
            raise BadArgument("parameters", f"{rule}; `Fit.robot` returns a robot with it")
        result.setdefault(table, {})[last] = value
    return result
