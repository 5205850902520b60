"""Figures of a run: one meaning each, the same for a simulation and for the robot in the tank.

Pure functions of logged arrays and plain numbers. Where a figure has no meaning, as a cost per meter of a robot that
stood still or a steady velocity of a run of two seconds, they raise a `ValueError` that says why; none returns nan.
"""

import numpy as np
from jaxtyping import Bool, Float

from laticauda.errors import BadArgument, positive
from laticauda.fluid.laws import Element
from laticauda.kinematics import trailing_edge
from laticauda.robot import Ground, Robot, Water
from laticauda.trial.cycles import (
    SteadyPart,
    Time,
    course_cycle_mean,
    cycle_mean,
    cycle_middles,
    direction,
    interpolated,
    steady_part,
)

Path = Float[np.ndarray, "n_samples n_axes"]

STANDARD_GRAVITY = 9.81  # [m/s2]
STILL = 1e-9  # a speed below this is rounding [m/s]


# ---- speed ---------------------------------------------------------------------------------------------------------


def duration(time: Time) -> float:
    """Length of the log [s].

    Raises:
        ValueError: If it has fewer than two samples.
    """
    if time.size < 2:
        raise BadArgument("time", f"must have at least 2 samples for a mean over time, got {time.size}")
    return float(time[-1] - time[0])


def mean_velocity(time: Time, center_of_mass: Path) -> Float[np.ndarray, " n_axes"]:
    """Displacement of the center of mass over the whole run / its duration [m/s], world axes."""
    return (center_of_mass[-1] - center_of_mass[0]) / duration(time)


def forward_velocity(time: Time, center_of_mass: Path) -> float:
    """Straight-line displacement of the center of mass over the whole run / its duration [m/s].

    Equation (5) of the paper. It contains the start, and a curved run has less of it than of `path_speed`.

    Args:
        time: Of the samples [s].
        center_of_mass: p [m], world axes.

    Raises:
        ValueError: If the log has fewer than two samples.
    """
    return float(np.linalg.norm(mean_velocity(time, center_of_mass)))


def path_speed(time: Time, center_of_mass: Path) -> float:
    """Length of the path of the center of mass / duration [m/s]; never below `forward_velocity`.

    Args:
        time: Of the samples [s].
        center_of_mass: p [m], world axes.

    Raises:
        ValueError: If the log has fewer than two samples.
    """
    return float(np.sum(np.linalg.norm(np.diff(center_of_mass, axis=0), axis=1))) / duration(time)


def steady_velocity(time: Time, center_of_mass: Path, velocity: Path, period: float | None) -> float:
    """As `forward_velocity`, over the steady part of the run only [m/s].

    The steady part is as many whole gait cycles as fit after the first third of the run and after 10 s, counted back
    from the end; without a gait all of that time. So neither the start nor the gait's ripple is in it.

    Args:
        time: Of the samples [s].
        center_of_mass: p [m], world axes.
        velocity: p' [m/s], world axes.
        period: Of the gait [s], None where there is no gait.

    Raises:
        ValueError: If the run is too short; the message says how long it must be.
    """
    part = steady_part(time, period)
    return float(np.linalg.norm(_displacement(time, center_of_mass, velocity, part))) / (part.stop - part.start)


# ---- direction -----------------------------------------------------------------------------------------------------


def course(time: Time, center_of_mass: Path, velocity: Path, period: float | None) -> float:
    """Direction of travel over the steady part, in [-pi, pi] from the world x axis, counter-clockwise [rad].

    Arguments as for `steady_velocity`.

    Raises:
        ValueError: If the run is too short, or the robot stands still.
    """
    displacement = _displacement(time, center_of_mass, velocity, steady_part(time, period))
    return float(direction(displacement[np.newaxis])[0])


