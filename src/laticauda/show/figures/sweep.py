"""Results of a sweep in one figure: lines or maps, the best point that the robot can do, and its limit."""

# matplotlib's and xarray's own annotations are partial; this package passes on typed figures and
# axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import AbstractPathEffect, withStroke
from matplotlib.ticker import MaxNLocator

from laticauda.show.figures import style
from laticauda.trials.feasibility import CAN_DO

if TYPE_CHECKING:
    import xarray

SHOWN = {
    "forward_velocity": "forward velocity",
    "speed_through_water": "speed through the water",
    "cost_of_transport": "cost of transport",
}
"""Quantities of a sweep that are drawn, and their names on an axis; of the speeds only one, see `_speed_of`."""
SMALLEST_IS_BEST = ("cost_of_transport",)
"""Quantities whose smallest value is best."""
HEIGHT = 3.0
"""Height of a figure, without its title [in]."""
SATURATION = 3.0
"""A maximum of this many times the 90 % quantile would leave the other values dark."""
MOST_MARKS = 40
"""Largest number of points on a line that are marked."""
N_CONTOURS = 4
"""Lines of equal value on a map, about."""
LABEL_REACH = np.array([0.15, 0.08])
"""Distance from the best point to the middle of its text, as a fraction of the axes [-]."""
EDGE = 0.12
"""Space at the edge of a map without labels of lines, as a fraction of the axes [-]."""
LEAST_SPACE = 0.12
"""Smallest distance between two labels of lines, as a fraction of the axes [-]."""
N_AT_LIMIT = 3
"""Points near the limit of the robot that say what limits it."""
"""Largest share of what the robot offers that it can do, with a margin for rounding [-]."""
LIMIT_LOOK: Any = {"colors": style.ORANGE, "linewidths": 1.6, "linestyles": [(0, (4, 2))]}
"""Look of the line at the limit of the robot."""
BEST_LOOK: Any = style.marker_style(
    "*", 11.0, style.ORANGE, markeredgecolor="white", markeredgewidth=0.8, clip_on=False, zorder=6
)
"""Look of the best point."""
OUTLINE: list[AbstractPathEffect] = [withStroke(linewidth=2.2, foreground="white")]
"""White around a text on colors."""

Point = Mapping[str, float]
"""Values of all varied quantities at a point, by name (SI, radians)."""
NameLimits = Callable[[Sequence[Point]], str]
"""Function that returns in words which limits of the robot the trials at some points come up against."""


@dataclass(frozen=True)
class _Plane:
    """The part of a sweep that is drawn."""

    dataset: "xarray.Dataset"
    names: list[str]
    """The one or two quantities of its axes."""
    remark: str
    """Text about all other quantities; "" without any."""

    @property
    def share(self) -> np.ndarray:
        """Share of what the robot offers, of which it can do up to 1; 0 where it is unknown."""
        if "utilization" not in self.dataset:
            return np.zeros(np.shape(self._values("forward_velocity")))
        share: np.ndarray = self._values("utilization")
        return np.where(np.isfinite(share), share, 0.0)

    def find_best(self, quantity: str) -> int | None:
        """Return the flat index of the best point that the robot can do; None if there is none."""
        values = self._values(quantity)
        is_possible = np.isfinite(values) & (self.share <= CAN_DO)
        if not is_possible.any():
            return None
        if quantity in SMALLEST_IS_BEST:
            return int(np.argmin(np.where(is_possible & (values > 0.0), values, np.inf)))
        return int(np.argmax(np.where(is_possible, values, -np.inf)))

    def find_limit(self) -> list[int]:
        """Return the flat indices of the first points beyond the limit of the robot; empty if there are none."""
        share = self.share.ravel()
        beyond = np.flatnonzero(share > CAN_DO)
        return beyond[np.argsort(share[beyond])][:N_AT_LIMIT].tolist()

    def point(self, index: int) -> Point:
        """Return all varied quantities at a flat index."""
        dims = self.dataset.forward_velocity.dims
        point: dict[str, float] = {}
        for name in self.dataset.coords:
            if name == "trial":
                continue
            column = self.dataset[name].broadcast_like(self.dataset.forward_velocity)
            point[str(name)] = float(column.transpose(*dims).to_numpy().ravel()[index])
        return point

    def value(self, quantity: str, index: int) -> float:
        """Return a quantity at a flat index."""
        return float(self._values(quantity).ravel()[index])

    def _values(self, quantity: str) -> Any:
        dims = self.dataset.forward_velocity.dims
        return self.dataset[quantity].transpose(*dims).to_numpy()


