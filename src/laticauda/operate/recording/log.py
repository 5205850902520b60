"""The file of an operation: written while it happens, read again, and once more through an estimator or a controller.

It is MCAP, which survives that the program is killed. What the estimator and the controller got is kept bit for bit, in
the order in which they got it; beside it stands the same in the types that Foxglove draws by itself.
docs/how-to/recordings.md lists the topics.
"""

import json
import math
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from laticauda import codec, interfaces, logs
from laticauda.dynamics.plant import Plant
from laticauda.errors import BadArgument, TrialFileError, instance, not_negative
from laticauda.estimation import Estimate, Estimator, JointSample, PoseSample, Sample, StateEstimator
from laticauda.estimation.learning import Learned, Learner, Learning
from laticauda.estimation.samples import Mount
from laticauda.kinematics import to_quaternion, turn
from laticauda.logs.recorder import CLOCK
from laticauda.logs.recording import failures_of
from laticauda.operate.drivers.base import Frame
from laticauda.operate.recording import entries
from laticauda.operate.recording.entries import Decision, Entry, Event, Header, PowerReading, Tick, Timing
from laticauda.spatial.frames import Frames

CHUNK = 0.5  # what is lost at most when the program is killed [s]
PICTURE = 0.04  # between two postures that viewers get [s]
RECEIVED, SENT = "/can/received", "/can/sent"
LEVELS = {"fault": "error", "rejected": "warning", "changed": "warning"}
NOTES = {"idle_current": "idle", "settling": "initial"}
"""Events whose data are noted, too, and under which name."""


