"""Figures of a run, each with a single meaning that is the same for a simulation and for the robot in the tank.

Figures of arrays and plain numbers can be used without a trial; figures of a trial are its
properties. Where a figure has no meaning, such as a cost per meter of a robot that stood still or a
steady velocity of a run of two seconds, the function raises a `ValueError` that states the reason;
none returns nan.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Inexact

from laticauda.robot import Ground, Posture, Robot, Water
from laticauda.trials import cycles
from laticauda.trials.contents import Contents
from laticauda.trials.cycles import CycleMean, SteadyPart, Time
from laticauda.values import BadArgument, check_positive
from laticauda.water.fluid import Element

Path = Float[np.ndarray, "n_samples n_axes"]
Joints = Float[np.ndarray, "n_samples n_joints"]

STANDARD_GRAVITY = 9.81
"""Acceleration of gravity where an environment does not state it [m/s2]."""
STILL = 1e-9
"""A speed below this is rounding error [m/s]."""
CREEPING_SPEED = 1e-300
"""A speed at which only the linear part of a drag remains [m/s]."""


# ---- figures of arrays and numbers ---------------------------------------------------------------


def log_duration(time: Time) -> float:
    """Return the length of the log [s].

    Raises:
        ValueError: If it has fewer than two samples.
    """
    if time.size < 2:
        raise BadArgument(
            "time", f"must have at least 2 samples for a mean over time, got {time.size}"
        )
    return float(time[-1] - time[0])


def mean_velocity(time: Time, center_of_mass: Path) -> Float[np.ndarray, " n_axes"]:
    """Compute the displacement of the center of mass over the whole run / its duration [m/s], world axes."""
    return (center_of_mass[-1] - center_of_mass[0]) / log_duration(time)


def forward_velocity(time: Time, center_of_mass: Path) -> float:
    """Compute the straight-line displacement of the center of mass over the whole run / its duration [m/s].

    Equation (5) of the paper. It includes the start, and on a curved run it is smaller than
    `path_speed`.

    Args:
        time: Times of the samples [s].
        center_of_mass: p [m], world axes.

    Raises:
        ValueError: If the log has fewer than two samples.
    """
    return float(np.linalg.norm(mean_velocity(time, center_of_mass)))


def path_speed(time: Time, center_of_mass: Path) -> float:
    """Compute the length of the path of the center of mass / duration [m/s]; never below `forward_velocity`.

    Args:
        time: Times of the samples [s].
        center_of_mass: p [m], world axes.

    Raises:
        ValueError: If the log has fewer than two samples.
    """
    steps = np.linalg.norm(np.diff(center_of_mass, axis=0), axis=1)
    return float(np.sum(steps)) / log_duration(time)


def mean_power(time: Time, work: Time) -> float:
    """Compute the mean power from cumulative work over the whole run [W]: work done in the run / duration.

    Args:
        time: Times of the samples [s].
        work: Work done since counting began [J].

    Raises:
        ValueError: If the log has fewer than two samples.
    """
    return float(work[-1] - work[0]) / log_duration(time)


def cumulative_integral(
    time: Time, values: Inexact[np.ndarray, "n_samples ..."]
) -> Inexact[np.ndarray, "n_samples ..."]:
    """Compute the cumulative integral of values, starting from 0, by the trapezoidal rule.

    Args:
        time: Times of the samples [s].
        values: Values at the samples, along the first axis.
    """
    pieces = 0.5 * np.diff(time) * (values[1:] + values[:-1]).T
    return np.concatenate((np.zeros_like(values[:1]), np.cumsum(pieces.T, axis=0)))


def joint_work(time: Time, torque: Joints, rate: Joints) -> Float[np.ndarray, "n_samples 3"]:
    """Compute the cumulative work of the joints [J]: of sum |u phi'|, of sum u phi', of sum max(u phi', 0).

    Args:
        time: Times of the samples [s].
        torque: Torque of every joint [N m].
        rate: Rate of every joint [rad/s].
    """
    power = torque * rate
    absolute = np.abs(power).sum(axis=1)
    net = power.sum(axis=1)
    positive = np.maximum(power, 0.0).sum(axis=1)
    return cumulative_integral(time, np.stack([absolute, net, positive], axis=1))


def joules_per_meter(power: float, speed: float) -> float:
    """Compute the energy per distance P / v [J/m].

    Args:
        power: P [W].
        speed: v [m/s].

    Raises:
        ValueError: If the robot did not move.
    """
    return power / _moving(speed)


def cost_of_transport(power: float, weight: float, speed: float) -> float:
    """Compute the cost of transport P / (W v), dimensionless.

    Args:
        power: P [W].
        weight: W [N]: in water the weight of the displaced water, see `carried_weight`.
        speed: v [m/s].

    Raises:
        ValueError: If the robot did not move, or has no weight.
    """
    return power / (check_positive("weight", weight, "N") * _moving(speed))


def carried_weight(robot: Robot, environment: Water | Ground) -> float:
    """Return the weight used in the cost of transport [N].

    In water it is the weight of the displaced water, rho V g: published masses of swimming robots
    are ambiguous by a factor of two, the volume is not. On ground it is m g.
    """
    if isinstance(environment, Ground):
        return robot.mass * environment.gravity
    return environment.density * robot.volume * STANDARD_GRAVITY


def linear_drag_share(water: Water, speed: float) -> float:
    """Compute the share of the linear term in the axial drag at a given speed, U_ref / (U_ref + v), from 0 to 1.

    Where the share is large, C_f is a lumped coefficient and not a skin friction.

    Args:
        water: Water that defines the drag terms and U_ref.
        speed: v through the water [m/s].

    Raises:
        ValueError: If the water has no drag at that speed.
    """
    total = -_along(water, speed)
    if total <= 0.0:
        raise ValueError(
            "The water must have drag, and the robot a speed, for a share of the linear drag."
        )
    return -_along(water, CREEPING_SPEED) / CREEPING_SPEED * speed / total


def towing_drag(robot: Robot, water: Water, speed: float) -> float:
    """Compute the drag of the straight robot, with its fin, when it is towed along its own axis [N].

        F = sum c_t v (U_ref + v),    over links, fin strips and drag areas, each term only if the water includes it

    Tether and pectoral fins are not included.

    Args:
        robot: Robot whose links are summed.
        water: Water that defines the coefficients and drag terms.
        speed: v through the water [m/s].
    """
    from laticauda.robot import link_coefficients

    link = link_coefficients(robot, water)
    c_t = float(np.sum(link.c_t))
    if link.fin is not None:
        c_t += float(np.sum(link.fin.c_t))
    if link.areas is not None:
        c_t += float(np.sum(link.areas.c_t))
    return -c_t * _along(water, speed)


def _moving(speed: float) -> float:
    if not speed > STILL:
        raise ValueError(
            f"The robot must move for a cost per distance: its speed is {speed:.1e} m/s."
        )
    return speed


def _along(water: Water, speed: float) -> float:
    """Compute the drag along a straight body, per unit coefficient [m2/s2]."""
    return water.drag(speed, 0.0, 0.0, 0.0, Element(1.0, 0.0, 0.0, 0.0))[0]


# ---- figures of a trial --------------------------------------------------------------------------


def work_power(trial: Contents, kind: int) -> float:
    """Compute the mean mechanical power [W].

    Args:
        trial: The run.
        kind: Column of the trial's `work`.
    """
    trial.need("a mechanical power", "work")
    return mean_power(trial.time, trial.work[:, kind])


def electrical_power(trial: Contents) -> float:
    """Compute the mean electrical power above idle (4) of a trial [W]; a ValueError if it has no power model."""
    if trial.electrical_work is None:
        raise ValueError(
            "The power of the motors is unknown: give --joints servo (in Python joints='servo'), or "
            "a robot with an `active_power`; a robot that is operated needs a power meter."
        )
    return mean_power(trial.time, trial.electrical_work)


def speed_through_water(trial: Contents) -> float:
    """Compute the `forward_velocity` of a trial relative to the water: the local current is subtracted [m/s].

    The water's velocity is that where the center of mass was, averaged over the run: of waves, which
    carry the robot back and forth with them, only their slow drift remains. Raises a ValueError on
    ground.
    """
    water = _water(trial, "a speed through the water")
    return speed_relative_to(water, trial.time, trial.center_of_mass)


def speed_relative_to(water: Water, time: Time, center_of_mass: Path) -> float:
    """Compute the straight-line displacement relative to the water where the robot was / duration [m/s].

    Args:
        water: Water in which it swam.
        time: Times of the samples, since the start of the run [s].
        center_of_mass: p [m], world axes.

    Raises:
        ValueError: If the log has fewer than two samples.
    """
    velocity = mean_velocity(time, center_of_mass)
    velocity -= _mean_current(water, time, center_of_mass)
    return float(np.linalg.norm(velocity))


def transport_speed(trial: Contents) -> float:
    """Compute the speed on which costs per distance rest: through the water, on ground that over ground [m/s].

    A robot that drifts with a current covers ground without swimming.
    """
    if isinstance(trial.environment, Ground):
        return forward_velocity(trial.time, trial.center_of_mass)
    return speed_through_water(trial)


def _mean_current(water: Water, time: Time, center_of_mass: Path) -> Float[np.ndarray, " n_axes"]:
    """Return the velocity of the water where the robot was, averaged over the run [m/s]."""
    velocity = water.velocity(center_of_mass, time)
    if water.flow is None:
        return velocity[0]
    return cumulative_integral(time, velocity)[-1] / np.ptp(time)


def steady_velocity(trial: Contents) -> float:
    """Compute the `forward_velocity` over the steady part of a trial only [m/s]; a ValueError if the run is too short.

    The steady part is as many whole gait cycles as fit after the first third of the run and after
    10 s, counted back from the end; without a gait, all of that time. It therefore includes neither
    the start nor the gait's ripple.
    """
    part = cycles.steady_part(trial.time, trial.period)
    displacement = _displacement(trial.time, _path_over_ground(trial), part)
    return float(np.linalg.norm(displacement)) / (part.stop - part.start)


def steady_speed_through_water(trial: Contents) -> float:
    """Compute the `speed_through_water` over the steady part of a trial only [m/s]; see `steady_velocity`.

    Raises a ValueError if the run is too short, or on ground.
    """
    _water(trial, "a speed through the water")
    return _steady_transport_speed(trial)


def _steady_transport_speed(trial: Contents) -> float:
    part = cycles.steady_part(trial.time, trial.period)
    displacement = _displacement(trial.time, _path_through_water(trial), part)
    return float(np.linalg.norm(displacement)) / (part.stop - part.start)


def course(trial: Contents) -> float:
    """Return the direction of travel over the steady part, in [-pi, pi] from the world x axis, counter-clockwise [rad].

    Raises a ValueError if the trial is too short or the robot stands still.
    """
    part = cycles.steady_part(trial.time, trial.period)
    displacement = _displacement(trial.time, _path_over_ground(trial), part)
    return float(cycles.direction_of(displacement[np.newaxis])[0])


def heading_mean(trial: Contents) -> CycleMean:
    """Average a trial's heading over the gait cycle around each moment; a ValueError if there is no whole cycle."""
    trial.need("a mean heading", "heading")
    return cycles.cycle_mean(trial.time, trial.heading, trial.heading_rate, _period(trial))


def sideslip(trial: Contents) -> float:
    """Compute course minus heading of a trial, both as cycle means, averaged over the steady part [rad].

    Positive when the robot travels to the left of its heading. Raises a ValueError if the trial is
    too short or the robot stands still.
    """
    trial.need("a sideslip", "heading")
    time = trial.time
    period = _period(trial)
    is_steady = _in_steady_part(time, period)
    course_mean = cycles.course_cycle_mean(
        time, trial.center_of_mass, trial.center_of_mass_velocity, period
    )
    heading = heading_mean(trial)
    if not np.any(is_steady):
        rule = "must hold the middle of a whole gait cycle after the transient for a sideslip"
        advice = f"make it at least one sample longer than {time[-1] - time[0]:.4g} s"
        raise BadArgument("time", f"{rule}: {advice}")
    angle = (course_mean.value - heading.value)[is_steady]
    # Average directions, not numbers: course and heading may be unwrapped whole turns apart.
    return float(np.angle(np.mean(np.exp(1j * angle))))


def turning_rate(trial: Contents) -> float:
    """Compute the least-squares slope of the heading's cycle mean over the steady part; positive to the left [rad/s].

    Raises a ValueError if the steady part of the trial is shorter than two cycles: a single mean
    has no slope.
    """
    trial.need("a turning rate", "heading")
    period = _period(trial)
    part = cycles.steady_part(trial.time, period)
    is_steady = _in_steady_part(trial.time, period)
    if part.n_cycles is None or part.n_cycles < 2 or np.count_nonzero(is_steady) < 2:
        rule = "must span at least two gait cycles after the transient for a turning rate"
        length = f"{part.stop - part.start:.4g} s"
        raise BadArgument("time", f"{rule}; got {length}, and a cycle takes {period:.4g} s")
    mean = heading_mean(trial)
    time = mean.time[is_steady]
    heading = mean.value[is_steady]
    centered_time = time - np.mean(time)
    covariance = np.sum(centered_time * (heading - np.mean(heading)))
    return float(covariance / np.sum(centered_time * centered_time))


def strouhal_number(trial: Contents) -> float:
    """Compute the Strouhal number f A / U of the tail of a trial [-].

    f = 1 / period, U the steady velocity through the water, A the peak-to-peak excursion of the fin's trailing edge
    (without a fin, of the tail end) across the course. A is computed for each cycle of the steady
    part, across the course of that cycle, and averaged: on a straight path this is the excursion
    over the whole steady part; on a curved path the curve itself does not count. Eels swim at about
    0.32 (Tytell 2004). Raises a ValueError if the trial is too short or the robot stands still.
    """
    trial.need("a Strouhal number", "link_angle")
    period = _period(trial)
    return _excursion_across_course(trial, period) / (period * _steady_transport_speed(trial))


def _excursion_across_course(trial: Contents, period: float) -> float:
    """Return the peak-to-peak excursion of the trailing edge, the mean over the steady cycles [m]."""
    time = trial.time
    path = _path_through_water(trial)
    part = cycles.steady_part(time, period)
    center = path.position[:, :2]
    posture = Posture(trial.chain, center, trial.link_angle, fin_angle=trial.fin_angle)
    trailing_edge = posture.trailing_edge
    bounds = np.linspace(part.start, part.stop, (part.n_cycles or 1) + 1)
    positions_at_bounds = cycles.interpolated(time, path.position, path.velocity, bounds)
    courses = cycles.direction_of(np.diff(positions_at_bounds, axis=0))
    excursion = 0.0
    for begin, end, course_angle in zip(bounds[:-1], bounds[1:], courses, strict=True):
        edge_in_cycle = trailing_edge[(time >= begin) & (time <= end)]
        across_course = np.array([-np.sin(course_angle), np.cos(course_angle)])
        excursion += float(np.ptp(edge_in_cycle @ across_course)) / len(courses)
    return excursion


def quasi_propulsive_efficiency(trial: Contents) -> float:
    """Compute the towing power of the straight robot at the speed of a trial / mechanical power of its joints [-].

    The efficiency compares the swimmer with the same body under tow, so unlike a propeller's
    efficiency it is not bounded by 1. A "Froude efficiency" is not defined for a self-propelled
    body: thrust and drag are one force. Raises a ValueError on ground, or if the joints did no
    work.
    """
    water = _water(trial, "a towing drag")
    speed = speed_through_water(trial)
    drag = towing_drag(trial.chain, water, speed)
    power = work_power(trial, 0)
    if not power > 0.0:
        raise BadArgument("mechanical_power", f"must be > 0 W for an efficiency, got {power}")
    return drag * speed / power


def drag_share(trial: Contents) -> float:
    """Compute `linear_drag_share` at a trial's speed through the water [-]; a ValueError on ground, or without drag."""
    return linear_drag_share(
        _water(trial, "a share of the linear drag"), speed_through_water(trial)
    )


def _period(trial: Contents) -> float:
    if trial.period is None:
        raise ValueError(
            "The trial must have a gait that moves for a figure over whole gait cycles."
        )
    return trial.period


def _water(trial: Contents, figure: str) -> Water:
    if isinstance(trial.environment, Ground):
        raise ValueError(f"The environment must be water for {figure}; on ground there is none.")
    return trial.environment


class _Motion(NamedTuple):
    """Motion of the center of mass, over ground or relative to the water."""

    position: Path
    """Position at the samples [m]."""
    velocity: Path
    """Velocity at the samples [m/s]."""


def _path_over_ground(trial: Contents) -> _Motion:
    return _Motion(trial.center_of_mass, trial.center_of_mass_velocity)


def _path_through_water(trial: Contents) -> _Motion:
    """Return the motion relative to the water where the robot was; on ground, or in still water, that over ground."""
    motion = _path_over_ground(trial)
    water = trial.environment
    if isinstance(water, Ground) or water.is_still:
        return motion
    water_velocity = water.velocity(trial.center_of_mass, trial.time)
    drift = cumulative_integral(trial.time, water_velocity)
    return _Motion(motion.position - drift, motion.velocity - water_velocity)


def _displacement(time: Time, motion: _Motion, part: SteadyPart) -> Float[np.ndarray, " n_axes"]:
    bounds = np.array([part.start, part.stop])
    position_at_start, position_at_stop = cycles.interpolated(
        time, motion.position, motion.velocity, bounds
    )
    return position_at_stop - position_at_start


def _in_steady_part(time: Time, period: float) -> Bool[np.ndarray, " n_middles"]:
    """Return which cycle middles belong to cycles within the steady part."""
    middle = cycles.cycle_middles(time, period)
    part = cycles.steady_part(time, period)
    slack = 1e-9 * period
    begins_inside = middle >= part.start + 0.5 * period - slack
    ends_inside = middle <= part.stop - 0.5 * period + slack
    return begins_inside & ends_inside
