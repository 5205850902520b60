"""What a tick of an operation takes, keeps and gives."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from laticauda.estimation import Estimate, PoseSample
from laticauda.interfaces import Command
from laticauda.operate.course.calibration import ClockState, MeanCurrent, Places
from laticauda.operate.course.reference_source import ReferenceState
from laticauda.operate.recording.entries import Event, Measurement, PowerReading
from laticauda.operate.safety.limits import LimitState
from laticauda.operate.safety.modules import Modules
from laticauda.operate.safety.supervisor import SupervisorState
from laticauda.operate.safety.transitions import PHASES
from laticauda.protocol import CanMessage


@dataclass(frozen=True, kw_only=True, eq=False)
class Inputs:
    """What came in since the last tick."""

    messages: tuple[tuple[float, CanMessage], ...] = ()
    """From the bus, with the time of their arrival [s]."""
    frames: tuple[tuple[float, PoseSample], ...] = ()
    """From the motion capture, with the time of their arrival [s]; their own time is that of the cameras' clock, and
    they are in the tank frame."""
    readings: tuple[PowerReading, ...] = ()
    """From the power meter, on our clock."""
    events: Mapping[str, str] = field(default_factory=dict[str, str])
    """What drivers, recorder and operator say, by the names of the supervisor's table, with a sentence each."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Outputs:
    """What goes out."""

    messages: tuple[CanMessage, ...] = ()
    """To the bus, in this order."""
    samples: tuple[Measurement, ...] = ()
    """What the estimator took, in that order, on our clock and in the path frame; then the power meter's readings."""
    estimate: Estimate | None = None
    """Where the robot is; None before it is known."""
    command: Command | None = None
    """What the controller decided at this tick; None where it was not due."""
    signals: Mapping[str, float] = field(default_factory=dict[str, float])
    """Its signals, by name."""
    events: tuple[Event, ...] = ()
    """For the log."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Prepared:
    """What the preparations found."""

    marker_turned: float = 0.0
    """By how much the marker body sits otherwise on its module than the trial file says, as measured [rad]."""
    angle: tuple[np.ndarray, ...] = ()
    """Joint angles of the limp robot [rad]."""
    rotation: tuple[np.ndarray, ...] = ()
    """Of the marker body, path frame [-]."""
    sets_zero: bool = False
    """Whether the modules are to take their angles as zero."""
    places: Places = ()
    """Where the robot was in the last moments."""
    start: tuple[float, float, float] | None = None
    """Center of mass [m, m] and heading [rad] of the robot at rest, path frame: p_y(0) and theta(0)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OperatorState:
    """Where an operation stands."""

    phase: str = PHASES[0]
    """One of `PHASES`."""
    since: float | None = None
    """When the phase began [s]; None before the first tick."""
    now: float | None = None
    """Time of the last tick [s]; None before the first."""
    supervisor: SupervisorState
    """The safety supervisor's."""
    limits: LimitState
    """Of the limits."""
    modules: Modules
    """What the modules say."""
    estimator: Any
    """State of the state estimation."""
    estimate: Estimate | None = None
    """Where the robot is, path frame; None before it is known."""
    clock: ClockState | None = None
    """Offset of the cameras' clock."""
    frame_time: float | None = None
    """When the cameras saw the robot last; None before [s]."""
    reading: PowerReading | None = None
    """The last one of the power meter."""
    idle: MeanCurrent = field(default_factory=MeanCurrent)
    """Current at rest, before the run."""
    drawn: MeanCurrent = field(default_factory=MeanCurrent)
    """Current of the run."""
    reference: ReferenceState
    """The references of the joints."""
    prepared: Prepared
    """What the preparations found."""
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
    ordered: float = -1e9
    """When the last order went out that waits to be obeyed [s]."""
    sync: int = 0
    """Counter of the next Sync [-]."""

    @property
    def is_done(self) -> bool:
        """Whether nothing is left to do."""
        return self.phase == "done"
