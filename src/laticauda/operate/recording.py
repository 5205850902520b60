"""One file for everything that happens while a robot is operated: MCAP, which survives that the program is killed.

What the estimator and the controller got is kept bit for bit, in the order in which they got it; beside it stands the
same in the types that Foxglove draws by itself. docs/how-to/recordings.md lists the topics.
"""

import dataclasses
import json
import math
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from laticauda.errors import instance, not_negative, positive
from laticauda.gaits import Gait
from laticauda.interfaces import Command
from laticauda.logs import Recorder
from laticauda.operate.estimate import Estimate
from laticauda.operate.packing import ESTIMATE, LABELS, TOPICS, Recorded, packed, packed_estimate
from laticauda.operate.samples import Event, JointSample, PoseSample, PowerReading
from laticauda.operate.timing import Tick
from laticauda.operate.values import to_json
from laticauda.robot import Environment, Robot, to_toml

HEADER = "operation"
FORMAT = "1"
COMMAND = "/command"
TICK = "/loop/tick"
RECEIVED, SENT = "/can/received", "/can/sent"
LEVELS = {"fault": "error", "rejected": "warning"}


@dataclasses.dataclass(frozen=True, kw_only=True)
class Header:
    """What a recording says about the whole operation."""

    robot: Robot
    """What swims."""
    environment: Environment
    """What it swims in, as far as it is known; its density and current count for the figures."""
    gait: Gait | None = None
    """What is swum; None if none is."""
    controller: object | None = None
    """What decides the commands, for a replay: one of those of `laticauda.control`, or None."""
    estimator: object | None = None
    """What says where the robot is, for a replay, or None."""
    supply_voltage: float | None = None
    """V of (4); None without a power meter [V]."""
    settings: Mapping[str, str | float] = dataclasses.field(default_factory=dict[str, str | float])
    """Whatever else belongs to the record of the trial."""
    operation: str = ""
    """The trial file as it was read."""

    def __post_init__(self) -> None:
        """Check every field once."""
        instance("robot", self.robot, Robot)
        instance("gait", self.gait, Gait, type(None))
        if self.supply_voltage is not None:
            object.__setattr__(self, "supply_voltage", positive("supply_voltage", self.supply_voltage, "V"))

    def texts(self) -> dict[str, str]:
        """The header as texts by name."""
        return {
            "format": FORMAT,
            "version": version("laticauda"),
            "robot": to_toml(self.robot),
            "environment": to_toml(self.environment),
            "gait": to_json(self.gait),
            "controller": to_json(self.controller),
            "estimator": to_json(self.estimator),
            "supply_voltage": "" if self.supply_voltage is None else repr(self.supply_voltage),
            "settings": json.dumps(dict(self.settings)),
            "operation": self.operation,
        }


