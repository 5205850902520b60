"""Whether the closed form and the 3D engine agree, for readers: a table and the convergence plot."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from laticauda.figures import style
from laticauda.paper.parity import ORDERS, ParityStudy
from laticauda.paper.report.chapter import paper_chapter
from laticauda.reports.chapter import Chapter

ACCEPTED = 3e-3  # of the distance [-]
MARKERS = "osD"  # by curve


def parity_chapter(study: ParityStudy) -> Chapter:
    """What the comparison puts into the folder and the report.

    Args:
        study: What `run_parity` returned.
    """
    rows = [
        {
            "case": row.case,
            "step of the spatial model [ms]": 1000.0 * row.dt,
            "path / distance [-]": row.path,
            "after Richardson extrapolation [-]": row.richardson,
            "rotation [rad]": row.rotation,
            "heading [rad]": row.heading,
        }
        for row in study.rows
    ]
    dt, path = min(study.worst("path").items())
    return paper_chapter(
        "parity",
        values={"study": study, "dt": dt, "path": path},
        tables={"parity": rows},
        n_figures=1,
        figures=lambda: parity_figures(study),
    )


def parity_figures(study: ParityStudy) -> Iterator[tuple[str, str, Figure]]:
    """The convergence plot: the name of its file, what it shows, and the figure.

    Args:
        study: What `run_parity` returned.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.9)
    labels = {"path": "path: largest difference / distance [-]", "heading": "heading: largest difference [rad]"}
    joints = str(study.how["joints"])
    for ax, (name, label) in zip(figure.subplots(1, 2), labels.items(), strict=True):
        bounds = [(ACCEPTED, "0.3 %")] if name == "path" else []
        curve = f"{joints} joints"
        convergence({curve: study.worst(name)}, ax, ylabel=label, orders={curve: ORDERS[joints]}, bounds=bounds)
    yield "parity", "Planar and spatial model over the step of the spatial one: the worst of all cases.", figure


def convergence(
    curves: Mapping[str, Mapping[float, float]],
    ax: Axes,
    *,
    ylabel: str,
    orders: Mapping[str, int],
    bounds: Sequence[tuple[float, str]] = (),
) -> Axes:
    """Differences over the step, both logarithmic.

    Args:
        curves: At most three: by what the legend says, the difference by step [s].
        ax: Where to draw.
        ylabel: What the difference is, with its unit.
        orders: With which power of the step curves should fall: a short line of this slope is drawn beside each [-].
        bounds: Levels that the differences have to stay below, with what they are called.

    Returns:
        `ax`.
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
    return ax


def _slope(curve: Mapping[float, float], order: int, ax: Axes) -> None:
    """The slope of the curve's order, below its largest steps."""
    dt = max(curve) * np.array([1.0, 0.5])
    level = 0.3 * curve[max(curve)] * (dt / dt[0]) ** order
    ax.loglog(1e3 * dt, level, color=style.GRAY, linewidth=style.THIN)
    style.note(ax, f"order {order}", (float(1e3 * dt[1]), float(level[1])), (2, -3), ha="left", va="top")
