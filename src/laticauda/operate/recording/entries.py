"""What a recording holds beside the estimator's samples and estimates, and all of it as numbers, bit for bit.

A schema says how an entry is an array: what may be missing is nan; what is of variable length comes last, behind its
length.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias, get_args

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument
from laticauda.estimation import Estimate, JointSample, PoseSample, ReferenceSample
from laticauda.estimation.samples import Status
from laticauda.interfaces import Command
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


Numbers: TypeAlias = Float[np.ndarray, " _"]
ESTIMATE, IN_SPACE = "/estimate", "/estimate/in_space"
OPTIONAL = ("rotation", "rate", "torque", "current", "average", "minimum", "maximum", "since")
"""Fields that are None where nothing was measured."""
_STATUS = get_args(Status)


@dataclass(frozen=True)
class Schema:
    """The fields of one kind of message in their order."""

    kind: type[Any]
    """Its class."""
    label: str
    """What the numbers are, each in SI units."""
    layout: str
    """The fields, and behind a colon how many numbers one has that is an array: a number, `n` or `n+1`, where the field
    `n` says how many joints there are, or `...` for the rest."""

    @cached_property
    def fields(self) -> tuple[tuple[str, str], ...]:
        """Names and sizes; "" is the size of a plain number."""
        return tuple((name, size) for name, _, size in (word.partition(":") for word in self.layout.split()))

    def pack(self, entry: Any) -> Numbers:
        """An entry of this kind as numbers."""
        n = entry.joint_angle.size if isinstance(entry, Estimate) else getattr(entry, "angle", np.zeros(0)).size
        flat: list[float] = []  # quicker than arrays, for so few numbers
        for name, size in self.fields:
            value: Any = n if name == "n" else getattr(entry, name)
            if value is None:
                flat += [np.nan] * _count(size, n)
            elif not size:
                flat.append(_STATUS.index(value) if name == "status" else value)
            else:
                flat += value.ravel().tolist()
        return np.array(flat, dtype=np.float64)

    def unpack(self, topic: str, numbers: Sequence[float] | Numbers) -> Any:
        """The entry again.

        Args:
            topic: Where it was recorded.
            numbers: As `pack` made them.

        Raises:
            ValueError: If they are too few or too many, or no such entry.
        """
        data = np.asarray(numbers, dtype=np.float64)
        values: dict[str, Any] = {}
        at = n = 0
        for name, size in self.fields:
            count = data.size - at if size == "..." else _count(size, n)
            part = data[at : at + count].copy()
            at += count
            if name == "n":
                n = int(part[0]) if part.size else 0
            else:
                values[name] = _value(name, size, part) if part.size == count else None
        if at != data.size:
            raise BadArgument(topic, f"must hold {at} numbers, got {data.size}")
        return self.kind(**values)


def _count(size: str, n: int) -> int:
    return {"": 1, "n": n, "n+1": n + 1}[size] if size in ("", "n", "n+1") else int(size)


def _value(name: str, size: str, part: Numbers) -> Any:
    if name in OPTIONAL and np.isnan(part).all():
        return None
    if name == "status":
        return _STATUS[int(part[0])]
    if name == "rotation":
        return part.reshape(3, 3)
    return part if size else float(part[0])


SCHEMAS: dict[str, Schema] = {
    "/sample/pose": Schema(
        PoseSample, "time, x, y, z, rotation row by row, residual", "time position:3 rotation:9 residual"
    ),
    "/sample/joints": Schema(JointSample, "time, n, n angles, n rates, n torques", "time n angle:n rate:n torque:n"),
    "/sample/references": Schema(ReferenceSample, "time, frequency, angles", "time frequency angle:..."),
    "/sample/power": Schema(
        PowerReading,
        "time, current, average, minimum, maximum, since",
        "time current average minimum maximum since",
    ),
    ESTIMATE: Schema(
        Estimate,
        "time, status, age, center of mass, its velocity, heading, heading rate, std of center of mass, "
        "std of heading, current, its std, n joints, n joint angles, n joint rates, n + 1 link angles",
        "time status age center_of_mass:2 center_of_mass_velocity:2 heading heading_rate center_of_mass_std "
        "heading_std current:2 current_std n joint_angle:n joint_rate:n link_angle:n+1",
    ),
    IN_SPACE: Schema(
        Estimate,
        "time, status, age, center of mass, its velocity, heading, heading rate, pitch, "
        "n joints, n joint angles, n joint rates, n + 1 link angles",
        "time status age center_of_mass:3 center_of_mass_velocity:3 heading heading_rate pitch "
        "n joint_angle:n joint_rate:n link_angle:n+1",
    ),
}
_TOPICS = {schema.kind: topic for topic, schema in SCHEMAS.items() if topic != IN_SPACE}


def topic_of(entry: Measurement | Estimate) -> str:
    """Where an entry is recorded."""
    return IN_SPACE if isinstance(entry, Estimate) and entry.center_of_mass.size == 3 else _TOPICS[type(entry)]
