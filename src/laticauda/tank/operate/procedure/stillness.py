"""Whether the robot has been still for long enough, from where it was seen in the last moments."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import NamedTuple

TIME_ROUNDING = 1e-9
"""A pose that is older by this still belongs to the time that is watched [s]."""
MISSING_SHARE = 0.1
"""Share of the time at the beginning of which nothing need be known [-]."""


class Pose(NamedTuple):
    """Where the robot is, in the plane of the path frame."""

    x: float
    """Position of the center of mass along the path's first direction [m]."""
    y: float
    """Position of the center of mass across it [m]."""
    heading: float
    """Heading [rad]."""


class TimedPose(NamedTuple):
    """Where the robot was at a time."""

    time: float
    """Time of the estimate [s]."""
    x: float
    """As of a `Pose` [m]."""
    y: float
    """As of a `Pose` [m]."""
    heading: float
    """As of a `Pose` [rad]."""


@dataclass(frozen=True, kw_only=True)
class StillnessRule:
    """What counts as still."""

    speed: float
    """Largest speed that counts as still [m/s]."""
    rate: float
    """Largest turning rate that counts as still [rad/s]."""
    duration: float
    """Time for which it has to be still [s]."""


class Watch(NamedTuple):
    """What is known after one more look."""

    poses: tuple[TimedPose, ...]
    """Poses within the time that counts."""
    is_still: bool
    """Whether it was still throughout."""


def watch_stillness(
    poses: Sequence[TimedPose], now: float, pose: Pose, rule: StillnessRule
) -> Watch:
    """Return whether something has been still for long enough, after one more look.

    Means over the two halves of the time are compared, so noise does not count as motion.

    Args:
        poses: Poses returned by the last call; () at the start.
        now: Current time [s].
        pose: Where it is now.
        rule: What counts as still.
    """
    begin = now - rule.duration
    recent = [earlier for earlier in poses if earlier.time > begin - TIME_ROUNDING]
    watched = (*recent, TimedPose(now, *pose))
    middle = now - 0.5 * rule.duration
    first_half = [timed for timed in watched if timed.time <= middle]
    second_half = [timed for timed in watched if timed.time > middle]
    is_whole = watched[0].time <= begin + MISSING_SHARE * rule.duration
    if not is_whole or not first_half or not second_half:
        return Watch(poses=watched, is_still=False)
    early = _mean(first_half)
    late = _mean(second_half)
    interval = late.time - early.time
    speed = math.hypot(late.x - early.x, late.y - early.y) / interval
    rate = abs((late.heading - early.heading) / interval)
    return Watch(poses=watched, is_still=speed <= rule.speed and rate <= rule.rate)


def mean_pose(poses: Sequence[TimedPose]) -> Pose:
    """Return the mean of some poses."""
    n_poses = len(poses)
    return Pose(
        x=sum(timed.x for timed in poses) / n_poses,
        y=sum(timed.y for timed in poses) / n_poses,
        heading=sum(timed.heading for timed in poses) / n_poses,
    )


def _mean(poses: Sequence[TimedPose]) -> TimedPose:
    return TimedPose(
        time=fmean(timed.time for timed in poses),
        x=fmean(timed.x for timed in poses),
        y=fmean(timed.y for timed in poses),
        heading=fmean(timed.heading for timed in poses),
    )
