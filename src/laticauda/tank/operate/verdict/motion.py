"""Checks of the motion as a whole: do speed, sideslip and turning change unlike the model's?

All are compared from cycle to cycle, by mean positions and mean headings, which contain nothing of
the swing within a cycle.
"""

import math

import numpy as np
from jaxtyping import Float

from laticauda.tank.operate.verdict.check import Measurement
from laticauda.tank.operate.verdict.recorded_run import CycleMotion, RecordedRun
from laticauda.tank.operate.verdict.signals import range_so_far

SMALLEST_ADVANCE = 1e-3
"""Advance per cycle to which others are related at least, if a gait hardly moves [m]."""
SMALLEST_SPEED_SHARE = 0.2
"""Share of the model's usual speed to which a speed is related at least: the model starts from rest
[-]."""
SMALLEST_SPEED_RATIO = 1e-3
"""Stands for the speed ratio of a robot that moves backward or not at all [-]."""
CYCLES_PER_TURN = 5
"""Cycles over which turning is averaged."""
LEAST_STEERING = 0.9
"""Share of the model's turning by which a robot may turn when it bends, at least [-]."""
MOST_STEERING = 1.1
"""Share of the model's turning by which a robot may turn when it bends, at most [-]."""
SMALLEST_SQUARED_TURN = 1e-12
"""Sum of squared turns below which the model goes straight [rad^2]."""

Steps = Float[np.ndarray, " n_steps"]


def measure_speed_change(run: RecordedRun) -> Measurement | None:
    """Measure how far the speed, as a share of the model's, has changed."""
    model = run.model_motion
    if model is None:
        return None
    return Measurement(
        times=run.cycles.ends[1:], values=range_so_far(_speed_ratio(run.motion, model))
    )


def measure_sideslip_change(run: RecordedRun) -> Measurement | None:
    """Measure how far the sideslip beyond the model's has changed, as a share of its advance.

    The first step is left out: the robot starts from rest, and slips aside as it likes.
    """
    model = run.model_motion
    if model is None:
        return None
    sideslip = (run.motion.sideslip - model.sideslip)[1:] / _usual_advance(model)
    return Measurement(times=run.cycles.ends[2:], values=range_so_far(sideslip))


def measure_turn_change(run: RecordedRun) -> Measurement | None:
    """Measure how far the turning beyond the model's has changed.

    A robot that steers turns a little more or less than the model for the same bending, which is no
    change.
    """
    model = run.model_motion
    if model is None or run.motion.turn.size < CYCLES_PER_TURN:
        return None
    turn = run.motion.turn
    share_of_model = turn @ model.turn / max(model.turn @ model.turn, SMALLEST_SQUARED_TURN)
    steering = np.clip(share_of_model, LEAST_STEERING, MOST_STEERING)
    windows = np.lib.stride_tricks.sliding_window_view(
        turn - model.turn * steering, CYCLES_PER_TURN
    )
    return Measurement(
        times=run.cycles.ends[CYCLES_PER_TURN:], values=range_so_far(windows.mean(axis=1))
    )


def measure_model_speed(run: RecordedRun) -> Measurement | None:
    """Measure by what factor the robot is faster or slower than the model, as a logarithm."""
    model = run.model_motion
    if model is None:
        return None
    ratio = float(np.median(_speed_ratio(run.motion, model)))
    factor = abs(math.log(max(ratio, SMALLEST_SPEED_RATIO)))
    return Measurement(times=run.cycles.ends[-1:], values=np.array([factor]))


def _usual_advance(model: CycleMotion) -> float:
    """Return the model's usual advance per cycle; negative if it swims backward [m]."""
    advance = float(np.median(model.advance))
    return math.copysign(max(abs(advance), SMALLEST_ADVANCE), advance)


def _speed_ratio(robot: CycleMotion, model: CycleMotion) -> Steps:
    """Return the robot's speed divided by the model's, from cycle to cycle [-]."""
    usual_advance = _usual_advance(model)
    robot_speed = robot.advance / usual_advance
    model_speed = model.advance / usual_advance
    return robot_speed / np.maximum(model_speed, SMALLEST_SPEED_SHARE)
