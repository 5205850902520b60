"""Path of a run, with the postures of the body drawn along it, and the water under it.

The water is shown as the arrow of a current, or as the field of a flow at one time.
"""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.image import AxesImage
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D, ScaledTranslation, Transform, blended_transform_factory

from laticauda.figures import style
from laticauda.fluid.arrows import arrows_of, grid_points, has_waves, surface_elevation
from laticauda.kinematics import Posture
from laticauda.robot import CaudalFin, Robot, Water
from laticauda.trial import Trial

Point = Float[np.ndarray, " 2"]
Points = Float[np.ndarray, "n_points 2"]

MARGIN = 0.05  # around the path, for the times beside the postures, as a fraction of its extent [-]
NOSE = 2.0  # length of the pointed front, in half widths
MOST = 9  # largest number of postures along a path
FADED = 0.65  # fraction of white in the oldest posture
_ROUND = np.linspace(0.0, 2.0 * np.pi, 25)
_NOSE = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 13)

ROW = 9.0  # height of the text above the upper right corner [pt]
BAR = 0.09  # width of the color bar [in]
LEAST = 0.1  # smallest extent that is shown along x and y [m]
PIXELS = 240  # of the shading, along its longer side
# Pale, so that arrows and bodies stand out: from white, and from one color to another through
# white.
SPEED = LinearSegmentedColormap.from_list("speed", ["#FFFFFF", "#CFE3F1", "#8DBBDC"])
HEIGHT = LinearSegmentedColormap.from_list("height", ["#8DBBDC", "#FFFFFF", "#EFC9A8"])


def path_strip(trial: Trial, ax: Axes | None = None) -> Axes:
    """Plot the path of the center of mass, with the body along it like a film strip, older postures lighter.

    The body has its real lengths and widths; the head is orange and pointed, a fin is a dark line
    at the tail.

    Args:
        trial: Any trial, including a failed one.
        ax: Axes to draw on; None: those of a new figure, `ax.figure`.
    """
    ax = ax or style.new_figure(style.DOUBLE_COLUMN, 3.0).add_subplot()
    robot = trial.chain
    half_width = max(module.section.half_width for module in robot.modules)
    samples = choose_instants(trial)
    for k, sample in enumerate(samples):
        points = outline(robot, trial, sample)
        age = (len(samples) - 1 - k) / max(len(samples) - 1, 1)
        draw_posture(ax, robot, points, age)
        _tell_time(ax, trial, points, sample, half_width)
    x, y = trial.center_of_mass[:, 0], trial.center_of_mass[:, 1]
    ax.plot(x, y, color=style.INK, linewidth=0.8, zorder=4, label="center of mass")
    ax.plot(x[:1], y[:1], color=style.INK, marker="o", markersize=3, zorder=4)
    moving = draw_water(trial, ax)
    ax.set_aspect("equal", adjustable="box" if moving else "datalim")
    return style.style_axes(ax, xlabel="x [m]", ylabel="y [m]")


def path_extent(trial: Trial) -> tuple[float, float]:
    """Return the width and height of path and postures, with space for the times [m]."""
    robot = trial.chain
    bodies = [outline(robot, trial, sample) for sample in choose_instants(trial)]
    width, height = np.ptp(np.vstack([*bodies, trial.center_of_mass[:, :2]]), axis=0)
    room = 2.0 * MARGIN * max(width, height)
    return float(width + room), float(height + room)


