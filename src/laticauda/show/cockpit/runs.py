"""Runs as files: saving the current one, playing back a stored one as a ghost, and repeating the current scenario."""

import contextlib
import json
import os
import subprocess
import sys
import tempfile
import threading
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from laticauda import robot, scenarios
from laticauda.show.cockpit.live import Live
from laticauda.show.cockpit.pages import refusing
from laticauda.show.cockpit.scene import Scene
from laticauda.tank import operate
from laticauda.tank.operate.recording.header import HEADER
from laticauda.trials import Format, Trial, logs
from laticauda.values import series
from laticauda.values.errors import LaticaudaError, TrialFileError

READ = tuple(ending for ending in Format.endings() if ending != ".csv")
SAVED = "cockpit-run.nc"
GAP = 0.5  # from the robot to a ghost next to it, to the left of the robot's heading [m]
BESIDE = "The ghost begins beside the robot; otherwise, where it was recorded"
DURATION = 30.0  # [s]
SECONDS = 60.0  # time limit for reading an uploaded file
ROOM = 2 << 30  # memory limit for reading it [bytes]
SHARE = 8  # ROOM / SHARE is the limit of the converted file, and thus of this process
REFUSED = 3  # exit status
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}  # each thread reserves memory
FILE = "scenario.toml"
COMMAND = f"laticauda swim {FILE}"
PYTHON = "trial = lc.swim(scenario)\nprint(trial.forward_velocity, trial.mean_power)"
_TEXT = Path(__file__).with_name("elsewhere.md").read_text().strip()
TEXT = _TEXT.replace("COMMAND", COMMAND).replace("PYTHON", PYTHON).replace("FILE", FILE)
"""Explanation on the page, as Markdown."""
STYLE = Path(__file__).with_name("copy.css").read_text().strip()
SCRIPT = "".join(Path(__file__).with_name("copy.js").read_text().splitlines()[2:])


class Ghost:
    """A stored trial that is played back in a loop.

    Args:
        trial: The trial.

    Raises:
        ValueError: If the trial does not contain the robot's posture.
    """

    def __init__(self, trial: Trial) -> None:
        trial.need("a picture of the robot", "joint_angle", "heading", "link_angle")
        self.shift = np.zeros(trial.center_of_mass.shape[1])
        """Offset of the ghost from its recorded position [m]."""
        self.robot: robot.Robot = trial.chain
        self._trial = trial
        if trial.center_of_mass.shape[1] == 3 and "orientation_w" not in trial.signals:
            raise ValueError("The trial must hold the robot's orientation in space to be shown.")

    def move(self, place: np.ndarray) -> None:
        """Shift the ghost so that it begins at a given position [m]."""
        self.shift[:2] = place[:2] - self._trial.center_of_mass[0, :2]

    def sample(self, time: float) -> series.Log:
        """Return the sample at a time since the beginning [s]; after its end, the trial repeats."""
        trial = self._trial
        within = float(trial.time[0]) + (time % trial.duration if trial.duration > 0.0 else 0.0)
        before: int = np.searchsorted(trial.time, within).item()
        i = min(before, trial.time.size - 1)
        found = trial.at(i)
        return replace(found, center_of_mass=found.center_of_mass + self.shift)


class Runs:
    """Controls for saving, playing back and repeating runs.

    Args:
        gui: GUI of the page's server; the controls are added at its current position.
        live: The simulation that is saved.
        scene: The scene in which the ghost swims.
    """

    def __init__(self, gui: Any, live: Live, scene: Scene) -> None:
        self._live, self._scene = live, scene
        self._ghost: Ghost | None = None
        self._since = 0.0
        self._reading = threading.Lock()
        hint = "The run since the setting was last changed, at most ten minutes of it, as a netCDF file"
        gui.add_button("save the run", hint=hint).on_click(self._save)
        hint = f"Robot, gait and water, from where the robot first began, as {FILE}"
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
        """Update the copy buttons after a change of the scenario."""
        file = scenario_file(self._live.scenario)
        self._copy.content = copy_buttons(
            {"copy the command": in_shell(file), "copy the Python": in_python(file)}
        )

    def begin(self) -> None:
        """Restart the ghost together with the simulation."""
        self._since = self._live.simulation.time
        self._place()

    def play(self, trial: Trial) -> None:
        """Play a trial back from now on, as a ghost.

        Raises:
            ValueError: If the trial does not contain the robot's posture.
        """
        self._ghost = Ghost(trial)
        self._beside.visible = self._away.visible = True
        self.begin()

    def show(self) -> None:
        """Update the ghost according to the simulation's clock."""
        ghost = self._ghost
        if ghost is not None:
            self._scene.ghost(
                ghost.robot, ghost.sample(max(self._live.simulation.time - self._since, 0.0))
            )

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
        with self._reading, tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"uploaded{Path(file.name).suffix.lower()}"
            path.write_bytes(file.content)
            self.play(foreign_trial(path, file.name))

    def _place(self, event: Any = None) -> None:
        """Place the ghost beside the robot, or where it was recorded."""
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


