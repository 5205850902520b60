"""The speeds of path-following trials: measured, simulated in several ways, and predicted without physics."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from laticauda.figures import style
from laticauda.paper.path_following import FollowingCase

ROW_HEIGHT = 0.27  # [in]
AROUND = 1.35  # height that title, labels and legend take [in]
GAP = 1.0  # rows between two groups, for the name of the second
# By joint law in its order, told apart by shapes too.
LAWS: tuple[tuple[str, str], ...] = ((style.BLUE, "o"), (style.ORANGE, "^"), (style.AMBER, "s"))
MARKS = {
    "measured": style.points("D", 6.0, markeredgecolor="white", markeredgewidth=0.6, zorder=4),
    "chosen": style.points("o", 9.5, markerfacecolor="none", markeredgewidth=0.8, zorder=5),
    "mean": style.points("o", 5.5, style.BLUE, markerfacecolor="white", markeredgewidth=1.2, zorder=3),
    "null": style.points("|", 13.0, style.GRAY, markeredgewidth=2.0, zorder=1),
}
RANGE: dict[str, Any] = {"color": "#C9DDEA", "linewidth": 5.0, "solid_capstyle": "round", "zorder": 0}


def following_speeds(rows: Sequence[FollowingCase], null: Sequence[float], ax: Axes) -> Axes:
    """Speeds of trials, one below the other: a mark per way, a line over their range.

    Args:
        rows: From top to bottom; those of a group follow each other.
        null: Predicted without physics, by row [m/s].
        ax: Where to draw.
    """
    places = _places(rows)
    for row, y, predicted in zip(rows, places, null, strict=True):
        speeds = [run.forward_velocity for run in row.band]
        ax.plot([min(speeds), max(speeds)], [y, y], **RANGE)
        for (color, marker), law in zip(LAWS, _bandwidths(row), strict=False):
            runs = [run.forward_velocity for run in row.band if run.joints == law]
            ax.plot(runs, [y] * len(runs), **style.points(marker, 4.0, color), zorder=3)
        values = {"null": predicted, "mean": row.cycle_mean.forward_velocity}
        values |= {"chosen": row.run.forward_velocity, "measured": row.measured.forward_velocity}
        for name, speed in values.items():
            ax.plot([speed], [y], clip_on=False, **MARKS[name])
    for i, (row, y) in enumerate(zip(rows, places, strict=True)):
        if i == 0 or row.group != rows[i - 1].group:
            ax.text(0.001, y - 0.75, row.group.name, fontsize=style.TICK, color=style.INK, weight="bold", va="center")
    ax.set_yticks(places, [f"case {row.measured.case}" for row in rows])
    ax.set_ylim(places[-1] + 0.6, places[0] - 1.1)
    ax.set_xlim(left=0.0)
    ax.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]))
    style.light_grid(ax, "x")
    style.dress(ax, xlabel="forward velocity [m/s]", ylabel="")
    ax.tick_params(axis="y", length=0)
    return ax


def following_speeds_sheet(
    rows: Sequence[FollowingCase], title: str, *, chosen: str, null: tuple[str, Sequence[float]]
) -> Figure:
    """The speeds of trials with a title and a legend.

    Args:
        rows: From top to bottom; those of a group follow each other.
        title: Above the axes.
        chosen: What the legend calls the chosen runs.
        null: What it calls the prediction without physics, and its speeds, by row [m/s].
    """
    n_groups = len({row.group.name for row in rows})
    figure = style.new_figure(style.DOUBLE_COLUMN, AROUND + ROW_HEIGHT * (len(rows) + GAP * n_groups))
    following_speeds(rows, null[1], figure.subplots())
    words = {"measured": "measured in the tank", "chosen": chosen, "mean": "the same, cycle-mean heading"}
    words["null"] = null[0]
    handles = [Line2D([], [], label=label, **MARKS[name]) for name, label in words.items()]
    for (color, marker), (law, found) in zip(LAWS, _bandwidths(rows[0]).items(), strict=False):
        label = f"{law} joints, {' and '.join(f'{each:g}' for each in found)} rad/s, raw heading"
        handles.append(Line2D([], [], label=label, **style.points(marker, 4.0, color)))
    band: dict[str, Any] = {**RANGE, "solid_capstyle": "butt"}
    handles.append(Line2D([], [], label="range of these", **band))
    style.legend_below(figure, handles, handlelength=1.4, handletextpad=0.7)
    style.head(figure, title)
    return figure


def _places(rows: Sequence[FollowingCase]) -> list[float]:
    """Heights of the rows, with room before each group."""
    places: list[float] = []
    for i, row in enumerate(rows):
        step = 1.0 if i == 0 or row.group == rows[i - 1].group else 1.0 + GAP
        places.append(places[-1] + step if places else 0.0)
    return places


def _bandwidths(case: FollowingCase) -> dict[str, list[float]]:
    """By joint law, the bandwidths of the band [rad/s]."""
    found: dict[str, list[float]] = {}
    for run in case.band:
        found.setdefault(run.joints, []).append(run.offset_bandwidth)
    return found