def _tell_time(ax: Axes, trial: Trial, points: Points, sample: int, half_width: float) -> None:
    """Add the time beside a posture: to its left, or on the outer side of a curved path; else on the free side."""
    path = trial.center_of_mass[:, :2]
    center, heading = path[sample], float(trial.heading[sample])
    ahead, left = (
        np.array([np.cos(heading), np.sin(heading)]),
        np.array([-np.sin(heading), np.cos(heading)]),
    )
    if is_crowded(trial):  # the bodies overlap: behind the first, and ahead of the last
        side = ahead if sample else -ahead
        place = points[-1] if sample else points[0]
    else:
        is_straight = trial.path_speed < 1.25 * trial.forward_velocity
        outward = center - 0.5 * (path.min(axis=0) + path.max(axis=0))
        side = left if is_straight or left @ outward > 0.0 else -left
        near = points[np.abs((points - center) @ ahead) < 0.25 * np.ptp(points @ ahead)]
        text = MARGIN * max(path_extent(trial))  # about as wide as the text
        places = [(to, _beside(center, near, to, half_width)) for to in (side, -side)]
        gaps = [
            float(np.linalg.norm(path - (at + 0.5 * text * to), axis=1).min()) for to, at in places
        ]
        side, place = next(
            (one for one, gap in zip(places, gaps, strict=True) if gap > 0.7 * text), places[0]
        )
    style.add_note(
        ax,
        f"{trial.time[sample]:.3g} s",
        (float(place[0]), float(place[1])),
        (3.0 * float(side[0]), 3.0 * float(side[1])),
        ha="left" if side[0] > 0.5 else "right" if side[0] < -0.5 else "center",
        va="bottom" if side[1] > 0.5 else "top" if side[1] < -0.5 else "center",
        color=style.INK,
        path_effects=[withStroke(linewidth=2.0, foreground="white")],
        zorder=5,
    )
    # The limits of axes ignore texts; this point reserves space for it.
    room = MARGIN * max(path_extent(trial)) * (1.0 + 1.5 * abs(side[0]))
    ax.update_datalim([tuple(place + room * side)])


def _beside(center: Point, points: Points, side: Point, half_width: float) -> Point:
    """Return the point just off the body on one side of it."""
    return center + (np.max((points - center) @ side, initial=0.0) + half_width) * side


# ---- postures ------------------------------------------------------------------------------------


def outline(robot: Robot, trial: Trial, sample: int) -> Points:
    """Return trailing edge, fin hinges, tail end, joints and head end of the body at a sample, in this order [m]."""
    return posture_outline(
        robot, trial.center_of_mass[sample, :2], trial.link_angle[sample], trial.fin_angle[sample]
    )


def posture_outline(
    robot: Robot, center: Point, angle: np.ndarray, fin_angle: np.ndarray | None = None
) -> Points:
    """Return the `outline` of a center of mass [m] and link angles [rad]; without fin angles, the fin is straight."""
    bent = Posture(robot, center, angle, fin_angle)
    return np.vstack((bent.fin_line[:-1], bent.link_ends))


def choose_instants(trial: Trial) -> list[int]:
    """Return the samples at which to draw the body: first, last, and as many in between as fit without overlap."""
    last = trial.time.size - 1
    lengths = _body_lengths(trial)
    if is_crowded(trial):
        return [0, last] if lengths > 0.1 else [last]
    n_steps = min(int(lengths), MOST - 1)
    first, duration = float(trial.time[0]), float(trial.time[-1] - trial.time[0])
    moments = [first + duration * k / n_steps for k in range(n_steps + 1)]
    return _apart(
        trial, sorted({int(np.argmin(np.abs(trial.time - moment))) for moment in moments})
    )


def is_crowded(trial: Trial) -> bool:
    """Return whether the robot swam so short a distance that its first and last postures overlap."""
    return _body_lengths(trial) < 1.0


def _body_lengths(trial: Trial) -> float:
    """Return the length of the path in lengths of the body with its fin, including a small margin."""
    steps = np.diff(trial.center_of_mass[:, :2], axis=0)
    return float(np.sum(np.linalg.norm(steps, axis=1))) / (1.06 * trial.chain.reach)


def _apart(trial: Trial, samples: list[int]) -> list[int]:
    """Return the samples whose bodies stay clear of all later ones; the last is always kept."""
    robot = trial.chain
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
    links = [_link(ends[i], ends[i + 1], width) for i, width in enumerate(widths[:-1])]
    bends = [_circle(ends[i + 1], min(widths[i], widths[i + 1])) for i in range(len(widths) - 1)]
    hinges = [_circle(end, 0.22 * min(widths)) for end in ends[1:-1]]
    for polygons, color, place in (
        ([*links, *bends], _faded(style.BLUE, age), order),
        ([_head(ends[-2], ends[-1], widths[-1])], _faded(style.AMBER, age), order),
        (hinges, "white", order + 0.01),
    ):
        ax.add_collection(PolyCollection(polygons, facecolor=color, edgecolor="none", zorder=place))


