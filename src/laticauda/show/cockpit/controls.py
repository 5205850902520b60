"""All controls of the page: the quantities that can be set, with units and sensible limits."""

from collections.abc import Callable
from typing import Any

from laticauda.scenarios import Scenario, Spatial
from laticauda.show.cockpit.body_controls import BodyControls, has_elastic_fin
from laticauda.show.cockpit.control import Control
from laticauda.show.cockpit.events import Event, EventQueue, refusing
from laticauda.show.cockpit.gait_controls import add_gait_controls, add_pitch_controls
from laticauda.show.cockpit.live import FASTEST, SLOWEST, Live
from laticauda.show.cockpit.path_controls import PathControls
from laticauda.show.cockpit.water_controls import WaterControls


class Controls:
    """Controls of one page's server; all pages show the same.

    Args:
        gui: GUI of the page's server.
        live: The simulation that they control.
        events: Queue in which their events are handled.
        changed: Called after every change.
    """

    def __init__(
        self, gui: Any, live: Live, events: EventQueue, changed: Callable[[], None]
    ) -> None:
        self._live = live
        self._changed = changed
        self.by_name: dict[str, Control] = {}
        """Controls by what they set."""
        listen = events.handler(self.apply, then=self.settle)
        path_controls = PathControls(live)
        with gui.add_folder("Gait"):
            self.by_name |= add_gait_controls(gui, live)
        with gui.add_folder("Robot and water"):
            self._body_controls = BodyControls(gui, live)
            self.by_name |= self._body_controls.by_name
            self._water_controls = WaterControls(gui, live, self.by_name, listen)
        with gui.add_folder("Path"):
            self.by_name["path"] = path_controls.add_path(gui)
        with gui.add_folder("Time"):
            self.speed = gui.add_slider("speed of time [-]", SLOWEST, FASTEST, 0.1, live.speed)
            pause = gui.add_checkbox("pause", live.paused)
            self.reset = gui.add_button("reset")
        self._space_folder = gui.add_folder("In space")
        with self._space_folder:
            self.by_name["depth"] = path_controls.add_depth(gui)
            self.by_name |= add_pitch_controls(gui, live)
        for control in self.by_name.values():
            control.handle.on_update(listen)
        self.speed.on_update(events.handler(self.set_speed, then=self.settle))
        pause.on_update(events.handler(self._set_paused))
        self.show(live.scenario)

    def show(self, scenario: Scenario) -> None:
        """Update the controls to a scenario that came from elsewhere."""
        self._body_controls.remember_rigidity(scenario.robot)
        self._water_controls.update_fields(scenario)
        for control in self.by_name.values():
            control.handle.value = control.read(scenario)
        self._space_folder.visible = isinstance(scenario.model, Spatial)
        self.by_name["rigidity"].handle.visible = has_elastic_fin(scenario)

    @refusing
    def apply(self, event: Event) -> None:
        """Change only what a user has set: an untouched control may not show the full state."""
        for control in self.by_name.values():
            if control.handle is event.target:
                self._live.alter(**control.change(event.value))
                return

    def settle(self) -> None:
        """Show the actual state on all pages."""
        self.show(self._live.scenario)
        self.speed.value = self._live.speed
        self._changed()

    @refusing
    def set_speed(self, event: Event) -> None:
        """Set the speed of time."""
        self._live.speed = event.value

    def _set_paused(self, event: Event) -> None:
        self._live.paused = event.value
