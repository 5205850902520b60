"""How punctual a control loop was: the distribution of its period and its latency."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

from typing import Literal

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from laticauda.figures import style

KINDS = {"period": style.BLUE, "latency": style.ORANGE}


def timing_sheet(
    period: Float[np.ndarray, " n_periods"], latency: Float[np.ndarray, " n_ticks"], interval: float, *, note: str = ""
) -> Figure:
    """Both distributions of a loop in one picture.

    Args:
        period: From the begin of a tick to that of the next [s].
        latency: From when a tick was due until its last frame was sent [s].
        interval: Between two ticks, as asked for [s].
        note: What else there is to say, behind the ticks and the missed deadlines.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.6)
    left, right = figure.subplots(1, 2)
    plot_timing(left, period, interval, "period")
    plot_timing(right, latency, interval, "latency")
    missed = int(np.count_nonzero(latency > interval))
    words = f"{latency.size} ticks, {missed} missed deadlines{'; ' if note else ''}{note}"
    style.head(figure, f"Operator's loop at {1.0 / interval:g} Hz", words)
    return figure


def plot_timing(
    ax: Axes, values: Float[np.ndarray, " n_ticks"], interval: float, kind: Literal["period", "latency"]
) -> Axes:
    """Share of the ticks beyond a time, with the median, the 99th percentile and the largest marked.

    Args:
        ax: To draw on.
        values: Periods or latencies [s].
        interval: Between two ticks, as asked for: beyond it a latency misses its deadline [s].
        kind: Which of both they are.
    """
    sorted_ms = 1e3 * np.sort(values)
    n = sorted_ms.size
    beyond = 100.0 * (n - np.arange(n)) / n
    ax.step(sorted_ms, beyond, where="post", color=KINDS[kind], linewidth=style.LINE)
    ax.axvline(1e3 * interval, color=style.GRAY, linewidth=style.THIN, linestyle="--")
    line = " interval" if kind == "period" else " deadline"
    ax.text(1e3 * interval, 400.0, line, fontsize=style.TICK, color=style.GRAY, va="top")
    for name, value, share in (
        ("median", np.median(sorted_ms), 50.0),
        ("99 %", np.percentile(sorted_ms, 99.0), 1.0),
        ("largest", sorted_ms[-1], 100.0 / n),
    ):
        ax.plot(value, share, "o", color=KINDS[kind], markersize=3)
        said = style.note(ax, f"{name} {value:.2f}", (float(value), share), (5, 4), color=style.INK)
        said.set(bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5})
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_ylim(50.0 / n, 400.0)
    ax.set_xlim(0.8 * max(sorted_ms[0], 1e-2), 2.5 * sorted_ms[-1])
    ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    ax.xaxis.set_minor_formatter(NullFormatter())
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    return style.dress(ax, xlabel=f"{kind} [ms]", ylabel="ticks beyond [%]")