def _draw_fin(ax: Axes, fin: CaudalFin, line: Points, age: float) -> None:
    """Draw the fin, a plate a few millimeters thick seen edge-on, as a line that is thinner at its opening."""
    opening = 0.0 if fin.opening == "closed" else fin.opening_length
    behind = [
        0.0,
        *(piece.end for piece in fin.pieces),
    ]  # positions of the line's points along the fin
    inner = np.array([np.interp(opening, behind, line[:, axis]) for axis in range(2)])
    k = int(np.searchsorted(behind, opening, side="right"))
    lines = LineCollection(
        [np.vstack((line[:k], inner)), np.vstack((inner, line[k:]))], zorder=3.0 - age
    )
    lines.set(linewidth=[0.8, 2.2], color=_faded(style.INK, age), capstyle="butt")
    ax.add_collection(lines)


def _link(tail: Point, head: Point, half_width: float) -> Points:
    """Return a rectangle around the line between the two ends of a link."""
    side = half_width * _normal(tail, head)
    return np.stack((tail + side, head + side, head - side, tail - side))


def _head(tail: Point, head: Point, half_width: float) -> Points:
    """Return the foremost link, with a pointed front that shows the swimming direction."""
    length = float(np.linalg.norm(head - tail))
    nose = min(NOSE * half_width, length)
    along, side = (head - tail) / length, _normal(tail, head)
    front = tail + (length - nose) * along
    tip = (
        front
        + nose * np.cos(_NOSE)[:, np.newaxis] * along
        + half_width * np.sin(_NOSE)[:, np.newaxis] * side
    )
    return np.vstack((tail - half_width * side, tip, tail + half_width * side))


def _circle(center: Point, radius: float) -> Points:
    return center + radius * np.stack((np.cos(_ROUND), np.sin(_ROUND)), axis=1)


def _normal(tail: Point, head: Point) -> Point:
    along = (head - tail) / np.linalg.norm(head - tail)
    return np.array([-along[1], along[0]])


def _faded(color: str, age: float) -> tuple[float, float, float]:
    """Return a color, whiter with increasing age."""
    red, green, blue = (1.0 - (1.0 - part) * (1.0 - FADED * age) for part in to_rgb(color))
    return red, green, blue


# ---- water ---------------------------------------------------------------------------------------


def draw_water(trial: Trial, ax: Axes) -> bool:
    """Draw the motion of a run's water: its current above the corner, or the field of its flow under the path.

    Arrows show the velocity at the robot's depth at the end of the run; shading shows the elevation
    of the surface if there are waves, otherwise the speed.

    Args:
        trial: Any trial.
        ax: Axes with its path, in meters.

    Returns:
        Whether a field was drawn, which sets the limits of the axes.
    """
    water = trial.environment
    if isinstance(water, Water) and water.flow is not None:
        _draw_field(trial, water, ax)
        return True
    if isinstance(water, Water) and any(water.uniform[:2]):
        _tell_current(ax, water.uniform[:2])
    return False


