"""The stability maps for readers: figure, tables, and what their chapter of the report speaks of."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.patheffects import withStroke

from laticauda.figures import style
from laticauda.paper.datasets import to_dataset
from laticauda.paper.report.chapter import paper_chapter
from laticauda.paper.stability import COMING, SETTLED, SWINGS, Loops, StabilityStudy
from laticauda.reports.chapter import Chapter

HEADINGS = {"cycle_mean": "mean heading", "raw": "raw heading"}
Edge = tuple[tuple[float, float], tuple[float, float]]

COLORS = colormaps["cividis"]  # its lightness rises evenly, also for the color-blind
SCALE = LogNorm(1e-3, 0.4)  # [m]
SMALLEST = 1e-3  # below it a cell says no more than that [m]
GAP = 0.45  # between mean and raw heading, in cells
CELL = (0.43, 0.24)  # [in]
NUMBER = 6.5  # size of the numbers in the cells [pt]
BOUNDARY = 2.0  # width of the line around the loops that have not settled [pt]
HATCH = "////"


def stability_chapter(study: StabilityStudy) -> Chapter:
    """What the stability maps put into the folder and the report.

    Args:
        study: What `run_stability` returned.
    """
    return paper_chapter(
        "stability",
        values={
            "study": study,
            "settings": study.settings,
            "at_the_papers_gains": _at_the_papers_gains(study),
            "rule": _rule_of_thumb(study),
            "shortest": _shortest(study),
            "speeds": _speeds(study),
        },
        tables={"stability-boundary": _boundary(study), "stability": _points(study)},
        n_figures=1,
        figures=lambda: stability_figures(study),
        data={"stability.nc": lambda: to_dataset(study)},
    )


def stability_figures(study: StabilityStudy) -> Iterator[tuple[str, str, Figure]]:
    """The maps in one figure: the name of its file, what it shows, and the figure.

    Args:
        study: What `run_stability` returned.
    """
    settings = study.settings
    title = "Line of sight over look-ahead distance and gain: where the loop settles on the path"
    caption = (
        f"{title}. Numbers: root mean square of the cycle-mean cross-track error over the last third of "
        f"{settings.duration:g} s [cm]; below {100.0 * settings.tolerance:g} cm a loop has settled. The dashed line is "
        "the rule of thumb, two lengths of the robot with its fin; the frames are the paper's gains."
    )
    start = f"start {settings.initial_cross_track_error:g} m beside the path, {settings.duration:g} s"
    note = f"numbers: rms of the mean error, last third [cm]; {start}"
    yield "stability", caption, stability_sheet(study.maps, title, settings.paper, note)


# ---- tables --------------------------------------------------------------------------------------------------------


def _boundary(study: StabilityStudy) -> list[dict[str, Any]]:
    """How long a look-ahead distance each gain takes."""
    return [
        {
            "swimmer": loops.swimmer.name,
            "heading": HEADINGS[loops.heading],
            "gain [-]": gain,
            "shortest look-ahead distance [m]": distance,
            "in robot lengths [-]": None if distance is None else distance / loops.swimmer.length,
        }
        for loops in study.maps
        for gain, distance in zip(loops.gains.tolist(), loops.shortest, strict=True)
    ]


def _points(study: StabilityStudy) -> list[dict[str, Any]]:
    """Every point of every map."""
    return [
        {
            "swimmer": loops.swimmer.name,
            "heading": HEADINGS[loops.heading],
            "look-ahead distance [m]": distance,
            "gain [-]": gain,
            "behavior": str(loops.behaviors[i, j]),
            "rms of the mean error, last third [m]": loops.rms[i, j],
            "rms of the mean error, second third [m]": loops.rms_before[i, j],
            "v [m/s]": loops.forward_velocity[i, j],
        }
        for loops in study.maps
        for i, distance in enumerate(study.settings.look_ahead_distances)
        for j, gain in enumerate(loops.gains.tolist())
    ]


# ---- findings ------------------------------------------------------------------------------------------------------


def _at_the_papers_gains(study: StabilityStudy) -> dict[str, list[tuple[str, str, float]]]:
    """By heading, what the loop of each swimmer does with the paper's pair, and its error [m]."""
    distance, gain = study.settings.paper
    said: dict[str, list[tuple[str, str, float]]] = {words: [] for words in HEADINGS.values()}
    for loops in study.maps:
        here = np.ix_(loops.look_ahead_distances == distance, np.isclose(loops.gains, gain))
        for name, rms in zip(loops.behaviors[here].flat, loops.rms[here].flat, strict=True):
            said[HEADINGS[loops.heading]].append((loops.swimmer.name, str(name), float(rms)))
    return {words: loops for words, loops in said.items() if loops}