def sideslip(
    time: Time, center_of_mass: Path, velocity: Path, heading: Time, heading_rate: Time, period: float
) -> float:
    """Course minus heading, both as cycle means, averaged over the steady part [rad].

    Positive when the robot travels to the left of where it points.

    Args:
        time: Of the samples [s].
        center_of_mass: p [m], world axes.
        velocity: p' [m/s], world axes.
        heading: Mean link angle, equation (6) [rad], unwrapped.
        heading_rate: Its rate [rad/s].
        period: Of the gait [s].

    Raises:
        ValueError: If the run is too short, or the robot stands still.
    """
    inside = _in_steady_part(time, period)
    traveled = course_cycle_mean(time, center_of_mass, velocity, period).value
    pointed = cycle_mean(time, heading, heading_rate, period).value
    if not np.any(inside):
        raise BadArgument(
            "time",
            "must hold the middle of a whole gait cycle after the transient for a sideslip: "
            f"make it one sample longer than {float(time[-1] - time[0]):.4g} s at least",
        )
    angle = (traveled - pointed)[inside]
    # The mean of directions, not of numbers: course and heading may be unwrapped whole turns apart.
    return float(np.angle(np.mean(np.exp(1j * angle))))


def turning_rate(time: Time, heading: Time, heading_rate: Time, period: float) -> float:
    """Slope of the heading's cycle mean over the steady part, by least squares; positive to the left [rad/s].

    Args:
        time: Of the samples [s].
        heading: Mean link angle, equation (6) [rad], unwrapped.
        heading_rate: Its rate [rad/s].
        period: Of the gait [s].

    Raises:
        ValueError: If the steady part is shorter than two cycles: one mean has no slope.
    """
    part = steady_part(time, period)
    inside = _in_steady_part(time, period)
    if part.n_cycles is None or part.n_cycles < 2 or np.count_nonzero(inside) < 2:
        raise BadArgument(
            "time",
            "must span at least two gait cycles after the transient for a turning rate; "
            f"got {part.stop - part.start:.4g} s, and a cycle takes {period:.4g} s",
        )
    mean = cycle_mean(time, heading, heading_rate, period)
    t, value = mean.time[inside], mean.value[inside]
    t = t - np.mean(t)
    return float(np.sum(t * (value - np.mean(value))) / np.sum(t * t))


def strouhal_number(
    time: Time,
    center_of_mass: Path,
    velocity: Path,
    link_angle: Float[np.ndarray, "n_samples n_links"],
    robot: Robot,
    period: float,
    fin_angle: Float[np.ndarray, "n_samples n_fin_joints"] | None = None,
) -> float:
    """Strouhal number f A / U of the tail.

    f = 1 / period, U the steady velocity, A the peak-to-peak excursion of the fin's trailing edge (without a fin, of
    the tail end) across the course. A is taken cycle by cycle over the steady part, each across its own course, and
    averaged: on a straight path that is the excursion over the whole steady part, on a curved one the curve itself
    does not count. Eels swim at about 0.32 (Tytell 2004).

    Args:
        time: Of the samples [s].
        center_of_mass: p [m], world axes.
        velocity: p' [m/s], world axes.
        link_angle: theta [rad].
        robot: The robot whose links these are.
        period: Of the gait [s].
        fin_angle: Of the joints of its fin [rad]; None: straight.

    Raises:
        ValueError: If the run is too short, or the robot stands still.
    """
    part = steady_part(time, period)
    edge = trailing_edge(robot, center_of_mass[:, :2], link_angle, fin_angle=fin_angle)
    bounds = np.linspace(part.start, part.stop, (part.n_cycles or 1) + 1)
    steps = np.diff(interpolated(time, center_of_mass, velocity, bounds), axis=0)
    excursion = 0.0
    for begin, end, angle in zip(bounds[:-1], bounds[1:], direction(steps), strict=True):
        cycle = edge[(time >= begin) & (time <= end)]
        excursion += float(np.ptp(cycle @ np.array([-np.sin(angle), np.cos(angle)]))) / len(steps)
    return excursion / (period * steady_velocity(time, center_of_mass, velocity, period))


# ---- power and efficiency ------------------------------------------------------------------------------------------


def mean_power(time: Time, work: Time) -> float:
    """Mean power of a cumulative work over the whole run [W]: what was added / duration.

    Args:
        time: Of the samples [s].
        work: Done since the start of the count [J].

    Raises:
        ValueError: If the log has fewer than two samples.
    """
    return float(work[-1] - work[0]) / duration(time)


