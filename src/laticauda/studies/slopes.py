"""Slopes of a loss at two points, and what their difference says about its curvature."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float


class SlopeChange(NamedTuple):
    """How the slope of a loss changes from one point to another."""

    step: Float[np.ndarray, " n_names"]
    """From the one point to the other."""
    turn: Float[np.ndarray, " n_names"]
    """From the one slope to the other."""
    curvature: float
    """Curvature of the loss along the step, times the square of its length."""
    largest_curvature: float
    """What that would be if the slope turned along the step."""


class PointSlope(NamedTuple):
    """A point, and the slope of the loss there."""

    point: Float[np.ndarray, " n_names"]
    """The point."""
    slope: Float[np.ndarray, " n_names"]
    """Derivatives of the loss."""

    def change_to(self, later: "PointSlope") -> SlopeChange:
        """Return the change from here to another point.

        Args:
            later: The other point.
        """
        step = later.point - self.point
        turn = later.slope - self.slope
        return SlopeChange(
            step=step,
            turn=turn,
            curvature=float(step @ turn),
            largest_curvature=float(np.linalg.norm(step) * np.linalg.norm(turn)),
        )
