"""Figures of an efficiency study: forward velocity and power over the parameters of the gait, as Figs. 4 to 11."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from laticauda.figures import style

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
MARKER = 6.5  # [pt]
PANEL_HEIGHT = 2.1  # [in]
HEAD = 0.75  # height that title and legend take [in]
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
    if np.all(np.isnan(panel.measured.power)):
        ax.text(0.5, 0.5, "not available", transform=ax.transAxes, ha="center", fontsize=style.TICK, color=style.GRAY)
    return _dress(panel, ax, "electrical power,\nmeasured [W]")


def velocity_sheet(panels: Sequence[Panel], title: str) -> Figure:
    """One of Figs. 4 to 7: forward velocity over each parameter, side by side.

    Args:
        panels: One per parameter.
        title: Above all panels.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, PANEL_HEIGHT + HEAD)
    axes: list[Axes] = list(figure.subplots(1, len(panels), sharey=True, squeeze=False)[0])
    for panel, ax in zip(panels, axes, strict=True):
        velocity_curves(panel, ax)
    _level(axes, [np.concatenate([*(curve.velocity for curve in p.curves), p.measured.velocity]) for p in panels])
    _finish(figure, [axes], panels, title)
    return figure


def power_sheet(panels: Sequence[Panel], title: str) -> Figure:
    """One of Figs. 8 to 11: the simulated mechanical power above, the measured electrical power below.

    The two differ by what motors and electronics lose, so each has its own axis.

    Args:
        panels: One per parameter.
        title: Above all panels.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, 1.7 * PANEL_HEIGHT + HEAD)
    grid = figure.subplots(2, len(panels), sharex="col", sharey="row", squeeze=False)
    above, below = ([*row] for row in grid)
    for panel, upper, lower in zip(panels, above, below, strict=True):
        mechanical_power_curves(panel, upper).set_xlabel("")
        electrical_power_marks(panel, lower)
    _level(above, [curve.power for p in panels for curve in p.curves])
    _level(below, [p.measured.power for p in panels])
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
        ax.set_xlim(float(low) - margin, float(high) + margin)
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
    handles: list[Line2D] = []
    for i, curve in enumerate(panels[0].curves):
        color, dashes = LINES[i % len(LINES)]
        handles.append(Line2D([], [], color=color, linestyle=dashes, linewidth=1.5, label=curve.label))
    for maximum, label in ((True, "measured, fastest of its sweep"), (False, "measured, another setting")):
        handles.append(Line2D([], [], label=label, **_mark(maximum)))
    figure.suptitle(title, fontsize=style.LABEL, color=style.INK, x=0.01, ha="left")
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=2,
        fontsize=style.TICK,
        labelcolor=style.INK,
        frameon=False,
        handlelength=2.6,
    )
