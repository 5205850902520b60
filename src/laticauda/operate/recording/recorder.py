"""One file for everything that happens while a robot is operated: MCAP, which survives that the program is killed.

What the estimator and the controller got is kept bit for bit, in the order in which they got it; beside it stands the
same in the types that Foxglove draws by itself. docs/how-to/recordings.md lists the topics. In real time, a thread
writes what the loop hands over, so that no disk makes it late.
"""

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from laticauda import codec, estimation, interfaces, logs
from laticauda.errors import not_negative
from laticauda.kinematics import to_quaternion, turn
from laticauda.operate.course.state import OperatorState, Outputs
from laticauda.operate.drivers.can import Frame
from laticauda.operate.recording import entries
from laticauda.operate.recording.entries import Event, Measurement, PowerReading, Tick
from laticauda.operate.recording.header import HEADER, Header

CHUNK = 0.5  # what is lost at most when the program is killed [s]
COMMAND = "/command"
RECEIVED, SENT = "/can/received", "/can/sent"
LEVELS = {"fault": "error", "rejected": "warning"}


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

    def sample(self, sample: Measurement, *, received: float | None = None) -> None:
        """What came in, in the order in which the estimator got it.

        Args:
            sample: A sample or a reading.
            received: When it came; None: when it was taken [s].
        """
        time = sample.time if received is None else not_negative("received", received, "s")
        self._entry(time, sample)
        if isinstance(sample, estimation.JointSample):
            names = next(n for n in (self._driven, self._joints, self._yaw) if sample.angle.size == len(n))
            rate, torque = (() if value is None else value for value in (sample.rate, sample.torque))
            self.joint_state("/joint_states", time, names, sample.angle, rate, torque)  # pyright: ignore
        elif isinstance(sample, estimation.PoseSample) and not sample.is_lost:
            turned = (1.0, 0.0, 0.0, 0.0) if sample.rotation is None else to_quaternion(sample.rotation)
            self.pose("/mocap/body", time, sample.position.tolist(), turned)
        elif isinstance(sample, PowerReading):
            self.scalar("/power/current", time, sample.current, unit="A")

    def estimate(self, estimate: estimation.Estimate) -> None:
        """An `estimate` of where the robot was."""
        time = estimate.time
        self._entry(time, estimate)
        x, y, z = (*estimate.center_of_mass.tolist(), 0.0)[:3]
        turned = to_quaternion(turn("yaw", estimate.heading) @ turn("pitch", estimate.pitch))
        self.pose("/estimate/body", time, (x, y, z), turned)
        self.scalar("/estimate/heading", time, estimate.heading, unit="rad")

    def _entry(self, time: float, entry: Measurement | estimation.Estimate | Tick) -> None:
        kind = type(entry)
        self.message(entries.TOPIC_OF[kind], time, entries.kind_of(kind), entries.content_of(entry), unit="SI")

    def command(self, time: float, command: interfaces.Command, signals: Mapping[str, float] | None = None) -> None:
        """What a controller decided.

        Args:
            time: Of the estimate that it decided on; that estimate is recorded before [s].
            command: Its decision.
            signals: Its signals, by name.
        """
        content = {"time": time, "command": codec.encode(command), "signals": dict(signals or {})}
        self.json(COMMAND, time, content)
        for name, value in (signals or {}).items():
            self.scalar(f"/control/{name}", time, value, unit="SI")

    def tick(self, tick: Tick) -> None:
        """When a `tick` of the loop was due, when it began, and when its last frame was sent."""
        self._entry(tick.began, tick)

    def can(self, time: float, identifier: int, data: bytes, *, sent: bool = False) -> None:
        """A raw frame of the bus.

        Args:
            time: When [s].
            identifier: 11 bits.
            data: Up to 8 bytes.
            sent: Whether it is ours.
        """
        self.can_frame(SENT if sent else RECEIVED, time, identifier, data)

    def happened(self, event: Event) -> None:
        """An `event`; what came before it is on disk after this. Those of kind `start` and `stop` enclose a run."""
        content = {"message": event.message, "data": dict(event.data)}
        self.event(event.time, event.kind, content, level=LEVELS.get(event.kind, "info"))

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

    def tick(self, state: OperatorState, outputs: Outputs, frames: tuple[Frame, ...], tick: Tick | None) -> None:
        """Keep one tick: the state after it, what went out, the frames of the bus, both ways, and when it was.

        After an error, nothing more is written.
        """
        if self._thread is None:
            self._keep(state, outputs, frames, tick)
        elif not self.trouble:
            self._thread.submit(self._keep, state, outputs, frames, tick)

    def _keep(self, state: OperatorState, outputs: Outputs, frames: tuple[Frame, ...], tick: Tick | None) -> None:
        if self.trouble:
            return
        try:
            self._write(state, outputs, frames if self._frames else (), tick)
        except Exception as error:
            self.trouble = str(error) or type(error).__name__

    def _write(self, state: OperatorState, outputs: Outputs, frames: tuple[Frame, ...], tick: Tick | None) -> None:
        recorder, now = self._recorder, state.now
        assert now is not None  # it was a tick
        for frame in frames:
            recorder.can(frame.time, frame.identifier, frame.data, sent=frame.is_ours)
        for sample in outputs.samples:
            recorder.sample(sample, received=now)
        if outputs.estimate is not None:
            recorder.estimate(outputs.estimate)
            if outputs.command is not None:
                recorder.command(outputs.estimate.time, outputs.command, outputs.signals)
        if tick is not None:
            recorder.tick(tick)
        for event in outputs.events:
            recorder.happened(event)
            if event.kind == "idle_current" and "current" in event.data:
                recorder.note("idle", event.data)
            if event.kind == "settling" and "heading" in event.data:
                recorder.note("initial", event.data)
