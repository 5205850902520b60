"""Gait map: trials over amplitude and frequency as a chart in the panel, with the current gait marked."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportAttributeAccessIssue=false
# pyright: reportUnknownArgumentType=false

import math
import threading
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

import laticauda as lc
from laticauda.show.cockpit.live import Live
from laticauda.show.cockpit.pages import Event, EventQueue, refusing
from laticauda.show.figures import style
from laticauda.studies.point_trials import COSTS, LABELS
from laticauda.values.errors import LaticaudaError

AMPLITUDES = tuple(float(value) for value in range(5, 65, 5))  # [deg]
FREQUENCIES = tuple(float(value) for value in range(20, 220, 20))  # [deg/s]
OF_GAITS = {
    name.replace("_", " "): name for name in ("forward_velocity", "mean_power", "cost_of_transport")
}
"""Mapped quantities, frequencies by amplitudes, by their names on the page."""
DURATION = 20.0  # of every trial [s]
WAITING = f"Computing {len(AMPLITUDES) * len(FREQUENCIES)} trials; the first map also compiles, some 20 s ..."
OF_THE_GAITS = "Planar trials of 20 s from rest, in the plane; gray where a trial failed. Red: the current gait."


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
        self._on = gui.add_checkbox(
            "show the map", False, hint="Over amplitude and frequency; takes some seconds"
        )
        self._quantity = gui.add_dropdown("quantity", tuple(OF_GAITS))
        self._image = gui.add_image(
            np.zeros((1, 1, 3), dtype=np.uint8), format="png", visible=False
        )
        self._best = gui.add_button("swim the best of the map", visible=False)
        self._best.on_click(events.handler(self._swim_best, then=changed))
        self._text = gui.add_markdown("")
        self._computed: tuple[lc.Scenario, dict[str, np.ndarray]] | None = (
            None  # of which base; empty if it failed
        )
        self._worker: threading.Thread | None = None
        self._drawn: object = None

    def show(self) -> None:
        """Update the chart; called from time to time, returns at once."""
        values = self._values() if self._on.value else None
        self._image.visible = self._best.visible = values is not None
        self._text.visible = self._on.value
        gait, quantity = self._live.scenario.gait, OF_GAITS[self._quantity.value]
        wanted = id(values), quantity, gait.amplitude, gait.frequency
        if values is not None and self._drawn != wanted:
            self._drawn, self._image.image = wanted, gait_map_picture(values, quantity, gait)

    def _values(self) -> np.ndarray | None:
        """Return the values to draw; None until they are available."""
        base = base_of(self._live.scenario)
        is_busy = self._worker is not None and self._worker.is_alive()
        if not is_busy and (self._computed is None or self._computed[0] != base):
            self._text.content = WAITING
            self._worker = threading.Thread(
                target=self._compute, args=(base,), name="map", daemon=True
            )
            self._worker.start()
        return (
            None
            if self._computed is None
            else self._computed[1].get(OF_GAITS[self._quantity.value])
        )

    def _compute(self, base: lc.Scenario) -> None:
        try:
            self._computed, self._text.content = (base, map_of_gaits(base)), OF_THE_GAITS
        except (ValueError, LaticaudaError) as error:
            self._computed, self._text.content = (base, {}), str(error)

    @refusing
    def _swim_best(self, _: Event) -> None:
        values, quantity = self._values(), OF_GAITS[self._quantity.value]
        if values is None or np.isnan(values).all():
            return
        i, j = np.unravel_index(
            (np.nanargmin if quantity in COSTS else np.nanargmax)(values), values.shape
        )
        self._live.alter(gait=with_wave(self._live.scenario.gait, AMPLITUDES[j], FREQUENCIES[i]))


# ---- content of the map --------------------------------------------------------------------------


def base_of(scenario: lc.Scenario) -> lc.Scenario:
    """Return what the map depends on, in the plane and without steering; scenarios with the same base share a map.

    Args:
        scenario: The scenario.
    """
    gait = replace(scenario.gait, amplitude=0.0, frequency=0.0)
    return replace(scenario, motion=gait, model=lc.Planar(joints=scenario.model.joints))


def map_of_gaits(scenario: lc.Scenario) -> dict[str, np.ndarray]:
    """Compute trials of `DURATION` from rest in one batch: each quantity of `OF_GAITS`, over frequency and amplitude.

    Args:
        scenario: The scenario.

    Raises:
        ValueError: If the batch cannot compute such trials.
    """
    base = replace(base_of(scenario), duration=DURATION, sample_interval=0.05)
    gaits = [
        with_wave(base.gait, amplitude, frequency)
        for frequency in FREQUENCIES
        for amplitude in AMPLITUDES
    ]
    swims = lc.swim_many([replace(base, motion=gait) for gait in gaits])
    shape = len(FREQUENCIES), len(AMPLITUDES)
    return {name: np.asarray(getattr(swims, name)).reshape(shape) for name in OF_GAITS.values()}


def with_wave(gait: lc.Gait, amplitude_deg: float, frequency_deg_s: float) -> lc.Gait:
    """Return the gait with another amplitude [deg] and frequency [deg/s]."""
    return replace(
        gait, amplitude=math.radians(amplitude_deg), frequency=math.radians(frequency_deg_s)
    )


def gait_map_picture(values: np.ndarray, quantity: str, gait: lc.Gait) -> np.ndarray:
    """Draw a quantity as colors over amplitude and frequency, and a gait as a dot; gray where a trial failed.

    Args:
        values: Value of every trial.
        quantity: One of `OF_GAITS`.
        gait: The gait to mark.
    """
    figure = style.new_figure(3.4, 2.9)
    figure.set_dpi(220)
    ax = figure.add_subplot()
    ax.set_facecolor("#c8c8c8")
    mesh = ax.pcolormesh(AMPLITUDES, FREQUENCIES, np.ma.masked_invalid(values), shading="nearest")
    style.style_axes(ax, xlabel="amplitude [deg]", ylabel="frequency [deg/s]")
    ax.autoscale_view()
    ax.autoscale(False)
    ax.plot(
        math.degrees(gait.amplitude),
        math.degrees(gait.frequency),
        **style.marker_style("o", 7.0, "#E63C1E"),
    )
    style.add_title(figure, LABELS[quantity])
    bar: Any = figure.colorbar(mesh, ax=ax)
    bar.ax.tick_params(labelsize=style.TICK, labelcolor=style.INK)
    bar.outline.set_visible(False)
    canvas: Any = figure.canvas
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()
