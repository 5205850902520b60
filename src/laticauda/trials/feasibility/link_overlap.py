"""Links that overlap: neighbors that fold over each other, and links further apart that cross.

Links are rectangles with their length and width. Neighbors fold over each other when the inner
edges of their bend meet beyond the middle of one of them; links further apart overlap when their
rectangles do, which is checked in the plane of the yaw joints as long as no other joint bends.
"""

import math
from typing import NamedTuple, TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda.robot import Robot

MOST_ELEMENTS = 1 << 20
"""Samples times pairs of links that are processed at once: 100 MB."""
SHARPEST_BEND = math.pi - 1e-6
"""A bend that stands for all sharper ones, whose inner edges would never meet [rad]."""

Postures: TypeAlias = Float[np.ndarray, "n_samples n_joints"]
Pairs: TypeAlias = Float[np.ndarray, "n_samples n_pairs"]


class Overlap(NamedTuple):
    """How close two links come to overlapping."""

    share: float
    """Share of their room that is used up; above 1 they overlap [-]."""
    first_link: int
    """The link nearer to the tail."""
    second_link: int
    """The link nearer to the head."""


NO_OVERLAP = Overlap(0.0, 0, 0)


def measure_overlap(robot: Robot, angle: Postures) -> Overlap:
    """Return the two links that come closest to overlapping.

    Args:
        robot: The robot whose links are bent.
        angle: phi of the joints between the links, tail first [rad].
    """
    largest_bend = np.abs(angle).max(axis=0, initial=0.0)
    return max(measure_neighbor_overlap(robot, largest_bend), measure_crossing(robot, angle))


def measure_neighbor_overlap(robot: Robot, largest_bend: Float[np.ndarray, " n_joints"]) -> Overlap:
    """Return the neighboring links that come closest to folding over each other.

    Args:
        robot: The robot whose links are bent.
        largest_bend: Largest |phi| of every joint [rad].
    """
    closest = NO_OVERLAP
    for i, bend in enumerate(largest_bend.tolist()):
        closest = max(closest, Overlap(measure_fold(robot, i, bend), i, i + 1))
    return closest


def measure_fold(robot: Robot, joint: int, bend: float) -> float:
    """Return how much of the room between the two links at a joint is used up; above 1 they overlap [-].

    Args:
        robot: The robot.
        joint: Index of the joint.
        bend: Largest |phi| [rad].
    """
    half_size, half_length = measure_room_of_neighbors(robot, joint)
    inner_edge = half_size * math.tan(0.5 * min(bend, SHARPEST_BEND))
    return inner_edge / half_length


def measure_room_of_neighbors(robot: Robot, joint: int) -> tuple[float, float]:
    """Return half the width of the two links at a joint, and half the length of the shorter one [m].

    Args:
        robot: The robot.
        joint: Index of the joint; the width is that in the plane in which it bends.
    """
    neighbors = robot.modules[joint : joint + 2]
    if robot.joints[joint].axis == "yaw":
        half_size = max(module.section.half_width for module in neighbors)
    else:
        half_size = max(module.section.half_height for module in neighbors)
    return half_size, 0.5 * min(module.length for module in neighbors)


def find_smallest_crossing_curl(robot: Robot) -> float:
    """Return the difference in direction below which no link can cross another [rad].

    Up to it, all links advance along the body, and none passes the next.
    """
    inner_length = min((module.length for module in robot.modules[1:-1]), default=math.inf)
    half_width = max(module.section.half_width for module in robot.modules)
    return 2.0 * math.atan(0.5 * inner_length / half_width)


def measure_crossing(robot: Robot, angle: Postures) -> Overlap:
    """Return the links that are no neighbors and come closest to crossing, as rectangles.

    Args:
        robot: The robot whose links are bent.
        angle: phi of the joints between the links, tail first [rad].
    """
    is_not_yaw = [joint.axis != "yaw" for joint in robot.joints]
    if not angle.size or robot.n_links < 3 or np.any(angle[:, is_not_yaw]):
        return NO_OVERLAP
    if len(angle) > 1 and angle.size * robot.n_links > MOST_ELEMENTS:
        halves = [measure_crossing(robot, half) for half in np.array_split(angle, 2)]
        return max(halves, key=lambda closest: closest.share)
    length = np.array([module.length for module in robot.modules])
    half_width = np.array([module.section.half_width for module in robot.modules])
    direction = np.cumsum(np.column_stack((np.zeros(len(angle)), angle)), axis=1)
    first, second = np.triu_indices(length.size, 2)
    gap = _gap_of_rectangles(length, half_width, direction, first, second)
    share = (1.0 - gap / (half_width[first] + half_width[second])).max(axis=0)
    closest = int(np.argmax(share))
    return Overlap(float(share[closest]), int(first[closest]), int(second[closest]))


def _gap_of_rectangles(
    length: Float[np.ndarray, " n_links"],
    half_width: Float[np.ndarray, " n_links"],
    direction: Float[np.ndarray, "n_samples n_links"],
    first: np.ndarray,
    second: np.ndarray,
) -> Pairs:
    """Return the gap between pairs of links, negative where they overlap [m].

    Two rectangles are apart if they are so along an axis of one of them. An extent is half of what
    a rectangle covers on an axis.

    Args:
        length: Lengths of the links [m].
        half_width: Half of their widths [m].
        direction: Their directions in every posture [rad].
        first: Index of the one link of every pair.
        second: Index of the other.
    """
    axis = np.stack((np.cos(direction), np.sin(direction)))
    center = np.cumsum(length * axis, axis=2) - 0.5 * length * axis
    offset_x, offset_y = center[:, :, second] - center[:, :, first]
    angle_between = direction[:, second] - direction[:, first]
    cos = np.abs(np.cos(angle_between))
    sin = np.abs(np.sin(angle_between))
    gaps: list[Pairs] = []
    for own, facing in ((first, second), (second, first)):
        axis_x, axis_y = axis[:, :, own]
        distance_along = np.abs(offset_x * axis_x + offset_y * axis_y)
        distance_across = np.abs(offset_y * axis_x - offset_x * axis_y)
        extent_along = 0.5 * (length[own] + length[facing] * cos)
        gaps.append(distance_along - extent_along - half_width[facing] * sin)
        extent_across = 0.5 * length[facing] * sin
        gaps.append(distance_across - extent_across - half_width[own] - half_width[facing] * cos)
    return np.max(gaps, axis=0)
