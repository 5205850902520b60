"""How punctual a control loop was: the distribution of its period and its latency."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

from typing import Literal

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes

from laticauda.figures.style import BLUE, GRAY, INK, LINE, ORANGE, THIN, TICK, dress

KINDS = {"period": BLUE, "latency": ORANGE}


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
    ax.step(sorted_ms, beyond, where="post", color=KINDS[kind], linewidth=LINE)
    ax.axvline(1e3 * interval, color=GRAY, linewidth=THIN, linestyle="--")
    ax.text(
        1e3 * interval, 130.0, "interval" if kind == "period" else "deadline", fontsize=TICK, color=GRAY, ha="center"
    )
    for name, value, share in (
        ("median", np.median(sorted_ms), 50.0),
        ("99 %", np.percentile(sorted_ms, 99.0), 1.0),
        ("largest", sorted_ms[-1], 100.0 / n),
    ):
        ax.plot(value, share, "o", color=KINDS[kind], markersize=3)
        ax.annotate(f"{name} {value:.2f}", (value, share), (5, 4), textcoords="offset points", fontsize=TICK, color=INK)
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_ylim(50.0 / n, 250.0)
    ax.set_xlim(0.8 * max(sorted_ms[0], 1e-2), 2.5 * sorted_ms[-1])
    return dress(ax, xlabel=f"{kind} [ms]", ylabel="ticks beyond [%]")
