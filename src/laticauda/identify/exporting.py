"""Identified values applied to a robot, a water, or a parameter file.

Only values identified in general, or for a kind of gait, apply to other trials. Those of a group or
of a single measurement (such as where it began) belong to its measurements alone, and are left out.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple, cast

import numpy as np

import laticauda as lc
from laticauda.identify.problem import Problem
from laticauda.identify.resolving import is_of_gait, with_tied
from laticauda.identify.unknowns import NUISANCE
from laticauda.models.simulate import change_parameters
from laticauda.models.simulate.numbers import list_parameters
from laticauda.robot import FIELDS_OF_ROBOT, GAITS, NAMES
from laticauda.values import BadArgument, extensions, quantities

Changes = dict[str, dict[str, Any]]
"""Tables of a parameter file, and the numbers in them, by name."""
Values = Mapping[str, float]

_EVERY_GAIT = ""
"""Stands for a kind of gait where only the general values are asked for."""


def applied(problem: Problem, values: Values, scenario: lc.Scenario, gait_kind: str) -> lc.Scenario:
    """Return a scenario with the values identified for a kind of gait.

    Args:
        problem: Problem that was fitted.
        values: Identified values, by the names of the unknowns.
        scenario: Scenario to change; numbers of parts that it does not have are skipped.
        gait_kind: Kind of gait whose own numbers override the general ones; "": only the general
            ones.
    """
    present = list_parameters(scenario)
    numbers = _values_for_gait(problem, values, gait_kind)
    changes = {name: value for name, value in numbers.items() if name in present}
    return change_parameters(scenario, changes)


def as_parameters(problem: Problem, values: Values, name: str, title: str) -> lc.Parameters:
    """Return the identified values as a parameter file, without those of `list_beyond_parameter_file`.

    Args:
        problem: Problem that was fitted.
        values: Identified values, by the names of the unknowns.
        name: Name of the parameters in files and stored trials.
        title: Text for legends.

    Raises:
        ValueError: If the measurements were not made in water.
    """
    waters = _waters_by_gait(problem)
    first_water = problem.scenarios[0].environment
    if not isinstance(first_water, lc.Water):
        first_water = next(iter(waters.values()))
    common_water = _applied_to_water(problem, values, first_water, _EVERY_GAIT)
    common_changes = _robot_changes(problem, values, _EVERY_GAIT)
    own_waters: dict[str, lc.Water] = {}
    own_changes: dict[str, Changes] = {}
    for kind in GAITS:
        water = _applied_to_water(problem, values, waters.get(kind, first_water), kind)
        if replace(water, name=common_water.name) != common_water:
            own_waters[kind] = water
        changes = _robot_changes(problem, values, kind)
        if changes != common_changes:
            own_changes[kind] = changes
    joints = applied(problem, values, problem.scenarios[0], _EVERY_GAIT).model.joints
    law_has_numbers = bool(quantities.quantities_of(type(joints)))
    return lc.Parameters(
        name=name,
        title=title,
        fitted=_names_for_other_trials(problem),
        joints=joints if law_has_numbers else extensions.name_of(type(joints)),
        every_gait=common_water,
        own=own_waters,
        changes=common_changes,
        own_changes=own_changes,
    )


def _names_for_other_trials(problem: Problem) -> tuple[str, ...]:
    """Return the names of the unknowns that hold for other trials than the measured ones, too."""
    return tuple(
        unknown.name
        for unknown in problem.unknowns
        if unknown.scope in (_EVERY_GAIT, *GAITS) and unknown.parameter.name not in NUISANCE
    )


def _waters_by_gait(problem: Problem) -> dict[str, lc.Water]:
    """Return, for each kind of gait, the water of its first measurement in water."""
    waters: dict[str, lc.Water] = {}
    for scenario in reversed(problem.scenarios):
        if isinstance(scenario.environment, lc.Water):
            waters[scenario.gait.kind] = scenario.environment
    if not waters:
        raise BadArgument("measurements", "must be made in water for a parameter file, got ground")
    return waters


def _applied_to_water(
    problem: Problem, values: Values, water: lc.Water, gait_kind: str
) -> lc.Water:
    scenario = replace(problem.scenarios[0], environment=water)
    return cast(lc.Water, applied(problem, values, scenario, gait_kind).environment)


def _values_for_gait(problem: Problem, values: Values, gait_kind: str) -> dict[str, float]:
    """Return values by name without scope: general ones, overridden by those of a kind of gait."""
    numbers = _values_of_scope(problem, values, _EVERY_GAIT)
    if gait_kind != _EVERY_GAIT:
        numbers |= _values_of_scope(problem, values, gait_kind)
    return numbers


def _values_of_scope(problem: Problem, values: Values, scope: str) -> dict[str, float]:
    """Return the values of the unknowns of one scope, and of the numbers tied to them."""
    numbers: dict[str, float] = {}
    for k, unknown in enumerate(problem.unknowns):
        if unknown.scope != scope:
            continue
        # What is tied keeps its proportion in the measurements that depend on the unknown.
        first_dependent = int(np.argmax(problem.depends_on[:, k]))
        scenario = problem.scenarios[first_dependent]
        value = values[unknown.name]
        numbers |= with_tied(scenario, unknown.parameter.name, value, unknown.tied)
    return numbers


def _robot_changes(problem: Problem, values: Values, gait_kind: str) -> Changes:
    """Return the changes to the robot that a parameter file can hold."""
    changes: Changes = {}
    for name, value in _values_for_gait(problem, values, gait_kind).items():
        place = _place_in_file(name)
        if name.startswith("robot.") and _can_hold(place):
            changes.setdefault(place.table, {})[place.field_name] = value
    return changes


def list_beyond_parameter_file(problem: Problem) -> tuple[str, ...]:
    """Return the identified numbers of robot and gait that a parameter file cannot hold, by name without scope.

    It has tables for all joints, the fin and the robot as a whole, and none for single parts.

    Args:
        problem: Problem that was fitted.
    """
    names: dict[str, None] = {}
    for unknown in problem.unknowns:
        if unknown.scope not in (_EVERY_GAIT, *GAITS):
            continue
        for name in (unknown.parameter.name, *unknown.tied):
            is_of_robot = name.startswith("robot.")
            if is_of_gait(name) or (is_of_robot and not _can_hold(_place_in_file(name))):
                names[name] = None
    return tuple(names)


def check_parameter_file_holds(problem: Problem) -> None:
    """Reject identified numbers that a parameter file cannot hold.

    Args:
        problem: Problem that was fitted.

    Raises:
        ValueError: If there are some.
    """
    for name in list_beyond_parameter_file(problem):
        rule = f"must be numbers that a parameter file can hold, got `{name}`"
        holder = "`Fit.robot` returns a robot with it"
        if is_of_gait(name):
            holder = "the gait of `first_scenario` has it"
        raise BadArgument("parameters", f"{rule}; {holder}")


class _Place(NamedTuple):
    """Where a number of the robot stands in a parameter file, if it can hold it."""

    table: str
    field_name: str


def _place_in_file(name: str) -> _Place:
    path, _, field_name = name.rpartition(".")
    return _Place(path.removeprefix("robot.").removeprefix("joint."), field_name)


def _can_hold(place: _Place) -> bool:
    """Return whether a parameter file can hold a number of the robot."""
    if place.table not in NAMES or place.field_name.endswith(("_x", "_y")):
        return False
    return place.table != "robot" or place.field_name in FIELDS_OF_ROBOT
