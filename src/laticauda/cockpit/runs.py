"""Runs as files: the present one saved, a stored one played back as a ghost, and how to repeat what swims."""

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.cockpit.commands import FILE, TEXT, copy_buttons, in_python, in_shell, scenario_file
from laticauda.cockpit.events import refusing
from laticauda.cockpit.files import READ, received_trial
from laticauda.cockpit.live import Live
from laticauda.cockpit.scene import Scene
from laticauda.robot import Robot
from laticauda.series import Log
from laticauda.trial import Trial

SAVED = "cockpit-run.nc"
GAP = 0.5  # from the robot to a ghost beside it, to the left of where that heads [m]
BESIDE = "It begins beside the robot; else it is where it was when it was recorded"


class Ghost:
    """A stored trial that is played back again and again.

    Args:
        trial: The trial.

    Raises:
        ValueError: If it does not say how the robot was bent.
    """

    def __init__(self, trial: Trial) -> None:
        trial.need("a picture of the robot", "joint_angle", "heading", "link_angle")
        self.shift = np.zeros(trial.center_of_mass.shape[1])
        """By which it is shown beside its place [m]."""
        self.robot: Robot = trial.robot if trial.center_of_mass.shape[1] == 3 else trial.robot.planar()
        self._trial = trial
        if trial.center_of_mass.shape[1] == 3 and "orientation_w" not in trial.signals:
            raise ValueError("The trial must say which way the robot was turned in space, to be shown.")

    def move(self, place: np.ndarray) -> None:
        """Show it so that it begins at a place [m]."""
        self.shift[:2] = place[:2] - self._trial.center_of_mass[0, :2]

    def sample(self, time: float) -> Log:
        """The sample at a time since its begin; after its end it begins anew [s]."""
        trial = self._trial
        within = float(trial.time[0]) + (time % trial.duration if trial.duration > 0.0 else 0.0)
        before: int = np.searchsorted(trial.time, within).item()
        i = min(before, trial.time.size - 1)
        found = trial.at(i)
        return replace(found, center_of_mass=found.center_of_mass + self.shift)


class Runs:
    """The controls for all of it.

    Args:
        gui: Of the page's server; the controls go where it is.
        live: What is saved.
        scene: Where the ghost swims.
    """

    def __init__(self, gui: Any, live: Live, scene: Scene) -> None:
        self._live, self._scene = live, scene
        self._ghost: Ghost | None = None
        self._since = 0.0
        hint = "The run since the setting was last changed, at most ten minutes of it, as a netCDF file"
        gui.add_button("save the run", hint=hint).on_click(self._save)
        hint = f"What swims, how and where, from where it first began, as {FILE}"
        gui.add_button("download the scenario", hint=hint).on_click(self._send_scenario)
        hint = f"A saved run, or the recording of an operation ({', '.join(READ)}), as a ghost"
        upload = gui.add_upload_button("play back a trial", hint=hint)
        upload.on_upload(self._load)
        self._beside = gui.add_checkbox("ghost beside the robot", True, visible=False, hint=BESIDE)
        self._beside.on_update(self._place)
        self._away = gui.add_button("remove the ghost", visible=False)
        self._away.on_click(self._remove)
        gui.add_markdown("**The same run elsewhere**, from straight and at rest:")
        self._copy = gui.add_html("")
        gui.add_markdown(TEXT)

    def changed(self) -> None:
        """After every change of the scenario."""
        file = scenario_file(self._live.scenario)
        self._copy.content = copy_buttons({"copy the command": in_shell(file), "copy the Python": in_python(file)})

    def begin(self) -> None:
        """Let the ghost begin anew, with the simulation."""
        self._since = self._live.simulation.time
        self._place()

    def play(self, trial: Trial) -> None:
        """Play a trial back from now on, as a ghost.

        Raises:
            ValueError: If it does not say how the robot was bent.
        """
        self._ghost = Ghost(trial)
        self._beside.visible = self._away.visible = True
        self.begin()

    def show(self) -> None:
        """Bring the ghost up to date, by the simulation's clock."""
        ghost = self._ghost
        if ghost is not None:
            self._scene.ghost(ghost.robot, ghost.sample(max(self._live.simulation.time - self._since, 0.0)))

    @refusing
    def _save(self, event: Any) -> None:
        trial = self._live.trial()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / SAVED
            trial.save(path)
            _send(event, SAVED, path.read_bytes())

    def _send_scenario(self, event: Any) -> None:
        _send(event, FILE, scenario_file(self._live.scenario).encode())

    @refusing
    def _load(self, event: Any) -> None:
        file = event.target.value
        self.play(received_trial(file.name, file.content))

    def _place(self, event: Any = None) -> None:
        """Beside the robot, or where it was."""
        ghost = self._ghost
        if ghost is None:
            return
        if not self._beside.value:
            ghost.shift[:] = 0.0
            return
        now = self._live.latest()
        heading = float(now.heading)
        ghost.move(now.center_of_mass[:2] + GAP * np.array([-np.sin(heading), np.cos(heading)]))

    def _remove(self, event: Any) -> None:
        self._ghost = None
        self._scene.ghost(None)
        self._beside.visible = self._away.visible = False


def _send(event: Any, name: str, content: bytes) -> None:
    event.client.send_file_download(name, content, save_immediately=True)
