"""Inputs, state and outputs of a tick of an operation."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from laticauda.control.estimation import Estimate, PoseSample
from laticauda.tank import protocol
from laticauda.tank.operate.procedure.clocks import ClockState
from laticauda.tank.operate.procedure.reference_source import ReferenceState
from laticauda.tank.operate.procedure.sensed import SensedState
from laticauda.tank.operate.procedure.stillness import Pose, TimedPose
from laticauda.tank.operate.recording.entries import Entry, Event, PowerReading, SensorSample
from laticauda.tank.operate.safety.limits import LimitState
from laticauda.tank.operate.safety.modules import Modules
from laticauda.tank.operate.safety.supervisor import PHASES, Phase, SupervisorState


@dataclass(frozen=True, kw_only=True)
class MeanCurrent:
    """Mean current over the readings of a period, such as I_0 at rest."""

    total: float = 0.0
    """Sum of the readings [A]."""
    count: int = 0
    """Number of readings [-]."""

    def step(self, current: float) -> "MeanCurrent":
        """Return the mean with one more reading of the `current` [A]."""
        return MeanCurrent(total=self.total + current, count=self.count + 1)

    @property
    def mean(self) -> float | None:
        """Mean current [A]; None without a reading."""
        if not self.count:
            return None
        return self.total / self.count


@dataclass(frozen=True, kw_only=True, eq=False)
class Inputs:
    """Data received since the last tick."""

    messages: tuple[tuple[float, protocol.CanMessage], ...] = ()
    """Messages from the bus, with their arrival times [s]."""
    frames: tuple[tuple[float, PoseSample], ...] = ()
    """Frames from the motion capture, with their arrival times [s]; their own times are on the
    cameras' clock, and they are in the tank frame."""
    readings: tuple[PowerReading, ...] = ()
    """Readings of the power meter, on our clock."""
    sensed: tuple[tuple[float, SensorSample], ...] = ()
    """Samples of the robot's own sensors, with their arrival times [s]; their own times are on the
    robot's clock."""
    events: Mapping[str, str] = field(default_factory=dict[str, str])
    """Events from drivers, recorder and operator, by their names in the supervisor's table, each
    with a sentence."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Outputs:
    """Outputs of a tick."""

    messages: tuple[protocol.CanMessage, ...] = ()
    """Messages to the bus, in this order."""
    entries: tuple[Entry, ...] = ()
    """Entries to record: the samples that the estimator got, in that order, on our clock and in the
    path frame, the power meter's readings, those of the robot's own sensors, the estimate, the
    controller's decision if one was due, and events."""

    @property
    def events(self) -> tuple[Event, ...]:
        """Events among the entries."""
        return tuple(entry for entry in self.entries if isinstance(entry, Event))


@dataclass(frozen=True, kw_only=True, eq=False)
class Prepared:
    """Results of the preparations."""

    marker_turned: float = 0.0
    """Measured rotation of the marker body on its module relative to what the trial file says
    [rad]."""
    angle: tuple[np.ndarray, ...] = ()
    """Joint angles of the limp robot [rad]."""
    rotation: tuple[np.ndarray, ...] = ()
    """Rotations of the marker body, path frame [-]."""
    sets_zero: bool = False
    """Whether the modules are to take their present angles as zero."""
    recent_poses: tuple[TimedPose, ...] = ()
    """Where the robot was in the last moments."""
    start: Pose | None = None
    """Where the robot at rest is, path frame: p_y(0) and theta(0)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OperatorState:
    """State of an operation."""

    phase: Phase = PHASES[0]
    """What the operation is doing."""
    since: float | None = None
    """When the phase began [s]; None before the first tick."""
    now: float | None = None
    """Time of the last tick [s]; None before the first."""
    supervisor: SupervisorState
    """State of the safety supervisor."""
    limits: LimitState
    """State of the limits."""
    modules: Modules
    """State of the modules."""
    estimator: Any
    """State of the state estimation."""
    estimate: Estimate | None = None
    """Estimate of where the robot is, path frame; None before it is known."""
    clock: ClockState | None = None
    """Offset of the cameras' clock."""
    frame_time: float | None = None
    """Time at which the cameras last saw the robot [s]; None before."""
    reading: PowerReading | None = None
    """Last reading of the power meter."""
    sensed: SensedState = field(default_factory=SensedState)
    """What the robot's own sensors told."""
    idle: MeanCurrent = field(default_factory=MeanCurrent)
    """Current at rest, before the run."""
    drawn: MeanCurrent = field(default_factory=MeanCurrent)
    """Current during the run."""
    reference: ReferenceState
    """State of the joint references."""
    prepared: Prepared
    """Results of the preparations."""
    begun: float | None = None
    """When the run began [s]; None before."""
    ended: float | None = None
    """When the run ended [s]; None before."""
    stopped_by: str = ""
    """The event that ended the run; "" if it reached its end."""
    failure: str = ""
    """Why the operation is given up before the run; "" if it is not."""
    error: str = ""
    """What went wrong in our own program at the last tick."""
    notes: tuple[str, ...] = ()
    """Events of the run that did not stop it."""
    lost_meter: bool = False
    """Whether the power meter was silent during the run, whenever it fell silent."""
    ordered: float = -1e9
    """Time at which the last order was sent that is waiting to be obeyed [s]."""
    sync: int = 0
    """Counter of the next Sync [-]."""

    @property
    def is_done(self) -> bool:
        """Whether nothing is left to do."""
        return self.phase == "done"
