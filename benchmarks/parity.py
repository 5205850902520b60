"""Do the closed form and MuJoCo with water agree, and how does the difference fall with the step?

Question: is the spatial model (planar root, no gravity) within 0.3 % of the distance at 0.5 ms, and within 0.1 % after
Richardson extrapolation, for every case and every drive? Path: largest distance between the two paths over the distance
traveled in 30 s, the best rotation about the start taken out. The planar run has a quarter of the smallest step.

Last answer (2026-11-21), the worst of lateral, eel-like, turning, fin and current:
    prescribed  0.0500 s   path 5.8e-05   Richardson -          heading 4.9e-04 rad
    prescribed  0.0250 s   path 3.1e-06   Richardson 6.5e-07    heading 3.0e-05 rad
    prescribed  0.0125 s   path 1.8e-07   Richardson 1.8e-08    heading 1.8e-06 rad
    prescribed  0.0063 s   path 1.1e-08   Richardson 7.1e-09    heading 1.3e-07 rad
    prescribed  0.0031 s   path 6.8e-09   Richardson 6.9e-09    heading 4.2e-08 rad
    prescribed  0.0010 s   path 6.9e-09   Richardson -          heading 3.6e-08 rad
    prescribed  0.0005 s   path 6.9e-09   Richardson 6.9e-09    heading 3.6e-08 rad
    pd          0.0040 s   path 7.4e-04   Richardson -          heading 2.2e-04 rad
    pd          0.0020 s   path 2.3e-04   Richardson 6.6e-05    heading 6.4e-05 rad
    pd          0.0010 s   path 6.7e-05   Richardson 1.1e-05    heading 1.7e-05 rad
    pd          0.0005 s   path 1.8e-05   Richardson 2.0e-06    heading 4.3e-06 rad
    servo       0.0040 s   path 6.9e-04   Richardson -          heading 4.7e-04 rad
    servo       0.0020 s   path 1.9e-04   Richardson 2.6e-05    heading 1.3e-04 rad
    servo       0.0010 s   path 4.9e-05   Richardson 9.8e-07    heading 3.2e-05 rad
    servo       0.0005 s   path 1.2e-05   Richardson 1.4e-07    heading 7.8e-06 rad
"""

import sys
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from laticauda.figures import new_figure, save_figure, style
from laticauda.paper import Parity, parity_cases
from laticauda.paper.parity import parity

STEPS = {
    "prescribed": (0.05, 0.025, 0.0125, 0.00625, 0.003125, 0.001, 0.0005),
    "pd": (0.004, 0.002, 0.001, 0.0005),
    "servo": (0.004, 0.002, 0.001, 0.0005),
}
MARKERS = "osD"  # by curve
ORDERS = {"prescribed": 4, "pd": 2}  # servo's slope would lie on that of pd


def main() -> None:
    """Print the table; with a file's name as argument, draw the picture of the docs into it."""
    names = f"{'path':>10}{'Richardson':>12}{'rotation [rad]':>16}{'heading [rad]':>15}"
    print(f"{'case':<10}{'joints':<12}{'dt [s]':>8}{names}")
    rows: list[Parity] = []
    for joints, steps in STEPS.items():
        for case in parity_cases():
            for row in parity(case, joints, steps):
                extrapolated = "-" if row.richardson is None else f"{row.richardson:.1e}"
                print(
                    f"{row.case:<10}{row.joints:<12}{row.dt:>8.4f}{row.path:>10.1e}{extrapolated:>12}"
                    f"{row.rotation:>16.1e}{row.heading:>15.1e}",
                    flush=True,
                )
                rows.append(row)
    if len(sys.argv) > 1:
        draw(rows, sys.argv[1])


def draw(rows: list[Parity], path: str) -> None:
    """The worst case at every step."""
    figure = new_figure(style.DOUBLE_COLUMN, 2.9)
    left, right = figure.subplots(1, 2)
    for ax, name, label in (
        (left, "path", "path: largest difference / distance [-]"),
        (right, "heading", "heading: largest difference [rad]"),
    ):
        curves = {
            joints: {dt: max(getattr(r, name) for r in rows if (r.joints, r.dt) == (joints, dt)) for dt in steps}
            for joints, steps in STEPS.items()
        }
        bounds = [(3e-3, "0.3 %")] if name == "path" else []
        convergence(curves, ax, ylabel=label, orders=ORDERS, bounds=bounds)
    style.legend(left, loc="lower right")
    save_figure(figure, path)


def convergence(
    curves: Mapping[str, Mapping[float, float]],
    ax: Axes,
    *,
    ylabel: str,
    orders: Mapping[str, int],
    bounds: Sequence[tuple[float, str]] = (),
) -> None:
    """Differences over the step, both logarithmic.

    Args:
        curves: At most three: by what the legend says, the difference by step [s].
        ax: Where to draw.
        ylabel: What the difference is, with its unit.
        orders: With which power of the step curves should fall: a short line of this slope is drawn beside each [-].
        bounds: Levels that the differences have to stay below, with what they are called.
    """
    for (label, curve), (color, dashes), marker in zip(curves.items(), style.LINES, MARKERS, strict=False):
        style_of = {"color": color, "linewidth": style.LINE, "marker": marker, "markersize": 3.5}
        steps, differences = 1e3 * np.array([*curve]), [*curve.values()]
        ax.loglog(steps, differences, linestyle=dashes, label=label, **style_of)
        if label in orders:
            _slope(curve, orders[label], ax)
    for level, name in bounds:
        ax.axhline(level, color=style.GRAY, linewidth=style.THIN)
        at_right: Any = {"xycoords": ("axes fraction", "data"), "ha": "right"}
        style.note(ax, name, (0.98, level), (0, 1.5), va="bottom", **at_right)
    style.dress(ax, xlabel="time step of the spatial model [ms]", ylabel=ylabel)
    ax.minorticks_off()
    low, high = ax.get_xlim()
    ticks = [t for t in (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0) if low <= t <= high]
    ax.set_xticks(ticks, [f"{t:g}" for t in ticks])


def _slope(curve: Mapping[float, float], order: int, ax: Axes) -> None:
    """The slope of the curve's order, below its largest steps."""
    dt = max(curve) * np.array([1.0, 0.5])
    level = 0.3 * curve[max(curve)] * (dt / dt[0]) ** order
    ax.loglog(1e3 * dt, level, color=style.GRAY, linewidth=style.THIN)
    style.note(ax, f"order {order}", (float(1e3 * dt[1]), float(level[1])), (2, -3), ha="left", va="top")


if __name__ == "__main__":
    main()
