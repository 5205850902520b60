"""Figures of the paper's studies: forward velocity and power over the parameters of the gait, as in Figs. 4 to 11.

Also the speeds of path-following trials: measured, simulated in several ways, and predicted without
physics.
"""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.container import ErrorbarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from laticauda.paper.efficiency import Repeat
from laticauda.paper.measured import MeasuredCase
from laticauda.paper.path_following import FollowingCase, group_by_law
from laticauda.paper.settings import SweepSettings
from laticauda.show.figures import style

Curves = Float[np.ndarray, "n_curves n_values"]
Values = Float[np.ndarray, " _"]

LABELS = {
    "amplitude": "amplitude $\\alpha$ [deg]",
    "frequency": "frequency $\\omega$ [deg/s]",
    "phase_shift": "phase shift $\\delta$ [deg]",
}
SYMBOLS = {
    "amplitude": "$\\alpha$ = {:g}°",
    "frequency": "$\\omega$ = {:g}°/s",
    "phase_shift": "$\\delta$ = {:g}°",
}
VELOCITY = ("forward velocity [m/s]",)
POWERS = ("mechanical power,\nsimulated [W]", "electrical power,\nmeasured [W]")
SHOWN = {
    VELOCITY[0]: ("velocity", "forward_velocity"),
    POWERS[0]: ("power", ""),
    POWERS[1]: ("", "mean_power"),
}
"""By axis label, the names of the data shown: of the curves of a panel, and of the fields in rows of a table."""
REPEATS = "#007A5A"  # a green that is darker than the models' colors
BESIDE = 0.035  # shift of repeated trials to the right of their setting, as a fraction of the axis
MARKER = 6.5  # [pt]
MARKS = {
    "measured, fastest of its sweep": style.marker_style(
        "*", 1.5 * MARKER, markerfacecolor=style.INK, markeredgewidth=0.9
    ),
    "measured, another setting": style.marker_style(
        "o", 0.85 * MARKER, markerfacecolor="white", markeredgewidth=0.9
    ),
}
"""By legend label."""
TRIAL = style.marker_style("o", 0.4 * MARKER, REPEATS, markerfacecolor="none", markeredgewidth=0.6)
MEAN = style.marker_style("D", 0.4 * MARKER, REPEATS)
PANEL_HEIGHT = 2.1  # [in]
HEAD = 0.42  # height of the title [in]
LEGEND_LINE = 0.165  # height of a line of the legend [in]
ROOM = 1.12  # upper end of the axis, as a multiple of the highest value
MARGIN = 0.035  # margin at the first and the last value, as a fraction of the axis


@dataclass(frozen=True, kw_only=True, eq=False)
class Panel:
    """Data of one panel, in which one parameter of the gait is varied."""

    sweep: SweepSettings
    """Parameter that is varied, and parameters that are held fixed."""
    labels: tuple[str, ...]
    """Legend label of each curve."""
    velocity: Curves
    """Simulated forward velocity [m/s]."""
    power: Curves
    """Simulated mechanical power [W]."""
    measured: tuple[MeasuredCase, ...]
    """Measured settings on this line."""
    repeats: tuple[Repeat, ...]
    """Repeated settings on this line."""

    def at(self, found: Sequence[MeasuredCase] | Sequence[Repeat]) -> Values:
        """Return the positions of settings on the axis [deg, deg/s].

        Args:
            found: Measured settings.
        """
        return np.degrees([getattr(one.gait, self.sweep.parameter) for one in found])


# ---- figures -------------------------------------------------------------------------------------


def draw_panel(panel: Panel, ax: Axes, ylabel: str) -> Axes:
    """Draw a quantity over one parameter, with a line per model and a mark per measured setting.

    Args:
        panel: Data of the panel.
        ax: Axes to draw on.
        ylabel: Axis label, one of `SHOWN`.
    """
    of_curves, of_rows = SHOWN[ylabel]
    curves: Sequence[Values] = [*getattr(panel, of_curves)] if of_curves else []
    marks = np.array([getattr(one, of_rows, None) for one in panel.measured], dtype=float)
    repeated = [np.array(getattr(one, of_rows, ()), dtype=float) for one in panel.repeats]
    for i, curve in enumerate(curves):
        color, dashes = style.LINES[i % len(style.LINES)]
        ax.plot(np.degrees(panel.sweep.values), curve, color=color, linestyle=dashes, linewidth=1.5)
    _draw_marks(panel, marks, ax)
    _draw_scatter(panel, repeated, ax)
    if np.all(np.isnan(np.concatenate([*curves, marks, *repeated]))):
        ax.text(
            0.5,
            0.5,
            "not available",
            transform=ax.transAxes,
            ha="center",
            fontsize=style.TICK,
            color=style.GRAY,
        )
    return _dress(panel, ax, ylabel)


