"""Recording of an operation: written while it runs, read again, and rerun through an estimator or a controller.

The format is MCAP, which survives if the program is killed. What the estimator and the controller
got is kept bit for bit, in the order in which they got it; the same data are also stored in the
types that Foxglove draws by itself. docs/how-to/recordings.md lists the topics.
"""

import json
import math
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.control.estimation import (
    Estimate,
    Estimator,
    JointSample,
    PoseSample,
    Sample,
    StateEstimator,
)
from laticauda.control.estimation.learning import Learned, Learner, Learning
from laticauda.control.estimation.samples import Mount
from laticauda.models.dynamics.plant import Plant
from laticauda.models.spatial.frames import Frames
from laticauda.robot.kinematics import to_quaternion, turn
from laticauda.scenarios import interfaces
from laticauda.tank.operate.drivers.base import Frame
from laticauda.tank.operate.recording import entries
from laticauda.tank.operate.recording.entries import (
    Decision,
    Entry,
    Event,
    Header,
    PowerReading,
    Tick,
    Timing,
)
from laticauda.trials import logs
from laticauda.trials.logs.recorder import CLOCK
from laticauda.trials.logs.recording import failures_of
from laticauda.values import codec
from laticauda.values.checks import check_instance, check_not_negative
from laticauda.values.errors import BadArgument, TrialFileError

