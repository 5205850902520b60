"""How a run starts, and the settings of its model."""

import math
from collections.abc import Iterator

from laticauda.robot import Robot
from laticauda.scenarios.interfaces import Start
from laticauda.scenarios.plausibility.doubts import LENGTHS, SPEEDS, TIMES, Doubt, suggest_unit
from laticauda.scenarios.plausibility.waters import DEEPEST
from laticauda.scenarios.scenario import Model, Spatial

FULL_TURN = 2.0 * math.pi
"""[rad]"""
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
    if abs(start.heading) > FULL_TURN:
        hint = ""
        if abs(start.heading) <= 360.0:
            hint = f"; did you mean degrees: heading_deg={start.heading:g}?"
        rule = f"must be within a turn, 2 pi = 6.28 rad, got {start.heading:g}{hint}"
        yield Doubt(name="heading", rule=rule, refuses=True)
    speed = abs(start.velocity)
    lengths = speed / robot.length
    hint = suggest_unit(start.velocity, SPEEDS, lambda meant: abs(meant) <= robot.length)
    if lengths > FASTEST_START:
        limit = f"{FASTEST_START * robot.length:.3g} m/s, {FASTEST_START:g} body lengths per second"
        rule = f"must be within {limit}, got {start.velocity:g}{hint}"
        yield Doubt(name="velocity", rule=rule, refuses=True)
    elif lengths > FAST_START:
        rule = f"of {start.velocity:g} m/s is {lengths:.2g} body lengths per second{hint}"
        yield Doubt(name="velocity", rule=rule)
    farthest = max(map(abs, start.center_of_mass))
    if farthest > FARTHEST:
        hint = suggest_unit(farthest, LENGTHS, lambda meant: meant <= FARTHEST)
        rule = (
            f"of {farthest:g} m is far from the origin, where digits of the motion are lost{hint}"
        )
        yield Doubt(name="center_of_mass", rule=rule)
    if start.depth is not None and abs(start.depth) > DEEPEST:
        rule = f"must be within {DEEPEST:g} m, the deepest sea, got {start.depth:g}"
        yield Doubt(name="start.depth", rule=rule, refuses=True)


def judge_model(robot: Robot, model: Model) -> Iterator[Doubt]:
    """Yield what is odd about the settings of a model.

    Args:
        robot: The robot that the model is of.
        model: The model.
    """
    if model.loop_delay > LONGEST_DELAY:
        hint = suggest_unit(model.loop_delay, TIMES, lambda delay: delay <= LONGEST_DELAY)
        rule = f"of {model.loop_delay:g} s is longer than anything steers with{hint}"
        yield Doubt(name="loop_delay", rule=rule)
    if not isinstance(model, Spatial):
        return
    half_height = max(module.section.half_height for module in robot.modules)
    if abs(model.ballast_depth) > half_height:
        hint = suggest_unit(model.ballast_depth, LENGTHS, lambda depth: depth < half_height)
        rule = f"must lie inside the modules, within {half_height:g} m, got {model.ballast_depth:g}{hint}"
        yield Doubt(name="ballast_depth", rule=rule, refuses=True)
