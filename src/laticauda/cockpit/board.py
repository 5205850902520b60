"""A map on a board beside the robot, computed in the background or from a stored sweep, and clicked to set the gait."""

import math
import threading
from collections.abc import Callable
from typing import Any

import numpy as np

from laticauda.cockpit.chart import Chart, with_values
from laticauda.cockpit.controls import refuse
from laticauda.cockpit.gait_map import AMPLITUDES, FREQUENCIES, QUANTITIES, GaitMap, base, chart, gait_map
from laticauda.cockpit.live import Live
from laticauda.cockpit.sweep_controls import SweepControls
from laticauda.cockpit.turns import Asked, Turns
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
        turns: Where it is set.
        changed: Called after every change.
    """

    def __init__(self, gui: Any, scene: Any, live: Live, turns: Turns, changed: Callable[[], None]) -> None:
        self._scene, self._live = scene, live
        self._clicked = turns.hear(
            self._click, then=changed, read=lambda event: (event.ray_origin, event.ray_direction)
        )
        self._on = gui.add_checkbox("show the map", False, hint="On a board beside the robot; a click sets the gait")
        self._quantity = gui.add_dropdown("quantity", tuple(QUANTITIES))
        self._text = gui.add_markdown("")
        self._map: GaitMap | None = None
        self._failed: object = None
        self._chart: Chart | None = None
        self._picture: Picture | None = None
        self._drawn: object = None
        self._worker: threading.Thread | None = None
        self._frame: Any = None
        self._dot: Any = None
        self._sweeps = SweepControls(gui, live, refuse, self._other_map)

    @property
    def sweeps(self) -> SweepControls:
        """The controls of stored sweeps."""
        return self._sweeps

    def show(self, at_robot: np.ndarray) -> None:
        """Bring it up to date: called with every picture, returns at once."""
        if not self._on.value:
            if self._frame is not None:
                self._frame.remove()
                self._frame = self._drawn = self._picture = self._chart = None
                self._text.content = ""
            return
        found = self._wanted()
        if found is not None:
            self._draw(*found)
        if self._frame is not None and self._chart is not None:
            x, y = (float(value) for value in at_robot[:2])
            self._frame.position = (x, y + BEHIND, ABOVE)
            place = self._chart.place_of(self._live.setting)
            self._dot.visible = place is not None
            if place is not None:
                self._dot.position = self._place(*place)

    def _wanted(self) -> tuple[Chart, object] | None:
        """The map that is to be seen, and what tells it from others; None as long as there is none."""
        stored = self._sweeps.chart(self._quantity.value)
        if stored is not None:
            self._sweeps.note(self._live.setting)
            return stored
        wanted = base(self._live.setting)
        is_busy = self._worker is not None and self._worker.is_alive()
        if not is_busy and wanted != self._failed and (self._map is None or self._map.setting != wanted):
            self._text.content = WAITING.format(len(AMPLITUDES) * len(FREQUENCIES))
            self._worker = threading.Thread(target=self._compute, args=(wanted,), name="map", daemon=True)
            self._worker.start()
        quantity = self._quantity.value
        if self._map is None or quantity not in QUANTITIES:
            return None
        return chart(self._map, quantity), (self._map, quantity)

    def _other_map(self) -> None:
        """After a sweep was loaded or sent away."""
        sweep = self._sweeps.sweep
        self._text.content = ""
        names = tuple(QUANTITIES) if sweep is None else tuple(sweep.values)
        before = self._quantity.value
        self._quantity.options = names
        self._quantity.value = before if before in names else names[0]
        self._on.value = self._on.value or sweep is not None

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

    def _draw(self, found: Chart, key: object) -> None:
        if self._drawn == key:
            return
        self._drawn, self._chart = key, found
        x, y = found.x, found.y
        self._picture = gait_map_picture(x.ticks, y.ticks, found.values, found.title, (x.label, y.label))
        self._frame = self._scene.add_frame("/board", show_axes=False, wxyz=UPRIGHT)
        image = self._scene.add_image("/board/map", self._picture.pixels, WIDTH, HEIGHT, format="png")
        self._dot = self._scene.add_icosphere("/board/dot", radius=0.022, color=(230, 60, 30))
        image.on_click(self._clicked)

    def _place(self, across: float, up: float) -> tuple[float, float, float]:
        """Where two numbers are on the picture, in its frame: x to the right, y down [m]."""
        assert self._picture is not None
        (left, bottom, wide, high), limits = self._picture.box, self._picture.limits
        shares = [
            (min(max(value, low), top) - low) / (top - low)
            for value, (low, top) in zip((across, up), limits, strict=True)
        ]
        right, above = left + wide * shares[0] - 0.5, bottom + high * shares[1] - 0.5
        return right * WIDTH, -above * HEIGHT, 0.0

    def place_of(self, across: float, up: float) -> tuple[float, float, float]:
        """Where a point of the map is in the world [m].

        Args:
            across: Its number from left to right, in the unit shown.
            up: Its number upward, likewise.
        """
        x, y, z = (float(value) for value in self._frame.position)
        right, down, _ = self._place(across, up)
        return x + right, y, z - down

    def pointed_at(self, origin: np.ndarray, direction: np.ndarray) -> dict[str, float] | None:
        """The numbers of the trial that a ray meets on the board, by name, or None.

        Args:
            origin: Of the ray, world axes [m].
            direction: Its direction [-].
        """
        if self._picture is None or self._chart is None or self._frame is None or abs(direction[1]) < 1e-9:
            return None
        middle = np.asarray(self._frame.position, dtype=float)
        hit = origin + direction * (middle[1] - origin[1]) / direction[1]
        shares = (hit[0] - middle[0]) / WIDTH + 0.5, (hit[2] - middle[2]) / HEIGHT + 0.5
        (left, bottom, wide, high), limits = self._picture.box, self._picture.limits
        inside = (shares[0] - left) / wide, (shares[1] - bottom) / high
        if not all(0.0 <= share <= 1.0 for share in inside):
            return None
        return self._chart.nearest(
            *(low + share * (top - low) for share, (low, top) in zip(inside, limits, strict=True))
        )

    def _click(self, asked: Asked) -> None:
        found = self.pointed_at(*(np.array(part) for part in asked.value))
        if found is None:
            return
        try:
            self._live.change(with_values(self._live.setting, found))
        except (ValueError, LaticaudaError) as error:
            refuse(asked.client, error)