class OperationRecorder:
    """Writes the recording of one operation; a context manager, and any thread may write.

    Times are those of one clock, not negative [s].

    Args:
        path: The file; an older one is never replaced.
        header: What is known at the start; it is on disk at once.
        chunk_seconds: What is lost at most when the program is killed [s].

    Raises:
        StorageFailed: If the file exists, or cannot be written; later, if the disk is full.
        MissingExtra: If the package `mcap` is not installed.
    """

    def __init__(self, path: str | Path, header: Header, *, chunk_seconds: float = 0.5) -> None:
        self._recorder = Recorder(path, chunk_seconds=chunk_seconds)
        self._recorder.metadata(HEADER, header.texts())
        self._joints = tuple(f"joint_{i}" for i in range(header.robot.n_joints))
        self._yaw = tuple(f"joint_{i}" for i, joint in enumerate(header.robot.joints) if joint.axis == "yaw")

    @property
    def path(self) -> Path:
        """The file."""
        return self._recorder.path

    def sample(self, sample: Recorded, *, received: float | None = None) -> None:
        """What came in, in the order in which the estimator got it.

        Args:
            sample: A sample or a reading.
            received: When it came; None: when it was taken [s].
        """
        time = sample.time if received is None else not_negative("received", received, "s")
        topic = TOPICS[type(sample)]
        self._recorder.array(topic, time, packed(sample), unit="SI", labels=(LABELS[topic],))
        if isinstance(sample, JointSample):
            names = self._joints if sample.angle.size == len(self._joints) else self._yaw
            rate, torque = (() if value is None else value for value in (sample.rate, sample.torque))
            self._recorder.joint_state("/joint_states", time, names, sample.angle, rate, torque)  # pyright: ignore
        elif isinstance(sample, PoseSample) and not sample.is_lost:
            turned = (1.0, 0.0, 0.0, 0.0) if sample.rotation is None else _quaternion(sample.rotation)
            self._recorder.pose("/mocap/body", time, sample.position.tolist(), turned)
        elif isinstance(sample, PowerReading):
            self._recorder.scalar("/power/current", time, sample.current, unit="A")

    def estimate(self, estimate: Estimate) -> None:
        """An `estimate` of where the robot was."""
        time = estimate.time
        self._recorder.array(ESTIMATE, time, packed_estimate(estimate), unit="SI", labels=(LABELS[ESTIMATE],))
        x, y = estimate.center_of_mass.tolist()
        half = 0.5 * estimate.heading
        self._recorder.pose("/estimate/body", time, (x, y, 0.0), (math.cos(half), 0.0, 0.0, math.sin(half)))
        self._recorder.scalar("/estimate/heading", time, estimate.heading, unit="rad")

    def command(self, time: float, command: Command, signals: Mapping[str, float] | None = None) -> None:
        """What a controller decided.

        Args:
            time: Of the estimate that it decided on; that estimate is recorded before [s].
            command: Its decision.
            signals: What it had in mind.
        """
        content = {"time": time, "command": json.loads(to_json(command)), "signals": dict(signals or {})}
        self._recorder.json(COMMAND, time, content)
        for name, value in (signals or {}).items():
            self._recorder.scalar(f"/control/{name}", time, value, unit="SI")

    def tick(self, tick: Tick) -> None:
        """When a `tick` of the loop was due, when it began, and when its last frame was sent."""
        self._recorder.array(TICK, tick.began, np.array(tick), unit="s", labels=("due, began, sent",))

    def can(self, time: float, identifier: int, data: bytes, *, sent: bool = False) -> None:
        """A raw frame of the bus.

        Args:
            time: When [s].
            identifier: 11 bits.
            data: Up to 8 bytes.
            sent: Whether it is ours.
        """
        self._recorder.can_frame(SENT if sent else RECEIVED, time, identifier, data)

    def event(self, event: Event) -> None:
        """An `event`; what came before it is on disk after this. Those of kind `start` and `stop` enclose a run."""
        content = {"message": event.message, "data": dict(event.data)}
        self._recorder.event(event.time, event.kind, content, level=LEVELS.get(event.kind, "info"))

    def note(self, name: str, content: Mapping[str, str | float]) -> None:
        """What was found out on the way, as texts of the whole file; ``note("idle", {"current": 1.18})``.

        Args:
            name: What it is about.
            content: Numbers and texts by name.
        """
        texts = {key: value if isinstance(value, str) else repr(float(value)) for key, value in content.items()}
        self._recorder.metadata(name, texts)

    def flush(self) -> None:
        """Hand everything to the operating system."""
        self._recorder.flush()

    def close(self) -> None:
        """Complete the file; a second time it does nothing."""
        self._recorder.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()


def _quaternion(rotation: Any) -> tuple[float, float, float, float]:
    """w, x, y, z of a rotation matrix, by its largest part; for pictures."""
    m = rotation
    squares = (
        1.0 + m[0, 0] + m[1, 1] + m[2, 2],
        1.0 + m[0, 0] - m[1, 1] - m[2, 2],
        1.0 - m[0, 0] + m[1, 1] - m[2, 2],
        1.0 - m[0, 0] - m[1, 1] + m[2, 2],
    )
    differences = (m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1])
    sums = (m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1])
    rows = (
        (squares[0], *differences),
        (differences[0], squares[1], sums[0], sums[1]),
        (differences[1], sums[0], squares[2], sums[2]),
        (differences[2], sums[1], sums[2], squares[3]),
    )
    row = rows[max(range(4), key=lambda i: squares[i])]
    size = math.sqrt(sum(float(part) ** 2 for part in row))
    if not math.isfinite(size) or size == 0.0:
        return 1.0, 0.0, 0.0, 0.0
    w, x, y, z = (float(part) / size for part in row)
    return w, x, y, z