def stored_trial(path: Path, name: str) -> Trial:
    """Load the trial, or the run of a recorded operation, from a file.

    Args:
        path: The file.
        name: Name of the file in messages.

    Raises:
        TrialFileError: If the file is neither; the message gives the reason.
        MissingExtra: If the format needs a package that is not installed.
    """
    if not path.exists():
        raise TrialFileError(f"Cannot load {name}: there is no such file.")
    if path.suffix not in READ:
        raise TrialFileError(f"Cannot load {name}: a trial file ends in one of {', '.join(READ)}.")
    try:
        if path.suffix == ".mcap" and HEADER in logs.open_recording(path).metadata:
            return operate.trial_of(operate.read_operation(path))
        return logs.load_trial(path)
    except TrialFileError as error:
        raise TrialFileError(str(error).replace(str(path), name)) from error


def foreign_trial(path: Path, name: str) -> Trial:
    """Load an uploaded file as `stored_trial` does; another process reads it first, and converts it to one of ours.

    The readers of HDF5, zip and other formats are not designed for malicious files. The process is
    limited to `SECONDS` and, where the system supports such a limit, to `ROOM` bytes of memory.

    Args:
        path: The file, in a separate folder.
        name: Name of the file in messages.

    Raises:
        TrialFileError: If it is not such a file, or cannot be read within the limits; the message
            gives the reason.
    """
    read = path.with_name("read.nc")
    code = f"from {__name__} import hand_on; hand_on()"
    words = [sys.executable, "-P", "-c", code, *map(str, (path, read, name, ROOM))]
    own = os.environ | ONE_THREAD
    try:
        done = subprocess.run(
            words, stdin=subprocess.DEVNULL, capture_output=True, timeout=SECONDS, env=own
        )
    except subprocess.TimeoutExpired:
        raise TrialFileError(
            f"Cannot load {name}: reading it takes longer than {SECONDS:g} s."
        ) from None
    if done.returncode == REFUSED:
        raise TrialFileError(done.stderr.decode(errors="replace"))
    if done.returncode:
        raise TrialFileError(
            f"Cannot load {name}: its reader ended at once, or exceeded {ROOM >> 20} MiB."
        )
    return stored_trial(read, name)


def hand_on() -> None:
    """Run in that process; its command line contains the two files, the name, and the memory limit."""
    source, target, name, room = sys.argv[1:]
    with contextlib.suppress(ImportError):  # not available on Windows
        import resource

        for limited, most in (
            (resource.RLIMIT_AS, int(room)),
            (resource.RLIMIT_FSIZE, int(room) // SHARE),
        ):
            resource.setrlimit(limited, (most, most))
    try:
        stored_trial(Path(source), name).save(target)
    except (ValueError, LaticaudaError) as error:
        bytes(
            1 << 24
        )  # HDF5 reports a file as damaged when out of memory; then this allocation ends the process
        sys.stderr.write(str(error))
        sys.exit(REFUSED)


def _send(event: Any, name: str, content: bytes) -> None:
    event.client.send_file_download(name, content, save_immediately=True)


# ---- the same run elsewhere ----------------------------------------------------------------------


def scenario_file(scenario: scenarios.Scenario) -> str:
    """Return the content of the scenario file: everything that determines the run, for `DURATION`.

    Args:
        scenario: The scenario.
    """
    return scenarios.run_to_toml(replace(scenario, duration=DURATION))


def in_shell(file: str) -> str:
    """Return shell commands that write the scenario file and run it.

    Args:
        file: The content of the scenario file.
    """
    return f"cat > {FILE} <<'END'\n{file}END\n{COMMAND}\n"


def in_python(file: str) -> str:
    """Return a script that runs the scenario without any file; its `trial` is the run.

    Args:
        file: The content of the scenario file.
    """
    imports = "import laticauda as lc\nfrom laticauda.scenarios import run_from_toml"
    return f"{imports}\n\nscenario = run_from_toml(r'''\n{file}''')\n{PYTHON}\n"


def copy_buttons(texts: dict[str, str]) -> str:
    """Return buttons, as HTML, that copy a text to the clipboard of the page's user, which the server cannot do.

    Args:
        texts: Texts to copy, by the labels of their buttons.
    """
    return (
        "<div style='padding:0.3em 0.8em'>"
        + "".join(map(_button, texts, texts.values()))
        + "</div>"
    )


def _button(label: str, text: str) -> str:
    script = escape(SCRIPT.format(text=json.dumps(text)), quote=True)
    return f'<button type="button" style="{STYLE}" onclick="{script}">{escape(label)}</button>'