class OperationRecorder(logs.Recorder):
    """Writes the recording of one operation; a context manager, and any thread may write.

    Times are those of one clock, not negative [s].

    Args:
        path: The file; an older one is never replaced.
        header: What is known at the start; it is on disk at once.
        epoch: What time 0 of that clock is by the one on the wall [ns since 1970]; 0: nobody knows.

    Raises:
        StorageFailed: If the file exists, or cannot be written; later, if the disk is full.
        MissingExtra: If the package `mcap` is not installed.
    """

    def __init__(self, path: str | Path, header: Header, *, epoch: int = 0) -> None:
        super().__init__(path, chunk_seconds=CHUNK, epoch=epoch)
        self.metadata(entries.HEADER, header.texts())
        robot = header.run.robot
        self._bodies, self._drawn, self._fin_angle = Frames(robot), -math.inf, np.zeros(len(robot.fin_joints))
        self.robot(0.0, self._bodies.description, self._bodies.fixed)
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
                if names is self._driven and len(names) > len(self._joints):
                    self._fin_angle[0] = np.nan_to_num(entry.angle[-1])
            case PoseSample() if not entry.is_lost:
                turned = (1.0, 0.0, 0.0, 0.0) if entry.rotation is None else to_quaternion(entry.rotation)
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
        """Where the links were thought to be; their mean pitch counts for the tail."""
        tail = np.array([to_quaternion(turn("yaw", seen.link_angle[0]) @ turn("pitch", seen.pitch))])
        one = (values[np.newaxis] for values in (seen.joint_angle, self._fin_angle))
        found = self._bodies.moving(seen.center_of_mass[np.newaxis], tail, *one)
        return {name: (parent, place[0], angle[0]) for name, (parent, place, angle) in found.items()}

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
        learner: What learns from it meanwhile, and is recorded, too; None: nothing does.
    """

    trouble = ""
    """Why nothing is recorded any more; "" as long as it is."""

    def __init__(self, recorder: OperationRecorder, *, frames: bool = True, learner: Learner | None = None) -> None:
        self._recorder, self._frames, self._learner = recorder, frames, learner
        self._state: Any = None if learner is None else learner.init()
        self.news = deque[Event]()
        """What was learnt and what has changed, for whoever takes it away to show it."""

    def keep(self, now: float, found: Sequence[Entry | Frame]) -> None:
        """Keep what a tick at `now` [s] `found`, in this order; after an error, nothing more is written."""
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
        """Keep what a sample teaches; nothing depends on it, so that an error ends it, and no more."""
        try:
            self._state = learner.step(self._state, sample)
            learned = self._state.learned
            told = () if learned is None else learned.changes
        except Exception as error:
            self._learner, learned, told = None, None, (f"Nothing is learnt any more: {error}",)
        news = [Event(time=now, kind="changed", message=change) for change in told]
        for entry in news if learned is None else (learned, *news):
            self._recorder.record(entry, received=now)
        if learned is not None:
            news.insert(0, Event(time=now, kind="learned", message=learned.line))
        self.news.extend(news)


# ---- reading it again ------------------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class OperationLog:
    """Everything of a recording but the raw frames of the bus."""

    path: Path
    """The file."""
    header: Header
    """What the recording says about the whole operation."""
    version: str
    """Of the laticauda that recorded it."""
    notes: Mapping[str, Mapping[str, str]]
    """What was found out on the way, by name."""
    entries: tuple[Entry, ...]
    """In the order in which they were recorded."""
    lost: str
    """What is missing from the file: a sentence; "" if nothing is."""
    epoch: int = 0
    """What its time 0 was by the clock on the wall [ns since 1970]; 0: nobody knows."""

    @property
    def timing(self) -> Timing | None:
        """How punctual the loop was; None if it had no clock."""
        ticks = self.of(Tick)
        rate = self.header.run.notes.get("rate")
        times = np.array([(tick.due, tick.began, tick.sent) for tick in ticks])
        return Timing(times=times, interval=1.0 / float(rate)) if ticks and rate is not None else None

    @property
    def span(self) -> tuple[float, float]:
        """When the run began and ended; without such events minus and plus infinity [s]."""
        events: list[Event] = self.of(Event)
        begin = max((event.time for event in events if event.kind == "start"), default=-math.inf)
        end = min((event.time for event in events if event.kind == "stop" and event.time >= begin), default=math.inf)
        return begin, end

    def of(self, *kinds: type[Any]) -> list[Any]:
        """The entries of some `kinds` of class, in their order.

        Args:
            kinds: Classes of entries.
        """
        return [entry for entry in self.entries if isinstance(entry, kinds)]

    def of_run(self, kind: type[Any]) -> list[Any]:
        """Those of one `kind` from the begin of the run to its end.

        Args:
            kind: A class of entries.
        """
        begin, end = self.span
        return [entry for entry in self.of(kind) if begin <= entry.time <= end]


def read_operation(path: str | Path) -> OperationLog:
    """Read what `OperationRecorder` wrote; of a file that ends in the middle, all that is complete.

    Args:
        path: The file.

    Raises:
        TrialFileError: If there is no such file, or it is no recording of an operation; the message says why.
        MissingExtra: If the package `mcap` is not installed.
    """
    recording = logs.open_recording(path)
    header = header_in(recording)
    version = recording.metadata[entries.HEADER]["version"]
    with failures_of(path), codec.keys_of(f"Cannot load {path}", TrialFileError):
        found = tuple(entry_of(logged) for logged in recording.messages(*entries.TOPICS, "/events"))
    notes = {name: one for name, one in recording.metadata.items() if name not in (entries.HEADER, CLOCK)}
    read = OperationLog(
        path=Path(path), header=header, version=version, notes=notes, entries=found, lost=recording.lost
    )
    return replace(read, epoch=recording.epoch)


def header_in(recording: logs.Recording) -> Header:
    """What a `recording` says about the whole operation.

    Raises:
        TrialFileError: If it is no recording of an operation, or of another format.
    """
    path, texts = recording.path, recording.metadata.get(entries.HEADER)
    if texts is None:
        raise TrialFileError(f"Cannot load {path}: it is no recording of an operation, or its beginning is missing.")
    if texts.get("format") != entries.FORMAT:
        raise TrialFileError(
            f"Cannot load {path}: it has format {texts.get('format')}, and this version of laticauda reads "
            f"{entries.FORMAT}: read it with the laticauda that wrote it, {texts.get('version')}."
        )
    with failures_of(path), codec.keys_of(f"Cannot load {path}", TrialFileError):
        return entries.header_from_texts(texts)


def entry_of(logged: logs.Logged) -> Entry:
    """The entry that a message of a recording is; raises as `entries.entry_of`."""
    content = logged.content
    if logged.topic == "/events":
        msg: dict[str, Any] = json.loads(content["msg"]) if content["msg"] else {}
        return Event(time=logged.time, kind=content["name"], message=msg.get("message", ""), data=msg.get("data") or {})
    return entries.entry_of(logged.topic, content)


@dataclass(frozen=True, kw_only=True)
class Rerun:
    """The commands of a controller that ran again, beside those that were recorded."""

    recorded: tuple[Decision, ...]
    """What was decided then."""
    again: tuple[Decision, ...]
    """What is decided now, at the same instants."""

    @property
    def n_different(self) -> int:
        """Instants at which the two commands are not the same, bit for bit [-]."""
        return sum(one.command != two.command for one, two in zip(self.recorded, self.again, strict=True))

    @property
    def largest_difference(self) -> float:
        """Of the two offsets of the joints [rad]."""
        pairs = zip(self.recorded, self.again, strict=True)
        return max((abs(one.command.offset - two.command.offset) for one, two in pairs), default=0.0)


def rerun_estimator(
    log: OperationLog, estimator: StateEstimator | None = None, *, plant: Callable[..., Plant[Any]] | None = None
) -> list[Estimate]:
    """What an estimator makes of the recorded samples, in their order, at the times of the recorded estimates.

    Args:
        log: The recording.
        estimator: None takes the recorded one; then the estimates are the recorded ones, bit for bit.
        plant: `laticauda.plant`, which makes a recorded estimator's digital twin again; needed only if it had one.

    Raises:
        ValueError: If there is no estimator, or its twin would have to be made and `plant` was not given.
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
    """What a twin learns from the recorded samples: of a recording with what was learnt the same, bit for bit.

    Args:
        log: The recording.
        plant: `laticauda.plant`, which makes the twin.
        settings: What is learnt; None: as it was recorded, or else the usual.

    Raises:
        ValueError: If nothing can be learnt of such a robot.
    """
    run, mount = log.header.run, getattr(log.header.estimator, "mount", Mount())
    twin = plant(run.robot, run.environment, joints="servo")
    learner = Learner(settings=settings or log.header.learning or Learning(), robot=run.robot, plant=twin, mount=mount)
    state, found = learner.init(), list[Learned]()
    for sample in (entry for entry in log.entries if isinstance(entry, Sample)):
        state = learner.step(state, sample)
        found += [] if state.learned is None else [state.learned]
    return found


