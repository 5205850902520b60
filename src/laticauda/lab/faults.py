"""What may go wrong in the tank: on command, or by a schedule in a TOML file.

A schedule is a list of tables ``[[faults]]``, each with the fields of `Fault`:

    [[faults]]
    kind = "leak"
    time = 12.0
    node = 5
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, cast

from laticauda.errors import LaticaudaError, finite, nearest, not_negative, one_of, whole, within
from laticauda.protocol import EVERY_NODE, N_NODES
from laticauda.robot.checks import settle_required

KINDS = {
    "frame_loss": "frames on the bus are lost, a `share` of them",
    "frame_corruption": "frames on the bus arrive with wrong bytes, a `share` of them",
    "bus_off": "a node neither sends nor hears",
    "dead_module": "a node has no power; when it comes back, it starts up anew",
    "stuck_servo": "a joint is jammed where it stands",
    "leak": "water in a module",
    "over_temperature": "a motor is as hot as `temperature`",
    "body_lost": "the cameras do not see the markers",
    "mocap_silent": "the cameras' server sends nothing",
    "meter_silent": "the meter answers nothing",
    "late_computer": "frames of the operator's computer arrive late by `delay`",
}
ON_NODES = ("frame_loss", "frame_corruption", "bus_off", "dead_module", "stuck_servo", "leak", "over_temperature")


class FaultFileError(LaticaudaError, ValueError):
    """A schedule of faults is wrong: it says which file, key, rule and value."""


@dataclass(frozen=True, kw_only=True)
class Fault:
    """One thing that goes wrong."""

    kind: str
    """Which; see `KINDS` [-]."""
    time: float = 0.0
    """When, by the lab's clock [s]."""
    duration: float = math.inf
    """How long; infinite: to the end [s]."""
    node: int = EVERY_NODE
    """Where; 0: everywhere [-]."""
    share: float = 0.1
    """Of frames that are lost, or corrupted [-]."""
    delay: float = 0.1
    """Of late frames [s]."""
    temperature: float = 95.0
    """Of the motor [deg C]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        one_of("kind", self.kind, tuple(KINDS))
        settle_required(self, not_negative, "s", "time", "delay")
        if self.duration != math.inf:
            settle_required(self, not_negative, "s", "duration")
        if whole("node", self.node, 0) > N_NODES:
            raise ValueError(f"`node` must be <= {N_NODES}, got {self.node}.")
        if self.node != EVERY_NODE and self.kind not in ON_NODES:
            raise ValueError(f"`node` must be left out for `{self.kind}`, got {self.node}.")
        within("share", self.share, 0.0, 1.0)
        finite("temperature", self.temperature, "deg C")

    def is_on(self, time: float) -> bool:
        """Whether it is there at a moment.

        Args:
            time: By the lab's clock [s].
        """
        return self.time <= time < self.time + self.duration


class Faults:
    """All faults that there are, were and will be.

    Args:
        schedule: Those that are known before.
    """

    def __init__(self, schedule: Iterable[Fault] = ()) -> None:
        self._all = list(schedule)
        self._on: list[Fault] = []

    def add(self, fault: Fault) -> None:
        """One more: `fault`."""
        self._all.append(fault)

    def clear(self) -> None:
        """No more faults; what they did stays done."""
        self._all, self._on = [], []

    def look(self, time: float) -> None:
        """See which are on at `time` [s]; the other questions are answered for then."""
        self._on = [fault for fault in self._all if fault.is_on(time)] if self._all else []

    def on(self, kind: str, node: int = EVERY_NODE) -> Fault | None:
        """A fault of `kind` that is there now, at `node` or everywhere; None: there is none."""
        for fault in self._on:
            if fault.kind == kind and fault.node in (EVERY_NODE, node):
                return fault
        return None

    @property
    def any(self) -> bool:
        """Whether there is any now."""
        return bool(self._on)

    @property
    def present(self) -> tuple[Fault, ...]:
        """Those that are there now."""
        return tuple(self._on)


def load_faults(path: str | Path) -> tuple[Fault, ...]:
    """Read a schedule.

    Args:
        path: A TOML file.

    Raises:
        FaultFileError: If anything is wrong with it; the message has the file, the entry, the rule and the value.
    """
    import tomllib

    try:
        table: Any = tomllib.loads(Path(path).read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise FaultFileError(f"{path}: cannot be read: {error.strerror or error}") from None
    except (ValueError, RecursionError) as error:
        raise FaultFileError(f"{path}: is not valid TOML: {error}") from None
    for key in table:
        if key != "faults":
            raise FaultFileError(f"{path}: key `{key}`: is not known; the only key here is faults")
    entries: Any = table.get("faults", [])
    if not isinstance(entries, list):
        raise FaultFileError(f"{path}: key `faults`: must be a list of tables, got {entries!r:.60}")
    found: list[Fault] = []
    for i, entry in enumerate(cast("Sequence[Any]", entries)):
        try:
            found.append(fault_of(entry))
        except ValueError as error:
            raise FaultFileError(f"{path}: key `faults[{i}]`: {error}") from None
    return tuple(found)


def fault_of(entry: Any) -> Fault:
    """The fault that a table says.

    Raises:
        ValueError: If it says none.
    """
    if not isinstance(entry, dict):
        raise ValueError(f"must be a table, got {entry!r:.60}.")
    values = cast("dict[str, Any]", entry)
    names = [field.name for field in fields(Fault)]
    for key in values:
        if key not in names:
            raise ValueError(f"`{key}` is not known{nearest(key, names) or '; the keys are ' + ', '.join(names)}.")
    if "kind" not in values:
        raise ValueError("`kind` is missing.")
    return Fault(**values)


def fault_from_words(text: str, now: float) -> Fault:
    """The fault that a line such as `leak node=5 duration=2` says; it begins now, unless it says a `time`.

    Args:
        text: The kind, then fields.
        now: By the lab's clock [s].

    Raises:
        ValueError: If it says none.
    """
    words = text.split()
    if not words:
        raise ValueError("`kind` is missing.")
    entry: dict[str, Any] = {"time": now}
    for word in words[1:]:
        key, equals, value = word.partition("=")
        if not equals:
            raise ValueError(f"`{key}` must have a value: {key}=...")
        try:
            entry[key] = int(value) if key == "node" else float(value)
        except ValueError:
            raise ValueError(f"`{key}` must be a number, got {value!r}.") from None
    return fault_of({**entry, "kind": words[0]})
