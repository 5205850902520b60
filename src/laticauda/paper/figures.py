"""Figures of the efficiency study: velocity and power over gait parameters, as in Figs. 4 to 11.

A sheet has a column of axes per swept parameter, and a row per quantity.
"""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.container import ErrorbarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from laticauda.paper.measured import MeasuredCase
from laticauda.paper.repeats import Repeat
from laticauda.paper.settings import SweepSettings
from laticauda.show.figures import style

Curves = Float[np.ndarray, "n_curves n_values"]
Values = Float[np.ndarray, " _"]

LABELS = {
    "amplitude": "amplitude $\\alpha$ [deg]",
    "frequency": "frequency $\\omega$ [deg/s]",
    "phase_shift": "phase shift $\\delta$ [deg]",
}
"""Axis labels of the parameters."""
SYMBOLS = {
    "amplitude": "$\\alpha$ = {:g}°",
    "frequency": "$\\omega$ = {:g}°/s",
    "phase_shift": "$\\delta$ = {:g}°",
}
"""Texts for parameters that are held fixed."""
VELOCITY = ("forward velocity [m/s]",)
"""Axis labels of a sheet of velocities."""
POWERS = ("mechanical power,\nsimulated [W]", "electrical power,\nmeasured [W]")
"""Axis labels of a sheet of powers: those that are simulated and measured differ by losses."""


class ShownFields(NamedTuple):
    """Fields that hold the data of one quantity."""

    of_curves: str
    """Field of a panel with the simulated curves; empty if the quantity is not simulated."""
    of_rows: str
    """Field of rows of a table with the measured values; empty if the quantity is not measured."""


SHOWN = {
    VELOCITY[0]: ShownFields(of_curves="velocity", of_rows="forward_velocity"),
    POWERS[0]: ShownFields(of_curves="power", of_rows=""),
    POWERS[1]: ShownFields(of_curves="", of_rows="mean_power"),
}
"""Fields that hold the data, by axis label."""

REPEATS = "#007A5A"
"""Color of repeated trials: a green that is darker than the models' colors."""
BESIDE = 0.035
"""Shift of repeated trials to the right of their setting, as a fraction of the axis [-]."""
MARKER = 6.5
"""Size of marks [pt]."""
CURVE_WIDTH = 1.5
"""Width of curves [pt]."""
FASTEST_MARK = style.marker_style("*", 1.5 * MARKER, markerfacecolor=style.INK, markeredgewidth=0.9)
"""Look of a setting that is the fastest of its sweep."""
SETTING_MARK = style.marker_style("o", 0.85 * MARKER, markerfacecolor="white", markeredgewidth=0.9)
"""Look of another measured setting."""
TRIAL = style.marker_style("o", 0.4 * MARKER, REPEATS, markerfacecolor="none", markeredgewidth=0.6)
"""Look of one repeated trial."""
MEAN = style.marker_style("D", 0.4 * MARKER, REPEATS)
"""Look of the mean of repeated trials."""
PANEL_HEIGHT = 2.1
"""Height of a row of panels [in]."""
MORE_PANEL_HEIGHT = 0.7
"""Height of each further row, as a share of the first [-]."""
HEAD = 0.42
"""Height of the title [in]."""
LEGEND_LINE = 0.165
"""Height of a line of the legend [in]."""
ROOM = 1.12
"""Upper end of the axis, as a multiple of the highest value [-]."""
MARGIN = 0.035
"""Margin at the first and the last value, as a fraction of the axis [-]."""


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

    @property
    def ends(self) -> tuple[float, float]:
        """First and last value of the parameter [deg, deg/s]."""
        low, high = np.degrees(self.sweep.values[[0, -1]]).tolist()
        return low, high

    def find_positions(self, rows: Sequence[MeasuredCase] | Sequence[Repeat]) -> Values:
        """Return the positions of settings on the axis [deg, deg/s].

        Args:
            rows: Measured settings.
        """
        return np.degrees([getattr(row.gait, self.sweep.parameter) for row in rows])


