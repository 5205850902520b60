"""Figure of the path-following study: the speeds of all trials, one trial below the other.

Each trial has the measured speed, a mark per simulation with a line over their range, and the speed
that is predicted without physics.
"""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from laticauda.paper.path_following import FollowingCase, FollowingRun, group_by_law
from laticauda.show.figures import style

ROW_HEIGHT = 0.27
"""Height of a trial [in]."""
AROUND = 1.35
"""Height of title, labels and legend [in]."""
GAP = 1.0
"""Rows between two groups, for the name of the second [-]."""
LAWS: tuple[dict[str, Any], ...] = (
    style.marker_style("o", 4.0, style.BLUE),
    style.marker_style("^", 4.0, style.ORANGE),
    style.marker_style("s", 4.0, style.AMBER),
)
"""Marks of simulated speeds by joint law, in order; distinguished by shape as well."""
SPEED_MARKS = {
    "measured": style.marker_style(
        "D", 6.0, markeredgecolor="white", markeredgewidth=0.6, zorder=4
    ),
    "chosen": style.marker_style("o", 9.5, markerfacecolor="none", markeredgewidth=0.8, zorder=5),
    "mean": style.marker_style(
        "o", 5.5, style.BLUE, markerfacecolor="white", markeredgewidth=1.2, zorder=3
    ),
    "null": style.marker_style("|", 13.0, style.GRAY, markeredgewidth=2.0, zorder=1),
    "own": style.marker_style(
        "*", 9.0, "#007A5A", markeredgecolor="white", markeredgewidth=0.5, zorder=4.5
    ),
}
"""Marks of other speeds: measured, of the chosen run, without physics, and of our own model."""
RANGE: dict[str, Any] = {
    "color": "#C9DDEA",
    "linewidth": 5.0,
    "solid_capstyle": "round",
    "zorder": 0,
}
"""Look of the line over the range of simulated speeds."""


class LabeledSpeeds(NamedTuple):
    """A prediction of the speeds of all trials."""

    label: str
    """Label in the legend."""
    speeds: Sequence[float]
    """Speed by trial [m/s]."""


def draw_speeds_sheet(
    rows: Sequence[FollowingCase],
    title: str,
    *,
    chosen: str,
    null: LabeledSpeeds,
    own: Sequence[LabeledSpeeds] = (),
) -> Figure:
    """Draw the speeds of trials with a title and a legend.

    Args:
        rows: Cases from top to bottom; those of a group are consecutive.
        title: Title above the axes.
        chosen: Legend label of the chosen runs.
        null: Prediction without physics.
        own: At most one more model, marked in every row.
    """
    n_groups = len({row.group.name for row in rows})
    height = AROUND + ROW_HEIGHT * (len(rows) + GAP * n_groups)
    figure = style.new_figure(style.DOUBLE_COLUMN, height)
    ax = draw_following_speeds(rows, null.speeds, figure.subplots())
    labels = {"measured": "measured in the tank"}
    for model in own:
        _draw_own_speeds(rows, model.speeds, ax)
        labels["own"] = model.label
    labels |= {
        "chosen": chosen,
        "mean": "the same, cycle-mean heading",
        "null": null.label,
    }
    style.outside_legend(
        figure,
        _list_handles(rows[0], labels),
        "outside lower center",
        ncols=2,
        handlelength=1.4,
        handletextpad=0.7,
    )
    style.add_title(figure, title)
    return figure


def draw_following_speeds(rows: Sequence[FollowingCase], null: Sequence[float], ax: Axes) -> Axes:
    """Draw the speeds of trials, one below the other: marks, and a line over the simulated range.

    Args:
        rows: Cases from top to bottom; those of a group are consecutive.
        null: Speeds predicted without physics, by row [m/s].
        ax: Axes to draw on.
    """
    heights = _find_heights(rows)
    for row, height, predicted in zip(rows, heights, null, strict=True):
        _draw_row(row, height, predicted, ax)
    _name_groups(rows, heights, ax)
    ax.set_yticks(heights, [f"case {row.measured.case}" for row in rows])
    ax.set_ylim(heights[-1] + 0.6, heights[0] - 1.1)
    ax.set_xlim(left=0.0)
    ax.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]))
    style.light_grid(ax, "x")
    style.style_axes(ax, xlabel="forward velocity [m/s]", ylabel="")
    ax.tick_params(axis="y", length=0)
    return ax


def _draw_own_speeds(rows: Sequence[FollowingCase], speeds: Sequence[float], ax: Axes) -> None:
    for height, speed in zip(_find_heights(rows), speeds, strict=True):
        ax.plot([speed], [height], clip_on=False, **SPEED_MARKS["own"])


def _find_heights(rows: Sequence[FollowingCase]) -> list[float]:
    """Return the position of each row on the axis, from the top; groups are apart [rows]."""
    steps = [0.0]
    for previous, row in pairwise(rows):
        gap = GAP
        if row.group == previous.group:
            gap = 0.0
        steps.append(1.0 + gap)
    return np.cumsum(steps).tolist()


def _draw_row(row: FollowingCase, height: float, predicted: float, ax: Axes) -> None:
    """Draw all speeds of a trial."""
    band_speeds = _speeds_of(row.band)
    ax.plot([min(band_speeds), max(band_speeds)], [height, height], **RANGE)
    for look, runs in zip(LAWS, group_by_law(row).values(), strict=False):
        ax.plot(_speeds_of(runs), [height] * len(runs), **look, zorder=3)
    speeds = {
        "null": predicted,
        "mean": row.cycle_mean.forward_velocity,
        "chosen": row.run.forward_velocity,
        "measured": row.measured.forward_velocity,
    }
    for name, speed in speeds.items():
        ax.plot([speed], [height], clip_on=False, **SPEED_MARKS[name])


def _speeds_of(runs: Sequence[FollowingRun]) -> list[float]:
    return [run.forward_velocity for run in runs]


def _name_groups(rows: Sequence[FollowingCase], heights: Sequence[float], ax: Axes) -> None:
    """Write the name of every group above its first row."""
    named_group = None
    for row, height in zip(rows, heights, strict=True):
        if row.group == named_group:
            continue
        named_group = row.group
        ax.text(
            0.001,
            height - 0.75,
            row.group.name,
            fontsize=style.TICK,
            color=style.INK,
            weight="bold",
            va="center",
        )


def _list_handles(row: FollowingCase, labels: dict[str, str]) -> list[Line2D]:
    """Return the handles of the legend: the marks, the joint laws of a row, and the range."""
    handles: list[Line2D] = []
    for name, label in labels.items():
        handles.append(Line2D([], [], label=label, **SPEED_MARKS[name]))
    runs_by_law = group_by_law(row)
    for look, law in zip(LAWS, runs_by_law, strict=False):
        label = _describe_law(law, runs_by_law[law])
        handles.append(Line2D([], [], label=label, **look))
    range_look: dict[str, Any] = {**RANGE, "solid_capstyle": "butt"}
    handles.append(Line2D([], [], label="range of these", **range_look))
    return handles


def _describe_law(law: str, runs: Sequence[FollowingRun]) -> str:
    """Return the legend label of the runs with a joint law."""
    bandwidths = " and ".join(f"{run.offset_bandwidth:g}" for run in runs)
    return f"{law} joints, {bandwidths} rad/s, raw heading"