def sweep_sheet(sweep: "xarray.Dataset", name_limits: NameLimits | None = None) -> Figure:
    """Plot forward velocity and cost of transport over the varied quantities: lines for one, maps for two.

    Where the water moves, the speed is that through it.

    A star marks the best point that the robot can do, and a line where it comes to its limit. For a
    grid of more, the map lies in the plane of the first two through the fastest point, and the
    figure says so; for lists and samples, every point is a dot over the first two.

    Args:
        sweep: Sweep as read by `laticauda.studies.open_sweep`.
        name_limits: Function that names the limits at some points; None: they are not named.
    """
    plane = _plane_of(sweep)
    dataset = plane.dataset
    figure = style.new_figure(style.DOUBLE_COLUMN, HEIGHT)
    quantities = (_speed_of(dataset), "cost_of_transport")
    axes: Sequence[Axes] = figure.subplots(1, len(quantities))
    limit = _describe_limit(plane, name_limits)
    for quantity, ax in zip(quantities, axes, strict=True):
        if len(plane.names) == 1:
            _plot_line(plane, quantity, limit, ax)
        else:
            _plot_map(plane, quantity, limit, ax)
        _mark_best(plane, quantity, ax)
    speeds = dataset.forward_velocity.to_numpy()
    n_lost = int(np.count_nonzero(~np.isfinite(speeds)))
    remarks = [plane.remark] if plane.remark else []
    if n_lost:
        remarks.append(f"{n_lost} of {speeds.size} without a value")
    remarks += _describe_best(plane, limit, name_limits)
    gait = dataset.attrs["gait"].replace("_", " ")
    title = f"Sweep of {dataset.attrs['robot']}, {gait}, {dataset.attrs['duration']:g} s"
    style.add_title(figure, title, "; ".join(remarks))
    return figure


def _speed_of(sweep: "xarray.Dataset") -> str:
    """Return the speed that is drawn: through the water if it moves, else, and of older sweeps, over ground."""
    if "speed_through_water" not in sweep:
        return "forward_velocity"
    through_water = sweep.speed_through_water.to_numpy()
    is_known = np.isfinite(through_water)
    if np.any(through_water[is_known] != sweep.forward_velocity.to_numpy()[is_known]):
        return "speed_through_water"
    return "forward_velocity"


# ---- best point and limit ------------------------------------------------------------------------


def _describe_limit(plane: _Plane, name_limits: NameLimits | None) -> str:
    """Return what limits the robot where it comes to its limit; "" if no trial goes beyond it."""
    at_limit = plane.find_limit()
    if not at_limit:
        return ""
    limit = ""
    if name_limits is not None:
        limit = name_limits([plane.point(index) for index in at_limit])
    return limit or "the robot"


def _describe_best(plane: _Plane, limit: str, name_limits: NameLimits | None) -> list[str]:
    """Return a remark on the fastest point that the robot can do."""
    fastest = plane.find_best(_speed_of(plane.dataset))
    if fastest is None:
        return [f"all points are beyond the limit of {limit}"]
    if name_limits is None:
        return []
    # Between two points of a grid it may be faster, up to the limit.
    reason = name_limits([plane.point(fastest)]) or limit
    if not reason:
        return ["no trial comes to a limit of the robot"]
    return [f"stars: the best that the robot can do; the fastest is limited by: {reason}"]


def _mark_best(plane: _Plane, quantity: str, ax: Axes) -> None:
    """Mark the best point that the robot can do, with its value on the side of the middle of the axes."""
    index = plane.find_best(quantity)
    if index is None:
        return
    value = plane.value(quantity, index)
    x, y = _position_of_best(plane, index, value)
    ax.plot([x], [y], **BEST_LOOK)
    x_shift = 7
    alignment = "left"
    if x > float(np.mean(ax.get_xlim())):
        x_shift = -7
        alignment = "right"
    y_shift = 9
    if y > float(np.mean(ax.get_ylim())):
        y_shift = -9
    if len(plane.names) == 1:  # the line is on that side
        y_shift = -y_shift
    style.add_note(
        ax,
        _format_value(plane.dataset, quantity, value),
        (x, y),
        (x_shift, y_shift),
        ha=alignment,
        va="center",
        color=style.INK,
        weight="bold",
        path_effects=OUTLINE,
        zorder=7,
    )


