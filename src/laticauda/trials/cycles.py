"""Whole gait cycles of a log: their positions, values between samples, means over one cycle.

A swimming snake's path and heading carry the ripple of its gait; a mean over exactly one cycle is
free of it. Nothing here knows about robots: signals in, signals out. A signal may have further axes
after the time axis.
"""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, Inexact

from laticauda.values import BadArgument

Time = Float[np.ndarray, " n_samples"]
Signal = Float[np.ndarray, "n_samples ..."]
Points = Float[np.ndarray, "n_points ..."]
AnyPoints = Inexact[np.ndarray, "n_points ..."]  # real, or complex for complex-step derivatives
Middles = Float[np.ndarray, " n_middles"]

TRANSIENT = 10.0
"""The first third of a run, and at least this long, counts as the transient [s]."""
SAMPLES_PER_CYCLE = 10
"""Fewer samples do not resolve a cycle."""
SHORTEST_DISPLACEMENT = 1e-6
"""A shorter displacement has no direction [m]."""
_ROUNDING = 1e-9
"""Fraction of a cycle that may be missing from a whole number of cycles [-]."""


class CycleMean(NamedTuple):
    """A signal averaged over the gait cycle around each moment."""

    time: Middles
    """Middles of the cycles [s]: all samples at least half a cycle away from both ends of the log."""
    value: Float[np.ndarray, "n_middles ..."]
    """Mean over that cycle, in the signal's unit."""


class SteadyPart(NamedTuple):
    """The part of a run that counts as steady."""

    start: float
    """Start time [s]."""
    stop: float
    """End time, which is the end of the run [s]."""
    n_cycles: int | None
    """Number of whole gait cycles in it; None if no gait is known."""


def steady_part(time: Time, period: float | None) -> SteadyPart:
    """Find the whole gait cycles at the end of the run, after its first third and at least 10 s.

    The part holds as many cycles as fit into that time; without a period, it is all of that time.

    Args:
        time: Times of the samples [s].
        period: Gait period [s]; None if no gait is known.

    Raises:
        ValueError: If the run is too short for one cycle; the message says how long it must be.
    """
    start = 0.0
    stop = 0.0
    if time.size:
        start = float(time[0])
        stop = float(time[-1])
    duration = stop - start
    time_after_transient = duration - max(duration / 3.0, TRANSIENT)
    if period is None:
        if time_after_transient <= 0.0:
            rule = f"must span more than {TRANSIENT:g} s for a steady part"
            raise BadArgument("time", f"{rule}, got {duration:.6g} s")
        return SteadyPart(stop - time_after_transient, stop, None)
    _refuse_coarse(time, period)
    n_cycles = 0
    if time_after_transient > 0.0:
        n_cycles = int(np.floor(time_after_transient / period + _ROUNDING))
    if n_cycles < 1:
        shortest = max(TRANSIENT + period, 1.5 * period)
        transient = f"a transient of {TRANSIENT:g} s or a third"
        rule = f"must span at least {shortest:.4g} s for a steady part: {transient}"
        raise BadArgument(
            "time", f"{rule}, then one whole cycle of {period:.4g} s; got {duration:.6g} s"
        )
    return SteadyPart(max(stop - n_cycles * period, start), stop, n_cycles)


def find_steady_starts(
    time: Time, period: Float[np.ndarray, " n_runs"]
) -> Float[np.ndarray, " n_runs"]:
    """Return the start of the steady part of many runs, as `steady_part` does [s]; nan if there is none.

    Args:
        time: Times of the samples of every run [s].
        period: Gait period of each run [s]; nan if it has no gait.
    """
    stop = float(time[-1])
    start = float(time[0])
    duration = stop - start
    time_after_transient = duration - max(duration / 3.0, TRANSIENT)
    if time_after_transient <= 0.0 or time.size < 2:
        return np.full(period.size, np.nan)
    n_cycles = np.floor(time_after_transient / period + _ROUNDING)
    duration_of_cycles = n_cycles * period
    begin = np.maximum(stop - duration_of_cycles, start)
    shortest_period = _mean_step(time) * SAMPLES_PER_CYCLE
    is_resolved = shortest_period <= period * (1.0 + _ROUNDING)
    has_cycle = is_resolved & (n_cycles >= 1.0)
    begin_of_cycles = np.where(has_cycle, begin, np.nan)
    begin_without_gait = stop - time_after_transient
    return np.where(np.isnan(period), begin_without_gait, begin_of_cycles)


def interpolated(
    time: Time, signal: Signal, rate: Signal, at: Float[np.ndarray, " n_points"]
) -> Points:
    """Interpolate a signal between its samples by cubic Hermite polynomials, using its known rate (error ~ step^4).

    Args:
        time: Times of the samples [s], strictly increasing.
        signal: Values at the samples.
        rate: Its time derivative at the samples.
        at: Times at which the values are wanted [s], within the log.

    Returns:
        One row per moment in `at`.
    """
    i = np.clip(np.searchsorted(time, at, side="right") - 1, 0, time.size - 2)
    step = time[i + 1] - time[i]
    s = (at - time[i]) / step
    over_axes = _index_over_axes_of(signal)
    return hermite(
        s[over_axes], step[over_axes], (signal[i], signal[i + 1]), (rate[i], rate[i + 1])
    )


