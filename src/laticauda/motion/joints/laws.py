"""Joint laws: the torque of an actuator, and its slopes with respect to the joint's angle and rate.

A law is a frozen value derived from `JointLaw`: its fields are its own numbers, its `__call__` is
the formula, which the kernels of both models compile (`laticauda.values.formulas`). It returns the torque
and the two slopes K_p = -du/dphi and K_d = -du/dphi' that an implicit time step needs. A torque u >
0 turns the head side of the joint to the left relative to the tail side. The skin around the joint
is not included.

The annotations say float, but complex numbers (for complex-step derivatives) and lanes (for many
trials at once) work too; conditions therefore use the real part only, and choices use `where`.
"""

import functools
from collections.abc import Callable
from typing import ClassVar, NamedTuple

from laticauda.values import (
    Extensible,
    Formula,
    Law,
    check_choice,
    magnitude,
    tanh,
    value_class,
    where,
)

# Rate over which dry friction changes sign; small compared with the rates of swimming, about 1
# rad/s [rad/s].
SLIDING_RATE = 0.05
PER_SLIDING_RATE = 1.0 / SLIDING_RATE  # a product takes a tenth of the time of a quotient [s/rad]

MOTION = 5
"""Count of the arguments of a law before the drive: phi, phi', phi_ref, phi_ref', phi_ref''."""

LOCKED, PRESCRIBED, PASSIVE, PD_DRIVEN, OWN_LINEAR, SERVO_DRIVEN, OWN_DRIVEN = range(7)
"""Codes of joints in the kernels; from PASSIVE on the torque is known, below it the acceleration."""
FIRST_FREE = PASSIVE
LAST_LINEAR = OWN_LINEAR
"""From PASSIVE to here, the torque is linear in angle and rate."""


class Drive(NamedTuple):
    """Numbers of the joint's `laticauda.robot.Actuator`; gains and stall torque are 0 if it is switched off."""

    proportional_gain: float
    """k_p [N m/rad]."""
    derivative_gain: float
    """k_d [N m s/rad]."""
    servo_gain: float
    """Duty per angle error [1/rad]."""
    stall_torque: float
    """u_stall [N m]."""
    no_load_speed: float
    """phi'_0 [rad/s]."""
    friction_torque: float
    """u_c [N m]."""
    viscous_friction: float
    """b [N m s/rad]."""


_DRIVE = 3
JOINT = (
    *range(4),
    _DRIVE + Drive._fields.index("stall_torque"),
    *(_DRIVE + len(Drive._fields) + k for k in range(3)),
)
"""Positions of a joint's numbers in the kernels of both models: its envelope g, times the share of it that a prescribed
joint does; stiffness and damping of skin or hinge; the `Drive`, and where its motor begins; the
motor's V I_stall, 0 if electrical power is not requested; the lead of its phase over the gait's wave; and the
total count."""


class JointLaw(Law, Extensible, group="joint_laws"):
    """Base of the laws by which joints follow their references."""

    prescribed: ClassVar[bool] = False
    """Whether joints follow the reference exactly, whatever torque that requires."""
    powered: ClassVar[bool] = False
    """Whether the motors' electrical power is always computed."""
    dt: ClassVar[float | None] = 0.005
    """Time step at which the law is converged in the planar model [s]; None: that of the model's own integrator."""
    ramp: ClassVar[float] = 0.0
    """Default duration of the smooth start [s]."""
    is_linear: ClassVar[bool] = False
    """Whether the torque is linear in angle and rate, with the slopes that the law returns; classes derived from a
    linear law say so anew."""
    takes_jumps: ClassVar[bool] = False
    """Whether references may jump, because the law does not use their rates and accelerations."""
    remedy: ClassVar[str] = "a smaller `dt`, or a softer joint law"
    """What to try if a run diverges."""

    def __call__(
        self,
        angle: float,
        rate: float,
        reference: float,
        reference_rate: float,
        reference_acceleration: float,
        drive: Drive,
    ) -> tuple[float, float, float]:
        """Return the torque of one joint and its slopes.

        Args:
            angle: phi [rad].
            rate: phi' [rad/s].
            reference: phi_ref [rad].
            reference_rate: phi_ref' [rad/s].
            reference_acceleration: phi_ref'' [rad/s^2].
            drive: Numbers of the joint's actuator.

        Returns:
            u [N m], K_p = -du/dphi [N m/rad], K_d = -du/dphi' [N m s/rad].
        """
        raise NotImplementedError

    def check(self) -> None:
        """Reject a law that the kernels cannot compile.

        Raises:
            ValueError: If the law cannot be compiled; the message gives the reason.
        """
        if self.own is not None and not self.own.is_own:
            from laticauda.compiling.formulas import check  # Numba is slow to import

            example = (0.1, -0.2, 0.3, 0.4, 0.5, *[1.0] * len(Drive._fields))
            check(self.formula, self.numbers, Drive, example, 3, "u, K_p and K_d")

    @property
    def code(self) -> int:
        """Code of the law in the kernels."""
        codes: dict[type, int] = {Prescribed: PRESCRIBED, PD: PD_DRIVEN, Servo: SERVO_DRIVEN}
        if type(self) in codes:
            return codes[type(self)]
        if vars(type(self)).get("is_linear", False):
            return OWN_LINEAR
        return OWN_DRIVEN

    @property
    def own(self) -> Formula | None:
        """Formula that kernels are compiled for; None: one that all kernels include."""
        if self.code not in (OWN_LINEAR, OWN_DRIVEN):
            return None
        return self.formula

    @classmethod
    def of(cls, law: "JointLaw | str") -> "JointLaw":
        """Return a law, which may be stated by its name.

        Args:
            law: Law, or its name: prescribed, pd, servo, or one that an installed package
                provides.

        Raises:
            ValueError: If there is no law of that name.
        """
        if isinstance(law, str):
            law_class = cls.named(check_choice("joints", law, cls.names()))
            return usual_law(law_class)
        return law


