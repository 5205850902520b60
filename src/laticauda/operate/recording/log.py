"""Reading a recording: its entries in their order, and these once more through an estimator or a controller."""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from laticauda import codec, interfaces, logs
from laticauda.dynamics.plant import Plant
from laticauda.errors import BadArgument, TrialFileError, instance
from laticauda.estimation import Estimate, Estimator, JointSample, PoseSample, ReferenceSample, StateEstimator
from laticauda.operate.recording.entries import TOPICS, Decision, Entry, Event, Tick, Timing, entry_of
from laticauda.operate.recording.header import FORMAT, HEADER, Header, header_from_texts


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

    @property
    def timing(self) -> Timing | None:
        """How punctual the loop was; None if it had no clock."""
        ticks = self.of(Tick)
        rate = self.header.run.notes.get("rate")
        return Timing(ticks=ticks, interval=1.0 / float(rate)) if ticks and rate is not None else None

    @property
    def span(self) -> tuple[float, float]:
        """When the run began and ended; without such events minus and plus infinity [s]."""
        events: list[Event] = self.of(Event)
        begin = max((event.time for event in events if event.kind == "start"), default=-math.inf)
        end = min((event.time for event in events if event.kind == "stop" and event.time >= begin), default=math.inf)
        return begin, end

    def of(self, *kinds: type[Any]) -> list[Any]:
        """The entries of some `kinds` of class, in their order."""
        return [entry for entry in self.entries if isinstance(entry, kinds)]


def read_operation(path: str | Path) -> OperationLog:
    """Read what `OperationRecorder` wrote; of a file that ends in the middle, all that is complete.

    Args:
        path: The file.

    Raises:
        TrialFileError: If there is no such file, or it is no recording of an operation; the message says why.
        MissingExtra: If the package `mcap` is not installed.
    """
    recording = logs.open_recording(path)
    texts = recording.metadata.get(HEADER)
    if texts is None:
        raise TrialFileError(f"Cannot load {path}: it is no recording of an operation, or its beginning is missing.")
    if texts.get("format") != FORMAT:
        raise TrialFileError(
            f"Cannot load {path}: it has format {texts.get('format')}, and this version of laticauda reads "
            f"{FORMAT}: read it with the laticauda that wrote it, {texts.get('version')}."
        )
    try:
        with codec.keys_of(f"Cannot load {path}", TrialFileError):
            header = header_from_texts(texts)
            entries = tuple(_entry(logged) for logged in recording.messages(*TOPICS, "/events"))
    except KeyError as error:
        raise TrialFileError(f"Cannot load {path}: it has no {error}.") from error
    except (ValueError, TypeError, IndexError) as error:
        raise TrialFileError(f"Cannot load {path}: {error}") from error
    notes = {name: content for name, content in recording.metadata.items() if name != HEADER}
    return OperationLog(
        path=Path(path),
        header=header,
        version=texts["version"],
        notes=notes,
        entries=entries,
        lost=recording.lost,
    )


def _entry(logged: logs.Logged) -> Entry:
    content = logged.content
    if logged.topic == "/events":
        msg: dict[str, Any] = json.loads(content["msg"]) if content["msg"] else {}
        return Event(time=logged.time, kind=content["name"], message=msg.get("message", ""), data=msg.get("data") or {})
    return entry_of(logged.topic, content)


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
    found: list[Estimate] = []
    for entry in log.entries:
        if isinstance(entry, PoseSample | JointSample | ReferenceSample):
            state = chosen.step(state, entry)
        elif isinstance(entry, Estimate):
            estimate = chosen.estimate(state, entry.time)
            if estimate is not None:
                found.append(estimate)
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
    begin, end = log.span
    recorded = [item for item in log.of(Decision) if begin <= item.time <= end]
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