def efficiency_sheet(panels: Sequence[Panel], title: str, ylabels: Sequence[str]) -> Figure:
    """Draw one of Figs. 4 to 11: quantities over each parameter side by side, one row per quantity.

    The simulated mechanical power and the measured electrical power differ by the losses of motors
    and electronics, so each has its own axis.

    Args:
        panels: One panel per parameter.
        title: Title above all panels.
        ylabels: Axis labels of the rows, from `SHOWN`.
    """
    height = PANEL_HEIGHT * (1.0 + 0.7 * (len(ylabels) - 1))
    figure = style.new_figure(
        style.DOUBLE_COLUMN, height + HEAD + LEGEND_LINE * math.ceil(len(_handles(panels)) / 2)
    )
    grid = figure.subplots(len(ylabels), len(panels), sharex="col", sharey="row", squeeze=False)
    rows: list[list[Axes]] = [[*row] for row in grid]
    for ylabel, row in zip(ylabels, rows, strict=True):
        for panel, ax in zip(panels, row, strict=True):
            draw_panel(panel, ax, ylabel)
            if row is not rows[-1]:
                ax.set_xlabel("")
        highest = max([0.0, *(ax.dataLim.y1 for ax in row)])
        row[0].set_ylim(0.0, ROOM * highest if highest > 0.0 else 1.0)  # a common scale from zero
    _finish(figure, rows, panels, title)
    return figure


# ---- parts ---------------------------------------------------------------------------------------


def _draw_marks(panel: Panel, quantity: Values, ax: Axes) -> None:
    starred = np.array([one.starred == panel.sweep.parameter for one in panel.measured], dtype=bool)
    for is_fastest, look in zip((False, True), reversed(MARKS.values()), strict=True):
        shown = ~np.isnan(quantity) & (starred == is_fastest)
        if np.any(shown):  # the layout treats an empty line that is not clipped as infinite
            ax.plot(
                panel.at(panel.measured)[shown], quantity[shown], clip_on=False, zorder=3, **look
            )


def _draw_scatter(panel: Panel, quantities: Sequence[Values], ax: Axes) -> None:
    """Draw repeated trials as dots, and mean and standard deviation of several, shifted right to keep marks visible."""
    low, high = np.degrees(panel.sweep.values[[0, -1]])
    step = BESIDE * float(high - low)
    for place, quantity in zip(panel.at(panel.repeats).tolist(), quantities, strict=True):
        known, at = quantity[~np.isnan(quantity)], place + step
        if known.size:
            ax.plot([at] * known.size, known, clip_on=False, zorder=4, **TRIAL)
        if known.size > 1:
            mean, deviation = float(np.mean(known)), float(np.std(known, ddof=1))
            ax.errorbar([at + 0.8 * step], [mean], yerr=[deviation], capsize=1.8, zorder=4, **MEAN)


def _mean_handle() -> ErrorbarContainer:
    """Return the legend handle of mean and standard deviation."""
    return ErrorbarContainer(
        (Line2D([], [], **MEAN), (), (LineCollection([], colors=REPEATS, linewidths=1.0),)),
        has_yerr=True,
        label="their mean and standard deviation",
    )


def _dress(panel: Panel, ax: Axes, ylabel: str) -> Axes:
    low, high = np.degrees(panel.sweep.values[[0, -1]])
    if high > low:
        margin = MARGIN * float(high - low)  # keeps a mark at the end away from the next panel
        beside = 2.0 * BESIDE * float(high - low)
        farthest = max([float(high), *(panel.at(panel.repeats) + beside)])
        ax.set_xlim(float(low) - margin, farthest + margin)
    ax.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2.5, 5, 10]))
    ax.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
    return style.style_axes(ax, xlabel=LABELS[panel.sweep.parameter], ylabel=ylabel)


def _finish(
    figure: Figure, rows: Sequence[Sequence[Axes]], panels: Sequence[Panel], title: str
) -> None:
    """Add what surrounds the data: letters, fixed parameters, legend and title."""
    for place, (ax, panel) in enumerate(zip(rows[0], panels, strict=True)):
        held = [
            SYMBOLS[name].format(float(np.degrees(value)))
            for name, value in panel.sweep.fixed.items()
        ]
        style.add_letter(ax, place, ", ".join(held), pad=6)
    for row in rows:
        for ax in row[1:]:
            ax.set_ylabel("")
            ax.tick_params(labelleft=False)
        for ax in row:
            style.light_grid(ax, "y")
    figure.align_ylabels([row[0] for row in rows])
    figure.suptitle(title, fontsize=style.LABEL, color=style.INK, x=0.01, ha="left")
    style.outside_legend(
        figure, _handles(panels), "outside lower center", ncols=2, handlelength=2.6
    )


def _handles(panels: Sequence[Panel]) -> list[Line2D | ErrorbarContainer]:
    """Return the handles of the legend."""
    handles: list[Line2D | ErrorbarContainer] = []
    for i, label in enumerate(panels[0].labels):
        color, dashes = style.LINES[i % len(style.LINES)]
        handles.append(Line2D([], [], color=color, linestyle=dashes, linewidth=1.5, label=label))
    handles += [Line2D([], [], label=label, **look) for label, look in MARKS.items()]
    if any(panel.repeats for panel in panels):
        handles.append(Line2D([], [], label="repeated trials, beside their setting", **TRIAL))
        handles.append(_mean_handle())
    return handles