def rerun_controller(
    log: OperationLog, controller: interfaces.Controller[Any] | None = None, estimates: list[Estimate] | None = None
) -> Rerun:
    """What a controller decides on the recorded estimates, at the recorded control instants of the run.

    Args:
        log: The recording.
        controller: None takes the recorded one; then the commands are the recorded ones, bit for bit.
        estimates: Others than the recorded ones.

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
            raise BadArgument("estimates", f"must have one at every control instant, got none at {decision.time} s")
        state, command = chosen.step(state, known[decision.time])
        instance("command", command, interfaces.Command)
        again.append(Decision(time=decision.time, command=command, signals={}))
    return Rerun(recorded=tuple(recorded), again=tuple(again))


def _recorded_estimator(log: OperationLog, plant: Callable[..., Plant[Any]] | None) -> StateEstimator:
    """The one of the recording, with its digital twin."""
    estimator, twin = log.header.estimator, log.header.twin
    if estimator is None:
        raise BadArgument("estimator", "must be given: the recording holds none, got None")
    if twin is None or not isinstance(estimator, Estimator):
        return estimator
    if plant is None:
        raise BadArgument("plant", "must be `laticauda.plant`, which makes the recorded twin again, got None")
    return replace(estimator, plant=plant(twin.robot, twin.environment, twin.model))
