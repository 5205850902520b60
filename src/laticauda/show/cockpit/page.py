"""The cockpit: one simulation in real time, shown on any number of pages."""

import math
import threading
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from laticauda.control import StraightLine
from laticauda.show.cockpit.cameras import FIELD_OF_VIEW, HOME, PageCameras
from laticauda.show.cockpit.changes import read_depth, read_path, sample_route
from laticauda.show.cockpit.controls import Controls
from laticauda.show.cockpit.events import Event, EventQueue, refusing
from laticauda.show.cockpit.files import load_played_trial
from laticauda.show.cockpit.gait_map import GaitMap
from laticauda.show.cockpit.live import Live
from laticauda.show.cockpit.operated import OperatedRobot
from laticauda.show.cockpit.plots import Plots
from laticauda.show.cockpit.readouts import format_figures
from laticauda.show.cockpit.runs import Runs
from laticauda.show.cockpit.scene import Scene
from laticauda.show.cockpit.server import start_server, stop_server
from laticauda.values import ServerAccess

FRAME = 0.05
"""Time between two frames [s]."""
TEXT_FRAMES = 5
"""Frames between two updates of numbers, trails and the map."""
PLOT_FRAMES = 10
"""Frames between two updates of the plots."""
CLOSING_TIME = 5.0
"""How long closing waits for the frame that is being computed [s]."""
STYLE = f"<style>{Path(__file__).with_suffix('.css').read_text()}</style>"


