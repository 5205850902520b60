"""Several runs in one figure: overlaid paths and speeds, and the results of a sweep."""

# matplotlib's and xarray's own annotations are partial; this package passes on typed figures and
# axes.
# pyright: reportUnknownMemberType=false

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from laticauda.figures import style
from laticauda.figures.swim import cycle_mean_speed, forward_speed
from laticauda.trial import Trial

if TYPE_CHECKING:
    import xarray

SHOWN = {"forward_velocity": "forward velocity", "cost_of_transport": "cost of transport"}
"""Quantities of a sweep that are drawn, and their names on an axis."""
HEIGHT = 3.0  # of a figure, without its legend or title [in]
ROW = 0.2  # of a legend [in]
CLEAR = 3.0  # a maximum of this many times the 90 % quantile would leave the other values dark
MOST_MARKS = 40  # largest number of points on a line that are marked


def plot_overlay(trials: Sequence[Trial], names: Sequence[str]) -> Figure:
    """Plot the paths of several trials on top of each other, and their speeds as means over a gait cycle.

    Args:
        trials: Any trials; for one without whole gait cycles, the forward speed itself is drawn.
        names: Name of each trial.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, HEIGHT + ROW * math.ceil(len(trials) / 2))
    path, velocity = figure.subplots(1, 2, width_ratios=(1.2, 1.0))
    for trial, name, (color, dashes) in zip(trials, names, itertools.cycle(_looks()), strict=False):
        look: Any = {"color": color, "linestyle": dashes, "linewidth": style.LINE}
        mean = cycle_mean_speed(trial)
        path.plot(*trial.center_of_mass[:, :2].T, **look, label=name)
        path.plot(*trial.center_of_mass[-1, :2], **style.marker_style("o", 3.5, color))
        velocity.plot(*((trial.time, forward_speed(trial)) if mean is None else mean), **look)
    path.set_aspect("equal", adjustable="datalim")
    style.outside_legend(figure, path.get_legend_handles_labels()[0], "outside lower left", ncols=2)
    style.style_axes(path, xlabel="x [m]", ylabel="y [m]")
    style.style_axes(velocity, xlabel="time [s]", ylabel="speed, mean over a cycle [m/s]")
    return figure


def _looks() -> list[tuple[str, Any]]:
    """Return all distinct combinations of line colors and dashes."""
    n = len(style.LINES)
    return [
        (style.LINES[i][0], style.LINES[(i + turn) % n][1]) for turn in range(n) for i in range(n)
    ]


def sweep_sheet(found: "xarray.Dataset") -> Figure:
    """Plot forward velocity and cost of transport over the varied quantities: lines for one, maps for two.

    For a grid of more, the map lies in the plane of the first two through the fastest point, and
    the figure says so; for lists and samples, every point is a dot over the first two.

    Args:
        found: Sweep as read by `laticauda.studies.open_sweep`.
    """
    found, names, held = _plane(found)
    figure = style.new_figure(style.DOUBLE_COLUMN, HEIGHT)
    axes: Sequence[Axes] = figure.subplots(1, len(SHOWN))
    for quantity, ax in zip(SHOWN, axes, strict=True):
        (_over_one if len(names) == 1 else _over_two)(found, names, quantity, ax)
    lost = int(np.count_nonzero(~np.isfinite(found.forward_velocity.to_numpy())))
    about = f"Sweep of {found.attrs['robot']}, {found.attrs['gait'].replace('_', ' ')}, {found.attrs['duration']:g} s"
    notes = [held, f"{lost} of {found.forward_velocity.size} without a value" if lost else ""]
    style.add_title(figure, about, "; ".join(filter(None, notes)))
    return figure


def _plane(found: "xarray.Dataset") -> tuple["xarray.Dataset", list[str], str]:
    """Return the part of a sweep to draw, the one or two quantities of its axes, and a text about the others."""
    names = [str(name) for name in found.coords if name != "trial"]
    varied = [name for name in names if np.unique(found[name].to_numpy()).size > 1] or names[:1]
    shown, others = varied[:2], varied[2:]
    if not others or found.forward_velocity.dims == ("trial",):
        rest = f"over all of {', '.join(_label(found, name) for name in others)}" if others else ""
        return found.squeeze(({*names} - {*shown}) & {*map(str, found.dims)}), shown, rest
    speed = np.nan_to_num(found.forward_velocity.to_numpy(), nan=-np.inf)
    best = dict(zip(found.dims, np.unravel_index(int(np.argmax(speed)), speed.shape), strict=True))
    plane = found.isel({name: int(i) for name, i in best.items() if name not in shown})
    said = ", ".join(f"{_label(plane, name)} {_read(plane, name):.4g}" for name in others)
    return plane, shown, f"through the fastest point, {said}"


def _over_one(found: "xarray.Dataset", names: list[str], quantity: str, ax: Axes) -> Axes:
    """Draw a line, with its points marked if they can be distinguished."""
    x, y = _read(found, names[0]), found[quantity].to_numpy()
    order = np.argsort(x)
    marker = "o" if x.size <= MOST_MARKS else ""
    ax.plot(x[order], y[order], color=style.BLUE, linewidth=style.LINE, marker=marker, markersize=3)
    return style.style_axes(ax, xlabel=_label(found, names[0]), ylabel=_label(found, quantity))


def _over_two(found: "xarray.Dataset", names: list[str], quantity: str, ax: Axes) -> Axes:
    """Draw a filled map for a grid, colored dots for anything else; values far above the rest saturate."""
    x, y, values = *(_read(found, name) for name in names), found[quantity]
    known = values.to_numpy()[np.isfinite(values.to_numpy())]
    high = float(np.quantile(known, 0.9)) if known.size else 1.0
    is_cut = known.size > 0 and float(known.max()) > CLEAR * high > 0.0
    look: Any = {"cmap": "viridis", "vmax": high if is_cut else None}
    if values.dims == ("trial",):
        drawn: Any = ax.scatter(x, y, c=values.to_numpy(), s=10, **look)
    else:
        drawn = ax.pcolormesh(
            x, y, values.transpose(names[1], names[0]).to_numpy(), shading="nearest", **look
        )
    figure: Any = ax.get_figure(root=True)
    bar = figure.colorbar(drawn, ax=ax, extend="max" if is_cut else "neither")
    bar.set_label(_label(found, quantity), fontsize=style.LABEL, color=style.INK)
    bar.ax.tick_params(labelsize=style.TICK, labelcolor=style.INK)
    bar.outline.set_visible(False)
    return style.style_axes(ax, xlabel=_label(found, names[0]), ylabel=_label(found, names[1]))


def _label(found: "xarray.Dataset", name: str) -> str:
    """Return the label of an axis, with angles in degrees."""
    about = found[name].attrs
    unit = (
        about["units"].replace("rad", "deg") if about["units"].startswith("rad") else about["units"]
    )
    return f"{SHOWN.get(name, about['long_name'])} [{'-' if unit == '1' else unit}]"


def _read(found: "xarray.Dataset", name: str) -> np.ndarray:
    """Return the values as plotted on an axis, with angles in degrees."""
    values = found[name].to_numpy()
    return np.degrees(values) if found[name].attrs["units"].startswith("rad") else values
