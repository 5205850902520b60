"""What no body in a film does: signs of a wrong frame rate, or of pixels taken for metres."""

import numpy as np
from jaxtyping import Float

from laticauda.film.points import TrackedPoints

FASTEST = 100.0
"""Speed in body lengths per second above which the frame rate is wrong; fish burst at 25 [1/s]."""
LONGEST_BODY = 40.0
"""Length of a body at most: that of a blue whale and more [m]."""
SHORTEST_BODY = 1e-4
"""Length of a body at least; a rotifer is 0.1 to 0.5 mm long [m]."""
SLOWEST_FILM = 0.5
"""Frames per second of a film at least, below which times are in another unit [1/s]."""
LARGEST_JUMP = 0.5
"""Distance, by the length of the body, by which no body moves from one frame to the next [-]."""
SUDDEN = 8.0
"""The same distance by the usual one from frame to frame [-]."""
SMALLEST_PICTURE = 2.0
"""Positions that all lie within so many pixels are not in pixels [px]."""
N_FRAMES_OF_STEP = 4
"""Frames over which the speed is taken, so that noise of a pixel does not count as one."""


def check_plausible(points: TrackedPoints, body_length: float | None = None) -> None:
    """Refuse points that no body can be at.

    Args:
        points: The points.
        body_length: Length of the body if it is known; None: the extent of its points [px or m].

    Raises:
        ValueError: If the unit or the frame rate cannot be right; the message says which.
    """
    if not points.is_seen.any():
        raise ValueError("no point was seen in any frame.")
    if points.unit == "px":
        _check_pixels(points)
    length = body_length
    if length is None:
        length = measure_extent(points.position)
    if points.unit == "m" and length > 0.0:
        _check_metres(length)
    _check_rate(points)
    if length > 0.0:
        _check_speed(points, length)
        _check_jumps(points, length)


def measure_extent(position: Float[np.ndarray, "n_frames n_points 2"]) -> float:
    """Return the usual largest distance between two points of a frame; 0 if there is but one.

    Args:
        position: Positions; nan where one is lost.
    """
    is_seen = np.isfinite(position[..., 0])
    complete = position[is_seen.sum(axis=1) >= 2]
    if not len(complete):
        return 0.0
    low = np.nanmin(complete, axis=1)
    high = np.nanmax(complete, axis=1)
    return float(np.median(np.linalg.norm(high - low, axis=-1)))


def _check_pixels(points: TrackedPoints) -> None:
    spread = np.nanmax(points.position, axis=(0, 1)) - np.nanmin(points.position, axis=(0, 1))
    if points.n_points > 1 and spread.max() < SMALLEST_PICTURE:
        raise ValueError(
            f"its positions all lie within {spread.max():.2g} px; are they in m, or shares of the "
            "picture? Give the columns their unit, such as `nose.x [m]`, or px."
        )


def _check_metres(length: float) -> None:
    if length > LONGEST_BODY:
        raise ValueError(
            f"its body is {length:.3g} m long; are the positions in px or mm? State their unit."
        )
    if length < SHORTEST_BODY:
        raise ValueError(
            f"its body is {length:.2g} m long; are the positions in another unit? State it."
        )


def _check_speed(points: TrackedPoints, length: float) -> None:
    n_steps = min(N_FRAMES_OF_STEP, points.n_frames - 1)
    moved = np.linalg.norm(points.position[n_steps:] - points.position[:-n_steps], axis=-1)
    elapsed = (points.time[n_steps:] - points.time[:-n_steps])[:, np.newaxis]
    speed = moved / elapsed
    is_known = np.isfinite(speed)
    if not is_known.any():
        return
    usual = float(np.median(speed[is_known])) / length
    if usual > FASTEST:
        raise ValueError(
            f"its points move by {usual:.0f} body lengths per second; is the frame rate of "
            f"{points.frame_rate:.6g} frames per second right?"
        )


def _check_rate(points: TrackedPoints) -> None:
    if points.frame_rate < SLOWEST_FILM:
        raise ValueError(
            f"its frames are {1.0 / points.frame_rate:.3g} s apart, at least {SLOWEST_FILM:g} frames per second make a "
            "film; are its times in ms? State their unit, as in `time [ms]`, or the frame rate."
        )


def _check_jumps(points: TrackedPoints, length: float) -> None:
    """Refuse a track that goes on elsewhere from one frame to the next, as where two individuals were swapped.

    A tracker that errs for a frame comes back, which is no jump: places before and after are medians of
    three frames.
    """
    if points.n_frames < 2 * N_FRAMES_OF_STEP:
        return
    steps = _median_distance(points.position[1:], points.position[:-1])
    if not np.isfinite(steps).any():
        return
    usual = float(np.nanmedian(steps))
    least = max(LARGEST_JUMP * length, SUDDEN * usual)
    for frame in np.flatnonzero(steps > least):
        before = points.position[max(frame - 2, 0) : frame + 1]
        after = points.position[frame + 1 : frame + 4]
        n_pairs = min(len(before), len(after))
        left = _median_distance(after[:n_pairs], before[-n_pairs:])
        if n_pairs < 2 or float(np.nanmin(left)) < least:
            continue
        raise ValueError(
            f"its points jump by {steps[frame]:.3g} {points.unit}, {steps[frame] / length:.2g} body lengths, from "
            f"{points.time[frame]:.4g} to {points.time[frame + 1]:.4g} s, and stay there: has another individual taken "
            "over the track? Correct it in the tracker, or cut the film there."
        )


def _median_distance(
    first: Float[np.ndarray, "n n_points 2"], second: Float[np.ndarray, "n n_points 2"]
) -> Float[np.ndarray, " n"]:
    """Return the median over points of their distances in each frame; nan where none is in both."""
    distances = np.linalg.norm(first - second, axis=2)
    medians = np.full(len(distances), np.nan)
    for i, row in enumerate(distances):
        known_distances = row[np.isfinite(row)]
        if known_distances.size:
            medians[i] = np.median(known_distances)
    return medians
