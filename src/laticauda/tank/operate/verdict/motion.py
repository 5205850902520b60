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
LONGEST_DELAY = 0.1
"""Time by which a robot may turn later or sooner than the model [s]."""

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

    A robot that steers turns a little more or less than the model for the same bending, and a
    little later or sooner, which is no change.
    """
    model = run.model_motion
    if model is None or run.motion.turn.size < CYCLES_PER_TURN:
        return None
    turn = run.motion.turn
    unexplained = turn - _explain_turn(turn, model.turn, run.cycles.period)
    windows = np.lib.stride_tricks.sliding_window_view(unexplained, CYCLES_PER_TURN)
    return Measurement(
        times=run.cycles.ends[CYCLES_PER_TURN:], values=range_so_far(windows.mean(axis=1))
    )


def _explain_turn(turn: Steps, model_turn: Steps, period: float) -> Steps:
    """Return what the model's turn explains of the robot's: a share of it, delayed a little."""
    turn_per_delay = -np.gradient(model_turn) / period
    predictors = np.stack((model_turn, turn_per_delay), axis=1)
    share, delay = np.linalg.lstsq(predictors, turn)[0]
    steering = np.clip(share, LEAST_STEERING, MOST_STEERING)
    return model_turn * steering + turn_per_delay * np.clip(delay, -LONGEST_DELAY, LONGEST_DELAY)


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
    """Return the robot's speed divided by the model's, from cycle to cycle [-].

    Where both are slow, as at the start or at rest, their difference is related to a share of the
    usual speed: two robots that glide alike have a ratio of one.
    """
    usual_advance = _usual_advance(model)
    robot_speed = robot.advance / usual_advance
    model_speed = model.advance / usual_advance
    return 1.0 + (robot_speed - model_speed) / np.maximum(model_speed, SMALLEST_SPEED_SHARE)
