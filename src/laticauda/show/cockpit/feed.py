"""What the recording of an operation says about the robot, while the recording is being written."""

import math
import time
from collections import deque
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.tank.operate import Header
from laticauda.tank.operate.recording import log, recorder
from laticauda.trials import logs
from laticauda.values import TrialFileError

if TYPE_CHECKING:
    from laticauda.control.estimation import Estimate

SPAN = 5.0
"""Duration over which the speed is computed, and how much of the past is read [s]."""
SILENT = 2.0
"""A recording to which nothing is written for this long has stopped [s]."""
TOPICS = ("/estimate", "/sample/joints", "/events")
N_EVENTS = 3
"""Number of events that are shown."""


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
        self.events = deque[str](maxlen=N_EVENTS)
        """Latest events, in sentences."""
        self._recording: logs.Recording | None = None
        self._estimates = deque["Estimate"]()

    def update(self) -> str:
        """Read new entries; return what is wrong, in a sentence, or "".

        The picture lags by `recorder.CHUNK_DURATION`, so that it moves as steadily as the robot does.
        """
        try:
            written_at = self._read_entries()
        except (OSError, TrialFileError) as error:
            return str(error)
        if written_at is None:
            return f"There is no recording of an operation in {self.place} yet."
        if not self._estimates:
            return "The robot has not been seen yet."
        age = time.time() - written_at
        newest = self._estimates[-1].time
        chunk = recorder.CHUNK_DURATION
        self._show_estimate_at(newest - chunk + min(age, chunk))
        if age > SILENT:
            return f"Nothing has been written for {age:.0f} s: the last position is shown."
        return ""

    def _read_entries(self) -> float | None:
        """Read new entries of the newest recording; return when it was last written to, None without one [s]."""
        newest = self._find_newest()
        if newest is None:
            return None
        if self._recording is None or newest != self._recording.path:
            recording = logs.open_recording(newest)
            self._begin(recording)
        else:
            recording = self._recording
        for logged in recording.more(*TOPICS, since=recording.stop - SPAN):
            self._take_entry(logged.topic, log.entry_of(logged))
        return newest.stat().st_mtime

    def _find_newest(self) -> Path | None:
        """Return the newest recording, if there is one."""
        recordings = [self.place]
        if self.place.is_dir():
            recordings = list(self.place.glob("*.mcap"))
        if not recordings:
            return None
        return max(recordings, key=_written_at)

    def _begin(self, recording: logs.Recording) -> None:
        """Begin to read another recording."""
        self._recording = recording
        self.header = log.header_in(recording)
        self.estimate = None
        self._estimates.clear()
        self.events.clear()

    def _take_entry(self, topic: str, entry: Any) -> None:
        if topic == "/estimate":
            self._estimates.append(entry)
        elif topic == "/sample/joints":
            n_joints = 0
            if self.header is not None:
                n_joints = self.header.run.robot.n_joints
            fin_angles = entry.angle[n_joints:]
            self.fin_angle = float(np.nan_to_num(fin_angles).sum())
        elif entry.kind != "phase":
            self.events.append(entry.message)

    def _show_estimate_at(self, moment: float) -> None:
        """Set estimate and speed to those at a moment, and forget what is older than `SPAN` [s]."""
        shown = _last_until(moment, self._estimates)
        self.estimate = self._estimates[shown]
        while self.estimate.time - self._estimates[0].time > SPAN:
            self._estimates.popleft()
        first = self._estimates[0]
        duration = self.estimate.time - first.time
        self.speed = math.nan
        if duration > 0.5 * SPAN:
            displacement = self.estimate.center_of_mass - first.center_of_mass
            self.speed = float(np.linalg.norm(displacement)) / duration


def _written_at(path: Path) -> float:
    """Return when a file was last written to [s]."""
    return path.stat().st_mtime


def _last_until(moment: float, estimates: Sequence["Estimate"]) -> int:
    """Return the index of the last estimate up to a moment [s]; 0 if all are later."""
    last = 0
    for index, estimate in enumerate(estimates):
        if estimate.time <= moment:
            last = index
    return last
