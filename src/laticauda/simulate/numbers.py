"""Parameters that can be swept: every number in robot, gait, environment and joint law, by a dotted name.

A name is the path to the field: `gait.amplitude`, `water.normal_drag`, `robot.caudal_fin.length`.
The singular of a plural field addresses all of its items alike: `robot.module.mass`,
`robot.joint.actuator.servo_gain`. A pair of numbers is two parameters: `water.current_x`,
`water.current_y`; a flow has each of its numbers: `water.current.height`, and a sum of flows those
of each flow: `water.current.flow[0].height`. `robot.n_links` is the number of links; `joints` has
the numbers of a custom joint law. Units are those of the fields: SI and radians.
"""

import difflib
import functools
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, cast

import numpy as np

from laticauda.errors import BadArgument
from laticauda.quantities import hints_of, quantities_of, texts_of
from laticauda.robot import Current, Environment, Water
from laticauda.scenarios import Scenario
from laticauda.series import SERIES
from laticauda.trial import Trial

Changes = dict[str, Any]

_FIGURES = "forward_velocity steady_velocity mechanical_power net_power positive_power mean_power cost_of_transport"
UNITS = {name: getattr(Trial, name).unit for name in _FIGURES.split()} | {
    "x": "m",
    "y": "m",
    "heading": "rad",
}
"""Figures of a trial that depend on its parameters, with their units."""

_SINGULAR = {
    "modules": "module",
    "joints": "joint",
    "thrusters": "thruster",
    "pectoral_fins": "pectoral_fin",
}
_EACH = {"flows": "flow"}  # items whose numbers are never addressed together
_PLURAL = {one: several for several, one in (_SINGULAR | _EACH).items()}
_ENDS = ("_x", "_y", "_z")
_ONE = re.compile(r"(\w+)\[(\d+)\]")  # one of several: module[3]
_WHOLE, _NUMBER = ((kind, kind | None) for kind in (int, float))  # field types
_AXES = (tuple[float, float], tuple[float, float] | None, tuple[float, float, float], Current)


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A number that can be swept."""

    name: str
    """Dotted path to the field."""
    unit: str
    """Its unit; "" for a pure number."""
    title: str
    """Title, in a few words."""
    is_whole: bool = False
    """Whether it is a count, and must be a whole number."""

    @property
    def phrase(self) -> str:
        """Name in words, as on a plot axis: height of the caudal fin."""
        root, *owners, last = self.name.split(".")
        last, axis = (last[:-2], f", {last[-1]}") if last.endswith(_ENDS) else (last, "")
        words = last.replace("_", " ")
        words = f"number of {words[2:]}" if last.startswith("n_") else words
        if (root, last) == ("gait", "frequency"):
            words = f"angular {words}"
        return " of ".join([words, *map(_owner, reversed(owners))]) + axis


def _owner(step: str) -> str:
    """Return what a step of a name stands for, in words."""
    one = _ONE.fullmatch(step)
    return (f"{one[1]} {one[2]}" if one else f"the {_PLURAL.get(step, step)}").replace("_", " ")


def described(title: str, unit: str) -> dict[str, str]:
    """Return the attributes of a Dataset variable, from which xarray's plots take their axis labels.

    Args:
        title: Title, a phrase.
        unit: Unit; "" for a pure number.
    """
    return {"long_name": title, "units": unit or "1"}


def of_figure(name: str) -> dict[str, str]:
    """Return the attributes for a figure of a trial, for the final value of a series, or for `succeeded`.

    Args:
        name: Name of the figure or the series.
    """
    if name == "succeeded":
        return {"long_name": "whether the run reached its end"}
    if name in SERIES:
        return described(f"{SERIES[name].text}, at the end", SERIES[name].units)
    return described(getattr(Trial, name).title, getattr(Trial, name).unit)


def list_parameters(scenario: Scenario, *, each: bool = False) -> dict[str, Parameter]:
    """Return the parameters that can be swept, by name.

    Fins, thrusters and tether drag can be swept if the robot has them; coefficients that are still
    None can be swept.

    Args:
        scenario: The scenario; names of its environment's parameters begin with `water` or
            `ground`.
        each: Whether to list the numbers of every single module and joint as well.
    """
    robot, environment = scenario.robot, scenario.environment
    found = [
        *_numbers(scenario.gait, "gait"),
        *_numbers(environment, environment_prefix(environment)),
    ]
    found += _numbers(scenario.model.joints, "joints")
    found.append(Parameter(name="robot.n_links", unit="", title="Number of links", is_whole=True))
    found += _numbers(robot, "robot")
    if each:
        for several, one in _SINGULAR.items():
            for i, part in enumerate(getattr(robot, several)):
                found += _numbers(part, f"robot.{one}[{i}]")
    return {parameter.name: parameter for parameter in found}


def environment_prefix(environment: Environment) -> str:
    """Return the prefix of the names of an environment's parameters."""
    return "water" if isinstance(environment, Water) else "ground"


