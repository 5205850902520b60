"""Gaits: how fast, how far and with which shift the joints swing."""

import math
from collections.abc import Iterator

from laticauda.motion.gaits import FASTEST, SMALLEST_AMPLITUDE, Gait, Wave
from laticauda.robot import Robot
from laticauda.scenarios.plausibility.doubts import Doubt

IMPOSSIBLE_FREQUENCY = 100.0
"""No robot swims with more cycles per second [Hz]."""
SLOWEST = 0.45
"""Angular frequencies below this hardly move a robot; many that are given are cycles per second [rad/s]."""
LARGEST_PHASE_SHIFT = 2.4
"""Phase shifts beyond this fold neighboring joints against each other [rad]."""
SMALLEST_PHASE_SHIFT = 0.05
"""Phase shifts below this let all joints swing together; many that are given in degrees are in rad [rad]."""
TIMES_NO_LOAD = 3.0
"""How many times the no-load speed of its servos a gait may demand before it is hardly meant."""
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
    if wave.amplitude < math.radians(SMALLEST_AMPLITUDE):
        degrees = math.degrees(wave.amplitude)
        bends = f"of {wave.amplitude:.3g} rad bends the joints by {degrees:.3g} of a degree"
        hint = f"did you mean {degrees:.3g} rad?"
        yield Doubt(name=f"{prefix}amplitude", rule=f"{bends}; {hint}")
    shift = wave.phase_shift
    name = f"{prefix}phase_shift"
    if abs(shift) > LARGEST_PHASE_SHIFT:
        rule = f"of {shift:.3g} rad is {math.degrees(shift):.0f} deg from joint to joint"
        hint = f"did you mean phase_shift_deg={shift:g}?"
        yield Doubt(name=name, rule=f"{rule}, hardly a wave; {hint}")
    elif 0.0 < abs(shift) < SMALLEST_PHASE_SHIFT:
        degrees = math.degrees(shift)
        rule = f"of {shift:.3g} rad is {degrees:.3g} deg: all joints swing together"
        yield Doubt(name=name, rule=f"{rule}; did you mean {degrees:.3g} rad?")


def _judge_frequency(name: str, frequency: float) -> Iterator[Doubt]:
    cycles = frequency / HZ
    if cycles > IMPOSSIBLE_FREQUENCY:
        rule = f"must be <= {IMPOSSIBLE_FREQUENCY * HZ:.0f} rad/s, {IMPOSSIBLE_FREQUENCY:g} cycles per second"
        hint = f"did you mean frequency_deg_s={frequency:g}?"
        yield Doubt(name=name, rule=f"{rule}, got {frequency:g}; {hint}", refuses=True)
    elif cycles > FASTEST:
        rule = f"of {frequency:.4g} rad/s is {cycles:.3g} cycles per second"
        yield Doubt(name=name, rule=f"{rule}; did you mean frequency_deg_s={frequency:.4g}?")
    elif 0.0 < frequency < SLOWEST:
        rule = f"of {frequency:.3g} rad/s is one cycle in {HZ / frequency:.3g} s"
        if frequency < math.radians(SLOWEST * 10.0):
            yield Doubt(
                name=name, rule=f"{rule}; did you mean {math.degrees(frequency):.3g} rad/s?"
            )
        else:
            yield Doubt(name=name, rule=f"{rule}; did you mean frequency_hz={frequency:.3g}?")


def judge_gait_of_robot(robot: Robot, gait: Gait) -> Iterator[Doubt]:
    """Yield a doubt if a gait demands many times the speed of a robot's servos.

    Args:
        robot: The robot.
        gait: The gait that it is to swim.
    """
    if gait.frequency > FASTEST * HZ:  # which is said already
        return
    speeds = [joint.actuator.no_load_speed for joint in robot.joints if joint.actuator.stated]
    rate = gait.amplitude * gait.frequency
    if not speeds or rate <= TIMES_NO_LOAD * min(speeds):
        return
    times = rate / min(speeds)
    rule = f"of {gait.frequency:.4g} rad/s lets joints turn at {rate:.3g} rad/s, {times:.2g} times the no-load speed"
    hint = f"did you mean frequency_deg_s={gait.frequency:.4g}?"
    yield Doubt(name="frequency", rule=f"{rule} of the servos; {hint}")
