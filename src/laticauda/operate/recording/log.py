"""Reading a recording: samples, estimates, commands and events in the order in which they were recorded."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from laticauda.codec import decode, keys_of
from laticauda.errors import TrialFileError
from laticauda.estimation import Estimate
from laticauda.interfaces import Command
from laticauda.logs import Logged, open_recording
from laticauda.operate.recording.entries import Decision, Event, Measurement
from laticauda.operate.recording.header import FORMATS, HEADER, Header, header_from_texts, named_today
from laticauda.operate.recording.recorder import COMMAND, TICK
from laticauda.operate.recording.schema import SCHEMAS
from laticauda.operate.timing import Tick, Timing, timing_of

Entry = Measurement | Estimate | Decision | Event | Tick


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
        return timing_of(ticks, 1.0 / float(rate)) if ticks and rate is not None else None

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
    recording = open_recording(path)
    texts = recording.metadata.get(HEADER)
    if texts is None:
        raise TrialFileError(f"Cannot load {path}: it is no recording of an operation, or its beginning is missing.")
    if texts.get("format") not in FORMATS:
        raise TrialFileError(
            f"Cannot load {path}: it has format {texts.get('format')}, and this version of laticauda reads "
            f"{' and '.join(FORMATS)}: read it with the laticauda that wrote it, {texts.get('version')}."
        )
    try:
        with keys_of(f"Cannot load {path}", TrialFileError):
            header = header_from_texts(texts)
            entries = tuple(_entry(logged) for logged in recording.messages(*SCHEMAS, COMMAND, TICK, "/events"))
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


def _entry(logged: Logged) -> Entry:
    content = logged.content
    if logged.topic == "/events":
        said: dict[str, Any] = json.loads(content["msg"]) if content["msg"] else {}
        return Event(
            time=logged.time, kind=content["name"], message=said.get("message", ""), data=said.get("data") or {}
        )
    if logged.topic == COMMAND:
        decided = json.loads(content["data"])
        decided["command"] = decode(Command, named_today(decided["command"]), "command")
        return Decision(**decided)
    if logged.topic == TICK:
        return Tick(*content["data"])
    return SCHEMAS[logged.topic].unpack(logged.topic, content["data"])
