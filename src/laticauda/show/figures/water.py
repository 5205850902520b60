"""The motion of the water under a path: the arrow of a current, or the field of a flow at one time."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, LinearSegmentedColormap
from matplotlib.image import AxesImage
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D, ScaledTranslation, Transform, blended_transform_factory

from laticauda.robot import Water
from laticauda.show.figures import style
from laticauda.trials import Trial
from laticauda.water.fluid import arrows_of, grid_points, has_waves, surface_elevation

TEXT_HEIGHT = 9.0
"""Height of the text above the upper right corner [pt]."""
BAR_WIDTH = 0.09
"""Width of the color bar [in]."""
SMALLEST_EXTENT = 0.1
"""Smallest extent that is shown along x and y [m]."""
SHADING_PIXELS = 240
"""Pixels of the shading along its longer side."""
CURRENT_ARROW = 7.0
"""Half length of the arrow of a current [pt]."""
CURRENT_ARROW_CENTER = -10.0
"""Position of its middle, from the corner to the right [pt]."""
CURRENT_TEXT_END = -20.0
"""Position of the end of its text, likewise [pt]."""
# Pale, so that arrows and bodies stand out.
SPEED_COLORS = LinearSegmentedColormap.from_list("speed", ["#FFFFFF", "#CFE3F1", "#8DBBDC"])
"""From white to blue."""
HEIGHT_COLORS = LinearSegmentedColormap.from_list("height", ["#8DBBDC", "#FFFFFF", "#EFC9A8"])
"""From blue to orange, through white."""
ARROWS: Any = {
    "angles": "xy",
    "scale_units": "xy",
    "scale": 1.0,
    "units": "dots",
    "width": 2.2,
}
"""Look of arrows whose lengths are in meters."""


def draw_water(trial: Trial, ax: Axes) -> bool:
    """Draw the motion of a run's water: its current above the corner, or the field of its flow under the path.

    Arrows show the velocity at the robot's depth at the end of the run; shading shows the elevation
    of the surface if there are waves, otherwise the speed.

    Args:
        trial: Any trial.
        ax: Axes with its path, in meters.

    Returns:
        Whether a field was drawn, which sets the limits of the axes.
    """
    water = trial.environment
    if isinstance(water, Water) and water.flow is not None:
        _draw_field(trial, water, ax)
        return True
    if isinstance(water, Water) and any(water.uniform[:2]):
        _draw_current(ax, water.uniform[:2])
    return False


@dataclass(frozen=True)
class _Area:
    """The drawn rectangle, with the velocity of the water in it at the robot's depth."""

    water: Water
    low: np.ndarray
    """Lower left corner [m]."""
    high: np.ndarray
    """Upper right corner [m]."""
    time: float
    """Time of the field [s]."""
    depth: float
    """Depth of the field, 0 at the surface [m]."""

    def velocity(self, points: np.ndarray, time: float) -> np.ndarray:
        """Return the velocity at points of the plane [m/s]."""
        heights = np.full(len(points), -self.depth)
        return self.water.velocity(np.column_stack((points, heights)), time)[:, :2]


@dataclass(frozen=True)
class _Shading:
    """What the colors of a field show."""

    values: np.ndarray
    """Value at every pixel, x outermost."""
    colors: Colormap
    least: float
    """Value of the first color."""
    label: str


def _draw_field(trial: Trial, water: Water, ax: Axes) -> None:
    """Draw shading and arrows all over the axes, which sets their limits, with a key, a color bar and the time."""
    low, high = _corners(ax)
    depth = water.depth or 0.0
    if trial.center_of_mass.shape[1] == 3:
        depth = -float(np.mean(trial.center_of_mass[:, 2]))
    area = _Area(water=water, low=low, high=high, time=float(trial.time[-1]), depth=depth)
    _draw_shading(area, ax)
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), anchor="W")
    text = f"water at {area.time:.3g} s"
    if depth:
        text += f", {depth:.3g} m deep"
    _draw_arrows(area, ax, text)


def _draw_shading(area: _Area, ax: Axes) -> None:
    """Draw the shading, with its color bar."""
    extent = area.high - area.low
    n_pixels = np.ceil(SHADING_PIXELS * extent / np.max(extent)).astype(int)
    points = grid_points(
        np.linspace(area.low[0], area.high[0], n_pixels[0]),
        np.linspace(area.low[1], area.high[1], n_pixels[1]),
    )
    shading = _shading_of(area, points)
    ends: Any = (area.low[0], area.high[0], area.low[1], area.high[1])
    image = ax.imshow(
        shading.values.reshape(n_pixels).T,
        extent=ends,
        origin="lower",
        interpolation="bilinear",
        cmap=shading.colors,
        vmin=shading.least,
        vmax=float(np.max(np.abs(shading.values))),
        zorder=0,
    )
    _add_bar(ax, image, shading.label)