@functools.cache
def usual_law(law_class: Callable[[], JointLaw]) -> JointLaw:
    """Return the law of a class with its defaults, always the same object.

    Args:
        law_class: The class.
    """
    return law_class()


@value_class
class Prescribed(JointLaw):
    """Exact motion, whatever torque that takes; `Actuator.tracking` is the share of its reference that a joint does."""

    prescribed: ClassVar[bool] = True
    dt: ClassVar[float | None] = None
    ramp: ClassVar[float] = 1.0
    remedy: ClassVar[str] = "a smaller `dt`, smaller drag coefficients, or a slower gait"

    @property
    def words(self) -> str:
        """Description of the law, as used for an FMU."""
        return "prescribed joints"


@value_class
class PD(JointLaw):
    """Law of the published simulations: u = phi_ref'' + k_d (phi_ref' - phi') + k_p (phi_ref - phi).

    The torque is not limited; phi_ref'' is fed forward with an inertia of 1 kg m^2, whatever the
    robot's inertia is.

    References:
        E. Kelasidi et al., IEEE Robot. Autom. Mag. 23(1), 2016, eq. (20).
    """

    dt: ClassVar[float | None] = 1.0 / 120.0
    remedy: ClassVar[str] = "a smaller `dt`, or lower `proportional_gain` and `derivative_gain`"

    def __call__(
        self,
        angle: float,
        rate: float,
        reference: float,
        reference_rate: float,
        reference_acceleration: float,
        drive: Drive,
    ) -> tuple[float, float, float]:
        """Return u, K_p and K_d, see `JointLaw.__call__`."""
        k_p, k_d = drive.proportional_gain, drive.derivative_gain
        return (
            reference_acceleration + k_d * (reference_rate - rate) + k_p * (reference - angle),
            k_p,
            k_d,
        )

    @property
    def words(self) -> str:
        """Description of the law, as used for an FMU."""
        return "pd-controlled joints"


@value_class
class Servo(JointLaw):
    """Hobby servos as in the real robot, see `servo`."""

    powered: ClassVar[bool] = True
    dt: ClassVar[float | None] = 1.0 / 160.0
    takes_jumps: ClassVar[bool] = True
    remedy: ClassVar[str] = "a smaller `dt`, or a lower `servo_gain` and `friction_torque`"

    def __call__(
        self,
        angle: float,
        rate: float,
        reference: float,
        reference_rate: float,
        reference_acceleration: float,
        drive: Drive,
    ) -> tuple[float, float, float]:
        """Return the torque and its slopes, see `servo`."""
        return servo(angle, rate, reference, drive)[:3]

    def duty(self, angle: float, rate: float, reference: float, drive: Drive) -> float:
        """Return the share of the supply voltage that the motor gets, from -1 to 1 [-].

        Args:
            angle: phi [rad].
            rate: phi' [rad/s].
            reference: phi_ref [rad].
            drive: Numbers of the joint's actuator.
        """
        return servo(angle, rate, reference, drive)[3]

    @property
    def words(self) -> str:
        """Description of the law, as used for an FMU."""
        return "servos in the joints"


