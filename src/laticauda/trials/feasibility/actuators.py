"""What joints and actuators offer: angles up to a limit, and torques up to a torque-speed line.

The torque available from an actuator at the rate phi', in the direction of u, follows its
torque-speed line, u_stall (1 - phi'/phi'_0) less its own friction. This is its `servo` law
inverted; the duty must stay within -1 and 1:

    d = (u + b phi' + u_c tanh(phi'/eps)) / u_stall + phi'/phi'_0

When it brakes (phi' < 0 in that formula), more torque is available than at standstill. So a joint
that the water turns faster than phi'_0 is not beyond its motor, which only brakes it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda.motion.joints import SLIDING_RATE
from laticauda.robot import Actuator, Robot

Joints: TypeAlias = Float[np.ndarray, "n_samples n_joints n_runs"]
JointLimits: TypeAlias = Float[np.ndarray, "n_joints n_runs"]


@dataclass(frozen=True)
class TorqueSpeedLine:
    """What a motor can do; one whose data are not stated has no limits."""

    stall_torque: float
    """Torque at standstill [N m]."""
    no_load_speed: float
    """Rate without load [rad/s]."""
    dry_friction: float
    """Friction torque at any rate [N m]."""
    viscous_friction: float
    """Friction torque per rate [N m s]."""

    @classmethod
    def of(cls, actuator: Actuator) -> "TorqueSpeedLine":
        """Return the torque-speed line of an actuator."""
        if not actuator.stated:
            return cls(
                stall_torque=math.inf,
                no_load_speed=math.inf,
                dry_friction=0.0,
                viscous_friction=0.0,
            )
        return cls(
            stall_torque=actuator.stall_torque,
            no_load_speed=actuator.no_load_speed,
            dry_friction=actuator.friction_torque,
            viscous_friction=actuator.viscous_friction,
        )

    def available_torque(self, rate: float) -> float:
        """Return the torque that is available at a rate in its direction; not less than 0 [N m].

        Args:
            rate: phi' in the direction of the torque; negative if the motor brakes [rad/s].
        """
        torque = self.stall_torque * (1.0 - rate / self.no_load_speed)
        friction = self.dry_friction * math.tanh(rate / SLIDING_RATE)
        return max(0.0, torque - self.viscous_friction * rate - friction)


@dataclass(frozen=True)
class Offer:
    """What the driven joints of many runs offer."""

    joint_limit: JointLimits
    """Largest angle [rad]."""
    stall_torque: JointLimits
    """Torque at standstill [N m]."""
    no_load_speed: JointLimits
    """Rate without load [rad/s]."""
    dry_friction: JointLimits
    """Friction torque at any rate [N m]."""
    viscous_friction: JointLimits
    """Friction torque per rate [N m s]."""

    @classmethod
    def of(cls, robots: Sequence[Robot]) -> "Offer":
        """Return what the robots offer, one robot per run.

        A robot that swims in many of the runs is read once.
        """
        rows_by_robot = {id(robot): _limit_rows(robot) for robot in robots}
        rows = np.array([rows_by_robot[id(robot)] for robot in robots])
        return cls(*rows.reshape(len(robots), -1, 5).T)


def _limit_rows(robot: Robot) -> list[tuple[float, ...]]:
    """Return the numbers of every driven joint, in the order of the fields of `Offer`."""
    rows: list[tuple[float, ...]] = []
    for joint in robot.driven_joints:
        motor = TorqueSpeedLine.of(joint.actuator)
        rows.append(
            (
                joint.limit,
                motor.stall_torque,
                motor.no_load_speed,
                motor.dry_friction,
                motor.viscous_friction,
            )
        )
    return rows


def duty(robots: Sequence[Robot], rate: Joints, torque: Joints) -> Joints:
    """Compute the duty d that the actuators would need; beyond -1 and 1 they cannot follow.

    Args:
        robots: One robot per run, in its planar form for runs in the plane.
        rate: phi' of the driven joints, tail first, followed by that of a driven fin [rad/s].
        torque: u [N m].
    """
    return duty_from_offer(Offer.of(robots), rate, torque)


def driven_rate(rate: Joints, torque: Joints) -> Joints:
    """Return the rate where the motor drives the joint, and 0 where it brakes it [rad/s].

    Args:
        rate: phi' [rad/s].
        torque: u [N m].
    """
    return np.where(rate * torque < 0.0, 0.0, rate)


def duty_from_offer(offer: Offer, rate: Joints, torque: Joints) -> Joints:
    """Compute the same as `duty`, from what the joints offer."""
    per_rate = offer.viscous_friction / offer.stall_torque + 1.0 / offer.no_load_speed
    without_dry_friction = torque / offer.stall_torque + rate * per_rate
    if not np.any(offer.dry_friction):
        return without_dry_friction
    dry_share = offer.dry_friction / offer.stall_torque
    return without_dry_friction + dry_share * np.tanh(rate / SLIDING_RATE)
