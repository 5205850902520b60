"""Figures of a filmed swim: forces along the body over a cycle, each link's mean, power, and the force left over."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from laticauda.film.forces.estimates import Estimate
from laticauda.film.forces.inverse import FilmForces
from laticauda.film.forces.window import SAMPLES_PER_CYCLE
from laticauda.show.figures import style

SHEET_HEIGHT = 4.6
"""Height of the figure [in]."""
BAND = (2.5, 50.0, 97.5)
"""Percentiles of a band and its middle."""


def draw_forces(forces: FilmForces) -> Figure:
    """Draw what a filmed swim does to the water, as wide as two journal columns.

    Args:
        forces: The figures of the swim.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, SHEET_HEIGHT)
    panels = figure.subplots(2, 2)
    _draw_forces_along(forces, panels[0, 0])
    _draw_links(forces, panels[0, 1])
    _draw_band(forces, panels[1, 0], forces.loads.power, label="power of the joints [W]")
    _draw_left_over(forces, panels[1, 1])
    speed = forces.figures["speed"]
    power = forces.figures["mechanical_power"]
    note = (
        f"{speed.median:.3g} m/s ({speed.low:.3g} to {speed.high:.3g}), {power.median:.3g} W "
        f"({power.low:.3g} to {power.high:.3g}); bands and bars are 95 % intervals"
    )
    style.add_title(figure, f"From film to forces: {forces.fit.robot.name}", note)
    return figure


def _draw_forces_along(forces: FilmForces, ax: Axes) -> None:
    """Draw the force along the direction of travel on every link over a cycle."""
    force = _mean_cycles(forces, forces.force_along)
    median = np.median(force, axis=0)
    highest = float(np.max(np.abs(median)))
    end = _last_time(forces)
    n_links = forces.fit.robot.n_links
    image = ax.imshow(
        median.T,
        aspect="auto",
        origin="lower",
        cmap="RdBu",
        vmin=-highest,
        vmax=highest,
        extent=(0.0, end, 0.5, n_links + 0.5),
    )
    style.style_axes(ax, xlabel=_time_label(forces), ylabel="link, from the tail")
    ticks = [-highest, 0.0, highest]
    # Beside the panel, it would take its width from the panel below, too.
    bar = ax.figure.colorbar(image, ax=ax, location="top", aspect=40, ticks=ticks, format="%.2g")
    bar.set_label("force along the way [N]", fontsize=style.LABEL, color=style.INK)
    bar.ax.tick_params(labelsize=style.TICK)


def _draw_links(forces: FilmForces, ax: Axes) -> None:
    """Draw every link's mean force with its interval."""
    for i, figure in enumerate(forces.link_figures):
        _draw_link(figure, i + 1, ax)
    ax.axhline(0.0, color=style.GRAY, linewidth=style.THIN)
    style.style_axes(ax, xlabel="link, from the tail", ylabel="mean force [N]")


def _draw_link(figure: Estimate, number: int, ax: Axes) -> None:
    """Draw a bar with its interval, in the color of a link that pushes or of one that brakes."""
    color = style.ORANGE
    if figure.median > 0.0:
        color = style.BLUE
    ax.bar(number, figure.median, color=color, width=0.7)
    # An interval without width may end on the wrong side of its median by rounding.
    below = max(figure.median - figure.low, 0.0)
    above = max(figure.high - figure.median, 0.0)
    ax.errorbar(
        number,
        figure.median,
        yerr=[[below], [above]],
        fmt="none",
        color=style.INK,
        linewidth=style.LINE,
    )


def _draw_left_over(forces: FilmForces, ax: Axes) -> None:
    """Draw the force left over beside the force of the water on the whole body."""
    force_on_body = np.sum(forces.force_along, axis=2)
    median = np.median(_mean_cycles(forces, force_on_body), axis=0)
    time = np.linspace(0.0, _last_time(forces), median.size)
    ax.plot(time, median, color=style.BLUE, linewidth=style.LINE, label="of the water")
    label = "force along the way [N]"
    _draw_band(forces, ax, forces.left_over_along, label=label, name="left over")
    ax.axhline(0.0, color=style.GRAY, linewidth=style.THIN)
    ax.margins(y=0.2)
    ax.legend(loc="upper center", ncol=2, **style.LEGEND)


def _draw_band(
    forces: FilmForces,
    ax: Axes,
    series: Float[np.ndarray, "n_draws n_times"],
    *,
    label: str,
    name: str = "",
) -> None:
    low, middle, high = np.percentile(_mean_cycles(forces, series), BAND, axis=0)
    time = np.linspace(0.0, _last_time(forces), middle.size)
    ax.fill_between(time, low, high, color=style.ORANGE, alpha=0.25, linewidth=0.0)
    ax.plot(time, middle, color=style.ORANGE, linewidth=style.LINE, label=name)
    style.style_axes(ax, xlabel=_time_label(forces), ylabel=label)


def _mean_cycles(
    forces: FilmForces, series: Float[np.ndarray, "n_draws n_times ..."]
) -> Float[np.ndarray, "n_draws n_moments ..."]:
    """Return the mean cycle of every draw, its first moment again at the end; without cycles, the whole span."""
    n_cycles = forces.window.n_cycles
    if n_cycles == 0:
        return series
    n_draws, _, *last_axes = series.shape
    # The last moment is the first one of the next cycle.
    cycles = series[:, :-1].reshape(n_draws, n_cycles, SAMPLES_PER_CYCLE, *last_axes)
    cycle = cycles.mean(axis=1)
    return np.concatenate((cycle, cycle[:, :1]), axis=1)


def _last_time(forces: FilmForces) -> float:
    """Return the end of the axis of time: one cycle, or the whole span [s]."""
    return forces.window.duration / max(forces.window.n_cycles, 1)


def _time_label(forces: FilmForces) -> str:
    if forces.window.n_cycles == 0:
        return "time [s]"
    return f"time in the mean of {forces.window.n_cycles} cycles [s]"
