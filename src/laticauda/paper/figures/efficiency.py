"""Figures of an efficiency study: forward velocity and power over the parameters of the gait, as Figs. 4 to 11."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.container import ErrorbarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from laticauda.figures import style

Values = Float[np.ndarray, " _"]

LABELS = {
    "amplitude": "amplitude $\\alpha$ [deg]",
    "frequency": "frequency $\\omega$ [deg/s]",
    "phase_shift": "phase shift $\\delta$ [deg]",
}
SYMBOLS = {"amplitude": "$\\alpha$ = {:g}°", "frequency": "$\\omega$ = {:g}°/s", "phase_shift": "$\\delta$ = {:g}°"}
# By model, told apart by dashes too.
LINES: tuple[tuple[str, Any], ...] = (
    (style.BLUE, "-"),
    (style.ORANGE, (0, (5, 2))),
    (style.INK, (0, (1, 1.5))),
    (style.AMBER, (0, (5, 1, 1, 1))),
)
REPEATS = "#007A5A"  # a green that is darker than the models' colors
BESIDE = 0.035  # how far right of their setting repeated trials are drawn, as a share of the axis
MARKER = 6.5  # [pt]
PANEL_HEIGHT = 2.1  # [in]
HEAD = 0.42  # height that the title takes [in]
LEGEND_LINE = 0.165  # height of a line of the legend [in]
ROOM = 1.12  # of the highest value
MARGIN = 0.035  # beside the first and the last value


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """A simulated curve over one parameter of the gait."""

    label: str
    """What the legend says."""
    velocity: Float[np.ndarray, " n_values"]
    """Forward velocity [m/s]."""
    power: Float[np.ndarray, " n_values"]
    """Mechanical power [W]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scatter:
    """Repeated trials of one setting on a panel's line of settings."""

    at: float
    """The parameter [rad, rad/s]."""
    velocity: Float[np.ndarray, " n_trials"]
    """Forward velocity; nan where it is missing [m/s]."""
    power: Float[np.ndarray, " n_trials"]
    """Electrical power above idle; nan where it is missing [W]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Marks:
    """What was measured on a panel's line of settings."""

    at: Float[np.ndarray, " n_marks"]
    """The parameter [rad, rad/s]."""
    velocity: Float[np.ndarray, " n_marks"]
    """Forward velocity; nan where it is missing [m/s]."""
    power: Float[np.ndarray, " n_marks"]
    """Electrical power above idle; nan where it is missing [W]."""
    is_maximum: Bool[np.ndarray, " n_marks"]
    """Whether it is given as the fastest of its sweep."""
    scatter: tuple[Scatter, ...] = ()
    """Repeated trials, an entry per setting."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Panel:
    """One parameter of the gait is varied: the data of one panel."""

    parameter: str
    """amplitude, frequency or phase_shift."""
    fixed: dict[str, float]
    """The other two, held [rad, rad/s]."""
    values: Float[np.ndarray, " n_values"]
    """Of the parameter, for all curves [rad, rad/s]."""
    curves: tuple[Curve, ...]
    """In the same order in every panel."""
    measured: Marks
    """What was measured."""


# ---- figures -------------------------------------------------------------------------------------------------------


def velocity_curves(panel: Panel, ax: Axes) -> Axes:
    """Forward velocity (5) over one parameter: a line per model, a mark per measured setting.

    Args:
        panel: The data.
        ax: Where to draw.
    """
    _draw_curves(panel, [curve.velocity for curve in panel.curves], ax)
    _draw_marks(panel, panel.measured.velocity, ax)
    _draw_scatter(panel, _velocities(panel), ax)
    return _dress(panel, ax, "forward velocity [m/s]")


def mechanical_power_curves(panel: Panel, ax: Axes) -> Axes:
    """Simulated mechanical power over one parameter, a line per model.

    Args:
        panel: The data.
        ax: Where to draw.
    """
    _draw_curves(panel, [curve.power for curve in panel.curves], ax)
    return _dress(panel, ax, "mechanical power,\nsimulated [W]")


def electrical_power_marks(panel: Panel, ax: Axes) -> Axes:
    """Measured electrical power over one parameter, a mark per measured setting.

    Args:
        panel: The data.
        ax: Where to draw.
    """
    _draw_marks(panel, panel.measured.power, ax)
    _draw_scatter(panel, _powers(panel), ax)
    if np.all(np.isnan(np.concatenate([panel.measured.power, *_powers(panel)]))):
        ax.text(0.5, 0.5, "not available", transform=ax.transAxes, ha="center", fontsize=style.TICK, color=style.GRAY)
    return _dress(panel, ax, "electrical power,\nmeasured [W]")


def velocity_sheet(panels: Sequence[Panel], title: str) -> Figure:
    """One of Figs. 4 to 7: forward velocity over each parameter, side by side.

    Args:
        panels: One per parameter.
        title: Above all panels.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, PANEL_HEIGHT + _frame(panels))
    axes: list[Axes] = list(figure.subplots(1, len(panels), sharey=True, squeeze=False)[0])
    shown: list[Values] = []
    for panel, ax in zip(panels, axes, strict=True):
        velocity_curves(panel, ax)
        shown += [*(curve.velocity for curve in panel.curves), panel.measured.velocity, *_velocities(panel)]
    _level(axes, shown)
    _finish(figure, [axes], panels, title)
    return figure


