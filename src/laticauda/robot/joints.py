"""Joints between modules, and the actuators that drive them."""

import math
from typing import Literal

from laticauda.quantities import option, quantity, value


@value
class Actuator:
    """What turns a joint: gains of the `pd` law, and the motor, gear and supply of the `servo` law.

    The servo's defaults are those of the Hitec HSR-5990TG, the servo of Mamba's joints, at 7.4 V. Hitec's figures, as a
    table of its robot servos from 2007 has them [1]: 24 / 30 kg cm and 0.17 / 0.14 s per 60 deg at 6.0 / 7.4 V, hence
    30 kg cm = 2.94 N m and 60 deg / 0.14 s = 7.48 rad/s. They hold at the output shaft, so the gear's losses at
    stall and at full speed are in them already, and the friction given here comes on top of them: 0 by default.

    `tracking` says how much of its reference a joint does that is `prescribed`, the offset not counted: joints under
    `pd` control or with `servo`s lose amplitude by themselves and do not look at it.

    Two defaults are not published figures. `stall_current` follows from 1.6 ohm, measured across the motor of the
    sister model HSR-5995TG [2]: 7.4 V / 1.6 ohm = 4.6 A, which makes the gear 64 % efficient. `servo_gain` is an
    assumption: full duty at an error of 10 deg.

    References:
        [1] "HSR Serial Communication", table "Hitec Robot Servos" of 2007-09-23, scribd.com/document/317975179.
        [2] RoboSavvy forum, topic 440, post by i-Bot of 2006-07-29.
    """

    proportional_gain: float = quantity("N m/rad", "k_p of the `pd` law", ge=0.0, default=20.0)
    derivative_gain: float = quantity("N m s/rad", "k_d of the `pd` law", ge=0.0, default=5.0)
    stall_torque: float = quantity("N m", "Torque of the servo at full duty and standstill", gt=0.0, default=2.9)
    no_load_speed: float = quantity("rad/s", "Speed of the servo at full duty and no torque", gt=0.0, default=7.5)
    servo_gain: float = quantity("1/rad", "Duty of the servo per angle error", gt=0.0, default=5.7)
    friction_torque: float = quantity("N m", "Dry friction of the gear, beyond the figures", ge=0.0, default=0.0)
    viscous_friction: float = quantity("N m s/rad", "Viscous friction of the gear, likewise", ge=0.0, default=0.0)
    voltage: float = quantity("V", "Supply of the servo", gt=0.0, default=7.4)
    stall_current: float = quantity("A", "Current of the servo at full duty and standstill", gt=0.0, default=4.6)
    idle_current: float = quantity("A", "Current of the servo at rest without load", ge=0.0, default=0.0)
    tracking: float = quantity(
        "", "Share of the oscillation that a `prescribed` joint does", gt=0.0, le=1.5, default=1.0
    )

    @property
    def stall_power(self) -> float:
        """Power at full duty and standstill, V I_stall [W]."""
        return self.voltage * self.stall_current

    @property
    def idle_power(self) -> float:
        """Power at rest without load [W]."""
        return self.voltage * self.idle_current


@value
class Joint:
    """A driven hinge between two modules, with the skin that keeps the water out.

    Its limit is by default the servo's travel.
    """

    counted = ("axis",)  # keys that may be lists in an entry of a file with a `count`
    axis: Literal["yaw", "pitch"] = option("`yaw` bends the body in the plane, `pitch` out of it", default="yaw")
    limit: float = quantity("rad", "Largest angle, to either side", gt=0.0, le=math.pi, default=math.pi / 2.0)
    actuator: Actuator = option("What drives it", default_factory=Actuator)
    stiffness: float = quantity("N m/rad", "k_s of the skin", ge=0.0, default=0.0)
    damping: float = quantity("N m s/rad", "d_s of the skin", ge=0.0, default=0.0)
