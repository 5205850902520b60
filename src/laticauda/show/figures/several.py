"""Several runs in one figure: overlaid paths and speeds, and the results of a sweep."""

# matplotlib's and xarray's own annotations are partial; this package passes on typed figures and
# axes.
# pyright: reportUnknownMemberType=false

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from laticauda.show.figures import style
from laticauda.show.figures.swim import cycle_mean_speed, forward_speed
from laticauda.trials import Trial

if TYPE_CHECKING:
    import xarray

SHOWN = {"forward_velocity": "forward velocity", "cost_of_transport": "cost of transport"}
"""Quantities of a sweep that are drawn, and their names on an axis."""
HEIGHT = 3.0
"""Height of a figure, without its legend or title [in]."""
LEGEND_ROW = 0.2
"""Height of a row of a legend [in]."""
SATURATION = 3.0
"""A maximum of this many times the 90 % quantile would leave the other values dark."""
MOST_MARKS = 40
"""Largest number of points on a line that are marked."""


def plot_overlay(trials: Sequence[Trial], names: Sequence[str]) -> Figure:
    """Plot the paths of several trials on top of each other, and their speeds as means over a gait cycle.

    Args:
        trials: Any trials; for one without whole gait cycles, the forward speed itself is drawn.
        names: Name of each trial.
    """
    n_rows = math.ceil(len(trials) / 2)
    figure = style.new_figure(style.DOUBLE_COLUMN, HEIGHT + LEGEND_ROW * n_rows)
    path, velocity = figure.subplots(1, 2, width_ratios=(1.2, 1.0))
    for trial, name, (color, dashes) in zip(
        trials, names, itertools.cycle(_line_looks()), strict=False
    ):
        look: Any = {"color": color, "linestyle": dashes, "linewidth": style.LINE}
        path.plot(*trial.center_of_mass[:, :2].T, **look, label=name)
        path.plot(*trial.center_of_mass[-1, :2], **style.marker_style("o", 3.5, color))
        mean = cycle_mean_speed(trial)
        if mean is None:
            velocity.plot(trial.time, forward_speed(trial), **look)
        else:
            velocity.plot(mean.time, mean.speed, **look)
    path.set_aspect("equal", adjustable="datalim")
    style.outside_legend(figure, path.get_legend_handles_labels()[0], "outside lower left", ncols=2)
    style.style_axes(path, xlabel="x [m]", ylabel="y [m]")
    style.style_axes(velocity, xlabel="time [s]", ylabel="speed, mean over a cycle [m/s]")
    return figure


def _line_looks() -> list[tuple[str, Any]]:
    """Return all distinct combinations of line colors and dashes."""
    n_lines = len(style.LINES)
    looks: list[tuple[str, Any]] = []
    for shift in range(n_lines):
        for i, (color, _) in enumerate(style.LINES):
            _, dashes = style.LINES[(i + shift) % n_lines]
            looks.append((color, dashes))
    return looks


@dataclass(frozen=True)
class _Plane:
    """The part of a sweep that is drawn."""

    dataset: "xarray.Dataset"
    names: list[str]
    """The one or two quantities of its axes."""
    remark: str
    """Text about all other quantities; "" without any."""


def sweep_sheet(sweep: "xarray.Dataset") -> Figure:
    """Plot forward velocity and cost of transport over the varied quantities: lines for one, maps for two.

    For a grid of more, the map lies in the plane of the first two through the fastest point, and
    the figure says so; for lists and samples, every point is a dot over the first two.

    Args:
        sweep: Sweep as read by `laticauda.studies.open_sweep`.
    """
    plane = _plane_of(sweep)
    dataset = plane.dataset
    figure = style.new_figure(style.DOUBLE_COLUMN, HEIGHT)
    axes: Sequence[Axes] = figure.subplots(1, len(SHOWN))
    for quantity, ax in zip(SHOWN, axes, strict=True):
        if len(plane.names) == 1:
            _plot_line(dataset, plane.names[0], quantity, ax)
        else:
            _plot_map(dataset, plane.names, quantity, ax)
    speeds = dataset.forward_velocity.to_numpy()
    n_lost = int(np.count_nonzero(~np.isfinite(speeds)))
    remarks = [plane.remark] if plane.remark else []
    if n_lost:
        remarks.append(f"{n_lost} of {speeds.size} without a value")
    gait = dataset.attrs["gait"].replace("_", " ")
    title = f"Sweep of {dataset.attrs['robot']}, {gait}, {dataset.attrs['duration']:g} s"
    style.add_title(figure, title, "; ".join(remarks))
    return figure


