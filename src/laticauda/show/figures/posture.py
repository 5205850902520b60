"""Postures of the body, drawn true to scale and seen from above, and which of a run's are drawn."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb

from laticauda.robot import CaudalFin, Posture, Robot
from laticauda.show.figures import style
from laticauda.trials import Trial

Point = Float[np.ndarray, " 2"]
Points = Float[np.ndarray, "n_points 2"]

NOSE_LENGTH = 2.0
"""Length of the pointed front, in half widths of the head."""
HINGE_RADIUS = 0.22
"""Radius of the mark of a joint, in half widths of the narrowest module."""
MOST_POSTURES = 9
"""Number of postures along a path at most."""
BODY_MARGIN = 1.06
"""Length of path that a posture takes, in lengths of the body with its fin."""
CLEARANCE = 2.5
"""Distance at which two postures count as apart, in half widths of the widest module."""
OLDEST_WHITENESS = 0.65
"""Fraction of white in the oldest posture."""
OPENING_WIDTH = 0.8
"""Width of the line of a fin's opening [pt]."""
PLATE_WIDTH = 2.2
"""Width of the line of a fin's plate [pt]."""
_CIRCLE_ANGLES = np.linspace(0.0, 2.0 * np.pi, 25)
_NOSE_ANGLES = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 13)


def outline(robot: Robot, trial: Trial, sample: int) -> Points:
    """Return trailing edge, fin hinges, tail end, joints and head end of the body at a sample, in this order [m].

    Args:
        robot: The robot of the trial, in the plane.
        trial: The trial.
        sample: Number of the sample.
    """
    return posture_outline(
        robot, trial.center_of_mass[sample, :2], trial.link_angle[sample], trial.fin_angle[sample]
    )


def posture_outline(
    robot: Robot, center: Point, angle: np.ndarray, fin_angle: np.ndarray | None = None
) -> Points:
    """Return the `outline` of a center of mass [m] and link angles [rad]; without fin angles, the fin is straight."""
    posture = Posture(robot, center, angle, fin_angle)
    return np.vstack((posture.fin_line[:-1], posture.link_ends))


def choose_instants(trial: Trial) -> list[int]:
    """Return the samples at which to draw the body: first, last, and as many in between as fit without overlap."""
    last = trial.time.size - 1
    n_lengths = _body_lengths(trial)
    if is_crowded(trial):
        return [0, last] if n_lengths > 0.1 else [last]
    n_steps = min(int(n_lengths), MOST_POSTURES - 1)
    start = float(trial.time[0])
    step = float(trial.time[-1] - trial.time[0]) / n_steps
    moments = [_round_time(start + step * k, step) for k in range(1, n_steps)]
    samples = {0, last}
    for moment in moments:
        samples.add(int(np.argmin(np.abs(trial.time - moment))))
    return _keep_apart(trial, sorted(samples))


def _round_time(moment: float, step: float) -> float:
    """Return a moment between two postures as a time that is easily read, at most an eighth of a step away [s]."""
    grain = 10.0 ** math.floor(math.log10(0.25 * step))
    return grain * round(moment / grain)


def is_crowded(trial: Trial) -> bool:
    """Return whether the robot swam so short a distance that its first and last postures overlap."""
    return _body_lengths(trial) < 1.0


def _body_lengths(trial: Trial) -> float:
    """Return the length of the path in lengths of the body with its fin, including a small margin."""
    steps = np.diff(trial.center_of_mass[:, :2], axis=0)
    return float(np.sum(np.linalg.norm(steps, axis=1))) / (BODY_MARGIN * trial.chain.reach)


def _keep_apart(trial: Trial, samples: list[int]) -> list[int]:
    """Return the samples whose bodies stay clear of all later ones; the last is always kept."""
    robot = trial.chain
    clearance = CLEARANCE * max(module.section.half_width for module in robot.modules)
    clear_samples: list[int] = []
    bodies: list[Points] = []
    for sample in reversed(samples):
        body = outline(robot, trial, sample)
        if all(_distance(body, later_body) > clearance for later_body in bodies):
            clear_samples.append(sample)
            bodies.append(body)
    return clear_samples[::-1]


def _distance(points: Points, other_points: Points) -> float:
    """Return the smallest distance between two sets of points [m]."""
    return float(np.linalg.norm(points[:, np.newaxis] - other_points, axis=2).min())


