"""Linearly implicit step of the spatial model, and joint powers of both: scalar formulas that the kernels compile.

ROS2 (Verwer, Spee, Blom and Hundsdorfer, SIAM J. Sci. Comput. 20, 1999), a Rosenbrock W-method of
order 2 with gamma = 1 - 1/sqrt(2), L-stable. Its approximate Jacobian is that of the joint law, so
an implicit step only adds gamma h K_d + (gamma h)^2 K_p to each joint's own inertia. The second
stage is solved for a = k2 + 2 k1, which avoids the mass matrix:

    y(t + h) = y + h (3/2 k1 + 1/2 k2)

With `rate` and `acceleration` of a degree of freedom, k1 is (rate + gamma h acceleration,
acceleration).
"""

from laticauda.values import magnitude

GAMMA = 1.0 - 0.5**0.5
WEIGHTS = (1.5, 0.5)
"""Weights of the slopes of the first and second stage."""
FARTHEST = 1e6
"""Bound of positions [m, rad] and rates [m/s, rad/s]; a run that exceeds it has diverged."""
STRONGEST = 1e12
"""Bound of torques [N m]; a run that exceeds it has diverged."""


def implicit_inertia(slope_p: float, slope_d: float, gamma_dt: float) -> float:
    """Return the inertia that an implicit step adds to a joint [kg m^2].

    Args:
        slope_p: Total K_p at the joint [N m/rad].
        slope_d: Total K_d at the joint [N m s/rad].
        gamma_dt: gamma h [s].
    """
    return gamma_dt * (slope_d + gamma_dt * slope_p)


def second_torque(
    torque: float,
    slope_p: float,
    inertia: float,
    rate: float,
    first_rate: float,
    first: float,
    gamma_dt: float,
) -> float:
    """Return the effective torque on a joint in the second stage [N m].

    Args:
        torque: Torque in the state at which the second stage is evaluated [N m].
        slope_p: K_p in the first stage [N m/rad].
        inertia: Value of `implicit_inertia` in the first stage [kg m^2].
        rate: Joint rate in the state at which the second stage is evaluated [rad/s].
        first_rate: Rate in k1 [rad/s].
        first: Acceleration in k1 [rad/s^2].
        gamma_dt: gamma h [s].
    """
    difference = rate - 2.0 * first_rate
    return torque - gamma_dt * slope_p * difference + 2.0 * inertia * first


def combined(
    rate: float, acceleration: float, first_rate: float, first: float, gamma_dt: float
) -> tuple[float, float]:
    """Return the slopes of position and rate over the whole step, 3/2 k1 + 1/2 k2.

    Args:
        rate: Rate in the state at which the second stage is evaluated.
        acceleration: Solution a of the second stage.
        first_rate: Rate in k1.
        first: Acceleration in k1.
        gamma_dt: gamma h [s].
    """
    second = acceleration - 2.0 * first
    second_rate = rate - 2.0 * first_rate + gamma_dt * second
    w_1, w_2 = WEIGHTS
    return w_1 * first_rate + w_2 * second_rate, w_1 * first + w_2 * second


def joint_powers(torque: float, rate: float) -> tuple[float, float, float]:
    """Return |u phi'|, u phi' and max(u phi', 0) of one joint [W].

    Args:
        torque: u [N m].
        rate: phi' [rad/s].
    """
    power = torque * rate
    return magnitude(power), power, 0.5 * (power + magnitude(power))
