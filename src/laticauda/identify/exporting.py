"""What was identified, put into a robot, a water, or a parameter file."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, cast

import numpy as np

import laticauda as lc
from laticauda import extensions, quantities
from laticauda.errors import BadArgument
from laticauda.identify.problem import Problem
from laticauda.identify.unknowns import with_tied
from laticauda.robot.parameters import GAITS, NAMES, OF_ROBOT
from laticauda.simulate.numbers import changed, parameters

Changes = dict[str, dict[str, Any]]
Values = Mapping[str, float]


def applied(problem: Problem, values: Values, scenario: lc.Scenario, gait_kind: str) -> lc.Scenario:
    """A scenario with what was identified for a kind of gait.

    Args:
        problem: What was fitted.
        values: What was found, by the names of the unknowns.
        scenario: What to change; numbers of what it does not have are left out.
        gait_kind: Whose own numbers win over the general ones; "": the general ones only.
    """
    known = parameters(scenario, each=True)
    own = _for_gait(problem, values, gait_kind)
    return changed(scenario, {name: value for name, value in own.items() if name in known})


def as_parameters(problem: Problem, values: Values, name: str, title: str) -> lc.Parameters:
    """What was identified as a parameter file has it; see `Fit.parameters`."""
    bases = {s.gait.kind: s.environment for s in reversed(problem.scenarios) if isinstance(s.environment, lc.Water)}
    if not bases:
        raise BadArgument("measurements", "must be made in water for a parameter file, got ground")
    first = problem.scenarios[0].environment
    first = first if isinstance(first, lc.Water) else next(iter(bases.values()))
    base = problem.scenarios[0]

    def water(of: lc.Water, kind: str) -> lc.Water:
        return cast(lc.Water, applied(problem, values, replace(base, environment=of), kind).environment)

    common = water(first, "")
    own = {kind: water(bases.get(kind, first), kind) for kind in GAITS}
    joints = applied(problem, values, base, "").model.joints
    changes, own_changes = _changes(problem, values, ""), {kind: _changes(problem, values, kind) for kind in GAITS}
    return lc.Parameters(
        name=name,
        title=title,
        joints=joints if quantities.quantities_of(type(joints)) else extensions.name_of(type(joints)),
        every_gait=common,
        own={kind: water for kind, water in own.items() if replace(water, name=common.name) != common},
        changes=changes,
        own_changes={kind: mine for kind, mine in own_changes.items() if mine != changes},
    )


def _for_gait(problem: Problem, values: Values, gait_kind: str) -> dict[str, float]:
    """Values by name without scope: those for all, and over them those for a kind of gait."""
    chosen = [unknown for unknown in problem.unknowns if unknown.scope in ("", gait_kind)]
    chosen.sort(key=lambda unknown: unknown.scope != "")
    result: dict[str, float] = {}
    for unknown in chosen:
        at = int(np.argmax(problem.moves[:, problem.unknowns.index(unknown)]))
        base, name = problem.scenarios[at], unknown.parameter.name
        result |= with_tied(base, name, values[unknown.name], unknown.tied)
    return result


def _changes(problem: Problem, values: Values, gait_kind: str) -> Changes:
    """What a parameter file can say about the robot.

    Raises:
        ValueError: If something was identified of the robot that it cannot say.
    """
    result: Changes = {}
    for name, value in _for_gait(problem, values, gait_kind).items():
        if not name.startswith("robot."):
            continue
        way, _, last = name.rpartition(".")
        table = way.removeprefix("robot.").removeprefix("joint.")
        if table not in NAMES or last.endswith(("_x", "_y")) or (table == "robot" and last not in OF_ROBOT):
            rule = f"must be numbers that a parameter file has a table for, got `{name}`"
            raise BadArgument("parameters", f"{rule}; `Fit.robot` makes a robot with it")
        result.setdefault(table, {})[last] = value
    return result
