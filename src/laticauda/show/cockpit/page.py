"""The cockpit: one simulation in real time, shown on any number of pages."""

import math
import threading
import time
from pathlib import Path
from typing import Any

from laticauda.control import StraightLine
from laticauda.show.cockpit import controls, gait_map, pages, readouts, runs, scene, simulation
from laticauda.show.cockpit.live import Live
from laticauda.show.cockpit.operated import OperatedRobot
from laticauda.show.cockpit.pages import Event, EventQueue, refusing
from laticauda.values.access import ServerAccess

FRAME = 0.05  # time between two frames [s]
SLOW = 5  # frames between two updates of numbers and plots
STYLE = f"<style>{Path(__file__).with_suffix('.css').read_text()}</style>"


class Cockpit:
    """Server of a page, with its simulation.

    Args:
        live: The simulation.
        host: Address to listen on; for any address but that of this computer alone, the page's URL
            contains a token.
        port: Port to listen on; 0: any free port.

    Raises:
        MissingExtra: If viser is not installed.
        PortTaken: If the server cannot listen there.
    """

    def __init__(self, live: Live, *, host: str = "127.0.0.1", port: int = 8080) -> None:
        self.live = live
        self.door = ServerAccess.of(host)
        """Access control for pages."""
        self._server = pages.serve(self.door, port)
        self._events = EventQueue()
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None
        self._frames = 0
        self._new_trail = False
        gui = self._server.gui
        gui.configure_theme(
            dark_mode=True, show_logo=False, show_share_button=False, control_width="large"
        )
        gui.set_panel_label("laticauda cockpit")
        self._scene = scene.Scene(self._server.scene)
        camera = self._server.initial_camera
        camera.position, camera.look_at = scene.HOME
        camera.fov = scene.FIELD_OF_VIEW
        gui.add_html(STYLE)
        self._figures = gui.add_markdown("")
        tabs = gui.add_tab_group()
        with tabs.add_tab("Swim"):
            self._controls = controls.Controls(gui, live, self._events, self._changed)
            self._forces = gui.add_checkbox(
                "link forces", False, hint="Drag, added mass and effectors together"
            )
        with tabs.add_tab("Plots"):
            self._plots = readouts.Plots(gui)
        with tabs.add_tab("Map"):
            self._map = gait_map.GaitMap(gui, live, self._events, self._show_scenario)
        with tabs.add_tab("Run"):
            self._runs = runs.Runs(gui, live, self._scene)
        with tabs.add_tab("Lab"):
            self.operated = OperatedRobot(gui, self._server.scene, self._scene)
            """Robot that somebody else operates, if one is being watched."""
        flat = {"scale": 0.35, "active_axes": (True, True, False), "visible": False}
        self._gizmo = self._server.scene.add_transform_controls("/handle", **flat)
        self._gizmo.on_update(self._events.handler(self._drag, read=_pose))
        self._controls.reset.on_click(self._events.handler(lambda _: self._reset()))
        self._forces.on_update(
            self._events.handler(lambda event: setattr(live, "link_forces", event.value))
        )
        self._changed()
        self._cameras = pages.PageCameras(
            self._server
        )  # the controls of each page itself appear below the rest

    @property
    def address(self) -> str:
        """URL of the page, with the token if there is one."""
        return self.door.url(self._server.get_port())

    @property
    def pages(self) -> int:
        """Number of open pages."""
        return len(self._cameras.all())

    def load(self, path: Path) -> None:
        """Play back a trial or a recording as a ghost.

        Args:
            path: The file.

        Raises:
            TrialFileError: If the file is neither; the message gives the reason.
            MissingExtra: If the format needs a package that is not installed.
            ValueError: If the trial does not contain the robot's posture.
        """
        self._runs.play(runs.stored_trial(path, str(path)))

    def open(self) -> None:
        """Run the simulation in a separate thread."""
        self._thread = threading.Thread(target=self._run, name="cockpit", daemon=True)
        self._thread.start()

    def wait(self) -> None:
        """Wait until the cockpit is closed."""
        while not self._stop.wait(0.2):
            pass

    def close(self) -> None:
        """Stop the simulation and the server."""
        self._stop.set()
        if self._thread is not None:
            self._thread.join(5.0)
        pages.stop_server(self._server)
        self._events.close()

    def _run(self) -> None:
        last = time.perf_counter()
        while not self._stop.wait(max(FRAME - (time.perf_counter() - last), 0.0)):
            now = time.perf_counter()
            self.live.advance(now - last)
            last = now
            self.frame()

    def frame(self) -> None:
        """Update all pages."""
        live, self._frames = self.live, self._frames + 1
        sample, plant = live.latest(), live.simulation.plant
        with self._server.atomic():
            if self._new_trail:
                self._scene.trail.forget()
                self._new_trail = False
            self._scene.show(plant.robot, plant.environment, sample, forces=live.link_forces)
            self._runs.show()
            operated = self.operated.show(with_text=self._frames % SLOW == 0)
            if self._frames % SLOW == 0:
                self._scene.trail.draw()
                self._figures.content = readouts.numbers_text(live)
                self._map.show()
            if self._frames % (2 * SLOW) == 0:
                self._plots.show(live)
        self._cameras.show(sample.center_of_mass if operated is None else operated)

    @property
    def _height(self) -> float:
        """Height at which a path is drawn: its own, or the robot's [m]."""
        place, depth = self.live.latest().center_of_mass, simulation.depth_of(self.live.scenario)
        return -depth if depth is not None else float(place[2]) if place.size == 3 else 0.0

    def _changed(self) -> None:
        """Update the page after a change of the scenario."""
        path, live = simulation.path_of(self.live.scenario), self.live
        self._scene.path(simulation.route_of(live.scenario, self._height))
        self._scene.surroundings(live.simulation.plant, live.simulation.state)
        self._gizmo.visible = isinstance(path, StraightLine)
        if isinstance(path, StraightLine):
            half = 0.5 * path.angle
            self._gizmo.position = (*path.point, self._height)
            self._gizmo.wxyz = (math.cos(half), 0.0, 0.0, math.sin(half))
        self._runs.changed()

    def _show_scenario(self) -> None:
        """Update the page after a change that did not come from the controls."""
        self._controls.show(self.live.scenario)
        self._changed()

    @refusing
    def _drag(self, event: Event) -> None:
        """Move the path to where its gizmo is dragged."""
        if simulation.path_of(self.live.scenario) is None:
            return
        (x, y, _), (w, _, _, z), phase = event.value
        try:
            self.live.alter(
                path=StraightLine(
                    point=(float(x), float(y)), angle=2.0 * math.atan2(float(z), float(w))
                )
            )
        finally:
            self._scene.path(simulation.route_of(self.live.scenario, self._height))
            if phase == "end":
                self._runs.changed()

    def _reset(self) -> None:
        self.live.reset()
        self._runs.begin()
        self._new_trail = True


def _pose(event: Any) -> tuple[Any, ...]:
    return event.target.position, event.target.wxyz, event.phase
