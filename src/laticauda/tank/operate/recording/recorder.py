"""Writing a recording of an operation while it runs.

The format is MCAP, which survives if the program is killed. What the estimator and the controller
got is kept bit for bit, in the order in which they got it; the same data are also stored in the
types that Foxglove draws by itself. docs/how-to/recordings.md lists the topics.
"""

import math
from collections import deque
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.control.estimation import Estimate, JointSample, Learned, Learner, PoseSample, Sample
from laticauda.models.spatial import Frames
from laticauda.robot import to_quaternion, turn
from laticauda.tank.operate.drivers.base import Frame
from laticauda.tank.operate.recording.entries import Decision, Entry, Event, PowerReading
from laticauda.tank.operate.recording.header import HEADER, Header
from laticauda.tank.operate.recording.messages import TOPIC_OF, content_of, ros_type_of
from laticauda.trials import logs
from laticauda.values import check_not_negative

CHUNK_DURATION = 0.5
"""Most that is lost if the program is killed [s]."""
POSTURE_INTERVAL = 0.04
"""Time between two postures for viewers [s]."""
RECEIVED_TOPIC = "/can/received"
"""Topic of the raw frames that modules sent."""
SENT_TOPIC = "/can/sent"
"""Topic of our own raw frames."""
LEVELS = {"fault": "error", "rejected": "warning", "changed": "warning"}
"""Levels of events by kind; all others are information."""
NOTES = {"idle_current": "idle", "settling": "initial"}
"""Events whose data are also kept as notes, and the names of the notes."""
NOT_TURNED = (1.0, 0.0, 0.0, 0.0)
"""Quaternion of a body of which only the position is known."""


class OperationRecorder(logs.Recorder):
    """Writer of the recording of one operation; a context manager that any thread may use.

    All times are on one clock and not negative [s].

    Args:
        path: Path of the file; an existing file is never replaced.
        header: What is known at the start; written to disk at once.
        epoch: Wall-clock time at time 0 of that clock [ns since 1970]; 0: unknown.

    Raises:
        StorageFailed: If the file exists, or cannot be written; later, if the disk is full.
        MissingExtra: If the package `mcap` is not installed.
    """

    def __init__(self, path: str | Path, header: Header, *, epoch: int = 0) -> None:
        super().__init__(path, chunk_seconds=CHUNK_DURATION, epoch=epoch)
        self.metadata(HEADER, header.texts())
        robot = header.run.robot
        self._link_frames = Frames(robot)
        self._fin_angle = np.zeros(len(robot.fin_joints))
        self._posture_time = -math.inf
        self.robot(0.0, self._link_frames.description, self._link_frames.fixed)
        body_joints = tuple(f"joint_{i}" for i in range(robot.n_joints))
        self._body_joints = body_joints
        self._driven_joints = (*body_joints, "fin_joint")[: len(robot.driven_joints)]
        self._yaw_joints = tuple(
            name
            for name, joint in zip(body_joints, robot.joints, strict=True)
            if joint.axis == "yaw"
        )

    def record(self, entry: Entry | Frame, *, received: float | None = None) -> None:
        """Record an entry, in the order in which the estimator and the controller got it.

        An event is on disk at once, with everything before it; events of kind `start` and `stop`
        enclose a run. A decision comes after the estimate on which it is based.

        Args:
            entry: A sample, a reading, an estimate, a decision, a tick, an event, or a raw frame of
                the bus.
            received: Time at which a sample arrived; None: when it was taken [s].
        """
        if isinstance(entry, Event):
            content = {"message": entry.message, "data": dict(entry.data)}
            self.event(entry.time, entry.kind, content, level=LEVELS.get(entry.kind, "info"))
            return
        if isinstance(entry, Frame):
            topic = SENT_TOPIC if entry.is_ours else RECEIVED_TOPIC
            self.can_frame(topic, entry.time, entry.identifier, entry.data)
            return
        time = entry.time
        if received is not None:
            time = check_not_negative("received", received, "s")
        entry_class = type(entry)
        self.message(
            TOPIC_OF[entry_class],
            time,
            ros_type_of(entry_class),
            content_of(entry),
            unit="SI",
        )
        self._draw(time, entry)

    def note(self, name: str, content: Mapping[str, str | float]) -> None:
        """Record what was found out on the way, as texts of the whole file.

        For instance, ``note("idle", {"current": 1.18})``.

        Args:
            name: Name of the note.
            content: Numbers and texts by name.
        """
        texts: dict[str, str] = {}
        for key, value in content.items():
            texts[key] = value if isinstance(value, str) else repr(float(value))
        self.metadata(name, texts)

    def _draw(self, time: float, entry: Entry) -> None:
        """Record an entry in the types that a viewer can draw, if there are any."""
        match entry:
            case JointSample():
                self._draw_joints(time, entry)
            case PoseSample() if not entry.is_lost:
                turned = NOT_TURNED
                if entry.rotation is not None:
                    turned = to_quaternion(entry.rotation)
                self.pose("/mocap/body", time, entry.position.tolist(), turned)
            case PowerReading():
                self.scalar("/power/current", time, entry.current, unit="A")
            case Estimate():
                self._draw_estimate(time, entry)
            case Decision():
                for name, value in entry.signals.items():
                    self.scalar(f"/control/{name}", time, value, unit="SI")
            case Learned():
                for name, value in entry.value.items():
                    self.scalar(f"/learned/{name}", time, value, unit="SI")
            case _:
                pass

    def _draw_joints(self, time: float, sample: JointSample) -> None:
        names = self._names_of_joints(sample.angle.size)
        rate = () if sample.rate is None else sample.rate
        torque = () if sample.torque is None else sample.torque
        self.joint_state("/joint_states", time, names, sample.angle, rate, torque)  # pyright: ignore
        has_driven_fin = len(self._driven_joints) > len(self._body_joints)
        if has_driven_fin and names is self._driven_joints:
            self._fin_angle[0] = np.nan_to_num(sample.angle[-1])

    def _names_of_joints(self, n_joints: int) -> tuple[str, ...]:
        """Return the names of as many joints: all driven ones, those of the body, or yaw joints."""
        all_names = (self._driven_joints, self._body_joints, self._yaw_joints)
        return next(names for names in all_names if len(names) == n_joints)

    def _draw_estimate(self, time: float, estimate: Estimate) -> None:
        turned = to_quaternion(turn("yaw", estimate.heading) @ turn("pitch", estimate.pitch))
        position = (*estimate.center_of_mass.tolist(), 0.0)[:3]
        self.pose("/estimate/body", time, position, turned)
        self.scalar("/estimate/heading", time, estimate.heading, unit="rad")
        if time - self._posture_time >= POSTURE_INTERVAL:
            self._posture_time = time
            self.transforms(time, self._posture(estimate))

    def _posture(self, estimate: Estimate) -> dict[str, logs.Frame]:
        """Return the estimated frames of the links; the mean pitch is used for the tail."""
        tail = to_quaternion(turn("yaw", estimate.link_angle[0]) @ turn("pitch", estimate.pitch))
        moving_frames = self._link_frames.compute_moving_frames(
            estimate.center_of_mass[np.newaxis],
            np.array([tail]),
            estimate.joint_angle[np.newaxis],
            self._fin_angle[np.newaxis],
        )
        frames: dict[str, logs.Frame] = {}
        for name, (parent, positions, rotations) in moving_frames.items():
            frames[name] = (parent, positions[0], rotations[0])
        return frames


