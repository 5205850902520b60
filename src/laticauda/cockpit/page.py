"""The cockpit: one world on a clock, shown on any number of pages."""

import math
import threading
import time
from pathlib import Path
from typing import Any

from laticauda.cockpit import door
from laticauda.cockpit.board import Board
from laticauda.cockpit.controls import Controls, refuse
from laticauda.cockpit.figures import figures_text
from laticauda.cockpit.files import opened
from laticauda.cockpit.live import Live
from laticauda.cockpit.plots import Plots
from laticauda.cockpit.runs import Runs
from laticauda.cockpit.scene import FIELD_OF_VIEW, Scene, look_down
from laticauda.cockpit.sweeps import StoredSweep
from laticauda.cockpit.turns import Asked, Turns
from laticauda.cockpit.views import Views
from laticauda.cockpit.watched import Watched
from laticauda.control import StraightLine
from laticauda.errors import LaticaudaError

FRAME = 0.05  # time between two pictures [s]
SLOW = 5  # pictures between two updates of numbers and plots


class Cockpit:
    """A page's server with its world.

    Args:
        live: The world.
        host: Address that it listens on.
        port: Likewise; 0: any that is free.

    Raises:
        MissingExtra: If viser is not installed.
        PortTaken: If it cannot listen there.
    """

    def __init__(self, live: Live, *, host: str = "127.0.0.1", port: int = 8080) -> None:
        self.live = live
        self._server = door.server(host, port)
        self._turns = Turns()
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None
        self._frames = 0
        self._new_trail = False
        gui = self._server.gui
        gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False, control_width="large")
        gui.set_panel_label("laticauda cockpit")
        self._scene = Scene(self._server.scene)
        camera = self._server.initial_camera
        camera.position, camera.look_at = look_down()
        camera.fov = FIELD_OF_VIEW
        self._figures = gui.add_markdown("")
        tabs = gui.add_tab_group()
        with tabs.add_tab("Swim"):
            self._controls = Controls(gui, live, self._turns, self._changed)
            self._forces = gui.add_checkbox("link forces", False, hint="Drag, added mass and effectors together")
        with tabs.add_tab("Plots"):
            self._plots = Plots(gui)
        with tabs.add_tab("Map"):
            self._board = Board(gui, self._server.scene, live, self._turns, self._show_setting)
        with tabs.add_tab("Run"):
            self._runs = Runs(gui, live, self._scene)
        with tabs.add_tab("Lab"):
            self._watched = Watched(gui, self._server.scene, self._scene, live.setting.robot)
        self._gizmo = self._server.scene.add_transform_controls(
            "/handle", scale=0.35, active_axes=(True, True, False), visible=False
        )
        dragged = self._turns.hear(
            self._drag, read=lambda event: (event.target.position, event.target.wxyz, event.phase)
        )
        self._gizmo.on_update(dragged)
        self._controls.reset.on_click(self._turns.hear(lambda _: self._reset()))
        self._forces.on_update(self._show_forces)
        self._changed()
        self._views = Views(self._server)  # what a page has for itself stands below the rest

    @property
    def address(self) -> str:
        """Where a browser finds it."""
        host = self._server.get_host()
        return f"http://{f'[{host}]' if ':' in host else host}:{self._server.get_port()}"

    @property
    def pages(self) -> int:
        """How many pages are open."""
        return len(self._views)

    @property
    def watched(self) -> Watched:
        """The robot that somebody else operates, if it is connected."""
        return self._watched

    def load(self, path: Path) -> None:
        """Play back a trial or a recording as a ghost, or show a sweep as the map.

        Args:
            path: The file, or the folder of a sweep.

        Raises:
            TrialFileError: If it is none of them; the message has the reason.
            MissingExtra: If the format needs a package that is not installed.
            ValueError: If the trial does not say how the robot was bent.
        """
        found = opened(path)
        if isinstance(found, StoredSweep):
            self._board.sweeps.show(found)
        else:
            self._runs.play(found)

    def open(self) -> None:
        """Let the world live, in a thread of its own."""
        self._thread = threading.Thread(target=self._run, name="cockpit", daemon=True)
        self._thread.start()

    def wait(self) -> None:
        """Until somebody closes it."""
        while not self._stop.wait(0.2):
            pass

    def close(self) -> None:
        """Stop the world and its server."""
        self._stop.set()
        if self._thread is not None:
            self._thread.join(5.0)
        self._watched.disconnect()
        door.stop(self._server)
        self._turns.close()

    def _run(self) -> None:
        last = time.perf_counter()
        while not self._stop.wait(max(FRAME - (time.perf_counter() - last), 0.0)):
            now = time.perf_counter()
            self.live.advance(now - last)
            last = now
            self.frame()

    def frame(self) -> None:
        """Bring all pages up to date."""
        live, self._frames = self.live, self._frames + 1
        sample, robot = live.latest(), live.world.plant.robot
        with self._server.atomic():
            if self._new_trail:
                self._scene.forget_trail()
                self._new_trail = False
            self._scene.show(robot, sample, forces=live.link_forces)
            self._board.show(sample["center_of_mass"])
            self._runs.show()
            watched = self._watched.show(with_text=self._frames % SLOW == 0)
            if self._frames % SLOW == 0:
                self._scene.trail()
                self._figures.content = figures_text(live)
            if self._frames % (2 * SLOW) == 0:
                self._plots.show(live)
        self._views.show((sample["center_of_mass"] if watched is None else watched)[:2])

    def _changed(self) -> None:
        """After every change of the setting."""
        path = self.live.setting.path
        self._scene.path(path)
        self._gizmo.visible = path is not None
        if path is not None:
            half = 0.5 * path.angle
            self._gizmo.position = (*path.point, 0.0)
            self._gizmo.wxyz = (math.cos(half), 0.0, 0.0, math.sin(half))
        self._runs.changed()

    def _show_setting(self) -> None:
        """After a change that did not come from the controls."""
        self._controls.show(self.live.setting)
        self._changed()

    def _drag(self, asked: Asked) -> None:
        """The path goes where its gizmo is dragged to."""
        if self.live.setting.path is None:
            return
        (x, y, _), (w, _, _, z), phase = asked.value
        moved = StraightLine(point=(float(x), float(y)), angle=2.0 * math.atan2(float(z), float(w)))
        try:
            self.live.alter(path=moved)
        except (ValueError, LaticaudaError) as error:
            refuse(asked.client, error)
        self._scene.path(self.live.setting.path)
        if phase == "end":
            self._runs.changed()

    def _reset(self) -> None:
        self.live.reset()
        self._runs.begin()
        self._new_trail = True

    def _show_forces(self, event: Any) -> None:
        self.live.link_forces = event.target.value
