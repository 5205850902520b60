"""Entries of a recording: everything that is kept of an operation, besides raw frames of the bus."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda.control.estimation import Estimate, JointSample, Learned, PoseSample, ReferenceSample
from laticauda.scenarios import interfaces
from laticauda.tank.operate.recording.timing import Tick
from laticauda.tank.operate.safety.supervisor import Phase
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


@dataclass(frozen=True, kw_only=True, eq=False)
class SensorSample:
    """Reading of one of the robot's own sensors; without values, it says that there is this sensor."""

    time: float
    """When it was measured [s]."""
    sensor: str
    """Name of the sensor."""
    columns: tuple[str, ...]
    """Names of its values."""
    values: Float[np.ndarray, " n_columns"]
    """Its values, nan where there is none; empty: nothing has been measured yet."""
    n_lost: float = 0.0
    """Number of its readings that were lost on the way since the one before [-]."""

    @property
    def has_values(self) -> bool:
        """Whether something was measured."""
        return self.values.size > 0


EventKind: TypeAlias = (
    Phase
    | Literal[
        "failed",
        "phase",
        "start",
        "stop",
        "state",
        "fault",
        "torque",
        "loop",
        "verdict",
        "learned",
        "changed",
    ]
)
"""Kind of an event.

    connecting, ...  what a phase before the run has found
    failed           why the operation is given up before the run
    phase            the operation goes to another phase
    start, stop      the run begins, or ends
    state, fault     the supervisor reacts; fault: to what somebody has to look at
    torque           what the motors are told
    loop             what the system allowed the loop
    verdict          verdict on the run
    learned, changed what the twin has learned, and what has changed
"""


@dataclass(frozen=True, kw_only=True)
class Event:
    """Something that happened, or a state that was entered."""

    time: float
    """Time of the event [s]."""
    kind: EventKind
    """Kind of event; other versions may have recorded other ones."""
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


Measurement: TypeAlias = PoseSample | JointSample | ReferenceSample | PowerReading | SensorSample
"""What was received from the devices, and the references that were sent."""
Entry: TypeAlias = Measurement | Estimate | Decision | Event | Tick | Learned
"""What is recorded of an operation, besides the raw frames of the bus."""
