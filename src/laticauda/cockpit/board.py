"""A map on a board beside the robot, computed in the background or from a stored sweep, and clicked to set the gait."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportAttributeAccessIssue=false
# pyright: reportUnknownArgumentType=false

import math
import threading
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.cockpit.files import received_sweep
from laticauda.cockpit.live import Live
from laticauda.cockpit.maps import AMPLITUDES, FREQUENCIES, OF_GAITS, Chart, Map, base_of, map_of_gaits, with_numbers
from laticauda.cockpit.pages import Event, EventQueue, refusing
from laticauda.errors import LaticaudaError
from laticauda.figures import style
from laticauda.scenarios import Scenario
from laticauda.studies.trials import attributes_of

WIDTH, HEIGHT = 1.8, 1.35  # [m]
BEHIND, ABOVE = 1.5, 0.5  # where its middle is to the robot: along y, and along z [m]
UPRIGHT = (math.sqrt(0.5), -math.sqrt(0.5), 0.0, 0.0)  # the picture's right is x, its top z; seen from -y
WAITING = (
    f"Computing {len(AMPLITUDES) * len(FREQUENCIES)} trials of this robot, water and joints; "
    "the first map on a computer also compiles, some 20 s ..."
)
OF_THE_GAITS = "Planar trials of 20 s from rest, in the plane; gray where a trial failed. Click the map to swim so."
HINT = "A sweep of `laticauda sweep`: its folder packed as .zip, or its Dataset as .nc"
SIZE = (3.4, 2.55)  # [in]
BOX = (0.17, 0.19, 0.65, 0.68)  # of the axes in the picture: left, bottom, width, height, as shares
POINT = 14.0  # size of a single one [pt^2]
Values = Float[np.ndarray, "n_y n_x"] | Float[np.ndarray, " n_points"]


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
        self._gui, self._scene, self._live = gui, scene, live
        self._clicked = events.handler(
            self._click, then=changed, read=lambda event: (event.ray_origin, event.ray_direction)
        )
        self._on = gui.add_checkbox("show the map", False, hint="On a board beside the robot; a click sets the gait")
        self._quantity = gui.add_dropdown("quantity", OF_GAITS)
        self._text = gui.add_markdown("")
        gui.add_upload_button("load a sweep", hint=HINT).on_upload(self._load)
        self._folder = gui.add_folder("Sweep", visible=False)
        with self._folder:
            self._about = gui.add_markdown("")
            self._x, self._y = gui.add_dropdown("across", ("",)), gui.add_dropdown("up", ("",))
            gui.add_button("back to the computed map", order=1e9).on_click(self._remove)
        self._x.on_update(self._choose)
        self._y.on_update(self._choose)
        self._sweep: Map | None = None
        self._across, self._up = "", ""  # what the map of the sweep spans
        self._others: dict[str, Any] = {}  # the controls of what it does not
        self._computed: tuple[Scenario, Map | None] | None = None  # and of what; no map where that failed
        self._worker: threading.Thread | None = None
        self._chart: Chart | None = None
        self._picture: Picture | None = None
        self._drawn: object = None
        self._frame: Any = None
        self._dot: Any = None

    def show(self, at_robot: np.ndarray) -> None:
        """Bring it up to date: called with every picture, returns at once."""
        if not self._on.value:
            if self._frame is not None:
                self._frame.remove()
                self._frame = self._drawn = self._picture = self._chart = None
                self._text.content = ""
            return
        found = self._current_chart()
        if found is not None:
            self._draw(found)
        if self._frame is not None and self._chart is not None:
            x, y = (float(value) for value in at_robot[:2])
            self._frame.position = (x, y + BEHIND, ABOVE)
            place = self._chart.place_of(self._live.scenario)
            self._dot.visible = place is not None
            if place is not None:
                self._dot.position = self._place(*place)

    def show_sweep(self, sweep: Map | None) -> None:
        """Let a stored sweep be the map from now on; None: the one that is computed."""
        for handle in self._others.values():
            handle.remove()
        self._sweep, self._others, self._text.content = sweep, {}, ""
        quantities, before = OF_GAITS if sweep is None else sweep.quantities, self._quantity.value
        self._quantity.options = quantities
        self._quantity.value = before if before in quantities else quantities[0]
        self._folder.visible = sweep is not None
        if sweep is None:
            return
        self._x.options = self._y.options = sweep.spanning
        self._x.value, self._y.value = self._across, self._up = sweep.spanning[:2]
        with self._folder:
            for name in sweep.names if sweep.is_grid else ():
                ticks, own = sweep.ticks(name), sweep.shown_of(self._live.scenario, name)
                nearest = ticks[0] if own is None else min(ticks, key=lambda tick, own=own: abs(tick - own))
                self._others[name] = self._gui.add_dropdown(
                    sweep.label(name),
                    tuple(f"{tick:.6g}" for tick in ticks),
                    initial_value=f"{nearest:.6g}",
                    visible=name not in (self._across, self._up),
                )
        self._on.value = True

    def _current_chart(self) -> Chart | None:
        """What is to be drawn; None as long as there is none."""
        quantity = self._quantity.value
        if self._sweep is not None:
            self._about.content = _differences(self._sweep, self._live.scenario)
            at = {name: handle.options.index(handle.value) for name, handle in self._others.items()}
            return self._sweep.chart(quantity, self._across, self._up, at)
        base = base_of(self._live.scenario)
        is_busy = self._worker is not None and self._worker.is_alive()
        if not is_busy and (self._computed is None or self._computed[0] != base):
            self._text.content = WAITING
            self._worker = threading.Thread(target=self._compute, args=(base,), name="map", daemon=True)
            self._worker.start()
        found = None if self._computed is None else self._computed[1]
        return None if found is None else found.chart(quantity, found.names[0], found.names[1])

    def _compute(self, base: Scenario) -> None:
        try:
            self._computed, self._text.content = (base, map_of_gaits(base)), OF_THE_GAITS
        except (ValueError, LaticaudaError) as error:
            self._computed, self._text.content = (base, None), str(error)

    def _draw(self, chart: Chart) -> None:
        key = chart.quantity, chart.x, chart.y, id(chart.map), tuple(h.value for h in self._others.values())
        if self._drawn == key:
            return
        self._drawn, self._chart, found = key, chart, chart.map
        across, up, values = found.ticks(chart.x), found.ticks(chart.y), np.asarray(chart.cut, dtype=float)
        labels = found.label(chart.x), found.label(chart.y)
        self._picture = gait_map_picture(across.tolist(), up.tolist(), values, chart.title, labels)
        self._frame = self._scene.add_frame("/board", show_axes=False, wxyz=UPRIGHT)
        image = self._scene.add_image("/board/map", self._picture.pixels, WIDTH, HEIGHT, format="png")
        self._dot = self._scene.add_icosphere("/board/dot", radius=0.022, color=(230, 60, 30))
        image.on_click(self._clicked)

    def _place(self, across: float, up: float) -> tuple[float, float, float]:
        """Where two numbers are on the picture, in its frame: x to the right, y down [m]."""
        assert self._picture is not None
        (left, bottom, wide, high), limits = BOX, self._picture.limits
        right = np.interp(across, limits[0], (left, left + wide)) - 0.5
        above = np.interp(up, limits[1], (bottom, bottom + high)) - 0.5
        return float(right) * WIDTH, float(-above) * HEIGHT, 0.0

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
        right, above = float((hit[0] - middle[0]) / WIDTH + 0.5), float((hit[2] - middle[2]) / HEIGHT + 0.5)
        (left, bottom, wide, high), limits = BOX, self._picture.limits
        if not (left <= right <= left + wide and bottom <= above <= bottom + high):
            return None
        across = np.interp(right, (left, left + wide), limits[0])
        return self._chart.nearest(float(across), float(np.interp(above, (bottom, bottom + high), limits[1])))

    @refusing
    def _click(self, event: Event) -> None:
        found = self.pointed_at(*(np.array(part) for part in event.value))
        if found is not None:
            self._live.change(with_numbers(self._live.scenario, found))

    @refusing
    def _load(self, event: Any) -> None:
        file = event.target.value
        self.show_sweep(received_sweep(file.name, file.content))

    def _remove(self, event: Any) -> None:
        self.show_sweep(None)

    def _choose(self, event: Any) -> None:
        """After another axis was chosen; one that was on the other axis changes places with it."""
        if event.client is None or self._sweep is None:
            return
        x, y = self._x.value, self._y.value
        if x == y:
            x, y = (x, self._across) if event.target is self._x else (self._up, y)
            self._x.value, self._y.value = x, y
        for name, handle in self._others.items():
            handle.visible = name not in (x, y)
        self._across, self._up = x, y


def _differences(sweep: Map, scenario: Scenario) -> str:
    """What a sweep is of, and in what that is not what swims here."""
    here = attributes_of(scenario)
    of = ", ".join(value.replace("_", " ") for value in sweep.about.values())
    other = [f"{name} {here[name]}" for name, value in sweep.about.items() if here[name] != value]
    text = f"**{sweep.name}**: {of}. A click sets the numbers of a trial."
    return text + (f" Here it is {', '.join(other)}." if other else "")


# ---- the picture ---------------------------------------------------------------------------------------------------


class Picture(NamedTuple):
    """A picture of the map, for a screen, and what its axes, in `BOX`, go from and to."""

    pixels: Any
    limits: tuple[tuple[float, float], tuple[float, float]]


def gait_map_picture(
    across: Sequence[float], up: Sequence[float], values: Values, title: str, labels: tuple[str, str]
) -> Picture:
    """A figure of many trials as colors over two of their numbers; gray where there is none.

    Args:
        across: Of every column, or of every point.
        up: Of every row, or of every point.
        values: The figure: a table, or one value per point.
        title: Its name, with its unit.
        labels: What is across and what is up, with units.
    """
    figure = style.new_figure(*SIZE)
    figure.set_layout_engine("none")
    figure.set_dpi(220)
    ax = figure.add_axes(BOX)
    ax.set_facecolor("#c8c8c8")
    shown = np.ma.masked_invalid(values)
    if shown.ndim == 2:
        mesh = ax.pcolormesh(across, up, shown, shading="nearest")
    else:
        mesh = ax.scatter(across, up, c=shown, s=POINT, linewidths=0.0)
    style.dress(ax, xlabel=labels[0], ylabel=labels[1])
    ax.set_title(title, fontsize=style.LABEL, color=style.INK)
    bar: Any = figure.colorbar(mesh, cax=ax.inset_axes((1.04, 0.0, 0.05, 1.0)))
    bar.ax.tick_params(labelsize=style.TICK, labelcolor=style.INK)
    bar.outline.set_visible(False)
    canvas: Any = figure.canvas
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3].copy()
    return Picture(pixels=pixels, limits=(ax.get_xlim(), ax.get_ylim()))