def _draw_field(trial: Trial, water: Water, ax: Axes) -> None:
    """Draw shading and arrows all over the axes, which sets their limits, with a key, a color bar and the time."""
    low, high = _corners(ax)
    time, depth = float(trial.time[-1]), water.depth or 0.0
    if trial.center_of_mass.shape[1] == 3:
        depth = -float(np.mean(trial.center_of_mass[:, 2]))

    def velocity(points: np.ndarray, t: float) -> np.ndarray:
        return water.velocity(np.column_stack((points, np.full(len(points), -depth))), t)[:, :2]

    counts = np.ceil(PIXELS * (high - low) / np.max(high - low)).astype(int)
    places = grid_points(
        np.linspace(low[0], high[0], counts[0]), np.linspace(low[1], high[1], counts[1])
    )
    if has_waves(water.flow, 0.5 * (low + high)):
        shade, colors, label = surface_elevation(water.flow, places, time), HEIGHT, "elevation [m]"
        least = -float(np.max(np.abs(shade)))
    else:
        shade, colors, label, least = (
            np.linalg.norm(velocity(places, time), axis=1),
            SPEED,
            "speed [m/s]",
            0.0,
        )
    ends: Any = (low[0], high[0], low[1], high[1])
    look: Any = {"cmap": colors, "vmin": least, "vmax": float(np.max(np.abs(shade))), "zorder": 0}
    image = ax.imshow(
        shade.reshape(counts).T, extent=ends, origin="lower", interpolation="bilinear", **look
    )
    _add_bar(ax, image, label)
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), anchor="W")
    corner, end = _above_corner(ax), high[0]
    words = f"water at {time:.3g} s" + (f", {depth:.3g} m deep" if depth else "")
    arrows = arrows_of(velocity, low, high, [time])
    if arrows is not None:
        tails, tips = np.moveaxis(arrows.at(arrows.places(low, high), time), 1, 0)
        sizes: Any = {
            "angles": "xy",
            "scale_units": "xy",
            "scale": 1.0,
            "units": "dots",
            "width": 2.2,
        }
        ax.quiver(*tails.T, *(tips - tails).T, color=style.GRAY, zorder=0.6, **sizes)
        long = arrows.key * arrows.time
        places = blended_transform_factory(ax.transData, corner)
        key = ax.quiver(
            end,
            ROW,
            long,
            0.0,
            color=style.INK,
            pivot="tip",
            transform=places,
            clip_on=False,
            **sizes,
        )
        key.set_in_layout(False)
        words, end = f"{words}; {arrows.key:g} m/s:", end - long
    at: Any = {
        "xycoords": ("data", corner),
        "ha": "right",
        "va": "center",
        "annotation_clip": False,
    }
    style.add_note(ax, words, (end, ROW), (-5.0, 0.0), color=style.INK, **at)


def _add_bar(ax: Axes, image: AxesImage, label: str) -> None:
    """Add the color bar of the shading, to the right of the axes and of the same height."""
    figure: Any = ax.get_figure(root=True)
    side = ax.inset_axes((1.02, 0.0, BAR / (ax.get_position().width * figure.get_figwidth()), 1.0))
    bar = figure.colorbar(image, cax=side)
    bar.set_label(label, fontsize=style.LABEL, color=style.INK)
    side.tick_params(labelsize=style.TICK, labelcolor=style.INK, length=0)
    side.yaxis.set_major_locator(MaxNLocator(4))
    bar.outline.set_visible(False)


def _corners(ax: Axes) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of the drawn area with its margins, extended to fill axes of equal scales."""
    figure: Any = ax.get_figure(root=True)
    box: Any = np.array(ax.get_position().size) * figure.get_size_inches()
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    low, high = np.array((left, bottom)), np.array((right, top))
    half = 0.5 * np.maximum(high - low, LEAST) / box
    return 0.5 * (low + high) - np.max(half) * box, 0.5 * (low + high) + np.max(half) * box


def _above_corner(ax: Axes) -> Transform:
    """Return a transform in points from the upper right corner, in which drawings keep their size and direction."""
    figure: Any = ax.get_figure(root=True)
    corner = ScaledTranslation(1.0, 1.0, ax.transAxes)  # pyright: ignore[reportArgumentType]  # any transform will do
    return Affine2D().scale(1.0 / 72.0) + figure.dpi_scale_trans + corner


def _tell_current(ax: Axes, current: Sequence[float]) -> None:
    """Show strength and direction of the current above the upper right corner."""
    strength, in_points = math.hypot(*current), _above_corner(ax)
    x, y = (7.0 * part / strength for part in current)
    look: Any = {"xycoords": in_points, "color": style.INK, "annotation_clip": False}
    style.add_note(
        ax, f"current {strength:.3g} m/s", (-20.0, ROW), (0, 0), ha="right", va="center", **look
    )
    arrow = {
        "arrowstyle": "-|>",
        "mutation_scale": 7,
        "shrinkA": 0,
        "shrinkB": 0,
        "linewidth": style.THIN,
    }
    ax.annotate(
        "",
        (-10.0 + x, ROW + y),
        (-10.0 - x, ROW - y),
        textcoords=in_points,
        arrowprops=arrow,
        **look,
    )
