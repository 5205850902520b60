"""The figures of one run: its path with the body along it, its speed, its joint angles and torques."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from laticauda.figures import postures, style
from laticauda.robot import Water
from laticauda.trial import Trial, measured_counterpart
from laticauda.trial.cycles import cycle_middles, interpolated

Series = Float[np.ndarray, "n_samples ..."]

WORDS = {"lateral_undulation": "lateral undulation", "eel_like": "eel-like motion", "custom": "custom gait"}
CYCLES_SHOWN = 3  # of joint angles and torques, at the end of a run
STRIP_HEIGHT = (0.85, 2.2)  # of the path, where it is above the other figures [in]
PANEL_HEIGHT = 1.9  # [in]
LABELS = 0.55  # height that title and labels of a figure take [in]


# ---- figures -------------------------------------------------------------------------------------------------------


def path_strip(trial: Trial, ax: Axes) -> Axes:
    """The path of the center of mass, with the body drawn along it like a film strip, older postures lighter.

    The body has its real lengths and widths; the head is orange and pointed, a fin is a dark line at the tail.

    Args:
        trial: Any trial, a failed one too.
        ax: Where to draw.
    """
    robot = postures.planar_body(trial)
    samples = postures.instants(trial)
    for k, sample in enumerate(samples):
        points = postures.outline(robot, trial, sample)
        age = (len(samples) - 1 - k) / max(len(samples) - 1, 1)
        postures.draw_posture(ax, robot, points, age)
        _tell_time(ax, trial, points, sample)
    x, y = trial.center_of_mass[:, 0], trial.center_of_mass[:, 1]
    ax.plot(x, y, color=style.INK, linewidth=0.8, zorder=4, label="center of mass")
    ax.plot(x[:1], y[:1], color=style.INK, marker="o", markersize=3, zorder=4)
    if isinstance(trial.environment, Water) and any(trial.environment.current):
        _tell_current(ax, trial.environment.current)
    ax.set_aspect("equal", adjustable="datalim")
    return style.dress(ax, xlabel="x [m]", ylabel="y [m]")


def speed(trial: Trial, ax: Axes) -> Axes:
    """Forward speed over time, its mean over the gait cycle around each moment, and what was measured, if it was.

    Forward is along the heading; the cycle mean is the displacement over one cycle / its duration.

    Args:
        trial: Any trial, a failed one too.
        ax: Where to draw.
    """
    ahead = np.stack((np.cos(trial.heading), np.sin(trial.heading)), axis=1)
    forward = np.sum(trial.center_of_mass_velocity[:, :2] * ahead, axis=1)
    ax.plot(trial.time, forward, color=style.BLUE, linewidth=style.THIN, label="forward")
    mean = _cycle_mean_speed(trial)
    if mean is not None:
        ax.plot(*mean, color=style.INK, linewidth=1.4, label="mean over a cycle")
    measured = measured_counterpart(trial)
    if measured is not None and measured.forward_velocity is not None:
        label = f"measured, {measured.forward_velocity:.3f} m/s"
        ax.axhline(measured.forward_velocity, color=style.ORANGE, linewidth=style.LINE, linestyle=(0, (4, 2)), label=label)
    _from_to(ax, trial.time)
    style.legend(ax, loc="lower right")
    return style.dress(ax, xlabel="time [s]", ylabel="speed [m/s]")


def joint_angle(trial: Trial, ax: Axes, *, last: float | None = None, scale: bool = True) -> Axes:
    """Angles of all joints over time, in degrees, colored from tail to head.

    Args:
        trial: Any trial, a failed one too.
        ax: Where to draw.
        last: Show only so much of the run's end [s]; None shows all of it.
        scale: Put the color scale beside the axes.
    """
    return _joints(trial, np.degrees(trial.joint_angle), ax, "joint angle [deg]", last, scale)


def joint_torque(trial: Trial, ax: Axes, *, last: float | None = None, scale: bool = True) -> Axes:
    """Torques of all joints' drives over time, colored from tail to head.

    Args:
        trial: Any trial, a failed one too.
        ax: Where to draw.
        last: Show only so much of the run's end [s]; None shows all of it.
        scale: Put the color scale beside the axes.
    """
    return _joints(trial, trial.joint_torque, ax, "joint torque [N m]", last, scale)


def swim_sheet(trial: Trial) -> Figure:
    """One picture of a run, as wide as two columns of a journal: path, speed, joint angles and torques.

    The joints are shown over the last cycles only. A long path lies above the rest, a curved one beside it.

    Args:
        trial: Any trial, a failed one too.
    """
    strip = _strip_height(trial)
    last = None if trial.period is None else CYCLES_SHOWN * trial.period
    if strip <= STRIP_HEIGHT[1]:
        heights = [max(strip, STRIP_HEIGHT[0]) + LABELS, PANEL_HEIGHT]
        figure = style.new_figure(style.DOUBLE_COLUMN, sum(heights))
        grid = figure.add_gridspec(2, 3, height_ratios=heights, width_ratios=(1.25, 1.0, 1.0))
        places = [grid[0, :], grid[1, 0], grid[1, 1], grid[1, 2]]
    else:
        figure = style.new_figure(style.DOUBLE_COLUMN, 3.0 * 0.8 * PANEL_HEIGHT)
        grid = figure.add_gridspec(3, 2, width_ratios=(1.15, 1.0))
        places = [grid[:, 0], grid[0, 1], grid[1, 1], grid[2, 1]]
    path, velocity, angle, torque = (figure.add_subplot(place) for place in places)
    path_strip(trial, path)
    path.set_title(_title(trial), fontsize=style.LABEL, loc="left", color=style.INK)
    speed(trial, velocity)
    joint_angle(trial, angle, last=last, scale=False)
    joint_torque(trial, torque, last=last, scale=False)
    _scale(figure, trial, [torque] if strip <= STRIP_HEIGHT[1] else [angle, torque])
    return figure


# ---- parts ---------------------------------------------------------------------------------------------------------


def _tell_time(ax: Axes, trial: Trial, points: postures.Points, sample: int) -> None:
    """The time beside a posture, on its outer side where the path is curved."""
    center, heading = trial.center_of_mass[sample, :2], float(trial.heading[sample])
    left = np.array([-np.sin(heading), np.cos(heading)])
    middle = 0.5 * (trial.center_of_mass[:, :2].min(axis=0) + trial.center_of_mass[:, :2].max(axis=0))
    side = -left if left @ (center - middle) < -0.1 else left
    reach = float(np.max((points - center) @ side))
    place = center + (reach + 0.1) * side
    ax.annotate(
        f"{trial.time[sample]:.3g} s",
        place,
        xytext=4.0 * side,
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize=style.TICK,
        color=style.INK,
        zorder=5,
    )
    # What a text covers does not count for the limits of axes; this point does.
    ax.update_datalim([tuple(center + (reach + 0.25) * side)])


def _tell_current(ax: Axes, current: tuple[float, float]) -> None:
    speed = math.hypot(*current)
    across = (0.5 * current[0] / speed, 0.5 * current[1] / speed)
    ax.annotate(
        f"current {speed:.3g} m/s",
        xy=(0.98 + 0.0 * across[0], 0.93),
        xycoords="axes fraction",
        ha="right",
        va="top",
        fontsize=style.TICK,
        color=style.INK,
    )


def _joints(trial: Trial, values: Series, ax: Axes, label: str, last: float | None, scale: bool) -> Axes:
    start = trial.time[0] if last is None else max(trial.time[0], trial.time[-1] - last)
    shown = trial.time >= start
    n_joints = values.shape[1]
    if n_joints:
        colors, norm = style.joint_colors(n_joints)
        lines = [np.stack((trial.time[shown], values[shown, i]), axis=1) for i in range(n_joints)]
        drawn = LineCollection(lines, cmap=colors, norm=norm, array=np.arange(n_joints), linewidth=0.9)
        ax.add_collection(drawn)
        ax.autoscale_view()
        if scale:
            _scale(ax.get_figure(root=True), trial, [ax])
    _from_to(ax, trial.time[shown])
    return style.dress(ax, xlabel="time [s]", ylabel=label)


def _scale(figure: Figure | None, trial: Trial, axes: list[Axes]) -> None:
    """The color scale of the joints, from tail to head."""
    n_joints = trial.joint_angle.shape[1]
    if figure is None or n_joints == 0:
        return
    colors, norm = style.joint_colors(n_joints)
    bar = figure.colorbar(ScalarMappable(norm=norm, cmap=colors), ax=axes, aspect=25, pad=0.03, drawedges=False)
    ticks = sorted({0, n_joints - 1})
    bar.set_ticks(ticks, labels=[f"{i} ({end})" for i, end in zip(ticks, ("tail", "head"), strict=False)])
    bar.ax.tick_params(labelsize=style.TICK, labelcolor=style.INK, length=0, which="both")
    bar.set_label("joint", fontsize=style.LABEL, color=style.INK, labelpad=-10)
    bar.outline.set_visible(False)


def _cycle_mean_speed(trial: Trial) -> tuple[Series, Series] | None:
    """Times and displacement over the cycle around each / its duration; None where there is no whole cycle."""
    if trial.period is None:
        return None
    try:
        middle = cycle_middles(trial.time, trial.period)
    except ValueError:  # too short a run, or too few samples
        return None
    log = trial.time, trial.center_of_mass, trial.center_of_mass_velocity
    before, after = (interpolated(*log, middle + shift * trial.period) for shift in (-0.5, 0.5))
    return middle, np.linalg.norm(after - before, axis=1) / trial.period


def _strip_height(trial: Trial) -> float:
    """Height of the path's axes if they are as wide as the figure, at equal scales [in]."""
    robot = postures.planar_body(trial)
    bodies = [postures.outline(robot, trial, sample) for sample in postures.instants(trial)]
    points = np.vstack([*bodies, trial.center_of_mass[:, :2]])
    width, height = np.ptp(points, axis=0)
    return (style.DOUBLE_COLUMN - 0.6) * (height + 0.6) / max(width + 0.2, 1e-9)


def _title(trial: Trial) -> str:
    text = trial.robot.name
    if trial.gait is not None:
        gait = trial.gait
        angles = (gait.amplitude, gait.frequency, gait.phase_shift)
        text += ", {} ({:.3g} deg, {:.3g} deg/s, {:.3g} deg)".format(WORDS.get(gait.kind, gait.kind), *np.degrees(angles))
        if gait.offset:
            text += f", offset {math.degrees(gait.offset):.3g} deg"
    return text


def _from_to(ax: Axes, time: Series) -> None:
    if time.size > 1:
        ax.set_xlim(float(time[0]), float(time[-1]))
        ax.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
