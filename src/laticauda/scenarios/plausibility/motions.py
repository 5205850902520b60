"""Gaits: how fast, how far and with which shift the joints swing."""

import math
from collections.abc import Iterator

from laticauda.motion.gaits import FASTEST, SMALLEST_AMPLITUDE, Gait, Wave
from laticauda.robot import Robot
from laticauda.scenarios.plausibility.doubts import Doubt, hardly_is, must_be

IMPOSSIBLE_FREQUENCY = 100.0
"""No robot swims with more cycles per second [Hz]."""
SLOWEST = 0.45
"""Angular frequencies below this hardly move a robot; many that are given are cycles per second [rad/s]."""
SLOWEST_IN_HZ = 0.08
"""Angular frequencies below this are rather in deg/s than in Hz [rad/s]."""
ROUNDING = 1e-9
"""How far a number that was converted is from the one that was given, relatively."""
LARGEST_PHASE_SHIFT = 2.4
"""Phase shifts beyond this fold neighboring joints against each other [rad]."""
SMALLEST_PHASE_SHIFT = 0.05
"""Phase shifts below this let all joints swing together; many that are given in degrees are in rad [rad]."""
TIMES_NO_LOAD = 3.0
"""How many times the no-load speed of its servos a gait may demand before it is hardly meant."""
SLOWEST_DOUBTED_RATE = 3.0
"""Rates of joints below this are never doubted [rad/s]."""
HZ = 2.0 * math.pi
"""One cycle per second [rad/s]."""


def judge_gait(gait: Gait) -> Iterator[Doubt]:
    """Yield what is odd about a gait, whatever robot swims it.

    Args:
        gait: The gait.
    """
    if gait.recorded is None:
        yield from _judge_wave("", gait)
    for name in ("pitch", "fin"):
        wave = getattr(gait, name)
        if wave is not None:
            yield from _judge_wave(f"{name}.", wave)


def _judge_wave(prefix: str, wave: Gait | Wave) -> Iterator[Doubt]:
    if wave.amplitude == 0.0:
        return
    yield from _judge_frequency(f"{prefix}frequency", wave.frequency)
    degrees = math.degrees(wave.amplitude)
    if degrees < SMALLEST_AMPLITUDE:
        remark = f"bends the joints by {degrees:.3g} of a degree; did you mean {degrees:.3g} rad?"
        yield hardly_is(f"{prefix}amplitude", wave.amplitude, "rad", remark)
    yield from _judge_phase_shift(f"{prefix}phase_shift", wave.phase_shift)


def _judge_phase_shift(name: str, shift: float) -> Iterator[Doubt]:
    degrees = math.degrees(shift)
    if abs(shift) > LARGEST_PHASE_SHIFT:
        remark = f"is {degrees:.0f} deg from joint to joint, hardly a wave"
        hint = f"; did you mean phase_shift_deg={shift:g}?"
        yield hardly_is(name, shift, "rad", remark, hint)
    elif 0.0 < abs(shift) < SMALLEST_PHASE_SHIFT:
        remark = f"is {degrees:.3g} deg: all joints swing together"
        yield hardly_is(name, shift, "rad", remark, f"; did you mean {degrees:.3g} rad?")


def _judge_frequency(name: str, frequency: float) -> Iterator[Doubt]:
    cycles = frequency / HZ
    in_degrees = _suggest_degrees(frequency)
    if cycles > IMPOSSIBLE_FREQUENCY:
        yield must_be(name, "<= 628 rad/s, 100 cycles per second", frequency, in_degrees)
    elif cycles > FASTEST:
        remark = f"is {cycles:.3g} cycles per second"
        yield hardly_is(name, frequency, "rad/s", remark, in_degrees)
    elif 0.0 < frequency < SLOWEST and not _was_converted(frequency):
        hint = f"; did you mean frequency_hz={frequency:.3g}?"
        if frequency < SLOWEST_IN_HZ:
            hint = f"; did you mean {math.degrees(frequency):.3g} rad/s?"
        yield hardly_is(name, frequency, "rad/s", f"is one cycle in {1.0 / cycles:.3g} s", hint)


def _suggest_degrees(frequency: float) -> str:
    """Return the end of a rule for a fast frequency: the number that was given, as one in deg/s."""
    cycles = frequency / HZ
    typed_frequency = frequency
    if _is_whole(cycles):  # it was given in Hz
        typed_frequency = cycles
    elif _is_whole(math.degrees(frequency)):  # it was given in deg/s
        return ""
    return f"; did you mean frequency_deg_s={typed_frequency:.4g}?"


def _is_whole(frequency: float) -> bool:
    return math.isclose(frequency, round(frequency), rel_tol=ROUNDING)


def _was_converted(frequency: float) -> bool:
    """Return whether a slow frequency is a whole number of deg/s: it was given so, and not in Hz."""
    return frequency >= SLOWEST_IN_HZ and _is_whole(math.degrees(frequency))


def judge_gait_of_robot(robot: Robot, gait: Gait) -> Iterator[Doubt]:
    """Yield a doubt if a gait demands many times the speed of a robot's servos.

    Args:
        robot: The robot.
        gait: The gait that it is to swim.
    """
    frequency = gait.frequency
    rate = gait.amplitude * frequency
    if rate < SLOWEST_DOUBTED_RATE or frequency > FASTEST * HZ:  # the latter is said already
        return
    speeds = [joint.actuator.no_load_speed for joint in robot.joints if joint.actuator.stated]
    slowest = min(speeds, default=math.inf)
    if rate > TIMES_NO_LOAD * slowest:
        ratio = rate / slowest
        remark = f"lets joints turn at {rate:.3g} rad/s, {ratio:.2g} times the no-load speed of the servos"
        hint = _suggest_degrees(frequency)
        yield hardly_is("frequency", frequency, "rad/s", remark, hint)
