"""Open-loop turning: rate, radius and speed over the offset of all joints."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, MaxNLocator, MultipleLocator, NullLocator

from laticauda.figures import style
from laticauda.paper.turning import TurningCurve

PANEL_HEIGHT = 2.2  # [in]
HEAD = 0.9  # height that title and legend take [in]
RADII = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)  # on the axis [m]


def turning_rates(lines: Sequence[TurningCurve], ax: Axes) -> Axes:
    """Turning rate over the offset.

    Args:
        lines: The data.
        ax: Where to draw.
    """
    return _draw(lines, [np.degrees(line.turning_rate) for line in lines], ax, "turning rate [deg/s]")


def turning_radii(lines: Sequence[TurningCurve], ax: Axes) -> Axes:
    """Radius of the turn over the offset, on a scale of ratios.

    Args:
        lines: The data.
        ax: Where to draw.
    """
    _draw(lines, [line.radius for line in lines], ax, "radius [m]")
    ax.set_yscale("log")
    shown = [value for line in lines for value in line.radius.tolist()]
    ax.set_ylim(0.8 * min(shown), 1.25 * max(shown))
    ax.yaxis.set_major_locator(FixedLocator(RADII))
    ax.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    ax.yaxis.set_minor_locator(NullLocator())
    return ax


def turning_speeds(lines: Sequence[TurningCurve], ax: Axes) -> Axes:
    """Path speed over the offset.

    Args:
        lines: The data.
        ax: Where to draw.
    """
    return _draw(lines, [line.path_speed for line in lines], ax, "path speed [m/s]")


def turning_sheet(lines: Sequence[TurningCurve], title: str) -> Figure:
    """Rate, radius and speed side by side.

    Args:
        lines: One per swimmer.
        title: Above all panels.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, PANEL_HEIGHT + HEAD)
    axes: list[Axes] = list(figure.subplots(1, 3))
    for place, (draw, ax) in enumerate(zip((turning_rates, turning_radii, turning_speeds), axes, strict=True)):
        draw(lines, ax)
        style.letter(ax, place)
    for ax in (axes[0], axes[2]):
        ax.set_ylim(0.0, None)
        ax.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    style.head(figure, title)
    style.legend_below(figure, *axes[0].get_legend_handles_labels())
    return figure


def _draw(lines: Sequence[TurningCurve], values: Sequence[Float[np.ndarray, " n_offsets"]], ax: Axes, y: str) -> Axes:
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
    return style.dress(ax, xlabel="offset $\\phi_0$ [deg]", ylabel=y)