class GizmoPose(NamedTuple):
    """Where a page has dragged the gizmo of the path."""

    position: tuple[float, float, float]
    """[m]."""
    orientation: tuple[float, float, float, float]
    """Quaternion (w, x, y, z) [-]."""
    phase: str
    """`end` when it is let go."""


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
        self._server = start_server(self.door, port)
        self._events = EventQueue()
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None
        self._n_frames = 0
        self._is_trail_outdated = False
        self._set_theme()
        self._scene = Scene(self._server.scene)
        self._set_initial_camera()
        self._add_panel()
        self._gizmo = self._add_gizmo()
        self._connect_controls()
        self._update_scenario()
        # The controls of each page itself appear below the others.
        self._cameras = PageCameras(self._server)

    # ---- set-up ----------------------------------------------------------------------------------

    def _set_theme(self) -> None:
        gui = self._server.gui
        gui.configure_theme(
            dark_mode=True, show_logo=False, show_share_button=False, control_width="large"
        )
        gui.set_panel_label("laticauda cockpit")

    def _set_initial_camera(self) -> None:
        camera = self._server.initial_camera
        camera.position = HOME.position
        camera.look_at = HOME.look_at
        camera.fov = FIELD_OF_VIEW

    def _add_panel(self) -> None:
        """Add the figures, and the tabs below them."""
        gui = self._server.gui
        gui.add_html(STYLE)
        self._figures = gui.add_markdown("")
        tabs = gui.add_tab_group()
        with tabs.add_tab("Swim"):
            self._controls = Controls(gui, self.live, self._events, self._update_scenario)
            self._forces = gui.add_checkbox(
                "link forces", False, hint="Drag, added mass and effectors together"
            )
        with tabs.add_tab("Plots"):
            self._plots = Plots(gui)
        with tabs.add_tab("Map"):
            self._map = GaitMap(gui, self.live, self._events, self._show_scenario)
        with tabs.add_tab("Run"):
            self._runs = Runs(gui, self.live, self._scene)
        with tabs.add_tab("Lab"):
            self.operated = OperatedRobot(gui, self._server.scene, self._scene)
            """Robot that somebody else operates, if one is being watched."""

    def _add_gizmo(self) -> Any:
        """Add the gizmo with which the path can be dragged."""
        return self._server.scene.add_transform_controls(
            "/handle", scale=0.35, active_axes=(True, True, False), visible=False
        )

    def _connect_controls(self) -> None:
        events = self._events
        self._gizmo.on_update(events.handler(self._drag, read=_read_gizmo))
        self._controls.reset.on_click(events.handler(self._handle_reset))
        self._forces.on_update(events.handler(self._set_link_forces))

    # ---- for the program -------------------------------------------------------------------------

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
        self._runs.play(load_played_trial(path, str(path)))

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
            self._thread.join(CLOSING_TIME)
        stop_server(self._server)
        self._events.close()

    # ---- time ------------------------------------------------------------------------------------

    def _run(self) -> None:
        last = time.perf_counter()
        while True:
            time_left = FRAME - (time.perf_counter() - last)
            if self._stop.wait(max(time_left, 0.0)):
                return
            now = time.perf_counter()
            self.live.advance(now - last)
            last = now
            self.frame()

    def frame(self) -> None:
        """Update all pages."""
        self._n_frames += 1
        with_text = self._n_frames % TEXT_FRAMES == 0
        sample = self.live.latest()
        plant = self.live.simulation.plant
        with self._server.atomic():
            if self._is_trail_outdated:
                self._scene.trail.forget()
                self._is_trail_outdated = False
            self._scene.show(plant.robot, plant.environment, sample, forces=self.live.link_forces)
            self._runs.show()
            operated_center = self.operated.show(with_text=with_text)
            if with_text:
                self._update_text()
            if self._n_frames % PLOT_FRAMES == 0:
                self._plots.show(self.live)
        center = sample.center_of_mass
        if operated_center is not None:
            center = operated_center
        self._cameras.show(center)

    def _update_text(self) -> None:
        """Update what need not be smooth."""
        self._scene.trail.draw()
        self._figures.content = format_figures(self.live)
        self._map.show()

    # ---- changes ---------------------------------------------------------------------------------

    def _update_scenario(self) -> None:
        """Update the page after a change of the scenario."""
        simulation = self.live.simulation
        self._draw_path()
        self._scene.draw_surroundings(simulation.plant, simulation.state)
        path = read_path(self.live.scenario)
        self._gizmo.visible = isinstance(path, StraightLine)
        if isinstance(path, StraightLine):
            half_angle = 0.5 * path.angle
            self._gizmo.position = (*path.point, self._path_height)
            self._gizmo.wxyz = (math.cos(half_angle), 0.0, 0.0, math.sin(half_angle))
        self._runs.update_copies()

    def _show_scenario(self) -> None:
        """Update the page after a change that did not come from the controls."""
        self._controls.show(self.live.scenario)
        self._update_scenario()

    def _draw_path(self) -> None:
        self._scene.draw_path(sample_route(self.live.scenario, self._path_height))

    @property
    def _path_height(self) -> float:
        """Height at which a path is drawn: its own, or the robot's [m]."""
        depth = read_depth(self.live.scenario)
        if depth is not None:
            return -depth
        return _height_of(self.live.latest().center_of_mass)

    @refusing
    def _drag(self, event: Event) -> None:
        """Move the path to where its gizmo is dragged."""
        if read_path(self.live.scenario) is None:
            return
        pose: GizmoPose = event.value
        try:
            self.live.alter(path=_line_of(pose))
        finally:
            self._draw_path()
            if pose.phase == "end":
                self._runs.update_copies()

    def _set_link_forces(self, event: Event) -> None:
        self.live.link_forces = event.value

    def _handle_reset(self, event: Event) -> None:
        self._reset()

    def _reset(self) -> None:
        self.live.reset()
        self._runs.begin()
        self._is_trail_outdated = True


def _height_of(center: np.ndarray) -> float:
    """Return the height of a robot; 0 in the plane [m]."""
    if center.size == 2:
        return 0.0
    return float(center[2])


def _read_gizmo(event: Any) -> GizmoPose:
    """Return the pose in viser's event."""
    return GizmoPose(event.target.position, event.target.wxyz, event.phase)


def _line_of(pose: GizmoPose) -> StraightLine:
    """Return the path through a gizmo, along its x axis."""
    x, y, _ = pose.position
    w, _, _, z = pose.orientation
    return StraightLine(point=(float(x), float(y)), angle=2.0 * math.atan2(float(z), float(w)))
