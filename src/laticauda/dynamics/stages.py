"""The linearly implicit step of both models, and what they count alike: scalar formulas, which kernels compile.

ROS2 (Verwer, Spee, Blom and Hundsdorfer, SIAM J. Sci. Comput. 20, 1999), a Rosenbrock W-method of order 2 with
gamma = 1 - 1/sqrt(2), L-stable. Its approximate Jacobian is the joint law's own, so all that an implicit step adds is
gamma h K_d + (gamma h)^2 K_p to each joint's own inertia. The second stage is solved for a = k2 + 2 k1, so that the
mass matrix is not needed:

    y(t + h) = y + h (3/2 k1 + 1/2 k2)

With `rate` and `acceleration` of a degree of freedom, k1 is (rate + gamma h acceleration, acceleration).
"""

from laticauda.scalars import magnitude

GAMMA = 1.0 - 0.5**0.5
WEIGHTS = (1.5, 0.5)
"""Of the first and the second stage's slope."""
FARTHEST, STRONGEST = 1e6, 1e12
"""What positions and rates, and torques, of a swimming robot stay below; a run that leaves them has diverged."""


def implicit_inertia(slope_p: float, slope_d: float, gamma_dt: float) -> float:
    """What an implicit step adds to the inertia of a joint [kg m^2].

    Args:
        slope_p: K_p of everything at the joint [N m/rad].
        slope_d: K_d [N m s/rad].
        gamma_dt: gamma h [s].
    """
    return gamma_dt * (slope_d + gamma_dt * slope_p)


def second_torque(
    torque: float, slope_p: float, inertia: float, rate: float, first_rate: float, first: float, gamma_dt: float
) -> float:
    """What acts on a joint in the second stage [N m].

    Args:
        torque: In the state that the second stage looks at [N m].
        slope_p: K_p in the first stage [N m/rad].
        inertia: From `implicit_inertia` in the first stage [kg m^2].
        rate: Of the joint, in the state that the second stage looks at [rad/s].
        first_rate: Rate in k1 [rad/s].
        first: Acceleration in k1 [rad/s^2].
        gamma_dt: gamma h [s].
    """
    rest = rate - 2.0 * first_rate
    return torque - gamma_dt * slope_p * rest + 2.0 * inertia * first


def combined(rate: float, acceleration: float, first_rate: float, first: float, gamma_dt: float) -> tuple[float, float]:
    """Slopes of position and rate over the whole step, 3/2 k1 + 1/2 k2.

    Args:
        rate: In the state that the second stage looks at.
        acceleration: The solution a there.
        first_rate: Rate in k1.
        first: Acceleration in k1.
        gamma_dt: gamma h [s].
    """
    second = acceleration - 2.0 * first
    second_rate = rate - 2.0 * first_rate + gamma_dt * second
    one, two = WEIGHTS
    return one * first_rate + two * second_rate, one * first + two * second


def joint_powers(torque: float, rate: float) -> tuple[float, float, float]:
    """|u phi'|, u phi' and max(u phi', 0) of one joint [W].

    Args:
        torque: u [N m].
        rate: phi' [rad/s].
    """
    power = torque * rate
    return magnitude(power), power, 0.5 * (power + magnitude(power))
