"""What a parameter file changes about a robot: tables of single numbers for its joints, actuators, fin and electronics.

    [actuator]                 # of every joint
    tracking = 0.92

    [caudal_fin]               # of robots that have one
    normal_drag = 1.4

    [robot]
    active_power = 60.0

The tables are `joint` (but for its axis), `actuator`, `caudal_fin`, `tether` and `robot`; keys are fields of the class.
"""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any, TypeAlias, cast

from laticauda.errors import nearest, not_negative
from laticauda.robot.effectors import CaudalFin, Tether
from laticauda.robot.joints import Actuator, Joint
from laticauda.robot.robot import Robot
from laticauda.robot.tables import BadKey, Table, decode, encode

Adjustments: TypeAlias = Mapping[str, Mapping[str, Any]]
"""By table, by field: the value that the robot has instead of its own."""

SECTIONS: dict[str, type] = {"joint": Joint, "actuator": Actuator, "caudal_fin": CaudalFin, "tether": Tether}
OF_ROBOT = ("active_power", "electronics_power")
NAMES = (*SECTIONS, "robot")


def read_adjustments(tables: Mapping[str, object], path: str = "") -> dict[str, dict[str, Any]]:
    """Check tables as a file has them.

    Args:
        tables: By name, one of `NAMES`.
        path: Where they stand in the file, "" for the top.

    Returns:
        The same with every value as its class keeps it, angles in radians.

    Raises:
        BadKey: If a key is unknown, or its value of the wrong type or out of range.
    """
    return {name: _read(name, table, f"{path}.{name}" if path else name) for name, table in tables.items()}


def adjusted(robot: Robot, adjustments: Adjustments) -> Robot:
    """A robot with other numbers; what it has no part for is left out.

    Args:
        robot: The robot; without a caudal fin, the numbers of one are not used.
        adjustments: From `read_adjustments`.

    Raises:
        ValueError: If a number does not go with what the robot has.
    """
    changes: dict[str, Any] = dict(adjustments.get("robot", {}))
    of_joint, of_actuator = adjustments.get("joint", {}), adjustments.get("actuator", {})
    if of_joint or of_actuator:
        new = {
            joint: replace(joint, actuator=replace(joint.actuator, **of_actuator), **of_joint)
            for joint in set(robot.joints)
        }
        changes["joints"] = tuple(new[joint] for joint in robot.joints)
    if adjustments.get("caudal_fin") and robot.caudal_fin is not None:
        changes["caudal_fin"] = replace(robot.caudal_fin, **adjustments["caudal_fin"])
    if adjustments.get("tether"):
        changes["tether"] = replace(robot.tether, **adjustments["tether"])
    return replace(robot, **changes) if changes else robot


def write_adjustments(adjustments: Adjustments) -> dict[str, Table]:
    """The tables that `read_adjustments` turns back into equal ones."""
    return {
        name: {key: _written(value) for key, value in values.items()} for name, values in adjustments.items() if values
    }


def _read(name: str, table: object, path: str) -> dict[str, Any]:
    if not isinstance(table, Mapping):
        raise BadKey(path, f"must be a table, got {table!r}")
    values = dict(cast("Mapping[str, Any]", table))
    for key, value in values.items():
        if value is None:
            raise BadKey(f"{path}.{key}", "must be left out where the robot's own value is meant, got None")
    if name == "robot":
        return {key: _power(key, value, f"{path}.{key}") for key, value in values.items()}
    if name == "joint":
        _refuse_of_joint(values, path)
    plain = {key: encode(value) if is_dataclass(value) else value for key, value in values.items()}
    kind = SECTIONS[name]
    read = cast("object", decode(kind, plain, path))
    known = {field.name for field in fields(kind)}
    given = (key if key in known else key.removesuffix("_deg") for key in values)
    return {key: getattr(read, key) for key in given}


def _refuse_of_joint(values: Mapping[str, object], path: str) -> None:
    if "axis" in values:
        raise BadKey(f"{path}.axis", "must not be given: a parameter file does not turn joints")
    if "actuator" in values:
        raise BadKey(f"{path}.actuator", "must not be given: the table `actuator` beside it is for that")


def _power(key: str, value: object, path: str) -> float:
    if key not in OF_ROBOT:
        hint = nearest(key, OF_ROBOT) or f"; the keys here are {', '.join(OF_ROBOT)}"
        raise BadKey(path, f"is not known{hint}")
    try:
        return not_negative(key, value, "W")
    except ValueError as error:
        raise BadKey(path, str(error).removeprefix(f"`{key}` ").removesuffix(".")) from None


def _written(value: Any) -> Any:
    if is_dataclass(value):
        return encode(value)
    return list(value) if isinstance(value, tuple) else value  # pyright: ignore[reportUnknownArgumentType, reportUnknownVariableType]
