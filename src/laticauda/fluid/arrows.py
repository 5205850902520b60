"""How moving water is shown: where its arrows stand, how long they are, and the shape of its surface.

Figures, films and the live page all ask here, so that the same water looks the same on each.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from laticauda.fluid.flow import Flow

ALONG = 10.0  # arrows along the longer side of what is shown, at least
MOMENTS = (0.0, 0.31, 0.83, 1.7, 3.1, 5.3, 9.1, 17.0)  # in which the water is looked at, where nobody says when [s]
LOOKS = 20  # along x and y, for the fastest
FAST = 92.0  # percent of the water that is not faster than a whole arrow: a vortex's core would make all others short
AROUND = 1.2  # how far from a robot arrows stand, in its lengths
LONGEST = 1.2  # of an arrow [spacings]
SLOWEST = 1e-6  # that is shown [m/s]
FINE = 0.25  # spacing of a patch of the surface in its middle, to that of an even one [-]

Velocity = Callable[[np.ndarray, float], np.ndarray]


@dataclass(frozen=True, kw_only=True)
class Arrows:
    """Arrows of moving water: they stand still in the world, each around its place, and turn as the water does."""

    velocity: Velocity
    """Of the water, in the plane or in space; takes points, shape (n, 2) or (n, 3) [m], and the time [s]."""
    spacing: float
    """Between two of them, along x and y [m]."""
    time: float
    """An arrow is as long as the way that the water there makes in this time [s]."""
    reach: float = math.inf
    """How far they stand around a robot [m]."""
    axes: int = 2
    """Of the points that `velocity` takes."""
    flow: Flow | None = None
    """Which lifts the surface, above which there are none."""

    @property
    def words(self) -> str:
        """Their scale, for people."""
        return f"arrows: the water's way in {self.time:g} s"

    @property
    def key(self) -> float:
        """A round speed, whose arrow is nearly a spacing long [m/s]."""
        return round_down(self.spacing / self.time)

    def places(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Where arrows stand between two corners, shape (n, 2) [m]."""
        first, last = np.ceil(low / self.spacing), np.floor(high / self.spacing)
        return self.spacing * grid(np.arange(first[0], last[0] + 1.0), np.arange(first[1], last[1] + 1.0))

    def around(self, middle: np.ndarray, t: float) -> np.ndarray:
        """The arrows around a robot, in its level.

        Args:
            middle: Where it is shown, in space [m].
            t: Since the start of the run [s].

        Returns:
            Tail and tip of each, shape (n, 2, 3) [m].
        """
        places = self.places(middle[:2] - self.reach, middle[:2] + self.reach)
        is_wet = self.axes == 2 or middle[2] <= elevation(self.flow, places, t)
        places = places[is_wet & (np.hypot(*(places - middle[:2]).T) <= self.reach)]
        height = np.full((len(places), 1), middle[2])
        found = self.at(np.column_stack((places, height))[:, : self.axes], t)
        return np.dstack((found, np.stack((height, height), axis=1)))[..., :3]

    def at(self, points: np.ndarray, t: float) -> np.ndarray:
        """Tail and tip of the arrows at these points at a time, shape (n, 2, n_axes) [m]."""
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
    """The arrows that suit what is shown; None where the water stands still.

    Args:
        velocity: Of the water at points, shape (n, n_axes) [m], at a time [s], of the same shape [m/s].
        low: One corner of it, in the plane or in space [m].
        high: The other [m].
        times: Some in which it is shown [s].
        length: Of a robot whose way that is, and around which they stand; None: they stand all over it [m].
        flow: Which lifts the surface.
    """
    reach = math.inf if length is None else AROUND * length
    shown = float(np.max((high - low)[:2])) if length is None else 2.0 * reach
    room = 0.0 if length is None else reach
    looks = np.linspace(low[:2] - room, high[:2] + room, LOOKS)
    places = grid(looks[:, 0], looks[:, 1])
    points = np.column_stack((places, np.tile(0.5 * (low + high)[2:], (len(places), 1))))
    fastest = float(np.percentile([np.linalg.norm(velocity(points, t), axis=-1) for t in times], FAST))
    if fastest < SLOWEST:
        return None
    spacing = round_down(shown / ALONG)
    time = float(f"{spacing / fastest:.2g}")
    return Arrows(velocity=velocity, spacing=spacing, time=time, reach=reach, axes=low.size, flow=flow)


def grid(x: Any, y: Any) -> np.ndarray:
    """All places with one of these x and one of these y, shape (n, 2); y is the faster one."""
    return np.column_stack((np.repeat(x, y.size), np.tile(y, x.size)))


def round_down(number: float) -> float:
    """The largest of ... 0.1, 0.2, 0.3, 0.5, 1, 2, 3, 5, 10 ... that is not above a positive number."""
    power = 10.0 ** math.floor(math.log10(number))
    return power * max(step for step in (1.0, 2.0, 3.0, 5.0) if step * power <= number * (1.0 + 1e-9) or step == 1.0)


# ---- the surface ---------------------------------------------------------------------------------------------------


def elevation(flow: Flow | None, places: np.ndarray, t: float) -> np.ndarray:
    """Height of the surface above its mean; infinite where nothing is said of it.

    Args:
        flow: How the water moves.
        places: Where, shape (n, 2) [m].
        t: Since the start of the run [s].
    """
    if flow is None:
        return np.full(len(places), math.inf)
    x, y = places.T
    return np.broadcast_to(flow.motion(x, y, 0.0 * x, t).elevation, x.shape)


def has_waves(flow: Flow | None, middle: np.ndarray) -> bool:
    """Whether its surface moves near a place in the plane [m]."""
    places = middle[:2] + np.random.default_rng(0).uniform(-5.0, 5.0, (64, 2))
    return flow is not None and any(np.any(elevation(flow, places, moment)) for moment in MOMENTS)


class Surface:
    """The surface around a robot as triangles, finer in the middle.

    Args:
        flow: That moves it.
        reach: From its middle to its sides [m].
        count: Corners along a side.
    """

    def __init__(self, flow: Flow, reach: float, count: int) -> None:
        self._flow, even = flow, np.linspace(-1.0, 1.0, count)
        self.line = reach * (FINE * even + (1.0 - FINE) * even**3)
        """Where corners are along x and y, from its middle [m]."""
        k = np.arange(count * count).reshape(count, count)
        a, b, c, d = k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]
        self.faces = np.stack((a, b, c, a, c, d), axis=-1).reshape(-1, 3)
        """The corners of each triangle, seen from above counter-clockwise."""

    def at(self, middle: np.ndarray, t: float) -> np.ndarray:
        """Its corners when its middle is there, shape (count^2, 3) [m]; y is the faster one."""
        places = middle[:2] + grid(self.line, self.line)
        return np.column_stack((places, elevation(self._flow, places, t)))
