"""Joints between modules, and the actuators that drive them."""

import math
from dataclasses import dataclass, field
from typing import Literal

from laticauda.errors import instance, not_negative, one_of, positive, within
from laticauda.robot.checks import settle_required

AXES = ("yaw", "pitch")


@dataclass(frozen=True, kw_only=True)
class Actuator:
    """What turns a joint: gains of the `pd` law, and the motor, gear and supply of the `servo` law.

    The servo's defaults are those of the Hitec HSR-5990TG, the servo of Mamba's joints, at 7.4 V. Hitec's figures, as a
    table of its robot servos from 2007 has them [1]: 24 / 30 kg cm and 0.17 / 0.14 s per 60 deg at 6.0 / 7.4 V, hence
    30 kg cm = 2.94 N m and 60 deg / 0.14 s = 7.48 rad/s. They hold at the output shaft, so the gear's losses at
    stall and at full speed are in them already, and the friction given here comes on top of them: 0 by default.

    `tracking` says how much of its reference a joint does that is `prescribed`: joints under `pd` control or with
    `servo`s lose amplitude by themselves and do not look at it.

    Two defaults are not published figures. `stall_current` follows from 1.6 ohm, measured across the motor of the
    sister model HSR-5995TG [2]: 7.4 V / 1.6 ohm = 4.6 A, which makes the gear 64 % efficient. `servo_gain` is an
    assumption: full duty at an error of 10 deg.

    References:
        [1] "HSR Serial Communication", table "Hitec Robot Servos" of 2007-09-23, scribd.com/document/317975179.
        [2] RoboSavvy forum, topic 440, post by i-Bot of 2006-07-29.
    """

    proportional_gain: float = 20.0
    """k_p of the `pd` law [N m/rad]."""
    derivative_gain: float = 5.0
    """k_d of the `pd` law [N m s/rad]."""
    stall_torque: float = 2.9
    """Torque of the servo at full duty and standstill [N m]."""
    no_load_speed: float = 7.5
    """Speed of the servo at full duty and no torque [rad/s]."""
    servo_gain: float = 5.7
    """Duty of the servo per angle error [1/rad]."""
    friction_torque: float = 0.0
    """Dry friction of the gear, beyond what the published figures contain [N m]."""
    viscous_friction: float = 0.0
    """Viscous friction of the gear, likewise [N m s/rad]."""
    voltage: float = 7.4
    """Supply of the servo [V]."""
    stall_current: float = 4.6
    """Current of the servo at full duty and standstill [A]."""
    idle_current: float = 0.0
    """Current of the servo at rest without load; see also `Robot.electronics_power` [A]."""
    tracking: float = 1.0
    """Share of the gait's oscillation that a `prescribed` joint does: its loss of amplitude; not of the offset [-]."""

    def __post_init__(self) -> None:
        settle_required(self, not_negative, "N m/rad", "proportional_gain")
        settle_required(self, not_negative, "N m s/rad", "derivative_gain", "viscous_friction")
        settle_required(self, positive, "N m", "stall_torque")
        settle_required(self, positive, "rad/s", "no_load_speed")
        settle_required(self, positive, "1/rad", "servo_gain")
        settle_required(self, not_negative, "N m", "friction_torque")
        settle_required(self, positive, "V", "voltage")
        settle_required(self, positive, "A", "stall_current")
        settle_required(self, not_negative, "A", "idle_current")
        settle_required(self, positive, "", "tracking")
        within("tracking", self.tracking, 0.0, 1.5)

    @property
    def stall_power(self) -> float:
        """Power at full duty and standstill, V I_stall [W]."""
        return self.voltage * self.stall_current

    @property
    def idle_power(self) -> float:
        """Power at rest without load [W]."""
        return self.voltage * self.idle_current


@dataclass(frozen=True, kw_only=True)
class Joint:
    """A driven hinge between two modules, with the skin that keeps the water out."""

    axis: Literal["yaw", "pitch"] = "yaw"
    """`yaw` bends the body in the swimming plane, `pitch` out of it [-]."""
    limit: float = math.pi / 2.0
    """Largest joint angle to either side; by default the servo's travel [rad]."""
    actuator: Actuator = field(default_factory=Actuator)
    """What drives it (its fields have their own units)."""
    stiffness: float = 0.0
    """k_s of the skin [N m/rad]."""
    damping: float = 0.0
    """d_s of the skin [N m s/rad]."""

    def __post_init__(self) -> None:
        one_of("axis", self.axis, AXES)
        settle_required(self, positive, "rad", "limit")
        within("limit", self.limit, 0.0, math.pi, "rad")
        instance("actuator", self.actuator, Actuator)
        settle_required(self, not_negative, "N m/rad", "stiffness")
        settle_required(self, not_negative, "N m s/rad", "damping")