def _shading_of(area: _Area, points: np.ndarray) -> _Shading:
    """Return the elevation of the surface if there are waves, otherwise the speed."""
    flow = area.water.flow
    if has_waves(flow, 0.5 * (area.low + area.high)):
        elevation = surface_elevation(flow, points, area.time)
        least = -float(np.max(np.abs(elevation)))
        return _Shading(elevation, HEIGHT_COLORS, least, "elevation [m]")
    speed = np.linalg.norm(area.velocity(points, area.time), axis=1)
    return _Shading(speed, SPEED_COLORS, 0.0, "speed [m/s]")


def _draw_arrows(area: _Area, ax: Axes, text: str) -> None:
    """Draw arrows over the area, and above its corner the text with a key to their lengths."""
    corner = _above_corner(ax)
    text_end = area.high[0]
    arrows = arrows_of(area.velocity, area.low, area.high, [area.time])
    if arrows is not None:
        ends = arrows.at(arrows.places(area.low, area.high), area.time)
        tails, tips = np.moveaxis(ends, 1, 0)
        ax.quiver(*tails.T, *(tips - tails).T, color=style.GRAY, zorder=0.6, **ARROWS)
        key_length = arrows.key * arrows.time
        key = ax.quiver(
            area.high[0],
            TEXT_HEIGHT,
            key_length,
            0.0,
            color=style.INK,
            pivot="tip",
            transform=blended_transform_factory(ax.transData, corner),
            clip_on=False,
            **ARROWS,
        )
        key.set_in_layout(False)
        text = f"{text}; {arrows.key:g} m/s:"
        text_end -= key_length
    style.add_note(
        ax,
        text,
        (text_end, TEXT_HEIGHT),
        (-5.0, 0.0),
        color=style.INK,
        xycoords=("data", corner),
        ha="right",
        va="center",
        annotation_clip=False,
    )


def _add_bar(ax: Axes, image: AxesImage, label: str) -> None:
    """Add the color bar of the shading, to the right of the axes and of the same height."""
    figure: Any = ax.get_figure(root=True)
    width = BAR_WIDTH / (ax.get_position().width * figure.get_figwidth())
    bar_axes = ax.inset_axes((1.02, 0.0, width, 1.0))
    bar = figure.colorbar(image, cax=bar_axes)
    bar.set_label(label, fontsize=style.LABEL, color=style.INK)
    bar_axes.tick_params(labelsize=style.TICK, labelcolor=style.INK, length=0)
    bar_axes.yaxis.set_major_locator(MaxNLocator(4))
    bar.outline.set_visible(False)


def _corners(ax: Axes) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of the drawn area with its margins, extended to fill axes of equal scales."""
    figure: Any = ax.get_figure(root=True)
    box: Any = np.array(ax.get_position().size) * figure.get_size_inches()
    left, right = ax.get_xlim()
    bottom, top = ax.get_ylim()
    low = np.array((left, bottom))
    high = np.array((right, top))
    middle = 0.5 * (low + high)
    half_sizes = 0.5 * np.maximum(high - low, SMALLEST_EXTENT) / box
    half_diagonal = np.max(half_sizes) * box
    return middle - half_diagonal, middle + half_diagonal


def _above_corner(ax: Axes) -> Transform:
    """Return a transform in points from the upper right corner, in which drawings keep their size and direction."""
    figure: Any = ax.get_figure(root=True)
    corner = ScaledTranslation(1.0, 1.0, ax.transAxes)  # pyright: ignore[reportArgumentType]  # any transform will do
    return Affine2D().scale(1.0 / 72.0) + figure.dpi_scale_trans + corner


def _draw_current(ax: Axes, current: Sequence[float]) -> None:
    """Show strength and direction of the current above the upper right corner."""
    strength = math.hypot(*current)
    corner = _above_corner(ax)
    x, y = (CURRENT_ARROW * component / strength for component in current)
    look: Any = {"xycoords": corner, "color": style.INK, "annotation_clip": False}
    style.add_note(
        ax,
        f"current {strength:.3g} m/s",
        (CURRENT_TEXT_END, TEXT_HEIGHT),
        (0, 0),
        ha="right",
        va="center",
        **look,
    )
    arrow = {
        "arrowstyle": "-|>",
        "mutation_scale": 7,
        "shrinkA": 0,
        "shrinkB": 0,
        "linewidth": style.THIN,
    }
    ax.annotate(
        "",
        (CURRENT_ARROW_CENTER + x, TEXT_HEIGHT + y),
        (CURRENT_ARROW_CENTER - x, TEXT_HEIGHT - y),
        textcoords=corner,
        arrowprops=arrow,
        **look,
    )