def _rule_of_thumb(study: StabilityStudy) -> dict[str, int]:
    """Whether two robot lengths are enough, and whether they are needed: loops with the mean heading, counted."""
    counts: dict[str, int] = dict.fromkeys(("n_above", "swinging_above", "n_below", "settled_below"), 0)
    for loops in _with_mean_heading(study):
        behaviors = loops.behaviors
        above = loops.look_ahead_distances >= 2.0 * loops.swimmer.length * (1.0 - 1e-9)
        counts["n_above"] += behaviors[above].size
        counts["n_below"] += behaviors[~above].size
        counts["swinging_above"] += int(np.sum(behaviors[above] == SWINGS))
        counts["settled_below"] += int(np.sum(behaviors[~above] == SETTLED))
    return counts


def _shortest(study: StabilityStudy) -> list[tuple[str, float | None]]:
    """By swimmer, the shortest look-ahead distance that settles at the paper's gain with the mean heading [m]."""
    at = [j for j, gain in enumerate(study.settings.gains) if math.isclose(gain, study.settings.paper[1])]
    return [(loops.swimmer.name, loops.shortest[j]) for j in at for loops in _with_mean_heading(study)]


def _speeds(study: StabilityStudy) -> list[tuple[str, list[float], list[float]]]:
    """By swimmer that has both, the speeds of loops that settle and of those in a limit cycle [m/s]."""
    found: list[tuple[str, list[float], list[float]]] = []
    for loops in _with_mean_heading(study):
        settled, swinging = (loops.forward_velocity[loops.behaviors == one].tolist() for one in (SETTLED, SWINGS))
        if settled and swinging:
            found.append((loops.swimmer.name, settled, swinging))
    return found


def _with_mean_heading(study: StabilityStudy) -> list[Loops]:
    return [loops for loops in study.maps if loops.heading == "cycle_mean"]


# ---- figure --------------------------------------------------------------------------------------------------------


def stability_map(mean: Loops, raw: Loops, ax: Axes, paper: tuple[float, float]) -> Axes:
    """One map: color and number are the error, a thick line parts the loops that settle from those that do not.

    The first columns are for the mean heading, those behind the gap for the raw one.

    Args:
        mean: The map of one swimmer with the mean heading.
        raw: The same with the raw one; it may be empty.
        ax: Where to draw.
        paper: Look-ahead distance [m] and gain [-] to be marked.
    """
    distances, n, beside = mean.look_ahead_distances, mean.gains.size, mean.gains.size + GAP
    columns = [*range(n), *(beside + j for j in range(raw.gains.size))]
    for loops, begin in ((mean, 0.0), (raw, beside)):
        _draw_loops(loops, begin, ax, paper)
    above = np.flatnonzero(distances >= 2.0 * mean.swimmer.length * (1.0 - 1e-9))
    if above.size:  # the rule of thumb, a line under the first distance that keeps it
        at, ends = float(above[0]) - 0.5, (-0.5, columns[-1] + 0.5)
        ax.plot(ends, (at, at), color=style.ORANGE, linewidth=1.4, linestyle=(0, (4, 2)), zorder=4, clip_on=False)
    ax.set_xlim(-0.5, columns[-1] + 0.5)
    ax.set_ylim(-0.5, distances.size - 0.5)
    ax.set_xticks(columns, [f"{gain:g}" for gain in (*mean.gains, *raw.gains)])
    ax.set_yticks(range(distances.size), [f"{value:g}" for value in distances])
    if raw.gains.size:
        for at, words in ((np.mean(columns[:n]), "mean heading"), (np.mean(columns[n:]), "raw")):
            above_panel: Any = {"xycoords": ("data", "axes fraction"), "annotation_clip": False}
            style.note(ax, words, (float(at), 1.0), (0.0, 3.0), ha="center", color=style.INK, **above_panel)
    style.dress(ax, xlabel="gain k [-]", ylabel="look-ahead distance $\\Delta$ [m]")
    for spine in ax.spines.values():
        spine.set_visible(False)
    ax.tick_params(length=0)
    return ax


