"""One file for everything that happens while a robot is operated: MCAP, which survives that the program is killed.

What the estimator and the controller got is kept bit for bit, in the order in which they got it; beside it stands the
same in the types that Foxglove draws by itself. docs/how-to/recordings.md lists the topics. In real time, a thread
writes what the loop hands over, so that no disk makes it late.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from laticauda import logs
from laticauda.errors import not_negative
from laticauda.estimation import Estimate, JointSample, PoseSample
from laticauda.kinematics import to_quaternion, turn
from laticauda.operate.drivers.can import Frame
from laticauda.operate.recording import entries
from laticauda.operate.recording.entries import Decision, Entry, Event, PowerReading
from laticauda.operate.recording.header import HEADER, Header

CHUNK = 0.5  # what is lost at most when the program is killed [s]
RECEIVED, SENT = "/can/received", "/can/sent"
LEVELS = {"fault": "error", "rejected": "warning"}
NOTES = {"idle_current": "idle", "settling": "initial"}
"""Events whose data are noted, too, and under which name."""


class OperationRecorder(logs.Recorder):
    """Writes the recording of one operation; a context manager, and any thread may write.

    Times are those of one clock, not negative [s].

    Args:
        path: The file; an older one is never replaced.
        header: What is known at the start; it is on disk at once.

    Raises:
        StorageFailed: If the file exists, or cannot be written; later, if the disk is full.
        MissingExtra: If the package `mcap` is not installed.
    """

    def __init__(self, path: str | Path, header: Header) -> None:
        super().__init__(path, chunk_seconds=CHUNK)
        self.metadata(HEADER, header.texts())
        robot = header.run.robot
        self._joints = tuple(f"joint_{i}" for i in range(robot.n_joints))
        self._driven = (*self._joints, "fin_joint")[: len(robot.driven_joints)]
        self._yaw = tuple(f"joint_{i}" for i, joint in enumerate(robot.joints) if joint.axis == "yaw")

    def record(self, entry: Entry | Frame, *, received: float | None = None) -> None:
        """What happened, in the order in which the estimator and the controller got it.

        What came before an event is on disk after it; those of kind `start` and `stop` enclose a run. A decision comes
        after the estimate that it was made on.

        Args:
            entry: A sample, a reading, an estimate, a decision, a tick, an event, or a raw frame of the bus.
            received: When a sample came; None: when it was taken [s].
        """
        if isinstance(entry, Event):
            content = {"message": entry.message, "data": dict(entry.data)}
            self.event(entry.time, entry.kind, content, level=LEVELS.get(entry.kind, "info"))
        elif isinstance(entry, Frame):
            self.can_frame(SENT if entry.is_ours else RECEIVED, entry.time, entry.identifier, entry.data)
        else:
            time, kind = entry.time if received is None else not_negative("received", received, "s"), type(entry)
            self.message(entries.TOPIC_OF[kind], time, entries.kind_of(kind), entries.content_of(entry), unit="SI")
            self._draw(time, entry)

    def _draw(self, time: float, entry: Entry) -> None:
        """The same, as far as a viewer can draw it."""
        match entry:
            case JointSample():
                names = next(n for n in (self._driven, self._joints, self._yaw) if entry.angle.size == len(n))
                rate, torque = (() if value is None else value for value in (entry.rate, entry.torque))
                self.joint_state("/joint_states", time, names, entry.angle, rate, torque)  # pyright: ignore
            case PoseSample() if not entry.is_lost:
                turned = (1.0, 0.0, 0.0, 0.0) if entry.rotation is None else to_quaternion(entry.rotation)
                self.pose("/mocap/body", time, entry.position.tolist(), turned)
            case PowerReading():
                self.scalar("/power/current", time, entry.current, unit="A")
            case Estimate():
                turned = to_quaternion(turn("yaw", entry.heading) @ turn("pitch", entry.pitch))
                self.pose("/estimate/body", time, (*entry.center_of_mass.tolist(), 0.0)[:3], turned)
                self.scalar("/estimate/heading", time, entry.heading, unit="rad")
            case Decision():
                for name, value in entry.signals.items():
                    self.scalar(f"/control/{name}", time, value, unit="SI")
            case _:
                pass

    def note(self, name: str, content: Mapping[str, str | float]) -> None:
        """What was found out on the way, as texts of the whole file; ``note("idle", {"current": 1.18})``.

        Args:
            name: What it is about.
            content: Numbers and texts by name.
        """
        texts = {key: value if isinstance(value, str) else repr(float(value)) for key, value in content.items()}
        self.metadata(name, texts)


class Sink:
    """Keeps a record of every tick, and says by `trouble` if it cannot.

    Args:
        recorder: Open; it stays open.
        frames: Whether the raw frames of the bus are kept, which are most of a recording.
        thread: What writes; None: at once, for operations without a clock.
    """

    trouble = ""
    """Why nothing is recorded any more; "" as long as it is."""

    def __init__(
        self, recorder: OperationRecorder, *, frames: bool = True, thread: ThreadPoolExecutor | None = None
    ) -> None:
        self._recorder, self._frames, self._thread = recorder, frames, thread

    def keep(self, now: float, found: Sequence[Entry | Frame]) -> None:
        """Keep what a tick at `now` [s] `found`, in this order; after an error, nothing more is written."""
        if self._thread is None:
            self._write(now, found)
        elif not self.trouble:
            self._thread.submit(self._write, now, found)

    def _write(self, now: float, found: Sequence[Entry | Frame]) -> None:
        if self.trouble:
            return
        try:
            for entry in found:
                if self._frames or not isinstance(entry, Frame):
                    self._recorder.record(entry, received=now)
                if isinstance(entry, Event) and entry.kind in NOTES and entry.data:
                    self._recorder.note(NOTES[entry.kind], entry.data)
        except Exception as error:
            self.trouble = str(error) or type(error).__name__
