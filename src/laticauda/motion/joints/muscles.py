"""Muscles in place of motors: two at every joint, one on each side, each with an activation from 0 to 1.

The reference of a joint says which of the two is active and how much: its positive part, times
`gain`, activates the left muscle, its negative part the right one. `tone` activates both, always:
they then hold the joint more stiffly. A controller whose neurons activate muscles commands such
references (`Command.references`); a gait does so, too.

References:
    O. Ekeberg, Biol. Cybern. 69, 1993: a combined neuronal and mechanical model of fish swimming.
    F. E. Zajac, Crit. Rev. Biomed. Eng. 17, 1989: muscle and tendon.
    H. Geyer, A. Seyfarth and R. Blickhan, Proc. R. Soc. B 270, 2003: force and velocity, stretched
    faster than it shortens.
"""

from typing import ClassVar

from laticauda.motion.joints.laws import Drive, JointLaw
from laticauda.values import quantity, value_class, where

SHORTENING_CURVATURE = 5.0
"""K, how fast force falls with the speed of shortening (Geyer et al.) [-]."""
STRETCHED_FORCE = 1.5
"""N, force of a muscle that is stretched fast, per isometric force (Geyer et al.) [-]."""
STRETCHING_STEEPNESS = 7.56 * SHORTENING_CURVATURE
"""How fast force rises with the speed of stretching (Geyer et al.) [-]."""


@value_class
class _Muscles(JointLaw):
    """Two muscles, and how the reference activates them."""

    dt: ClassVar[float | None] = 1.0 / 120.0
    takes_jumps: ClassVar[bool] = True

    gain: float = quantity("1/rad", "Activation per reference", gt=0.0, default=1.0)
    tone: float = quantity("", "Activation of both muscles at rest", ge=0.0, le=1.0, default=0.1)


@value_class
class Ekeberg(_Muscles):
    """Muscles as springs that activation stiffens, see `ekeberg`."""

    is_linear: ClassVar[bool] = True
    remedy: ClassVar[str] = "a smaller `dt`, or a lower `strength`"
    strength: float = quantity(
        "N m", "alpha, torque per difference of activations", ge=0.0, default=2.0
    )
    stiffness: float = quantity("N m/rad", "beta, stiffness per activation", ge=0.0, default=1.0)
    tonic: float = quantity(
        "", "gamma, activation whose stiffness is there without any", ge=0.0, default=1.0
    )
    damping: float = quantity("N m s/rad", "delta", ge=0.0, default=0.4)

    def __call__(
        self,
        angle: float,
        rate: float,
        reference: float,
        reference_rate: float,
        reference_acceleration: float,
        drive: Drive,
    ) -> tuple[float, float, float]:
        """Return the torque and its slopes, see `ekeberg`."""
        return ekeberg(angle, rate, reference, self, drive)


@value_class
class Hill(_Muscles):
    """Muscles whose force depends on their length and speed, see `hill`."""

    remedy: ClassVar[str] = "a smaller `dt`, or a lower `force`"

    force: float = quantity(
        "N", "Isometric force of one muscle, fully active", ge=0.0, default=60.0
    )
    lever: float = quantity("m", "Distance of a muscle from the joint", gt=0.0, default=0.05)
    fiber_length: float = quantity("m", "Length at which it is strongest", gt=0.0, default=0.15)
    largest_speed: float = quantity(
        "1/s", "Speed of shortening without load, in lengths per second", gt=0.0, default=5.0
    )
    width: float = quantity(
        "", "Change of length, per length, at which it has no force left", gt=0.0, default=0.5
    )
    passive_stiffness: float = quantity(
        "N m/rad", "Stiffness of what lies around the joint", ge=0.0, default=0.5
    )
    passive_damping: float = quantity("N m s/rad", "Its damping", ge=0.0, default=0.1)

    def __call__(
        self,
        angle: float,
        rate: float,
        reference: float,
        reference_rate: float,
        reference_acceleration: float,
        drive: Drive,
    ) -> tuple[float, float, float]:
        """Return the torque and its slopes, see `hill`."""
        return hill(angle, rate, reference, self, drive)


