"""An identification in pictures: measured against predicted, residuals, correlations, intervals; what trials add."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from laticauda.figures import style

MARKS: tuple[tuple[str, str], ...] = (
    (style.BLUE, "o"),
    (style.ORANGE, "s"),
    (style.AMBER, "D"),
    (style.INK, "^"),
    (style.GRAY, "v"),
)
"""By group, color and marker; they repeat."""
_LINES = ("-", (0, (5, 2)), (0, (1, 1.5)), (0, (5, 1.5, 1, 1.5)))


@dataclass(frozen=True, kw_only=True, eq=False)
class Compared:
    """Numbers of one group, measured and predicted."""

    label: str
    """What the legend says."""
    measured: Float[np.ndarray, " n"]
    """In the unit of the axes."""
    predicted: Float[np.ndarray, " n"]
    """Likewise."""


@dataclass(frozen=True, kw_only=True)
class Interval:
    """One parameter and its uncertainty, as shares of its value."""

    label: str
    """Its name."""
    plain: tuple[float, float] | None
    """Confidence interval from the covariance; None: not identified [-]."""
    profile: tuple[float | None, float | None] | None = None
    """The same from the likelihood itself, None where it is open; None: not computed [-]."""


def parity(groups: Sequence[Compared], ax: Axes, *, what: str) -> Axes:
    """Predicted over measured numbers, with the line of equality and a band of 10 % about it.

    Args:
        groups: What is compared.
        ax: Where to draw.
        what: The quantity with its unit, for both labels.

    Returns:
        `ax`.
    """
    every = np.concatenate([values for group in groups for values in (group.measured, group.predicted)])
    low, high = float(np.min(every)), float(np.max(every))
    pad = 0.06 * (high - low or abs(high) or 1.0)
    ends = np.array([max(low - pad, 0.0) if low >= 0.0 else low - pad, high + pad])
    if low >= 0.0:
        ax.fill_between(ends, 0.9 * ends, 1.1 * ends, color=style.GRAY, alpha=0.15, linewidth=0, label="±10 %")
    ax.plot(ends, ends, color=style.GRAY, linewidth=style.THIN)
    many = sum(group.measured.size for group in groups) > 200
    for i, group in enumerate(groups):
        color, marker = MARKS[i % len(MARKS)]
        size = 1.5 if many else 4.0
        ax.plot(group.measured, group.predicted, marker, color=color, markersize=size, label=group.label)
    style.dress(ax, xlabel=f"measured {what}", ylabel=f"predicted {what}")
    ax.set(xlim=ends, ylim=ends)
    ax.set_aspect("equal")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator(5))
    return ax


def residuals(names: Sequence[str], in_sigmas: Sequence[float], groups: Sequence[str], ax: Axes, *, label: str) -> Axes:
    """A bar per measurement: how far the prediction is off, colored by group.

    Args:
        names: By bar.
        in_sigmas: By bar, its length.
        groups: By bar.
        ax: Where to draw.
        label: Of the axis.

    Returns:
        `ax`.
    """
    different = list(dict.fromkeys(groups))
    places = np.arange(len(names))
    for i, group in enumerate(different):
        mine = [k for k, other in enumerate(groups) if other == group]
        color = MARKS[i % len(MARKS)][0]
        ax.barh(places[mine], [in_sigmas[k] for k in mine], height=0.7, color=color, label=group)
    ax.axvline(0.0, color=style.INK, linewidth=style.THIN)
    for level in (-2.0, 2.0):
        ax.axvline(level, color=style.GRAY, linewidth=style.THIN, linestyle=(0, (5, 2)))
    style.dress(ax, xlabel=label, ylabel="")
    ax.set_yticks(places, names)
    ax.set_ylim(len(names) - 0.4, -0.6)
    reach = max(2.5, 1.1 * float(np.max(np.abs(in_sigmas))))
    ax.set_xlim(-reach, reach)
    return ax


def correlations(names: Sequence[str], matrix: Float[np.ndarray, "n n"], ax: Axes) -> Axes:
    """Correlations of parameters as a matrix of numbers, without the diagonal; a dash for what is not identified.

    Args:
        names: Of the parameters.
        matrix: Theirs; nan for what is not identified.
        ax: Where to draw.

    Returns:
        `ax`.
    """
    shown = np.where(np.isfinite(matrix) & ~np.eye(len(names), dtype=bool), matrix, 0.0)
    ax.imshow(shown, vmin=-1.0, vmax=1.0, cmap="RdBu_r", aspect="auto")
    for i, row in enumerate(matrix):
        for j, value in enumerate(row):
            if i == j:
                continue
            text = f"{value:.2f}".replace("-", "\N{MINUS SIGN}") if np.isfinite(value) else "\N{EN DASH}"
            color = "white" if np.isfinite(value) and abs(value) > 0.6 else style.INK
            ax.text(j, i, text, ha="center", va="center", fontsize=style.TICK, color=color)
    style.dress(ax, xlabel="", ylabel="")
    ax.set_xticks(range(len(names)), [name.replace(" ", "\n") for name in names])
    ax.set_yticks(range(len(names)), names)
    ax.tick_params(length=0)
    for spine in ax.spines.values():
        spine.set_visible(False)
    return ax


def intervals(rows: Sequence[Interval], ax: Axes, *, confidence: float) -> Axes:
    """Confidence intervals of parameters, as shares of their values.

    Args:
        rows: By parameter, from the top.
        ax: Where to draw.
        confidence: Of the intervals [-].

    Returns:
        `ax`.
    """
    ends = [end for row in rows for pair in (row.plain, row.profile) if pair for end in pair if end is not None]
    low, high = min([0.8, *(0.97 * end for end in ends)]), max([1.25, *(1.03 * end for end in ends)])
    for i, row in enumerate(rows):
        if row.plain is not None:
            ax.plot(row.plain, (i, i), color=style.BLUE, linewidth=3.0, solid_capstyle="butt")
            ax.plot(1.0, i, "o", color=style.INK, markersize=3.5)
        else:
            ax.annotate(
                "not identified",
                (1.0, i),
                xytext=(4, 0),
                textcoords="offset points",
                va="center",
                fontsize=style.TICK,
                color=style.GRAY,
            )
        if row.profile is not None:
            shown = [end if end is not None else edge for end, edge in zip(row.profile, (low, high), strict=True)]
            ax.plot(shown, (i + 0.22, i + 0.22), color=style.ORANGE, linewidth=1.6, solid_capstyle="butt")
    ax.plot([], [], color=style.BLUE, linewidth=3.0, label=f"{100 * confidence:g} % interval, from the covariance")
    if any(row.profile is not None for row in rows):
        ax.plot([], [], color=style.ORANGE, linewidth=1.6, label="from the profile likelihood (open ends: to the edge)")
    ax.axvline(1.0, color=style.GRAY, linewidth=style.THIN)
    style.dress(ax, xlabel="value / best value [-]", ylabel="")
    ax.set_yticks(range(len(rows)), [row.label for row in rows])
    ax.set_ylim(len(rows) - 0.4, -0.6)
    ax.set_xlim(low, high)
    return ax


def shrinking(
    labels: Sequence[str], sigma: Float[np.ndarray, "n_steps n_parameters"], ax: Axes, *, ylabel: str, limit: float
) -> Axes:
    """Expected standard deviations over the number of further trials.

    Args:
        labels: Of the parameters.
        sigma: A row per number of trials, from none on; inf where nothing is known [-].
        ax: Where to draw.
        ylabel: Of the axis.
        limit: Above it a parameter counts as not identified [-].

    Returns:
        `ax`.
    """
    n = np.arange(len(sigma))
    finite = sigma[np.isfinite(sigma)]
    top = 3.0 * min(float(np.max(finite, initial=limit)), 10.0 * limit)
    for k, label in enumerate(labels):
        color, marker = MARKS[k % len(MARKS)]
        dashes = _LINES[k % len(_LINES)]  # lines may lie on each other
        style_of = {"color": color, "marker": marker, "markersize": 4.0, "linewidth": style.LINE}
        ax.semilogy(n, np.minimum(sigma[:, k], top), linestyle=dashes, label=label, **style_of)
        beyond = n[~(sigma[:, k] < top)]
        ax.semilogy(beyond, np.full(beyond.size, top), marker, color=color, markerfacecolor="white", markersize=4.0)
    ax.axhline(limit, color=style.GRAY, linewidth=style.THIN, linestyle=(0, (5, 2)))
    for text, level, offset, va in (("not identified above", limit, 2, "bottom"), ("open: not known", top, -4, "top")):
        if level == limit or not np.all(sigma < top):
            ax.annotate(
                text,
                (1.0, level),
                xycoords=("axes fraction", "data"),
                xytext=(-2, offset),
                textcoords="offset points",
                ha="right",
                va=va,
                fontsize=style.TICK,
                color=style.GRAY,
            )
    style.dress(ax, xlabel="further trials", ylabel=ylabel)
    ax.set_xticks(n)
    ax.set_ylim(top=1.15 * top)
    style.legend(ax, loc="center left", bbox_to_anchor=(1.01, 0.5))
    return ax
