"""Figures of a run that followed a path: path, cross-track error, heading, and the sheet with all three."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.text import Annotation

from laticauda.show.figures import style
from laticauda.show.figures.path import MARGIN, path_extent, path_strip
from laticauda.show.figures.swim import LABELS_HEIGHT, span_time_axis, title_of
from laticauda.trials import Trial, following

PATH_HEIGHTS = (0.9, 2.6)
"""Smallest and largest height of the path [in]."""
BELOW_HEIGHT = 1.8
"""Height of the panels below it [in]."""
TITLE_HEIGHT = 0.6
"""Height of title, note and letters above the panels [in]."""


def plot_path_beside(trial: Trial, ax: Axes) -> Axes:
    """Plot the path strip with the desired path, as far as the robot was beside it.

    Args:
        trial: A run with the signals of path following.
        ax: Axes to draw on.
    """
    path_strip(trial, ax)
    ax.plot(*following.nearest_points(trial).T, zorder=0.5, **style.AIM)
    waypoints: Sequence[tuple[float, float]] = getattr(following.path_of(trial), "waypoints", ())
    if waypoints:
        look = style.marker_style("o", 4.0, style.ORANGE, markerfacecolor="white", zorder=0.6)
        ax.plot(*np.array(waypoints).T, **look)
        _add_end(ax, trial, waypoints[-1])
    else:
        x, y = following.nearest_points(trial)[0]
        _add_path_note(ax, "path", (float(x), float(y)), shift=(-4, -3), ha="right")
    return ax


def _add_end(ax: Axes, trial: Trial, point: tuple[float, float]) -> None:
    """Name the last waypoint: below it on the right, or on the other side if the time of a posture stands there."""
    room = 2.0 * MARGIN * max(path_extent(trial))
    times = np.array([note.xy for note in ax.texts if isinstance(note, Annotation)])
    from_point = times - point
    is_near = np.linalg.norm(from_point, axis=1) < room
    is_below_on_the_right = from_point @ (1.0, -1.0) > 0.0
    if np.any(is_near & is_below_on_the_right):
        _add_path_note(ax, "end", point, shift=(-5, 4), ha="right")
    else:
        _add_path_note(ax, "end", point, shift=(5, -9))


def _add_path_note(
    ax: Axes, text: str, point: tuple[float, float], shift: tuple[float, float], **look: Any
) -> None:
    """Add a text at a point of the desired path, readable on a body that lies there."""
    outline = [withStroke(linewidth=2.0, foreground="white")]
    look |= {"color": style.ORANGE, "path_effects": outline, "zorder": 6}
    style.add_note(ax, text, point, shift, **look)


def plot_cross_track_error(trial: Trial, ax: Axes) -> Axes:
    """Plot the distance from the path over time, positive to the left.

    Args:
        trial: A run with the signals of path following.
        ax: Axes to draw on.
    """
    ax.axhline(0.0, **style.AIM)
    ax.plot(trial.time, trial.signals["cross_track_error"], color=style.BLUE, linewidth=style.LINE)
    span_time_axis(ax, trial.time)
    return style.style_axes(ax, xlabel="time [s]", ylabel="cross-track error [m]")


def plot_heading_against_reference(trial: Trial, ax: Axes) -> Axes:
    """Plot the heading used by the controller, and the reference heading of the guidance, over time.

    Args:
        trial: A run with the signals of path following.
        ax: Axes to draw on.
    """
    heading = np.degrees(trial.signals["heading_used"])
    reference = np.degrees(trial.signals["heading_ref"])
    ax.plot(trial.time, heading, color=style.BLUE, linewidth=style.THIN, label="heading")
    ax.plot(trial.time, reference, label="reference", **style.AIM)
    span_time_axis(ax, trial.time)
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.35 * (high - low))  # space for the legend
    style.add_legend(ax, loc="upper right", ncols=2)
    return style.style_axes(ax, xlabel="time [s]", ylabel="heading [deg]")


def follow_sheet(trial: Trial, *, title: str = "", note: str = "") -> Figure:
    """Create one figure of a path-following run: path with body postures, cross-track error, heading.

    Args:
        trial: A run with the signals of path following.
        title: Title above all panels, which then have letters as in the paper's Figs. 12 to 23; "":
            that of `title_of`, no letters.
        note: A second line under the title; "" for none.
    """
    path_width, path_height = path_extent(trial)
    width = style.DOUBLE_COLUMN
    strip = float(np.clip((width - 0.8) * path_height / path_width, *PATH_HEIGHTS))
    figure = style.new_figure(width, strip + BELOW_HEIGHT + 2.0 * LABELS_HEIGHT + TITLE_HEIGHT)
    heights = (strip + LABELS_HEIGHT, BELOW_HEIGHT + LABELS_HEIGHT)
    grid = figure.add_gridspec(2, 2, height_ratios=heights)
    axes = (
        plot_path_beside(trial, figure.add_subplot(grid[0, :])),
        plot_cross_track_error(trial, figure.add_subplot(grid[1, 0])),
        plot_heading_against_reference(trial, figure.add_subplot(grid[1, 1])),
    )
    if title:
        for panel, ax in enumerate(axes):
            style.add_letter(ax, panel)
    style.add_title(figure, title or title_of(trial), note)
    return figure
