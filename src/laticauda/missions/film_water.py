"""The water in films of missions: its motion as arrows, and in words."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from laticauda.robot import Environment, Water
from laticauda.values import name_of
from laticauda.water.fluid import Flow, Waves, arrows_of

N_TIMES = 50
"""Moments of a run at which it is asked how fast the water moves, for the scale of arrows."""
ARROWS: Any = {
    "color": "#BFD7E2",
    "angles": "xy",
    "scale_units": "xy",
    "scale": 1.0,
    "units": "dots",
    "width": 2.5,
    "pivot": "middle",
    "zorder": 1.0,
}
"""Look of arrows whose lengths are in meters."""


class WaterArrows:
    """Arrows that show how the water moves at the robot's depth; none in still water.

    Args:
        ax: The map.
        environment: The water.
        duration: Duration of the run [s].
    """

    def __init__(self, ax: Axes, environment: Environment, duration: float) -> None:
        self.artists: Sequence[Artist] = ()
        """What is drawn."""
        if not isinstance(environment, Water):
            return
        left, right = ax.get_xlim()
        bottom, top = ax.get_ylim()
        low = np.array((left, bottom))
        high = np.array((right, top))
        times = np.linspace(0.0, duration, N_TIMES).tolist()
        arrows = arrows_of(environment.velocity, low, high, times)
        if arrows is None:
            return
        self._arrows = arrows
        self._centers = arrows.places(low, high)
        zeros = np.zeros(len(self._centers))
        self._quiver: Any = ax.quiver(*self._centers.T, zeros, zeros, **ARROWS)
        self.artists = (self._quiver,)

    def turn(self, time: float) -> None:
        """Turn the arrows into the directions at some time.

        Args:
            time: The time [s].
        """
        if not self.artists:
            return
        ends = self._arrows.at(self._centers, time)
        u, v = (ends[:, 1] - ends[:, 0]).T
        self._quiver.set_UVC(u, v)


def describe_water(environment: Environment) -> str:
    """Return how the water moves, in words.

    Args:
        environment: The water.
    """
    if not isinstance(environment, Water) or environment.is_still:
        return "still water"
    if environment.flow is None:
        return _describe_current(environment.uniform)
    flows: Sequence[Flow] = getattr(environment.flow, "flows", (environment.flow,))
    return ", ".join(_describe_flow(flow) for flow in flows)


def _describe_flow(flow: Flow) -> str:
    """Return how the water of a flow moves, in words."""
    if flow.constant is not None:
        return _describe_current(flow.constant)
    if isinstance(flow, Waves):
        return f"waves {100.0 * flow.height:.0f} cm, {flow.period:.1f} s"
    return name_of(type(flow))


def _describe_current(velocity: tuple[float, float, float]) -> str:
    """Return how strong a current is, in words."""
    return f"current {math.hypot(*velocity):.2f} m/s"
