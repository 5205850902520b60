"""Controls of the page for runs: saving the current one, playing back a stored one, and repeating it elsewhere."""

import tempfile
import threading
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.show.cockpit.elsewhere import (
    FILE,
    TEXT,
    build_copy_buttons,
    write_python,
    write_scenario,
    write_shell,
)
from laticauda.show.cockpit.events import refusing
from laticauda.show.cockpit.files import ENDINGS, load_uploaded_trial
from laticauda.show.cockpit.ghost import Ghost
from laticauda.show.cockpit.live import Live
from laticauda.show.cockpit.scene import Scene
from laticauda.trials import Trial
from laticauda.values import LaticaudaError

SAVED = "cockpit-run.nc"
"""Name of a saved run."""
MOST_UNSENT = 500
"""Messages that may wait for a page that is sent a file; a file is one for each MiB [-]."""
GAP = 0.5
"""From the robot to a ghost next to it, to the left of the robot's heading [m]."""
HINT_OF_SAVE = (
    "The run since the setting was last changed, at most ten minutes of it, as a netCDF file"
)
HINT_OF_SCENARIO = f"Robot, gait and water, from where the robot first began, as {FILE}"
HINT_OF_UPLOAD = f"A saved run, or the recording of an operation ({', '.join(ENDINGS)}), as a ghost"
HINT_OF_BESIDE = "The ghost begins beside the robot; otherwise, where it was recorded"


class Runs:
    """Controls for saving, playing back and repeating runs.

    Args:
        gui: GUI of the page's server; the controls are added at its current position.
        live: The simulation that is saved.
        scene: The scene in which the ghost swims.
    """

    def __init__(self, gui: Any, live: Live, scene: Scene) -> None:
        self._live = live
        self._scene = scene
        self._ghost: Ghost | None = None
        self._ghost_start = 0.0
        """Simulated time at which the ghost began [s]."""
        self._reading = threading.Lock()
        """Held while an uploaded file is read, which occupies one of the server's few threads."""
        self._writing = threading.Lock()
        """Held while a run is saved, likewise."""
        save = gui.add_button("save the run", hint=HINT_OF_SAVE)
        save.on_click(self._save)
        download = gui.add_button("download the scenario", hint=HINT_OF_SCENARIO)
        download.on_click(self._send_scenario)
        upload = gui.add_upload_button("play back a trial", hint=HINT_OF_UPLOAD)
        upload.on_upload(self._load)
        self._beside = gui.add_checkbox(
            "ghost beside the robot", True, visible=False, hint=HINT_OF_BESIDE
        )
        self._beside.on_update(self._place)
        self._removal = gui.add_button("remove the ghost", visible=False)
        self._removal.on_click(self._remove)
        gui.add_markdown("**The same run elsewhere**, from straight and at rest:")
        self._copy = gui.add_html("")
        gui.add_markdown(TEXT)

    def update_copies(self) -> None:
        """Update the copy buttons after a change of the scenario."""
        file = write_scenario(self._live.scenario)
        texts = {"copy the command": write_shell(file), "copy the Python": write_python(file)}
        self._copy.content = build_copy_buttons(texts)

    def begin(self) -> None:
        """Restart the ghost together with the simulation."""
        self._ghost_start = self._live.simulation.time
        self._place()

    def play(self, trial: Trial) -> None:
        """Play a trial back from now on, as a ghost.

        Args:
            trial: The trial.

        Raises:
            ValueError: If the trial does not contain the robot's posture.
        """
        self._ghost = Ghost(trial)
        self._set_controls_visible(True)
        self.begin()

    def show(self) -> None:
        """Update the ghost according to the simulation's clock."""
        if self._ghost is None:
            return
        time = max(self._live.simulation.time - self._ghost_start, 0.0)
        self._scene.show_ghost(self._ghost.robot, self._ghost.sample(time))

    @refusing
    def _save(self, event: Any) -> None:
        with hold_at_once(self._writing), tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / SAVED
            self._live.trial().save(path)
            _send_file(event.client, SAVED, path.read_bytes())

    @refusing
    def _send_scenario(self, event: Any) -> None:
        file = write_scenario(self._live.scenario)
        _send_file(event.client, FILE, file.encode())

    @refusing
    def _load(self, event: Any) -> None:
        file = event.target.value
        with hold_at_once(self._reading), tempfile.TemporaryDirectory() as folder:
            ending = Path(file.name).suffix.lower()
            path = Path(folder) / f"uploaded{ending}"
            path.write_bytes(file.content)
            self.play(load_uploaded_trial(path, file.name))

    def _place(self, event: Any = None) -> None:
        """Place the ghost beside the robot, or where it was recorded."""
        if self._ghost is None:
            return
        if not self._beside.value:
            self._ghost.shift[:] = 0.0
            return
        sample = self._live.latest()
        heading = float(sample.heading)
        left = np.array([-np.sin(heading), np.cos(heading)])
        self._ghost.move(sample.center_of_mass[:2] + GAP * left)

    def _remove(self, event: Any) -> None:
        self._ghost = None
        self._scene.remove_ghost()
        self._set_controls_visible(False)

    def _set_controls_visible(self, is_visible: bool) -> None:
        """Show or hide the controls of the ghost."""
        self._beside.visible = is_visible
        self._removal.visible = is_visible


@contextmanager
def hold_at_once(lock: threading.Lock) -> Generator[None]:
    """Hold a lock without waiting for it.

    Raises:
        LaticaudaError: If it is held for another file.
    """
    if not lock.acquire(blocking=False):
        raise LaticaudaError("Another file is being read or written: try again in a moment.")
    try:
        yield
    finally:
        lock.release()


def _send_file(page: Any, name: str, content: bytes) -> None:
    """Send a file to a page that receives what it is sent.

    Raises:
        LaticaudaError: If many messages to it still wait.
    """
    if len(page._websock_connection.get_message_buffer().message_from_id) > MOST_UNSENT:
        raise LaticaudaError("This page has not yet received the files before: wait for them.")
    page.send_file_download(name, content, save_immediately=True)
