"""A figure of many trials over two of their numbers, amplitude and frequency of the gait for instance."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportAttributeAccessIssue=false
# pyright: reportUnknownArgumentType=false

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes

from laticauda.figures import style

SIZE = (3.4, 2.55)  # [in]
BOX = (0.17, 0.19, 0.65, 0.68)  # of the axes in the picture: left, bottom, width, height, as shares
LABELS = ("amplitude [deg]", "frequency [deg/s]")
POINT = 14.0  # size of a single one [pt^2]
Values = Float[np.ndarray, "n_y n_x"] | Float[np.ndarray, " n_points"]


class Picture(NamedTuple):
    """A picture of the map, for a screen, and where its axes are."""

    pixels: Any
    box: tuple[float, float, float, float]
    limits: tuple[tuple[float, float], tuple[float, float]]


def gait_map(
    ax: Axes,
    across: Sequence[float],
    up: Sequence[float],
    values: Values,
    title: str,
    labels: tuple[str, str] = LABELS,
) -> Axes:
    """A figure of the trials as colors over two of their numbers; gray where there is none.

    Args:
        ax: Where to draw.
        across: Of every column, or of every point.
        up: Of every row, or of every point.
        values: The figure: a table, or one value per point.
        title: Its name, with its unit.
        labels: What is across and what is up, with units.
    """
    ax.set_facecolor("#c8c8c8")
    shown = np.ma.masked_invalid(values)
    if shown.ndim == 2:
        mesh = ax.pcolormesh(across, up, shown, shading="nearest")
    else:
        mesh = ax.scatter(across, up, c=shown, s=POINT, linewidths=0.0)
    style.dress(ax, xlabel=labels[0], ylabel=labels[1])
    ax.set_title(title, fontsize=style.LABEL, color=style.INK)
    figure: Any = ax.get_figure()
    bar = figure.colorbar(mesh, cax=ax.inset_axes((1.04, 0.0, 0.05, 1.0)))
    bar.ax.tick_params(labelsize=style.TICK, labelcolor=style.INK)
    bar.outline.set_visible(False)
    return ax


def gait_map_picture(
    across: Sequence[float],
    up: Sequence[float],
    values: Values,
    title: str,
    labels: tuple[str, str] = LABELS,
) -> Picture:
    """The same as pixels; arguments as for `gait_map`."""
    figure = style.new_figure(*SIZE)
    figure.set_layout_engine("none")
    figure.set_dpi(220)
    ax = gait_map(figure.add_axes(BOX), across, up, values, title, labels)
    canvas: Any = figure.canvas
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3].copy()
    return Picture(pixels=pixels, box=BOX, limits=(ax.get_xlim(), ax.get_ylim()))
