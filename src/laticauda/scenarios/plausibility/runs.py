"""How a run starts, and the settings of its model."""

import math
from collections.abc import Iterator

from laticauda.robot import Robot
from laticauda.scenarios.interfaces import Start
from laticauda.scenarios.plausibility.doubts import (
    LENGTHS,
    SPEEDS,
    TIMES,
    Doubt,
    hardly_is,
    must_be,
    suggest_unit,
)
from laticauda.scenarios.plausibility.waters import DEEPEST
from laticauda.scenarios.scenario import Model, Spatial

FULL_TURN = 2.0 * math.pi
"""Largest heading, to either side [rad]."""
MOST_DEGREES = 360.0
"""Headings above this are not even degrees."""
FAST_START = 2.0
"""Body lengths per second with which a robot hardly starts."""
FASTEST_START = 20.0
"""Body lengths per second with which none starts."""
FARTHEST = 1e4
"""A start is rather in other units than m, or in those of a map, beyond this [m]."""
LONGEST_DELAY = 2.0
"""Delays of a loop above this are rather in ms [s]."""


def judge_start(robot: Robot, start: Start) -> Iterator[Doubt]:
    """Yield what is odd about the start of a run.

    Args:
        robot: The robot that starts.
        start: Where and how it starts.
    """
    heading = start.heading
    if abs(heading) > FULL_TURN:
        hint = ""
        if abs(heading) <= MOST_DEGREES:
            hint = f"; did you mean degrees: heading_deg={heading:g}?"
        yield must_be("heading", "within a turn, 2 pi = 6.28 rad", heading, hint)
    if start.velocity:
        yield from _judge_velocity(robot.length, start.velocity)
    farthest = max(map(abs, start.center_of_mass))
    if farthest > FARTHEST:
        hint = suggest_unit(farthest, LENGTHS, (0.0, FARTHEST))
        yield hardly_is("center_of_mass", farthest, "m", "is far from the origin", hint)
    depth = start.depth
    if depth is not None and abs(depth) > DEEPEST:
        yield must_be("start.depth", f"within {DEEPEST:g} m, the deepest sea", depth)


def _judge_velocity(length: float, velocity: float) -> Iterator[Doubt]:
    """Relate the velocity of a start to the length of the robot."""
    lengths = abs(velocity) / length
    hint = suggest_unit(velocity, SPEEDS, (0.0, length))
    if lengths > FASTEST_START:
        fastest = FASTEST_START * length
        rule = f"within {fastest:.3g} m/s, {FASTEST_START:g} body lengths per second"
        yield must_be("velocity", rule, velocity, hint)
    elif lengths > FAST_START:
        remark = f"is {lengths:.2g} body lengths per second"
        yield hardly_is("velocity", velocity, "m/s", remark, hint)


def judge_model(robot: Robot, model: Model) -> Iterator[Doubt]:
    """Yield what is odd about the settings of a model.

    Args:
        robot: The robot that the model is of.
        model: The model.
    """
    delay = model.loop_delay
    if delay > LONGEST_DELAY:
        hint = suggest_unit(delay, TIMES, (0.0, LONGEST_DELAY))
        yield hardly_is("loop_delay", delay, "s", "is longer than anything steers with", hint)
    if not isinstance(model, Spatial):
        return
    half_height = max(module.section.half_height for module in robot.modules)
    depth = model.ballast_depth
    if abs(depth) > half_height:
        hint = suggest_unit(depth, LENGTHS, (0.0, half_height))
        rule = f"within {half_height:g} m, as it lies inside the modules"
        yield must_be("ballast_depth", rule, depth, hint)