class Sink:
    """Keeps a record of every tick; if it cannot, `trouble` says why.

    Args:
        recorder: Open recorder; it stays open.
        frames: Whether to keep the raw frames of the bus, which make up most of a recording.
        learner: Learner that learns from the entries, with its results recorded, too; None: nothing
            is learned.
    """

    trouble = ""
    """Why nothing is recorded any more; "" while recording works."""

    def __init__(
        self, recorder: OperationRecorder, *, frames: bool = True, learner: Learner | None = None
    ) -> None:
        self._recorder = recorder
        self._keeps_frames = frames
        self._learner = learner
        self._learner_state: Any = None
        if learner is not None:
            self._learner_state = learner.init()
        self.news = deque[Event]()
        """Events about what was learned and what has changed; whoever shows them removes them."""

    def keep(self, now: float, entries: Sequence[Entry | Frame]) -> None:
        """Record the entries of a tick, in this order; after an error, nothing more is written.

        Args:
            now: Time of the tick [s].
            entries: Its entries, and raw frames of the bus.
        """
        if self.trouble:
            return
        try:
            for entry in entries:
                self._keep_entry(now, entry)
        except Exception as error:
            self.trouble = str(error) or type(error).__name__

    def _keep_entry(self, now: float, entry: Entry | Frame) -> None:
        if self._keeps_frames or not isinstance(entry, Frame):
            self._recorder.record(entry, received=now)
        if isinstance(entry, Event) and entry.kind in NOTES and entry.data:
            self._recorder.note(NOTES[entry.kind], entry.data)
        if self._learner is not None and isinstance(entry, Sample):
            self._learn(self._learner, now, entry)

    def _learn(self, learner: Learner, now: float, sample: Sample) -> None:
        """Record what is learned from a sample.

        An error ends only the learning, because nothing depends on it.
        """
        try:
            self._learner_state = learner.step(self._learner_state, sample)
            learned = self._learner_state.learned
            changes = () if learned is None else learned.changes
        except Exception as error:
            self._learner = None
            learned = None
            changes = (f"Learning has stopped: {error}",)
        news = [Event(time=now, kind="changed", message=change) for change in changes]
        if learned is not None:
            self._recorder.record(learned, received=now)
        for event in news:
            self._recorder.record(event, received=now)
        if learned is not None:
            news.insert(0, Event(time=now, kind="learned", message=learned.line))
        self.news.extend(news)
