"""Servos by name: files that state an `Actuator`, and the presets that come with laticauda.

A file states ``kind = "servo"`` and the fields of `Actuator`, in the same units as in a robot file; a
``description`` may say what it is.
"""

from dataclasses import replace
from pathlib import Path

from laticauda.robot.body import Actuator
from laticauda.robot.files import find, preset_names, read_table
from laticauda.robot.robot import Robot
from laticauda.values import RobotFileError, decode, keys_of, take_kind

KIND = "servo"
"""Kind of the files."""


def servo_names() -> tuple[str, ...]:
    """Return the sorted names of the servo presets."""
    return preset_names(KIND)


def load_servo(name_or_path: str | Path) -> Actuator:
    """Load a servo.

    Args:
        name_or_path: A preset's name (`servo_names` lists them), or the path of a TOML file.

    Raises:
        RobotFileError: If there is no such servo (`RobotNotFound`), or its file is invalid.

    Example:
        >>> load_servo("xw540-t140").stall_torque
        6.9
    """
    path = find(name_or_path, KIND)
    with keys_of(str(path), RobotFileError):
        table = read_table(path)
        take_kind(table, KIND)
        table.pop("description", None)
        return decode(Actuator, table)


def with_servos(robot: Robot, servo: Actuator | str | Path) -> Robot:
    """Return a robot all of whose driven joints have one servo.

    Args:
        robot: The robot.
        servo: The servo, the name of a preset, or the path of a file.

    Raises:
        RobotFileError: If there is no such servo, or its file is invalid.

    Example:
        >>> import laticauda as lc
        >>> with_servos(lc.load_robot("chain"), "xw540-t140").joints[0].actuator.no_load_speed
        7.5398223686155035
    """
    if not isinstance(servo, Actuator):
        servo = load_servo(servo)
    fin = robot.caudal_fin
    if fin is not None and fin.joint is not None:
        fin = replace(fin, joint=replace(fin.joint, actuator=servo))
    changed_joints = {joint: replace(joint, actuator=servo) for joint in set(robot.joints)}
    joints = tuple(changed_joints[joint] for joint in robot.joints)
    return replace(robot, joints=joints, caudal_fin=fin)