def look_up(name: object, known: Mapping[str, Parameter], argument: str = "points") -> Parameter:
    """Return the parameter of a given name.

    Args:
        name: Dotted name of the parameter.
        known: Parameters that can be swept.
        argument: Argument that holds the names, for error messages.

    Raises:
        ValueError: If there is none; the message gives the nearest names.
    """
    if isinstance(name, str) and name in known:
        return known[name]
    hint = suggest_names(name, known) if isinstance(name, str) else ""
    medium = "ground" if any(one.startswith("ground.") for one in known) else "water"
    rule = f"must name numbers of gait, {medium} or robot, such as `gait.amplitude`, got {name!r}{hint}"
    raise BadArgument(argument, rule)


def change_parameters(scenario: Scenario, values: Mapping[str, float]) -> Scenario:
    """Return a scenario with other values of its parameters; unchanged parts remain the same objects.

    Args:
        scenario: The original scenario.
        values: New values by parameter name; all names must be known.

    Raises:
        ValueError: If a value is out of its range, or the values are incompatible.
    """
    wanted: Changes = {}
    for name, value in values.items():
        *way, last = name.split(".")
        inner = wanted
        for step in way:
            inner = inner.setdefault(step, {})
        inner[last] = value
    if not wanted:
        return scenario
    robot, environment, body = scenario.robot, scenario.environment, dict(wanted.get("robot", {}))
    if "n_links" in body:
        robot = robot.with_links(int(body.pop("n_links")))
    return replace(
        scenario,
        robot=_applied(robot, body),
        motion=_applied(scenario.gait, wanted["gait"]) if "gait" in wanted else scenario.motion,
        environment=_applied(environment, wanted.get(environment_prefix(environment), {})),
        model=_applied(scenario.model, {"joints": wanted["joints"]})
        if "joints" in wanted
        else scenario.model,
    )


def _applied(thing: Any, wanted: Changes) -> Any:
    """Return a dataclass with other values at the ends of the paths in `wanted`, all validated at once."""
    if not wanted:
        return thing
    new: Changes = {}
    for step, value in wanted.items():
        name, some = _place(thing, step)
        held = new.get(name, getattr(thing, name))
        if some is None:
            new[name] = _other(held, value)
        else:
            several = list(held)
            made = {
                id(one): _other(one, value) for one in several[some]
            }  # items that were the same object remain so
            several[some] = [made[id(one)] for one in several[some]]
            new[name] = tuple(several)
    whole = {name: int(new[name]) for name in new.keys() & _whole_fields(thing.__class__)}
    return replace(thing, **new | whole)


def _other(held: Any, value: Any) -> Any:
    """Return the replacement for a number, or for an object whose numbers change."""
    return _applied(held, cast("Changes", value)) if isinstance(value, dict) else value


def _place(thing: Any, step: str) -> tuple[str, slice | None]:
    """Return the field that a step of a name leads to, and a slice of its items or numbers; None: a single item."""
    one = _ONE.fullmatch(step)
    if one:
        return _PLURAL[one[1]], slice(int(one[2]), int(one[2]) + 1)
    if step in _PLURAL and hasattr(thing, _PLURAL[step]):  # a driven fin has a single joint
        return _PLURAL[step], slice(None)
    if step.endswith(_ENDS) and not hasattr(thing, step):
        end = _ENDS.index(step[-2:])
        return step[:-2], slice(end, end + 1)
    return step, None