def joules_per_meter(power: float, speed: float) -> float:
    """Energy per distance P / v [J/m].

    Args:
        power: P [W].
        speed: v [m/s].

    Raises:
        ValueError: If the robot did not move.
    """
    return power / _moving(speed)


def cost_of_transport(power: float, weight: float, speed: float) -> float:
    """Cost of transport P / (W v), dimensionless.

    Args:
        power: P [W].
        weight: W [N]: in water that of the displaced water, see `carried_weight`.
        speed: v [m/s].

    Raises:
        ValueError: If the robot did not move, or weighs nothing.
    """
    return power / (positive("weight", weight, "N") * _moving(speed))


def carried_weight(robot: Robot, environment: Water | Ground) -> float:
    """The weight that a cost of transport is measured by [N].

    In water rho V g, that of the displaced water: published masses of swimming robots are ambiguous by a factor of
    two, the volume is not. On ground m g.
    """
    if isinstance(environment, Ground):
        return robot.mass * environment.gravity
    return environment.density * robot.volume * STANDARD_GRAVITY


def linear_drag_share(water: Water, speed: float) -> float:
    """Share of the linear term in the axial drag at a speed, U_ref / (U_ref + v), from 0 to 1.

    Where it is large, C_f is a lumped number and not a skin friction.

    Args:
        water: Which terms it has, and U_ref.
        speed: v through the water [m/s].

    Raises:
        ValueError: If the water has no drag at that speed.
    """
    total, near = -_along(water, speed), 1e-300  # a speed at which nothing but the linear part is left
    if total <= 0.0:
        raise ValueError("The water must have drag, and the robot a speed, for a share of the linear drag.")
    return -_along(water, near) / near * speed / total


def towing_drag(robot: Robot, water: Water, speed: float) -> float:
    """Drag of the straight robot, with its fin, when it is towed along itself [N].

        F = sum c_t v (U_ref + v),    over links and fin strips, each term only if the water has it

    Tether and pectoral fins are left out.

    Args:
        robot: Whose links are summed.
        water: Its coefficients and drag terms.
        speed: v through the water [m/s].
    """
    from laticauda.hydrodynamics.coefficients import link_coefficients

    link = link_coefficients(robot, water)
    c_t = float(np.sum(link.c_t))
    if link.fin is not None:
        c_t += float(np.sum(link.fin.c_t))
    return -c_t * _along(water, speed)


def quasi_propulsive_efficiency(towing_drag: float, speed: float, mechanical_power: float) -> float:
    """Towing power of the straight robot at its speed / mechanical power of its joints.

    It compares the swimmer with the same body on a rope, so unlike a propeller's efficiency it has no bound of 1. A
    "Froude efficiency" is not defined for a body that propels itself: thrust and drag are one force.

    Args:
        towing_drag: Of the straight robot at that speed [N].
        speed: v through the water [m/s].
        mechanical_power: Mean of sum |u phi'| [W].

    Raises:
        ValueError: If the joints did no work.
    """
    if not mechanical_power > 0.0:
        raise BadArgument("mechanical_power", f"must be > 0 W for an efficiency, got {mechanical_power}")
    return towing_drag * speed / mechanical_power


# ---- inside --------------------------------------------------------------------------------------------------------


def _moving(speed: float) -> float:
    if not speed > STILL:
        raise ValueError(f"The robot must move for a cost per distance: its speed is {speed:.1e} m/s.")
    return speed


def _along(water: Water, speed: float) -> float:
    """Drag along a straight body, per coefficient of 1 [m2/s2]."""
    return water.drag(speed, 0.0, 0.0, 0.0, Element(1.0, 0.0, 0.0, 0.0))[0]


def _displacement(time: Time, center_of_mass: Path, velocity: Path, part: SteadyPart) -> Float[np.ndarray, " n_axes"]:
    ends = interpolated(time, center_of_mass, velocity, np.array([part.start, part.stop]))
    return ends[1] - ends[0]


def _in_steady_part(time: Time, period: float) -> Bool[np.ndarray, " n_middles"]:
    """Which of the cycle middles belong to cycles inside the steady part."""
    middle = cycle_middles(time, period)
    part = steady_part(time, period)
    slack = 1e-9 * period
    return (middle >= part.start + 0.5 * period - slack) & (middle <= part.stop - 0.5 * period + slack)
