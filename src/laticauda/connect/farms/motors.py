"""Motors and muscles of a FARMS animat as a joint law, and as the actuators of the robot.

`position_muscle` is a position servo, u = k_p (q_cmd - q) - k_v q', limited; `ekeberg_muscle` two springs:

    u = alpha (x_right - x_left) + (x_left + x_right + gamma) beta (q_0 - q) - delta q'

The activations x = A (1 + cos(theta)) of FARMS add up to 2 A all the time; those of `Ekeberg` are the two
halves of the reference and add up to 2 A / pi on average. `tonic` makes up for the difference. Joints that
are moved by anything else get the servos that `Actuator` has by default.
"""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from laticauda.connect.farms.entries import Entry
from laticauda.connect.farms.remarks import Remarks
from laticauda.motion.joints import Ekeberg, JointLaw, Servo
from laticauda.robot import Actuator
from laticauda.values import BadArgument

SERVO_EQUATION = "position_muscle"
MUSCLE_EQUATIONS = frozenset({"ekeberg_muscle", "ekeberg_muscle_explicit"})
UNLIMITED_SPEED = 1e4
"""No-load speed of a servo without damping: it never matters [rad/s]."""


LARGEST_ERROR = math.pi
"""Error of an angle that a servo never has: a torque beyond that at this error is no limit [rad]."""


class Drivetrain(NamedTuple):
    """What moves the joints."""

    law: JointLaw
    """Law by which they follow their references."""
    actuators: Mapping[str, Actuator]
    """Actuators, by the names of the joints."""


USUAL_SERVOS = Drivetrain(law=Servo(), actuators={})
"""Servos of joints whose motors are not understood."""


def build_drivetrain(
    motors: Sequence[Entry],
    muscles: Sequence[Entry],
    amplitude: float,
    remarks: Remarks,
) -> Drivetrain:
    """Return what moves the joints of the spine.

    Args:
        motors: Their entries among the motors, in any order.
        muscles: Their entries among the muscles.
        amplitude: Amplitude of the references, on average over the joints [rad].
        remarks: Remarks, to which is added what is not taken as it is.
    """
    equations = {motor.text("equation", "none") for motor in motors}
    if equations == {SERVO_EQUATION}:
        return _build_servos(motors, remarks)
    if equations and equations <= MUSCLE_EQUATIONS and muscles:
        law = _build_muscles(muscles, amplitude, remarks)
        return Drivetrain(law=law, actuators={})
    if equations:
        listed = ", ".join(sorted(equations))
        remarks.append(f"motors with the equation {listed}: joints have servos instead")
    return USUAL_SERVOS


def _build_servos(motors: Sequence[Entry], remarks: Remarks) -> Drivetrain:
    """Return servos with the gains and limits of motors."""
    actuators: dict[str, Actuator] = {}
    for motor in motors:
        actuator = _build_servo(motor)
        if actuator is None:
            remarks.append("motors, because some have no gain: joints have servos")
            return USUAL_SERVOS
        name = motor.text("joint_name")
        actuators[name] = actuator
    return Drivetrain(law=Servo(), actuators=actuators)


def _build_servo(motor: Entry) -> Actuator | None:
    """Return a servo; None if the motor has no gain."""
    stiffness, damping = motor.numbers("gains", 2, 0.0)
    torque_limits = motor.limits("limits_torque")
    stall_torque = min(-torque_limits.low, torque_limits.high)
    if stiffness <= 0.0 or stall_torque <= 0.0:
        return None
    stall_torque = min(stall_torque, stiffness * LARGEST_ERROR)
    no_load_speed = UNLIMITED_SPEED
    if damping > 0.0:
        no_load_speed = min(stall_torque / damping, UNLIMITED_SPEED)
    return Actuator(
        stated=False,
        stall_torque=stall_torque,
        no_load_speed=no_load_speed,
        servo_gain=stiffness / stall_torque,
    )


def _build_muscles(
    muscles: Sequence[Entry],
    amplitude: float,
    remarks: Remarks,
) -> Ekeberg:
    """Return one law for all muscles."""
    alpha = _mean("alpha", muscles, remarks)
    beta = _mean("beta", muscles, remarks)
    gamma = _mean("gamma", muscles, remarks)
    delta = _mean("delta", muscles, remarks)
    if any(muscle.number("epsilon", 0.0) for muscle in muscles):
        remarks.append("dry friction of the muscles, epsilon")
    gain = 1.0
    if amplitude > 1.0:
        gain = 1.0 / amplitude  # an activation is 1 at most
    missing_activation = 2.0 * amplitude * (1.0 - gain / math.pi)
    try:
        return Ekeberg(
            gain=gain,
            tone=0.0,
            strength=2.0 * alpha / gain,
            stiffness=beta,
            tonic=gamma + missing_activation,
            damping=delta,
        )
    except BadArgument as refusal:
        raise muscles[0].error(refusal.name, f"of the muscles {refusal.rule}") from None


def _mean(
    name: str,
    muscles: Sequence[Entry],
    remarks: Remarks,
) -> float:
    """Return the mean of a number of the muscles."""
    numbers = [muscle.number(name) for muscle in muscles]
    return remarks.add_mean(f"{name} of the muscles", numbers, "")