def _numbers(thing: Any, prefix: str) -> Iterator[Parameter]:
    """Yield the numbers in a dataclass and in its parts."""
    kind = cast("type[object]", type(thing))
    hints, texts, numbers = hints_of(kind), texts_of(kind), quantities_of(kind)
    for field in fields(thing):
        value = getattr(thing, field.name)
        name, title = f"{prefix}.{field.name}", texts[field.name]
        unit = numbers[field.name].unit if field.name in numbers else ""
        if hints[field.name] in (*_WHOLE, *_NUMBER):
            yield Parameter(name=name, unit=unit, title=title, is_whole=hints[field.name] in _WHOLE)
        elif is_dataclass(value):
            yield from _numbers(value, name)
        elif hints[field.name] in _AXES:
            for end in _ENDS[: len(value or "xy")]:
                yield Parameter(name=name + end, unit=unit, title=f"{title}: {end[1]}")
        elif field.name in _EACH:
            for i, one in enumerate(value):
                yield from _numbers(one, f"{prefix}.{_EACH[field.name]}[{i}]")
        elif field.name in _SINGULAR and value:
            yield from _numbers(value[0], f"{prefix}.{_SINGULAR[field.name]}")


@functools.cache
def _whole_fields(kind: type) -> frozenset[str]:
    return frozenset(name for name, hint in hints_of(kind).items() if hint in _WHOLE)


def check_whole(parameter: Parameter, values: Any) -> None:
    """Reject fractions where only whole numbers are meaningful.

    Args:
        parameter: The parameter that is swept.
        values: Array of its values.

    Raises:
        ValueError: If a value is not a whole number.
    """
    fractions = values[values != np.rint(values)]
    if parameter.is_whole and fractions.size:
        raise ValueError(f"`{parameter.name}` must be a whole number, got {fractions[0]}.")


def value_of(name: str, scenario: Scenario, argument: str = "names") -> float:
    """Return the value of a parameter in a scenario.

    Args:
        name: Dotted name of the parameter.
        scenario: The scenario that contains it.
        argument: Argument that holds the names, for error messages.

    Raises:
        ValueError: If it differs among the modules or joints that it stands for, or is None.
    """
    root, *way = name.split(".")
    environment = scenario.environment
    roots = {"robot": scenario.robot, "gait": scenario.gait, "joints": scenario.model.joints}
    things: list[Any] = [roots.get(root, environment)]
    for step in way:
        things = [part for thing in things for part in _parts(thing, step)]
    # A coefficient of a module or fin that is None takes the water's value.
    things = [getattr(environment, way[-1], None) if thing is None else thing for thing in things]
    if len(set(things)) > 1:
        rule = f"must be of numbers that are the same in all parts, got `{name}`, {sorted(set(things))}"
        raise BadArgument(argument, rule)
    if things[0] is None:
        raise BadArgument(
            argument, f"must be of numbers that the trial has, got `{name}`, which is None"
        )
    return float(things[0])


def _parts(thing: Any, step: str) -> Sequence[Any]:
    """Return the objects or numbers that a step of a name leads to."""
    name, some = _place(thing, step)
    found = getattr(thing, name)
    return [found] if some is None else found[some]


def suggest_names(name: str, known: Collection[str]) -> str:
    """Return the end of an error message about a mistyped name: up to three similar names or name ends, or "".

    Args:
        name: The name as typed.
        known: Valid names.
    """
    plain = name.casefold().replace("-", "_")
    by_end: dict[str, list[str]] = {}
    for word in (word for word in known if "[" not in word):
        by_end.setdefault(word.rsplit(".", 1)[-1], []).append(word)
    ends = difflib.get_close_matches(plain.rsplit(".", 1)[-1], by_end, n=2, cutoff=0.75)
    found = [word for end in ends for word in by_end[end]]
    found.sort(key=lambda word: -difflib.SequenceMatcher(None, plain, word).ratio())
    nearest = list(dict.fromkeys([*found, *difflib.get_close_matches(plain, known, n=3)]))[:3]
    return f"; the nearest are {', '.join(f'`{word}`' for word in nearest)}" if nearest else ""
