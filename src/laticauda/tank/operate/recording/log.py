"""A recording of an operation, read again: its header, its notes, and its entries in their order."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.tank.operate.recording import messages
from laticauda.tank.operate.recording.entries import Entry, Event
from laticauda.tank.operate.recording.header import FORMAT, HEADER, Header, header_from_texts
from laticauda.tank.operate.recording.timing import Tick, Timing
from laticauda.trials import logs
from laticauda.trials.logs import CLOCK, failures_of
from laticauda.values import TrialFileError, codec

EVENTS_TOPIC = "/events"
"""Topic of the events."""


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
        ticks: list[Tick] = self.of(Tick)
        rate = self.header.run.notes.get("rate")
        if not ticks or rate is None:
            return None
        times = np.array([(tick.due, tick.began, tick.sent) for tick in ticks])
        return Timing(times=times, interval=1.0 / float(rate))

    @property
    def span(self) -> tuple[float, float]:
        """Times at which the run began and ended [s].

        They are those of the last `start` and the `stop` after it; minus and plus infinity without
        such events.
        """
        events: list[Event] = self.of(Event)
        starts = [event.time for event in events if event.kind == "start"]
        begin = max(starts, default=-math.inf)
        stops = [event.time for event in events if event.kind == "stop" and event.time >= begin]
        end = min(stops, default=math.inf)
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
    path = recording.path
    header = header_in(recording)
    with failures_of(path), codec.keys_of(f"Cannot load {path}", TrialFileError):
        logged_messages = recording.messages(*messages.TOPICS, EVENTS_TOPIC)
        entries = tuple(entry_of(logged) for logged in logged_messages)
    notes = {
        name: texts for name, texts in recording.metadata.items() if name not in (HEADER, CLOCK)
    }
    return OperationLog(
        path=path,
        header=header,
        version=recording.metadata[HEADER]["version"],
        notes=notes,
        entries=entries,
        lost=recording.lost,
        epoch=recording.epoch,
    )


def header_in(recording: logs.Recording) -> Header:
    """Return the header of a `recording`, about the whole operation.

    Raises:
        TrialFileError: If it is not a recording of an operation, or has another format.
    """
    path = recording.path
    texts = recording.metadata.get(HEADER)
    if texts is None:
        raise TrialFileError(
            f"Cannot load {path}: it is not a recording of an operation, or its beginning is "
            "missing."
        )
    if texts.get("format") != FORMAT:
        raise TrialFileError(
            f"Cannot load {path}: it has format {texts.get('format')}, and this version of "
            f"laticauda reads {FORMAT}: read it with laticauda {texts.get('version')}, which "
            "wrote it."
        )
    with failures_of(path), codec.keys_of(f"Cannot load {path}", TrialFileError):
        return header_from_texts(texts)


def entry_of(logged: logs.Logged) -> Entry:
    """Return the entry in a message of a recording; raises what `messages.entry_of` raises."""
    if logged.topic != EVENTS_TOPIC:
        return messages.entry_of(logged.topic, logged.content)
    text = logged.content["msg"]
    content: dict[str, Any] = json.loads(text) if text else {}
    return Event(
        time=logged.time,
        kind=logged.content["name"],
        message=content.get("message", ""),
        data=content.get("data") or {},
    )
