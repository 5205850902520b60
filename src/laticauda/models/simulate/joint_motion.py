"""Numbers that a gait has for every single yaw joint: `gait.amplitude[4]` and `gait.phase[2]`.

They count from 0 at the tail. An amplitude is that of the joint's own angle, so that it becomes a
share of the gait's amplitude in a custom envelope. A phase is the joint's lead over the wave, see
`Gait.phases`.
"""

from collections.abc import Mapping
from dataclasses import replace

from laticauda.models.simulate.parameter_paths import items_of, strip_items
from laticauda.motion.gaits import Custom, Gait
from laticauda.robot import Robot
from laticauda.values import BadArgument

TITLES = {
    "amplitude": "Amplitude of single yaw joints, from 0 at the tail",
    "phase": "Lead of single yaw joints over the wave, from 0 at the tail",
}
"""Titles of the numbers by the step that leads to them; all are in rad."""


def is_of_joints(step: str) -> bool:
    """Return whether the last step of a gait's number leads to numbers of single joints.

    Args:
        step: The step, such as `amplitude[4]`.
    """
    return items_of(step) is not None and strip_items(step) in TITLES


def list_values(gait: Gait, step: str, robot: Robot) -> list[float]:
    """Return the numbers of the joints that a step is about; empty if the robot has none of them.

    Args:
        gait: The gait.
        step: Step for which `is_of_joints` holds.
        robot: Robot that has the joints.
    """
    n_links = count_joints(robot) + 1
    if strip_items(step) == "phase":
        values = list(gait.joint_phases(n_links))
    else:
        values = [gait.amplitude * share for share in gait.joint_envelope(n_links)]
    return values[items_of(step) or slice(None)]


def change_joints(gait: Gait, changes: Mapping[str, float], robot: Robot) -> Gait:
    """Return a gait with other numbers of single joints.

    Args:
        gait: The gait.
        changes: New values by step, for which `is_of_joints` holds.
        robot: Robot that has the joints.

    Raises:
        ValueError: If there is no such joint, or the gait has no amplitude.
    """
    n_links = count_joints(robot) + 1
    shares = list(gait.joint_envelope(n_links))
    phases = list(gait.joint_phases(n_links))
    for step, value in changes.items():
        joints = range(n_links - 1)[items_of(step) or slice(None)]
        if not joints:
            raise ValueError(f"There is no joint of `gait.{step}`: yaw joints are {n_links - 1}.")
        for joint in joints:
            if strip_items(step) == "phase":
                phases[joint] = value
            else:
                shares[joint] = _share_of(value, gait)
    steps = {strip_items(step) for step in changes}
    if "amplitude" in steps:
        gait = replace(gait, envelope=Custom(values=tuple(shares)))
    if "phase" in steps:
        gait = replace(gait, phases=tuple(phases))
    return gait


def _share_of(amplitude: float, gait: Gait) -> float:
    """Return an amplitude as a share of the gait's."""
    if gait.amplitude == 0.0:
        rule = "must be > 0 for joints with amplitudes of their own, which are shares of it"
        raise BadArgument("gait.amplitude", f"{rule}, got 0")
    return amplitude / gait.amplitude


def count_joints(robot: Robot) -> int:
    """Return the number of joints that a gait moves: those that yaw.

    Args:
        robot: Robot that has the joints.
    """
    return sum(joint.axis == "yaw" for joint in robot.joints)