def _index_over_axes_of(signal: Signal) -> tuple[Any, ...]:
    """Return an index that gives an array over time the further axes of a signal, each of length 1."""
    return (..., *(np.newaxis,) * (signal.ndim - 1))


def hermite(
    s: Any, step: Any, signal: tuple[AnyPoints, AnyPoints], rate: tuple[AnyPoints, AnyPoints]
) -> AnyPoints:
    """Evaluate the cubic polynomial between two samples.

    Args:
        s: Position, from 0 at the first sample to 1 at the second; numbers or arrays.
        step: Time between the two samples [s].
        signal: Values at the two samples.
        rate: Time derivatives at the two samples.
    """
    value = signal[0] + s * s * (3.0 - 2.0 * s) * (signal[1] - signal[0])
    return value + step * s * (1.0 - s) * ((1.0 - s) * rate[0] - s * rate[1])


def cycle_mean(time: Time, signal: Signal, rate: Signal, period: float) -> CycleMean:
    """Compute the mean of a signal over the whole gait cycle centered at each moment.

        m(t) = 1/T integral of s over [t - T/2, t + T/2]

    The mean is free of every ripple whose period divides T; a straight line is its own cycle mean.

    Args:
        time: Times of the samples [s], strictly increasing.
        signal: Values at the samples.
        rate: Its time derivative at the samples.
        period: Gait period T [s].

    Raises:
        ValueError: If the log is shorter than one cycle.
    """
    middle = cycle_middles(time, period)
    step = np.diff(time)[_index_over_axes_of(signal)]
    # The end correction of the trapezoidal rule makes the integral as accurate as the
    # interpolation.
    piece = 0.5 * step * (signal[:-1] + signal[1:]) + step**2 / 12.0 * (rate[:-1] - rate[1:])
    integral = np.concatenate((np.zeros_like(signal[:1]), np.cumsum(piece, axis=0)))
    integral_before = interpolated(time, integral, signal, middle - 0.5 * period)
    integral_after = interpolated(time, integral, signal, middle + 0.5 * period)
    return CycleMean(middle, (integral_after - integral_before) / period)


def course_cycle_mean(
    time: Time,
    center_of_mass: Float[np.ndarray, "n_samples n_axes"],
    velocity: Float[np.ndarray, "n_samples n_axes"],
    period: float,
) -> CycleMean:
    """Return the direction of travel [rad], unwrapped: that of the displacement over the cycle centered at each moment.

    Args:
        time: Times of the samples [s], strictly increasing.
        center_of_mass: p [m], world axes; only x and y are used.
        velocity: p' [m/s], world axes.
        period: Gait period [s].

    Raises:
        ValueError: If the log is shorter than one cycle, or the robot stands still over one.
    """
    middle = cycle_middles(time, period)
    ends = np.concatenate((middle - 0.5 * period, middle + 0.5 * period))
    before, after = np.split(interpolated(time, center_of_mass, velocity, ends), 2)
    return CycleMean(middle, np.unwrap(direction_of(after - before)))


def cycle_middles(time: Time, period: float) -> Middles:
    """Return the times of the samples that have half a cycle before and after them [s].

    Args:
        time: Times of the samples [s], strictly increasing.
        period: Gait period [s].

    Raises:
        ValueError: If the log is shorter than one cycle, or too coarse to resolve one.
    """
    _refuse_coarse(time, period)
    # A log of exactly one cycle has one middle, whatever the last digits of its times are.
    slack = _ROUNDING * period
    has_half_before = time - time[0] >= 0.5 * period - slack
    has_half_after = time[-1] - time >= 0.5 * period - slack
    middle = time[has_half_before & has_half_after]
    span = float(time[-1] - time[0])
    if not middle.size and span >= period - slack:
        middle = np.array([0.5 * (time[0] + time[-1])])
    if not middle.size:
        raise BadArgument(
            "time", f"must span at least one gait cycle of {period:.4g} s, got {span:.6g} s"
        )
    return middle


def direction_of(
    displacement: Float[np.ndarray, "n_points n_axes"],
) -> Float[np.ndarray, " n_points"]:
    """Compute the angles of displacements in the plane from the world x axis, in [-pi, pi] [rad].

    Raises:
        ValueError: If a displacement is shorter than a micrometer: it has no direction.
    """
    x = displacement[:, 0]
    y = displacement[:, 1]
    shortest = float(np.min(np.hypot(x, y)))
    if shortest < SHORTEST_DISPLACEMENT:
        raise ValueError(f"The robot must travel to have a course: it moved only {shortest:.1e} m.")
    return np.arctan2(y, x)


def resolves_cycles(time: Time, period: float) -> bool:
    """Return whether a log has enough samples for means over its gait cycles; one that was cut may not.

    Args:
        time: Times of the samples [s], strictly increasing; at least two.
        period: Gait period [s].
    """
    return bool(_mean_step(time) * SAMPLES_PER_CYCLE <= period * (1.0 + _ROUNDING))


def _mean_step(time: Time) -> float:
    return float(time[-1] - time[0]) / (time.size - 1)


def _refuse_coarse(time: Time, period: float) -> None:
    if time.size < 2:
        raise BadArgument("time", f"must have at least 2 samples, got {time.size}")
    if not resolves_cycles(time, period):
        step = _mean_step(time)
        rule = f"must have at least {SAMPLES_PER_CYCLE} samples per gait cycle of {period:.4g} s"
        raise BadArgument("time", f"{rule}, got one every {step:.4g} s")