def _position_of_best(plane: _Plane, index: int, value: float) -> tuple[float, float]:
    """Return where the best point lies on the axes."""
    point = plane.point(index)
    position = [_in_degrees(plane.dataset, name, point[name]) for name in plane.names]
    if len(position) == 1:
        position.append(value)
    return position[0], position[1]


def _format_value(sweep: "xarray.Dataset", quantity: str, value: float) -> str:
    unit = sweep[quantity].attrs["units"]
    if unit == "1":
        return f"{value:.3g}"
    return f"{value:.3g} {unit}"


# ---- the plane -----------------------------------------------------------------------------------


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
    speed = np.nan_to_num(sweep[_speed_of(sweep)].to_numpy(), nan=-np.inf)
    fastest = np.unravel_index(int(np.argmax(speed)), speed.shape)
    indices = {dim: int(i) for dim, i in zip(sweep.dims, fastest, strict=True) if dim not in shown}
    plane = sweep.isel(indices)
    listed = ", ".join(f"{_label(plane, name)} {_read(plane, name):.4g}" for name in hidden)
    return _Plane(plane, shown, f"through the fastest point, {listed}")


# ---- lines and maps ------------------------------------------------------------------------------


def _plot_line(plane: _Plane, quantity: str, limit: str, ax: Axes) -> None:
    """Draw a line, with its points marked if they can be distinguished; shaded is what the robot cannot do."""
    sweep = plane.dataset
    (name,) = plane.names
    x = _read(sweep, name)
    y = sweep[quantity].to_numpy()
    order = np.argsort(x)
    marker = "o" if x.size <= MOST_MARKS else ""
    ax.plot(x[order], y[order], color=style.BLUE, linewidth=style.LINE, marker=marker, markersize=3)
    style.style_axes(ax, xlabel=_label(sweep, name), ylabel=_label(sweep, quantity))
    is_beyond = plane.share[order] > CAN_DO
    if is_beyond.any():
        ax.fill_between(
            x[order],
            0.0,
            1.0,
            where=is_beyond,
            transform=ax.get_xaxis_transform(),
            color=style.ORANGE,
            alpha=0.15,
            linewidth=0,
            label=f"beyond the limit: {limit}",
        )
        ax.margins(y=0.25)
        style.add_legend(ax, loc="best")


def _plot_map(plane: _Plane, quantity: str, limit: str, ax: Axes) -> None:
    """Draw a filled map for a grid, colored dots for anything else; values far above the rest saturate."""
    sweep = plane.dataset
    x_name, y_name = plane.names
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
        _cross_out(plane, limit, x, y, ax)
    else:
        rows = variable.transpose(y_name, x_name).to_numpy()
        colored = ax.pcolormesh(x, y, rows, shading="nearest", **look)
        if min(rows.shape) > 1:
            ax.set(xlim=(x.min(), x.max()), ylim=(y.min(), y.max()))
            labels = _Labels.around_best(plane, quantity, ax)
            _draw_limit(plane, limit, (x, y), labels, ax)
            _draw_contours(sweep, quantity, (x, y, rows), labels, ax)
    figure: Any = ax.get_figure(root=True)
    bar = figure.colorbar(colored, ax=ax, extend="max" if is_cut else "neither")
    bar.set_label(_label(sweep, quantity), fontsize=style.LABEL, color=style.INK)
    bar.ax.tick_params(labelsize=style.TICK, labelcolor=style.INK)
    bar.outline.set_visible(False)
    style.style_axes(ax, xlabel=_label(sweep, x_name), ylabel=_label(sweep, y_name))


