"""Display of moving water: positions and lengths of its arrows, and the shape of its surface.

Figures, films and the live page all use this module, so that the same water looks the same in each.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from laticauda.water.fluid.flow import Flow

ALONG = 10.0  # minimum number of arrows along the longer side of the region shown
MOMENTS = (
    0.0,
    0.31,
    0.83,
    1.7,
    3.1,
    5.3,
    9.1,
    17.0,
)  # default times at which the water is sampled [s]
LOOKS = 20  # samples along x and y, to find the fastest water
FAST = 92.0  # percentile of the speed that sets the scale: the core of a vortex would make all other arrows short
AROUND = 1.2  # largest distance of arrows from a robot, in robot lengths
LONGEST = 1.2  # largest length of an arrow [spacings]
SLOWEST = 1e-6  # smallest speed that is shown [m/s]
FINE = 0.25  # spacing in the middle of the surface patch, relative to that of an even one [-]

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
        first, last = np.ceil(low / self.spacing), np.floor(high / self.spacing)
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
        is_wet = self.axes == 2 or middle[2] <= surface_elevation(self.flow, places, t)
        places = places[is_wet & (np.hypot(*(places - middle[:2]).T) <= self.reach)]
        height = np.full((len(places), 1), middle[2])
        found = self.at(np.column_stack((places, height))[:, : self.axes], t)
        return np.dstack((found, np.stack((height, height), axis=1)))[..., :3]

    def at(self, points: np.ndarray, t: float) -> np.ndarray:
        """Return tail and tip of the arrows at given points and time, shape (n, 2, n_axes) [m]."""
        half = 0.5 * self.time * self.velocity(points, t)
        length = 2.0 * np.linalg.norm(half, axis=-1, keepdims=True)
        half = half * np.minimum(1.0, LONGEST * self.spacing / np.maximum(length, 1e-12))
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
    reach = math.inf if length is None else AROUND * length
    shown = float(np.max((high - low)[:2])) if length is None else 2.0 * reach
    room = 0.0 if length is None else reach
    looks = np.linspace(low[:2] - room, high[:2] + room, LOOKS)
    places = grid_points(looks[:, 0], looks[:, 1])
    points = np.column_stack((places, np.tile(0.5 * (low + high)[2:], (len(places), 1))))
    fastest = float(
        np.percentile([np.linalg.norm(velocity(points, t), axis=-1) for t in times], FAST)
    )
    if fastest < SLOWEST:
        return None
    spacing = round_down(shown / ALONG)
    time = float(f"{spacing / fastest:.2g}")
    return Arrows(
        velocity=velocity, spacing=spacing, time=time, reach=reach, axes=low.size, flow=flow
    )


def grid_points(x: Any, y: Any) -> np.ndarray:
    """Return all points with one of these x and one of these y, shape (n, 2); y varies fastest."""
    return np.column_stack((np.repeat(x, y.size), np.tile(y, x.size)))


def round_down(number: float) -> float:
    """Return the largest of ... 0.1, 0.2, 0.3, 0.5, 1, 2, 3, 5, 10 ... that is not above a positive number."""
    power = 10.0 ** math.floor(math.log10(number))
    return power * max(
        step
        for step in (1.0, 2.0, 3.0, 5.0)
        if step * power <= number * (1.0 + 1e-9) or step == 1.0
    )


# ---- the surface ---------------------------------------------------------------------------------


def surface_elevation(flow: Flow | None, places: np.ndarray, t: float) -> np.ndarray:
    """Return the height of the surface above its mean; infinite without a flow.

    Args:
        flow: Flow of the water.
        places: Points, shape (n, 2) [m].
        t: Time since the start of the run [s].
    """
    if flow is None:
        return np.full(len(places), math.inf)
    x, y = places.T
    return np.broadcast_to(flow.motion(x, y, 0.0 * x, t).elevation, x.shape)


def has_waves(flow: Flow | None, middle: np.ndarray) -> bool:
    """Return whether the surface of a flow moves near a point in the plane [m]."""
    places = middle[:2] + np.random.default_rng(0).uniform(-5.0, 5.0, (64, 2))
    return flow is not None and any(
        np.any(surface_elevation(flow, places, moment)) for moment in MOMENTS
    )


class Surface:
    """The surface around a robot as triangles, finer in the middle.

    Args:
        flow: Flow that moves the surface.
        reach: Distance from the middle to the sides [m].
        count: Number of corners along a side.
    """

    def __init__(self, flow: Flow, reach: float, count: int) -> None:
        self._flow, even = flow, np.linspace(-1.0, 1.0, count)
        self.line = reach * (FINE * even + (1.0 - FINE) * even**3)
        """Positions of the corners along x and y, from the middle [m]."""
        k = np.arange(count * count).reshape(count, count)
        a, b, c, d = k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]
        self.faces = np.stack((a, b, c, a, c, d), axis=-1).reshape(-1, 3)
        """Corners of each triangle, counter-clockwise as seen from above."""

    def at(self, middle: np.ndarray, t: float) -> np.ndarray:
        """Return the corners for a given middle and time, shape (count^2, 3) [m]; y varies fastest."""
        places = middle[:2] + grid_points(self.line, self.line)
        return np.column_stack((places, surface_elevation(self._flow, places, t)))
