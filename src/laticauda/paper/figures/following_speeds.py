"""The speeds of path-following trials: measured, simulated in several ways, and predicted without physics."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from laticauda.figures import style

ROW_HEIGHT = 0.27  # [in]
AROUND = 1.35  # height that title, labels and legend take [in]
GAP = 1.0  # rows between two groups, for the name of the second
# By joint law in its order, told apart by shapes too.
LAWS: tuple[tuple[str, str], ...] = ((style.BLUE, "o"), (style.ORANGE, "^"), (style.AMBER, "s"))
MARKS: dict[str, dict[str, Any]] = {
    "measured": {
        "marker": "D",
        "color": style.INK,
        "markeredgecolor": "white",
        "markeredgewidth": 0.6,
        "markersize": 6.0,
        "zorder": 4,
    },
    "chosen": {
        "marker": "o",
        "markerfacecolor": "none",
        "markeredgecolor": style.INK,
        "markeredgewidth": 0.8,
        "markersize": 9.5,
        "zorder": 5,
    },
    "mean": {
        "marker": "o",
        "markerfacecolor": "white",
        "markeredgecolor": style.BLUE,
        "markeredgewidth": 1.2,
        "markersize": 5.5,
        "zorder": 3,
    },
    "null": {"marker": "|", "color": style.GRAY, "markersize": 13.0, "markeredgewidth": 2.0, "zorder": 1},
}
RANGE: dict[str, Any] = {"color": "#C9DDEA", "linewidth": 5.0, "solid_capstyle": "round", "zorder": 0}


@dataclass(frozen=True, kw_only=True)
class SpeedRow:
    """One trial; all speeds are averages over the whole run [m/s]."""

    group: str
    """What it has in common with the rows beside it."""
    label: str
    """What tells it from them."""
    measured: float
    """In the tank [m/s]."""
    simulated: Mapping[str, tuple[float, ...]]
    """By joint law as the legend has it, one or several runs [m/s]."""
    chosen: float
    """The one of them that stands for the simulation [m/s]."""
    cycle_mean: float
    """The same with the mean heading over the gait cycle [m/s]."""
    null: float
    """Predicted without physics [m/s]."""


def following_speeds(rows: Sequence[SpeedRow], ax: Axes) -> Axes:
    """Speeds of trials, one below the other: a mark per way, a line over their range.

    Args:
        rows: From top to bottom; those of a group follow each other.
        ax: Where to draw.
    """
    places = _places(rows)
    for row, y in zip(rows, places, strict=True):
        speeds = [speed for runs in row.simulated.values() for speed in runs]
        ax.plot([min(speeds), max(speeds)], [y, y], **RANGE)
        for (color, marker), runs in zip(LAWS, row.simulated.values(), strict=False):
            ax.plot(runs, [y] * len(runs), color=color, marker=marker, markersize=4.0, linestyle="none", zorder=3)
        values = {"null": row.null, "mean": row.cycle_mean, "chosen": row.chosen, "measured": row.measured}
        for name, speed in values.items():
            ax.plot([speed], [y], linestyle="none", clip_on=False, **MARKS[name])
    for row, y in zip(rows, places, strict=True):
        if row.group not in (other.group for other, place in zip(rows, places, strict=True) if place < y):
            ax.text(0.001, y - 0.75, row.group, fontsize=style.TICK, color=style.INK, weight="bold", va="center")
    ax.set_yticks(places, [row.label for row in rows])
    ax.set_ylim(places[-1] + 0.6, places[0] - 1.1)
    ax.set_xlim(left=0.0)
    ax.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]))
    style.light_grid(ax, "x")
    style.dress(ax, xlabel="forward velocity [m/s]", ylabel="")
    ax.tick_params(axis="y", length=0)
    return ax


def following_speeds_sheet(rows: Sequence[SpeedRow], title: str, *, chosen: str, null: str) -> Figure:
    """The speeds of trials with a title and a legend.

    Args:
        rows: From top to bottom; those of a group follow each other.
        title: Above the axes.
        chosen: What the legend calls the chosen runs.
        null: What it calls the prediction without physics.
    """
    n_groups = len({row.group for row in rows})
    figure = style.new_figure(style.DOUBLE_COLUMN, AROUND + ROW_HEIGHT * (len(rows) + GAP * n_groups))
    following_speeds(rows, figure.subplots())
    words = {"measured": "measured in the tank", "chosen": chosen, "mean": "the same, cycle-mean heading", "null": null}
    handles = [Line2D([], [], linestyle="none", label=label, **MARKS[name]) for name, label in words.items()]
    for (color, marker), law in zip(LAWS, rows[0].simulated, strict=False):
        handles.append(Line2D([], [], linestyle="none", color=color, marker=marker, markersize=4.0, label=law))
    band: dict[str, Any] = {**RANGE, "solid_capstyle": "butt"}
    handles.append(Line2D([], [], label="range of these", **band))
    style.legend_below(figure, handles, handlelength=1.4, handletextpad=0.7)
    style.head(figure, title)
    return figure


def _places(rows: Sequence[SpeedRow]) -> list[float]:
    """Heights of the rows, with room before each group."""
    places: list[float] = []
    for i, row in enumerate(rows):
        step = 1.0 if i == 0 or row.group == rows[i - 1].group else 1.0 + GAP
        places.append(places[-1] + step if places else 0.0)
    return places
