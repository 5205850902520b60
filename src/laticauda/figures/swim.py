"""Figures of one run: speed, joint angles and torques, the followed path; sheets with all of them and the path.

Also the timing of the loop of an operated run: the distributions of its lateness and its latency.
"""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence
from typing import Literal

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter, StrMethodFormatter

from laticauda.figures import style
from laticauda.figures.path import path_extent, path_strip
from laticauda.pictures.render import describe_run
from laticauda.trial import Trial, cycles, following, measured_counterpart

Series = Float[np.ndarray, "n_samples ..."]

CYCLES_SHOWN = 3  # of joint angles and torques, at the end of a run
STRIP_HEIGHT = (0.85, 2.4)  # of the path, if it is above the other figures [in]
PANEL_HEIGHT = 1.9  # [in]
LABELS = 0.55  # height of title and labels of a figure [in]
FOLLOWED_HEIGHT, BELOW_HEIGHT = (
    (0.9, 2.6),
    1.8,
)  # of a followed path, and of the panels below it [in]
TITLE = 0.6  # height of title, note and letters above them [in]
LEGEND = 0.4  # height of a legend as a fraction of its axes [-]
KINDS = {"lateness": style.BLUE, "latency": style.ORANGE}  # colors of the times of a loop


# ---- figures -------------------------------------------------------------------------------------


def plot_speed(trial: Trial, ax: Axes) -> Axes:
    """Plot forward speed over time, its mean over the gait cycle around each instant, and the measured one, if any.

    Forward is along the heading; the cycle mean is the displacement over one cycle / its duration.

    Args:
        trial: Any trial, including a failed one.
        ax: Axes to draw on.
    """
    forward, mean = forward_speed(trial), cycle_mean_speed(trial)
    ax.plot(trial.time, forward, color=style.BLUE, linewidth=style.THIN, label="forward")
    if mean is not None:
        ax.plot(*mean, color=style.INK, linewidth=1.4, label="mean over a cycle")
    measured = measured_counterpart(trial)
    if measured is not None and measured.forward_velocity is not None:
        label = f"measured, {measured.forward_velocity:.3f} m/s"
        ax.axhline(measured.forward_velocity, label=label, **style.AIM)
    _from_to(ax, trial.time)
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
    return _joints(trial, np.degrees(trial.joint_angle), ax, "joint angle [deg]", last, scale)


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
    return _joints(trial, trial.joint_torque, ax, "joint torque [N m]", last, scale)


def swim_sheet(trial: Trial) -> Figure:
    """Create a figure of a run, as wide as two journal columns: path, speed, joint angles and torques.

    The joints are shown over the last cycles only. A long path is above the other panels, a curved
    one beside them.

    Args:
        trial: Any trial, including a failed one.
    """
    width, height = path_extent(trial)
    last = None if trial.period is None else CYCLES_SHOWN * trial.period
    strip = (style.DOUBLE_COLUMN - 0.6) * height / width
    if strip < 1.5 * STRIP_HEIGHT[1]:
        heights = [min(max(strip, STRIP_HEIGHT[0]), STRIP_HEIGHT[1]) + LABELS, PANEL_HEIGHT]
        figure = style.new_figure(style.DOUBLE_COLUMN, sum(heights))
        grid = figure.add_gridspec(2, 3, height_ratios=heights, width_ratios=(1.25, 1.0, 1.0))
        places = [grid[0, :], grid[1, 0], grid[1, 1], grid[1, 2]]
    else:
        figure = style.new_figure(style.DOUBLE_COLUMN, 2.6 * PANEL_HEIGHT)
        sides = (min(max(1.2 * width / height, 0.5), 1.2), 1.0)
        grid = figure.add_gridspec(3, 2, width_ratios=sides, height_ratios=(1.5, 1.0, 1.0))
        places = [grid[:, 0], grid[0, 1], grid[1, 1], grid[2, 1]]
    path, velocity, angle, torque = (figure.add_subplot(place) for place in places)
    path_strip(trial, path)
    figure.suptitle(title_of(trial), fontsize=style.LABEL, color=style.INK, x=0.01, ha="left")
    plot_speed(trial, velocity)
    plot_joint_angle(trial, angle, last=last, scale=False)
    plot_joint_torque(trial, torque, last=last, scale=False)
    if grid.ncols == 2:  # stacked panels
        angle.set_xlabel("")
        figure.align_ylabels([velocity, angle, torque])
    _scale(figure, trial, [torque] if grid.ncols == 3 else [angle, torque])
    return figure


def sheet(trial: Trial) -> Figure:
    """Create the figure that shows most of a run: `follow_sheet` if it followed a path, otherwise `swim_sheet`.

    Args:
        trial: Any trial, including a failed one.
    """
    return follow_sheet(trial) if "cross_track_error" in trial.signals else swim_sheet(trial)


