"""Joint laws: what torque an actuator delivers, and how stiffly it depends on the joint's angle and rate.

A law is a frozen value below `JointLaw`: its fields are numbers of its own, its `__call__` is the formula, which the
kernels of both models compile (`laticauda.formulas`). It returns the torque and the two slopes K_p = -du/dphi and
K_d = -du/dphi' that an implicit time step needs. A torque u > 0 turns the head side of the joint to the left against
the tail side. The skin around the joint is not in it.

The annotations say float; complex numbers work too, for complex-step derivatives, and lanes, for many trials at once;
so conditions look at the real part only, and choices come from `where`.
"""

from typing import ClassVar, NamedTuple

from laticauda.errors import one_of
from laticauda.extensions import Extensible
from laticauda.formulas import Formula, Law
from laticauda.quantities import value
from laticauda.scalars import tanh, where

# Rate over which dry friction changes its sign; small against the rates of swimming, about 1 rad/s [rad/s].
SLIDING_RATE = 0.05

MOTION = 5
"""Numbers that a law gets before the drive: phi, phi', phi_ref, phi_ref', phi_ref''."""

LOCKED, PRESCRIBED, PASSIVE, PD_DRIVEN, SERVO_DRIVEN, OWN_DRIVEN = range(6)
"""How kernels tell joints apart; from PASSIVE on the torque is known, and before it the acceleration."""
FIRST_FREE = PASSIVE


class Drive(NamedTuple):
    """What a law knows of the joint's `laticauda.robot.Actuator`; gains and stall torque of one switched off are 0."""

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
JOINT = (*range(4), _DRIVE + Drive._fields.index("stall_torque"), *(_DRIVE + len(Drive._fields) + k for k in range(2)))
"""Where the numbers of a joint stand in the kernels of both models: its envelope g, times the share that a prescribed
joint does of it; stiffness and damping of skin or hinge; the `Drive`, and where its motor begins; V I_stall of that, 0
if its electrical power is not asked for; how many they are."""


class JointLaw(Law, Extensible, group="joint_laws"):
    """Base of how joints follow their references."""

    prescribed: ClassVar[bool] = False
    """Whether joints are where the reference is, whatever torque that takes."""
    powered: ClassVar[bool] = False
    """Whether the motors' electrical power is always asked for."""
    dt: ClassVar[float | None] = 0.002
    """Step at which it is converged [s]; None: that of the model's own integrator."""
    ramp: ClassVar[float] = 0.0
    """Usual duration of the smooth start [s]."""
    takes_jumps: ClassVar[bool] = False
    """Whether references may jump, because it does not look at their rates and accelerations."""
    remedy: ClassVar[str] = "a smaller `dt`, or a softer joint law"
    """What to try if a run blows up."""

    def __call__(
        self,
        angle: float,
        rate: float,
        reference: float,
        reference_rate: float,
        reference_acceleration: float,
        drive: Drive,
    ) -> tuple[float, float, float]:
        """Torque of one joint, and its slopes.

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
        """Refuse a law that kernels cannot compile.

        Raises:
            ValueError: With the reason.
        """
        if self.own is not None:
            from laticauda.compiling.formulas import check  # Numba is slow to import

            example = (0.1, -0.2, 0.3, 0.4, 0.5, *[1.0] * len(Drive._fields))
            check(self.formula, self.numbers, Drive, example, 3, "u, K_p and K_d")

    @property
    def code(self) -> int:
        """How kernels tell it apart."""
        codes: dict[type, int] = {Prescribed: PRESCRIBED, PD: PD_DRIVEN, Servo: SERVO_DRIVEN}
        return codes.get(type(self), OWN_DRIVEN)

    @property
    def own(self) -> Formula | None:
        """The formula that kernels are compiled for; None: one that they all have."""
        return self.formula if self.code == OWN_DRIVEN else None

    @classmethod
    def of(cls, given: "JointLaw | str") -> "JointLaw":
        """A law, which may be `given` by its name.

        Args:
            given: The law, or its name: prescribed, pd, servo, or what an installed package brings.

        Raises:
            ValueError: If there is none of that name.
        """
        if isinstance(given, str):
            return cls.named(one_of("joints", given, cls.names()))()
        return given


@value
class Prescribed(JointLaw):
    """Exactly, whatever torque it takes; `Actuator.tracking` says how much of its reference a joint does."""

    prescribed: ClassVar[bool] = True
    dt: ClassVar[float | None] = None
    ramp: ClassVar[float] = 1.0
    remedy: ClassVar[str] = "a smaller `dt`, smaller drag coefficients, or a slower gait"

    @property
    def words(self) -> str:
        """As an FMU's description has it."""
        return "prescribed joints"


