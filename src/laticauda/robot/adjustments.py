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
from dataclasses import replace
from typing import Any, TypeAlias

from laticauda.codec import BadKey, Table, arguments_of, check_keys, decode, encode, table_of
from laticauda.quantities import quantities_of
from laticauda.robot.body import Actuator, Joint
from laticauda.robot.effectors import CaudalFin, Tether
from laticauda.robot.robot import Robot

Adjustments: TypeAlias = Mapping[str, Mapping[str, Any]]
"""By table, by field: the value that the robot has instead of its own."""

SECTIONS: dict[str, type[Any]] = {"joint": Joint, "actuator": Actuator, "caudal_fin": CaudalFin, "tether": Tether}
OF_ROBOT = ("active_power", "electronics_power")
REFUSED = {
    "axis": "a parameter file does not turn joints",
    "actuator": "the table `actuator` beside it is for that",
}
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
    of_joint, of_actuator = adjustments.get("joint", {}), dict(adjustments.get("actuator", {}))
    if of_joint or of_actuator:
        of_actuator |= {"stated": True} if of_actuator else {}
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
    return encode({name: values for name, values in adjustments.items() if values})


def _read(name: str, table: object, path: str) -> dict[str, Any]:
    values = table_of(table, path)
    for key, value in values.items():
        if value is None:
            raise BadKey(f"{path}.{key}", "must be left out where the robot's own value is meant, got None")
    if name == "robot":
        check_keys(values, OF_ROBOT, path)
        with arguments_of(path):
            return {key: quantities_of(Robot)[key].checked(key, value) for key, value in values.items()}
    for key in sorted(REFUSED.keys() & values if name == "joint" else ()):
        raise BadKey(f"{path}.{key}", f"must not be given: {REFUSED[key]}")
    read = decode(SECTIONS[name], values, path)
    fields = (key if hasattr(read, key) else key.removesuffix("_deg") for key in values)
    return {field: getattr(read, field) for field in fields}
