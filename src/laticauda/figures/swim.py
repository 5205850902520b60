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
from matplotlib.patches import FancyArrowPatch
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D, ScaledTranslation

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
    width, height = _extent(trial)
    last = None if trial.period is None else CYCLES_SHOWN * trial.period
    strip = (style.DOUBLE_COLUMN - 0.6) * height / width
    if strip < 1.5 * STRIP_HEIGHT[1]:
        heights = [min(max(strip, STRIP_HEIGHT[0]), STRIP_HEIGHT[1]) + LABELS, PANEL_HEIGHT]
        figure = style.new_figure(style.DOUBLE_COLUMN, sum(heights))
        grid = figure.add_gridspec(2, 3, height_ratios=heights, width_ratios=(1.25, 1.0, 1.0))
        places = [grid[0, :], grid[1, 0], grid[1, 1], grid[1, 2]]
    else:
        figure = style.new_figure(style.DOUBLE_COLUMN, 2.4 * PANEL_HEIGHT)
        grid = figure.add_gridspec(3, 2, width_ratios=(min(max(1.2 * width / height, 0.5), 1.2), 1.0))
        places = [grid[:, 0], grid[0, 1], grid[1, 1], grid[2, 1]]
    path, velocity, angle, torque = (figure.add_subplot(place) for place in places)
    path_strip(trial, path)
    figure.suptitle(_title(trial), fontsize=style.LABEL, color=style.INK, x=0.01, ha="left")
    speed(trial, velocity)
    joint_angle(trial, angle, last=last, scale=False)
    joint_torque(trial, torque, last=last, scale=False)
    _scale(figure, trial, [torque] if grid.ncols == 3 else [angle, torque])
    figure.align_ylabels([velocity, angle, torque] if grid.ncols == 2 else [velocity])
    return figure


# ---- parts ---------------------------------------------------------------------------------------------------------


def _tell_time(ax: Axes, trial: Trial, points: postures.Points, sample: int, half_width: float) -> None:
    """The time beside a posture, to its left, or on the outer side where the path is curved."""
    path = trial.center_of_mass[:, :2]
    center, heading = path[sample], float(trial.heading[sample])
    ahead, left = np.array([np.cos(heading), np.sin(heading)]), np.array([-np.sin(heading), np.cos(heading)])
    is_straight = trial.path_speed < 1.25 * trial.forward_velocity if trial.time.size > 1 else True
    outward = center - 0.5 * (path.min(axis=0) + path.max(axis=0))
    side = left if is_straight or left @ outward > 0.0 else -left
    near = points[np.abs((points - center) @ ahead) < 0.25 * np.ptp(points @ ahead)]
    reach = float(np.max((near - center) @ side, initial=0.0)) + half_width
    ax.annotate(
        f"{trial.time[sample]:.3g} s",
        tuple(center + reach * side),
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
    ax.update_datalim([tuple(center + (reach + MARGIN * max(_extent(trial))) * side)])


def _tell_current(ax: Axes, current: tuple[float, float]) -> None:
    """Strength and direction of the current, above the upper right corner."""
    strength = math.hypot(*current)
    figure = ax.get_figure(root=True)
    assert figure is not None
    # Points, counted from the corner: the arrow keeps its size and its direction.
    in_points = Affine2D().scale(1.0 / 72.0) + figure.dpi_scale_trans + ScaledTranslation(1.0, 1.0, ax.transAxes)
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
    bar.ax.set_title("joint", fontsize=style.LABEL, color=style.INK, loc="left", pad=5)
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


def _extent(trial: Trial) -> tuple[float, float]:
    """Width and height that path and postures take, with room for the times [m]."""
    robot = postures.planar_body(trial)
    bodies = [postures.outline(robot, trial, sample) for sample in postures.instants(trial)]
    width, height = np.ptp(np.vstack([*bodies, trial.center_of_mass[:, :2]]), axis=0)
    room = 2.0 * MARGIN * max(width, height)
    return float(width + room), float(height + room)


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
        ax.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
