"""What a recording holds beside the estimator's samples and estimates."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from laticauda.errors import finite
from laticauda.estimation import JointSample, PoseSample, ReferenceSample
from laticauda.interfaces import Command


@dataclass(frozen=True, kw_only=True)
class PowerReading:
    """What the power meter in the supply cable says."""

    time: float
    """When it was read [s]."""
    current: float
    """Now [A]."""
    average: float | None = None
    """Since the meter was reset; None if it was not queried [A]."""
    minimum: float | None = None
    """Since the meter was reset [A]."""
    maximum: float | None = None
    """Since the meter was reset [A]."""
    since: float | None = None
    """When the meter was reset; None if that is not known [s]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        object.__setattr__(self, "time", finite("time", self.time, "s"))
        object.__setattr__(self, "current", finite("current", self.current, "A"))


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
