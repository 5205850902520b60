"""What the figures of an identification and of a design draw on their axes: each function takes data and axes.

Colors and markers repeat if there are more groups than `MARKS`.
"""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Mapping, Sequence
from itertools import cycle
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from laticauda.show.figures import style

Ends = Float[np.ndarray, "2"]
"""Ends of an interval; nan where it is open."""
DASHED = (0, (5, 2))
"""Dash pattern of lines at limits [pt]."""

MANY_POINTS = 200
"""Points of a panel above which they are drawn small [-]."""
SMALL_MARKER = 1.5
"""Size of a small marker [pt]."""
LARGE_MARKER = 4.0
"""Size of a marker [pt]."""
STRONG_CORRELATION = 0.6
"""Correlation above which the text on its color is white [-]."""


class Mark(NamedTuple):
    """Color and marker of a group."""

    color: str
    """Color."""
    marker: str
    """Marker, as in matplotlib."""


MARKS = (
    Mark(color=style.BLUE, marker="o"),
    Mark(color=style.ORANGE, marker="s"),
    Mark(color=style.AMBER, marker="D"),
    Mark(color=style.INK, marker="^"),
    Mark(color=style.GRAY, marker="v"),
)


class ParameterIntervals(NamedTuple):
    """Confidence intervals of a parameter, relative to its value."""

    covariance: Ends | None
    """Interval from the covariance; None if the parameter is not identified [-]."""
    profile: Ends | None
    """Interval from the likelihood itself; None if it was not computed [-]."""


def draw_parity(
    groups: Mapping[str, Float[np.ndarray, "2 n"]],
    ax: Axes,
    *,
    quantity: str,
    marks: Sequence[Mark] = MARKS,
) -> Axes:
    """Draw predicted over measured numbers, with the line of equality and a band of 10 % about it.

    Args:
        groups: By legend label, the measured numbers and the predicted ones, in the unit of the
            axes.
        ax: Axes to draw on.
        quantity: Quantity with its unit, for both labels.
        marks: Colors and markers of the groups.

    Returns:
        `ax`.
    """
    all_pairs = np.concatenate([*groups.values()], axis=1)
    ends = _parity_ends(all_pairs)
    if ends[0] >= 0.0:
        ax.fill_between(
            ends, 0.9 * ends, 1.1 * ends, color=style.GRAY, alpha=0.15, linewidth=0, label="±10 %"
        )
    ax.plot(ends, ends, color=style.GRAY, linewidth=style.THIN)
    n_pairs = all_pairs.shape[1]
    marker_size = SMALL_MARKER if n_pairs > MANY_POINTS else LARGE_MARKER
    for (label, pairs), mark in zip(groups.items(), cycle(marks), strict=False):
        measured, predicted = pairs
        ax.plot(
            measured, predicted, mark.marker, color=mark.color, markersize=marker_size, label=label
        )
    style.style_axes(ax, xlabel=f"measured {quantity}", ylabel=f"predicted {quantity}")
    ax.set(xlim=ends, ylim=ends)
    ax.set_aspect("equal")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator(5))
    return ax


def _parity_ends(numbers: Float[np.ndarray, "2 n"]) -> Ends:
    """Return the ends of both axes: a little beyond the numbers, but not below 0 if none is negative."""
    low = float(np.min(numbers))
    high = float(np.max(numbers))
    padding = 0.06 * (high - low or abs(high) or 1.0)
    first = low - padding
    if low >= 0.0:
        first = max(first, 0.0)
    return np.array([first, high + padding])


def draw_residuals(
    names: Sequence[str], in_sigmas: Sequence[float], groups: Sequence[str], ax: Axes, *, label: str
) -> Axes:
    """Draw the error of the prediction as one bar per measurement, colored by group.

    Args:
        names: Name of each bar.
        in_sigmas: Length of each bar.
        groups: Group of each bar.
        ax: Axes to draw on.
        label: Label of the axis.

    Returns:
        `ax`.
    """
    lengths = np.array(in_sigmas)
    positions = np.arange(len(names))
    group_of_bar = np.array(groups)
    for group, mark in zip(dict.fromkeys(groups), cycle(MARKS), strict=False):
        is_member = group_of_bar == group
        ax.barh(positions[is_member], lengths[is_member], height=0.7, color=mark.color, label=group)
    ax.axvline(0.0, color=style.INK, linewidth=style.THIN)
    for level in (-2.0, 2.0):
        ax.axvline(level, color=style.GRAY, linewidth=style.THIN, linestyle=DASHED)
    style.style_axes(ax, xlabel=label, ylabel="")
    ax.set_yticks(positions, names)
    ax.set_ylim(len(names) - 0.4, -0.6)
    reach = max(2.5, 1.1 * float(np.max(np.abs(lengths))))
    ax.set_xlim(-reach, reach)
    return ax


def draw_correlations(names: Sequence[str], matrix: Float[np.ndarray, "n n"], ax: Axes) -> Axes:
    """Draw correlations of parameters as a matrix of numbers, without the diagonal; a dash means not identified.

    Args:
        names: Names of the parameters.
        matrix: Their correlations; nan for parameters that are not identified.
        ax: Axes to draw on.

    Returns:
        `ax`.
    """
    is_diagonal = np.eye(len(names), dtype=bool)
    is_colored = np.isfinite(matrix) & ~is_diagonal
    ax.imshow(np.where(is_colored, matrix, 0.0), vmin=-1.0, vmax=1.0, cmap="RdBu_r", aspect="auto")
    for row, column in np.argwhere(~is_diagonal).tolist():
        _write_correlation(ax, float(matrix[row, column]), row=row, column=column)
    style.style_axes(ax, xlabel="", ylabel="")
    ax.set_xticks(range(len(names)), [name.replace(" ", "\n") for name in names])
    ax.set_yticks(range(len(names)), names)
    ax.tick_params(length=0)
    for spine in ax.spines.values():
        spine.set_visible(False)
    return ax


