"""Path of a run, with the postures of the body drawn along it, and the water under it."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from laticauda.show.figures import style
from laticauda.show.figures.places import draw_places, outlines_of, places_of
from laticauda.show.figures.posture import (
    Point,
    Points,
    choose_instants,
    draw_posture,
    is_crowded,
    outline,
)
from laticauda.show.figures.water import draw_water
from laticauda.trials import Trial, metrics

MARGIN = 0.05
"""Space around the path for the times beside the postures, as a fraction of its extent [-]."""
STRAIGHT = 1.25
"""Length of a path that counts as straight, at most, by the distance between its ends [-]."""


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
        _add_time(ax, trial, points, sample, half_width)
    x = trial.center_of_mass[:, 0]
    y = trial.center_of_mass[:, 1]
    ax.plot(x, y, color=style.INK, linewidth=0.8, zorder=4, label="center of mass")
    ax.plot(x[:1], y[:1], color=style.INK, marker="o", markersize=3, zorder=4)
    draw_places(ax, places_of(trial))
    has_field = draw_water(trial, ax)
    ax.set_aspect("equal", adjustable="box" if has_field else "datalim")
    return style.style_axes(ax, xlabel="x [m]", ylabel="y [m]")


def path_extent(trial: Trial) -> tuple[float, float]:
    """Return the width and height of path, postures and places, with space for the times [m].

    Args:
        trial: Any trial.
    """
    robot = trial.chain
    bodies = [outline(robot, trial, sample) for sample in choose_instants(trial)]
    lines = [*bodies, trial.center_of_mass[:, :2], *outlines_of(places_of(trial))]
    width, height = np.ptp(np.vstack(lines), axis=0)
    margins = 2.0 * MARGIN * max(width, height)
    return float(width + margins), float(height + margins)


@dataclass(frozen=True)
class _Spot:
    """Where the time of a posture may stand."""

    direction: Point
    """Unit vector away from the body."""
    point: Point
    """Point just off the body [m]."""


def _add_time(ax: Axes, trial: Trial, points: Points, sample: int, half_width: float) -> None:
    """Add the time beside a posture."""
    spot = _spot_of_time(trial, points, sample, half_width)
    x, y = float(spot.direction[0]), float(spot.direction[1])
    style.add_note(
        ax,
        f"{trial.time[sample]:.3g} s",
        (float(spot.point[0]), float(spot.point[1])),
        (3.0 * x, 3.0 * y),
        ha=_alignment(x, "left", "right"),
        va=_alignment(y, "bottom", "top"),
        color=style.INK,
        path_effects=[withStroke(linewidth=2.0, foreground="white")],
        zorder=5,
    )
    # The limits of axes ignore texts; this point reserves space for it.
    text_room = MARGIN * max(path_extent(trial)) * (1.0 + 1.5 * abs(x))
    ax.update_datalim([tuple(spot.point + text_room * spot.direction)])


def _alignment(component: float, towards_positive: str, towards_negative: str) -> str:
    """Return how a text is aligned that lies in a direction with this component along an axis."""
    if component > 0.5:
        return towards_positive
    if component < -0.5:
        return towards_negative
    return "center"


def _spot_of_time(trial: Trial, points: Points, sample: int, half_width: float) -> _Spot:
    """Return where the time stands: left, or on the outer side of a curved path; else on the free side."""
    path = trial.center_of_mass[:, :2]
    center = path[sample]
    heading = float(trial.heading[sample])
    ahead = np.array([np.cos(heading), np.sin(heading)])
    left = np.array([-np.sin(heading), np.cos(heading)])
    if is_crowded(trial):  # the bodies overlap: behind the first, and ahead of the last
        if sample:
            return _Spot(direction=ahead, point=points[-1])
        return _Spot(direction=-ahead, point=points[0])
    log = trial.time, trial.center_of_mass  # a run that failed has them, but no figures
    is_straight = metrics.path_speed(*log) < STRAIGHT * metrics.forward_velocity(*log)
    outward = center - 0.5 * (path.min(axis=0) + path.max(axis=0))
    side = left if is_straight or left @ outward > 0.0 else -left
    is_middle = np.abs((points - center) @ ahead) < 0.25 * np.ptp(points @ ahead)
    spots = [
        _Spot(direction=direction, point=_beside(center, points[is_middle], direction, half_width))
        for direction in (side, -side)
    ]
    text_width = MARGIN * max(path_extent(trial))  # about
    for spot in spots:
        text_center = spot.point + 0.5 * text_width * spot.direction
        distance_to_path = float(np.linalg.norm(path - text_center, axis=1).min())
        if distance_to_path > 0.7 * text_width:
            return spot
    return spots[0]


def _beside(center: Point, points: Points, side: Point, half_width: float) -> Point:
    """Return the point just off the body on one side of it."""
    return center + (np.max((points - center) @ side, initial=0.0) + half_width) * side
