"""What was run beyond the paper, for readers: figures, tables, and what its chapter of the report speaks of."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, MaxNLocator, MultipleLocator, NullLocator

from laticauda.figures import style
from laticauda.figures.path import extent
from laticauda.figures.swim import path_beside
from laticauda.paper.beyond import BeyondStudy, TurningCurve
from laticauda.paper.datasets import to_dataset
from laticauda.paper.report.chapter import degrees, paper_chapter
from laticauda.reports.chapter import Chapter
from laticauda.trial import Trial
from laticauda.trial.cycles import CycleMean

DRIFT, CURVED, TURNING = "beyond-cross-current", "beyond-curved-path", "beyond-turning"
STRIP = (0.55, 2.4)  # smallest and largest height of a path [in]
LABELS = 0.55  # height that labels and letters take [in]
PANEL_HEIGHT = 1.7  # [in]
HEAD = 0.75  # height that title and legend take [in]
TURN_HEIGHT = 2.2  # [in]
TURN_HEAD = 0.9  # height that title and legend take [in]
TURNS = {"turning_rate": "turning rate [deg/s]", "radius": "radius [m]", "path_speed": "path speed [m/s]"}
RADII = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)  # on the axis [m]


def beyond_chapter(study: BeyondStudy) -> Chapter:
    """What the study puts into the folder and the report.

    Args:
        study: What `run_beyond` returned.
    """
    settings = study.settings
    tightest = settings.curved.tightest_radius
    needed = {curve.swimmer.name: _offset_for(curve, settings.turning.offsets, tightest) for curve in study.turning}
    return paper_chapter(
        "beyond",
        values={
            "study": study,
            "settings": settings,
            "needed": {name: offset for name, offset in needed.items() if offset is not None},
            "turns": [_turns(curve, settings.turning.offsets) for curve in study.turning],
        },
        tables={DRIFT: _drift(study), CURVED: _curved(study), TURNING: _turning(study)},
        n_figures=3,
        figures=lambda: beyond_figures(study),
        data={"beyond.nc": lambda: to_dataset(study)},
    )


def beyond_figures(study: BeyondStudy) -> Iterator[tuple[str, str, Figure]]:
    """The study's figures, one after the other: the name of its file, what it shows, and the figure.

    Args:
        study: What `run_beyond` returned.
    """
    drift, law = study.settings.drift, study.settings.curved.law
    way = "the way, and the cycle-mean cross-track error. Simulation only."
    title = f"{drift.swimmer.name.capitalize()} in a current of {math.hypot(*drift.current):g} m/s across the path"
    drifted = {run.law.name: (run.trial, run.error) for run in study.drift}
    yield DRIFT, f"{title}: {way}", runs_sheet(drifted, title, xlabel="time [s]", tolerance=drift.tolerance)
    title = f"A curved path, line of sight with {law.name}"
    bent = {run.swimmer.name: (run.trial, CycleMean(run.along.value, run.error.value)) for run in study.curved}
    yield CURVED, f"{title}: {way}", runs_sheet(bent, title, xlabel="distance along the path [m]")
    title = "Turning with a constant offset of all joints"
    caption = f"{title}: turning rate, radius and path speed. Simulation only."
    yield TURNING, caption, turning_sheet(study.turning, title)


# ---- tables and findings -------------------------------------------------------------------------------------------


def _drift(study: BeyondStudy) -> list[dict[str, Any]]:
    """The cross current, law by law."""
    return [
        {
            "law": run.law.name,
            "look-ahead distance Delta [m]": run.law.guidance.look_ahead_distance,
            "gain [-]": run.law.gain,
            "integral gain [m/s]": getattr(run.law.guidance, "integral_gain", None),
            "mean e, last third [m]": run.mean_error,
            "rms of e, last third [m]": run.rms(2.0),
            "largest e [m]": run.largest,
            "e at the end [m]": float(run.error.value[-1]),
            "sideslip [deg]": math.degrees(run.trial.sideslip),
            "Delta tan(sideslip) [m]": run.law.guidance.look_ahead_distance * math.tan(run.trial.sideslip),
            "v [m/s]": run.trial.forward_velocity,
            "holds the path": study.settings.drift.holds(run),
        }
        for run in study.drift
    ]


def _curved(study: BeyondStudy) -> list[dict[str, Any]]:
    """The curved path, swimmer by swimmer."""
    length = study.settings.curved.path.length
    return [
        {
            "swimmer": run.swimmer.name,
            "rms of the mean error [m]": run.rms(),
            "largest mean error [m]": abs(run.largest),
            "reached the end": run.is_cut_short,
            "after [s]": run.trial.duration,
            "progress [m/s]": length / run.trial.duration if run.is_cut_short else None,
            "path speed [m/s]": run.trial.path_speed,
            "mechanical power [W]": run.trial.mechanical_power,
        }
        for run in study.curved
    ]


def _turning(study: BeyondStudy) -> list[dict[str, Any]]:
    """Open-loop turning, offset by offset."""
    return [
        {
            "swimmer": curve.swimmer.name,
            "offset [deg]": degrees(offset),
            "turning rate [deg/s]": math.degrees(curve.turning_rate[i]),
            "radius [m]": curve.radius[i],
            "radius in robot lengths [-]": curve.radius[i] / curve.swimmer.length,
            "path speed [m/s]": curve.path_speed[i],
            "mechanical power [W]": curve.mechanical_power[i],
        }
        for curve in study.turning
        for i, offset in enumerate(study.settings.turning.offsets)
    ]


def _turns(curve: TurningCurve, offsets: tuple[float, ...]) -> dict[str, Any]:
    """How fast and how tightly one swimmer turns."""
    return {
        "name": curve.swimmer.name,
        "rates": np.degrees(curve.turning_rate[[0, -1]]).tolist(),
        "radii": curve.radius[[0, -1]].tolist(),
        "per_offset": [rate / offset for rate, offset in zip(curve.turning_rate.tolist(), offsets, strict=True)],
        "tightest": float(curve.radius[-1]) / curve.swimmer.length,
        "slowed": 100.0 * (1.0 - float(curve.path_speed[-1] / curve.path_speed[0])),
    }


def _offset_for(curve: TurningCurve, offsets: tuple[float, ...], radius: float) -> float | None:
    """The offset [rad] that turns at a radius [m], between two that were run; None outside."""
    found = curve.radius
    if not (np.all(np.diff(found) < 0.0) and found[-1] <= radius <= found[0]):
        return None
    return float(np.interp(-math.log(radius), -np.log(found), offsets))


# ---- figures -------------------------------------------------------------------------------------------------------


def mean_errors(lines: Mapping[str, CycleMean], ax: Axes, *, xlabel: str, tolerance: float | None = None) -> Axes:
    """Mean distance from the path, a line per run.

    Args:
        lines: By what the legend says, the cycle mean of a run's cross-track error, positive to the left [m]; over the
            time [s] or over how far along the path it was [m].
        ax: Where to draw.
        xlabel: What the errors are drawn over, with its unit.
        tolerance: A band around the path to be shaded; None for none [m].
    """
    if tolerance is not None:
        label = f"\N{PLUS-MINUS SIGN}{100.0 * tolerance:g} cm"
        ax.axhspan(-tolerance, tolerance, color="#E4E4E4", linewidth=0.0, zorder=0, label=label)
    ax.axhline(0.0, color=style.GRAY, linewidth=style.THIN, zorder=1)
    for i, (label, error) in enumerate(lines.items()):
        color, dashes = style.LINES[i % len(style.LINES)]
        ax.plot(*error, color=color, linestyle=dashes, linewidth=1.5, label=label)
    ends = np.array([error.time[[0, -1]] for error in lines.values()])
    ax.set_xlim(min(0.0, float(ends.min())), float(ends[:, 1].max()))
    return style.dress(ax, xlabel=xlabel, ylabel="mean cross-track\nerror [m]")


def runs_sheet(
    runs: Mapping[str, tuple[Trial, CycleMean]], title: str, *, xlabel: str, tolerance: float | None = None
) -> Figure:
    """The ways of the first two runs one above the other, and below them the mean errors of all.

    Args:
        runs: By name, runs that followed a path, and their errors as for `mean_errors`.
        title: Above all panels.
        xlabel: What the errors are drawn over, with its unit.
        tolerance: As for `mean_errors` [m].
    """
    trials = [(name, trial) for name, (trial, _) in runs.items()][:2]
    lines = {name: error for name, (_, error) in runs.items()}
    width = style.DOUBLE_COLUMN
    extents = [extent(trial) for _, trial in trials]
    # One scale for all ways: they are drawn as wide as the longest.
    scale = (width - 0.9) / max(wide for wide, _ in extents)
    strips = [float(np.clip(scale * high, *STRIP)) + LABELS for _, high in extents]
    figure = style.new_figure(width, sum(strips) + PANEL_HEIGHT + LABELS + HEAD)
    grid = figure.add_gridspec(len(trials) + 1, 1, height_ratios=(*strips, PANEL_HEIGHT + LABELS))
    axes: list[Axes] = []
    for i, (words, trial) in enumerate(trials):
        ax = path_beside(trial, figure.add_subplot(grid[i], **({"sharex": axes[0]} if axes else {})))
        style.letter(ax, i, words)
        axes.append(ax)
    for ax in axes[:-1]:
        ax.set_xlabel("")
    last = mean_errors(lines, figure.add_subplot(grid[-1]), xlabel=xlabel, tolerance=tolerance)
    style.letter(last, len(trials))
    figure.align_ylabels([*axes, last])
    style.head(figure, title)
    style.legend_below(figure, *last.get_legend_handles_labels())
    return figure


def turning(lines: Sequence[TurningCurve], name: str, ax: Axes) -> Axes:
    """A quantity over the offset; the radius on a scale of ratios.

    Args:
        lines: The data.
        name: One of `TURNS`.
        ax: Where to draw.
    """
    values = [np.degrees(line.turning_rate) if name == "turning_rate" else getattr(line, name) for line in lines]
    for line, value in zip(lines, values, strict=True):
        is_eel_like, has_fin = line.swimmer.gait.kind == "eel_like", line.swimmer.has_fin
        ax.plot(
            np.degrees(line.offset),
            value,
            color=style.ORANGE if is_eel_like else style.BLUE,
            linestyle="-" if has_fin else (0, (5, 2)),
            linewidth=1.4,
            marker="s" if is_eel_like else "o",
            markersize=3.2,
            markerfacecolor=None if has_fin else "white",
            label=line.swimmer.name,
        )
    style.light_grid(ax, "y")
    ax.set_xlim(0.0, 1.04 * max(float(np.degrees(line.offset[-1])) for line in lines))
    ax.xaxis.set_major_locator(MultipleLocator(5.0))
    style.dress(ax, xlabel="offset $\\phi_0$ [deg]", ylabel=TURNS[name])
    if name == "radius":
        ax.set_yscale("log")
        ax.set_ylim(0.8 * min(map(np.min, values)), 1.25 * max(map(np.max, values)))
        ax.yaxis.set_major_locator(FixedLocator(RADII))
        ax.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        ax.yaxis.set_minor_locator(NullLocator())
    return ax


def turning_sheet(lines: Sequence[TurningCurve], title: str) -> Figure:
    """Rate, radius and speed side by side.

    Args:
        lines: One per swimmer.
        title: Above all panels.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, TURN_HEIGHT + TURN_HEAD)
    axes: list[Axes] = list(figure.subplots(1, 3))
    for place, (name, ax) in enumerate(zip(TURNS, axes, strict=True)):
        style.letter(turning(lines, name, ax), place)
    for ax in (axes[0], axes[2]):
        ax.set_ylim(0.0, None)
        ax.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    style.head(figure, title)
    style.legend_below(figure, *axes[0].get_legend_handles_labels())
    return figure