def _write_correlation(ax: Axes, value: float, *, row: int, column: int) -> None:
    """Write a correlation into its cell, white on a dark color."""
    text = "\N{EN DASH}"
    color = style.INK
    if np.isfinite(value):
        text = f"{value:.2f}".replace("-", "\N{MINUS SIGN}")
        if abs(value) > STRONG_CORRELATION:
            color = "white"
    ax.text(column, row, text, ha="center", va="center", fontsize=style.TICK, color=color)


def draw_intervals(
    intervals: Mapping[str, ParameterIntervals], ax: Axes, *, confidence: float
) -> Axes:
    """Draw confidence intervals of parameters, relative to their values.

    Args:
        intervals: Intervals by parameter, from the top.
        ax: Axes to draw on.
        confidence: Confidence level of the intervals [-].

    Returns:
        `ax`.
    """
    low, high = _interval_ends(intervals)
    for position, parameter in enumerate(intervals.values()):
        _draw_covariance_interval(ax, parameter.covariance, position)
        if parameter.profile is not None:
            is_open = np.isnan(parameter.profile)
            ends = np.where(is_open, (low, high), parameter.profile)
            heights = (position + 0.22, position + 0.22)
            ax.plot(ends, heights, color=style.ORANGE, linewidth=1.6, solid_capstyle="butt")
    _add_interval_legend(ax, intervals, confidence=confidence)
    ax.axvline(1.0, color=style.GRAY, linewidth=style.THIN)
    style.style_axes(ax, xlabel="value / best value [-]", ylabel="")
    ax.set_yticks(range(len(intervals)), [*intervals])
    ax.set_ylim(len(intervals) - 0.4, -0.6)
    ax.set_xlim(low, high)
    return ax


def _interval_ends(intervals: Mapping[str, ParameterIntervals]) -> tuple[float, float]:
    """Return the ends of the axis: beyond all ends of intervals that are not open."""
    ends: list[Ends] = []
    for parameter in intervals.values():
        for interval in parameter:
            if interval is not None:
                ends.append(interval)
    all_ends = np.ravel(ends)
    low = np.nanmin([0.8, *(0.97 * all_ends)])
    high = np.nanmax([1.25, *(1.03 * all_ends)])
    return low, high


def _draw_covariance_interval(ax: Axes, ends: Ends | None, position: int) -> None:
    """Draw an interval with the value in it, or the note that there is none."""
    if ends is None:
        style.add_note(ax, "not identified", (1.0, position), (4, 0), va="center")
        return
    heights = (position, position)
    ax.plot(ends, heights, color=style.BLUE, linewidth=3.0, solid_capstyle="butt")
    ax.plot(1.0, position, "o", color=style.INK, markersize=3.5)


def _add_interval_legend(
    ax: Axes, intervals: Mapping[str, ParameterIntervals], *, confidence: float
) -> None:
    """Add empty lines whose labels a legend shows."""
    ax.plot(
        [],
        [],
        color=style.BLUE,
        linewidth=3.0,
        label=f"{100 * confidence:g} % interval, from the covariance",
    )
    has_profiles = any(parameter.profile is not None for parameter in intervals.values())
    if has_profiles:
        ax.plot(
            [],
            [],
            color=style.ORANGE,
            linewidth=1.6,
            label="from the profile likelihood (open ends: to the edge)",
        )


def draw_expected_deviations(
    labels: Sequence[str],
    sigma: Float[np.ndarray, "n_steps n_parameters"],
    ax: Axes,
    *,
    ylabel: str,
    limit: float,
) -> Axes:
    """Draw expected standard deviations over the number of further trials.

    Args:
        labels: Labels of the parameters.
        sigma: Standard deviations, one row per number of trials, from zero; inf where nothing is
            known [-].
        ax: Axes to draw on.
        ylabel: Label of the axis.
        limit: Limit above which a parameter counts as not identified [-].

    Returns:
        `ax`.
    """
    n_trials = np.arange(len(sigma))
    largest = float(np.max(sigma[np.isfinite(sigma)], initial=limit))
    top = 3.0 * min(largest, 10.0 * limit)
    line_styles = cycle(style.LINES)  # lines may coincide
    parameters = zip(labels, sigma.T, cycle(MARKS), line_styles, strict=False)
    for label, deviations, mark, (_, dashes) in parameters:
        ax.semilogy(
            n_trials,
            np.minimum(deviations, top),
            linestyle=dashes,
            label=label,
            color=mark.color,
            marker=mark.marker,
            markersize=4.0,
            linewidth=style.LINE,
        )
        is_beyond = ~(deviations < top)
        n_trials_beyond = n_trials[is_beyond]
        ax.semilogy(
            n_trials_beyond,
            np.full(n_trials_beyond.size, top),
            mark.marker,
            color=mark.color,
            markerfacecolor="white",
            markersize=4.0,
        )
    ax.axhline(limit, color=style.GRAY, linewidth=style.THIN, linestyle=DASHED)
    at_right: Any = {"xycoords": ("axes fraction", "data"), "ha": "right"}
    style.add_note(ax, "not identified above", (1.0, limit), (-2, 2), va="bottom", **at_right)
    if not np.all(sigma < top):
        style.add_note(ax, "open: not known", (1.0, top), (-2, -4), va="top", **at_right)
    style.style_axes(ax, xlabel="further trials", ylabel=ylabel)
    ax.set_xticks(n_trials)
    ax.set_ylim(top=1.15 * top)
    style.add_legend(ax, loc="center left", bbox_to_anchor=(1.01, 0.5))
    return ax
