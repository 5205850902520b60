"""Figures of path following as in Figs. 12 to 23: one trial, simulated by several models, with the measured speed.

The body is drawn along the path of the first model. The paper shows path, cross-track error and
heading; the distance over time is added, where the measured speed is a slope.
"""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from laticauda.show.figures import path_extent, path_strip, style
from laticauda.trials import Trial, following

STRIP_HEIGHTS = (0.9, 2.2)
"""Smallest and largest height of the path [in]."""
PANEL_HEIGHT = 1.75
"""Height of a panel below the path [in]."""
LABELS_HEIGHT = 0.55
"""Height of letter and labels of a panel [in]."""
AROUND = 0.85
"""Height of title and legend [in]."""
LINES: tuple[dict[str, Any], ...] = (
    {"color": style.BLUE, "linewidth": style.LINE, "zorder": 3},
    {"color": style.GRAY, "linewidth": style.LINE, "zorder": 2},
    {"color": style.AMBER, "linewidth": style.LINE, "zorder": 1},
)
"""Looks of the models' lines, in order."""
DESIRED: dict[str, Any] = {"color": style.INK, "linewidth": style.THIN, "linestyle": style.DOTTED}
"""Look of the desired path."""
REFERENCE: dict[str, Any] = {
    "color": style.INK,
    "linewidth": 0.8,
    "linestyle": style.DASHED,
    "zorder": 2.5,
}
"""Look of the reference heading."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ModelRun:
    """A trial as one model simulates it."""

    label: str
    """The model, in the legend."""
    trial: Trial
    """Trial along the x axis."""
    forward_velocity: float
    """Its forward velocity, in the legend [m/s]."""


def draw_following_sheet(
    runs: Sequence[ModelRun], *, title: str, measured_velocity: float | None = None
) -> Figure:
    """Draw a trial by several models: path, cross-track error, heading, and distance over time.

    Args:
        runs: The same trial by at most three models; the body of the first one is drawn.
        title: Title above all panels.
        measured_velocity: Measured forward velocity, drawn as a slope; None: not measured [m/s].
    """
    trial = runs[0].trial
    path_width, path_height = path_extent(trial)
    strip_height = (style.DOUBLE_COLUMN - 0.8) * path_height / path_width
    heights = (
        float(np.clip(strip_height, *STRIP_HEIGHTS)) + LABELS_HEIGHT,
        PANEL_HEIGHT + LABELS_HEIGHT,
    )
    figure = style.new_figure(style.DOUBLE_COLUMN, sum(heights) + AROUND)
    grid = figure.add_gridspec(2, 3, height_ratios=heights)
    panels = [
        _draw_path(runs, figure.add_subplot(grid[0, :])),
        _draw_cross_track_error(runs, figure.add_subplot(grid[1, 0])),
        _draw_heading(runs, figure.add_subplot(grid[1, 1])),
        _draw_distance(runs, measured_velocity, figure.add_subplot(grid[1, 2])),
    ]
    for number, ax in enumerate(panels):
        style.add_letter(ax, number)
    handles = _list_handles(runs, measured_velocity)
    style.outside_legend(figure, handles, "outside lower center", ncols=2, handlelength=2.4)
    style.add_title(figure, title)
    return figure


# ---- panels --------------------------------------------------------------------------------------


def _draw_path(runs: Sequence[ModelRun], ax: Axes) -> Axes:
    """Draw the body along the path of the first model, and the paths of the others."""
    first = runs[0]
    path_strip(first.trial, ax)
    for run, look in zip(runs[1:], LINES[1:], strict=False):
        path = run.trial.center_of_mass[:, :2]
        x, y = path.T
        behind_the_body: dict[str, Any] = {**look, "zorder": 0.8}
        ax.plot(x, y, **behind_the_body)
    x, y = following.nearest_points(first.trial).T
    ax.plot(x, y, zorder=0.5, **DESIRED)
    return ax


def _draw_cross_track_error(runs: Sequence[ModelRun], ax: Axes) -> Axes:
    ax.axhline(0.0, **DESIRED)
    for run, look in zip(runs, LINES, strict=False):
        ax.plot(run.trial.time, run.trial.signals["cross_track_error"], **look)
    return _style_over_time(runs, ax, "cross-track error [m]")


def _draw_heading(runs: Sequence[ModelRun], ax: Axes) -> Axes:
    """Draw the heading that each controller used, and the reference of the first model."""
    for run, look in zip(runs, LINES, strict=False):
        ax.plot(run.trial.time, _in_degrees(run.trial, "heading_used"), **look)
    first = runs[0].trial
    ax.plot(first.time, _in_degrees(first, "heading_ref"), **REFERENCE)
    return _style_over_time(runs, ax, "heading [deg]")


def _draw_distance(runs: Sequence[ModelRun], measured_velocity: float | None, ax: Axes) -> Axes:
    """Draw the distance from the start, whose final value over the time is the forward velocity."""
    farthest = 0.0
    for run, look in zip(runs, LINES, strict=False):
        distance = _distance_from_start(run.trial)
        ax.plot(run.trial.time, distance, **look)
        run_farthest = float(distance.max())
        farthest = max(farthest, run_farthest)
    if measured_velocity is not None:
        end = min(farthest / measured_velocity, _longest_time(runs))
        ax.plot([0.0, end], [0.0, measured_velocity * end], **style.AIM, zorder=4)
    ax.set_ylim(bottom=0.0)
    return _style_over_time(runs, ax, "distance from the start [m]")


def _in_degrees(trial: Trial, signal: str) -> Float[np.ndarray, " n_samples"]:
    return np.degrees(trial.signals[signal])


def _distance_from_start(trial: Trial) -> Float[np.ndarray, " n_samples"]:
    """Return the distance of the center of mass from its start [m]."""
    path = trial.center_of_mass[:, :2]
    way = path - path[0]
    return np.linalg.norm(way, axis=1)


def _longest_time(runs: Sequence[ModelRun]) -> float:
    return max(float(run.trial.time[-1]) for run in runs)


def _style_over_time(runs: Sequence[ModelRun], ax: Axes, ylabel: str) -> Axes:
    ax.set_xlim(0.0, _longest_time(runs))
    ax.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    ax.yaxis.set_major_locator(MaxNLocator(6))
    return style.style_axes(ax, xlabel="time [s]", ylabel=ylabel)


# ---- legend --------------------------------------------------------------------------------------


def _list_handles(runs: Sequence[ModelRun], measured_velocity: float | None) -> list[Line2D]:
    handles: list[Line2D] = []
    for run, look in zip(runs, LINES, strict=False):
        label = f"{run.label}: {run.forward_velocity:.4f} m/s"
        handles.append(Line2D([], [], label=label, **look))
    if measured_velocity is not None:
        label = f"measured: {measured_velocity:.4f} m/s"
        handles.append(Line2D([], [], label=label, **style.AIM))
    handles.append(Line2D([], [], label="reference heading of the first", **REFERENCE))
    return handles
