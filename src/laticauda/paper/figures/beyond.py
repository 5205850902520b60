"""Beyond the paper: ways along a path with the mean distance from it, and how an offset of all joints turns."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, MaxNLocator, MultipleLocator, NullLocator

from laticauda.figures import style
from laticauda.figures.path import extent
from laticauda.figures.swim import path_beside
from laticauda.paper.beyond import TurningCurve
from laticauda.trial import Trial
from laticauda.trial.cycles import CycleMean

STRIP = (0.55, 2.4)  # smallest and largest height of a path [in]
LABELS = 0.55  # height that labels and letters take [in]
PANEL_HEIGHT = 1.7  # [in]
HEAD = 0.75  # height that title and legend take [in]
# By run, told apart by dashes too.
LINES: tuple[tuple[str, Any], ...] = (
    (style.BLUE, (0, (5, 2))),
    (style.ORANGE, "-"),
    (style.INK, (0, (1, 1.5))),
    (style.AMBER, (0, (5, 1, 1, 1))),
)


ErrorLine = tuple[str, CycleMean]
"""What a legend says, and the mean error of a run."""


def mean_errors(lines: Sequence[ErrorLine], ax: Axes, *, xlabel: str, tolerance: float | None = None) -> Axes:
    """Mean distance from the path, a line per run.

    Args:
        lines: Of each run, what the legend says, and the cycle mean of its cross-track error, positive to the left [m];
            over the time [s] or over how far along the path it was [m].
        ax: Where to draw.
        xlabel: What the errors are drawn over, with its unit.
        tolerance: A band around the path to be shaded; None for none [m].
    """
    if tolerance is not None:
        label = f"\N{PLUS-MINUS SIGN}{100.0 * tolerance:g} cm"
        ax.axhspan(-tolerance, tolerance, color="#E4E4E4", linewidth=0.0, zorder=0, label=label)
    ax.axhline(0.0, color=style.GRAY, linewidth=style.THIN, zorder=1)
    for i, (label, error) in enumerate(lines):
        color, dashes = LINES[i % len(LINES)]
        ax.plot(*error, color=color, linestyle=dashes, linewidth=1.5, label=label)
    ax.set_xlim(
        min(0.0, *(float(error.time[0]) for _, error in lines)), max(float(error.time[-1]) for _, error in lines)
    )
    return style.dress(ax, xlabel=xlabel, ylabel="mean cross-track\nerror [m]")


def runs_sheet(
    trials: Sequence[tuple[str, Trial]],
    lines: Sequence[ErrorLine],
    title: str,
    *,
    xlabel: str,
    tolerance: float | None = None,
) -> Figure:
    """The ways of some runs one above the other, and below them the mean errors of all.

    Args:
        trials: What stands above each, and the run, which followed a path.
        lines: The errors, of these runs and of others.
        title: Above all panels.
        xlabel: What the errors are drawn over, with its unit.
        tolerance: As for `mean_errors` [m].
    """
    width = style.DOUBLE_COLUMN
    extents = [extent(trial) for _, trial in trials]
    # One scale for all ways: they are drawn as wide as the longest.
    scale = (width - 0.9) / max(wide for wide, _ in extents)
    strips = [float(np.clip(scale * high, *STRIP)) + LABELS for _, high in extents]
    figure = style.new_figure(width, sum(strips) + PANEL_HEIGHT + LABELS + HEAD)
    grid = figure.add_gridspec(len(trials) + 1, 1, height_ratios=(*strips, PANEL_HEIGHT + LABELS))
    axes: list[Axes] = []
    for i, (words, trial) in enumerate(trials):
        ax = path_beside(trial, figure.add_subplot(grid[i], **({"sharex": axes[0]} if axes else {})))
        style.letter(ax, i, words)
        axes.append(ax)
    for ax in axes[:-1]:
        ax.set_xlabel("")
    last = mean_errors(lines, figure.add_subplot(grid[-1]), xlabel=xlabel, tolerance=tolerance)
    style.letter(last, len(trials))
    figure.align_ylabels([*axes, last])
    style.head(figure, title)
    style.legend_below(figure, *last.get_legend_handles_labels())
    return figure


TURN_HEIGHT = 2.2  # [in]
TURN_HEAD = 0.9  # height that title and legend take [in]
RADII = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)  # on the axis [m]


def turning_rates(lines: Sequence[TurningCurve], ax: Axes) -> Axes:
    """Turning rate over the offset.

    Args:
        lines: The data.
        ax: Where to draw.
    """
    return _draw(lines, [np.degrees(line.turning_rate) for line in lines], ax, "turning rate [deg/s]")


def turning_radii(lines: Sequence[TurningCurve], ax: Axes) -> Axes:
    """Radius of the turn over the offset, on a scale of ratios.

    Args:
        lines: The data.
        ax: Where to draw.
    """
    _draw(lines, [line.radius for line in lines], ax, "radius [m]")
    ax.set_yscale("log")
    shown = [value for line in lines for value in line.radius.tolist()]
    ax.set_ylim(0.8 * min(shown), 1.25 * max(shown))
    ax.yaxis.set_major_locator(FixedLocator(RADII))
    ax.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    ax.yaxis.set_minor_locator(NullLocator())
    return ax


def turning_speeds(lines: Sequence[TurningCurve], ax: Axes) -> Axes:
    """Path speed over the offset.

    Args:
        lines: The data.
        ax: Where to draw.
    """
    return _draw(lines, [line.path_speed for line in lines], ax, "path speed [m/s]")


def turning_sheet(lines: Sequence[TurningCurve], title: str) -> Figure:
    """Rate, radius and speed side by side.

    Args:
        lines: One per swimmer.
        title: Above all panels.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, TURN_HEIGHT + TURN_HEAD)
    axes: list[Axes] = list(figure.subplots(1, 3))
    for place, (draw, ax) in enumerate(zip((turning_rates, turning_radii, turning_speeds), axes, strict=True)):
        draw(lines, ax)
        style.letter(ax, place)
    for ax in (axes[0], axes[2]):
        ax.set_ylim(0.0, None)
        ax.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    style.head(figure, title)
    style.legend_below(figure, *axes[0].get_legend_handles_labels())
    return figure


def _draw(lines: Sequence[TurningCurve], values: Sequence[Float[np.ndarray, " n_offsets"]], ax: Axes, y: str) -> Axes:
    for line, value in zip(lines, values, strict=True):
        is_eel_like, has_fin = line.swimmer.gait.kind == "eel_like", line.swimmer.has_fin
        ax.plot(
            np.degrees(line.offset),
            value,
            color=style.ORANGE if is_eel_like else style.BLUE,
            linestyle="-" if has_fin else (0, (5, 2)),
            linewidth=1.4,
            marker="s" if is_eel_like else "o",
            markersize=3.2,
            markerfacecolor=None if has_fin else "white",
            label=line.swimmer.name,
        )
    style.light_grid(ax, "y")
    ax.set_xlim(0.0, 1.04 * max(float(np.degrees(line.offset[-1])) for line in lines))
    ax.xaxis.set_major_locator(MultipleLocator(5.0))
    return style.dress(ax, xlabel="offset $\\phi_0$ [deg]", ylabel=y)
