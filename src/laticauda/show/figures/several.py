"""Several runs in one figure: overlaid paths and speeds."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

import itertools
import math
from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure

from laticauda.show.figures import style
from laticauda.show.figures.swim import cycle_mean_speed, forward_speed
from laticauda.trials import Trial

HEIGHT = 3.0
"""Height of a figure, without its legend or title [in]."""
LEGEND_ROW = 0.2
"""Height of a row of a legend [in]."""


def plot_overlay(trials: Sequence[Trial], names: Sequence[str]) -> Figure:
    """Plot the paths of several trials on top of each other, and their speeds as means over a gait cycle.

    Args:
        trials: Any trials; for one without whole gait cycles, the forward speed itself is drawn.
        names: Name of each trial; one that failed is marked.
    """
    n_rows = math.ceil(len(trials) / 2)
    figure = style.new_figure(style.DOUBLE_COLUMN, HEIGHT + LEGEND_ROW * n_rows)
    path, velocity = figure.subplots(1, 2, width_ratios=(1.2, 1.0))
    for trial, name, (color, dashes) in zip(
        trials, names, itertools.cycle(_line_looks()), strict=False
    ):
        look: Any = {"color": color, "linestyle": dashes, "linewidth": style.LINE}
        label = name if trial.succeeded else f"{name}: FAILED"
        path.plot(*trial.center_of_mass[:, :2].T, **look, label=label)
        path.plot(*trial.center_of_mass[-1, :2], **style.marker_style("o", 3.5, color))
        mean = cycle_mean_speed(trial)
        if mean is None:
            velocity.plot(trial.time, forward_speed(trial), **look)
        else:
            velocity.plot(mean.time, mean.speed, **look)
    path.set_aspect("equal", adjustable="datalim")
    style.outside_legend(figure, path.get_legend_handles_labels()[0], "outside lower left", ncols=2)
    style.style_axes(path, xlabel="x [m]", ylabel="y [m]")
    style.style_axes(velocity, xlabel="time [s]", ylabel="speed, mean over a cycle [m/s]")
    return figure


def _line_looks() -> list[tuple[str, Any]]:
    """Return all distinct combinations of line colors and dashes."""
    n_lines = len(style.LINES)
    looks: list[tuple[str, Any]] = []
    for shift in range(n_lines):
        for i, (color, _) in enumerate(style.LINES):
            _, dashes = style.LINES[(i + shift) % n_lines]
            looks.append((color, dashes))
    return looks
