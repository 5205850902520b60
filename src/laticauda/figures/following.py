"""The figures of one path-following run: the way to the path, the distance from it, the heading that was asked for."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from laticauda.figures import style
from laticauda.figures.path import extent, path_strip
from laticauda.trial import Trial
from laticauda.trial.following import nearest_points

PANEL_HEIGHT = 1.8  # [in]
LABELS = 0.55  # height that title and labels of a figure take [in]
STRIP_HEIGHT = (0.9, 2.6)  # [in]
TITLE = 0.6  # height that title, note and letters take [in]


def path_beside(trial: Trial, ax: Axes) -> Axes:
    """The path strip with the path that was to be followed, as far as the robot was beside it.

    Args:
        trial: A run with the signals of path following.
        ax: Where to draw.
    """
    path_strip(trial, ax)
    ax.plot(*nearest_points(trial).T, zorder=0.5, **style.AIM)
    return ax


def cross_track_error(trial: Trial, ax: Axes) -> Axes:
    """Distance from the path over time, positive to the left.

    Args:
        trial: A run with the signals of path following.
        ax: Where to draw.
    """
    ax.axhline(0.0, **style.AIM)
    ax.plot(trial.time, trial.signals["cross_track_error"], color=style.BLUE, linewidth=style.LINE)
    _over_time(trial, ax)
    return style.dress(ax, xlabel="time [s]", ylabel="cross-track error [m]")


def heading_against_reference(trial: Trial, ax: Axes) -> Axes:
    """Heading as the controller sees it, and the heading that guidance asks for, over time.

    Args:
        trial: A run with the signals of path following.
        ax: Where to draw.
    """
    used, reference = (np.degrees(trial.signals[name]) for name in ("heading_used", "heading_ref"))
    ax.plot(trial.time, used, color=style.BLUE, linewidth=style.THIN, label="heading")
    ax.plot(trial.time, reference, label="reference", **style.AIM)
    _over_time(trial, ax)
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.35 * (high - low))  # room for the legend
    style.legend(ax, loc="upper right", ncols=2)
    return style.dress(ax, xlabel="time [s]", ylabel="heading [deg]")


def follow_sheet(trial: Trial, *, title: str = "", note: str = "") -> Figure:
    """All of a path-following run in one picture: the way with body postures, cross-track error, heading.

    Args:
        trial: A run with the signals of path following.
        title: Above all panels, which then have letters as the paper's Figs. 12 to 23; "": neither.
        note: A second line under the title; "" for none.
    """
    wide, high = extent(trial)
    width = style.DOUBLE_COLUMN
    strip = float(np.clip((width - 0.8) * high / wide, *STRIP_HEIGHT))
    head = TITLE if title else 0.0
    figure = style.new_figure(width, strip + PANEL_HEIGHT + 2.0 * LABELS + head)
    grid = figure.add_gridspec(2, 2, height_ratios=(strip + LABELS, PANEL_HEIGHT + LABELS))
    axes = (
        path_beside(trial, figure.add_subplot(grid[0, :])),
        cross_track_error(trial, figure.add_subplot(grid[1, 0])),
        heading_against_reference(trial, figure.add_subplot(grid[1, 1])),
    )
    if title:
        for letter, ax in zip("abc", axes, strict=True):
            ax.set_title(f"({letter})", fontsize=style.TICK, color=style.INK, loc="left", pad=4)
        style.head(figure, title, note)
    return figure


def _over_time(trial: Trial, ax: Axes) -> None:
    """The whole run from side to side."""
    ax.set_xlim(trial.time[0], trial.time[-1])
    # Few ticks whatever the width: with more, the layout finds out too late that the last label needs room.
    ax.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