def _plane_of(sweep: "xarray.Dataset") -> _Plane:
    """Return the part of a sweep to draw: of a grid of three and more, the plane through the fastest point."""
    names = [str(name) for name in sweep.coords if name != "trial"]
    varied = [name for name in names if np.unique(sweep[name].to_numpy()).size > 1] or names[:1]
    shown = varied[:2]
    hidden = varied[2:]
    if not hidden or sweep.forward_velocity.dims == ("trial",):
        remark = ""
        if hidden:
            remark = f"over all of {', '.join(_label(sweep, name) for name in hidden)}"
        dims = {str(dim) for dim in sweep.dims}
        fixed_dims = dims.intersection(names).difference(shown)
        return _Plane(sweep.squeeze(fixed_dims), shown, remark)
    speed = np.nan_to_num(sweep.forward_velocity.to_numpy(), nan=-np.inf)
    fastest = np.unravel_index(int(np.argmax(speed)), speed.shape)
    indices = {dim: int(i) for dim, i in zip(sweep.dims, fastest, strict=True) if dim not in shown}
    plane = sweep.isel(indices)
    listed = ", ".join(f"{_label(plane, name)} {_read(plane, name):.4g}" for name in hidden)
    return _Plane(plane, shown, f"through the fastest point, {listed}")


def _plot_line(sweep: "xarray.Dataset", name: str, quantity: str, ax: Axes) -> None:
    """Draw a line, with its points marked if they can be distinguished."""
    x = _read(sweep, name)
    y = sweep[quantity].to_numpy()
    order = np.argsort(x)
    marker = "o" if x.size <= MOST_MARKS else ""
    ax.plot(x[order], y[order], color=style.BLUE, linewidth=style.LINE, marker=marker, markersize=3)
    style.style_axes(ax, xlabel=_label(sweep, name), ylabel=_label(sweep, quantity))


def _plot_map(sweep: "xarray.Dataset", names: list[str], quantity: str, ax: Axes) -> None:
    """Draw a filled map for a grid, colored dots for anything else; values far above the rest saturate."""
    x_name, y_name = names
    x = _read(sweep, x_name)
    y = _read(sweep, y_name)
    variable = sweep[quantity]
    values = variable.to_numpy()
    finite = values[np.isfinite(values)]
    quantile = float(np.quantile(finite, 0.9)) if finite.size else 1.0
    is_cut = finite.size > 0 and float(finite.max()) > SATURATION * quantile > 0.0
    look: Any = {"cmap": "viridis", "vmax": quantile if is_cut else None}
    if variable.dims == ("trial",):
        colored: Any = ax.scatter(x, y, c=values, s=10, **look)
    else:
        rows = variable.transpose(y_name, x_name).to_numpy()
        colored = ax.pcolormesh(x, y, rows, shading="nearest", **look)
    figure: Any = ax.get_figure(root=True)
    bar = figure.colorbar(colored, ax=ax, extend="max" if is_cut else "neither")
    bar.set_label(_label(sweep, quantity), fontsize=style.LABEL, color=style.INK)
    bar.ax.tick_params(labelsize=style.TICK, labelcolor=style.INK)
    bar.outline.set_visible(False)
    style.style_axes(ax, xlabel=_label(sweep, x_name), ylabel=_label(sweep, y_name))


def _label(sweep: "xarray.Dataset", name: str) -> str:
    """Return the label of an axis, with angles in degrees."""
    attributes = sweep[name].attrs
    unit = attributes["units"]
    if _is_angle(sweep, name):
        unit = unit.replace("rad", "deg")
    if unit == "1":
        unit = "-"
    return f"{SHOWN.get(name, attributes['long_name'])} [{unit}]"


def _read(sweep: "xarray.Dataset", name: str) -> np.ndarray:
    """Return the values as plotted on an axis, with angles in degrees."""
    values = sweep[name].to_numpy()
    if _is_angle(sweep, name):
        return np.degrees(values)
    return values


def _is_angle(sweep: "xarray.Dataset", name: str) -> bool:
    """Return whether a quantity is an angle or a rate of one."""
    return sweep[name].attrs["units"].startswith("rad")