def ekeberg(
    angle: float, rate: float, reference: float, law: Ekeberg, drive: Drive
) -> tuple[float, float, float]:
    """Return the torque of two muscles that are springs.

        u = alpha (M_L - M_R) - beta (M_L + M_R + gamma) phi - delta phi'

    Args:
        angle: phi [rad].
        rate: phi' [rad/s].
        reference: phi_ref, which activates the muscles [rad].
        law: Law with its numbers.
        drive: Numbers of the joint's actuator; if it is switched off, nothing activates.

    Returns:
        u [N m], K_p [N m/rad], K_d [N m s/rad], which are the derivatives.
    """
    left = _activation(reference, law.gain, law.tone, drive)
    right = _activation(-reference, law.gain, law.tone, drive)
    stiffness = law.stiffness * (left + right + law.tonic)
    torque = law.strength * (left - right) - stiffness * angle - law.damping * rate
    return torque, stiffness, law.damping + 0.0 * torque


def hill(
    angle: float, rate: float, reference: float, law: Hill, drive: Drive
) -> tuple[float, float, float]:
    """Return the torque of two muscles whose force depends on their length and speed.

        u = r F (M_L f(l_L) g(s_L) - M_R f(l_R) g(s_R)) - k phi - d phi'
        l = 1 -+ r phi / l_0,   s = +- r phi' / (l_0 s_max)       upper sign: left
        f(l) = max(1 - ((l - 1) / w)^2, 0)
        g(s) = (1 - s) / (1 + K s)  while it shortens, s > 0, and 0 beyond s = 1
        g(s) = N + (N - 1) (1 + s) / (7.56 K s - 1)  while it is stretched, s < 0, down to s = -1

    Args:
        angle: phi [rad].
        rate: phi' [rad/s].
        reference: phi_ref, which activates the muscles [rad].
        law: Law with its numbers.
        drive: Numbers of the joint's actuator; if it is switched off, nothing activates.

    Returns:
        u [N m], K_p [N m/rad], K_d [N m s/rad]. K_p is that of what lies around the joint: the
        muscles' own, by their length, may be negative, which an implicit step must not use.
    """
    left = _activation(reference, law.gain, law.tone, drive)
    right = _activation(-reference, law.gain, law.tone, drive)
    shortening = law.lever / law.fiber_length * angle
    speed = law.lever / (law.fiber_length * law.largest_speed) * rate
    moment = law.lever * law.force
    left_moment = moment * left * _force_of_length(-shortening, law.width)
    right_moment = moment * right * _force_of_length(shortening, law.width)
    left_force, left_slope = _force_of_speed(speed)
    right_force, right_slope = _force_of_speed(-speed)
    torque = (
        left_moment * left_force
        - right_moment * right_force
        - law.passive_stiffness * angle
        - law.passive_damping * rate
    )
    grip = left_moment * left_slope + right_moment * right_slope
    speed_per_rate = law.lever / (law.fiber_length * law.largest_speed)
    damping = law.passive_damping + grip * speed_per_rate
    return torque, law.passive_stiffness + 0.0 * torque, damping


def _activation(reference: float, gain: float, tone: float, drive: Drive) -> float:
    """Return the activation of the muscle that a positive reference activates, from 0 to 1 [-]."""
    strength_of_motor = drive.proportional_gain + drive.servo_gain + drive.stall_torque
    asked = tone + gain * where(reference.real > 0.0, reference, 0.0 * reference)
    limited = where(asked.real < 1.0, asked, 1.0 + 0.0 * asked)
    return where(strength_of_motor.real > 0.0, limited, 0.0 * limited)


def _force_of_length(lengthening: float, width: float) -> float:
    """Return the share of its force that a muscle has at a relative lengthening [-]."""
    share = 1.0 - (lengthening / width) ** 2
    return where(share.real > 0.0, share, 0.0 * share)


def _force_of_speed(speed: float) -> tuple[float, float]:
    """Return the share of its force that a muscle has at a relative speed, and how steeply it falls."""
    none = 0.0 * speed
    fastest = 1.0 + none
    shortening = where(speed.real > 0.0, speed, none)
    shortening = where(shortening.real < 1.0, shortening, fastest)
    divisor = 1.0 + SHORTENING_CURVATURE * shortening
    force = (1.0 - shortening) / divisor
    slope = (1.0 + SHORTENING_CURVATURE) / (divisor * divisor)
    stretching = where(speed.real < 0.0, speed, none)
    stretching = where(stretching.real > -1.0, stretching, -fastest)
    excess = STRETCHED_FORCE - 1.0
    stretched_divisor = STRETCHING_STEEPNESS * stretching - 1.0
    stretched_force = STRETCHED_FORCE + excess * (1.0 + stretching) / stretched_divisor
    stretched_slope = (
        excess * (1.0 + STRETCHING_STEEPNESS) / (stretched_divisor * stretched_divisor)
    )
    is_stretched = speed.real < 0.0
    return (
        where(is_stretched, stretched_force, force),
        where(is_stretched, stretched_slope, slope),
    )