@dataclass(frozen=True)
class _Shapes:
    """Polygons of one color."""

    polygons: list[Points]
    color: Any
    order: float
    """Shapes of higher order cover those of lower."""


def draw_posture(ax: Axes, robot: Robot, points: Points, age: float) -> None:
    """Draw one posture.

    Args:
        ax: Axes to draw on.
        robot: Robot whose body is drawn.
        points: `outline` of the body [m].
        age: Age, from 0, the newest and darkest, to 1 [-].
    """
    order = 3.0 - age
    ends = points[-robot.n_links - 1 :]
    if robot.caudal_fin is not None:
        _draw_fin(ax, robot.caudal_fin, points[: -robot.n_links][::-1], age)
    widths = [module.section.half_width for module in robot.modules]
    head = _head_polygon(ends[-2], ends[-1], widths[-1])
    links: list[Points] = []
    bends: list[Points] = []
    hinges: list[Points] = []
    for i in range(robot.n_links - 1):
        joint = ends[i + 1]
        links.append(_link_polygon(ends[i], joint, widths[i]))
        bends.append(_circle(joint, min(widths[i], widths[i + 1])))
        hinges.append(_circle(joint, HINGE_RADIUS * min(widths)))
    for shapes in (
        _Shapes([*links, *bends], _fade(style.BLUE, age), order),
        _Shapes([head], _fade(style.AMBER, age), order),
        _Shapes(hinges, "white", order + 0.01),
    ):
        collection = PolyCollection(
            shapes.polygons, facecolor=shapes.color, edgecolor="none", zorder=shapes.order
        )
        ax.add_collection(collection)


def _draw_fin(ax: Axes, fin: CaudalFin, line: Points, age: float) -> None:
    """Draw the fin, a plate a few millimeters thick seen edge-on, as a line that is thinner at its opening."""
    opening_length = 0.0 if fin.opening == "closed" else fin.opening_length
    positions = [0.0, *(piece.end for piece in fin.pieces)]  # of the line's points along the fin
    plate_begin = np.array(
        [np.interp(opening_length, positions, line[:, axis]) for axis in range(2)]
    )
    k = int(np.searchsorted(positions, opening_length, side="right"))
    opening_line = np.vstack((line[:k], plate_begin))
    plate_line = np.vstack((plate_begin, line[k:]))
    lines = LineCollection([opening_line, plate_line], zorder=3.0 - age)
    lines.set(linewidth=[OPENING_WIDTH, PLATE_WIDTH], color=_fade(style.INK, age), capstyle="butt")
    ax.add_collection(lines)


def _link_polygon(tail: Point, head: Point, half_width: float) -> Points:
    """Return a rectangle around the line between the two ends of a link."""
    side = half_width * _normal(tail, head)
    return np.stack((tail + side, head + side, head - side, tail - side))


def _head_polygon(tail: Point, head: Point, half_width: float) -> Points:
    """Return the foremost link, with a pointed front that shows the swimming direction."""
    length = float(np.linalg.norm(head - tail))
    nose_length = min(NOSE_LENGTH * half_width, length)
    along = (head - tail) / length
    side = _normal(tail, head)
    front = tail + (length - nose_length) * along
    tip = (
        front
        + nose_length * np.cos(_NOSE_ANGLES)[:, np.newaxis] * along
        + half_width * np.sin(_NOSE_ANGLES)[:, np.newaxis] * side
    )
    return np.vstack((tail - half_width * side, tip, tail + half_width * side))


def _circle(center: Point, radius: float) -> Points:
    return center + radius * np.stack((np.cos(_CIRCLE_ANGLES), np.sin(_CIRCLE_ANGLES)), axis=1)


def _normal(tail: Point, head: Point) -> Point:
    along = (head - tail) / np.linalg.norm(head - tail)
    return np.array([-along[1], along[0]])


def _fade(color: str, age: float) -> tuple[float, float, float]:
    """Return a color, whiter with increasing age."""
    remaining = 1.0 - OLDEST_WHITENESS * age
    red, green, blue = to_rgb(color)
    return (
        1.0 - (1.0 - red) * remaining,
        1.0 - (1.0 - green) * remaining,
        1.0 - (1.0 - blue) * remaining,
    )