# ---- figures -------------------------------------------------------------------------------------


def draw_panel(panel: Panel, ax: Axes, ylabel: str) -> Axes:
    """Draw a quantity over one parameter, with a line per model and a mark per measured setting.

    Args:
        panel: Data of the panel.
        ax: Axes to draw on.
        ylabel: Axis label, one of `SHOWN`.
    """
    fields = SHOWN[ylabel]
    curves: list[Values] = []
    if fields.of_curves:
        curves = [*getattr(panel, fields.of_curves)]
    measured = np.array([getattr(row, fields.of_rows, None) for row in panel.measured], dtype=float)
    repeated = [
        np.array(getattr(repeat, fields.of_rows, ()), dtype=float) for repeat in panel.repeats
    ]
    _draw_curves(panel, curves, ax)
    _draw_settings(panel, measured, ax)
    _draw_repeats(panel, repeated, ax)
    if np.all(np.isnan(np.concatenate([*curves, measured, *repeated]))):
        _say_not_available(ax)
    return _style_panel(panel, ax, ylabel)


def draw_efficiency_sheet(panels: Sequence[Panel], title: str, ylabels: Sequence[str]) -> Figure:
    """Draw one of Figs. 4 to 11: quantities over each parameter side by side, one row per quantity.

    The simulated mechanical power and the measured electrical power differ by the losses of motors
    and electronics, so each has its own axis.

    Args:
        panels: One panel per parameter.
        title: Title above all panels.
        ylabels: Axis labels of the rows, from `SHOWN`.
    """
    handles = _list_handles(panels)
    panels_height = PANEL_HEIGHT * (1.0 + MORE_PANEL_HEIGHT * (len(ylabels) - 1))
    legend_height = LEGEND_LINE * math.ceil(len(handles) / 2)
    figure = style.new_figure(style.DOUBLE_COLUMN, panels_height + HEAD + legend_height)
    grid = figure.subplots(len(ylabels), len(panels), sharex="col", sharey="row", squeeze=False)
    rows: list[list[Axes]] = [[*row] for row in grid]
    for ylabel, row in zip(ylabels, rows, strict=True):
        for panel, ax in zip(panels, row, strict=True):
            draw_panel(panel, ax, ylabel)
            if row is not rows[-1]:
                ax.set_xlabel("")
        _scale_from_zero(row)
    _finish_sheet(figure, rows, panels, title)
    style.outside_legend(figure, handles, "outside lower center", ncols=2, handlelength=2.6)
    return figure


# ---- data of a panel -----------------------------------------------------------------------------


def _draw_curves(panel: Panel, curves: Sequence[Values], ax: Axes) -> None:
    """Draw a line per model."""
    positions = np.degrees(panel.sweep.values)
    for index, curve in enumerate(curves):
        ax.plot(positions, curve, **_line_look(index))


def _line_look(index: int) -> dict[str, Any]:
    """Return the look of the line of a model."""
    color, dashes = style.LINES[index % len(style.LINES)]
    return {"color": color, "linestyle": dashes, "linewidth": CURVE_WIDTH}


def _draw_settings(panel: Panel, values: Values, ax: Axes) -> None:
    """Draw a mark per measured setting."""
    is_fastest = np.array(
        [row.starred == panel.sweep.parameter for row in panel.measured], dtype=bool
    )
    is_known = ~np.isnan(values)
    positions = panel.find_positions(panel.measured)
    for is_shown, look in (
        (is_known & ~is_fastest, SETTING_MARK),
        (is_known & is_fastest, FASTEST_MARK),
    ):
        if np.any(is_shown):  # the layout treats an empty line that is not clipped as infinite
            ax.plot(positions[is_shown], values[is_shown], clip_on=False, zorder=3, **look)


