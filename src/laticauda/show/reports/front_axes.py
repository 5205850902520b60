"""Fronts of an optimization on axes: curves, letters at the marked points, and measured gaits."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

import laticauda as lc
from laticauda.show.figures import style
from laticauda.studies import LABELS, Front
from laticauda.trials import MeasuredTrial, all_measured

N_MARKED_POINTS = 5
"""Points of a front whose gaits are drawn [-]."""
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
"""Letters of the marked points, of all fronts in turn."""


class FrontMark(NamedTuple):
    """Color and marker of a front, whose points differ in shape as well."""

    color: str
    """Color."""
    marker: str
    """Marker, as in matplotlib."""


FRONT_MARKS = (
    FrontMark(color=style.BLUE, marker="o"),
    FrontMark(color=style.ORANGE, marker="s"),
)
MARK_SIZE = 4.0
"""Size of a marked point [pt]."""
LETTER_DISTANCE = 8.0
"""Distance from the point to its letter, in either direction [pt]."""
LETTER_STYLE: Any = {"fontsize": 6.5, "color": "white", "ha": "center", "va": "center"}
MEASURED_STYLE: Any = {
    "linestyle": "",
    "marker": "D",
    "markersize": 4.0,
    "markerfacecolor": "white",
}
SPACE_FOR_LETTERS = 0.04
"""Space for letters next to the first point, as a fraction of the axis [-]."""
END_OF_AXIS = 1.06
"""End of an axis, as a multiple of the farthest point [-]."""


class Curve(NamedTuple):
    """The objectives of a front's points, in ascending order of the last one."""

    x: Float[np.ndarray, " n_points"]
    """Last objective [SI]."""
    y: Float[np.ndarray, " n_points"]
    """First objective [SI]."""


class Direction(NamedTuple):
    """A diagonal direction on the axes."""

    x: int
    """1: to the right, -1: to the left [-]."""
    y: int
    """1: up, -1: down [-]."""


def choose_marked_points(front: Front) -> list[int]:
    """Return the points whose gaits are drawn, without the slowest end, where nobody swims and all fronts meet.

    Args:
        front: Result of `optimize`.
    """
    return front.spread(N_MARKED_POINTS + 1)[1:]


def simulate_measured_gaits(front: Front) -> np.ndarray:
    """Return the objectives of the measured gaits of this kind with this robot, by row: last objective, first one.

    Args:
        front: Result of `optimize`.
    """
    gaits = [trial.gait for trial in _list_measured_trials(front)]
    if not gaits:
        return np.empty((0, 2))
    scenario = front.optimization.scenario
    swims = lc.swim_many(
        [replace(scenario, motion=gait) for gait in gaits],
        load_figures=front.optimization.needs_loads,
    )
    first, last = front.optimization.objectives
    points = np.stack((getattr(swims, last), getattr(swims, first)), axis=1)
    is_finite = np.isfinite(points).all(axis=1)
    return points[is_finite]


def _list_measured_trials(front: Front) -> list[MeasuredTrial]:
    """Return the published trials of this robot with this kind of gait."""
    scenario = front.optimization.scenario
    trials: list[MeasuredTrial] = []
    for measured in all_measured():
        for trial in measured.trials():
            if trial.gait.kind == scenario.gait.kind and trial.robot == scenario.robot.name:
                trials.append(trial)
    return trials


def draw_fronts(fronts: Sequence[Front], ax: Axes) -> Axes:
    """Draw one or two fronts, with letters at the marked points, together with the measured gaits.

    Args:
        fronts: Fronts with the same two objectives.
        ax: Axes to draw on.
    """
    curves = [_curve_of(front) for front in fronts]
    measured_points = [simulate_measured_gaits(front) for front in fronts]
    n_letters = 0
    for number, front in enumerate(fronts):
        curve = curves[number]
        mark = FRONT_MARKS[number]
        label = front.optimization.scenario.gait.words
        ax.plot(curve.x, curve.y, color=mark.color, linewidth=1.6, label=label, zorder=3)
        ax.plot(*measured_points[number].T, color=mark.color, **MEASURED_STYLE, zorder=4)
        direction = _direction_of_letters(curve, curves)
        for point in choose_marked_points(front):
            position = (float(curve.x[point]), float(curve.y[point]))
            _mark_point(ax, position, LETTERS[n_letters], mark=mark, direction=direction)
            n_letters += 1
    if any(len(points) for points in measured_points):
        _add_measured_label(ax, fronts[0])
    _set_limits(ax, curves, measured_points)
    ax.xaxis.set_major_locator(MaxNLocator(6))
    ax.yaxis.set_major_locator(MaxNLocator(6))
    style.add_legend(ax, loc="lower right")
    first, last = fronts[0].optimization.objectives
    return style.style_axes(ax, xlabel=LABELS[last], ylabel=LABELS[first])


def _curve_of(front: Front) -> Curve:
    first, last = front.optimization.objectives
    return Curve(x=front.figures[last], y=front.figures[first])


def _mark_point(
    ax: Axes,
    position: tuple[float, float],
    letter: str,
    *,
    mark: FrontMark,
    direction: Direction,
) -> None:
    """Draw a marked point, with its letter in a circle beside it."""
    ax.plot(*position, mark.marker, color=mark.color, markersize=MARK_SIZE, clip_on=False, zorder=5)
    circle = {
        "boxstyle": "circle,pad=0.25",
        "facecolor": mark.color,
        "edgecolor": "white",
        "linewidth": 0.5,
    }
    shift = (direction.x * LETTER_DISTANCE, direction.y * LETTER_DISTANCE)
    style.add_note(ax, letter, position, shift, bbox=circle, zorder=6, **LETTER_STYLE)


def _add_measured_label(ax: Axes, front: Front) -> None:
    """Add a label for the measured gaits to the legend."""
    trials = _list_measured_trials(front)
    sources = " and ".join(dict.fromkeys(trial.source for trial in trials))
    label = f"{sources}'s gaits, simulated alike"
    ax.plot([], [], color=style.GRAY, **MEASURED_STYLE, label=label)


def _set_limits(ax: Axes, curves: Sequence[Curve], measured_points: Sequence[np.ndarray]) -> None:
    """Set the limits of the axes, so that all points and the letters of the first ones are within."""
    x_parts = [curve.x for curve in curves]
    y_parts = [curve.y for curve in curves]
    for points in measured_points:
        x_parts.append(points[:, 0])
        y_parts.append(points[:, 1])
    xs = np.concatenate(x_parts)
    ys = np.concatenate(y_parts)
    left = min(0.0, float(xs.min())) - SPACE_FOR_LETTERS * float(np.ptp(xs))
    ax.set_xlim(left, END_OF_AXIS * float(xs.max()))
    ax.set_ylim(min(0.0, float(ys.min())), END_OF_AXIS * float(ys.max()))


def _direction_of_letters(curve: Curve, curves: Sequence[Curve]) -> Direction:
    """Return the direction away from a front: towards better points, or worse ones if another front lies there."""
    is_rising = (float(curve.y[-1]) - float(curve.y[0])) >= 0.0
    better = Direction(x=-1, y=1)
    if not is_rising:
        better = Direction(x=-1, y=-1)
    middle = float(np.median(curve.x))
    height = float(np.interp(middle, curve.x, curve.y))
    for neighbor in curves:
        if neighbor is curve:
            continue
        neighbor_height = float(np.interp(middle, neighbor.x, neighbor.y))
        is_on_better_side = neighbor_height < height
        if is_rising:
            is_on_better_side = neighbor_height > height
        if is_on_better_side:
            return Direction(x=-better.x, y=-better.y)
    return better
