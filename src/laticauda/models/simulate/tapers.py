"""Tapers: a quantity of all modules along the body by three numbers, such as `robot.taper.mass.head`.

The quantity is any number that all modules have: `mass`, `length`, `section.half_width`.

tail   what the module at the tail has
head   what the one at the head has
bulge  how much more the middle of the body has than the mean of both ends

A change of `tail` adds to all modules, all of it at the tail and falling linearly to nothing at the
head; `head` likewise; `bulge` adds a parabola that leaves both ends alone. So `tail` and `head` make a
linear taper of a uniform body, and all three a quadratic one; what else makes modules differ is kept.
"""

from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from operator import attrgetter
from typing import Any, NamedTuple, cast

import numpy as np
from jaxtyping import Float

from laticauda.models.simulate.parameter_paths import apply_changes, nest_by_step
from laticauda.robot import Robot
from laticauda.values import BadArgument, hints_of

TAPER = "taper"
"""Step of a name that leads from a robot to its tapers."""
TITLES = {
    "tail": "at the tail of a taper along the body",
    "head": "at the head of a taper along the body",
    "bulge": "in the middle of the body above the mean of both ends",
}
"""Ends of the titles of a taper's numbers, by the last step of their names."""
LEAST_MODULES = {"tail": 2, "head": 2, "bulge": 3}
"""Modules that a robot must have for each of them."""


class TaperNumber(NamedTuple):
    """A number of a taper, as it is named."""

    quantity: str
    """Path to the modules' quantity, such as `mass` or `section.half_width`."""
    number: str
    """tail, head or bulge."""


def find_taper(name: str) -> TaperNumber | None:
    """Return what a name says of a taper; None for the name of anything else.

    Args:
        name: Name of a parameter, such as `robot.taper.mass.head`.
    """
    path = name.removeprefix(f"robot.{TAPER}.")
    quantity, _, number = path.rpartition(".")
    if path == name or not quantity or number not in TITLES:
        return None
    return TaperNumber(quantity=quantity, number=number)


def list_quantities(robot: Robot) -> list[str]:
    """Return the paths to the modules' numbers that can be tapered: those that every module has.

    Args:
        robot: The robot.
    """
    return _paths_to_numbers(robot.modules)


def _paths_to_numbers(values: Sequence[Any]) -> list[str]:
    """Return the paths to numbers that all values of a class have."""
    class_of_values: type[Any] = values[0].__class__
    hints = hints_of(class_of_values)
    paths: list[str] = []
    for field in fields(class_of_values):
        contents = [getattr(value, field.name) for value in values]
        classes: set[type[object]] = {content.__class__ for content in contents}
        if hints[field.name] in (float, float | None) and None not in contents:
            paths.append(field.name)
        elif is_dataclass(contents[0]) and len(classes) == 1:
            paths += [f"{field.name}.{path}" for path in _paths_to_numbers(contents)]
    return paths


def value_of_taper(robot: Robot, taper: TaperNumber) -> float:
    """Return a number of a taper.

    Args:
        robot: The robot.
        taper: The number; its quantity is one of `list_quantities`.
    """
    return _number_of(_values_of(robot, taper.quantity), taper.number)


def _number_of(values: Float[np.ndarray, " n_modules"], number: str) -> float:
    if number == "tail":
        return float(values[0])
    if number == "head":
        return float(values[-1])
    return _middle_of(values) - 0.5 * float(values[0] + values[-1])


def change_tapers(robot: Robot, changes: Mapping[str, Any]) -> Robot:
    """Return a robot with other tapers; modules that are equal remain one object.

    Args:
        robot: The robot.
        changes: New values by name after `taper`, as nested tables, one level per step.

    Raises:
        ValueError: If a quantity cannot be tapered, or a module's value is out of its range.
    """
    for path, value in _flatten(changes).items():
        quantity, _, number = path.rpartition(".")
        if quantity not in list_quantities(robot):
            choices = ", ".join(f"`{name}`" for name in list_quantities(robot))
            rule = f"must be of a quantity that all modules have: {choices}"
            raise BadArgument(f"robot.{TAPER}", f"{rule}, got `{quantity}`")
        values = _values_of(robot, quantity)
        change = value - _number_of(values, number)
        robot = _with_values(robot, quantity, values + change * _shape_of(number, len(values)))
    return robot


def _flatten(changes: Mapping[str, Any]) -> dict[str, float]:
    """Return nested tables as one, by dotted name; numbers that make a taper come tail and head first."""
    flat: dict[str, float] = {}
    for step, change in changes.items():
        if isinstance(change, Mapping):
            table = cast("Mapping[str, Any]", change)
            flat |= {f"{step}.{path}": value for path, value in _flatten(table).items()}
        else:
            flat[step] = change
    return dict(sorted(flat.items(), key=lambda item: item[0].endswith("bulge")))


def _values_of(robot: Robot, quantity: str) -> Float[np.ndarray, " n_modules"]:
    return np.array([attrgetter(quantity)(module) for module in robot.modules])


def _with_values(robot: Robot, quantity: str, values: Float[np.ndarray, " n_modules"]) -> Robot:
    """Return a robot with a value of a quantity for every module."""
    modules: dict[tuple[int, float], Any] = {}
    tapered: list[Any] = []
    for module, value in zip(robot.modules, values.tolist(), strict=True):
        key = id(module), value
        if key not in modules:
            modules[key] = apply_changes(module, nest_by_step({quantity: value}))
        tapered.append(modules[key])
    return replace(robot, modules=tuple(tapered))


def _shape_of(number: str, n_modules: int) -> Float[np.ndarray, " n_modules"]:
    """Return how much of a number's change each module gets."""
    position = np.linspace(0.0, 1.0, n_modules)
    if number == "tail":
        return 1.0 - position
    if number == "head":
        return position
    parabola = position * (1.0 - position)
    return parabola / _middle_of(parabola)


def _middle_of(values: Float[np.ndarray, " n_modules"]) -> float:
    """Return the value of the module in the middle, or the mean of the two there."""
    before = (values.size - 1) // 2
    after = values.size // 2
    return 0.5 * float(values[before] + values[after])
