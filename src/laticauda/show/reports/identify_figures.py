"""Figures of the report on an identification: predicted over measured, residuals, intervals, correlations.

Also the benefit of further trials. A function without an underscore takes data and axes, and
returns the axes.
"""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Iterator, Mapping, Sequence
from itertools import cycle
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from laticauda.identify import SERIES, Fit, Validation
from laticauda.models.simulate import UNITS
from laticauda.show.figures import new_figure, style

_DROPPED = ("robot.joint.actuator.", "robot.joint.", "robot.", "water.")
_MOST_BARS = 60

MARKS = tuple(
    zip((style.BLUE, style.ORANGE, style.AMBER, style.INK, style.GRAY), "osD^v", strict=True)
)
"""Color and marker by group; they repeat."""

Ends = Float[np.ndarray, "2"]
"""Ends of an interval; nan where it is open."""


def figures_of(done: Validation) -> Iterator[tuple[str, str, Figure]]:
    """Yield the figures one by one: name, caption and figure.

    Args:
        done: Validated result of the identification.
    """
    found = done.fit
    yield "parity", "Predicted over measured, by group. Line: equal.", _parity(found)
    yield (
        "residuals",
        "Predicted less measured in standard deviations of the noise as stated (series: root mean square). Dashed: 2.",
        _residuals(found),
    )
    yield "intervals", "Uncertainty of every parameter as a share of its value.", _intervals(done)
    if len(found.problem.of_interest) > 1:
        yield "correlations", "Correlations of the parameters' errors.", _correlations(found)


def short_names(names: Sequence[str]) -> list[str]:
    """Return names as shown in figures: without the path to the parameter, if that leaves them distinct.

    Args:
        names: Full names.
    """
    short = [_short(name) for name in names]
    return [one if short.count(one) == 1 else name for one, name in zip(short, names, strict=True)]


def _short(name: str) -> str:
    for part in _DROPPED:
        scope, found, rest = name.partition(part)
        if found:
            return (f"{scope.rstrip('.')}: " if scope else "").replace("_", " ") + rest.replace(
                "_", " "
            )
    return name.replace("_", " ")


