"""The kernels' numbers of the joints of a robot, in both models."""

import numpy as np
from jaxtyping import Float

from laticauda.motion.joints import JOINT, Drive, JointLaw
from laticauda.robot import Hinge, Joint, Robot, has_power_model

# Columns of the table; that of the envelope is 0.
ENVELOPE, STIFFNESS, DAMPING, DRIVE, MOTOR, STALL_POWER, LEAD, N_NUMBERS = JOINT


def joint_table(robot: Robot, law: JointLaw) -> Float[np.ndarray, "n_joints n_numbers"]:
    """Return the kernels' numbers of every joint (`laticauda.motion.joints.laws.JOINT`): body, then fin from its root.

    Args:
        robot: Robot with the joints; the passive hinges of its fin have stiffness and damping only.
        law: Law by which the driven joints follow their references.
    """
    has_power = has_power_model(robot, law)
    # Most joints are the same object.
    rows_of_joints: dict[int, np.ndarray] = {}
    table: list[np.ndarray] = []
    for joint in robot.driven_joints:
        if id(joint) not in rows_of_joints:
            rows_of_joints[id(joint)] = _driven_joint_row(joint, law, has_power=has_power)
        table.append(rows_of_joints[id(joint)])
    if robot.caudal_fin is not None:
        table += [_hinge_row(hinge) for hinge in robot.caudal_fin.hinges]
    return np.array(table).reshape(-1, N_NUMBERS)


def _driven_joint_row(joint: Joint, law: JointLaw, *, has_power: bool) -> np.ndarray:
    motor = joint.actuator
    row = np.zeros(N_NUMBERS)
    row[ENVELOPE] = motor.tracking if law.prescribed else 1.0
    row[STIFFNESS] = joint.stiffness
    row[DAMPING] = joint.damping
    for k, name in enumerate(Drive._fields):
        row[DRIVE + k] = getattr(motor, name)
    if has_power:
        row[STALL_POWER] = motor.stall_power
    return row


def _hinge_row(hinge: Hinge) -> np.ndarray:
    row = np.zeros(N_NUMBERS)
    row[STIFFNESS] = hinge.stiffness
    row[DAMPING] = hinge.damping
    return row


def has_hinges(robot: Robot) -> bool:
    """Return whether a robot has a flexible fin.

    Args:
        robot: Robot to check.
    """
    return robot.caudal_fin is not None and robot.caudal_fin.n_hinges > 0