def power_sheet(panels: Sequence[Panel], title: str) -> Figure:
    """One of Figs. 8 to 11: the simulated mechanical power above, the measured electrical power below.

    The two differ by what motors and electronics lose, so each has its own axis.

    Args:
        panels: One per parameter.
        title: Above all panels.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, 1.7 * PANEL_HEIGHT + _frame(panels))
    grid = figure.subplots(2, len(panels), sharex="col", sharey="row", squeeze=False)
    above, below = ([*row] for row in grid)
    for panel, upper, lower in zip(panels, above, below, strict=True):
        mechanical_power_curves(panel, upper).set_xlabel("")
        electrical_power_marks(panel, lower)
    _level(above, [curve.power for p in panels for curve in p.curves])
    _level(below, [values for p in panels for values in (p.measured.power, *_powers(p))])
    _finish(figure, [above, below], panels, title)
    return figure


# ---- parts ---------------------------------------------------------------------------------------------------------


def _draw_curves(panel: Panel, quantities: Sequence[Float[np.ndarray, " n_values"]], ax: Axes) -> None:
    for i, quantity in enumerate(quantities):
        color, dashes = LINES[i % len(LINES)]
        ax.plot(np.degrees(panel.values), quantity, color=color, linestyle=dashes, linewidth=1.5)


def _draw_marks(panel: Panel, quantity: Float[np.ndarray, " n_marks"], ax: Axes) -> None:
    known = ~np.isnan(quantity)
    for maximum in (False, True):
        shown = known & (panel.measured.is_maximum == maximum)
        if not np.any(shown):  # the layout takes an empty line that is not clipped for one without end
            continue
        ax.plot(np.degrees(panel.measured.at[shown]), quantity[shown], clip_on=False, zorder=3, **_mark(maximum))


def _velocities(panel: Panel) -> list[Values]:
    return [repeats.velocity for repeats in panel.measured.scatter]


def _powers(panel: Panel) -> list[Values]:
    return [repeats.power for repeats in panel.measured.scatter]


def _draw_scatter(panel: Panel, quantities: Sequence[Values], ax: Axes) -> None:
    """Every repeated trial as a dot, and mean and standard deviation of several: to the right, not over marks."""
    low, high = np.degrees(panel.values[[0, -1]])
    step = BESIDE * float(high - low)
    for repeats, quantity in zip(panel.measured.scatter, quantities, strict=True):
        known = quantity[~np.isnan(quantity)]
        at = float(np.degrees(repeats.at)) + step
        if known.size:
            ax.plot([at] * known.size, known, clip_on=False, zorder=4, **_dot())
        if known.size > 1:
            mean, deviation = float(np.mean(known)), float(np.std(known, ddof=1))
            ax.errorbar([at + 0.8 * step], [mean], yerr=[deviation], capsize=1.8, zorder=4, **_mean())


def _dot() -> dict[str, Any]:
    return {
        "color": REPEATS,
        "linestyle": "none",
        "marker": "o",
        "markersize": 0.4 * MARKER,
        "markerfacecolor": "none",
        "markeredgewidth": 0.6,
    }


def _mean() -> dict[str, Any]:
    return {"color": REPEATS, "linestyle": "none", "marker": "D", "markersize": 0.4 * MARKER}


def _mean_handle() -> ErrorbarContainer:
    """How a legend shows mean and standard deviation."""
    return ErrorbarContainer(
        (Line2D([], [], **_mean()), (), (LineCollection([], colors=REPEATS, linewidths=1.0),)),
        has_yerr=True,
        label="their mean and standard deviation",
    )


def _mark(maximum: bool) -> dict[str, Any]:
    face = style.INK if maximum else "white"
    return {
        "color": style.INK,
        "linestyle": "none",
        "marker": "*" if maximum else "o",
        "markersize": 1.5 * MARKER if maximum else 0.85 * MARKER,
        "markerfacecolor": face,
        "markeredgewidth": 0.9,
    }


def _dress(panel: Panel, ax: Axes, ylabel: str) -> Axes:
    low, high = np.degrees(panel.values[[0, -1]])
    if high > low:
        margin = MARGIN * float(high - low)  # a mark at the end keeps off the next panel
        beside = 2.0 * BESIDE * float(high - low)
        farthest = max([float(high), *(math.degrees(repeats.at) + beside for repeats in panel.measured.scatter)])
        ax.set_xlim(float(low) - margin, farthest + margin)
    ax.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2.5, 5, 10]))
    ax.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
    return style.dress(ax, xlabel=LABELS[panel.parameter], ylabel=ylabel)


def _level(axes: Sequence[Axes], shown: Sequence[Float[np.ndarray, " _"]]) -> None:
    """One scale from zero for axes that share it."""
    highest = np.nanmax(np.concatenate([[0.0], *shown]))
    axes[0].set_ylim(0.0, ROOM * float(highest) if highest > 0.0 else 1.0)


def _finish(figure: Figure, rows: Sequence[Sequence[Axes]], panels: Sequence[Panel], title: str) -> None:
    """What is beside the data: letters, what is held, legend and title."""
    for letter, ax, panel in zip("abcdefgh", rows[0], panels, strict=False):
        held = ", ".join(SYMBOLS[name].format(float(np.degrees(value))) for name, value in panel.fixed.items())
        ax.set_title(f"({letter})  {held}", fontsize=style.TICK, color=style.INK, loc="left", pad=6)
    for row in rows:
        for ax in row[1:]:
            ax.set_ylabel("")
            ax.tick_params(labelleft=False)
        for ax in row:
            ax.grid(axis="y", color="#E4E4E4", linewidth=style.THIN)
            ax.set_axisbelow(True)
    figure.align_ylabels([row[0] for row in rows])
    figure.suptitle(title, fontsize=style.LABEL, color=style.INK, x=0.01, ha="left")
    figure.legend(
        handles=_handles(panels),
        loc="outside lower center",
        ncols=2,
        fontsize=style.TICK,
        labelcolor=style.INK,
        frameon=False,
        handlelength=2.6,
    )


def _handles(panels: Sequence[Panel]) -> list[Line2D | ErrorbarContainer]:
    """What the legend shows."""
    handles: list[Line2D | ErrorbarContainer] = []
    for i, curve in enumerate(panels[0].curves):
        color, dashes = LINES[i % len(LINES)]
        handles.append(Line2D([], [], color=color, linestyle=dashes, linewidth=1.5, label=curve.label))
    for maximum, label in ((True, "measured, fastest of its sweep"), (False, "measured, another setting")):
        handles.append(Line2D([], [], label=label, **_mark(maximum)))
    if any(panel.measured.scatter for panel in panels):
        handles.append(Line2D([], [], label="repeated trials, beside their setting", **_dot()))
        handles.append(_mean_handle())
    return handles


def _frame(panels: Sequence[Panel]) -> float:
    """Height of what is around the panels [in]."""
    return HEAD + LEGEND_LINE * math.ceil(len(_handles(panels)) / 2)
