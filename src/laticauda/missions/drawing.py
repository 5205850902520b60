"""Pictures of missions: the table as a diagram of phases, and a run as a map."""

import math
import textwrap
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Rectangle
from matplotlib.path import Path
from matplotlib.textpath import TextPath

from laticauda.missions.mission import Mission, Way
from laticauda.missions.running import MissionResult, mission_of
from laticauda.show.figures import draw_places, new_panels, outlines_of, places_of, style
from laticauda.values import name_of

HALF_BOX = 0.75
"""Half the width of a phase in a diagram."""
HALF_HEIGHT = 0.24
"""Half its height, in rows."""
UNIT = 0.66
"""Length of a unit across a diagram [in]."""
ROW = 0.78
"""Height of a row of a diagram [in]."""
ROOM_LEFT = 1.15
"""Room for reasons to the left of all ways."""
ROOM_RIGHT = 1.2
"""Room for reasons to the right of all ways."""
LEAST_RIGHT = 2.8
"""Room to the right of the middle at least."""
REASON_WIDTH = 14
"""Characters of a line of the reasons beside a way past other phases."""
REASON_SIZE = 7
"""Size of reasons [pt]."""
LINE_HEIGHT = 0.18
"""Height of a line of reasons, in rows."""
POINTS_PER_INCH = 72.0
BESIDE_STEP = 0.08
"""Distance of reasons from the arrow of a step."""
ARC_ROOM = 0.7
"""Distance of the first way past other phases from the boxes."""
ARC_STEP = 1.25
"""Distance of the ways past other phases from each other: their reasons are between."""
STEP_REASON_WIDTH = 24
"""Characters of a line of the reasons beside a way to the next phase."""
PHASE_COLORS = ("#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9", "#8A8A8A")
"""Colors of phases on a map, in the order of the table."""
MAP_WIDTH = 5.5
"""Width of a map without its labels [in]."""
MAP_HEIGHTS = (1.5, 5.0)
"""Smallest and largest height of a map without its labels [in]."""
LABELS_HEIGHT = 0.7
"""Height of its labels [in]."""
BELIEVED: Any = {
    "color": style.INK,
    "linewidth": 0.5,
    "linestyle": style.DOTTED,
    "label": "believed",
}
"""Look of the way that the robot believed to take."""


def draw_phases(mission: Mission) -> Figure:
    """Draw the table of a mission: a box for every phase, an arrow for every way, with its reasons.

    Args:
        mission: The mission.
    """
    names = mission.phase_names
    ways = sorted(_merge_ways(mission.ways), key=_count_rows)
    n_arcs = {1: 0, -1: 0}
    for way in ways:
        if way.after != way.before + 1:
            n_arcs[_side_of(way)] += 1
    right_of_steps = _right_end_of_steps(ways)
    left = -(_arc_at(HALF_BOX, n_arcs[-1]) + ROOM_LEFT)
    right = max(_arc_at(right_of_steps, n_arcs[1]) + ROOM_RIGHT, LEAST_RIGHT)
    heights = _heights_of_phases(ways, len(names))
    n_rows = heights[-1] + 1.0
    figure, (panel,) = new_panels(width=UNIT * (right - left), height=ROW * n_rows)
    ax: Any = panel
    for phase, height, name in zip(mission.phases, heights, names, strict=True):
        _draw_box(ax, height, name, name_of(type(phase.behaviour)))
    n_drawn = {1: 0, -1: 0}
    for way in ways:
        if way.after == way.before + 1:
            _draw_step(ax, way, heights)
            continue
        side = _side_of(way)
        n_drawn[side] += 1
        inside = HALF_BOX
        if side > 0:
            inside = right_of_steps
        _draw_arc(ax, way, heights, x=side * _arc_at(inside, n_drawn[side]))
    ax.set_xlim(left, right)
    ax.set_ylim(n_rows - 0.5, -0.5)
    ax.set_axis_off()
    return figure


def _merge_ways(ways: tuple[Way, ...]) -> list[Way]:
    """Return one way between every pair of phases, with all of its reasons, one a line."""
    reasons_of_pair: dict[tuple[int, int], list[str]] = {}
    for way in ways:
        reasons_of_pair.setdefault((way.before, way.after), []).append(way.reason)
    merged_ways: list[Way] = []
    for (before, after), reasons in reasons_of_pair.items():
        merged_ways.append(Way(before, after, "\nor ".join(reasons)))
    return merged_ways


def _heights_of_phases(ways: list[Way], n_phases: int) -> list[float]:
    """Return how far down the phases are, in rows: farther apart where there are many reasons between two."""
    gaps = [1.0] * (n_phases - 1)
    for way in ways:
        if way.after == way.before + 1:
            n_lines = len(_wrap_reasons(way.reason, STEP_REASON_WIDTH))
            gaps[way.before] = max(1.0, 2.0 * HALF_HEIGHT + LINE_HEIGHT * n_lines)
    return [sum(gaps[:phase]) for phase in range(n_phases)]


def _right_end_of_steps(ways: list[Way]) -> float:
    """Return from where ways past other phases cross neither a box nor the reasons of a step, less a distance."""
    longest = 0.0
    for way in ways:
        if way.after == way.before + 1:
            lines = _wrap_reasons(way.reason, STEP_REASON_WIDTH)
            longest = max(longest, *(_width_of(line) for line in lines))
    return max(HALF_BOX, BESIDE_STEP + longest + BESIDE_STEP - ARC_ROOM)