def _parity(found: Fit) -> Figure:
    """Draw one panel per figure or series."""
    parts = _by_what(found)
    n = min(len(parts), 3)
    rows = -(-len(parts) // n)
    labels = list(dict.fromkeys(found.problem.groups))
    height = 3.2 if n == 1 else 0.35 + (3.1 if n == 2 else 2.3) * rows + 0.18 * len(labels)
    figure = new_figure(style.DOUBLE_COLUMN, height)
    panels = figure.subplots(rows, n, squeeze=False).ravel()
    for ax, (what, groups) in zip(panels, parts.items(), strict=False):
        unit = UNITS.get(what) or SERIES.get(what) or "-"
        parity(groups, ax, what=f"{what.replace('_', ' ')} [{unit}]")
    for ax in panels[len(parts) :]:
        ax.set_visible(False)
    if n == 1:
        panels[0].set_anchor("W")
    most = max((ax.get_legend_handles_labels()[0] for ax in panels[: len(parts)]), key=len)
    style.outside_legend(figure, most, "outside right upper" if n == 1 else "outside lower left")
    return figure


def _by_what(found: Fit) -> dict[str, dict[str, np.ndarray]]:
    """Return measured and predicted numbers by figure or series, then by group."""
    pieces: dict[str, dict[str, np.ndarray]] = {}
    for place in found.problem.data_blocks:
        group, name, here = found.problem.groups[place.owner], place.name, place.numbers
        both = np.stack((found.problem.observed[here], found.predictions[here]))
        groups = pieces.setdefault(name, {})
        groups[group] = np.concatenate((groups[group], both), axis=1) if group in groups else both
    return pieces


def _residuals(found: Fit) -> Figure:
    rows = sorted(found.residuals, key=lambda row: found.problem.groups.index(row["group"]))[
        :_MOST_BARS
    ]
    names = [row["measurement"].removeprefix(f"{row['group']}, ") for row in rows]
    if len({row["what"] for row in rows}) > 1:
        names = [f"{name}: {row['what']}" for name, row in zip(names, rows, strict=True)]
    figure = new_figure(
        style.DOUBLE_COLUMN, 0.8 + 0.17 * len(rows) + 0.18 * len(set(found.problem.groups))
    )
    ax = draw_residuals(
        names,
        [row["in standard deviations [-]"] for row in rows],
        [row["group"] for row in rows],
        figure.subplots(),
        label="predicted less measured, in standard deviations of the stated noise [-]",
    )
    style.outside_legend(figure, ax.get_legend_handles_labels()[0], "outside lower left")
    return figure


def _intervals(done: Validation) -> Figure:
    found, shown = done.fit, done.fit.problem.of_interest
    rows: dict[str, tuple[Ends | None, Ends | None]] = {}
    for k, label in zip(shown, short_names([found.problem.names[k] for k in shown]), strict=True):
        estimate = found.estimates[k]
        best = estimate.value or 1.0
        plain, profile = (
            estimate.interval if best >= 0.0 else None,
            done.profiles.get(estimate.name),
        )
        rows[label] = _share(plain, best), _share(profile, best)
    figure = new_figure(style.DOUBLE_COLUMN, 1.3 + 0.35 * len(rows))
    ax = draw_intervals(rows, figure.subplots(), confidence=found.method.confidence)
    style.outside_legend(figure, ax.get_legend_handles_labels()[0], "outside lower left")
    return figure


def _share(ends: tuple[float | None, float | None] | None, best: float) -> Ends | None:
    return None if ends is None else np.array(ends, dtype=float) / best


def _correlations(found: Fit) -> Figure:
    shown = found.problem.of_interest
    figure = new_figure(style.DOUBLE_COLUMN, 0.7 + 0.42 * len(shown))
    names = short_names([found.problem.names[k] for k in shown])
    draw_correlations(names, found.correlations[np.ix_(shown, shown)], figure.subplots())
    return figure


# ---- on axes -------------------------------------------------------------------------------------


def parity(groups: Mapping[str, Float[np.ndarray, "2 n"]], ax: Axes, *, what: str) -> Axes:
    """Draw predicted over measured numbers, with the line of equality and a band of 10 % about it.

    Args:
        groups: By legend label, the measured numbers and the predicted ones, in the unit of the
            axes.
        ax: Axes to draw on.
        what: Quantity with its unit, for both labels.

    Returns:
        `ax`.
    """
    every = np.concatenate([*groups.values()], axis=1)
    low, high = float(np.min(every)), float(np.max(every))
    pad = 0.06 * (high - low or abs(high) or 1.0)
    ends = np.array([max(low - pad, 0.0) if low >= 0.0 else low - pad, high + pad])
    if low >= 0.0:
        ax.fill_between(
            ends, 0.9 * ends, 1.1 * ends, color=style.GRAY, alpha=0.15, linewidth=0, label="±10 %"
        )
    ax.plot(ends, ends, color=style.GRAY, linewidth=style.THIN)
    size = 1.5 if every.shape[1] > 200 else 4.0
    for (label, (measured, predicted)), (color, marker) in zip(
        groups.items(), cycle(MARKS), strict=False
    ):
        ax.plot(measured, predicted, marker, color=color, markersize=size, label=label)
    style.style_axes(ax, xlabel=f"measured {what}", ylabel=f"predicted {what}")
    ax.set(xlim=ends, ylim=ends)
    ax.set_aspect("equal")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator(5))
    return ax


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
    places = np.arange(len(names))
    for group, (color, _) in zip(dict.fromkeys(groups), cycle(MARKS), strict=False):
        mine = [k for k, other in enumerate(groups) if other == group]
        ax.barh(places[mine], [in_sigmas[k] for k in mine], height=0.7, color=color, label=group)
    ax.axvline(0.0, color=style.INK, linewidth=style.THIN)
    for level in (-2.0, 2.0):
        ax.axvline(level, color=style.GRAY, linewidth=style.THIN, linestyle=(0, (5, 2)))
    style.style_axes(ax, xlabel=label, ylabel="")
    ax.set_yticks(places, names)
    ax.set_ylim(len(names) - 0.4, -0.6)
    reach = max(2.5, 1.1 * float(np.max(np.abs(in_sigmas))))
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
    shown = np.where(np.isfinite(matrix) & ~np.eye(len(names), dtype=bool), matrix, 0.0)
    ax.imshow(shown, vmin=-1.0, vmax=1.0, cmap="RdBu_r", aspect="auto")
    for i, row in enumerate(matrix):
        for j, value in enumerate(row):
            if i == j:
                continue
            text = (
                f"{value:.2f}".replace("-", "\N{MINUS SIGN}")
                if np.isfinite(value)
                else "\N{EN DASH}"
            )
            color = "white" if np.isfinite(value) and abs(value) > 0.6 else style.INK
            ax.text(j, i, text, ha="center", va="center", fontsize=style.TICK, color=color)
    style.style_axes(ax, xlabel="", ylabel="")
    ax.set_xticks(range(len(names)), [name.replace(" ", "\n") for name in names])
    ax.set_yticks(range(len(names)), names)
    ax.tick_params(length=0)
    for spine in ax.spines.values():
        spine.set_visible(False)
    return ax


