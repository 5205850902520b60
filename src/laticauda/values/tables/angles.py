"""Angles of joints over time: their unit, whole turns between samples, and jumps that no joint makes."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.values.errors import BadArgument
from laticauda.values.tables.columns import Samples

LARGEST_BEND = math.pi
"""Angle of a joint [rad]; anything larger is in another unit."""
SMALLEST_SWING_DEG = 3.2
"""If no angle [deg] exceeds this, the angles can only be radians."""
SMALLEST_SWING = math.radians(SMALLEST_SWING_DEG)
"""The same [rad]."""
FASTEST_JOINT = 40.0
"""Rate of the fastest joints [rad/s]: small servos without load reach 20."""
SMALLEST_JUMP = 0.35
"""Change between two samples that counts as a jump, at least, however close the samples are [rad]."""
LARGEST_REST_OF_TURN = 0.15
"""What may be left of a jump by a whole turn, as a share of a turn: the joint moves meanwhile."""


class MendedAngles(NamedTuple):
    """Angles without whole turns, and what was done to them."""

    radians: Samples
    """The angles [rad]."""
    n_turns: int
    """Number of places where whole turns were taken out."""


def mend_turns(radians: Samples) -> MendedAngles:
    """Remove whole turns from the angles of a joint: those between samples, and those in all of them.

    Args:
        radians: Angles [rad]; nan where one is missing.
    """
    mended = radians.copy()
    is_measured = np.isfinite(radians)
    measured = radians[is_measured]
    turns = np.diff(measured) / math.tau
    whole_turns = np.round(turns)
    is_whole = np.abs(turns - whole_turns) < LARGEST_REST_OF_TURN
    whole_turns[~is_whole] = 0.0
    n_turns = int(np.count_nonzero(whole_turns))
    measured = measured - math.tau * np.concatenate(([0.0], np.cumsum(whole_turns)))
    if n_turns and measured.size:
        measured = measured - math.tau * np.round(np.mean(measured) / math.tau)
    mended[is_measured] = measured
    return MendedAngles(radians=mended, n_turns=n_turns)


def check_unit(
    name: str, radians: Float[np.ndarray, "..."], unit: str, *, are_moving: bool = True
) -> None:
    """Reject angles of joints that can only be in the other unit.

    Args:
        name: Name of the column, or of all columns together.
        radians: Angles of one or all joints [rad], as converted from that unit.
        unit: The unit, deg or rad.
        are_moving: Whether joints are known to move; those that hold still have small angles in
            any unit.

    Raises:
        ValueError: If they are; the message says which unit was probably meant.
    """
    largest = float(np.max(np.abs(radians), initial=0.0, where=np.isfinite(radians)))
    if unit == "deg":
        largest_deg = math.degrees(largest)
        if are_moving and 0.0 < largest_deg < SMALLEST_SWING_DEG:
            reason = f"only reaches {largest_deg:.3g}, too little for deg"
            raise BadArgument(name, f"{reason}; is it in rad?")
        if largest > LARGEST_BEND:
            rule = f"must be between -180 and 180 deg, got {largest_deg:.4g} deg"
            raise BadArgument(name, rule)
    elif largest > LARGEST_BEND:
        rule = f"must be between -pi and pi rad, got {largest:.4g} rad"
        raise BadArgument(name, f"{rule}; is its `unit` deg?")


def check_jumps(
    name: str, seconds: Samples, radians: Samples, row_numbers: Sequence[int] = ()
) -> None:
    """Reject angles that jump as no joint does.

    Args:
        name: Name of the column.
        seconds: Times of its rows [s], increasing.
        radians: Angles [rad]; nan where one is missing.
        row_numbers: Numbers of the rows in the file, for the message.

    Raises:
        ValueError: If they jump; the message says where.
    """
    samples = np.flatnonzero(np.isfinite(radians))
    changes = np.abs(np.diff(radians[samples]))
    limit = np.maximum(SMALLEST_JUMP, FASTEST_JOINT * np.diff(seconds[samples]))
    is_jump = changes > limit
    if not np.any(is_jump):
        return
    i = int(np.argmax(is_jump))
    after = int(samples[i + 1])
    begin, end = float(seconds[samples[i]]), float(seconds[after])
    rule = f"jumps by {math.degrees(changes[i]):.3g} deg from {begin:.6g} s to {end:.6g} s"
    if row_numbers:
        rule += f", in row {row_numbers[after]}"
    raise BadArgument(name, f"{rule}: no joint turns that fast")
