"""Gait map: trials over amplitude and frequency as a chart in the panel, with the current gait marked."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportAttributeAccessIssue=false
# pyright: reportUnknownArgumentType=false

import math
import threading
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

import laticauda as lc
from laticauda.show.cockpit.events import Event, EventQueue, refusing
from laticauda.show.cockpit.gait_trials import (
    AMPLITUDES,
    CAN_DO,
    FREQUENCIES,
    QUANTITIES,
    SHARE,
    change_wave,
    find_best_trial,
    map_gaits,
    name_limit,
    strip_scenario,
)
from laticauda.show.cockpit.live import Live
from laticauda.show.figures import style
from laticauda.studies import LABELS
from laticauda.values import LaticaudaError

QUANTITY_OF_LABEL = {name.replace("_", " "): name for name in QUANTITIES}
"""Mapped quantities, by their names on the page."""
HINT = "Over amplitude and frequency; takes some seconds"
N_TRIALS = len(AMPLITUDES) * len(FREQUENCIES)
WAITING = f"Computing {N_TRIALS} trials; the first map also compiles, some 20 s ..."
EXPLANATION = (
    "Planar trials of 20 s from rest, in the plane; gray where a trial failed. "
    "Red: the current gait; star: the best that the robot can do. Pale: more than it can do."
)


class ComputedMap(NamedTuple):
    """The result of computing a map."""

    base: lc.Scenario
    """What the map depends on, see `strip_scenario`."""
    values: dict[str, np.ndarray]
    """Values of all trials by quantity; empty if they cannot be computed."""
    limit: str = ""
    """What limits the speed of the robot; "" if nothing does."""


class DrawnMap(NamedTuple):
    """What the chart shows."""

    values_id: int
    """Identity of the values."""
    quantity: str
    amplitude: float
    """Amplitude of the marked gait [rad]."""
    frequency: float
    """Frequency of the marked gait [rad/s]."""


class GaitMap:
    """The chart and its controls.

    Args:
        gui: GUI of the page's server; the controls are added at its current position.
        live: The simulation whose gait is shown.
        events: Queue in which the best gait is set.
        changed: Called after that.
    """

    def __init__(
        self, gui: Any, live: Live, events: EventQueue, changed: Callable[[], None]
    ) -> None:
        self._live = live
        self._on = gui.add_checkbox("show the map", False, hint=HINT)
        self._quantity = gui.add_dropdown("quantity", tuple(QUANTITY_OF_LABEL))
        no_image = np.zeros((1, 1, 3), dtype=np.uint8)
        self._image = gui.add_image(no_image, format="png", visible=False)
        self._best = gui.add_button("swim the best of the map", visible=False)
        self._best.on_click(events.handler(self._swim_best, then=changed))
        self._text = gui.add_markdown("")
        self._computed: ComputedMap | None = None
        self._worker: threading.Thread | None = None
        self._drawn: DrawnMap | None = None

    def show(self) -> None:
        """Update the chart; called from time to time, returns at once."""
        values = self._values() if self._on.value else None
        has_values = values is not None
        self._image.visible = has_values
        self._best.visible = has_values
        self._text.visible = self._on.value
        if values is None:
            return
        gait = self._live.scenario.gait
        quantity = self._chosen_quantity
        drawn = DrawnMap(id(values), quantity, gait.amplitude, gait.frequency)
        if drawn != self._drawn:
            self._drawn = drawn
            self._image.image = draw_gait_map(values, quantity, gait, *self._shares_and_limit())

    @property
    def _chosen_quantity(self) -> str:
        return QUANTITY_OF_LABEL[self._quantity.value]

    def _values(self) -> np.ndarray | None:
        """Return the values to draw, the latest ones while others are computed; None until there are any."""
        base = strip_scenario(self._live.scenario)
        is_busy = self._worker is not None and self._worker.is_alive()
        is_current = self._computed is not None and self._computed.base == base
        if not is_busy and not is_current:
            self._text.content = WAITING
            self._worker = threading.Thread(
                target=self._compute, args=(base,), name="map", daemon=True
            )
            self._worker.start()
        computed = self._computed
        if computed is None:
            return None
        return computed.values.get(self._chosen_quantity)

    def _shares_and_limit(self) -> tuple[np.ndarray | None, str]:
        """Return the share of what the robot offers of every trial, and what limits it."""
        computed = self._computed
        if computed is None:
            return None, ""
        return computed.values.get(SHARE), computed.limit

    def _compute(self, base: lc.Scenario) -> None:
        try:
            values = map_gaits(base)
            self._computed = ComputedMap(base, values, name_limit(base, values))
            self._text.content = EXPLANATION
        except (ValueError, LaticaudaError) as error:
            self._computed = ComputedMap(base, {})
            self._text.content = str(error)

    @refusing
    def _swim_best(self, _: Event) -> None:
        """Swim the best gait that the robot can do; if it can do none, the best of all."""
        values = self._values()
        if values is None:
            return
        shares, _limit = self._shares_and_limit()
        if shares is None:
            return
        best = find_best_trial(values, shares, self._chosen_quantity)
        if best is None:
            return
        gait = change_wave(self._live.scenario.gait, best.amplitude, best.frequency)
        self._live.alter(gait=gait)


# ---- the chart -----------------------------------------------------------------------------------

WIDTH = 3.4
"""[inch]."""
HEIGHT = 2.9
"""[inch]."""
DOTS_PER_INCH = 220
FAILED_COLOR = "#c8c8c8"
GAIT_COLOR = "#E63C1E"


def draw_gait_map(
    values: np.ndarray,
    quantity: str,
    gait: lc.Gait,
    shares: np.ndarray | None = None,
    limit: str = "",
) -> np.ndarray:
    """Draw a quantity as colors over amplitude and frequency, and a gait as a dot; gray where a trial failed.

    Args:
        values: Value of every trial.
        quantity: One of `QUANTITIES`.
        gait: The gait to mark.
        shares: Share of what the robot offers in every trial; None: unknown, so no limit is drawn.
        limit: What limits the speed of the robot; "" if nothing does.
    """
    figure = style.new_figure(WIDTH, HEIGHT)
    figure.set_dpi(DOTS_PER_INCH)
    axes = figure.add_subplot()
    axes.set_facecolor(FAILED_COLOR)
    colors = axes.pcolormesh(
        AMPLITUDES, FREQUENCIES, np.ma.masked_invalid(values), shading="nearest"
    )
    if shares is not None:
        _draw_limit(axes, shares)
        _mark_best(axes, values, shares, quantity)
    style.style_axes(axes, xlabel="amplitude [deg]", ylabel="frequency [deg/s]")
    axes.set_xlim(AMPLITUDES[0], AMPLITUDES[-1])
    axes.set_ylim(FREQUENCIES[0], FREQUENCIES[-1])
    amplitude = math.degrees(gait.amplitude)
    frequency = math.degrees(gait.frequency)
    axes.plot(amplitude, frequency, **style.marker_style("o", 7.0, GAIT_COLOR))
    note = ""
    if limit:
        note = f"limited by: {limit}"
    style.add_title(figure, LABELS[quantity], note)
    bar: Any = figure.colorbar(colors, ax=axes)
    bar.ax.tick_params(labelsize=style.TICK, labelcolor=style.INK)
    bar.outline.set_visible(False)
    canvas: Any = figure.canvas
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _draw_limit(axes: Any, shares: np.ndarray) -> None:
    """Draw the line at the limit of the robot; beyond it the map is pale."""
    finite_shares = np.nan_to_num(shares, nan=0.0)
    if not np.any(finite_shares > CAN_DO):
        return
    places = (AMPLITUDES, FREQUENCIES, finite_shares)
    axes.contourf(*places, levels=[1.0, np.inf], colors="white", alpha=0.45)
    if finite_shares.min() < 1.0:
        axes.contour(*places, levels=[1.0], colors=style.ORANGE, linewidths=1.8)


def _mark_best(axes: Any, values: np.ndarray, shares: np.ndarray, quantity: str) -> None:
    best = find_best_trial(values, shares, quantity)
    if best is not None:
        star = style.marker_style("*", 11.0, "white", markeredgecolor=style.INK)
        axes.plot(best.amplitude, best.frequency, **star)