# ---- parts ---------------------------------------------------------------------------------------


def _add_legend(ax: Axes, late: Series) -> None:
    """Add a legend where it covers no line: below the speeds, or else above them, in extra space."""
    low, high = ax.get_ylim()
    if np.min(late, initial=high) < low + LEGEND * (high - low):
        ax.set_ylim(low, high + LEGEND / (1.0 - LEGEND) * (high - low))
        style.add_legend(ax, loc="upper right")
    else:
        style.add_legend(ax, loc="lower right")


def _joints(
    trial: Trial, values: Series, ax: Axes, label: str, last: float | None, scale: bool
) -> Axes:
    start = trial.time[0] if last is None else max(trial.time[0], trial.time[-1] - last)
    shown = trial.time >= start
    n_joints = values.shape[1]
    if n_joints:
        colors, norm = style.joint_colors(n_joints)
        lines = [np.stack((trial.time[shown], values[shown, i]), axis=1) for i in range(n_joints)]
        drawn = LineCollection(
            lines, cmap=colors, norm=norm, array=list(range(n_joints)), linewidth=0.9
        )
        ax.add_collection(drawn)
        ax.autoscale_view()
        if scale:
            _scale(ax.get_figure(root=True), trial, [ax])
    _from_to(ax, trial.time[shown])
    return style.style_axes(ax, xlabel="time [s]", ylabel=label)


def _scale(figure: Figure | None, trial: Trial, axes: list[Axes]) -> None:
    """Add the color scale of the joints, from tail to head."""
    n_joints = trial.joint_angle.shape[1]
    if figure is None or n_joints == 0:
        return
    colors, norm = style.joint_colors(n_joints)
    bar = figure.colorbar(
        ScalarMappable(norm=norm, cmap=colors), ax=axes, aspect=25, pad=0.03, drawedges=False
    )
    ticks = sorted({0, n_joints - 1})
    bar.set_ticks(
        ticks, labels=[f"{i} ({end})" for i, end in zip(ticks, ("tail", "head"), strict=False)]
    )
    bar.ax.tick_params(labelsize=style.TICK, labelcolor=style.INK, length=0, which="both")
    bar.ax.set_title("joint", fontsize=style.LABEL, color=style.INK, loc="left", pad=5)
    bar.outline.set_visible(False)


def cycle_mean_speed(trial: Trial) -> tuple[Series, Series] | None:
    """Return times [s] and displacement over the cycle around each / its duration [m/s]; None without a whole cycle.

    Args:
        trial: Any trial, including a failed one.
    """
    if trial.period is None:
        return None
    try:
        middle = cycles.cycle_middles(trial.time, trial.period)
    except ValueError:  # too short a run, or too few samples
        return None
    log = trial.time, trial.center_of_mass, trial.center_of_mass_velocity
    before, after = (
        cycles.interpolated(*log, middle + shift * trial.period) for shift in (-0.5, 0.5)
    )
    return middle, np.linalg.norm(after - before, axis=1) / trial.period


def title_of(trial: Trial) -> str:
    """Return a one-line description of robot and motion."""
    return ", ".join(describe_run(trial))


def _from_to(ax: Axes, time: Series) -> None:
    """Let the time axis span exactly the given times."""
    if time.size > 1:
        ax.set_xlim(float(time[0]), float(time[-1]))
        # Few ticks regardless of the width: with more, the layout notices too late that the last
        # label needs space, and fractions of a second have long labels.
        few = 2 if time[-1] - time[0] < 1.0 else 5
        ax.xaxis.set_major_locator(MaxNLocator(few, steps=[1, 2, 5, 10]))


# ---- path following ------------------------------------------------------------------------------


def plot_path_beside(trial: Trial, ax: Axes) -> Axes:
    """Plot the path strip with the desired path, as far as the robot was beside it.

    Args:
        trial: A run with the signals of path following.
        ax: Axes to draw on.
    """
    path_strip(trial, ax)
    ax.plot(*following.nearest_points(trial).T, zorder=0.5, **style.AIM)
    corners: Sequence[tuple[float, float]] = getattr(following.path_of(trial), "waypoints", ())
    if corners:
        ax.plot(
            *np.array(corners).T,
            **style.marker_style("o", 4.0, style.ORANGE, markerfacecolor="white", zorder=0.6),
        )
        style.add_note(ax, "end", corners[-1], (5, -9), color=style.ORANGE)
    return ax


def plot_cross_track_error(trial: Trial, ax: Axes) -> Axes:
    """Plot the distance from the path over time, positive to the left.

    Args:
        trial: A run with the signals of path following.
        ax: Axes to draw on.
    """
    ax.axhline(0.0, **style.AIM)
    ax.plot(trial.time, trial.signals["cross_track_error"], color=style.BLUE, linewidth=style.LINE)
    _from_to(ax, trial.time)
    return style.style_axes(ax, xlabel="time [s]", ylabel="cross-track error [m]")


