"""How the difference between two models falls with the step."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes

from laticauda.figures import style

# By curve, told apart by dashes and markers too.
LINES: tuple[tuple[str, Any, str], ...] = (
    (style.BLUE, "-", "o"),
    (style.ORANGE, (0, (5, 2)), "s"),
    (style.INK, (0, (1, 1.5)), "D"),
)


@dataclass(frozen=True, kw_only=True, eq=False)
class ConvergenceCurve:
    """A difference over the step."""

    label: str
    """What the legend says."""
    dt: Float[np.ndarray, " n"]
    """Step [s]."""
    difference: Float[np.ndarray, " n"]
    """In the unit of the axis."""
    order: int
    """That the difference should fall with: a short line of this slope is drawn beside the curve; 0: none [-]."""


def convergence(
    curves: Sequence[ConvergenceCurve], ax: Axes, *, ylabel: str, bounds: Sequence[tuple[float, str]] = ()
) -> Axes:
    """Differences over the step, both logarithmic.

    Args:
        curves: At most three.
        ax: Where to draw.
        ylabel: What the difference is, with its unit.
        bounds: Levels that the differences have to stay below, with what they are called.

    Returns:
        `ax`.
    """
    for curve, (color, dashes, marker) in zip(curves, LINES, strict=False):
        style_of = {"color": color, "linewidth": style.LINE, "marker": marker, "markersize": 3.5}
        ax.loglog(1e3 * curve.dt, curve.difference, linestyle=dashes, label=curve.label, **style_of)
        if curve.order:
            _slope(curve, ax)
    for level, name in bounds:
        ax.axhline(level, color=style.GRAY, linewidth=style.THIN)
        ax.annotate(
            name,
            (0.98, level),
            xycoords=("axes fraction", "data"),
            xytext=(0, 1.5),
            textcoords="offset points",
            ha="right",
            va="bottom",
            fontsize=style.TICK,
            color=style.GRAY,
        )
    style.dress(ax, xlabel="time step of the spatial model [ms]", ylabel=ylabel)
    ax.minorticks_off()
    low, high = ax.get_xlim()
    ticks = [t for t in (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0) if low <= t <= high]
    ax.set_xticks(ticks, [f"{t:g}" for t in ticks])
    return ax


def _slope(curve: ConvergenceCurve, ax: Axes) -> None:
    """The slope of the curve's order, below its largest steps."""
    largest = int(np.argmax(curve.dt))
    dt = curve.dt[largest] * np.array([1.0, 0.5])
    level = 0.3 * curve.difference[largest] * (dt / dt[0]) ** curve.order
    ax.loglog(1e3 * dt, level, color=style.GRAY, linewidth=style.THIN)
    ax.annotate(
        f"order {curve.order}",
        (1e3 * dt[1], level[1]),
        xytext=(2, -3),
        textcoords="offset points",
        ha="left",
        va="top",
        fontsize=style.TICK,
        color=style.GRAY,
    )
