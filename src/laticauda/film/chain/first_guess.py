"""Where the fit of all frames begins: a chain through the points of every frame, smoothed a little."""

import numpy as np
from jaxtyping import Bool, Complex, Float, Int

from laticauda.film.chain.geometry import ChainGeometry, PointPlaces, link_begins

JUMP = 8.0
"""Jumps out of line by more than this many times the usual one are left out of the first guess [-]."""
SMALLEST_GAP = 1e-9
"""Distance along the body up to which two points sit on one cross-section [m]."""
NORMAL_MEDIAN = 1.4826
"""Standard deviation of a normal number per median of its size."""


def fill_gaps(
    time: Float[np.ndarray, " n_frames"],
    observed: Complex[np.ndarray, "n_frames n_points"],
    is_seen: Bool[np.ndarray, "n_frames n_points"],
) -> Complex[np.ndarray, "n_frames n_points"]:
    """Return places of all points in all frames: straight lines where one was lost or jumps away and back.

    Args:
        time: Times of the frames [s].
        observed: Where points were seen [m].
        is_seen: Where they were seen at all.
    """
    filled = np.empty_like(observed)
    for point in range(observed.shape[1]):
        frames = np.flatnonzero(is_seen[:, point])
        is_jump = _find_jumps(observed[frames, point])
        regular_frames = frames[~is_jump]
        places = observed[regular_frames, point]
        filled[:, point] = np.interp(time, time[regular_frames], places)
    return filled


def _find_jumps(places: Complex[np.ndarray, " n"]) -> Bool[np.ndarray, " n"]:
    """Return which places lie far off the line between the one before and the one after."""
    distance = _distance_off_line(places)
    usual_distance = NORMAL_MEDIAN * float(np.median(distance))
    is_far = distance > JUMP * max(usual_distance, 1e-12)
    # The neighbors of a jump are off the line through it by half: only the farthest of them is the jump.
    distance_after = np.append(distance[1:], 0.0)
    distance_before = np.append(0.0, distance[:-1])
    return is_far & (distance >= np.maximum(distance_after, distance_before))


def _distance_off_line(places: Complex[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
    """Return the distance of every place from the middle of its neighbors; 0 at the ends [m]."""
    distance = np.zeros(len(places))
    if len(places) > 2:
        middle = 0.5 * (places[2:] + places[:-2])
        distance[1:-1] = np.abs(places[1:-1] - middle)
    return distance


def guess_coordinates(
    geometry: ChainGeometry, places: PointPlaces, filled: Complex[np.ndarray, "n_frames n_points"]
) -> Float[np.ndarray, "n_frames n_coordinates"]:
    """Return coordinates of the chain in every frame, from a line through its points.

    Args:
        geometry: The chain with its points.
        places: Where the points sit.
        filled: Where they were seen, without gaps [m].
    """
    robot = geometry.robot
    ends = np.append(link_begins(robot), robot.length)
    line: np.ndarray = filled @ _interpolation(places.along, ends).T
    along_links: np.ndarray = line[:, 1:] - line[:, :-1]
    angles = _link_angles(along_links)
    centers_by_point: np.ndarray = filled - np.exp(1j * angles) @ geometry.lever.T
    center = np.mean(centers_by_point, axis=1)
    heading = np.mean(angles, axis=1)
    root = np.array([np.real(center), np.imag(center), heading]).T
    joint_angles: np.ndarray = angles[:, 1:] - angles[:, :-1]
    return np.column_stack((root, joint_angles))


def _link_angles(
    along_links: Complex[np.ndarray, "n_frames n_links"],
) -> Float[np.ndarray, "n_frames n_links"]:
    """Return the angles of links from their directions; none jumps from frame to frame [rad].

    Whole turns are counted for the body alone: an outlier must not leave a link a turn ahead for good.
    """
    body = np.sum(along_links, axis=1)
    body_angle = np.unwrap(_angle_of(body)).reshape(-1, 1)
    from_body = along_links * np.exp(-1j * body_angle)
    return body_angle + _angle_of(from_body)


def _angle_of(numbers: Complex[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
    return np.arctan2(np.imag(numbers), np.real(numbers))


def _interpolation(
    begin: Float[np.ndarray, " n_begin"], target: Float[np.ndarray, " n_target"]
) -> Float[np.ndarray, "n_target n_begin"]:
    """Return the matrix that takes values at known places to others, on straight lines, also beyond the ends."""
    order = np.argsort(begin, kind="stable")
    sorted_places = begin[order]
    before, after = _neighbors(sorted_places, target)
    gap = np.maximum(sorted_places[after] - sorted_places[before], SMALLEST_GAP)
    share = (target - sorted_places[before]) / gap
    matrix = np.zeros((target.size, begin.size))
    row = np.arange(target.size)
    np.add.at(matrix, (row, order[before]), 1.0 - share)
    np.add.at(matrix, (row, order[after]), share)
    return matrix


def _neighbors(
    places: Float[np.ndarray, " n_begin"], target: Float[np.ndarray, " n_target"]
) -> tuple[Int[np.ndarray, " n_target"], Int[np.ndarray, " n_target"]]:
    """Return the known places before and after every target, as indices of sorted ones with a gap between."""
    last = places.size - 1
    after = np.clip(np.searchsorted(places, target), 1, last)
    before = after - 1
    # Two points of one cross-section tell no direction: the next one further does.
    while True:
        is_short = places[after] - places[before] < SMALLEST_GAP
        is_stuck = is_short & (before == 0) & (after == last)
        if not np.any(is_short) or np.any(is_stuck):
            return before, after
        before = np.where(is_short, np.maximum(before - 1, 0), before)
        after = np.where(is_short, np.minimum(after + 1, last), after)
