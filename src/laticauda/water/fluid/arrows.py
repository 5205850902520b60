"""Arrows that show how water moves: where they are, and how long.

Figures, films and the live page all use this module, so that the same water looks the same in each.
The surface of the water is drawn by `laticauda.water.fluid.surface`.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from laticauda.water.fluid.flow import Flow
from laticauda.water.fluid.surface import grid_points, surface_elevation

ARROWS_PER_SIDE = 10.0
"""Smallest number of arrows along the longer side of the region shown."""
SAMPLES_PER_SIDE = 20
"""Samples of the speed along x and along y, to find the fastest water."""
FASTEST_PERCENTILE = 92.0
"""Percentile of the speed that sets the scale: the core of a vortex would make all other arrows short."""
REACH_IN_LENGTHS = 1.2
"""Largest distance of arrows from a robot, in robot lengths."""
LONGEST_IN_SPACINGS = 1.2
"""Largest length of an arrow, in spacings of the arrows."""
SLOWEST = 1e-6
"""Smallest speed that is shown [m/s]."""
ROUND_STEPS = (1.0, 2.0, 3.0, 5.0)
"""First digits of round numbers."""

Velocity = Callable[[np.ndarray, float], np.ndarray]


@dataclass(frozen=True, kw_only=True)
class Arrows:
    """Arrows of moving water, each fixed in the world at its center and turning with the water's velocity."""

    velocity: Velocity
    """Velocity of the water, in the plane or in space; takes points, shape (n, 2) or (n, 3) [m], and the time [s]."""
    spacing: float
    """Spacing of the arrows along x and y [m]."""
    time: float
    """Time scale: an arrow is as long as the distance that the water there travels in this time [s]."""
    reach: float = math.inf
    """Largest distance of arrows from a robot [m]."""
    axes: int = 2
    """Number of coordinates of the points that `velocity` takes."""
    flow: Flow | None = None
    """Flow that moves the surface, above which there are no arrows."""

    @property
    def words(self) -> str:
        """Description of the scale."""
        return f"arrows: displacement of the water in {self.time:g} s"

    @property
    def key(self) -> float:
        """A round speed whose arrow is almost one spacing long [m/s]."""
        return round_down(self.spacing / self.time)

    def places(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Return the positions of the arrows between two corners, shape (n, 2) [m]."""
        first: Any = np.ceil(low / self.spacing)
        last: Any = np.floor(high / self.spacing)
        return self.spacing * grid_points(
            np.arange(first[0], last[0] + 1.0), np.arange(first[1], last[1] + 1.0)
        )

    def around(self, middle: np.ndarray, t: float) -> np.ndarray:
        """Return the arrows around a robot, at its height.

        Args:
            middle: Displayed position of the robot, in space [m].
            t: Time since the start of the run [s].

        Returns:
            Tail and tip of each arrow, shape (n, 2, 3) [m].
        """
        places = self.places(middle[:2] - self.reach, middle[:2] + self.reach)
        distances = np.hypot(*(places - middle[:2]).T)
        is_wet = self.axes == 2 or middle[2] <= surface_elevation(self.flow, places, t)
        places = places[is_wet & (distances <= self.reach)]

        height = np.full((len(places), 1), middle[2])
        points = np.column_stack((places, height))
        ends = self.at(points[:, : self.axes], t)
        heights_of_ends = np.stack((height, height), axis=1)
        return np.dstack((ends, heights_of_ends))[..., :3]

    def at(self, points: np.ndarray, t: float) -> np.ndarray:
        """Return tail and tip of the arrows at given points and time, shape (n, 2, n_axes) [m]."""
        half = 0.5 * self.time * self.velocity(points, t)
        length = 2.0 * np.linalg.norm(half, axis=-1, keepdims=True)
        longest = LONGEST_IN_SPACINGS * self.spacing
        half = half * np.minimum(1.0, longest / np.maximum(length, 1e-12))
        return np.stack((points - half, points + half), axis=1)


def arrows_of(
    velocity: Velocity,
    low: np.ndarray,
    high: np.ndarray,
    times: Sequence[float],
    length: float | None = None,
    flow: Flow | None = None,
) -> Arrows | None:
    """Return arrows that suit the region shown; None if the water is still.

    Args:
        velocity: Velocity of the water at points, shape (n, n_axes) [m], and a time [s]; same shape
            [m/s].
        low: Lower corner of the region, in the plane or in space [m].
        high: Upper corner [m].
        times: Sample of the times shown [s].
        length: Length of a robot whose path the region is; arrows are around it; None: throughout
            the region [m].
        flow: Flow that moves the surface.
    """
    if length is None:
        reach = math.inf
        margin = 0.0
        longer_side = float(np.max((high - low)[:2]))
    else:
        reach = REACH_IN_LENGTHS * length
        margin = reach
        longer_side = 2.0 * reach

    points = _sample_points(low, high, margin)
    fastest = _fastest_speed(velocity, points, times)
    if fastest < SLOWEST:
        return None

    spacing = round_down(longer_side / ARROWS_PER_SIDE)
    time = float(f"{spacing / fastest:.2g}")
    return Arrows(
        velocity=velocity, spacing=spacing, time=time, reach=reach, axes=low.size, flow=flow
    )


def _sample_points(low: np.ndarray, high: np.ndarray, margin: float) -> np.ndarray:
    """Return points spread over a region and a margin around it, at its middle height [m]."""
    corners = (low[:2] - margin, high[:2] + margin)
    sides = np.linspace(*corners, SAMPLES_PER_SIDE)
    places = grid_points(sides[:, 0], sides[:, 1])
    middle_height = 0.5 * (low + high)[2:]
    return np.column_stack((places, np.tile(middle_height, (len(places), 1))))


def _fastest_speed(velocity: Velocity, points: np.ndarray, times: Sequence[float]) -> float:
    """Return the speed of the fastest water but for a few points [m/s]."""
    speeds = [np.linalg.norm(velocity(points, t), axis=-1) for t in times]
    return float(np.percentile(speeds, FASTEST_PERCENTILE))


def round_down(number: float) -> float:
    """Return the largest of ... 0.1, 0.2, 0.3, 0.5, 1, 2, 3, 5, 10 ... that is not above a positive number."""
    power = 10.0 ** math.floor(math.log10(number))
    largest = number * (1.0 + 1e-9)
    fitting = [step for step in ROUND_STEPS if step * power <= largest]
    return power * max(fitting, default=1.0)
