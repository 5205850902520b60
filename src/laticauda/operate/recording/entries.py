"""What a recording holds: the entries of an operation, and all but its events as messages, bit for bit."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any, NamedTuple, TypeAlias, cast, get_args, get_type_hints

import numpy as np
from jaxtyping import Float

from laticauda import codec
from laticauda.estimation import Estimate, JointSample, PoseSample, ReferenceSample
from laticauda.estimation.samples import Status
from laticauda.interfaces import Command
from laticauda.logs import ros2
from laticauda.quantities import quantity, value


@value
class PowerReading:
    """What the power meter in the supply cable says."""

    time: float = quantity("s", "When it was read")
    current: float = quantity("A", "Now")
    average: float | None = quantity("A", "Since the meter was reset; None if it was not queried", default=None)
    minimum: float | None = quantity("A", "Since the meter was reset", default=None)
    maximum: float | None = quantity("A", "Since the meter was reset", default=None)
    since: float | None = quantity("s", "When the meter was reset; None if that is not known", default=None)


@dataclass(frozen=True, kw_only=True)
class Event:
    """Something that happened, or a state that was entered."""

    time: float
    """[s]."""
    kind: str
    """What: `state`, `fault`, `rejected`, `operator` and so on."""
    message: str
    """A sentence."""
    data: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """What else belongs to it: texts and numbers by name."""


@dataclass(frozen=True, kw_only=True)
class Decision:
    """What a controller decided at one control instant."""

    time: float
    """Of the estimate that it decided on [s]."""
    command: Command
    """What it decided."""
    signals: Mapping[str, float]
    """Its signals, by name."""


Measurement: TypeAlias = PoseSample | JointSample | ReferenceSample | PowerReading
"""What came in from the devices, and the references that were sent."""


Times = Float[np.ndarray, " n_ticks"]
SPREAD = ("median", "p99", "largest")


class Tick(NamedTuple):
    """One tick of the loop."""

    due: float
    """When it was to begin [s]."""
    began: float
    """When it began [s]."""
    sent: float
    """When its last frame had been handed to the bus [s]."""

    @property
    def time(self) -> float:
        """When it began [s]."""
        return self.began


Entry: TypeAlias = Measurement | Estimate | Decision | Event | Tick
"""What is recorded of an operation, besides the raw frames of the bus."""


@dataclass(frozen=True, kw_only=True)
class Timing:
    """How punctual the ticks of one operation were."""

    ticks: Sequence[Tick]
    """In their order."""
    interval: float
    """Between two of them, as asked for [s]."""

    @property
    def period(self) -> Times:
        """From the begin of a tick to that of the next [s]."""
        return np.diff([tick.began for tick in self.ticks])

    @property
    def latency(self) -> Times:
        """From when a tick was due until its last frame was sent [s]."""
        return np.array([tick.sent - tick.due for tick in self.ticks])

    @property
    def missed(self) -> int:
        """Ticks that were not over when the next was due [-]."""
        return int(np.count_nonzero(self.latency > self.interval))

    def summary(self) -> dict[str, float | int]:
        """Median, 99th percentile and largest of period and latency, the ticks and the missed deadlines."""
        found: dict[str, float | int] = {"ticks": len(self.ticks), "interval": self.interval, "missed": self.missed}
        for name in ("period", "latency"):
            values: Times = getattr(self, name)
            if values.size:
                numbers = np.percentile(values, (50.0, 99.0, 100.0)).tolist()
                found |= {f"{name}_{of}": number for of, number in zip(SPREAD, numbers, strict=True)}
        return found


TOPICS: Mapping[str, type[Any]] = {
    "/sample/pose": PoseSample,
    "/sample/joints": JointSample,
    "/sample/references": ReferenceSample,
    "/sample/power": PowerReading,
    "/estimate": Estimate,
    "/command": Decision,
    "/loop/tick": Tick,
}
"""Where entries are recorded that are messages of their own type, with the fields of their class."""
TOPIC_OF = {kind: topic for topic, kind in TOPICS.items()}
_JSON = {Command: "string", Mapping[str, float]: "string"}
_PLAIN = {float: "float64", float | None: "float64", Status: "string", **_JSON}
"""ROS types of fields by those of Python; all others are arrays."""


@cache
def _fields(kind: type[Any]) -> Mapping[str, Any]:
    return get_type_hints(kind)


def kind_of(kind: type[Any]) -> str:
    """The ROS type of the entries of a class."""
    return f"laticauda_msgs/{kind.__name__}"


def _definition(kind: type[Any]) -> str:
    return "".join(f"{_PLAIN.get(hint, 'float64[]')} {name}\n" for name, hint in _fields(kind).items())


ros2.DEFINITIONS.update({kind_of(kind): _definition(kind) for kind in TOPIC_OF})


def content_of(entry: Any) -> list[Any]:
    """What a message of an entry holds, bit for bit: a number that is None is nan, and an array is empty."""
    content, kind = list[Any](), cast("type[Any]", type(entry))
    for name, hint in _fields(kind).items():
        value = getattr(entry, name)
        if value is None:
            content.append(math.nan if hint in _PLAIN else ())
        elif hint in _JSON:
            content.append(json.dumps(codec.encode(value)))
        else:
            content.append(value if hint in _PLAIN else value.ravel())
    return content


def entry_of(topic: str, content: Mapping[str, Any]) -> Any:
    """The entry again.

    Args:
        topic: Where it was recorded.
        content: Of the message, by field.

    Raises:
        KeyError: If a field is missing.
        BadKey: If a text in it is not as it may be.
        ValueError: If it is no such entry.
    """
    values: dict[str, Any] = {}
    for name, hint in _fields(TOPICS[topic]).items():
        value = content[name]
        if hint in _JSON:
            value = codec.decode(hint, json.loads(value), name)
        elif hint not in _PLAIN:
            value = np.array(value, dtype=np.float64).reshape((3, 3) if name == "rotation" and len(value) else -1)
        is_nothing = value.size == 0 if isinstance(value, np.ndarray) else value != value
        values[name] = None if is_nothing and type(None) in get_args(hint) else value
    return TOPICS[topic](**values)
