"""Figures of path following: how soon and how closely a run reached its path, each with a single meaning.

Pure functions of the distance from the path over time, like `metrics`. All but the last use its
mean over the gait cycle: the center of mass of a swimming snake swings across its course, and that
swing is the ripple, not an error.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from laticauda.trials.cycles import (
    CycleMean,
    Middles,
    Time,
    cycle_mean,
    interpolated,
    resolves_cycles,
)
from laticauda.trials.trial import Trial
from laticauda.values import BadArgument, check_positive

TOLERANCE = 0.1
"""Cycle-mean error within which a run counts as converged [m]."""
CYCLES_OF_A_SUMMARY = 1.5
"""Gait cycles that a run must last for figures of cycle means in `summarize_following`."""
LAST_CYCLES = 3
"""Gait cycles at the end of a run over which it has to stay with its path."""
_ROUNDING = 1e-9
"""Fraction of a cycle that may be missing from a whole one [-]."""


class Convergence(NamedTuple):
    """When and where a run reached its path."""

    time: float
    """Time since the start of the run [s]."""
    distance: float
    """Progress along the path since the start [m]."""


def mean_error(time: Time, cross_track_error: Time, period: float) -> CycleMean:
    """Average the cross-track error over the gait cycle around each moment [m].

    Args:
        time: Times of the samples [s].
        cross_track_error: Distance from the path, positive to the left [m].
        period: Gait period [s].

    Raises:
        ValueError: If the log is shorter than one cycle, or too coarse to resolve one.
    """
    return cycle_mean(time, cross_track_error, _rate(time, cross_track_error), period)


def convergence(
    time: Time,
    cross_track_error: Time,
    along_track_distance: Time,
    period: float,
    tolerance: float = TOLERANCE,
) -> Convergence | None:
    """Find when the cycle-mean error came within the tolerance and stayed there for a whole cycle.

    Args:
        time: Times of the samples [s].
        cross_track_error: Distance from the path, positive to the left [m].
        along_track_distance: Position along the path [m].
        period: Gait period [s].
        tolerance: Largest cycle-mean error to either side [m].

    Returns:
        Time and progress along the path up to then; None if it never converged.

    Raises:
        ValueError: If the log is shorter than one cycle, or too coarse to resolve one.
    """
    check_positive("tolerance", tolerance, "m")
    middle, error = mean_error(time, cross_track_error, period)
    entry = _first_entry(middle, np.abs(error) > tolerance, period)
    if entry is None:
        return None
    entry_time = middle[entry : entry + 1]
    rate = _rate(time, along_track_distance)
    distance = interpolated(time, along_track_distance, rate, entry_time)
    return Convergence(
        time=float(entry_time[0] - time[0]),
        distance=float(distance[0] - along_track_distance[0]),
    )


def _first_entry(
    middle: Middles, is_outside: Bool[np.ndarray, " n_middles"], period: float
) -> int | None:
    """Return the index at which the first span of at least a cycle begins that is not outside.

    Such spans lie between two excursions, before the first and after the last.
    """
    outside = np.flatnonzero(is_outside)
    entries = np.concatenate(([0], outside + 1))
    exits = np.concatenate((outside, [middle.size]))
    for entry, leave in zip(entries.tolist(), exits.tolist(), strict=True):
        if entry < leave and middle[leave - 1] - middle[entry] >= period * (1.0 - _ROUNDING):
            return entry
    return None


def overshoot(time: Time, cross_track_error: Time, period: float) -> float:
    """Return the largest cycle-mean error on the side of the path opposite to the start of the run [m], at least 0.

    Args:
        time: Times of the samples [s].
        cross_track_error: Distance from the path, positive to the left [m].
        period: Gait period [s].

    Raises:
        ValueError: If the log is shorter than one cycle, or too coarse to resolve one.
    """
    error = mean_error(time, cross_track_error, period).value
    return max(0.0, float(np.max(-np.sign(cross_track_error[0]) * error)))


def steady_error(
    time: Time, cross_track_error: Time, period: float, start: float, stop: float = np.inf
) -> float:
    """Compute the root mean square of the cycle-mean error from `start` on and before `stop` [m].

    Args:
        time: Times of the samples [s].
        cross_track_error: Distance from the path, positive to the left [m].
        period: Gait period [s].
        start: Time since the start of the run; what was before does not count [s].
        stop: Time since the start of the run; what comes from then on does not count [s].

    Raises:
        ValueError: If the log is shorter than one cycle, or too coarse to resolve one.
    """
    middle, error = mean_error(time, cross_track_error, period)
    counts = _since(time[0], middle, start) & (middle - time[0] < stop)
    return _root_mean_square(error[counts])


def ripple(time: Time, cross_track_error: Time, period: float, start: float) -> float:
    """Compute the root mean square of the error minus its cycle mean from `start` on [m].

    Args:
        time: Times of the samples [s].
        cross_track_error: Distance from the path, positive to the left [m].
        period: Gait period [s].
        start: Time since the start of the run; what was before does not count [s].

    Raises:
        ValueError: If the log is shorter than one cycle, or too coarse to resolve one.
    """
    middle, error = mean_error(time, cross_track_error, period)
    rate = _rate(time, cross_track_error)
    error_with_ripple = interpolated(time, cross_track_error, rate, middle)
    counts = _since(time[0], middle, start)
    return _root_mean_square((error_with_ripple - error)[counts])


def last_third_error(time: Time, cross_track_error: Time, period: float) -> float:
    """Compute the mean of the cycle-mean error over the last third of the run, with its sign [m].

    Args:
        time: Times of the samples [s].
        cross_track_error: Distance from the path, positive to the left [m].
        period: Gait period [s].

    Raises:
        ValueError: If the log is shorter than one cycle, or too coarse to resolve one.
    """
    return float(np.mean(last_third(time, cross_track_error, period)))


def last_third(time: Time, cross_track_error: Time, period: float) -> Middles:
    """Return the cycle-mean error over the last third of the run [m].

    Args:
        time: Times of the samples [s].
        cross_track_error: Distance from the path, positive to the left [m].
        period: Gait period [s].

    Raises:
        ValueError: If the log is shorter than one cycle, or too coarse to resolve one.
    """
    middle, error = mean_error(time, cross_track_error, period)
    return error[_since(time[0], middle, _begin_of_last_third(time))]


def last_cycles_error(time: Time, cross_track_error: Time, period: float) -> float:
    """Return the largest cycle-mean error over the last three cycles of the run, to either side [m].

    A slow swing about the path is within the tolerance for a cycle as it crosses, and leaves it
    again: `convergence` alone does not tell it from a run that stays.

    Args:
        time: Times of the samples [s].
        cross_track_error: Distance from the path, positive to the left [m].
        period: Gait period [s].

    Raises:
        ValueError: If the log is shorter than one cycle, or too coarse to resolve one.
    """
    middle, error = mean_error(time, cross_track_error, period)
    begin = float(time[-1]) - LAST_CYCLES * period
    is_late = middle >= begin + 0.5 * period * (1.0 - _ROUNDING)
    return float(np.max(np.abs(error[is_late])))


def stays(figures: Mapping[str, float | None]) -> bool:
    """Return whether a run came to its path, and is with it over its last three cycles.

    Args:
        figures: Its figures, from `summarize_following`.
    """
    last_error = figures["last_cycles_error"]
    has_come = figures["convergence_time"] is not None
    return has_come and last_error is not None and last_error <= TOLERANCE


def _has_last_cycles(time: Time, cross_track_error: Time, period: float) -> bool:
    """Return whether a run has three whole cycles at its end.

    It does not if it is shorter, or was cut: nothing was recorded while the computer stood still.
    """
    if time[-1] - time[0] < LAST_CYCLES * period * (1.0 - _ROUNDING):
        return False
    middle = mean_error(time, cross_track_error, period).time
    begin = float(time[-1]) - LAST_CYCLES * period
    return float(middle[-1]) >= begin + 0.5 * period


def _begin_of_last_third(time: Time) -> float:
    """Return the time since the start of the run at which its last third begins [s]."""
    return 2.0 / 3.0 * float(time[-1] - time[0])


def _has_last_third(time: Time, cross_track_error: Time, period: float) -> bool:
    """Return whether a whole gait cycle lies around a sample of the last third of the run.

    It does not if the run was cut: nothing was recorded while the computer stood still.
    """
    middle = mean_error(time, cross_track_error, period).time
    return float(middle[-1] - time[0]) >= _begin_of_last_third(time)


def saturated_share(time: Time, is_saturated: Time) -> float:
    """Compute the share of the run during which the offset was at its limit [-].

    Args:
        time: Times of the samples [s].
        is_saturated: 1 where it was at the limit, 0 where not; each value holds until the next
            sample.

    Raises:
        ValueError: If there are fewer than two samples.
    """
    if time.size < 2:
        raise BadArgument(
            "time", f"must have at least 2 samples for a share of time, got {time.size}"
        )
    return float(np.sum(is_saturated[:-1] * np.diff(time)) / (time[-1] - time[0]))


FIGURES = {
    "convergence_time": ("s", "time until the mean error stays within 0.1 m for a cycle"),
    "convergence_distance": ("m", "progress along the path until then"),
    "overshoot": ("m", "overshoot: largest mean error on the far side of the path"),
    "steady_error": ("m", "root mean square of the mean error after that"),
    "ripple": ("m", "root mean square of the swing about the mean after that"),
    "last_cycles_error": ("m", "largest mean error over the last three cycles, to either side"),
    "last_third_error": ("m", "mean error over the last third of the run"),
    "last_third_height_error": ("m", "mean height above the path over the last third of the run"),
    "end_time": ("s", "time until the end of the path, beyond which the robot swam on"),
    "saturated_share": ("", "share of the run with the offset at its limit"),
}
"""Unit and meaning of the figures of `summary`; errors are cycle means of the distance from the path."""


def summarize_following(trial: Trial) -> dict[str, float | None]:
    """Return the figures of a path-following run by the names of `FIGURES`; None where the run does not define one.

    Those of a run that failed are all None.

    Args:
        trial: A run with the signals of `laticauda.control.PathFollowing`.

    Raises:
        ValueError: If the trial lacks these signals.
    """
    if "cross_track_error" not in trial.signals:
        raise BadArgument(
            "trial", "must be a run that followed a path: it has no signal `cross_track_error`"
        )
    figures: dict[str, float | None] = dict.fromkeys(FIGURES)
    if not trial.succeeded:
        return figures
    time = trial.time
    error = trial.signals["cross_track_error"]
    distance = trial.signals["along_track_distance"]
    path_length = getattr(path_of(trial), "lengths", (np.inf,))[-1]
    if distance[-1] >= path_length:
        first_sample_at_end = np.argmax(distance >= path_length)
        figures["end_time"] = float(time[first_sample_at_end] - time[0])
    if time.size > 1:
        figures["saturated_share"] = saturated_share(time, trial.signals["is_saturated"])
    period = trial.period
    if period is None or time[-1] - time[0] < CYCLES_OF_A_SUMMARY * period:
        return figures
    if not resolves_cycles(time, period):
        return figures
    figures["overshoot"] = overshoot(time, error, period)
    if _has_last_cycles(time, error, period):
        figures["last_cycles_error"] = last_cycles_error(time, error, period)
    if _has_last_third(time, error, period):
        figures["last_third_error"] = last_third_error(time, error, period)
        if "height_error" in trial.signals:
            height_error = trial.signals["height_error"]
            figures["last_third_height_error"] = last_third_error(time, height_error, period)
    converged = convergence(time, error, distance, period)
    if converged is not None:
        figures["convergence_time"] = converged.time
        figures["convergence_distance"] = converged.distance
        figures["steady_error"] = steady_error(time, error, period, converged.time)
        figures["ripple"] = ripple(time, error, period, converged.time)
    return figures


def path_of(trial: Trial) -> Any:
    """Return the path that a run was to follow; None if it is unknown."""
    motion = getattr(trial.scenario, "motion", None)
    return getattr(motion, "path", None)


def nearest_points(trial: Trial) -> Float[np.ndarray, "n_samples 2"]:
    """Return the point of the path abreast of the robot at every sample [m]: the part of the path that it covered.

    Args:
        trial: A run with the signals of `laticauda.control.PathFollowing`.
    """
    angle = trial.signals["path_tangential_angle"]
    error = trial.signals["cross_track_error"]
    left = np.stack((-np.sin(angle), np.cos(angle)), axis=1)
    return np.asarray(trial.center_of_mass[:, :2] - error[:, np.newaxis] * left)


def _rate(time: Time, signal: Time) -> Time:
    if time.size < 3:
        raise BadArgument(
            "time", f"must have at least 3 samples for a mean over a cycle, got {time.size}"
        )
    return np.asarray(np.gradient(signal, time), dtype=np.float64)


def _since(begin: float, middle: Middles, start: float) -> Bool[np.ndarray, " n_middles"]:
    """Return which cycle middles lie at or after `start`, a time since the beginning of the run."""
    is_since = middle - begin >= start
    if not np.any(is_since):
        latest = float(middle[-1] - begin)
        rule = f"must be <= {latest:.6g} s, the middle of the last gait cycle"
        raise BadArgument("start", f"{rule}, got {start:.6g} s")
    return is_since


def _root_mean_square(values: Float[np.ndarray, " n"]) -> float:
    return float(np.sqrt(np.mean(values * values)))
