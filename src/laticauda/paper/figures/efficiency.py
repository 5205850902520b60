"""Figures of an efficiency study: forward velocity and power over the parameters of the gait, as Figs. 4 to 11."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.container import ErrorbarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from laticauda.figures import style
from laticauda.paper.measured import MeasuredCase
from laticauda.paper.repeats import Repeat
from laticauda.paper.settings import SweepSettings

Curves = Float[np.ndarray, "n_curves n_values"]
Values = Float[np.ndarray, " _"]

LABELS = {
    "amplitude": "amplitude $\\alpha$ [deg]",
    "frequency": "frequency $\\omega$ [deg/s]",
    "phase_shift": "phase shift $\\delta$ [deg]",
}
SYMBOLS = {"amplitude": "$\\alpha$ = {:g}°", "frequency": "$\\omega$ = {:g}°/s", "phase_shift": "$\\delta$ = {:g}°"}
REPEATS = "#007A5A"  # a green that is darker than the models' colors
BESIDE = 0.035  # how far right of their setting repeated trials are drawn, as a share of the axis
MARKER = 6.5  # [pt]
PANEL_HEIGHT = 2.1  # [in]
HEAD = 0.42  # height that the title takes [in]
LEGEND_LINE = 0.165  # height of a line of the legend [in]
ROOM = 1.12  # of the highest value
MARGIN = 0.035  # beside the first and the last value


@dataclass(frozen=True, kw_only=True, eq=False)
class Panel:
    """One parameter of the gait is varied: the data of one panel."""

    sweep: SweepSettings
    """What is varied, and what is held."""
    labels: tuple[str, ...]
    """What the legend says to each curve."""
    velocity: Curves
    """Simulated forward velocity [m/s]."""
    power: Curves
    """Simulated mechanical power [W]."""
    measured: tuple[MeasuredCase, ...]
    """The measured settings on this line."""
    repeats: tuple[Repeat, ...]
    """The settings on this line that were repeated."""

    @property
    def velocities(self) -> list[Values]:
        """Repeated, by setting; nan where one is missing [m/s]."""
        return [np.array(one.forward_velocity, dtype=float) for one in self.repeats]

    @property
    def powers(self) -> list[Values]:
        """The same of the electrical power above idle [W]."""
        return [np.array(one.mean_power, dtype=float) for one in self.repeats]

    def marks(self, name: str) -> Values:
        """What was measured, by setting; nan where it is missing.

        Args:
            name: forward_velocity [m/s] or mean_power [W].
        """
        return np.array([getattr(one, name) for one in self.measured], dtype=float)

    def at(self, found: Sequence[MeasuredCase] | Sequence[Repeat]) -> Values:
        """Where settings lie on the axis [deg, deg/s].

        Args:
            found: Some that were measured.
        """
        return np.degrees([getattr(one.gait, self.sweep.parameter) for one in found])


# ---- figures -------------------------------------------------------------------------------------------------------


def velocity_curves(panel: Panel, ax: Axes) -> Axes:
    """Forward velocity (5) over one parameter: a line per model, a mark per measured setting.

    Args:
        panel: The data.
        ax: Where to draw.
    """
    _draw_curves(panel, panel.velocity, ax)
    _draw_marks(panel, panel.marks("forward_velocity"), ax)
    _draw_scatter(panel, panel.velocities, ax)
    return _dress(panel, ax, "forward velocity [m/s]")


def mechanical_power_curves(panel: Panel, ax: Axes) -> Axes:
    """Simulated mechanical power over one parameter, a line per model.

    Args:
        panel: The data.
        ax: Where to draw.
    """
    _draw_curves(panel, panel.power, ax)
    return _dress(panel, ax, "mechanical power,\nsimulated [W]")


def electrical_power_marks(panel: Panel, ax: Axes) -> Axes:
    """Measured electrical power over one parameter, a mark per measured setting.

    Args:
        panel: The data.
        ax: Where to draw.
    """
    _draw_marks(panel, panel.marks("mean_power"), ax)
    _draw_scatter(panel, panel.powers, ax)
    if np.all(np.isnan(np.concatenate([panel.marks("mean_power"), *panel.powers]))):
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
        shown += [*panel.velocity, panel.marks("forward_velocity"), *panel.velocities]
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
    _level(above, [curve for panel in panels for curve in panel.power])
    _level(below, [values for panel in panels for values in (panel.marks("mean_power"), *panel.powers)])
    _finish(figure, [above, below], panels, title)
    return figure


# ---- parts ---------------------------------------------------------------------------------------------------------


def _draw_curves(panel: Panel, curves: Curves, ax: Axes) -> None:
    for i, curve in enumerate(curves):
        color, dashes = style.LINES[i % len(style.LINES)]
        ax.plot(np.degrees(panel.sweep.values), curve, color=color, linestyle=dashes, linewidth=1.5)


def _draw_marks(panel: Panel, quantity: Values, ax: Axes) -> None:
    starred = np.array([one.starred == panel.sweep.parameter for one in panel.measured], dtype=bool)
    for maximum in (False, True):
        shown = ~np.isnan(quantity) & (starred == maximum)
        if not np.any(shown):  # the layout takes an empty line that is not clipped for one without end
            continue
        ax.plot(panel.at(panel.measured)[shown], quantity[shown], clip_on=False, zorder=3, **_mark(maximum))


def _draw_scatter(panel: Panel, quantities: Sequence[Values], ax: Axes) -> None:
    """Every repeated trial as a dot, and mean and standard deviation of several: to the right, not over marks."""
    low, high = np.degrees(panel.sweep.values[[0, -1]])
    step = BESIDE * float(high - low)
    for place, quantity in zip(panel.at(panel.repeats).tolist(), quantities, strict=True):
        known, at = quantity[~np.isnan(quantity)], place + step
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
    low, high = np.degrees(panel.sweep.values[[0, -1]])
    if high > low:
        margin = MARGIN * float(high - low)  # a mark at the end keeps off the next panel
        beside = 2.0 * BESIDE * float(high - low)
        farthest = max([float(high), *(panel.at(panel.repeats) + beside)])
        ax.set_xlim(float(low) - margin, farthest + margin)
    ax.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2.5, 5, 10]))
    ax.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
    return style.dress(ax, xlabel=LABELS[panel.sweep.parameter], ylabel=ylabel)


def _level(axes: Sequence[Axes], shown: Sequence[Float[np.ndarray, " _"]]) -> None:
    """One scale from zero for axes that share it."""
    highest = np.nanmax(np.concatenate([[0.0], *shown]))
    axes[0].set_ylim(0.0, ROOM * float(highest) if highest > 0.0 else 1.0)


def _finish(figure: Figure, rows: Sequence[Sequence[Axes]], panels: Sequence[Panel], title: str) -> None:
    """What is beside the data: letters, what is held, legend and title."""
    for place, (ax, panel) in enumerate(zip(rows[0], panels, strict=True)):
        held = [SYMBOLS[name].format(float(np.degrees(value))) for name, value in panel.sweep.fixed.items()]
        style.letter(ax, place, ", ".join(held), pad=6)
    for row in rows:
        for ax in row[1:]:
            ax.set_ylabel("")
            ax.tick_params(labelleft=False)
        for ax in row:
            style.light_grid(ax, "y")
    figure.align_ylabels([row[0] for row in rows])
    figure.suptitle(title, fontsize=style.LABEL, color=style.INK, x=0.01, ha="left")
    style.legend_below(figure, _handles(panels))


def _handles(panels: Sequence[Panel]) -> list[Line2D | ErrorbarContainer]:
    """What the legend shows."""
    handles: list[Line2D | ErrorbarContainer] = []
    for i, label in enumerate(panels[0].labels):
        color, dashes = style.LINES[i % len(style.LINES)]
        handles.append(Line2D([], [], color=color, linestyle=dashes, linewidth=1.5, label=label))
    for maximum, label in ((True, "measured, fastest of its sweep"), (False, "measured, another setting")):
        handles.append(Line2D([], [], label=label, **_mark(maximum)))
    if any(panel.repeats for panel in panels):
        handles.append(Line2D([], [], label="repeated trials, beside their setting", **_dot()))
        handles.append(_mean_handle())
    return handles


def _frame(panels: Sequence[Panel]) -> float:
    """Height of what is around the panels [in]."""
    return HEAD + LEGEND_LINE * math.ceil(len(_handles(panels)) / 2)
