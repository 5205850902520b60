"""Checks of what happened before the run: is the water still, and have all modules a zero?"""

import math

import numpy as np

from laticauda.control.estimation import Estimate
from laticauda.tank.operate.verdict.check import Measurement
from laticauda.tank.operate.verdict.recorded_run import RecordedRun
from laticauda.tank.operate.verdict.signals import LONGEST_GAP, running_median

STRAIGHT_DURATION = 2.0
"""Time before the run in which the robot lies straight, and drifts with the water [s]."""


def measure_water_speed(run: RecordedRun) -> Measurement | None:
    """Measure how fast the straight robot drifts before the run: moving water carries it."""
    estimates = _estimates_while_straight(run)
    if len(estimates) < 2 or estimates[-1].time - estimates[0].time <= 0.5 * STRAIGHT_DURATION:
        return None
    times = [estimate.time - run.begin for estimate in estimates]
    positions = running_median([estimate.center_of_mass[:2] for estimate in estimates])
    velocity = np.polyfit(times, positions, 1)[0]
    return Measurement(times=np.array([run.begin]), values=np.array([math.hypot(*velocity)]))


def measure_modules_without_zero(run: RecordedRun) -> Measurement | None:
    """Count the modules that have reported no zero since power-on, at the last calibration."""
    counts = [
        float(event.data.get("without_zero", 0))
        for event in run.events
        if event.kind == "calibrating"
    ]
    if not counts:
        return None
    return Measurement(times=np.array([run.begin]), values=np.array([counts[-1]]))


def _estimates_while_straight(run: RecordedRun) -> list[Estimate]:
    """Return fresh estimates before the run, after joint zeros were set: these move it."""
    since = run.begin - STRAIGHT_DURATION
    for event in run.events:
        if event.kind == "calibrating":
            since = max(since, event.time + LONGEST_GAP)
    return [
        estimate
        for estimate in run.log.of(Estimate)
        if since <= estimate.time <= run.begin and estimate.age < LONGEST_GAP
    ]
