"""Timing of the loop of an operated run: the distributions of its lateness and its latency."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from laticauda.show.figures import style

HEIGHT = 2.6
"""Height of the figure [in]."""
COLORS = {"lateness": style.BLUE, "latency": style.ORANGE}
"""Colors of the times of a loop."""
HIGHEST_SHARE = 400.0
"""Upper end of the axis of shares: space for the word at the deadline [%]."""


@dataclass(frozen=True)
class _Mark:
    """A point of a distribution with its name."""

    name: str
    time: float
    """Time [ms]."""
    share: float
    """Share of ticks beyond it [%]."""


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
    figure = style.new_figure(style.DOUBLE_COLUMN, HEIGHT)
    left, right = figure.subplots(1, 2)
    plot_timing(left, lateness, interval, "lateness")
    plot_timing(right, latency, interval, "latency")
    n_missed = int(np.count_nonzero(latency > interval))
    counts = f"{latency.size} ticks, {n_missed} missed deadlines"
    if note:
        counts += f"; {note}"
    style.add_title(figure, f"Operator's loop at {1.0 / interval:g} Hz", counts)
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
    color = COLORS[kind]
    deadline = 1e3 * interval
    times = 1e3 * np.sort(values)
    n_ticks = times.size
    shares = 100.0 * (n_ticks - np.arange(n_ticks)) / n_ticks
    ax.step(times, shares, where="post", color=color, linewidth=style.LINE)
    ax.axvline(deadline, color=style.GRAY, linewidth=style.THIN, linestyle="--")
    ax.text(deadline, HIGHEST_SHARE, " deadline", fontsize=style.TICK, color=style.GRAY, va="top")
    for mark in (
        _Mark("median", float(np.median(times)), 50.0),
        _Mark("99.9 %", float(np.percentile(times, 99.9)), 0.1),
        _Mark("largest", float(times[-1]), 100.0 / n_ticks),
    ):
        ax.plot(mark.time, mark.share, "o", color=color, markersize=3)
        text = style.add_note(
            ax, f"{mark.name} {mark.time:.2f}", (mark.time, mark.share), (5, 4), color=style.INK
        )
        text.set(bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5})
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_ylim(50.0 / n_ticks, HIGHEST_SHARE)
    ax.set_xlim(0.8 * max(times[0], 1e-2), 2.5 * max(times[-1], deadline))
    ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
    ax.xaxis.set_minor_formatter(NullFormatter())
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    return style.style_axes(ax, xlabel=f"{kind} [ms]", ylabel="ticks beyond [%]")
