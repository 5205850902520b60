"""A figure of many trials over amplitude and frequency."""

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


class Picture(NamedTuple):
    """A picture of the map, for a screen, and where its axes are."""

    pixels: Any
    box: tuple[float, float, float, float]
    limits: tuple[tuple[float, float], tuple[float, float]]


def gait_map(
    ax: Axes,
    amplitude_deg: Sequence[float],
    frequency_deg_s: Sequence[float],
    values: Float[np.ndarray, "n_frequencies n_amplitudes"],
    title: str,
) -> Axes:
    """A figure of the trials as colors over amplitude and frequency; gray where there is none.

    Args:
        ax: Where to draw.
        amplitude_deg: Of every column [deg].
        frequency_deg_s: Of every row [deg/s].
        values: The figure.
        title: Its name, with its unit.
    """
    ax.set_facecolor("#c8c8c8")
    mesh = ax.pcolormesh(amplitude_deg, frequency_deg_s, np.ma.masked_invalid(values), shading="nearest")
    style.dress(ax, xlabel="amplitude [deg]", ylabel="frequency [deg/s]")
    ax.set_title(title, fontsize=style.LABEL, color=style.INK)
    figure: Any = ax.get_figure()
    bar = figure.colorbar(mesh, cax=ax.inset_axes((1.04, 0.0, 0.05, 1.0)))
    bar.ax.tick_params(labelsize=style.TICK, labelcolor=style.INK)
    bar.outline.set_visible(False)
    return ax


def gait_map_picture(
    amplitude_deg: Sequence[float],
    frequency_deg_s: Sequence[float],
    values: Float[np.ndarray, "n_frequencies n_amplitudes"],
    title: str,
) -> Picture:
    """The same as pixels; arguments as for `gait_map`."""
    figure = style.new_figure(*SIZE)
    figure.set_layout_engine("none")
    figure.set_dpi(220)
    ax = gait_map(figure.add_axes(BOX), amplitude_deg, frequency_deg_s, values, title)
    canvas: Any = figure.canvas
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3].copy()
    return Picture(pixels=pixels, box=BOX, limits=(ax.get_xlim(), ax.get_ylim()))
