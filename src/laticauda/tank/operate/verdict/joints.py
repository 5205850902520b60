"""Checks of the joints: do they follow, and do their angles change as their rates say?"""

import math
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from laticauda.control.estimation import JointSample
from laticauda.tank.operate.verdict.check import Measurement
from laticauda.tank.operate.verdict.recorded_run import RecordedRun
from laticauda.tank.operate.verdict.signals import LONGEST_GAP, jumps_of
from laticauda.trials.logs import interpolate_columns

LATENESS = 0.032
"""Time by which answers are late when a computer pauses [s]; a jump must outlast it."""
UNKNOWN_LAG_SHARE = 0.5
"""Share of its swing by which a joint may differ from its reference if nothing says how late its
servo may be [-]."""
SMALLEST_SQUARED_LAG = 1e-12
"""Sum of squared lags below which reference and servo are the same [rad^2]."""
SHORTEST_INTERVAL = 1e-6
"""Stands for an interval between two answers of the same time [s]."""

JointCycles = Float[np.ndarray, "n_cycles n_points n_driven"]
JointSeries = Float[np.ndarray, "n_samples n_joints"]


def measure_joint_error(run: RecordedRun) -> Measurement | None:
    """Measure how far joints are from the segment between reference and servo, by cycle.

    A servo follows as well as the water's load allows. One that does better than the model's is
    right, and so is one that lags as the model predicts. Without a model, only mean and swing
    count.
    """
    if not len(run.cycles):
        return None
    sample_times = [sample.time for sample in run.joint_samples]
    sampled = run.cycles.resample(sample_times, _column_of_each(run.joint_samples, "angle"))
    measured = sampled[..., run.driven_columns]
    reference = _references_in_force(run)
    if run.model is None:
        error = _error_of_mean_and_swing(measured, reference)
    else:
        lag = run.cycles.resample(run.model.time, run.model.joint_angle) - reference
        error = _error_beyond_lag(measured - reference, lag)
    worst_joint = int(error.max(axis=0).argmax())
    return Measurement(
        times=run.cycles.ends,
        values=error.max(axis=1),
        location=f"module {run.driven_columns[worst_joint] + 1}",
    )


def measure_angle_jump(run: RecordedRun) -> Measurement | None:
    """Measure jumps of every joint's angle that its rate does not explain, also within a cycle.

    A sensor that slips stays where it is, whereas an answer that came late is made up for by the
    next ones.
    """
    samples = run.joint_samples
    if len(samples) < 2 or any(sample.rate is None for sample in samples):
        return None
    times = np.array([sample.time for sample in samples], dtype=float)
    n_answers = _answers_while_late(times)
    if not 1 < n_answers < 0.5 * len(times):
        return None
    angle = _without_gaps(times, _column_of_each(samples, "angle"))
    rate = _without_gaps(times, _column_of_each(samples, "rate"))
    unexplained = _change_not_explained_by_rate(times, angle, rate)
    jumps = jumps_of(
        times[1:], np.cumsum(unexplained, axis=1).T, longest=math.inf, length=n_answers
    )
    worst_joint = int(jumps.sizes.max(axis=0).argmax())
    return Measurement(
        times=jumps.times,
        values=jumps.sizes.max(axis=1),
        location=f"module {worst_joint + 1}",
    )


def _column_of_each(samples: Sequence[JointSample], name: str) -> JointSeries:
    return np.array([getattr(sample, name) for sample in samples], dtype=float)


def _references_in_force(run: RecordedRun) -> JointCycles:
    """Return the reference of every driven joint at every point of every cycle [rad]."""
    sent_at = [reference.time for reference in run.references]
    latest = np.searchsorted(sent_at, run.cycles.points, side="right") - 1
    angles = np.array([reference.angle for reference in run.references])[:, run.driven_columns]
    return angles[np.maximum(latest, 0)]


def _error_beyond_lag(
    error: JointCycles, lag: JointCycles
) -> Float[np.ndarray, "n_cycles n_driven"]:
    """Return the root mean square of what no share of the model's lag explains [rad].

    Args:
        error: Measured angle minus reference [rad].
        lag: Angle of the model's servo minus reference [rad].
    """
    squared_lag = np.sum(lag * lag, axis=1)
    share = np.sum(error * lag, axis=1) / np.maximum(squared_lag, SMALLEST_SQUARED_LAG)
    explained = np.clip(share, 0.0, 1.0)[:, np.newaxis] * lag
    return np.sqrt(np.mean((error - explained) ** 2, axis=1))


def _error_of_mean_and_swing(
    measured: JointCycles, reference: JointCycles
) -> Float[np.ndarray, "n_cycles n_driven"]:
    """Return by how much mean or swing of a cycle are off, beyond what a lag may explain [rad]."""
    error_of_mean = np.abs((measured - reference).mean(axis=1))
    swing = reference.std(axis=1)
    error_of_swing = np.abs(measured.std(axis=1) - swing) - UNKNOWN_LAG_SHARE * swing
    error = np.maximum(error_of_mean, error_of_swing)
    error[0] = 0.0  # the run began at rest
    return error


def _answers_while_late(times: Float[np.ndarray, " n_samples"]) -> int:
    """Return how many answers count together: late ones must be fewer than half of them."""
    interval = float(np.median(np.diff(times)))
    return 2 * round(LATENESS / max(interval, SHORTEST_INTERVAL)) + 1


def _without_gaps(times: Float[np.ndarray, " n_samples"], values: JointSeries) -> JointSeries:
    """Return a series whose gaps are bridged linearly; zero where a module never answered."""
    return np.nan_to_num(interpolate_columns(times, times, values))


def _change_not_explained_by_rate(
    times: Float[np.ndarray, " n_samples"], angle: JointSeries, rate: JointSeries
) -> Float[np.ndarray, "n_joints n_steps"]:
    """Return what the rates before and after a change of angle do not explain of it [rad].

    A rate is that of a moment. How much of a step it explains depends on the load and on how often
    it is asked, and is therefore fitted over the whole run, for each joint.
    """
    interval = np.diff(times)[:, np.newaxis]
    is_connected = interval < LONGEST_GAP
    change = np.where(is_connected, np.diff(angle, axis=0), 0.0).T
    rate_after_and_before = np.stack((rate[1:], rate[:-1]))
    predictors = np.where(is_connected, interval * rate_after_and_before, 0.0).T
    shares = np.linalg.pinv(predictors) @ change[..., np.newaxis]
    return change - (predictors @ shares)[..., 0]
