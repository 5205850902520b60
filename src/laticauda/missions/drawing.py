"""Pictures of missions: the table as a diagram of phases, and a run as a map."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, Polygon

from laticauda.missions.mission import Mission, Way
from laticauda.missions.running import MissionResult, mission_of
from laticauda.scenarios import Scenario
from laticauda.sensing import Place, Solid
from laticauda.show.figures import new_panels, style

BOX_WIDTH = 2.6
"""Width of a phase in a diagram, in rows."""
BEND = 0.35
"""How far an arrow past other phases bends to the side, for every row, in rows."""
PHASE_COLORS = ("#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9", "#8A8A8A")
"""Colors of phases on a map, in the order of the table."""
BOX_CORNERS = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
"""Corners of a box in plan, in halves of its sides."""


def draw_phases(mission: Mission) -> Figure:
    """Draw the table of a mission: a box for every phase, an arrow for every way, with its reason.

    Args:
        mission: The mission.
    """
    names = mission.phase_names
    figure, (panel,) = new_panels(height=0.55 * len(names) + 0.9)
    ax: Any = panel
    for row, name in enumerate(names):
        behaviour = type(mission.phases[row].behaviour)
        _draw_box(ax, row, name, behaviour.__name__)
    n_right = n_left = 0
    for way, reason in _merge_ways(mission.ways):
        is_to_next = way.after == way.before + 1
        if is_to_next:
            _draw_step(ax, way, reason)
        elif way.after > way.before:
            _draw_arc(ax, way, reason, side=1, number=n_right)
            n_right += 1
        else:
            _draw_arc(ax, way, reason, side=-1, number=n_left)
            n_left += 1
    ax.set_xlim(-6.5, 9.5)
    ax.set_ylim(len(names) - 0.4, -0.6)
    ax.set_axis_off()
    return figure


def _merge_ways(ways: tuple[Way, ...]) -> list[tuple[Way, str]]:
    """Return the ways between different pairs of phases, each with all of its reasons."""
    reasons: dict[tuple[int, int], list[str]] = {}
    for way in ways:
        reasons.setdefault((way.before, way.after), []).append(way.reason)
    merged: list[tuple[Way, str]] = []
    for (before, after), words in reasons.items():
        merged.append((Way(before, after, ""), " or ".join(words)))
    return merged


def _draw_box(ax: Any, row: int, name: str, behaviour: str) -> None:
    """Draw a phase."""
    box = {"boxstyle": "round,pad=0.35", "facecolor": "white", "edgecolor": style.INK}
    ax.text(0.0, row, name, ha="center", va="center", fontsize=style.LABEL, bbox=box, zorder=3)
    ax.text(-0.5 * BOX_WIDTH, row, behaviour, ha="right", va="center", fontsize=7, color=style.GRAY)


def _draw_step(ax: Any, way: Way, reason: str) -> None:
    """Draw the way to the next phase, straight down."""
    ends = (0.0, way.before + 0.24), (0.0, way.after - 0.24)
    ax.add_patch(_arrow(*ends, bend=0.0))
    ax.text(0.12, 0.5 * (way.before + way.after), reason, va="center", fontsize=6.5)


def _draw_arc(ax: Any, way: Way, reason: str, *, side: int, number: int) -> None:
    """Draw a way past other phases: forward on the right, back on the left."""
    x = 0.5 * side * BOX_WIDTH * 0.55
    ends = (x, way.before + 0.06), (x, way.after - 0.06)
    ax.add_patch(_arrow(*ends, bend=-BEND * side if way.after > way.before else BEND * side))
    height = abs(way.after - way.before)
    middle = 0.5 * (way.before + way.after) + 0.13 * (number % 3 - 1)
    reach = x + side * (0.5 * BEND * height + 0.15)
    align = "left" if side > 0 else "right"
    ax.text(reach, middle, reason, ha=align, va="center", fontsize=6.5)


def _arrow(begin: tuple[float, float], end: tuple[float, float], *, bend: float) -> FancyArrowPatch:
    """Return an arrow between two points."""
    return FancyArrowPatch(
        begin,
        end,
        connectionstyle=f"arc3,rad={bend}",
        arrowstyle="-|>",
        mutation_scale=8,
        color=style.GRAY,
        linewidth=0.8,
    )


def draw_map(result: MissionResult) -> Figure:
    """Draw a run in plan: the places, the way of the robot by phase, and where it believed to be.

    Args:
        result: The run.
    """
    trial = result.trial
    scenario = trial.scenario
    mission = mission_of(scenario)
    assert isinstance(scenario, Scenario)
    figure, (panel,) = new_panels(height=4.0)
    ax: Any = panel
    for place in scenario.model.places:
        _draw_place(ax, place)
    x, y = trial.center_of_mass[:, 0], trial.center_of_mass[:, 1]
    ax.plot(
        trial.signals["believed_x"],
        trial.signals["believed_y"],
        color=style.INK,
        linewidth=0.5,
        linestyle=style.DOTTED,
        label="believed",
    )
    phase_of_sample = trial.signals["mission_phase"].astype(int)
    for phase, name in enumerate(mission.phase_names):
        in_phase = phase_of_sample == phase
        if in_phase.any():
            color = PHASE_COLORS[phase % len(PHASE_COLORS)]
            part_x = np.where(in_phase, x, np.nan)
            ax.plot(part_x, np.where(in_phase, y, np.nan), color=color, label=name)
    ax.set_aspect("equal")
    style.style_axes(ax, xlabel="x [m]", ylabel="y [m]")
    style.add_legend(ax, loc="upper left")
    return figure


def _draw_place(ax: Any, place: Place) -> None:
    """Draw a place in plan, with its name."""
    solids = place.solids()
    for solid in solids:
        ax.add_patch(_footprint(solid))
    centers = np.array([solid.center[:2] for solid in solids])
    x, y = centers.mean(axis=0).tolist()
    ax.text(x, y, place.name, ha="center", va="center", fontsize=style.TICK, color=style.GRAY)


def _footprint(solid: Solid) -> Polygon | Circle:
    """Return the outline of a shape in plan."""
    x, y, _ = solid.center
    if solid.kind != "box":
        return Circle((x, y), solid.size[0], color=style.GRAY)
    along = np.array(solid.axes[0][:2]) * solid.size[0]
    across = np.array(solid.axes[1][:2]) * solid.size[1]
    corners = [np.array((x, y)) + a * along + b * across for a, b in BOX_CORNERS]
    return Polygon(corners, closed=True, color=style.INK, linewidth=1.0)