def servo(
    angle: float, rate: float, reference: float, drive: Drive
) -> tuple[float, float, float, float]:
    """Return the torque of a hobby servo: proportional control of a geared DC motor through its duty cycle.

        d = clip(gain (phi_ref - phi), -1, 1)
        u = u_stall (d - phi'/phi'_0) - b phi' - u_c tanh(phi'/eps),    eps = 0.05 rad/s

    The first term is the motor with its back electromotive force, which inherently limits torque
    and speed: at full duty it stalls at `stall_torque` and delivers no torque at `no_load_speed`.
    Driven backward or faster, it brakes.

    Args:
        angle: phi [rad].
        rate: phi' [rad/s].
        reference: phi_ref [rad].
        drive: Numbers of the joint's actuator: its gain, u_stall, phi'_0, u_c and b.

    Returns:
        u [N m], K_p [N m/rad], K_d [N m s/rad], duty d [-]. Where the duty saturates, K_p = 0.
    """
    gain, stall_torque, viscous_friction = (
        drive.servo_gain,
        drive.stall_torque,
        drive.viscous_friction,
    )
    duty, saturated = servo_duty(angle, reference, gain)
    stiffness = where(saturated, 0.0 * gain, gain * stall_torque)
    sliding, dry = tanh(PER_SLIDING_RATE * rate), drive.friction_torque
    per_no_load_speed = 1.0 / drive.no_load_speed
    torque = (
        stall_torque * (duty - per_no_load_speed * rate) - viscous_friction * rate - dry * sliding
    )
    damping = (
        stall_torque * per_no_load_speed
        + viscous_friction
        + PER_SLIDING_RATE * dry * (1.0 - sliding * sliding)
    )
    return torque, stiffness, damping, duty


def joint_powers(torque: float, rate: float) -> tuple[float, float, float]:
    """Return |u phi'|, u phi' and max(u phi', 0) of one joint [W].

    Args:
        torque: u [N m].
        rate: phi' [rad/s].
    """
    power = torque * rate
    return magnitude(power), power, 0.5 * (power + magnitude(power))


def servo_duty(angle: float, reference: float, gain: float) -> tuple[float, bool]:
    """Return the duty cycle of a servo, and whether it saturates.

    Args:
        angle: phi [rad].
        reference: phi_ref [rad].
        gain: Duty per angle error [1/rad].
    """
    demand = gain * (reference - angle)
    saturated = (demand.real <= -1.0) | (demand.real >= 1.0)
    # 0 * demand keeps the number's type, real or complex, for the compiler.
    limit = where(demand.real > 0.0, 1.0, -1.0) + 0.0 * demand
    return where(saturated, limit, demand), saturated


def servo_power(
    angle: float,
    rate: float,
    reference: float,
    gain: float,
    no_load_speed: float,
    stall_power: float,
) -> float:
    """Return the `motor_power` of a servo with the torque of its law: P = V I_stall max(d (d - phi'/phi'_0), 0).

    Args:
        angle: phi [rad].
        rate: phi' [rad/s].
        reference: phi_ref [rad].
        gain: Duty per angle error [1/rad].
        no_load_speed: phi'_0 [rad/s].
        stall_power: V I_stall [W].
    """
    duty, _ = servo_duty(angle, reference, gain)
    share = duty * (duty - rate / no_load_speed)
    return stall_power * where(share.real > 0.0, share, 0.0 * share)


def motor_power(
    torque: float,
    rate: float,
    stall_torque: float,
    no_load_speed: float,
    friction_torque: float,
    viscous_friction: float,
    stall_power: float,
) -> float:
    """Return the electrical power above idle of the geared motor of `servo` while it delivers a torque at a rate.

        s = (u + b phi' + u_c tanh(phi'/eps)) / u_stall,   d = s + phi'/phi'_0,   P = V I_stall max(d s, 0)

    This is the inverse of the servo's law: s is the share of the stall current that the torque
    requires, d the duty at which the motor delivers it at that speed. The bridge draws the current
    from the supply V for the share d of the time, and cannot return energy. It therefore holds for
    joints under any law; |d| > 1 if a `servo` could not follow.

    Args:
        torque: u at the joint [N m].
        rate: phi' [rad/s].
        stall_torque: u_stall [N m].
        no_load_speed: phi'_0 [rad/s].
        friction_torque: u_c, dry friction of the gear [N m].
        viscous_friction: b [N m s/rad].
        stall_power: V I_stall [W].

    Returns:
        Power [W], not negative. Not below the delivered power u phi' if V I_stall >= u_stall
        phi'_0, that is, if the constants of motor and gear do not create energy.
    """
    sliding = tanh(PER_SLIDING_RATE * rate)
    # A single quotient for s and d, which need not wait for the hyperbolic tangent.
    per_product = 1.0 / (stall_torque * no_load_speed)
    motor_torque = torque + viscous_friction * rate + friction_torque * sliding
    current = no_load_speed * motor_torque * per_product
    duty = (no_load_speed * motor_torque + stall_torque * rate) * per_product
    share = current * duty
    return stall_power * where(share.real > 0.0, share, 0.0 * share)
