"""Positions of a marker over time: where it was lost, whatever a file writes then, and jumps that no body makes."""

from typing import NamedTuple, TypeAlias

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.values.tables.columns import Samples

Points: TypeAlias = Float[np.ndarray, "n_samples n_axes"]

FASTEST_PART = 5.0
"""Speed of any part of a swimming body in lengths of the body per second, at most [1/s]."""
SMALLEST_JUMP = 0.1
"""Change between two samples that counts as a jump, at least, in lengths of the body [-]."""
SMALLEST_JUMP_TO_ORIGIN = 0.02
"""The same for jumps to the origin of the file, or from it."""
N_USUAL_STEPS = 20
"""How many times the usual step such a jump is at least."""
MOST_JUMPS = 0.5
"""Share of the steps that are jumps because a marker was lost, or confused with another one, at most [-]."""


class LostSamples(NamedTuple):
    """Where a marker was lost."""

    is_lost: Bool[np.ndarray, " n_samples"]
    code: Float[np.ndarray, " n_axes"] | None
    """What the file says there, in its first such row; None if it was not lost."""

    @property
    def n_lost(self) -> int:
        """Number of samples."""
        return int(np.count_nonzero(self.is_lost))


def find_lost_samples(
    name: str, time: Samples, position: Points, *, body_length: float
) -> LostSamples:
    """Find the samples at which a file has a constant position instead of a marker that was lost.

    Motion capture writes 0, or any other constant, for a marker that no camera saw. Such samples
    lie beyond jumps that no body makes, on one or both sides, and all have the same position.

    Args:
        name: Name of the marker, for the message.
        time: Times of the samples [s], increasing.
        position: Positions [m]; nan where one is missing.
        body_length: Length of the robot [m].

    Raises:
        ValueError: If the marker jumps elsewhere.
    """
    is_lost = np.zeros(time.size, dtype=np.bool_)
    samples = np.flatnonzero(np.all(np.isfinite(position), axis=1))
    is_jump = _find_jumps(time[samples], position[samples], body_length)
    code = None
    if np.count_nonzero(is_jump) > MOST_JUMPS * is_jump.size:
        # The whole motion is too fast: a matter of units, which is said of the whole robot.
        return LostSamples(is_lost=is_lost, code=code)
    for piece in find_constant_pieces(position, samples, is_jump):
        is_lost[piece] = True
        if code is None:
            code = position[piece[0]]
    _check_smooth(name, time, position, samples[~is_lost[samples]], body_length)
    return LostSamples(is_lost=is_lost, code=code)


def find_constant_pieces(
    values: Points, samples: Int[np.ndarray, " n_known"], is_jump: Bool[np.ndarray, " n_steps"]
) -> list[Int[np.ndarray, " n_piece"]]:
    """Return the samples, piece by piece, at which something stands beyond a jump that never changes.

    Args:
        values: Numbers of every sample.
        samples: Samples that have numbers.
        is_jump: Whether there is a jump between each of them and the next.
    """
    pieces = np.split(samples, np.flatnonzero(is_jump) + 1)
    are_constant = [not np.any(np.ptp(values[piece], axis=0)) for piece in pieces if piece.size]
    if len(are_constant) < 2:
        return []
    sizes = [piece.size for piece in pieces]
    # The robot is where the marker moves; if it moves nowhere, where it is for the longest time.
    motion = max(range(len(pieces)), key=lambda i: (not are_constant[i], sizes[i]))
    return [piece for i, piece in enumerate(pieces) if i != motion and are_constant[i]]


def _find_jumps(
    time: Samples, position: Points, body_length: float
) -> Bool[np.ndarray, " n_steps"]:
    distances = np.linalg.norm(np.diff(position, axis=0), axis=1)
    reach = np.maximum(SMALLEST_JUMP, FASTEST_PART * np.diff(time))
    is_jump = distances > body_length * reach
    # The origin itself stands for a lost marker so often that smaller jumps to it count.
    is_origin = np.all(position == 0.0, axis=1)
    if distances.size:
        usual_distance = float(np.median(distances))
        least = max(SMALLEST_JUMP_TO_ORIGIN * body_length, N_USUAL_STEPS * usual_distance)
        is_jump |= (np.diff(is_origin.astype(int)) != 0) & (distances > least)
    return is_jump


def _check_smooth(
    name: str, time: Samples, position: Points, samples: np.ndarray, body_length: float
) -> None:
    """Reject a marker that still jumps at the samples at which it was seen."""
    is_jump = _find_jumps(time[samples], position[samples], body_length)
    if not np.any(is_jump):
        return
    i = int(np.argmax(is_jump))
    before, after = samples[i], samples[i + 1]
    distance = float(np.linalg.norm(position[after] - position[before]))
    begin, end = float(time[before]), float(time[after])
    raise ValueError(
        f"`{name}` jumps by {distance:.3g} m from {begin:.6g} s to {end:.6g} s, farther than a robot of "
        f"{body_length:.3g} m moves; were markers confused, or is its unit another one?"
    )
