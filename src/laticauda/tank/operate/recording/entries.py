"""Entries of a recording: everything that is kept of an operation, besides raw frames of the bus."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from laticauda.control.estimation import Estimate, JointSample, Learned, PoseSample, ReferenceSample
from laticauda.scenarios import interfaces
from laticauda.tank.operate.recording.timing import Tick
from laticauda.values import quantity, value_class


@value_class
class PowerReading:
    """Reading of the power meter in the supply cable."""

    time: float = quantity("s", "When it was read")
    current: float = quantity("A", "Present current")
    average: float | None = quantity(
        "A", "Since the meter was reset; None if it was not queried", default=None
    )
    minimum: float | None = quantity("A", "Since the meter was reset", default=None)
    maximum: float | None = quantity("A", "Since the meter was reset", default=None)
    since: float | None = quantity(
        "s", "When the meter was reset; None if that is not known", default=None
    )


@dataclass(frozen=True, kw_only=True)
class Event:
    """Something that happened, or a state that was entered."""

    time: float
    """Time of the event [s]."""
    kind: str
    """Kind of event: `state`, `fault`, `rejected`, `operator` and so on."""
    message: str
    """Description in one sentence."""
    data: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """Further data: texts and numbers by name."""


@dataclass(frozen=True, kw_only=True)
class Decision:
    """What a controller decided at one control instant."""

    time: float
    """Time of the estimate on which the decision is based [s]."""
    command: interfaces.Command
    """Command that it decided on."""
    signals: Mapping[str, float]
    """Signals of the controller, by name."""


Measurement: TypeAlias = PoseSample | JointSample | ReferenceSample | PowerReading
"""What was received from the devices, and the references that were sent."""
Entry: TypeAlias = Measurement | Estimate | Decision | Event | Tick | Learned
"""What is recorded of an operation, besides the raw frames of the bus."""
