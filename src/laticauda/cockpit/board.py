"""The map of the gaits on a board beside the robot: trials over amplitude and frequency, and a click sets the gait."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportAttributeAccessIssue=false
# pyright: reportUnknownArgumentType=false

import math
import threading
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

import laticauda as lc
from laticauda.cockpit.live import Live
from laticauda.cockpit.pages import Event, EventQueue, refusing
from laticauda.errors import LaticaudaError
from laticauda.figures import style
from laticauda.studies.sweep import QUANTITIES

AMPLITUDES = tuple(float(value) for value in range(5, 65, 5))  # [deg]
FREQUENCIES = tuple(float(value) for value in range(20, 220, 20))  # [deg/s]
OF_GAITS = ("forward_velocity", "mean_power", "cost_of_transport")
DURATION = 20.0  # of every trial [s]
SIZE = (3.4, 2.55)  # [in]
BOX = (0.17, 0.19, 0.65, 0.68)  # of the axes in the picture: left, bottom, width, height, as shares
Values = Float[np.ndarray, "n_frequencies n_amplitudes"]
WIDTH, HEIGHT = 1.8, 1.35  # [m]
BEHIND, ABOVE = 1.5, 0.5  # where its middle is to the robot: along y, and along z [m]
UPRIGHT = (math.sqrt(0.5), -math.sqrt(0.5), 0.0, 0.0)  # the picture's right is x, its top z; seen from -y
WAITING = (
    f"Computing {len(AMPLITUDES) * len(FREQUENCIES)} trials of this robot, water and joints; "
    "the first map on a computer also compiles, some 20 s ..."
)
OF_THE_GAITS = "Planar trials of 20 s from rest, in the plane; gray where a trial failed. Click the map to swim so."


class Board:
    """A board and the controls that belong to it.

    Args:
        gui: Of the page's server; the controls go where it is.
        scene: Of the same server.
        live: Whose gait the map sets.
        events: Where it is set.
        changed: Called after every change.
    """

    def __init__(self, gui: Any, scene: Any, live: Live, events: EventQueue, changed: Callable[[], None]) -> None:
        self._scene, self._live = scene, live
        self._clicked = events.handler(
            self._click, then=changed, read=lambda event: (event.ray_origin, event.ray_direction)
        )
        self._on = gui.add_checkbox("show the map", False, hint="On a board beside the robot; a click sets the gait")
        self._quantity = gui.add_dropdown("quantity", OF_GAITS)
        self._text = gui.add_markdown("")
        self._computed: tuple[lc.Scenario, dict[str, Values]] | None = None  # and of what; empty where that failed
        self._worker: threading.Thread | None = None
        self._picture: Picture | None = None
        self._drawn: object = None
        self._frame: Any = None
        self._dot: Any = None

    def show(self, at_robot: np.ndarray) -> None:
        """Bring it up to date: called with every picture, returns at once."""
        if not self._on.value:
            if self._frame is not None:
                self._frame.remove()
                self._frame = self._drawn = self._picture = None
                self._text.content = ""
            return
        values = self._values()
        if values is not None:
            self._draw(values)
        if self._frame is not None:
            x, y = (float(value) for value in at_robot[:2])
            self._frame.position = (x, y + BEHIND, ABOVE)
            gait = self._live.scenario.gait
            self._dot.position = self._place(math.degrees(gait.amplitude), math.degrees(gait.frequency))

    def _values(self) -> Values | None:
        """What is to be drawn; None as long as there is none."""
        base = base_of(self._live.scenario)
        is_busy = self._worker is not None and self._worker.is_alive()
        if not is_busy and (self._computed is None or self._computed[0] != base):
            self._text.content = WAITING
            self._worker = threading.Thread(target=self._compute, args=(base,), name="map", daemon=True)
            self._worker.start()
        return None if self._computed is None else self._computed[1].get(self._quantity.value)

    def _compute(self, base: lc.Scenario) -> None:
        try:
            self._computed, self._text.content = (base, map_of_gaits(base)), OF_THE_GAITS
        except (ValueError, LaticaudaError) as error:
            self._computed, self._text.content = (base, {}), str(error)

    def _draw(self, values: Values) -> None:
        if self._drawn is values:
            return
        self._drawn, self._picture = values, gait_map_picture(values, self._quantity.value)
        self._frame = self._scene.add_frame("/board", show_axes=False, wxyz=UPRIGHT)
        image = self._scene.add_image("/board/map", self._picture.pixels, WIDTH, HEIGHT, format="png")
        self._dot = self._scene.add_icosphere("/board/dot", radius=0.022, color=(230, 60, 30))
        image.on_click(self._clicked)

    def _place(self, amplitude: float, frequency: float) -> tuple[float, float, float]:
        """Where a gait [deg, deg/s] is on the picture, in its frame: x to the right, y down [m]."""
        assert self._picture is not None
        (left, bottom, wide, high), limits = BOX, self._picture.limits
        right = np.interp(amplitude, limits[0], (left, left + wide)) - 0.5
        above = np.interp(frequency, limits[1], (bottom, bottom + high)) - 0.5
        return float(right) * WIDTH, float(-above) * HEIGHT, 0.0

    def pointed_at(self, origin: np.ndarray, direction: np.ndarray) -> tuple[float, float] | None:
        """Amplitude [deg] and frequency [deg/s] of the trial that a ray meets on the board, or None.

        Args:
            origin: Of the ray, world axes [m].
            direction: Its direction [-].
        """
        if self._picture is None or self._frame is None or abs(direction[1]) < 1e-9:
            return None
        middle = np.asarray(self._frame.position, dtype=float)
        hit = origin + direction * (middle[1] - origin[1]) / direction[1]
        right, above = float((hit[0] - middle[0]) / WIDTH + 0.5), float((hit[2] - middle[2]) / HEIGHT + 0.5)
        (left, bottom, wide, high), limits = BOX, self._picture.limits
        if not (left <= right <= left + wide and bottom <= above <= bottom + high):
            return None
        across = np.interp(right, (left, left + wide), limits[0])
        up = np.interp(above, (bottom, bottom + high), limits[1])
        return _nearest(AMPLITUDES, across), _nearest(FREQUENCIES, up)

    @refusing
    def _click(self, event: Event) -> None:
        found = self.pointed_at(*(np.array(part) for part in event.value))
        if found is not None:
            self._live.alter(gait=with_wave(self._live.scenario.gait, *found))


def _nearest(values: Sequence[float], to: float) -> float:
    return min(values, key=lambda one: abs(one - to))


# ---- the map -------------------------------------------------------------------------------------------------------


class Picture(NamedTuple):
    """A picture of the map, for a screen, and what its axes, in `BOX`, go from and to."""

    pixels: Any
    limits: tuple[tuple[float, float], tuple[float, float]]


def base_of(scenario: lc.Scenario) -> lc.Scenario:
    """What the map depends on: scenarios with equal ones share it. It is in the plane, without steering.

    Args:
        scenario: What swims how.
    """
    gait = replace(scenario.gait, amplitude=0.0, frequency=0.0)
    return replace(scenario, motion=gait, model=lc.Planar(joints=scenario.model.joints))


def map_of_gaits(scenario: lc.Scenario) -> dict[str, Values]:
    """Trials of `DURATION` from rest side by side: each of `OF_GAITS`, over frequency and amplitude.

    Args:
        scenario: What swims how.

    Raises:
        ValueError: If the batch cannot compute such trials.
    """
    base = replace(base_of(scenario), duration=DURATION, sample_interval=0.05)
    gaits = [with_wave(base.gait, amplitude, frequency) for frequency in FREQUENCIES for amplitude in AMPLITUDES]
    swims = lc.swim_many([replace(base, motion=gait) for gait in gaits])
    return {name: np.asarray(getattr(swims, name)).reshape(len(FREQUENCIES), len(AMPLITUDES)) for name in OF_GAITS}


def with_wave(gait: lc.Gait, amplitude_deg: float, frequency_deg_s: float) -> lc.Gait:
    """The gait with another amplitude [deg] and frequency [deg/s]."""
    return replace(gait, amplitude=math.radians(amplitude_deg), frequency=math.radians(frequency_deg_s))


def gait_map_picture(values: Values, quantity: str) -> Picture:
    """A quantity as colors over amplitude and frequency; gray where a trial failed.

    Args:
        values: Of every trial.
        quantity: One of `OF_GAITS`.
    """
    figure = style.new_figure(*SIZE)
    figure.set_layout_engine("none")
    figure.set_dpi(220)
    ax = figure.add_axes(BOX)
    ax.set_facecolor("#c8c8c8")
    mesh = ax.pcolormesh(AMPLITUDES, FREQUENCIES, np.ma.masked_invalid(values), shading="nearest")
    style.dress(ax, xlabel="amplitude [deg]", ylabel="frequency [deg/s]")
    unit = QUANTITIES[quantity][0]
    title = f"{quantity.replace('_', ' ').capitalize()} [{'-' if unit == '1' else unit}]"
    ax.set_title(title, fontsize=style.LABEL, color=style.INK)
    bar: Any = figure.colorbar(mesh, cax=ax.inset_axes((1.04, 0.0, 0.05, 1.0)))
    bar.ax.tick_params(labelsize=style.TICK, labelcolor=style.INK)
    bar.outline.set_visible(False)
    canvas: Any = figure.canvas
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3].copy()
    return Picture(pixels=pixels, limits=(ax.get_xlim(), ax.get_ylim()))
