"""Checks of what the cameras see: poses, their clock, and the markers beside the model."""

import math

import numpy as np

from laticauda.tank.operate.verdict.check import Measurement
from laticauda.tank.operate.verdict.recorded_run import RecordedRun
from laticauda.tank.operate.verdict.signals import (
    LONGEST_GAP,
    MEDIAN_LENGTH,
    jumps_of,
    running_median,
    swing_of,
)

LATENCY_CHANGE = 0.01
"""Change of the frames' smallest latency that is no drift of a clock [s]."""
SHORTEST_DRIFT = 1.0
"""Time over which a drift counts at least [s]."""
SMALLEST_SWING = math.radians(1.0)
"""Swing of the model's marker body to which a difference is related at least [rad]."""


def measure_pose_age(run: RecordedRun) -> Measurement | None:
    """Measure the age of the cameras' poses: its median over the run, and over its end.

    The end counts by itself, because it decides how far the robot got.
    """
    if not run.estimates:
        return None
    ages = [estimate.age for estimate in run.estimates]
    last_time = run.estimates[-1].time
    return Measurement(
        times=np.array([last_time, last_time]),
        values=np.array([np.median(ages), np.median(ages[-MEDIAN_LENGTH:])]),
    )


def measure_clock_drift(run: RecordedRun) -> Measurement | None:
    """Measure how far the cameras' clock goes away from ours between start and stop, per time."""
    readings = [event for event in run.events if "clock" in event.data]
    if len(readings) != 2:
        return None
    start, stop = readings
    offset_change = abs(stop.data["clock"] - start.data["clock"])
    duration = max(stop.time - start.time, SHORTEST_DRIFT)
    drift = max(offset_change - LATENCY_CHANGE, 0.0) / duration
    return Measurement(times=np.array([stop.time]), values=np.array([drift]))


def measure_marker_jump(run: RecordedRun) -> Measurement | None:
    """Measure jumps of the heading that markers and joints tell together, against the model's.

    The marker body may be mounted askew, but it must stay as it is.
    """
    model = run.comparable_model
    if model is None:
        return None
    times, link_yaw = _marker_yaw(run)
    bend = [estimate.heading - estimate.link_angle[run.marker_link] for estimate in run.estimates]
    heading = link_yaw + np.interp(times, run.estimate_times, bend)
    deviation = heading - np.interp(times, model.time, model.heading)
    is_outside_run = (times < run.begin) | (times > model.time[-1])
    deviation[is_outside_run] = np.nan
    jumps = jumps_of(times, deviation, longest=LONGEST_GAP)
    return Measurement(times=jumps.times, values=jumps.sizes)


def measure_swing_error(run: RecordedRun) -> Measurement | None:
    """Measure the difference of the marker body's swing from the model's, as a share, by cycle."""
    model = run.comparable_model
    if model is None:
        return None
    times, link_yaw = _marker_yaw(run)
    measured = run.cycles.resample_scalar(times, running_median(link_yaw))
    modelled = run.cycles.resample_scalar(model.time, model.marker_link_angle)
    difference = swing_of(measured - modelled)
    return Measurement(
        times=run.cycles.ends,
        values=difference / np.maximum(swing_of(modelled), SMALLEST_SWING),
    )


def _marker_yaw(run: RecordedRun) -> tuple[np.ndarray, np.ndarray]:
    """Return times of marker poses [s], and angles of the link that carries the markers [rad]."""
    times = np.array([pose.time for pose in run.marker_poses])
    yaw = [
        run.mount.link_yaw(pose.rotation) for pose in run.marker_poses if pose.rotation is not None
    ]
    return times, np.unwrap(yaw)