def _width_of(line: str) -> float:
    """Return the width of a line of reasons, in units across a diagram."""
    letters: Any = TextPath((0.0, 0.0), line, size=REASON_SIZE)
    return letters.get_extents().width / POINTS_PER_INCH / UNIT


def _arc_at(inside: float, number: int) -> float:
    """Return the distance from the middle of one of the ways past other phases; of none, that of what is inside."""
    if number == 0:
        return inside
    return inside + ARC_ROOM + ARC_STEP * (number - 1)


def _wrap_reasons(reasons: str, width: int) -> list[str]:
    """Return the lines of reasons, each of which begins a new one."""
    lines: list[str] = []
    for reason in reasons.splitlines():
        lines += textwrap.wrap(reason, width)
    return lines


def _side_of(way: Way) -> int:
    """Return on which side a way past other phases is drawn: 1 for the right, by which one goes on; -1 for the left."""
    return int(math.copysign(1, way.after - way.before))


def _count_rows(way: Way) -> int:
    """Return how many rows a way leads up or down: short ones are drawn inside."""
    return abs(way.after - way.before)


def _draw_box(ax: Any, row: float, name: str, behaviour: str) -> None:
    """Draw a phase with what the robot does in it."""
    box = Rectangle(
        (-HALF_BOX, row - HALF_HEIGHT),
        2.0 * HALF_BOX,
        2.0 * HALF_HEIGHT,
        facecolor="white",
        edgecolor=style.INK,
        zorder=3,
    )
    ax.add_patch(box)
    ax.text(0.0, row - 0.07, name, ha="center", va="center", fontsize=style.LABEL, zorder=4)
    ax.text(
        0.0,
        row + 0.12,
        behaviour,
        ha="center",
        va="center",
        fontsize=REASON_SIZE,
        color=style.GRAY,
        zorder=4,
    )


def _draw_step(ax: Any, way: Way, heights: list[float]) -> None:
    """Draw the way to the next phase, straight down."""
    before, after = heights[way.before], heights[way.after]
    begin = 0.0, before + HALF_HEIGHT
    end = 0.0, after - HALF_HEIGHT
    ax.add_patch(_arrow((begin, end)))
    middle = 0.5 * (before + after)
    lines = _wrap_reasons(way.reason, STEP_REASON_WIDTH)
    _write_reasons(ax, BESIDE_STEP, middle, "\n".join(lines), align="left")


def _draw_arc(ax: Any, way: Way, heights: list[float], *, x: float) -> None:
    """Draw a way past other phases: out to the side, along, and back in."""
    side = math.copysign(1.0, x)
    before, after = heights[way.before], heights[way.after]
    down = math.copysign(1.0, after - before)
    lower = 0.1 * down
    begin = side * HALF_BOX, before + lower
    end = side * HALF_BOX, after - lower
    ax.add_patch(_arrow((begin, (x, begin[1]), (x, end[1]), end)))
    align = "left" if side > 0.0 else "right"
    lines = _wrap_reasons(way.reason, REASON_WIDTH)
    _write_reasons(ax, x + 0.06 * side, before + 0.5 * down, "\n".join(lines), align=align)


def _write_reasons(ax: Any, x: float, y: float, reasons: str, *, align: str) -> None:
    """Write reasons beside a way, over the lines of others."""
    ax.text(
        x,
        y,
        reasons,
        ha=align,
        va="center",
        fontsize=REASON_SIZE,
        linespacing=1.1,
        zorder=5,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5},
    )


def _arrow(points: tuple[tuple[float, float], ...]) -> FancyArrowPatch:
    """Return an arrow along points."""
    return FancyArrowPatch(
        path=Path(points), arrowstyle="-|>", mutation_scale=7, color=style.GRAY, linewidth=0.8
    )


def draw_map(result: MissionResult) -> Figure:
    """Draw a run in plan: the places, the way of the robot by phase, and where it believed to be.

    Args:
        result: The run.
    """
    trial = result.trial
    mission = mission_of(trial.scenario)
    way = trial.center_of_mass[:, :2]
    places = places_of(trial)
    width, height = np.ptp(np.vstack((way, *outlines_of(places))), axis=0)
    map_height = np.clip(MAP_WIDTH * height / width, *MAP_HEIGHTS)
    figure, (panel,) = new_panels(height=map_height + LABELS_HEIGHT)
    ax: Any = panel
    draw_places(ax, places)
    ax.plot(trial.signals["believed_x"], trial.signals["believed_y"], **BELIEVED)
    phase_of_sample = trial.signals["mission_phase"].astype(int)
    for phase, name in enumerate(mission.phase_names):
        in_phase = phase_of_sample == phase
        if in_phase.any():
            part = np.where(in_phase[:, np.newaxis], way, np.nan)
            ax.plot(*part.T, color=color_of_phase(phase), linestyle=style.SOLID, label=name)
    ax.set_aspect("equal")
    style.style_axes(ax, xlabel="x [m]", ylabel="y [m]")
    handles, _ = ax.get_legend_handles_labels()
    style.outside_legend(figure, handles, "outside right upper")
    return figure


def color_of_phase(phase: int) -> str:
    """Return the color of a phase on maps and in films.

    Args:
        phase: Its index in the table.
    """
    return PHASE_COLORS[phase % len(PHASE_COLORS)]
