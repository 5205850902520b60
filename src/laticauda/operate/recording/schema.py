"""How samples and estimates are arrays of numbers in a recording, bit for bit: one row of fields per kind.

Everything that may be missing is nan; what is of variable length comes last, behind its length.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias, get_args

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument
from laticauda.estimation import Estimate, JointSample, PoseSample, ReferenceSample
from laticauda.estimation.estimate import Status
from laticauda.operate.recording.entries import Measurement, PowerReading

Numbers: TypeAlias = Float[np.ndarray, " _"]
ESTIMATE = "/estimate"
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
    fields: tuple[tuple[str, int | str], ...]
    """Names, and how many numbers each has: 0 for a plain one, `n` or `n + 1` where that is the number of joints, which
    the field of that name says, and `...` for the rest."""

    def pack(self, entry: Any) -> Numbers:
        """An entry of this kind as numbers."""
        n = entry.angle.size if isinstance(entry, JointSample) else 0
        n = entry.joint_angle.size if isinstance(entry, Estimate) else n
        flat: list[float] = []  # quicker than arrays, for so few numbers
        for name, size in self.fields:
            value: Any = n if name == "n" else getattr(entry, name)
            if value is None:
                flat += [math.nan] * _count(size, n)
            elif size == 0:
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


def _count(size: int | str, n: int) -> int:
    return max(size, 1) if isinstance(size, int) else {"n": n, "n + 1": n + 1}[size]


def _value(name: str, size: int | str, part: Numbers) -> Any:
    if name in OPTIONAL and np.isnan(part).all():
        return None
    if name == "status":
        return _STATUS[int(part[0])]
    if name == "rotation":
        return part.reshape(3, 3)
    return float(part[0]) if size == 0 else part


SCHEMAS: dict[str, Schema] = {
    "/sample/pose": Schema(
        PoseSample,
        "time, x, y, z, rotation row by row, residual",
        (("time", 0), ("position", 3), ("rotation", 9), ("residual", 0)),
    ),
    "/sample/joints": Schema(
        JointSample,
        "time, n, n angles, n rates, n torques",
        (("time", 0), ("n", 0), ("angle", "n"), ("rate", "n"), ("torque", "n")),
    ),
    "/sample/references": Schema(
        ReferenceSample, "time, frequency, angles", (("time", 0), ("frequency", 0), ("angle", "..."))
    ),
    "/sample/power": Schema(
        PowerReading,
        "time, current, average, minimum, maximum, since",
        (("time", 0), ("current", 0), ("average", 0), ("minimum", 0), ("maximum", 0), ("since", 0)),
    ),
    ESTIMATE: Schema(
        Estimate,
        "time, status, age, center of mass, its velocity, heading, heading rate, std of center of mass, "
        "std of heading, current, its std, n joints, n joint angles, n joint rates, n + 1 link angles",
        (
            ("time", 0),
            ("status", 0),
            ("age", 0),
            ("center_of_mass", 2),
            ("center_of_mass_velocity", 2),
            ("heading", 0),
            ("heading_rate", 0),
            ("center_of_mass_std", 0),
            ("heading_std", 0),
            ("current", 2),
            ("current_std", 0),
            ("n", 0),
            ("joint_angle", "n"),
            ("joint_rate", "n"),
            ("link_angle", "n + 1"),
        ),
    ),
}
_TOPICS = {schema.kind: topic for topic, schema in SCHEMAS.items()}


def topic_of(entry: Measurement | Estimate) -> str:
    """Where an entry is recorded."""
    return _TOPICS[type(entry)]


def pack(entry: Measurement | Estimate) -> Numbers:
    """A sample, reading or estimate as numbers."""
    return SCHEMAS[topic_of(entry)].pack(entry)


def unpack(topic: str, numbers: Sequence[float] | Numbers) -> Any:
    """The sample, reading or estimate again.

    Args:
        topic: Where it was recorded.
        numbers: As `pack` made them.

    Raises:
        ValueError: If they are too few or too many, or no such entry.
    """
    return SCHEMAS[topic].unpack(topic, numbers)
