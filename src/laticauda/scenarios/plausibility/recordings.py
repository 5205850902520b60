"""Joint angles over time: whether they cover a run, and are fine enough to be a motion."""

import math
from collections.abc import Iterator

import numpy as np

from laticauda.motion.gaits import JointAngles
from laticauda.scenarios.plausibility.doubts import Doubt, must_be

FEWEST = 4
"""A recording with fewer of its times inside of a run is in another unit, or of another run."""
LATEST_BEGIN = 0.05
"""Share of a run after which a recording that has not begun belongs to another time."""
MOST_UNCOVERED = 0.5
"""Share of a run that a recording may leave out: joints that hold still after it let a robot glide."""
SHORTEST_IN_MS = 0.05
"""Share of a run that a recording covers at least if its times are in ms."""
GAP = 5.0
"""How many times the usual step is a gap."""
LONGEST_GAP = 0.2
"""A step that is longer than this share of a cycle cuts something off."""
COARSEST = 3.5
"""Samples per cycle below which a recording is not the motion."""
FEWEST_STEPS = 7
"""From fewer steps no cycle can be told."""
COARSEST_STEP = 0.75
"""Steps above this hardly show how a robot swims [s]."""
STILLEST = 1e-3
"""Joints that move less than this do not move [rad]."""
UNIX_TIME = 1e8
"""Times above this are those of clocks [s]."""


def judge_angles(angles: JointAngles) -> Iterator[Doubt]:
    """Yield what is odd about joint angles, whatever run they are for.

    Args:
        angles: Joint angles over time.
    """
    values = np.array(angles.angle)
    largest = np.max(np.abs(values), initial=0.0)
    if largest > math.pi:
        hint = "; did you mean degrees (angle_deg)?"
        yield must_be("recorded.angle", "within pi, 3.14 rad", float(largest), hint)
        return
    swings = np.ptp(values, axis=1)
    if swings.max(initial=0.0) < STILLEST:
        rule = "does not move: all joints hold their angles; is it sampled once a cycle?"
        yield Doubt(name="recorded", rule=rule)
        return
    yield from _judge_steps(angles)


def _judge_steps(angles: JointAngles) -> Iterator[Doubt]:
    """Look for gaps, and for steps that are too long for the motion."""
    steps = np.diff(angles.time)
    usual = float(np.median(steps))
    longest = float(steps.max())
    cycle = math.inf
    if angles.frequency > 0.0:
        cycle = 2.0 * math.pi / angles.frequency
    if longest > max(GAP * usual, LONGEST_GAP * cycle):
        begin = angles.time[int(steps.argmax())]
        rule = f"has a gap of {longest:.3g} s at {begin:.4g} s, in which the angles are guessed"
        yield Doubt(name="recorded.time", rule=rule)
    is_aliased = usual * COARSEST > cycle and steps.size >= FEWEST_STEPS
    if usual > COARSEST_STEP or is_aliased:
        rule = f"has a sample every {usual:.3g} s, too few to show how the joints move"
        yield Doubt(name="recorded.time", rule=rule)


def judge_times(angles: JointAngles, duration: float) -> Iterator[Doubt]:
    """Yield a doubt if joint angles do not cover a run.

    Args:
        angles: Joint angles over time.
        duration: Duration of the run [s].
    """
    time = np.array(angles.time)
    first, last = angles.time[0], angles.time[-1]
    n_inside = int(np.count_nonzero((time >= 0.0) & (time <= duration)))
    if n_inside < min(FEWEST, time.size):
        range_of_times = f"{n_inside} of {time.size} times do, from {first:.10g} to {last:.10g} s"
        rule = f"must lie in the run, from 0 to {duration:g} s: {range_of_times}"
        hint = _suggest_clock(first, last, duration)
        yield Doubt(name="recorded.time", rule=f"{rule}{hint}", refuses=True)
        return
    before, after = max(first, 0.0), max(duration - last, 0.0)
    step = (last - first) / (time.size - 1)
    begins_late = before > LATEST_BEGIN * duration + step
    if begins_late or before + after > MOST_UNCOVERED * duration:
        rule = f"covers {first:.4g} to {last:.4g} s of a run of {duration:g} s"
        hint = ": before and after, the joints hold still"
        yield Doubt(name="recorded.time", rule=f"{rule}{hint}")


def _suggest_clock(first: float, last: float, duration: float) -> str:
    """Return the end of a rule for times that are not those of a run."""
    if first > UNIX_TIME:
        return "; did you mean times since its start, not those of a clock?"
    begin, end = 1e-3 * first, 1e-3 * last
    if end - begin < SHORTEST_IN_MS * duration:
        return ""
    return f"; did you mean {begin:.4g} to {end:.4g} ({last:.6g} ms)?"
