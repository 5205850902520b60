"""Figures of the report on an identification: predicted over measured, residuals, intervals, correlations."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from laticauda.identify import SERIES, Fit, Validation
from laticauda.models.simulate import UNITS
from laticauda.show.figures import new_figure, style
from laticauda.show.reports.chapter import ReportFigure
from laticauda.show.reports.identify_axes import (
    Ends,
    ParameterIntervals,
    draw_correlations,
    draw_intervals,
    draw_parity,
    draw_residuals,
)
from laticauda.show.reports.identify_tables import RESIDUAL, sort_by_group
from laticauda.show.reports.parameter_names import shorten_names

MOST_BARS = 60
"""Measurements whose residuals are drawn at most [-]."""
MOST_PANELS_IN_ROW = 3
"""Panels of the figure of predicted over measured that stand side by side at most [-]."""
SINGLE_PANEL_HEIGHT = 3.2
"""Height of the figure of predicted over measured with one panel [in]."""
WIDE_PANEL_HEIGHT = 3.1
"""Height of a row of two panels [in]."""
NARROW_PANEL_HEIGHT = 2.3
"""Height of a row of three panels [in]."""
PARITY_MARGIN = 0.35
"""Height of what stands about several panels [in]."""
LEGEND_LINE_HEIGHT = 0.18
"""Height of a line of a legend [in]."""


def draw_identification_figures(validated: Validation) -> Iterator[ReportFigure]:
    """Yield the figures one by one.

    Args:
        validated: Validated result of the identification.
    """
    fit = validated.fit
    yield ReportFigure(
        name="parity",
        caption="Predicted over measured, by group. Line: equal.",
        figure=_draw_parity_figure(fit),
    )
    yield ReportFigure(
        name="residuals",
        caption="Predicted less measured in standard deviations of the noise as stated "
        "(series: root mean square). Dashed: 2.",
        figure=_draw_residual_figure(fit),
    )
    yield ReportFigure(
        name="intervals",
        caption="Uncertainty of every parameter as a share of its value.",
        figure=_draw_interval_figure(validated),
    )
    if len(fit.problem.of_interest) > 1:
        yield ReportFigure(
            name="correlations",
            caption="Correlations of the parameters' errors.",
            figure=_draw_correlation_figure(fit),
        )


def _draw_parity_figure(fit: Fit) -> Figure:
    """Draw one panel per figure or series."""
    quantities = _collect_predictions(fit)
    n_groups = len(set(fit.problem.groups))
    n_panels = len(quantities)
    n_columns = min(n_panels, MOST_PANELS_IN_ROW)
    n_rows = -(-n_panels // n_columns)  # rounded up
    height = _parity_height(n_columns=n_columns, n_rows=n_rows, n_groups=n_groups)
    figure = new_figure(style.DOUBLE_COLUMN, height)
    panels = figure.subplots(n_rows, n_columns, squeeze=False).ravel().tolist()
    drawn_panels = panels[:n_panels]
    for ax, (quantity, groups) in zip(drawn_panels, quantities.items(), strict=True):
        unit = UNITS.get(quantity) or SERIES.get(quantity) or "-"
        draw_parity(groups, ax, quantity=f"{quantity.replace('_', ' ')} [{unit}]")
    for ax in panels[n_panels:]:
        ax.set_visible(False)
    legend_place = "outside lower left"
    if n_columns == 1:
        panels[0].set_anchor("W")
        legend_place = "outside right upper"
    style.outside_legend(figure, _longest_legend(drawn_panels), legend_place)
    return figure


def _parity_height(*, n_columns: int, n_rows: int, n_groups: int) -> float:
    """Return the height of the figure of predicted over measured [in]."""
    if n_columns == 1:
        return SINGLE_PANEL_HEIGHT
    row_height = NARROW_PANEL_HEIGHT
    if n_columns == 2:
        row_height = WIDE_PANEL_HEIGHT
    return PARITY_MARGIN + row_height * n_rows + LEGEND_LINE_HEIGHT * n_groups


def _longest_legend(panels: Sequence[Axes]) -> list[Any]:
    """Return the legend handles of the panel that has the most."""
    legends = [_legend_handles(ax) for ax in panels]
    return max(legends, key=len)


def _legend_handles(ax: Axes) -> list[Any]:
    handles, _ = ax.get_legend_handles_labels()
    return handles


def _collect_predictions(fit: Fit) -> dict[str, dict[str, np.ndarray]]:
    """Return measured and predicted numbers by figure or series, then by group."""
    quantities: dict[str, dict[str, np.ndarray]] = {}
    for block in fit.problem.data_blocks:
        group = fit.problem.groups[block.owner]
        measured = fit.problem.observed[block.numbers]
        predicted = fit.predictions[block.numbers]
        pairs = np.stack((measured, predicted))
        groups = quantities.setdefault(block.name, {})
        if group in groups:
            pairs = np.concatenate((groups[group], pairs), axis=1)
        groups[group] = pairs
    return quantities


def _draw_residual_figure(fit: Fit) -> Figure:
    residuals = sort_by_group(fit.residuals, fit.problem.groups)[:MOST_BARS]
    n_groups = len(set(fit.problem.groups))
    height = 0.8 + 0.17 * len(residuals) + LEGEND_LINE_HEIGHT * n_groups
    figure = new_figure(style.DOUBLE_COLUMN, height)
    ax = draw_residuals(
        _residual_names(residuals),
        [residual[RESIDUAL] for residual in residuals],
        [residual["group"] for residual in residuals],
        figure.subplots(),
        label="predicted less measured, in standard deviations of the stated noise [-]",
    )
    style.outside_legend(figure, _legend_handles(ax), "outside lower left")
    return figure


def _residual_names(residuals: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the names of measurements without their group, with their quantity if there are several."""
    n_quantities = len({residual["what"] for residual in residuals})
    names: list[str] = []
    for residual in residuals:
        name = residual["measurement"].removeprefix(f"{residual['group']}, ")
        if n_quantities > 1:
            name = f"{name}: {residual['what']}"
        names.append(name)
    return names


def _draw_interval_figure(validated: Validation) -> Figure:
    fit = validated.fit
    indices = fit.problem.of_interest
    labels = shorten_names([fit.problem.names[index] for index in indices])
    intervals: dict[str, ParameterIntervals] = {}
    for index, label in zip(indices, labels, strict=True):
        estimate = fit.estimates[index]
        best_value = estimate.value or 1.0
        covariance_ends = estimate.interval
        if best_value < 0.0:
            covariance_ends = None
        intervals[label] = ParameterIntervals(
            covariance=_relative_to(best_value, covariance_ends),
            profile=_relative_to(best_value, validated.profiles.get(estimate.name)),
        )
    figure = new_figure(style.DOUBLE_COLUMN, 1.3 + 0.35 * len(intervals))
    ax = draw_intervals(intervals, figure.subplots(), confidence=fit.method.confidence)
    style.outside_legend(figure, _legend_handles(ax), "outside lower left")
    return figure


def _relative_to(value: float, ends: tuple[float | None, float | None] | None) -> Ends | None:
    """Return the ends of an interval as shares of a value; open ends become nan."""
    if ends is None:
        return None
    return np.array(ends, dtype=float) / value


def _draw_correlation_figure(fit: Fit) -> Figure:
    indices = fit.problem.of_interest
    names = shorten_names([fit.problem.names[index] for index in indices])
    correlations = fit.correlations[np.ix_(indices, indices)]
    figure = new_figure(style.DOUBLE_COLUMN, 0.7 + 0.42 * len(indices))
    draw_correlations(names, correlations, figure.subplots())
    return figure