@value
class PD(JointLaw):
    """By the law of the published simulations: u = phi_ref'' + k_d (phi_ref' - phi') + k_p (phi_ref - phi).

    There is no limit to its torque; phi_ref'' is fed forward with an inertia of 1 kg m^2, whatever the robot's is.

    References:
        E. Kelasidi et al., IEEE Robot. Autom. Mag. 23(1), 2016, eq. (20).
    """

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
        """u, K_p and K_d, see `JointLaw.__call__`."""
        k_p, k_d = drive.proportional_gain, drive.derivative_gain
        return reference_acceleration + k_d * (reference_rate - rate) + k_p * (reference - angle), k_p, k_d

    @property
    def words(self) -> str:
        """As an FMU's description has it."""
        return "pd-controlled joints"


@value
class Servo(JointLaw):
    """As the real robot's hobby servos do, see `servo`."""

    powered: ClassVar[bool] = True
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
        """See `servo`."""
        return servo(angle, rate, reference, drive)[:3]

    def duty(self, angle: float, rate: float, reference: float, drive: Drive) -> float:
        """Share of the supply's voltage that the motor gets, from -1 to 1 [-].

        Args:
            angle: phi [rad].
            rate: phi' [rad/s].
            reference: phi_ref [rad].
            drive: What the joint's actuator is.
        """
        return servo(angle, rate, reference, drive)[3]

    @property
    def words(self) -> str:
        """As an FMU's description has it."""
        return "servos in the joints"


def servo(angle: float, rate: float, reference: float, drive: Drive) -> tuple[float, float, float, float]:
    """A hobby servo: proportional control of a geared DC motor through its duty cycle.

        d = clip(gain (phi_ref - phi), -1, 1)
        u = u_stall (d - phi'/phi'_0) - b phi' - u_c tanh(phi'/eps),    eps = 0.05 rad/s

    The first term is the motor with its back electromotive force, which limits torque and speed by itself: at full duty
    it stalls at `stall_torque` and stops pulling at `no_load_speed`. Driven backward or beyond that speed it brakes.

    Args:
        angle: phi [rad].
        rate: phi' [rad/s].
        reference: phi_ref [rad].
        drive: What the joint's actuator is: its gain, u_stall, phi'_0, u_c and b.

    Returns:
        u [N m], K_p [N m/rad], K_d [N m s/rad], duty d [-]. Where the duty saturates, K_p = 0.
    """
    gain, stall_torque, viscous_friction = drive.servo_gain, drive.stall_torque, drive.viscous_friction
    demand = gain * (reference - angle)
    saturated = (demand.real <= -1.0) | (demand.real >= 1.0)
    # 0 * demand keeps the number's kind, real or complex, for the compiler.
    limit = where(demand.real > 0.0, 1.0, -1.0) + 0.0 * demand
    duty = where(saturated, limit, demand)
    stiffness = where(saturated, 0.0 * gain, gain * stall_torque)
    sliding, dry = tanh(rate / SLIDING_RATE), drive.friction_torque
    torque = stall_torque * (duty - rate / drive.no_load_speed) - viscous_friction * rate - dry * sliding
    damping = stall_torque / drive.no_load_speed + viscous_friction + dry / SLIDING_RATE * (1.0 - sliding * sliding)
    return torque, stiffness, damping, duty


def motor_power(
    torque: float,
    rate: float,
    stall_torque: float,
    no_load_speed: float,
    friction_torque: float,
    viscous_friction: float,
    stall_power: float,
) -> float:
    """Electrical power that the geared motor of `servo` draws above idle while it delivers a torque at a rate.

        s = (u + b phi' + u_c tanh(phi'/eps)) / u_stall,   d = s + phi'/phi'_0,   P = V I_stall max(d s, 0)

    It is the servo's law read backwards: s is the share of the stall current that the torque takes, d the duty at which
    the motor gives it at that speed. The bridge takes the current from the supply V for the share d of the time, and
    cannot give energy back. So it holds for joints under any law; one that a `servo` could not follow has |d| > 1.

    Args:
        torque: u at the joint [N m].
        rate: phi' [rad/s].
        stall_torque: u_stall [N m].
        no_load_speed: phi'_0 [rad/s].
        friction_torque: u_c, dry friction of the gear [N m].
        viscous_friction: b [N m s/rad].
        stall_power: V I_stall [W].

    Returns:
        Power [W], not negative. Not below what the motor delivers, u phi', as long as V I_stall >= u_stall phi'_0: a
        motor and gear of constants that do not create energy.
    """
    sliding = tanh(rate / SLIDING_RATE)
    current = (torque + viscous_friction * rate + friction_torque * sliding) / stall_torque
    share = (current + rate / no_load_speed) * current
    return stall_power * where(share.real > 0.0, share, 0.0 * share)