CHUNK = 0.5  # most that is lost if the program is killed [s]
PICTURE = 0.04  # time between two postures for viewers [s]
RECEIVED, SENT = "/can/received", "/can/sent"
LEVELS = {"fault": "error", "rejected": "warning", "changed": "warning"}
NOTES = {"idle_current": "idle", "settling": "initial"}
"""Events whose data are also kept as notes, and the names of the notes."""


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
        super().__init__(path, chunk_seconds=CHUNK, epoch=epoch)
        self.metadata(entries.HEADER, header.texts())
        robot = header.run.robot
        self._bodies, self._drawn, self._fin_angle = (
            Frames(robot),
            -math.inf,
            np.zeros(len(robot.fin_joints)),
        )
        self.robot(0.0, self._bodies.description, self._bodies.fixed)
        self._joints = tuple(f"joint_{i}" for i in range(robot.n_joints))
        self._driven = (*self._joints, "fin_joint")[: len(robot.driven_joints)]
        self._yaw = tuple(
            f"joint_{i}" for i, joint in enumerate(robot.joints) if joint.axis == "yaw"
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
        elif isinstance(entry, Frame):
            self.can_frame(
                SENT if entry.is_ours else RECEIVED, entry.time, entry.identifier, entry.data
            )
        else:
            time, kind = (
                entry.time if received is None else check_not_negative("received", received, "s"),
                type(entry),
            )
            self.message(
                entries.TOPIC_OF[kind],
                time,
                entries.ros_type_of(kind),
                entries.content_of(entry),
                unit="SI",
            )
            self._draw(time, entry)

    def _draw(self, time: float, entry: Entry) -> None:
        """Record an entry in the types that a viewer can draw, if there are any."""
        match entry:
            case JointSample():
                names = next(
                    n for n in (self._driven, self._joints, self._yaw) if entry.angle.size == len(n)
                )
                rate, torque = (
                    () if value is None else value for value in (entry.rate, entry.torque)
                )
                self.joint_state("/joint_states", time, names, entry.angle, rate, torque)  # pyright: ignore
                if names is self._driven and len(names) > len(self._joints):
                    self._fin_angle[0] = np.nan_to_num(entry.angle[-1])
            case PoseSample() if not entry.is_lost:
                turned = (
                    (1.0, 0.0, 0.0, 0.0)
                    if entry.rotation is None
                    else to_quaternion(entry.rotation)
                )
                self.pose("/mocap/body", time, entry.position.tolist(), turned)
            case PowerReading():
                self.scalar("/power/current", time, entry.current, unit="A")
            case Estimate():
                turned = to_quaternion(turn("yaw", entry.heading) @ turn("pitch", entry.pitch))
                self.pose("/estimate/body", time, (*entry.center_of_mass.tolist(), 0.0)[:3], turned)
                self.scalar("/estimate/heading", time, entry.heading, unit="rad")
                if time - self._drawn >= PICTURE:
                    self._drawn = time
                    self.transforms(time, self._frames(entry))
            case Decision():
                for name, value in entry.signals.items():
                    self.scalar(f"/control/{name}", time, value, unit="SI")
            case Learned():
                for name, value in entry.value.items():
                    self.scalar(f"/learned/{name}", time, value, unit="SI")
            case _:
                pass

    def _frames(self, seen: Estimate) -> dict[str, logs.Frame]:
        """Return the estimated frames of the links; the mean pitch is used for the tail."""
        tail = np.array(
            [to_quaternion(turn("yaw", seen.link_angle[0]) @ turn("pitch", seen.pitch))]
        )
        one = (values[np.newaxis] for values in (seen.joint_angle, self._fin_angle))
        found = self._bodies.moving(seen.center_of_mass[np.newaxis], tail, *one)
        return {
            name: (parent, place[0], angle[0]) for name, (parent, place, angle) in found.items()
        }

    def note(self, name: str, content: Mapping[str, str | float]) -> None:
        """Record what was found out on the way, as texts of the whole file; ``note("idle", {"current": 1.18})``.

        Args:
            name: Name of the note.
            content: Numbers and texts by name.
        """
        texts = {
            key: value if isinstance(value, str) else repr(float(value))
            for key, value in content.items()
        }
        self.metadata(name, texts)


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
        self._recorder, self._frames, self._learner = recorder, frames, learner
        self._state: Any = None if learner is None else learner.init()
        self.news = deque[Event]()
        """Events about what was learned and what has changed; whoever shows them removes them."""

    def keep(self, now: float, found: Sequence[Entry | Frame]) -> None:
        """Record what a tick at `now` [s] `found`, in this order; after an error, nothing more is written."""
        if self.trouble:
            return
        try:
            for entry in found:
                if self._frames or not isinstance(entry, Frame):
                    self._recorder.record(entry, received=now)
                if isinstance(entry, Event) and entry.kind in NOTES and entry.data:
                    self._recorder.note(NOTES[entry.kind], entry.data)
                if self._learner is not None and isinstance(entry, Sample):
                    self._learn(self._learner, now, entry)
        except Exception as error:
            self.trouble = str(error) or type(error).__name__

    def _learn(self, learner: Learner, now: float, sample: Sample) -> None:
        """Record what is learned from a sample; an error ends only the learning, because nothing depends on it."""
        try:
            self._state = learner.step(self._state, sample)
            learned = self._state.learned
            told = () if learned is None else learned.changes
        except Exception as error:
            self._learner, learned, told = None, None, (f"Learning has stopped: {error}",)
        news = [Event(time=now, kind="changed", message=change) for change in told]
        for entry in news if learned is None else (learned, *news):
            self._recorder.record(entry, received=now)
        if learned is not None:
            news.insert(0, Event(time=now, kind="learned", message=learned.line))
        self.news.extend(news)


# ---- reading it again ----------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class OperationLog:
    """Everything in a recording except the raw frames of the bus."""

    path: Path
    """Path of the file."""
    header: Header
    """Header of the recording, about the whole operation."""
    version: str
    """Version of the laticauda that recorded it."""
    notes: Mapping[str, Mapping[str, str]]
    """Notes made during the operation, by name."""
    entries: tuple[Entry, ...]
    """Entries in the order in which they were recorded."""
    lost: str
    """What is missing from the file, as a sentence; "" if nothing is."""
    epoch: int = 0
    """Wall-clock time at time 0 of the recording [ns since 1970]; 0: unknown."""

    @property
    def timing(self) -> Timing | None:
        """Punctuality of the loop; None if it had no real clock."""
        ticks = self.of(Tick)
        rate = self.header.run.notes.get("rate")
        times = np.array([(tick.due, tick.began, tick.sent) for tick in ticks])
        return (
            Timing(times=times, interval=1.0 / float(rate)) if ticks and rate is not None else None
        )

    @property
    def span(self) -> tuple[float, float]:
        """Times at which the run began and ended; minus and plus infinity without such events [s]."""
        events: list[Event] = self.of(Event)
        begin = max((event.time for event in events if event.kind == "start"), default=-math.inf)
        end = min(
            (event.time for event in events if event.kind == "stop" and event.time >= begin),
            default=math.inf,
        )
        return begin, end

    def of(self, *kinds: type[Any]) -> list[Any]:
        """Return the entries of some `kinds`, in their order.

        Args:
            kinds: Classes of entries.
        """
        return [entry for entry in self.entries if isinstance(entry, kinds)]

    def of_run(self, kind: type[Any]) -> list[Any]:
        """Return the entries of one `kind` from the beginning of the run to its end.

        Args:
            kind: A class of entries.
        """
        begin, end = self.span
        return [entry for entry in self.of(kind) if begin <= entry.time <= end]


def read_operation(path: str | Path) -> OperationLog:
    """Read a file written by `OperationRecorder`; if it is truncated, read all that is complete.

    Args:
        path: Path of the file.

    Raises:
        TrialFileError: If the file does not exist, or is not a recording of an operation; the
            message says why.
        MissingExtra: If the package `mcap` is not installed.
    """
    return operation_in(logs.open_recording(path))


def operation_in(recording: logs.Recording) -> OperationLog:
    """Return what is in a recording that is already open; see `read_operation`."""
    path, header = recording.path, header_in(recording)
    with failures_of(path), codec.keys_of(f"Cannot load {path}", TrialFileError):
        found = tuple(entry_of(logged) for logged in recording.messages(*entries.TOPICS, "/events"))
    notes = {
        name: one for name, one in recording.metadata.items() if name not in (entries.HEADER, CLOCK)
    }
    version, epoch = recording.metadata[entries.HEADER]["version"], recording.epoch
    return OperationLog(
        path=path,
        header=header,
        version=version,
        notes=notes,
        entries=found,
        lost=recording.lost,
        epoch=epoch,
    )


def header_in(recording: logs.Recording) -> Header:
    """Return the header of a `recording`, about the whole operation.

    Raises:
        TrialFileError: If it is not a recording of an operation, or has another format.
    """
    path, texts = recording.path, recording.metadata.get(entries.HEADER)
    if texts is None:
        raise TrialFileError(
            f"Cannot load {path}: it is not a recording of an operation, or its beginning is missing."
        )
    if texts.get("format") != entries.FORMAT:
        raise TrialFileError(
            f"Cannot load {path}: it has format {texts.get('format')}, and this version of laticauda reads "
            f"{entries.FORMAT}: read it with laticauda {texts.get('version')}, which wrote it."
        )
    with failures_of(path), codec.keys_of(f"Cannot load {path}", TrialFileError):
        return entries.header_from_texts(texts)


def entry_of(logged: logs.Logged) -> Entry:
    """Return the entry in a message of a recording; raises the same errors as `entries.entry_of`."""
    content = logged.content
    if logged.topic == "/events":
        msg: dict[str, Any] = json.loads(content["msg"]) if content["msg"] else {}
        return Event(
            time=logged.time,
            kind=content["name"],
            message=msg.get("message", ""),
            data=msg.get("data") or {},
        )
    return entries.entry_of(logged.topic, content)


@dataclass(frozen=True, kw_only=True)
class Rerun:
    """Commands of a controller that was run again, and the recorded commands."""

    recorded: tuple[Decision, ...]
    """Recorded decisions."""
    again: tuple[Decision, ...]
    """New decisions at the same instants."""

    @property
    def n_different(self) -> int:
        """Number of instants at which the two commands are not the same, bit for bit [-]."""
        return sum(
            one.command != two.command for one, two in zip(self.recorded, self.again, strict=True)
        )

    @property
    def largest_difference(self) -> float:
        """Largest difference between the two offsets of the joints [rad]."""
        pairs = zip(self.recorded, self.again, strict=True)
        return max(
            (abs(one.command.offset - two.command.offset) for one, two in pairs), default=0.0
        )


def rerun_estimator(
    log: OperationLog,
    estimator: StateEstimator | None = None,
    *,
    plant: Callable[..., Plant[Any]] | None = None,
) -> list[Estimate]:
    """Run an estimator on the recorded samples, in their order; estimate at the times of the recorded estimates.

    Args:
        log: The recording.
        estimator: Estimator to run; None: the recorded one, whose estimates equal the recorded ones
            bit for bit.
        plant: `laticauda.build_plant`, which rebuilds a recorded estimator's digital twin; needed only if
            it had one.

    Raises:
        ValueError: If there is no estimator, or its twin has to be rebuilt and `plant` is not
            given.
    """
    chosen = _recorded_estimator(log, plant) if estimator is None else estimator
    state = chosen.init()
    found, at_once = list[Estimate](), list[Sample]()
    for entry in log.entries:
        if isinstance(entry, Sample):
            at_once.append(entry)
        elif isinstance(entry, Estimate):
            state = chosen.steps(state, at_once)
            at_once.clear()
            estimate = chosen.estimate(state, entry.time)
            if estimate is not None:
                found.append(estimate)
    return found


def rerun_learner(
    log: OperationLog, plant: Callable[..., Plant[Any]], settings: Learning | None = None
) -> list[Learned]:
    """Return what a twin learns from the recorded samples; if that was recorded, too, the two agree bit for bit.

    Args:
        log: The recording.
        plant: `laticauda.build_plant`, which builds the twin.
        settings: What is learned; None: the recorded settings, or else the default.

    Raises:
        ValueError: If nothing can be learned about such a robot.
    """
    run, mount = log.header.run, getattr(log.header.estimator, "mount", Mount())
    twin = plant(run.robot, run.environment, joints="servo")
    learner = Learner(
        settings=settings or log.header.learning or Learning(),
        robot=run.robot,
        plant=twin,
        mount=mount,
    )
    state, found = learner.init(), list[Learned]()
    for sample in (entry for entry in log.entries if isinstance(entry, Sample)):
        state = learner.step(state, sample)
        found += [] if state.learned is None else [state.learned]
    return found


def rerun_controller(
    log: OperationLog,
    controller: interfaces.Controller[Any] | None = None,
    estimates: list[Estimate] | None = None,
) -> Rerun:
    """Run a controller on the recorded estimates, at the recorded control instants of the run.

    Args:
        log: The recording.
        controller: Controller to run; None: the recorded one, whose commands equal the recorded
            ones bit for bit.
        estimates: Estimates to use instead of the recorded ones.

    Raises:
        ValueError: If there is no controller, or an instant has no estimate.
    """
    chosen: Any = log.header.controller if controller is None else controller
    if chosen is None:
        raise BadArgument("controller", "must be given: the recording holds none, got None")
    recorded = log.of_run(Decision)
    known = {item.time: item for item in (log.of(Estimate) if estimates is None else estimates)}
    state, again = chosen.init(), list[Decision]()
    for decision in recorded:
        if decision.time not in known:
            raise BadArgument(
                "estimates",
                f"must have one at every control instant, got none at {decision.time} s",
            )
        state, command = chosen.step(state, known[decision.time])
        check_instance("command", command, interfaces.Command)
        again.append(Decision(time=decision.time, command=command, signals={}))
    return Rerun(recorded=tuple(recorded), again=tuple(again))


def _recorded_estimator(
    log: OperationLog, plant: Callable[..., Plant[Any]] | None
) -> StateEstimator:
    """Return the recorded estimator, with its digital twin."""
    estimator, twin = log.header.estimator, log.header.twin
    if estimator is None:
        raise BadArgument("estimator", "must be given: the recording holds none, got None")
    if twin is None or not isinstance(estimator, Estimator):
        return estimator
    if plant is None:
        raise BadArgument(
            "plant", "must be `laticauda.build_plant`, which rebuilds the recorded twin, got None"
        )
    return replace(estimator, plant=plant(twin.robot, twin.environment, twin.model))
