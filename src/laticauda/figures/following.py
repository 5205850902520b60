"""The figures of one path-following run: the way to the path, the distance from it, the heading that was asked for."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from laticauda.figures import style
from laticauda.figures.path import extent, path_strip
from laticauda.trial import Trial
from laticauda.trial.following import nearest_points

PANEL_HEIGHT = 1.8  # [in]
LABELS = 0.55  # height that title and labels of a figure take [in]
STRIP_HEIGHT = (0.9, 2.6)  # [in]


def path_beside(trial: Trial, ax: Axes) -> Axes:
    """The path strip with the path that was to be followed, as far as the robot was beside it.

    Args:
        trial: A run with the signals of path following.
        ax: Where to draw.
    """
    path_strip(trial, ax)
    ax.plot(*nearest_points(trial).T, color=style.ORANGE, linewidth=style.LINE, linestyle=(0, (4, 2)), zorder=0.5)
    return ax


def cross_track_error(trial: Trial, ax: Axes) -> Axes:
    """Distance from the path over time, positive to the left.

    Args:
        trial: A run with the signals of path following.
        ax: Where to draw.
    """
    ax.axhline(0.0, color=style.ORANGE, linewidth=style.LINE, linestyle=(0, (4, 2)))
    ax.plot(trial.time, trial.signals["cross_track_error"], color=style.BLUE, linewidth=style.LINE)
    ax.set_xlim(trial.time[0], trial.time[-1])
    return style.dress(ax, xlabel="time [s]", ylabel="cross-track error [m]")


def heading_against_reference(trial: Trial, ax: Axes) -> Axes:
    """Heading as the controller sees it, and the heading that guidance asks for, over time.

    Args:
        trial: A run with the signals of path following.
        ax: Where to draw.
    """
    ax.plot(
        trial.time, np.degrees(trial.signals["heading_used"]), color=style.BLUE, linewidth=style.THIN, label="heading"
    )
    ax.plot(
        trial.time,
        np.degrees(trial.signals["heading_ref"]),
        color=style.ORANGE,
        linewidth=style.LINE,
        linestyle=(0, (4, 2)),
        label="reference",
    )
    ax.set_xlim(trial.time[0], trial.time[-1])
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.35 * (high - low))  # room for the legend
    style.legend(ax, loc="upper right", ncols=2)
    return style.dress(ax, xlabel="time [s]", ylabel="heading [deg]")


def follow_sheet(trial: Trial) -> Figure:
    """All of a path-following run in one picture: the way with body postures, cross-track error, heading.

    Args:
        trial: A run with the signals of path following.
    """
    wide, high = extent(trial)
    width = style.DOUBLE_COLUMN
    strip = float(np.clip((width - 0.8) * high / wide, *STRIP_HEIGHT))
    figure = style.new_figure(width, strip + PANEL_HEIGHT + 2.0 * LABELS)
    grid = figure.add_gridspec(2, 2, height_ratios=(strip + LABELS, PANEL_HEIGHT + LABELS))
    path_beside(trial, figure.add_subplot(grid[0, :]))
    cross_track_error(trial, figure.add_subplot(grid[1, 0]))
    heading_against_reference(trial, figure.add_subplot(grid[1, 1]))
    return figure
