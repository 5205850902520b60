"""Figures of an identification's report."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from laticauda.figures import identification as draw
from laticauda.figures import new_figure, style
from laticauda.identify.measurements import SERIES
from laticauda.simulate.numbers import UNITS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from laticauda.identify import Fit
    from laticauda.identify.uncertainty import Ends
    from laticauda.identify.validation import Validation

_DROPPED = ("robot.joint.actuator.", "robot.joint.", "robot.", "water.")
_MOST_BARS = 60


def figures_of(done: "Validation") -> "Iterator[tuple[str, str, Figure]]":
    """Name, caption and figure, one after the other.

    Args:
        done: What was found.
    """
    found = done.found
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
    """Names as figures show them: without the way to the number, where that leaves them different.

    Args:
        names: In full.
    """
    short = [_short(name) for name in names]
    return [one if short.count(one) == 1 else name for one, name in zip(short, names, strict=True)]


def _short(name: str) -> str:
    for part in _DROPPED:
        scope, found, rest = name.partition(part)
        if found:
            return (f"{scope.rstrip('.')}: " if scope else "").replace("_", " ") + rest.replace("_", " ")
    return name.replace("_", " ")


def _parity(found: "Fit") -> "Figure":
    """A panel per figure or series."""
    parts = _by_what(found)
    n = min(len(parts), 3)
    rows = -(-len(parts) // n)
    labels = list(dict.fromkeys(found.problem.groups))
    height = 3.2 if n == 1 else 0.35 + (3.1 if n == 2 else 2.3) * rows + 0.18 * len(labels)
    figure = new_figure(style.DOUBLE_COLUMN, height)
    panels = figure.subplots(rows, n, squeeze=False).ravel()
    for ax, (what, groups) in zip(panels, parts.items(), strict=False):
        unit = UNITS.get(what) or SERIES.get(what) or "-"
        draw.parity(groups, ax, what=f"{what.replace('_', ' ')} [{unit}]")
    for ax in panels[len(parts) :]:
        ax.set_visible(False)
    most = max(panels[: len(parts)], key=lambda ax: len(ax.get_legend_handles_labels()[1]))
    if n == 1:
        most.set_anchor("W")
    style.outside_legend(figure, most, "outside right upper" if n == 1 else "outside lower left")
    return figure


def _by_what(found: "Fit") -> dict[str, dict[str, np.ndarray]]:
    """Measured and predicted numbers by figure or series, then by group."""
    pieces: dict[str, dict[str, np.ndarray]] = {}
    for place in found.problem.places:
        group, name, here = found.problem.groups[place.owner], place.what, place.at
        both = np.stack((found.problem.observed[here], found.predictions[here]))
        groups = pieces.setdefault(name, {})
        groups[group] = np.concatenate((groups[group], both), axis=1) if group in groups else both
    return pieces


def _residuals(found: "Fit") -> "Figure":
    rows = sorted(found.residuals, key=lambda row: found.problem.groups.index(row["group"]))[:_MOST_BARS]
    names = [row["measurement"].removeprefix(f"{row['group']}, ") for row in rows]
    if len({row["what"] for row in rows}) > 1:
        names = [f"{name}: {row['what']}" for name, row in zip(names, rows, strict=True)]
    figure = new_figure(style.DOUBLE_COLUMN, 0.8 + 0.17 * len(rows) + 0.18 * len(set(found.problem.groups)))
    ax = draw.residuals(
        names,
        [row["in standard deviations [-]"] for row in rows],
        [row["group"] for row in rows],
        figure.subplots(),
        label="predicted less measured, in standard deviations of the stated noise [-]",
    )
    style.outside_legend(figure, ax, "outside lower left")
    return figure


def _intervals(done: "Validation") -> "Figure":
    found, shown = done.found, done.found.problem.of_interest
    rows: dict[str, tuple[draw.Ends | None, draw.Ends | None]] = {}
    for k, label in zip(shown, short_names([found.problem.names[k] for k in shown]), strict=True):
        estimate = found.estimates[k]
        best = estimate.value or 1.0
        plain, profile = estimate.interval if best >= 0.0 else None, done.profiles.get(estimate.name)
        rows[label] = _share(plain, best), _share(profile, best)
    figure = new_figure(style.DOUBLE_COLUMN, 1.3 + 0.35 * len(rows))
    ax = draw.intervals(rows, figure.subplots(), confidence=found.method.confidence)
    style.outside_legend(figure, ax, "outside lower left")
    return figure


def _share(ends: "Ends | None", best: float) -> draw.Ends | None:
    return None if ends is None else np.array(ends, dtype=float) / best


def _correlations(found: "Fit") -> "Figure":
    shown = found.problem.of_interest
    figure = new_figure(style.DOUBLE_COLUMN, 0.7 + 0.42 * len(shown))
    names = short_names([found.problem.names[k] for k in shown])
    draw.correlations(names, found.correlations[np.ix_(shown, shown)], figure.subplots())
    return figure