def plot_heading_against_reference(trial: Trial, ax: Axes) -> Axes:
    """Plot the heading used by the controller, and the reference heading of the guidance, over time.

    Args:
        trial: A run with the signals of path following.
        ax: Axes to draw on.
    """
    used, reference = (np.degrees(trial.signals[name]) for name in ("heading_used", "heading_ref"))
    ax.plot(trial.time, used, color=style.BLUE, linewidth=style.THIN, label="heading")
    ax.plot(trial.time, reference, label="reference", **style.AIM)
    _from_to(ax, trial.time)
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.35 * (high - low))  # space for the legend
    style.add_legend(ax, loc="upper right", ncols=2)
    return style.style_axes(ax, xlabel="time [s]", ylabel="heading [deg]")


def follow_sheet(trial: Trial, *, title: str = "", note: str = "") -> Figure:
    """Create one figure of a path-following run: path with body postures, cross-track error, heading.

    Args:
        trial: A run with the signals of path following.
        title: Title above all panels, which then have letters as in the paper's Figs. 12 to 23; "":
            that of `title_of`, no letters.
        note: A second line under the title; "" for none.
    """
    wide, high = path_extent(trial)
    width = style.DOUBLE_COLUMN
    strip = float(np.clip((width - 0.8) * high / wide, *FOLLOWED_HEIGHT))
    figure = style.new_figure(width, strip + BELOW_HEIGHT + 2.0 * LABELS + TITLE)
    grid = figure.add_gridspec(2, 2, height_ratios=(strip + LABELS, BELOW_HEIGHT + LABELS))
    axes = (
        plot_path_beside(trial, figure.add_subplot(grid[0, :])),
        plot_cross_track_error(trial, figure.add_subplot(grid[1, 0])),
        plot_heading_against_reference(trial, figure.add_subplot(grid[1, 1])),
    )
    if title:
        for place, ax in enumerate(axes):
            style.add_letter(ax, place)
    style.add_title(figure, title or title_of(trial), note)
    return figure


# ---- timing of the loop --------------------------------------------------------------------------


def timing_sheet(
    lateness: Float[np.ndarray, " n_ticks"],
    latency: Float[np.ndarray, " n_ticks"],
    interval: float,
    *,
    note: str = "",
) -> Figure:
    """Plot both timing distributions of a loop in one figure.

    Args:
        lateness: Time from when a tick was due until it began [s].
        latency: Time from when a tick was due until its last frame was sent [s].
        interval: Nominal time between two ticks [s].
        note: Further text, after the numbers of ticks and missed deadlines.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.6)
    left, right = figure.subplots(1, 2)
    plot_timing(left, lateness, interval, "lateness")
    plot_timing(right, latency, interval, "latency")
    missed = int(np.count_nonzero(latency > interval))
    words = f"{latency.size} ticks, {missed} missed deadlines{'; ' if note else ''}{note}"
    style.add_title(figure, f"Operator's loop at {1.0 / interval:g} Hz", words)
    return figure


def plot_timing(
    ax: Axes,
    values: Float[np.ndarray, " n_ticks"],
    interval: float,
    kind: Literal["lateness", "latency"],
) -> Axes:
    """Plot the share of ticks beyond a time, with the median, the 99.9th percentile and the maximum marked.

    Args:
        ax: Axes to draw on.
        values: Value for every tick [s].
        interval: Nominal time between two ticks; a latency beyond it misses its deadline [s].
        kind: Which of the two the values are.
    """
    sorted_ms = 1e3 * np.sort(values)
    n = sorted_ms.size
    beyond = 100.0 * (n - np.arange(n)) / n
    ax.step(sorted_ms, beyond, where="post", color=KINDS[kind], linewidth=style.LINE)
    ax.axvline(1e3 * interval, color=style.GRAY, linewidth=style.THIN, linestyle="--")
    ax.text(1e3 * interval, 400.0, " deadline", fontsize=style.TICK, color=style.GRAY, va="top")
    for name, value, share in (
        ("median", np.median(sorted_ms), 50.0),
        ("99.9 %", np.percentile(sorted_ms, 99.9), 0.1),
        ("largest", sorted_ms[-1], 100.0 / n),
    ):
        ax.plot(value, share, "o", color=KINDS[kind], markersize=3)
        said = style.add_note(
            ax, f"{name} {value:.2f}", (float(value), share), (5, 4), color=style.INK
        )
        said.set(bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5})
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_ylim(50.0 / n, 400.0)
    ax.set_xlim(0.8 * max(sorted_ms[0], 1e-2), 2.5 * max(sorted_ms[-1], 1e3 * interval))
    ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
    ax.xaxis.set_minor_formatter(NullFormatter())
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    return style.style_axes(ax, xlabel=f"{kind} [ms]", ylabel="ticks beyond [%]")
