"""A robot that somebody else operates, shown from the operation's recording as it is written; nothing is sent."""

import math
import time
from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.scenarios import interfaces
from laticauda.show.cockpit import shapes
from laticauda.show.cockpit.scene import Body, Scene, Trail
from laticauda.tank.operate import Header
from laticauda.tank.operate.recording import log, recorder
from laticauda.trials import logs
from laticauda.values import series
from laticauda.values.errors import TrialFileError

if TYPE_CHECKING:
    from laticauda.control.estimation import Estimate

TRAIL: shapes.Color = (250, 120, 80)
SPAN = 5.0  # over which the speed is computed, and how much of the past is read [s]
SILENT = 2.0  # a recording to which nothing is written for this long has stopped [s]
TOPICS = ("/estimate", "/sample/joints", "/events")
LINES = 3  # number of events that are shown


class Feed:
    """Content of an operation's recording while it is being written.

    Args:
        place: The recording, or a folder whose newest recording is read, even if it is started
            later.
    """

    def __init__(self, place: Path) -> None:
        self.place = place
        self.header: Header | None = None
        """Header of the current recording; None before there is one."""
        self.estimate: Estimate | None = None
        """Estimate of where the robot is; None until it is known."""
        self.speed = math.nan
        """Speed over the last `SPAN` [m/s]."""
        self.fin_angle = 0.0
        """Angle of a driven fin [rad]."""
        self.events = deque[str](maxlen=LINES)
        """Latest events, in sentences."""
        self._recording: logs.Recording | None = None
        self._estimates = deque["Estimate"]()

    def look(self) -> str:
        """Read new entries; return what is wrong, in a sentence, or "".

        The picture lags by `recorder.CHUNK_DURATION`, so that it moves as steadily as the robot does.
        """
        try:
            written = self._follow()
        except (OSError, TrialFileError) as error:
            return str(error)
        if written is None or not self._estimates:
            none = f"There is no recording of an operation in {self.place} yet."
            return none if written is None else "The robot has not been seen yet."
        age = time.time() - written
        moment = (
            self._estimates[-1].time - recorder.CHUNK_DURATION + min(age, recorder.CHUNK_DURATION)
        )
        shown = max((k for k, one in enumerate(self._estimates) if one.time <= moment), default=0)
        while self._estimates[shown].time - self._estimates[0].time > SPAN:
            shown -= 1
            self._estimates.popleft()
        self.estimate, then = self._estimates[shown], self._estimates[0]
        gone, way = (
            self.estimate.time - then.time,
            self.estimate.center_of_mass - then.center_of_mass,
        )
        self.speed = float(np.linalg.norm(way)) / gone if gone > 0.5 * SPAN else math.nan
        return (
            f"Nothing has been written for {age:.0f} s: the last position is shown."
            if age > SILENT
            else ""
        )

    def _follow(self) -> float | None:
        """Read new entries of the newest recording; return when it was last written to, None without one [s]."""
        found = [*self.place.glob("*.mcap")] if self.place.is_dir() else [self.place]
        if not found:
            return None
        newest = max(found, key=lambda path: path.stat().st_mtime)
        if self._recording is None or newest != self._recording.path:
            self._recording = logs.open_recording(newest)
            self.header = log.header_in(self._recording)
            self.estimate = None
            self._estimates.clear()
            self.events.clear()
        n = self.header.run.robot.n_joints if self.header else 0
        for logged in self._recording.more(*TOPICS, since=self._recording.stop - SPAN):
            entry: Any = log.entry_of(logged)
            if logged.topic == "/estimate":
                self._estimates.append(entry)
            elif logged.topic == "/sample/joints":
                self.fin_angle = float(np.nan_to_num(entry.angle[n:]).sum())
            elif entry.kind != "phase":
                self.events.append(entry.message)
        return newest.stat().st_mtime


class OperatedRobot:
    """Picture of an operated robot, and the text next to it.

    Args:
        gui: GUI of the page's server; the controls are added at its current position.
        pictures: Scene of the same server.
        scene: The scene with the simulated robot.
    """

    def __init__(self, gui: Any, pictures: Any, scene: Scene) -> None:
        self._scene = scene
        self._feed: Feed | None = None
        self._header: Header | None = None
        self._body = Body(pictures, "operated")
        self._trail = Trail(pictures, "/operated trail", TRAIL)
        gui.add_markdown(
            "The robot that `laticauda operate` moves, as recorded; read-only. "
            "`laticauda cockpit --operated FOLDER` shows the newest one in a folder."
        )
        self._alone = gui.add_checkbox("hide the simulated robot", True)
        self._text = gui.add_markdown("")

    def watch(self, place: Path) -> None:
        """Show the recording at a `place`, or the newest in a folder, from now on."""
        self._feed = Feed(place)

    def show(self, *, with_text: bool) -> np.ndarray | None:
        """Update the picture; return the position of the robot, or None if it is unknown [m].

        Args:
            with_text: Whether to also update the numbers and extend the trail.
        """
        if self._feed is None:
            return None
        trouble = self._feed.look()
        estimate, header = self._feed.estimate, self._feed.header
        if estimate is None or header is None:
            if with_text:
                self._text.content = f"**{trouble}**"
            return None
        robot = header.run.robot.planar()
        self._body.show(robot, _sample(estimate, self._feed.fin_angle))
        self._scene.set_visible(not self._alone.value)
        if with_text:
            if header is not self._header:  # another run
                self._header = header
                self._trail.forget()
            self._trail.grow(estimate.center_of_mass)
            self._trail.draw()
            self._text.content = self._numbers(self._feed, estimate, trouble)
        return estimate.center_of_mass

    @staticmethod
    def _numbers(feed: Feed, estimate: "Estimate", trouble: str) -> str:
        """Return position, speed, latest events and what is wrong, as Markdown."""
        place, speed = estimate.center_of_mass, feed.speed
        rows = [
            ("place", f"{place[0]:z.2f}, {place[1]:z.2f} m"),
            ("heading", f"{math.degrees(estimate.heading):z.1f} deg"),
            (f"speed over {SPAN:g} s", f"{speed:.3f} m/s" if math.isfinite(speed) else "..."),
            (
                "joints",
                f"up to {math.degrees(float(np.max(np.abs(estimate.joint_angle), initial=0.0))):.0f} deg",
            ),
        ]
        rows += [("fin", f"{math.degrees(feed.fin_angle):z.0f} deg")] if feed.fin_angle else []
        lines = [
            f"| {estimate.status} | |",
            "|:--|--:|",
            *(f"| {name} | **{value}** |" for name, value in rows),
            "",
        ]
        lines += [f"- {event}" for event in feed.events]
        return "\n".join(lines) + (f"\n\n**{trouble}**" if trouble else "")


def _sample(estimate: "Estimate", fin_angle: float) -> series.Log:
    """Convert an estimate to a sample to draw, without motor data, but with the angle of a driven fin [rad]."""
    names = [
        name
        for name in interfaces.Observation.__dataclass_fields__
        if name in series.Log.__dataclass_fields__
    ]
    known: dict[str, Any] = {name: np.asarray(getattr(estimate, name)) for name in names}
    known |= {name: known[name][:2] for name in ("center_of_mass", "center_of_mass_velocity")}
    nothing = np.zeros_like(estimate.joint_angle)
    fin = {"fin_angle_0": np.asarray(fin_angle)}
    return series.Log(
        **known, joint_angle_ref=nothing, joint_torque=nothing, work=np.zeros(3), signals=fin
    )
