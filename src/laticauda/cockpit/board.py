"""The map of gaits on a board beside the robot: computed in the background, and clicked to set the gait."""

import math
import threading
from collections.abc import Callable
from typing import Any

import numpy as np

from laticauda.cockpit.controls import refuse
from laticauda.cockpit.gait_map import AMPLITUDES, FREQUENCIES, QUANTITIES, GaitMap, at, base, gait_map, nearest, title
from laticauda.cockpit.live import Live
from laticauda.errors import LaticaudaError
from laticauda.figures.gait_map import Picture, gait_map_picture

WIDTH, HEIGHT = 1.8, 1.35  # [m]
BEHIND, ABOVE = 1.5, 0.5  # where its middle is to the robot: along y, and along z [m]
UPRIGHT = (math.sqrt(0.5), -math.sqrt(0.5), 0.0, 0.0)  # the picture's right is x, its top z; seen from -y
WAITING = (
    "Computing {} trials of this robot, water and joints; the first map on a computer also compiles, some 20 s ..."
)


class Board:
    """A board and the controls that belong to it.

    Args:
        gui: Of the page's server; the controls go where it is.
        scene: Of the same server.
        live: Whose gait the map sets.
        changed: Called after every change.
    """

    def __init__(self, gui: Any, scene: Any, live: Live, changed: Callable[[], None]) -> None:
        self._scene, self._live, self._changed = scene, live, changed
        self._on = gui.add_checkbox("show the map", False, hint="On a board beside the robot; a click sets the gait")
        self._quantity = gui.add_dropdown("quantity", tuple(QUANTITIES))
        self._text = gui.add_markdown("")
        self._map: GaitMap | None = None
        self._failed: object = None
        self._picture: Picture | None = None
        self._drawn: tuple[GaitMap, str] | None = None
        self._worker: threading.Thread | None = None
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
        wanted = base(self._live.setting)
        is_busy = self._worker is not None and self._worker.is_alive()
        if not is_busy and wanted != self._failed and (self._map is None or self._map.setting != wanted):
            self._text.content = WAITING.format(len(AMPLITUDES) * len(FREQUENCIES))
            self._worker = threading.Thread(target=self._compute, args=(wanted,), name="map", daemon=True)
            self._worker.start()
        if self._map is not None:
            self._draw(self._map)
        if self._frame is not None:
            x, y = (float(value) for value in at_robot[:2])
            self._frame.position = (x, y + BEHIND, ABOVE)
            gait = self._live.setting.gait
            self._dot.position = self._place(math.degrees(gait.amplitude), math.degrees(gait.frequency))

    def _compute(self, wanted: Any) -> None:
        try:
            found = gait_map(wanted)
        except (ValueError, LaticaudaError) as error:
            self._failed = wanted
            self._text.content = str(error)
            return
        self._failed, self._map = None, found
        self._text.content = (
            "Planar trials of 20 s from rest, in the plane; gray where a trial failed. Click the map to swim so."
        )

    def _draw(self, found: GaitMap) -> None:
        quantity = self._quantity.value
        if self._drawn == (found, quantity):
            return
        self._drawn = found, quantity
        self._picture = gait_map_picture(AMPLITUDES, FREQUENCIES, found.values[quantity], title(quantity))
        self._frame = self._scene.add_frame("/board", show_axes=False, wxyz=UPRIGHT)
        image = self._scene.add_image("/board/map", self._picture.pixels, WIDTH, HEIGHT, format="png")
        self._dot = self._scene.add_icosphere("/board/dot", radius=0.022, color=(230, 60, 30))
        image.on_click(self._click)

    def _place(self, amplitude_deg: float, frequency_deg_s: float) -> tuple[float, float, float]:
        """Where a gait is on the picture, in its frame: x to the right, y down [m]."""
        assert self._picture is not None
        (left, bottom, wide, high), limits = self._picture.box, self._picture.limits
        shares = [
            (min(max(value, low), top) - low) / (top - low)
            for value, (low, top) in zip((amplitude_deg, frequency_deg_s), limits, strict=True)
        ]
        x, up = left + wide * shares[0] - 0.5, bottom + high * shares[1] - 0.5
        return x * WIDTH, -up * HEIGHT, 0.0

    def place_of(self, amplitude_deg: float, frequency_deg_s: float) -> tuple[float, float, float]:
        """Where a gait of the map is in the world [m].

        Args:
            amplitude_deg: Its amplitude [deg].
            frequency_deg_s: Its frequency [deg/s].
        """
        x, y, z = (float(value) for value in self._frame.position)
        right, down, _ = self._place(amplitude_deg, frequency_deg_s)
        return x + right, y, z - down

    def pointed_at(self, origin: np.ndarray, direction: np.ndarray) -> tuple[float, float] | None:
        """The amplitude [deg] and frequency [deg/s] of the trial that a ray meets on the board, or None.

        Args:
            origin: Of the ray, world axes [m].
            direction: Its direction [-].
        """
        if self._picture is None or self._frame is None or abs(direction[1]) < 1e-9:
            return None
        middle = np.asarray(self._frame.position, dtype=float)
        hit = origin + direction * (middle[1] - origin[1]) / direction[1]
        shares = (hit[0] - middle[0]) / WIDTH + 0.5, (hit[2] - middle[2]) / HEIGHT + 0.5
        (left, bottom, wide, high), limits = self._picture.box, self._picture.limits
        inside = (shares[0] - left) / wide, (shares[1] - bottom) / high
        if not all(0.0 <= share <= 1.0 for share in inside):
            return None
        amplitude, frequency = (low + share * (top - low) for share, (low, top) in zip(inside, limits, strict=True))
        return nearest(amplitude, frequency)

    def _click(self, event: Any) -> None:
        found = self.pointed_at(np.array(event.ray_origin), np.array(event.ray_direction))
        if found is None:
            return
        try:
            self._live.alter(gait=at(self._live.setting.gait, *found))
        except (ValueError, LaticaudaError) as error:
            refuse(event.client, error)
        self._changed()
