"""Where the fit of all frames begins: a chain through the points of every frame, smoothed a little."""

import numpy as np
from jaxtyping import Bool, Complex, Float

from laticauda.film.chain.geometry import ChainGeometry, PointPlaces, link_begins

JUMP = 8.0
"""Jumps out of line by more than this many times the usual one are left out of the first guess [-]."""
NORMAL_MEDIAN = 1.4826
"""Standard deviation of a normal number per median of its size."""


def fill_gaps(
    time: Float[np.ndarray, " n_frames"],
    observed: Complex[np.ndarray, "n_frames n_points"],
    seen: Bool[np.ndarray, "n_frames n_points"],
) -> Complex[np.ndarray, "n_frames n_points"]:
    """Return places of all points in all frames: straight lines where one was lost or jumps away and back.

    Args:
        time: Times of the frames [s].
        observed: Where points were seen [m].
        seen: Where they were seen at all.
    """
    filled = np.empty_like(observed)
    for point in range(observed.shape[1]):
        frames = np.flatnonzero(seen[:, point])
        regular_frames = frames[~_jumps(observed[frames, point])]
        places = observed[regular_frames, point]
        filled[:, point] = np.interp(time, time[regular_frames], places)
    return filled


def _jumps(places: Complex[np.ndarray, " n"]) -> Bool[np.ndarray, " n"]:
    """Return which places lie far off the line between the one before and the one after."""
    off_line = np.zeros(len(places))
    if len(places) > 2:
        off_line[1:-1] = np.abs(places[1:-1] - 0.5 * (places[2:] + places[:-2]))
    usual = NORMAL_MEDIAN * float(np.median(off_line))
    jumps = off_line > JUMP * max(usual, 1e-12)
    # The neighbors of a jump are off the line through it by half.
    largest = np.maximum(np.append(off_line[1:], 0.0), np.append(0.0, off_line[:-1]))
    return jumps & (off_line >= largest)


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
    # Whole turns are counted for the body alone: an outlier must not leave a link a turn ahead for good.
    whole: np.ndarray = np.sum(along_links, axis=1)
    body_angle = np.unwrap(np.arctan2(np.imag(whole), np.real(whole))).reshape(-1, 1)
    from_body: np.ndarray = along_links * np.exp(-1j * body_angle)
    angles: np.ndarray = body_angle + np.arctan2(np.imag(from_body), np.real(from_body))
    of_centers: np.ndarray = filled - np.exp(1j * angles) @ geometry.lever.T
    center = np.mean(of_centers, axis=1)
    heading = np.mean(angles, axis=1)
    joint_angles: np.ndarray = angles[:, 1:] - angles[:, :-1]
    root = np.array([np.real(center), np.imag(center), heading]).T
    return np.column_stack((root, joint_angles))


def _interpolation(
    begin: Float[np.ndarray, " n_begin"], target: Float[np.ndarray, " n_target"]
) -> Float[np.ndarray, "n_target n_begin"]:
    """Return the matrix that takes values at known places to others, on straight lines, also beyond the ends."""
    order = np.argsort(begin, kind="stable")
    sorted_places = begin[order]
    matrix = np.zeros((target.size, begin.size))
    after = np.clip(np.searchsorted(sorted_places, target), 1, begin.size - 1)
    before = after - 1
    # Two points of one cross-section tell no direction: the next one further does.
    while np.any(short := sorted_places[after] - sorted_places[before] < 1e-9):
        stuck = short & (before == 0) & (after == begin.size - 1)
        if np.any(stuck):
            break
        before = np.where(short, np.maximum(before - 1, 0), before)
        after = np.where(short, np.minimum(after + 1, begin.size - 1), after)
    gap = np.maximum(sorted_places[after] - sorted_places[before], 1e-9)
    share = (target - sorted_places[before]) / gap
    row = np.arange(target.size)
    np.add.at(matrix, (row, order[before]), 1.0 - share)
    np.add.at(matrix, (row, order[after]), share)
    return matrix