def _draw_repeats(panel: Panel, values_by_setting: Sequence[Values], ax: Axes) -> None:
    """Draw repeated trials as dots, and the mean and deviation of several.

    They are shifted to the right, so that the marks of settings stay visible.
    """
    low, high = panel.ends
    step = BESIDE * (high - low)
    positions = panel.find_positions(panel.repeats).tolist()
    for setting_at, values in zip(positions, values_by_setting, strict=True):
        known_values = values[~np.isnan(values)]
        dots_at = setting_at + step
        if known_values.size:
            dots = [dots_at] * known_values.size
            ax.plot(dots, known_values, clip_on=False, zorder=4, **TRIAL)
        if known_values.size > 1:
            mean = float(np.mean(known_values))
            deviation = float(np.std(known_values, ddof=1))
            mean_at = dots_at + 0.8 * step
            ax.errorbar([mean_at], [mean], yerr=[deviation], capsize=1.8, zorder=4, **MEAN)


def _say_not_available(ax: Axes) -> None:
    ax.text(
        0.5,
        0.5,
        "not available",
        transform=ax.transAxes,
        ha="center",
        fontsize=style.TICK,
        color=style.GRAY,
    )


# ---- axes ----------------------------------------------------------------------------------------


def _style_panel(panel: Panel, ax: Axes, ylabel: str) -> Axes:
    """Set limits, ticks and labels."""
    low, high = panel.ends
    span = high - low
    if span > 0.0:
        margin = MARGIN * span  # keeps a mark at the end away from the next panel
        repeats_at = panel.find_positions(panel.repeats) + 2.0 * BESIDE * span
        farthest = max([high, *repeats_at])
        ax.set_xlim(low - margin, farthest + margin)
    ax.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2.5, 5, 10]))
    ax.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
    return style.style_axes(ax, xlabel=LABELS[panel.sweep.parameter], ylabel=ylabel)


def _scale_from_zero(row: Sequence[Axes]) -> None:
    """Set a common scale from zero for the axes of a row."""
    highest = max([0.0, *(ax.dataLim.y1 for ax in row)])
    top = 1.0
    if highest > 0.0:
        top = ROOM * highest
    row[0].set_ylim(0.0, top)


def _finish_sheet(
    figure: Figure, rows: Sequence[Sequence[Axes]], panels: Sequence[Panel], title: str
) -> None:
    """Add what surrounds the data: letters, fixed parameters and title."""
    for index, (ax, panel) in enumerate(zip(rows[0], panels, strict=True)):
        fixed = [
            SYMBOLS[name].format(float(np.degrees(value)))
            for name, value in panel.sweep.fixed.items()
        ]
        style.add_letter(ax, index, ", ".join(fixed), pad=6)
    for row in rows:
        for ax in row[1:]:
            ax.set_ylabel("")
            ax.tick_params(labelleft=False)
        for ax in row:
            style.light_grid(ax, "y")
    figure.align_ylabels([row[0] for row in rows])
    style.add_title(figure, title)


# ---- legend --------------------------------------------------------------------------------------


def _list_handles(panels: Sequence[Panel]) -> list[Line2D | ErrorbarContainer]:
    """Return the handles of the legend."""
    handles: list[Line2D | ErrorbarContainer] = []
    for index, label in enumerate(panels[0].labels):
        handles.append(Line2D([], [], label=label, **_line_look(index)))
    handles.append(Line2D([], [], label="measured, fastest of its sweep", **FASTEST_MARK))
    handles.append(Line2D([], [], label="measured, another setting", **SETTING_MARK))
    if any(panel.repeats for panel in panels):
        handles.append(Line2D([], [], label="repeated trials, beside their setting", **TRIAL))
        handles.append(_mean_handle())
    return handles


def _mean_handle() -> ErrorbarContainer:
    """Return the legend handle of mean and standard deviation."""
    mean = Line2D([], [], **MEAN)
    stem = LineCollection([], colors=REPEATS, linewidths=1.0)
    return ErrorbarContainer(
        (mean, (), (stem,)), has_yerr=True, label="their mean and standard deviation"
    )
