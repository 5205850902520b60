"""The water under the path of a run: the arrow of a current, or the field of a flow at one time."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.image import AxesImage
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D, ScaledTranslation, Transform, blended_transform_factory

from laticauda.figures import style
from laticauda.fluid.arrows import arrows_of, elevation, grid, has_waves
from laticauda.robot import Water
from laticauda.trial import Trial

ROW = 9.0  # height of the words above the upper right corner [pt]
BAR = 0.09  # width of the color bar [in]
LEAST = 0.1  # that is shown along x and y [m]
PIXELS = 240  # of the shading, along its longer side
# Pale, so that arrows and bodies stand out: from white, and from one color to another through white.
SPEED = LinearSegmentedColormap.from_list("speed", ["#FFFFFF", "#CFE3F1", "#8DBBDC"])
HEIGHT = LinearSegmentedColormap.from_list("height", ["#8DBBDC", "#FFFFFF", "#EFC9A8"])


def draw_water(trial: Trial, ax: Axes) -> bool:
    """How the water of a run moves: its current above the corner, or the field of its flow under the path.

    Arrows stand for the velocity in the robot's level at the end of the run, shades for the elevation of the surface
    if there are waves, else for the speed.

    Args:
        trial: Any trial.
        ax: With its path, in meters.

    Returns:
        Whether it has drawn a field, and so set the limits of the axes.
    """
    water = trial.environment
    if isinstance(water, Water) and water.flow is not None:
        _draw_field(trial, water, ax)
        return True
    if isinstance(water, Water) and any(water.uniform[:2]):
        _tell_current(ax, water.uniform[:2])
    return False


def _draw_field(trial: Trial, water: Water, ax: Axes) -> None:
    """Shades and arrows all over the axes, whose limits are set by that, with a key, a bar and the time."""
    low, high = _corners(ax)
    time, depth = float(trial.time[-1]), water.depth or 0.0
    if trial.center_of_mass.shape[1] == 3:
        depth = -float(np.mean(trial.center_of_mass[:, 2]))

    def velocity(points: np.ndarray, t: float) -> np.ndarray:
        return water.velocity(np.column_stack((points, np.full(len(points), -depth))), t)[:, :2]

    counts = np.ceil(PIXELS * (high - low) / np.max(high - low)).astype(int)
    places = grid(np.linspace(low[0], high[0], counts[0]), np.linspace(low[1], high[1], counts[1]))
    if has_waves(water.flow, 0.5 * (low + high)):
        shade, colors, label = elevation(water.flow, places, time), HEIGHT, "elevation [m]"
        least = -float(np.max(np.abs(shade)))
    else:
        shade, colors, label, least = np.linalg.norm(velocity(places, time), axis=1), SPEED, "speed [m/s]", 0.0
    ends: Any = (low[0], high[0], low[1], high[1])
    look: Any = {"cmap": colors, "vmin": least, "vmax": float(np.max(np.abs(shade))), "zorder": 0}
    image = ax.imshow(shade.reshape(counts).T, extent=ends, origin="lower", interpolation="bilinear", **look)
    _add_bar(ax, image, label)
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), anchor="W")
    corner, end = _above_corner(ax), high[0]
    words = f"water at {time:.3g} s" + (f", {depth:.3g} m deep" if depth else "")
    arrows = arrows_of(velocity, low, high, [time])
    if arrows is not None:
        tails, tips = np.moveaxis(arrows.at(arrows.places(low, high), time), 1, 0)
        sizes: Any = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "units": "dots", "width": 2.2}
        ax.quiver(*tails.T, *(tips - tails).T, color=style.GRAY, zorder=0.6, **sizes)
        long = arrows.key * arrows.time
        places = blended_transform_factory(ax.transData, corner)
        key = ax.quiver(end, ROW, long, 0.0, color=style.INK, pivot="tip", transform=places, clip_on=False, **sizes)
        key.set_in_layout(False)
        words, end = f"{words}; {arrows.key:g} m/s:", end - long
    at: Any = {"xycoords": ("data", corner), "ha": "right", "va": "center", "annotation_clip": False}
    style.note(ax, words, (end, ROW), (-5.0, 0.0), color=style.INK, **at)


def _add_bar(ax: Axes, image: AxesImage, label: str) -> None:
    """What the shades stand for, to the right of the axes and as high as these."""
    figure: Any = ax.get_figure(root=True)
    side = ax.inset_axes((1.02, 0.0, BAR / (ax.get_position().width * figure.get_figwidth()), 1.0))
    bar = figure.colorbar(image, cax=side)
    bar.set_label(label, fontsize=style.LABEL, color=style.INK)
    side.tick_params(labelsize=style.TICK, labelcolor=style.INK, length=0)
    side.yaxis.set_major_locator(MaxNLocator(4))
    bar.outline.set_visible(False)


def _corners(ax: Axes) -> tuple[np.ndarray, np.ndarray]:
    """Of what is drawn, with its margins, and what beside it fills axes of equal scales."""
    figure: Any = ax.get_figure(root=True)
    box: Any = np.array(ax.get_position().size) * figure.get_size_inches()
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    low, high = np.array((left, bottom)), np.array((right, top))
    half = 0.5 * np.maximum(high - low, LEAST) / box
    return 0.5 * (low + high) - np.max(half) * box, 0.5 * (low + high) + np.max(half) * box


def _above_corner(ax: Axes) -> Transform:
    """Points, counted from the upper right corner: what is drawn in them keeps its size and its direction."""
    figure: Any = ax.get_figure(root=True)
    corner = ScaledTranslation(1.0, 1.0, ax.transAxes)  # pyright: ignore[reportArgumentType]  # any transform will do
    return Affine2D().scale(1.0 / 72.0) + figure.dpi_scale_trans + corner


def _tell_current(ax: Axes, current: Sequence[float]) -> None:
    """Strength and direction of the current, above the upper right corner."""
    strength, in_points = math.hypot(*current), _above_corner(ax)
    x, y = (7.0 * part / strength for part in current)
    look: Any = {"xycoords": in_points, "color": style.INK, "annotation_clip": False}
    style.note(ax, f"current {strength:.3g} m/s", (-20.0, ROW), (0, 0), ha="right", va="center", **look)
    arrow = {"arrowstyle": "-|>", "mutation_scale": 7, "shrinkA": 0, "shrinkB": 0, "linewidth": style.THIN}
    ax.annotate("", (-10.0 + x, ROW + y), (-10.0 - x, ROW - y), textcoords=in_points, arrowprops=arrow, **look)
