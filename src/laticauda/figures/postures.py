"""The body seen from above: polygons with the real lengths and widths, to be drawn along a path."""

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb

from laticauda.figures import style
from laticauda.kinematics import fin_line, link_ends
from laticauda.robot import CaudalFin, Robot
from laticauda.trial import Trial

Point = Float[np.ndarray, " 2"]
Points = Float[np.ndarray, "n_points 2"]

_ROUND = np.linspace(0.0, 2.0 * np.pi, 25)
_NOSE = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 13)
NOSE = 2.0  # length of the pointed front, in half widths
MOST = 9  # postures along a path
FADED = 0.65  # how much white is in the oldest posture


def planar_body(trial: Trial) -> Robot:
    """The robot whose links the columns of `link_angle` are."""
    return trial.robot if trial.center_of_mass.shape[1] == 3 else trial.robot.planar()


def outline(robot: Robot, trial: Trial, sample: int) -> Points:
    """Trailing edge, hinges of the fin, tail end, joints and head end of the body at a sample, in this order [m]."""
    return posture(robot, trial.center_of_mass[sample, :2], trial.link_angle[sample], trial.fin_angle[sample])


def posture(robot: Robot, center: Point, angle: np.ndarray, fin_angle: np.ndarray | None = None) -> Points:
    """The same of a center of mass [m] and link angles [rad]; without angles of the fin it is straight."""
    fin = fin_line(robot, center, angle, fin_angle=fin_angle)
    return np.vstack((fin[:-1], link_ends(robot, center, angle, fin_angle=fin_angle)))


def instants(trial: Trial) -> list[int]:
    """Samples at which to draw the body: first, last, and as many between as fit without lying on each other."""
    last = trial.time.size - 1
    lengths = _body_lengths(trial)
    if is_crowded(trial):
        return [0, last] if lengths > 0.1 else [last]
    n_steps = min(int(lengths), MOST - 1)
    first, duration = float(trial.time[0]), float(trial.time[-1] - trial.time[0])
    moments = [first + duration * k / n_steps for k in range(n_steps + 1)]
    return _apart(trial, sorted({int(np.argmin(np.abs(trial.time - moment))) for moment in moments}))


def is_crowded(trial: Trial) -> bool:
    """Whether the robot swam so short a way that its first and its last posture lie on each other."""
    return _body_lengths(trial) < 1.0


def _body_lengths(trial: Trial) -> float:
    """Length of the path in lengths of the body with its fin, and a little room."""
    robot = planar_body(trial)
    reach = robot.length + (robot.caudal_fin.length if robot.caudal_fin else 0.0)
    steps = np.diff(trial.center_of_mass[:, :2], axis=0)
    return float(np.sum(np.linalg.norm(steps, axis=1))) / (1.06 * reach)


def _apart(trial: Trial, samples: list[int]) -> list[int]:
    """Those samples whose bodies stay clear of all later ones; the last is always kept."""
    robot = planar_body(trial)
    clearance = 2.5 * max(module.section.half_width for module in robot.modules)
    kept: list[int] = []
    bodies: list[Points] = []
    for sample in reversed(samples):
        body = outline(robot, trial, sample)
        gaps = (np.linalg.norm(body[:, np.newaxis] - other, axis=2).min() for other in bodies)
        if all(gap > clearance for gap in gaps):
            kept.append(sample)
            bodies.append(body)
    return kept[::-1]


def draw_posture(ax: Axes, robot: Robot, points: Points, age: float) -> None:
    """Draw one posture.

    Args:
        ax: Where.
        robot: Whose body it is.
        points: Its `outline` [m].
        age: From 0, the newest and darkest, to 1 [-].
    """
    order = 3.0 - age
    ends = points[-robot.n_links - 1 :]
    if robot.caudal_fin is not None:
        _draw_fin(ax, robot.caudal_fin, points[: -robot.n_links][::-1], age)
    widths = [module.section.half_width for module in robot.modules]
    links = [_link(ends[i], ends[i + 1], width) for i, width in enumerate(widths[:-1])]
    bends = [_circle(ends[i + 1], min(widths[i], widths[i + 1])) for i in range(len(widths) - 1)]
    body = PolyCollection([*links, *bends], facecolor=_faded(style.BLUE, age), edgecolor="none", zorder=order)
    head = PolyCollection(
        [_head(ends[-2], ends[-1], widths[-1])], facecolor=_faded(style.AMBER, age), edgecolor="none", zorder=order
    )
    ax.add_collection(body)
    ax.add_collection(head)
    hinges = [_circle(end, 0.22 * min(widths)) for end in ends[1:-1]]
    ax.add_collection(PolyCollection(hinges, facecolor="white", edgecolor="none", zorder=order + 0.01))


def _draw_fin(ax: Axes, fin: CaudalFin, line: Points, age: float) -> None:
    """The fin is a plate of some millimeters, seen from its edge: a line, thinner where its opening is."""
    opening = 0.0 if fin.opening == "closed" else fin.opening_length
    behind = [0.0, *(piece.end for piece in fin.pieces)]  # of the line's points, along the fin
    inner = np.array([np.interp(opening, behind, line[:, axis]) for axis in range(2)])
    k = int(np.searchsorted(behind, opening, side="right"))
    lines = LineCollection([np.vstack((line[:k], inner)), np.vstack((inner, line[k:]))], zorder=3.0 - age)
    lines.set(linewidth=[0.8, 2.2], color=_faded(style.INK, age), capstyle="butt")
    ax.add_collection(lines)


def _link(tail: Point, head: Point, half_width: float) -> Points:
    """A rectangle around the line between the two ends of a link."""
    side = half_width * _normal(tail, head)
    return np.stack((tail + side, head + side, head - side, tail - side))


def _head(tail: Point, head: Point, half_width: float) -> Points:
    """The foremost link, with a pointed front so that one sees where it swims."""
    length = float(np.linalg.norm(head - tail))
    nose = min(NOSE * half_width, length)
    along, side = (head - tail) / length, _normal(tail, head)
    front = tail + (length - nose) * along
    tip = front + nose * np.cos(_NOSE)[:, np.newaxis] * along + half_width * np.sin(_NOSE)[:, np.newaxis] * side
    return np.vstack((tail - half_width * side, tip, tail + half_width * side))


def _circle(center: Point, radius: float) -> Points:
    return center + radius * np.stack((np.cos(_ROUND), np.sin(_ROUND)), axis=1)


def _normal(tail: Point, head: Point) -> Point:
    along = (head - tail) / np.linalg.norm(head - tail)
    return np.array([-along[1], along[0]])


def _faded(color: str, age: float) -> tuple[float, float, float]:
    """A color, the whiter the older."""
    red, green, blue = (1.0 - (1.0 - part) * (1.0 - FADED * age) for part in to_rgb(color))
    return red, green, blue