class _Labels:
    """Places labels of lines on a map, far from each other and from the best point."""

    def __init__(self, low: np.ndarray, high: np.ndarray) -> None:
        self._low = low
        self._size = high - low
        self._taken: list[np.ndarray] = []

    @classmethod
    def around_best(cls, plane: _Plane, quantity: str, ax: Axes) -> "_Labels":
        """Return labels for a map whose best point is marked."""
        low, high = np.transpose([ax.get_xlim(), ax.get_ylim()])
        labels = cls(low, high)
        index = plane.find_best(quantity)
        if index is not None:
            star = labels._scale(np.array(_position_of_best(plane, index, 0.0)))
            # The text at the star reaches towards the middle.
            to_the_middle = np.sign(0.5 - star)
            labels._taken += [star, star + LABEL_REACH * to_the_middle]
        return labels

    def add(self, lines: Any, **look: Any) -> list[Any]:
        """Add a label to each line of a contour plot where there is space; return the texts."""
        positions: list[tuple[float, float]] = []
        for segments in lines.allsegs:
            position = self._find_space([self._scale(segment) for segment in segments])
            if position is not None:
                self._taken.append(position)
                x, y = self._low + self._size * position
                positions.append((float(x), float(y)))
        if not positions:
            return []
        return list(lines.clabel(manual=positions, **look))

    def _scale(self, places: np.ndarray) -> np.ndarray:
        """Return places as fractions of the axes."""
        return (places - self._low) / self._size

    def _find_space(self, segments: Sequence[np.ndarray]) -> np.ndarray | None:
        """Return the place on a line that is farthest from what is taken, but not at the edge."""
        places = np.concatenate([np.empty((0, 2)), *segments])
        is_inside = np.all(np.abs(places - 0.5) < 0.5 - EDGE, axis=1)
        places = places[is_inside]
        if len(places) == 0:
            return None
        if not self._taken:
            return places[len(places) // 2]
        distances = [np.linalg.norm(places - label, axis=1) for label in self._taken]
        nearest = np.min(distances, axis=0)
        if nearest.max() < LEAST_SPACE:
            return None
        return places[int(np.argmax(nearest))]


def _draw_contours(
    sweep: "xarray.Dataset",
    quantity: str,
    grid: tuple[np.ndarray, np.ndarray, np.ndarray],
    labels: _Labels,
    ax: Axes,
) -> None:
    """Draw few lines of equal value, most of them where most values are, each with its value and unit."""
    x, y, rows = grid
    finite = rows[np.isfinite(rows)]
    if finite.size == 0:
        return
    ends = (float(finite.min()), float(np.quantile(finite, 0.9)))
    levels = [level for level in MaxNLocator(N_CONTOURS).tick_values(*ends) if level > ends[0]]
    levels = [level for level in levels if level < finite.max()]
    if not levels:
        return

    def label(level: float) -> str:
        return _format_value(sweep, quantity, level)

    masked = np.ma.masked_invalid(rows)
    lines: Any = ax.contour(x, y, masked, levels=levels, colors="white", linewidths=style.THIN)
    labels.add(lines, fmt=label, fontsize=style.TICK - 1.5)


def _draw_limit(
    plane: _Plane, limit: str, places: tuple[np.ndarray, np.ndarray], labels: _Labels, ax: Axes
) -> None:
    """Draw the line at the limit of the robot, with its name; beyond it the map is pale."""
    share = plane.share
    if not np.any(share > CAN_DO):
        return
    x, y = places
    if plane.dataset.forward_velocity.dims[0] == plane.names[0]:
        share = share.T
    ax.contourf(x, y, share, levels=[1.0, np.inf], colors="white", alpha=0.45)
    if np.all(share > CAN_DO):
        return

    def label(_: float) -> str:
        return f"limit: {limit}"

    line: Any = ax.contour(x, y, share, levels=[1.0], **LIMIT_LOOK)
    texts = labels.add(line, fmt=label, fontsize=style.TICK, colors=style.ORANGE)
    for text in texts:
        text.set_path_effects(OUTLINE)
        text.set_fontweight("bold")


def _cross_out(plane: _Plane, limit: str, x: np.ndarray, y: np.ndarray, ax: Axes) -> None:
    """Cross out the points that the robot cannot do."""
    is_beyond = plane.share > CAN_DO
    if is_beyond.any():
        cross = style.marker_style("x", 4.0, style.ORANGE)
        ax.plot(x[is_beyond], y[is_beyond], label=f"beyond the limit: {limit}", **cross)
        ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), handlelength=1.0, **style.LEGEND)


# ---- values --------------------------------------------------------------------------------------


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


def _in_degrees(sweep: "xarray.Dataset", name: str, value: float) -> float:
    """Return a value as plotted on an axis, with angles in degrees."""
    if _is_angle(sweep, name):
        return float(np.degrees(value))
    return value


def _is_angle(sweep: "xarray.Dataset", name: str) -> bool:
    """Return whether a quantity is an angle or a rate of one."""
    return sweep[name].attrs["units"].startswith("rad")
