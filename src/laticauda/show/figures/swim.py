"""Figures of one run: speed, joint angles and torques, and the sheet with all of them and the path."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from laticauda.show.figures import style
from laticauda.show.figures.path import path_extent, path_strip
from laticauda.show.pictures import describe_run
from laticauda.trials import Trial, cycles, measured_counterpart

Series = Float[np.ndarray, "n_samples ..."]

CYCLES_SHOWN = 3
"""Cycles of joint angles and torques that a sheet shows, at the end of the run."""
LOWEST_STRIP = 0.85
"""Height of a path above the other panels, at least [in]."""
HIGHEST_STRIP = 2.4
"""Height of a path above the other panels, at most [in]."""
PANEL_HEIGHT = 1.9
"""Height of a panel [in]."""
LABELS_HEIGHT = 0.55
"""Height of title and labels of a panel [in]."""
LEGEND_SHARE = 0.4
"""Height of a legend as a fraction of its axes [-]."""


def plot_speed(trial: Trial, ax: Axes) -> Axes:
    """Plot forward speed over time, its mean over the gait cycle around each instant, and the measured one, if any.

    Forward is along the heading; the cycle mean is the displacement over one cycle / its duration.

    Args:
        trial: Any trial, including a failed one.
        ax: Axes to draw on.
    """
    forward = forward_speed(trial)
    mean = cycle_mean_speed(trial)
    ax.plot(trial.time, forward, color=style.BLUE, linewidth=style.THIN, label="forward")
    if mean is not None:
        ax.plot(mean.time, mean.speed, color=style.INK, linewidth=1.4, label="mean over a cycle")
    measured = measured_counterpart(trial)
    if measured is not None and measured.forward_velocity is not None:
        label = f"measured, {measured.forward_velocity:.3f} m/s"
        ax.axhline(measured.forward_velocity, label=label, **style.AIM)
    span_time_axis(ax, trial.time)
    _add_legend(ax, forward[trial.time.size // 5 :])
    return style.style_axes(ax, xlabel="time [s]", ylabel="speed [m/s]")


def forward_speed(trial: Trial) -> Series:
    """Return the speed along the heading at every sample [m/s].

    Args:
        trial: Any trial, including a failed one.
    """
    ahead = np.stack((np.cos(trial.heading), np.sin(trial.heading)), axis=1)
    return np.sum(trial.center_of_mass_velocity[:, :2] * ahead, axis=1)


def plot_joint_angle(
    trial: Trial, ax: Axes, *, last: float | None = None, scale: bool = True
) -> Axes:
    """Plot the angles of all joints over time, in degrees, colored from tail to head.

    Args:
        trial: Any trial, including a failed one.
        ax: Axes to draw on.
        last: Show only this much of the end of the run [s]; None shows all of it.
        scale: Whether to add the color scale beside the axes.
    """
    if "joint_angle" in trial.not_measured:
        return _leave_empty(trial, ax, label="joint angle [deg]")
    return _plot_joints(
        trial,
        np.degrees(trial.joint_angle),
        ax,
        label="joint angle [deg]",
        last=last,
        scale=scale,
    )


def plot_joint_torque(
    trial: Trial, ax: Axes, *, last: float | None = None, scale: bool = True
) -> Axes:
    """Plot the torques of all joint drives over time, colored from tail to head.

    Args:
        trial: Any trial, including a failed one.
        ax: Axes to draw on.
        last: Show only this much of the end of the run [s]; None shows all of it.
        scale: Whether to add the color scale beside the axes.
    """
    if "joint_torque" in trial.not_measured:
        return _leave_empty(trial, ax, label="joint torque [N m]")
    return _plot_joints(
        trial, trial.joint_torque, ax, label="joint torque [N m]", last=last, scale=scale
    )


def swim_sheet(trial: Trial) -> Figure:
    """Create a figure of a run, as wide as two journal columns: path, speed, joint angles and torques.

    The joints are shown over the last cycles only. A long path is above the other panels, a curved
    one beside them.

    Args:
        trial: Any trial, including a failed one.
    """
    last = None if trial.period is None else CYCLES_SHOWN * trial.period
    width, height = path_extent(trial)
    strip = (style.DOUBLE_COLUMN - 0.6) * height / width
    if strip < 1.5 * HIGHEST_STRIP:
        panels = _panels_below(min(max(strip, LOWEST_STRIP), HIGHEST_STRIP))
    else:
        panels = _panels_beside(width / height)
    path_strip(trial, panels.path)
    style.add_title(panels.figure, title_of(trial))
    plot_speed(trial, panels.speed)
    plot_joint_angle(trial, panels.angle, last=last, scale=False)
    plot_joint_torque(trial, panels.torque, last=last, scale=False)
    if panels.are_stacked:
        panels.angle.set_xlabel("")
        panels.figure.align_ylabels([panels.speed, panels.angle, panels.torque])
        _add_joint_scale(panels.figure, trial, [panels.angle, panels.torque])
    else:
        _add_joint_scale(panels.figure, trial, [panels.torque])
    return panels.figure


@dataclass(frozen=True)
class _Panels:
    """An empty sheet of a run."""

    figure: Figure
    path: Axes
    speed: Axes
    angle: Axes
    torque: Axes
    are_stacked: bool
    """Whether speed, angle and torque stand one above the other."""


def _panels_below(strip_height: float) -> _Panels:
    """Return a sheet with a long path above the other panels; its height is that of the path [in]."""
    heights = [strip_height + LABELS_HEIGHT, PANEL_HEIGHT]
    figure = style.new_figure(style.DOUBLE_COLUMN, sum(heights))
    grid = figure.add_gridspec(2, 3, height_ratios=heights, width_ratios=(1.25, 1.0, 1.0))
    return _Panels(
        figure=figure,
        path=figure.add_subplot(grid[0, :]),
        speed=figure.add_subplot(grid[1, 0]),
        angle=figure.add_subplot(grid[1, 1]),
        torque=figure.add_subplot(grid[1, 2]),
        are_stacked=False,
    )


def _panels_beside(aspect: float) -> _Panels:
    """Return a sheet with a curved path beside the other panels; `aspect` is its width by its height."""
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.6 * PANEL_HEIGHT)
    widths = (min(max(1.2 * aspect, 0.5), 1.2), 1.0)
    grid = figure.add_gridspec(3, 2, width_ratios=widths, height_ratios=(1.5, 1.0, 1.0))
    return _Panels(
        figure=figure,
        path=figure.add_subplot(grid[:, 0]),
        speed=figure.add_subplot(grid[0, 1]),
        angle=figure.add_subplot(grid[1, 1]),
        torque=figure.add_subplot(grid[2, 1]),
        are_stacked=True,
    )


def _add_legend(ax: Axes, late_values: Series) -> None:
    """Add a legend where it covers no line: below the speeds, or else above them, in extra space."""
    low, high = ax.get_ylim()
    if np.min(late_values, initial=high) < low + LEGEND_SHARE * (high - low):
        ax.set_ylim(low, high + LEGEND_SHARE / (1.0 - LEGEND_SHARE) * (high - low))
        style.add_legend(ax, loc="upper right")
    else:
        style.add_legend(ax, loc="lower right")


def _plot_joints(
    trial: Trial, values: Series, ax: Axes, *, label: str, last: float | None, scale: bool
) -> Axes:
    """Plot one line per joint, over the last part of the run or all of it."""
    start = trial.time[0]
    if last is not None:
        start = max(start, trial.time[-1] - last)
    is_shown = trial.time >= start
    times = trial.time[is_shown]
    n_joints = values.shape[1]
    if n_joints:
        colors, norm = style.joint_colors(n_joints)
        lines = LineCollection(
            [np.stack((times, values[is_shown, i]), axis=1) for i in range(n_joints)],
            cmap=colors,
            norm=norm,
            array=list(range(n_joints)),
            linewidth=0.9,
        )
        ax.add_collection(lines)
        ax.autoscale_view()
        if scale:
            _add_joint_scale(ax.get_figure(root=True), trial, [ax])
    span_time_axis(ax, times)
    return style.style_axes(ax, xlabel="time [s]", ylabel=label)


def _leave_empty(trial: Trial, ax: Axes, *, label: str) -> Axes:
    """Say that what would be drawn was not measured, where zeros would look like a measurement."""
    middle = (0.5, 0.5)
    style.add_note(
        ax, "not measured", middle, (0, 0), xycoords="axes fraction", ha="center", va="center"
    )
    ax.set_yticks([])
    span_time_axis(ax, trial.time)
    return style.style_axes(ax, xlabel="time [s]", ylabel=label)


def _add_joint_scale(figure: Figure | None, trial: Trial, axes: list[Axes]) -> None:
    """Add the color scale of the joints, from tail to head."""
    n_joints = trial.joint_angle.shape[1]
    if figure is None or n_joints == 0:
        return
    colors, norm = style.joint_colors(n_joints)
    bar = figure.colorbar(
        ScalarMappable(norm=norm, cmap=colors), ax=axes, aspect=25, pad=0.03, drawedges=False
    )
    if n_joints == 1:
        bar.set_ticks([0], labels=["0 (tail)"])
    else:
        bar.set_ticks([0, n_joints - 1], labels=["0 (tail)", f"{n_joints - 1} (head)"])
    bar.ax.tick_params(labelsize=style.TICK, labelcolor=style.INK, length=0, which="both")
    bar.ax.set_title("joint", fontsize=style.LABEL, color=style.INK, loc="left", pad=5)
    bar.outline.set_visible(False)


@dataclass(frozen=True)
class CycleMeanSpeed:
    """Speed as a mean over the gait cycle around each time."""

    time: Series
    """Times [s]."""
    speed: Series
    """Displacement over the cycle around each time / its duration [m/s]."""


def cycle_mean_speed(trial: Trial) -> CycleMeanSpeed | None:
    """Return the speed as a mean over whole gait cycles; None without a whole cycle.

    Args:
        trial: Any trial, including a failed one.
    """
    if trial.period is None:
        return None
    try:
        middles = cycles.cycle_middles(trial.time, trial.period)
    except ValueError:  # too short a run, or too few samples
        return None
    log = (trial.time, trial.center_of_mass, trial.center_of_mass_velocity)
    begin = cycles.interpolated(*log, middles - 0.5 * trial.period)
    end = cycles.interpolated(*log, middles + 0.5 * trial.period)
    speed = np.linalg.norm(end - begin, axis=1) / trial.period
    return CycleMeanSpeed(time=middles, speed=speed)


def title_of(trial: Trial) -> str:
    """Return a one-line description of robot and motion."""
    return ", ".join(describe_run(trial))


def span_time_axis(ax: Axes, time: Series) -> None:
    """Let the time axis span exactly the given times."""
    if time.size <= 1:
        return
    ax.set_xlim(float(time[0]), float(time[-1]))
    # Few ticks regardless of the width: with more, the layout notices too late that the last label
    # needs space, and fractions of a second have long labels.
    n_ticks = 2 if time[-1] - time[0] < 1.0 else 5
    ax.xaxis.set_major_locator(MaxNLocator(n_ticks, steps=[1, 2, 5, 10]))
