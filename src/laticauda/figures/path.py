"""The path of a run, with the body drawn along it."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Affine2D, ScaledTranslation

from laticauda.figures import postures, style
from laticauda.robot import Water
from laticauda.trial import Trial

MARGIN = 0.05  # around the path, for the times beside the postures, as a share of its extent [-]


def path_strip(trial: Trial, ax: Axes) -> Axes:
    """The path of the center of mass, with the body drawn along it like a film strip, older postures lighter.

    The body has its real lengths and widths; the head is orange and pointed, a fin is a dark line at the tail.

    Args:
        trial: Any trial, a failed one too.
        ax: Where to draw.
    """
    robot = postures.planar_body(trial)
    half_width = max(module.section.half_width for module in robot.modules)
    samples = postures.instants(trial)
    for k, sample in enumerate(samples):
        points = postures.outline(robot, trial, sample)
        age = (len(samples) - 1 - k) / max(len(samples) - 1, 1)
        postures.draw_posture(ax, robot, points, age)
        _tell_time(ax, trial, points, sample, half_width)
    x, y = trial.center_of_mass[:, 0], trial.center_of_mass[:, 1]
    ax.plot(x, y, color=style.INK, linewidth=0.8, zorder=4, label="center of mass")
    ax.plot(x[:1], y[:1], color=style.INK, marker="o", markersize=3, zorder=4)
    if isinstance(trial.environment, Water) and any(trial.environment.current):
        _tell_current(ax, trial.environment.current)
    ax.set_aspect("equal", adjustable="datalim")
    return style.dress(ax, xlabel="x [m]", ylabel="y [m]")


def extent(trial: Trial) -> tuple[float, float]:
    """Width and height that path and postures take, with room for the times [m]."""
    robot = postures.planar_body(trial)
    bodies = [postures.outline(robot, trial, sample) for sample in postures.instants(trial)]
    width, height = np.ptp(np.vstack([*bodies, trial.center_of_mass[:, :2]]), axis=0)
    room = 2.0 * MARGIN * max(width, height)
    return float(width + room), float(height + room)


def _tell_time(ax: Axes, trial: Trial, points: postures.Points, sample: int, half_width: float) -> None:
    """The time beside a posture: to its left, or on the outer side where the path is curved; else on the free side."""
    path = trial.center_of_mass[:, :2]
    center, heading = path[sample], float(trial.heading[sample])
    ahead, left = np.array([np.cos(heading), np.sin(heading)]), np.array([-np.sin(heading), np.cos(heading)])
    if postures.is_crowded(trial):  # the bodies lie on each other: behind the first, and ahead of the last
        side = ahead if sample else -ahead
        place = points[-1] if sample else points[0]
    else:
        is_straight = trial.path_speed < 1.25 * trial.forward_velocity
        outward = center - 0.5 * (path.min(axis=0) + path.max(axis=0))
        side = left if is_straight or left @ outward > 0.0 else -left
        near = points[np.abs((points - center) @ ahead) < 0.25 * np.ptp(points @ ahead)]
        text = MARGIN * max(extent(trial))  # about as wide as the text
        places = [(each, _beside(center, near, each, half_width)) for each in (side, -side)]
        clear = [(each, at) for each, at in places if _gap(path, at + 0.5 * text * each) > 0.7 * text]
        side, place = clear[0] if clear else places[0]
    ax.annotate(
        f"{trial.time[sample]:.3g} s",
        tuple(place),
        xytext=tuple(3.0 * side),
        textcoords="offset points",
        ha="left" if side[0] > 0.5 else "right" if side[0] < -0.5 else "center",
        va="bottom" if side[1] > 0.5 else "top" if side[1] < -0.5 else "center",
        fontsize=style.TICK,
        color=style.INK,
        path_effects=[withStroke(linewidth=2.0, foreground="white")],
        zorder=5,
    )
    # The limits of axes do not mind texts; this point keeps room for it.
    room = MARGIN * max(extent(trial)) * (1.0 + 1.5 * abs(side[0]))
    ax.update_datalim([tuple(place + room * side)])


def _beside(center: postures.Point, points: postures.Points, side: postures.Point, half_width: float) -> postures.Point:
    """The place just off the body on one side of it."""
    return center + (np.max((points - center) @ side, initial=0.0) + half_width) * side


def _gap(path: postures.Points, place: postures.Point) -> float:
    """How far a place is from the path."""
    return float(np.min(np.linalg.norm(path - place, axis=1)))


def _tell_current(ax: Axes, current: tuple[float, float]) -> None:
    """Strength and direction of the current, above the upper right corner."""
    strength = math.hypot(*current)
    figure = ax.get_figure(root=True)
    assert figure is not None
    # Points, counted from the corner: the arrow keeps its size and its direction.
    in_points = Affine2D().scale(1.0 / 72.0) + figure.dpi_scale_trans + _at_upper_right(ax)
    tip = tuple(7.0 * part / strength for part in current)
    ax.annotate(
        f"current {strength:.3g} m/s",
        (-20.0, 9.0),
        xycoords=in_points,
        ha="right",
        va="center",
        fontsize=style.TICK,
        color=style.INK,
        annotation_clip=False,
    )
    arrow = FancyArrowPatch(
        (-10.0 - tip[0], 9.0 - tip[1]),
        (-10.0 + tip[0], 9.0 + tip[1]),
        arrowstyle="-|>",
        mutation_scale=7,
        shrinkA=0,
        shrinkB=0,
        color=style.INK,
        linewidth=style.THIN,
        clip_on=False,
        transform=in_points,
    )
    ax.add_patch(arrow)


def _at_upper_right(ax: Axes) -> ScaledTranslation:
    """Shifts to the upper right corner of axes."""
    return ScaledTranslation(1.0, 1.0, ax.transAxes)  # pyright: ignore[reportArgumentType]  # any transform will do