def stability_sheet(maps: Sequence[Loops], title: str, paper: tuple[float, float], note: str = "") -> Figure:
    """All maps, two in a row, with their scale and what the marks mean.

    Args:
        maps: Two per swimmer: with the mean heading, and with the raw one.
        title: Above all panels.
        paper: Look-ahead distance [m] and gain [-] to be marked.
        note: A second line under the title; "" for none.
    """
    panels = [*zip(maps[::2], maps[1::2], strict=True)]
    n_rows = -(-len(panels) // 2)
    height = n_rows * (maps[0].look_ahead_distances.size * CELL[1] + 0.85) + 1.1
    figure = style.new_figure(style.DOUBLE_COLUMN, height)
    grid = figure.subplots(n_rows, 2, squeeze=False)
    axes: list[Axes] = [ax for row in grid for ax in row]
    for place, (panel, ax) in enumerate(zip(panels, axes, strict=False)):
        style.letter(stability_map(*panel, ax, paper), place, panel[0].swimmer.name, pad=16)
    for ax in axes[len(panels) :]:
        ax.set_visible(False)
    used = axes[: len(panels)]
    bar = figure.colorbar(ScalarMappable(SCALE, COLORS), ax=used, aspect=45, pad=0.015, extend="both")
    bar.set_ticks([1e-3, 1e-2, 0.1, 0.4], labels=["0.1", "1", "10", "40"])
    bar.ax.minorticks_off()
    bar.ax.tick_params(labelsize=style.TICK, labelcolor=style.INK, color=style.GRAY, width=style.THIN, length=3)
    bar.set_label("rms of the mean error, last third [cm]", fontsize=style.LABEL, color=style.INK)
    bar.outline.set_visible(False)  # pyright: ignore[reportCallIssue, reportAttributeAccessIssue]
    style.head(figure, title, note)
    style.legend_below(figure, _handles(), ncols=4, handlelength=1.9, columnspacing=1.4)
    return figure


def _draw_loops(loops: Loops, begin: float, ax: Axes, paper: tuple[float, float]) -> None:
    """The cells from a column on, lines between those that settle and those that do not, and the paper's in a frame."""
    behaviors, settled = loops.behaviors, loops.behaviors == SETTLED
    for (row, j), error in np.ndenumerate(loops.rms):
        _draw_cell(ax, begin + j, row, float(error), str(behaviors[row, j]))
    above, beside = (
        np.argwhere(change).tolist() for change in (settled[1:] != settled[:-1], settled[:, 1:] != settled[:, :-1])
    )
    edges: list[Edge] = [((begin + j - 0.5, row + 0.5), (begin + j + 0.5, row + 0.5)) for row, j in above]
    edges += [((begin + j + 0.5, row - 0.5), (begin + j + 0.5, row + 0.5)) for row, j in beside]
    ax.add_collection(LineCollection(edges, colors=style.INK, linewidths=BOUNDARY, capstyle="projecting", zorder=3))
    is_papers = np.outer(np.isclose(loops.look_ahead_distances, paper[0]), np.isclose(loops.gains, paper[1]))
    frames = [Rectangle((begin + j - 0.42, row - 0.4), 0.84, 0.8) for row, j in np.argwhere(is_papers).tolist()]
    ax.add_collection(PatchCollection(frames, facecolor="none", edgecolor=style.ORANGE, linewidth=1.5, zorder=5))


def _draw_cell(ax: Axes, at: float, row: int, error: float, behavior: str) -> None:
    red, green, blue, _ = COLORS(SCALE(max(error, SMALLEST)))
    cell = Rectangle((at - 0.5, row - 0.5), 1.0, 1.0, facecolor=(red, green, blue), edgecolor="white", linewidth=0.8)
    ax.add_patch(cell)
    if behavior == COMING:
        over = Rectangle((at - 0.5, row - 0.5), 1.0, 1.0, fill=False, edgecolor="white", linewidth=0.0, hatch=HATCH)
        ax.add_patch(over)
    is_light = 0.30 * red + 0.59 * green + 0.11 * blue > 0.5
    ax.text(
        at,
        row,
        _centimeters(error),
        ha="center",
        va="center_baseline",
        fontsize=NUMBER,
        color=style.INK if is_light else "white",
        fontweight="bold" if behavior != SETTLED else "normal",
        path_effects=[withStroke(linewidth=1.6, foreground=(red, green, blue))],
    )


def _centimeters(error: float) -> str:
    """An error [m] as a cell says it [cm]."""
    if error < SMALLEST:
        return f"<{100.0 * SMALLEST:g}"
    return f"{100.0 * error:.1f}" if error < 0.0995 else f"{100.0 * error:.0f}"


def _handles() -> list[Line2D | Patch]:
    return [
        Line2D([], [], color=style.INK, linewidth=BOUNDARY, label="settled | not settled (bold)"),
        Patch(
            facecolor=COLORS(SCALE(0.06)),
            edgecolor="white",
            hatch=HATCH,
            linewidth=0.0,
            label="not settled, still coming",
        ),
        Line2D([], [], color=style.ORANGE, linewidth=1.4, linestyle=(0, (4, 2)), label="two robot lengths"),
        Patch(facecolor="none", edgecolor=style.ORANGE, linewidth=1.5, label="the paper's gains"),
    ]
