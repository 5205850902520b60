"""The water or ground of a scenario: by default, by name, or changed and named after its changes."""

import functools
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any, cast

from laticauda import robot as robots
from laticauda.motion.gaits import EelLike, Gait
from laticauda.robot import Robot, Water, find, textbook_of
from laticauda.values import Law, check_instance, extensions

MAMBA = ("mamba", "mamba-fin", "mamba-modules", "mamba-modules-fin")
"""The robots whose trials were used to identify the paper's waters."""

preset_water = functools.cache(robots.load_water)


def default_water(robot: Robot, gait: Gait | None = None) -> Water:
    """Return the default water: the textbook's for the robot's shape, or for Mamba the paper's for the gait.

    Args:
        robot: The robot; it is Mamba if its name is one of `MAMBA`.
        gait: Gait of its joints; the paper identified coefficients for each kind, and None selects
            those of lateral undulation.
    """
    check_instance("robot", robot, Robot)
    if robot.name not in MAMBA:
        return textbook_of(robot)
    if gait is not None and isinstance(gait.envelope, EelLike):
        return preset_water("paper-eel")
    return preset_water("paper-lateral")


def water_for(robot: Robot, name: str | None, gait: Gait | None = None) -> Water:
    """Return the water of a given name, or the default water.

    Args:
        robot: The robot.
        name: Name of a preset or a file, or ``textbook``; None: `default_water`.
        gait: Gait of its joints, which selects the coefficients of Mamba's default water; None:
            lateral undulation.

    Raises:
        RobotFileError: If there is no water of that name, or its file is wrong.
    """
    if name is None:
        return default_water(robot, gait)
    return robots.load_water(name, robot)


def environment_of(environment: object, robot: Robot, gait: Gait | None = None) -> Any:
    """Load a water or ground by name or path; anything else is returned unchanged, for others to check.

    Args:
        environment: The environment as the caller states it; None: `default_water`.
        robot: The robot that is to be in it.
        gait: Gait of its joints, for `default_water`.
    """
    if environment is None:
        return default_water(robot, gait)
    if not isinstance(environment, str | Path):
        return environment
    if str(environment) in robots.ground_names():
        return robots.load_ground(environment)
    if str(environment) in (*robots.water_names(), robots.TEXTBOOK):
        return robots.load_water(environment, robot)
    return robots.from_toml(find(environment, "water"))


def named_after(changed: Water, before: Water) -> Water:
    """Return a water whose name states how it differs from an earlier one.

    Args:
        changed: The changed water, with the same name as the earlier one.
        before: The earlier water.
    """
    differences = _differences(changed, before)
    if not differences:
        return before
    changes = ", ".join(f"{name} {_as_text(value)}" for name, value in differences.items())
    return replace(changed, name=f"{before.name} with {changes}")


def _differences(changed: Any, before: Any) -> Mapping[str, Any]:
    """Return the values of the fields that differ, also of those inside of fields."""
    differences: dict[str, Any] = {}
    for field in fields(changed):
        new = getattr(changed, field.name)
        old = getattr(before, field.name, None)
        if new == old:
            continue
        if is_dataclass(new) and type(new) is type(old):
            differences |= _differences(new, old)
        else:
            differences[field.name] = new
    return differences


def _as_text(value: Any) -> str:
    """Return a field's value as it is shown in a name."""
    if isinstance(value, Law):
        return extensions.name_of(type(value))
    if isinstance(value, tuple):
        return f"({', '.join(map(_as_text, cast('tuple[Any, ...]', value)))})"
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, float):
        return f"{value:g}"
    return str(value)
