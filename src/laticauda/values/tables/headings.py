"""Angles of a body over time: where they were lost, whole turns between samples, and jumps that no body makes."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from laticauda.values.errors import BadArgument
from laticauda.values.tables.columns import Samples
from laticauda.values.tables.positions import MOST_JUMPS, N_USUAL_STEPS, find_constant_pieces

FASTEST_LINK = 20.0
"""Rate at which a link of a swimming body turns, at most [rad/s]; heads of small robots reach 7."""
SMALLEST_JUMP = 0.35
"""Change between two samples that counts as a jump, at least, however close the samples are [rad]."""

SMALLEST_JUMP_TO_ZERO = 0.05
"""The same for jumps to exactly 0, or from it [rad]."""


class LostAngles(NamedTuple):
    """Where the angle of a body was lost."""

    is_lost: Bool[np.ndarray, " n_samples"]
    code: float | None
    """What the file says there, in its first such row [rad]; None if it was not lost."""


def find_lost_angles(name: str, time: Samples, angle: Samples) -> LostAngles:
    """Find the samples at which a file has a constant angle instead of one that was lost.

    Args:
        name: Name of the column, for the message.
        time: Times of the samples [s], increasing.
        angle: Angles [rad], which may go on from the other end of a turn; nan where one is missing.

    Raises:
        ValueError: If the angle jumps elsewhere.
    """
    is_lost = np.zeros(time.size, dtype=np.bool_)
    samples = np.flatnonzero(np.isfinite(angle))
    is_jump = _find_jumps(time[samples], angle[samples])
    if np.count_nonzero(is_jump) > MOST_JUMPS * is_jump.size:
        rule = f"turns faster than {FASTEST_LINK:g} rad/s most of the time"
        raise BadArgument(name, f"{rule}; is its unit deg, or that of its times another one?")
    code = None
    for piece in find_constant_pieces(angle[:, np.newaxis], samples, is_jump):
        is_lost[piece] = True
        if code is None:
            code = float(angle[piece[0]])
    _check_smooth(name, time, angle, samples[~is_lost[samples]])
    return LostAngles(is_lost=is_lost, code=code)


def count_turns(angle: Samples) -> int:
    """Return how often angles go on from the other end of a turn.

    Args:
        angle: Angles [rad]; nan where one is missing.
    """
    known = angle[np.isfinite(angle)]
    return int(np.count_nonzero(np.abs(np.diff(known)) > math.pi))


def _shortest_change(angle: Samples) -> Float[np.ndarray, " n_steps"]:
    """Return the change from each angle to the next, the shorter way round by at most one turn [rad]."""
    change = np.diff(angle)
    n_turns = np.clip(np.round(change / math.tau), -1.0, 1.0)
    return change - math.tau * n_turns


def _find_jumps(time: Samples, angle: Samples) -> Bool[np.ndarray, " n_steps"]:
    change = np.abs(_shortest_change(angle))
    is_jump = change > np.maximum(SMALLEST_JUMP, FASTEST_LINK * np.diff(time))
    # Zero itself stands for a lost angle so often that smaller jumps to it count.
    if change.size:
        least = max(SMALLEST_JUMP_TO_ZERO, N_USUAL_STEPS * float(np.median(change)))
        is_zero = (angle == 0.0).astype(int)
        is_jump |= (np.diff(is_zero) != 0) & (change > least)
    return is_jump


def _check_smooth(name: str, time: Samples, angle: Samples, samples: np.ndarray) -> None:
    """Reject an angle that still jumps at the samples at which it was seen."""
    is_jump = _find_jumps(time[samples], angle[samples])
    if not np.any(is_jump):
        return
    i = int(np.argmax(is_jump))
    change = math.degrees(_shortest_change(angle[samples])[i])
    begin, end = float(time[samples[i]]), float(time[samples[i + 1]])
    rule = f"jumps by {abs(change):.3g} deg from {begin:.6g} s to {end:.6g} s"
    raise BadArgument(name, f"{rule}: no body turns that fast; were its ends confused?")
