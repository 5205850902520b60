"""A servo with a speed loop: its joint turns at a limited speed whatever the load, within the motor's torque."""

from typing import ClassVar

import numpy as np

from laticauda.motion.joints.laws import SLIDING_RATE, Drive, Servo
from laticauda.values import quantity, tanh, value_class, where

TINY = 1e-30  # [(N m)^2], avoids 0/0 for a motor that is switched off and has nothing to do


@value_class
class SpeedServo(Servo):
    """Servos with speed control, see `speed_servo`; the actuator's motor limits the torque.

    The defaults are assumptions: no limit below the no-load speed of Mamba's servo, a lag of 0.05
    s, and full torque at an error of about 10 % of that speed.
    """

    speed_limit: float = quantity(
        "rad/s", "w_max, of the rate demanded by the position loop", gt=0.0, default=7.5
    )
    position_gain: float = quantity(
        "1/s", "k_w, rate demanded per angle error", gt=0.0, default=20.0
    )
    speed_gain: float = quantity(
        "N m s/rad", "k_u, torque demanded per rate error", gt=0.0, default=4.0
    )

    dt: ClassVar[float | None] = 0.005
    remedy: ClassVar[str] = "a smaller `dt`, or a lower `speed_gain` and `friction_torque`"

    def __call__(
        self,
        angle: float,
        rate: float,
        reference: float,
        reference_rate: float,
        reference_acceleration: float,
        drive: Drive,
    ) -> tuple[float, float, float]:
        """Return the torque and its slopes, see `speed_servo`."""
        return speed_servo(angle, rate, reference, self, drive)[:3]

    def duty(self, angle: float, rate: float, reference: float, drive: Drive) -> float:
        """Return the share of the supply voltage that the motor gets, from -1 to 1 [-].

        Args:
            angle: phi [rad].
            rate: phi' [rad/s].
            reference: phi_ref [rad].
            drive: Numbers of the joint's actuator.
        """
        return speed_servo(angle, rate, reference, self, drive)[3]

    @property
    def words(self) -> str:
        """Name and numbers of the law."""
        return super(Servo, self).words


def speed_servo(
    angle: float, rate: float, reference: float, law: SpeedServo, drive: Drive
) -> tuple[float, float, float, float]:
    """Return the torque of a position loop around a speed loop around a geared DC motor.

        w_ref = clip(k_w (phi_ref - phi), -w_max, w_max)
        s = k_u (w_ref - phi') / u_stall + phi'/phi'_0,    d = s / (1 + s^2)^(1/2)
        u = u_stall (d - phi'/phi'_0) - b phi' - u_c tanh(phi'/eps),    eps = 0.05 rad/s

    s is the duty at which the motor delivers the torque that the speed loop demands; the actual
    duty d is s limited smoothly to between -1 and 1. The driving torque therefore falls along the
    motor's characteristic from `stall_torque` at rest to zero at `no_load_speed`; beyond that
    speed, or driven backward, the motor brakes. With torque to spare, u is k_u (w_ref - phi') minus
    friction: `servo` with a stall torque of k_u w_max, a no-load speed of w_max and a gain of k_w /
    w_max.

    Args:
        angle: phi [rad].
        rate: phi' [rad/s].
        reference: phi_ref [rad].
        law: Law with k_w, w_max and k_u.
        drive: Numbers of the joint's actuator: its u_stall (0: the motor is off), phi'_0, u_c and
            b.

    Returns:
        u [N m], K_p [N m/rad], K_d [N m s/rad], duty d [-]. Where the demanded rate is at its
        limit, K_p = 0.
    """
    position_gain, speed_limit, speed_gain = law.position_gain, law.speed_limit, law.speed_gain
    stall_torque, no_load_speed, friction_torque, viscous_friction = drive[3:]
    aim = position_gain * (reference - angle)
    saturated = (aim.real <= -speed_limit.real) | (aim.real >= speed_limit.real)
    # 0 * aim keeps the number's type, real or complex, for the compiler.
    limit = where(aim.real > 0.0, speed_limit, -speed_limit) + 0.0 * aim
    rate_ref = where(saturated, limit, aim)
    steepness = where(saturated, 0.0 * position_gain, position_gain + 0.0 * speed_limit)
    back = stall_torque / no_load_speed
    asked = speed_gain * (rate_ref - rate) + back * rate  # u_stall s
    root = np.sqrt(asked * asked + stall_torque * stall_torque + TINY)
    duty, share = asked / root, stall_torque / root
    share_of_change = share**3  # of a change of the demand, that the motor answers
    sliding = tanh(rate / SLIDING_RATE)
    torque = stall_torque * duty - back * rate - viscous_friction * rate - friction_torque * sliding
    stiffness = share_of_change * speed_gain * steepness
    grip = viscous_friction + friction_torque / SLIDING_RATE * (1.0 - sliding * sliding)
    damping = share_of_change * (speed_gain - back) + back + grip
    return torque, stiffness, damping, duty