# ---- speeds of path following --------------------------------------------------------------------

ROW_HEIGHT = 0.27  # [in]
AROUND = 1.35  # height of title, labels and legend [in]
GAP = 1.0  # rows between two groups, for the name of the second
# By joint law, in order; distinguished by shape as well.
LAWS: tuple[tuple[str, str], ...] = ((style.BLUE, "o"), (style.ORANGE, "^"), (style.AMBER, "s"))
SPEED_MARKS = {
    "measured": style.marker_style(
        "D", 6.0, markeredgecolor="white", markeredgewidth=0.6, zorder=4
    ),
    "chosen": style.marker_style("o", 9.5, markerfacecolor="none", markeredgewidth=0.8, zorder=5),
    "mean": style.marker_style(
        "o", 5.5, style.BLUE, markerfacecolor="white", markeredgewidth=1.2, zorder=3
    ),
    "null": style.marker_style("|", 13.0, style.GRAY, markeredgewidth=2.0, zorder=1),
}
RANGE: dict[str, Any] = {
    "color": "#C9DDEA",
    "linewidth": 5.0,
    "solid_capstyle": "round",
    "zorder": 0,
}


def following_speeds(rows: Sequence[FollowingCase], null: Sequence[float], ax: Axes) -> Axes:
    """Draw the speeds of trials, one trial below the other, with a mark per simulation and a line over their range.

    Args:
        rows: Cases from top to bottom; those of a group are consecutive.
        null: Speeds predicted without physics, by row [m/s].
        ax: Axes to draw on.
    """
    steps = [1.0 if row.group == before.group else 1.0 + GAP for before, row in pairwise(rows)]
    places = np.cumsum([0.0, *steps]).tolist()
    for row, y, predicted in zip(rows, places, null, strict=True):
        speeds = [run.forward_velocity for run in row.band]
        ax.plot([min(speeds), max(speeds)], [y, y], **RANGE)
        for (color, marker), runs in zip(LAWS, group_by_law(row).values(), strict=False):
            found = [run.forward_velocity for run in runs]
            ax.plot(found, [y] * len(found), **style.marker_style(marker, 4.0, color), zorder=3)
        values = {"null": predicted, "mean": row.cycle_mean.forward_velocity}
        values |= {"chosen": row.run.forward_velocity, "measured": row.measured.forward_velocity}
        for name, speed in values.items():
            ax.plot([speed], [y], clip_on=False, **SPEED_MARKS[name])
    for i, (row, y) in enumerate(zip(rows, places, strict=True)):
        if i == 0 or row.group != rows[i - 1].group:
            ax.text(
                0.001,
                y - 0.75,
                row.group.name,
                fontsize=style.TICK,
                color=style.INK,
                weight="bold",
                va="center",
            )
    ax.set_yticks(places, [f"case {row.measured.case}" for row in rows])
    ax.set_ylim(places[-1] + 0.6, places[0] - 1.1)
    ax.set_xlim(left=0.0)
    ax.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]))
    style.light_grid(ax, "x")
    style.style_axes(ax, xlabel="forward velocity [m/s]", ylabel="")
    ax.tick_params(axis="y", length=0)
    return ax


def following_speeds_sheet(
    rows: Sequence[FollowingCase], title: str, *, chosen: str, null: tuple[str, Sequence[float]]
) -> Figure:
    """Draw the speeds of trials with a title and a legend.

    Args:
        rows: Cases from top to bottom; those of a group are consecutive.
        title: Title above the axes.
        chosen: Legend label of the chosen runs.
        null: Legend label of the prediction without physics, and its speeds by row [m/s].
    """
    n_groups = len({row.group.name for row in rows})
    figure = style.new_figure(
        style.DOUBLE_COLUMN, AROUND + ROW_HEIGHT * (len(rows) + GAP * n_groups)
    )
    following_speeds(rows, null[1], figure.subplots())
    words = {
        "measured": "measured in the tank",
        "chosen": chosen,
        "mean": "the same, cycle-mean heading",
    }
    words["null"] = null[0]
    handles = [Line2D([], [], label=label, **SPEED_MARKS[name]) for name, label in words.items()]
    for (color, marker), (law, runs) in zip(LAWS, group_by_law(rows[0]).items(), strict=False):
        label = f"{law} joints, {' and '.join(f'{run.offset_bandwidth:g}' for run in runs)} rad/s, raw heading"
        handles.append(Line2D([], [], label=label, **style.marker_style(marker, 4.0, color)))
    band: dict[str, Any] = {**RANGE, "solid_capstyle": "butt"}
    handles.append(Line2D([], [], label="range of these", **band))
    style.outside_legend(
        figure, handles, "outside lower center", ncols=2, handlelength=1.4, handletextpad=0.7
    )
    style.add_title(figure, title)
    return figure
