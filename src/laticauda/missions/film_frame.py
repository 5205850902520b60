"""What stays the same in all pictures of a film of a mission: map, scale, legend and the bar of phases."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from laticauda.missions.drawing import color_of_phase
from laticauda.missions.running import MissionResult, mission_of
from laticauda.missions.sensed import list_failures
from laticauda.show.figures import draw_places, new_figure, outlines_of, places_of, style

WIDTH = style.DOUBLE_COLUMN
"""Width of a picture [in]."""
HEIGHT = WIDTH * 9.0 / 16.0
"""Height of a picture [in]."""
PIXELS = 1280
"""Width of a picture in pixels."""
MAP_BOX = (0.02, 0.15, 0.96, 0.70)
"""Left, bottom, width and height of the map, in shares of the picture."""
TIMES_BOX = (0.02, 0.075, 0.96, 0.045)
"""The same of the bar of phases."""
MARGIN = 0.8
"""Water around everything that is shown [m]."""
SCALE = 2.0
"""Length of the scale of the map [m]."""
WIDE_ENOUGH = 0.07
"""Share of the time that a phase takes at least if its name stands on the bar."""
WATER_COLOR = "#F3F9FB"
"""Very light, so that arrows and lines stand out from it."""
FAILURE_COLOR = "#C00000"
"""A red that no phase has."""
NAME_OF_PHASE: Any = {"color": "white", "fontsize": style.TICK, "ha": "center", "va": "center"}
"""Look of the name of a phase on the bar."""
SCALE_LINE: Any = {"color": style.INK, "linewidth": 1.5, "solid_capstyle": "butt"}
"""Look of the scale."""
LEGEND: Any = {**style.LEGEND, "frameon": True, "edgecolor": "none", "facecolor": WATER_COLOR}
"""Look of the legend."""


def new_frame() -> Figure:
    """Return an empty figure of the size of a picture."""
    figure = new_figure(WIDTH, HEIGHT)
    figure.set_layout_engine("none")
    figure.set_dpi(PIXELS / WIDTH)
    return figure


def add_map(figure: Figure, result: MissionResult) -> Axes:
    """Add the map with its places, large enough for all that will be shown.

    Args:
        figure: The figure.
        result: The mission.
    """
    places = places_of(result.trial)
    ax = figure.add_axes(MAP_BOX)
    ax.set_facecolor(WATER_COLOR)
    draw_places(ax, places)
    points = np.vstack((result.trial.center_of_mass[:, :2], *outlines_of(places)))
    low = points.min(axis=0) - MARGIN
    high = points.max(axis=0) + MARGIN
    _, _, width, height = MAP_BOX
    box = np.array((width * WIDTH, height * HEIGHT))
    middle = 0.5 * (low + high)
    half_diagonal = 0.5 * box * np.max((high - low) / box)
    left, bottom = middle - half_diagonal
    right, top = middle + half_diagonal
    ax.set(xlim=(left, right), ylim=(bottom, top), aspect="equal", autoscale_on=False)
    ax.set(xticks=[], yticks=[])
    ax.spines[:].set_visible(False)
    _add_scale(ax, left + MARGIN, bottom + MARGIN)
    return ax


def _add_scale(ax: Axes, x: float, y: float) -> None:
    """Add a line of stated length that begins at a point of the map."""
    ax.plot([x, x + SCALE], [y, y], **SCALE_LINE)
    middle = x + 0.5 * SCALE, y
    style.add_note(ax, f"{SCALE:g} m", middle, (0.0, 2.0), ha="center", color=style.INK)


def add_legend(ax: Axes) -> Artist:
    """Add what the labeled marks mean, and return it.

    Args:
        ax: The map.
    """
    legend: Any = ax.legend(loc="lower right", ncols=3, **LEGEND)
    for handle in legend.legend_handles:
        handle.set_alpha(1.0)
    return legend


def add_times(figure: Figure, result: MissionResult) -> Axes:
    """Add the bar of phases over time, with a line above it while a sensor fails.

    Args:
        figure: The figure.
        result: The mission.
    """
    ax = figure.add_axes(TIMES_BOX)
    _draw_phases_over_time(ax, result)
    for failure in list_failures(result):
        duration = failure.end - failure.begin
        ax.barh(0.7, duration, 0.3, failure.begin, color=FAILURE_COLOR)
    ax.set(xlim=(0.0, result.duration), ylim=(-0.5, 0.9), yticks=[])
    style.style_axes(ax, xlabel="", ylabel="")
    ax.xaxis.set_major_formatter("{x:g} s")
    ax.spines["left"].set_visible(False)
    return ax


def _draw_phases_over_time(ax: Axes, result: MissionResult) -> None:
    """Draw a bar from 0 with a piece for every phase, in its color; long ones with its name."""
    names = mission_of(result.trial.scenario).phase_names
    for span in _spans_of_phases(result):
        duration = span.end - span.begin
        color = color_of_phase(names.index(span.phase))
        ax.barh(0.0, duration, 1.0, span.begin, color=color)
        if duration > WIDE_ENOUGH * result.duration:
            middle = span.begin + 0.5 * duration
            ax.text(middle, -0.03, span.phase, **NAME_OF_PHASE)


class _PhaseSpan(NamedTuple):
    """A phase from its begin to its end."""

    phase: str
    """Its name."""
    begin: float
    """When it begins [s]."""
    end: float
    """When it ends [s]."""


def _spans_of_phases(result: MissionResult) -> list[_PhaseSpan]:
    """Return the phases of a run in order."""
    spans: list[_PhaseSpan] = []
    phase = mission_of(result.trial.scenario).phase_names[0]
    begin = 0.0
    for change in result.changes:
        spans.append(_PhaseSpan(phase, begin, change.time))
        phase = change.after
        begin = change.time
    spans.append(_PhaseSpan(phase, begin, result.duration))
    return spans