def draw_intervals(
    rows: Mapping[str, tuple[Ends | None, Ends | None]], ax: Axes, *, confidence: float
) -> Axes:
    """Draw confidence intervals of parameters, relative to their values.

    Args:
        rows: By parameter, from the top: the interval from the covariance, None if it is not
            identified, and that from the likelihood itself, None if it was not computed [-].
        ax: Axes to draw on.
        confidence: Confidence level of the intervals [-].

    Returns:
        `ax`.
    """
    ends = [pair for pairs in rows.values() for pair in pairs if pair is not None]
    low, high = (
        np.nanmin([0.8, *(0.97 * np.ravel(ends))]),
        np.nanmax([1.25, *(1.03 * np.ravel(ends))]),
    )
    for i, (plain, profile) in enumerate(rows.values()):
        if plain is not None:
            ax.plot(plain, (i, i), color=style.BLUE, linewidth=3.0, solid_capstyle="butt")
            ax.plot(1.0, i, "o", color=style.INK, markersize=3.5)
        else:
            style.add_note(ax, "not identified", (1.0, i), (4, 0), va="center")
        if profile is not None:
            shown, at = np.where(np.isnan(profile), (low, high), profile), (i + 0.22, i + 0.22)
            ax.plot(shown, at, color=style.ORANGE, linewidth=1.6, solid_capstyle="butt")
    ax.plot(
        [],
        [],
        color=style.BLUE,
        linewidth=3.0,
        label=f"{100 * confidence:g} % interval, from the covariance",
    )
    if any(profile is not None for _, profile in rows.values()):
        ax.plot(
            [],
            [],
            color=style.ORANGE,
            linewidth=1.6,
            label="from the profile likelihood (open ends: to the edge)",
        )
    ax.axvline(1.0, color=style.GRAY, linewidth=style.THIN)
    style.style_axes(ax, xlabel="value / best value [-]", ylabel="")
    ax.set_yticks(range(len(rows)), [*rows])
    ax.set_ylim(len(rows) - 0.4, -0.6)
    ax.set_xlim(low, high)
    return ax


def shrinking(
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
    n = np.arange(len(sigma))
    finite = sigma[np.isfinite(sigma)]
    top = 3.0 * min(float(np.max(finite, initial=limit)), 10.0 * limit)
    looks = zip(cycle(MARKS), cycle(style.LINES), strict=False)  # lines may coincide
    for label, mine, ((color, marker), (_, dashes)) in zip(labels, sigma.T, looks, strict=False):
        style_of = {"color": color, "marker": marker, "markersize": 4.0, "linewidth": style.LINE}
        ax.semilogy(n, np.minimum(mine, top), linestyle=dashes, label=label, **style_of)
        beyond = n[~(mine < top)]
        ax.semilogy(
            beyond,
            np.full(beyond.size, top),
            marker,
            color=color,
            markerfacecolor="white",
            markersize=4.0,
        )
    ax.axhline(limit, color=style.GRAY, linewidth=style.THIN, linestyle=(0, (5, 2)))
    at_right: Any = {"xycoords": ("axes fraction", "data"), "ha": "right"}
    style.add_note(ax, "not identified above", (1.0, limit), (-2, 2), va="bottom", **at_right)
    if not np.all(sigma < top):
        style.add_note(ax, "open: not known", (1.0, top), (-2, -4), va="top", **at_right)
    style.style_axes(ax, xlabel="further trials", ylabel=ylabel)
    ax.set_xticks(n)
    ax.set_ylim(top=1.15 * top)
    style.add_legend(ax, loc="center left", bbox_to_anchor=(1.01, 0.5))
    return ax
