"""Drawing of a design: side and plan view of a robot, beside the one with which the search began, and their gaits."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from laticauda.robot import Robot
from laticauda.scenarios import Scenario
from laticauda.show.figures import new_figure, save_figure, style

MILLIMETERS = 1e3
"""Millimeters of a meter."""
VIEW_HEIGHT = 0.85
"""Height of a view [in]."""
GAIT_HEIGHT = 1.5
"""Height of the panels of the gaits [in]."""
MARGINS = 1.0
"""Height of titles and labels [in]."""
SMALL: Any = {"fontsize": style.TICK - 1.0, "ha": "center"}
"""Look of the numbers beside modules."""
NUMBER_HEIGHT = 0.15
"""Height of such a number, rather too large [in]."""
MARGIN = 1.24
"""Height of a view by the width of the largest robot, at least [-]."""
GAP = 4.0
"""Distance of the numbers from modules [mm]."""


@dataclass(frozen=True)
class Piece:
    """A part of a robot in one view, from tail to head [mm]."""

    begin: float
    length: float
    width: float


def draw_design_sheet(before: Scenario, after: Scenario, note: str = "") -> Figure:
    """Draw a design beside what it was made of.

    Args:
        before: Scenario with which the search began.
        after: Scenario of the design.
        note: Lines below the title.
    """
    height = 4.0 * VIEW_HEIGHT + GAIT_HEIGHT + MARGINS
    figure = new_figure(style.DOUBLE_COLUMN, height)
    rows = figure.add_gridspec(5, 2, height_ratios=[*[VIEW_HEIGHT] * 4, GAIT_HEIGHT])
    extent = _find_extent([before.robot, after.robot])
    views: list[Axes] = []
    for row, (scenario, color) in enumerate(((before, style.GRAY), (after, style.BLUE))):
        side = figure.add_subplot(rows[2 * row, :])
        plan = figure.add_subplot(rows[2 * row + 1, :])
        robot = scenario.robot
        _draw_view(side, side_view(robot), extent, color, f"{robot.name}: side view")
        _draw_view(plan, plan_view(robot), extent, color, f"{robot.name}: plan view")
        _write_numbers(plan, robot)
        views += [side, plan]
    for view in views[:-1]:
        view.tick_params(labelbottom=False)
    tail = "the tail"
    if before.robot.caudal_fin is not None and after.robot.caudal_fin is not None:
        tail = "the trailing edge of the fin"
    views[-1].set_xlabel(f"from {tail} toward the head [mm]", fontsize=style.LABEL)
    amplitude = figure.add_subplot(rows[4, 0])
    phase = figure.add_subplot(rows[4, 1])
    _draw_gaits([before, after], amplitude, phase)
    style.add_title(
        figure, f"Design of {after.robot.name}, with lengths in mm and masses in kg", note
    )
    return figure


def write_design_sheet(before: Scenario, after: Scenario, path: str | Path, note: str = "") -> None:
    """Write `draw_design_sheet` to a file.

    Args:
        before: Scenario with which the search began.
        after: Scenario of the design.
        path: Path of the picture; an existing file is replaced.
        note: Lines below the title.
    """
    save_figure(draw_design_sheet(before, after, note), path)


def side_view(robot: Robot) -> list[Piece]:
    """Return the parts of a robot as they are seen from the side, from tail to head.

    Args:
        robot: The robot.
    """
    heights = [2.0 * module.section.half_height for module in robot.modules]
    fin = robot.caudal_fin
    return _pieces(robot, heights, 0.0 if fin is None else fin.height)


def plan_view(robot: Robot) -> list[Piece]:
    """Return the parts of a robot as they are seen from above, from tail to head.

    Args:
        robot: The robot.
    """
    widths = [2.0 * module.section.half_width for module in robot.modules]
    fin = robot.caudal_fin
    return _pieces(robot, widths, 0.0 if fin is None else fin.thickness)


def _pieces(robot: Robot, widths: Sequence[float], fin_width: float) -> list[Piece]:
    """Return the fin, if there is one, and the modules."""
    pieces: list[Piece] = []
    begin = 0.0
    fin = robot.caudal_fin
    if fin is not None:
        stem = fin.opening_length if fin.opening == "open" else 0.0
        blade = MILLIMETERS * (fin.length - stem)
        pieces.append(Piece(0.0, blade, MILLIMETERS * fin_width))
        begin = MILLIMETERS * fin.length
    for module, width in zip(robot.modules, widths, strict=True):
        length = MILLIMETERS * module.length
        pieces.append(Piece(begin, length, MILLIMETERS * width))
        begin += length
    return pieces


class _Extent(NamedTuple):
    """What all views need."""

    length: float
    """Length along the body [mm]."""
    width: float
    """Width across it [mm]."""
    half_height: float
    """Half the height of a view, with room for the numbers [mm]."""


def _find_extent(robots: Sequence[Robot]) -> _Extent:
    """Return the extent of the largest views."""
    side_pieces: list[Piece] = []
    plan_pieces: list[Piece] = []
    for robot in robots:
        side_pieces += side_view(robot)
        plan_pieces += plan_view(robot)
    pieces = [*side_pieces, *plan_pieces]
    length = max(piece.begin + piece.length for piece in pieces)
    width = max(piece.width for piece in pieces)
    plan_width = max(piece.width for piece in plan_pieces)
    scale = max(length / style.DOUBLE_COLUMN, MARGIN * width / VIEW_HEIGHT)
    with_numbers = 0.5 * plan_width + GAP + NUMBER_HEIGHT * scale
    return _Extent(length, width, half_height=max(0.5 * MARGIN * width, with_numbers))


def _draw_view(ax: Axes, pieces: Sequence[Piece], extent: _Extent, color: str, title: str) -> None:
    """Draw one view, true to scale."""
    for piece in pieces:
        corner = (piece.begin, -0.5 * piece.width)
        ax.add_patch(
            Rectangle(
                corner,
                piece.length,
                piece.width,
                facecolor=color,
                edgecolor="white",
                linewidth=style.LINE,
                alpha=0.85,
            )
        )
    length, width, half_height = extent
    ax.set_xlim(-0.01 * length, 1.01 * length)
    ax.set_ylim(-half_height, half_height)
    ax.set_aspect("equal", anchor="W")
    style.style_axes(ax, xlabel="", ylabel="[mm]")
    ax.set_yticks(
        [-0.5 * width, 0.0, 0.5 * width], [f"{-0.5 * width:.0f}", "0", f"{0.5 * width:.0f}"]
    )
    ax.text(1.0, 1.0, title, transform=ax.transAxes, ha="right", va="bottom", fontsize=style.TICK)


def _write_numbers(ax: Axes, robot: Robot) -> None:
    """Write the length of every module above its plan view, and its mass below."""
    pieces = plan_view(robot)[-robot.n_links :]
    for piece, module in zip(pieces, robot.modules, strict=True):
        middle = piece.begin + 0.5 * piece.length
        above = 0.5 * piece.width + GAP
        ax.text(middle, above, f"{piece.length:.0f}", va="bottom", **SMALL)
        ax.text(middle, -above, f"{module.mass:.2f}", va="top", **SMALL)


def _draw_gaits(scenarios: Sequence[Scenario], amplitude: Axes, phase: Axes) -> None:
    """Draw amplitude and phase of every joint in both gaits."""
    colors = (style.GRAY, style.BLUE)
    for scenario, color in zip(scenarios, colors, strict=True):
        gait = scenario.gait
        n_links = scenario.robot.planar().n_links
        joints = np.arange(n_links - 1)
        amplitudes = gait.amplitude * np.array(gait.joint_envelope(n_links))
        leads = np.array(gait.joint_phases(n_links))
        frequency = gait.frequency / (2.0 * np.pi)
        label = f"{scenario.robot.name}, {frequency:.2f} Hz"
        _plot(amplitude, joints, np.degrees(amplitudes), color, label)
        _plot(phase, joints, np.degrees(gait.phase_shift * joints + leads), color, label)
    style.style_axes(amplitude, xlabel="joint, from the tail", ylabel="amplitude [deg]")
    style.style_axes(phase, xlabel="joint, from the tail", ylabel="phase [deg]")
    amplitude.set_ylim(bottom=0.0)
    amplitude.legend(**style.LEGEND)


def _plot(
    ax: Axes, joints: np.ndarray, values: Float[np.ndarray, " n_joints"], color: str, label: str
) -> None:
    ax.plot(
        joints, values, color=color, marker="o", markersize=3, linewidth=style.LINE, label=label
    )
