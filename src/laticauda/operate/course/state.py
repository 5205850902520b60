"""What a tick of an operation takes, keeps and gives, and how what came in becomes samples and an estimate."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from laticauda import kinematics, protocol
from laticauda.estimation import Estimate, JointSample, PoseSample, ReferenceSample, Sample, StateEstimator
from laticauda.operate.course.reference_source import ReferenceState
from laticauda.operate.recording.entries import Entry, Event, Measurement, PowerReading
from laticauda.operate.safety.limits import LimitState, Modules, updated
from laticauda.operate.safety.supervisor import PHASES, SupervisorState
from laticauda.operate.settings import CaptureVolume, Operation

CLOCK_WINDOW = 5.0  # in which the smallest latency of the cameras is looked for [s]
Places = tuple[tuple[float, float, float, float], ...]


class ClockState(NamedTuple):
    """What is known of another clock: the smallest differences of this window of time and of the one before."""

    smallest: float
    """Since the window began, own clock minus the other [s]."""
    before: float
    """In the window before [s]."""
    began: float
    """The window, own clock [s]."""

    @property
    def offset(self) -> float:
        """Own clock minus the other, with the smallest latency in it [s]."""
        return min(self.smallest, self.before)


def clock_after(state: ClockState | None, arrival: float, stamp: float, window: float = CLOCK_WINDOW) -> ClockState:
    """What is known of the difference of two clocks after one more frame.

    A frame is never early: own time of arrival minus its stamp is the offset plus a latency >= 0. The smallest one of
    the last seconds is the best estimate, and the smallest latency itself stays in it. What is older is forgotten:
    clocks drift, and the cameras' clock may jump, when their computer stalls or the measurement is begun anew.

    Args:
        state: As the last call returned it; None: nothing is known.
        arrival: Of the frame, own clock [s].
        stamp: Of the frame, the other clock [s].
        window: For so long a smallest latency counts at least, and for twice as long at most [s].
    """
    difference = arrival - stamp
    if state is None or arrival - state.began >= 2.0 * window:
        return ClockState(smallest=difference, before=difference, began=arrival)
    if arrival - state.began >= window:
        return ClockState(smallest=difference, before=state.smallest, began=arrival)
    return state._replace(smallest=min(state.smallest, difference))


@dataclass(frozen=True, kw_only=True)
class MeanCurrent:
    """A mean over the readings of a time: I_0 at rest."""

    total: float = 0.0
    """Sum [A]."""
    count: int = 0
    """Number of readings [-]."""

    def step(self, current: float) -> "MeanCurrent":
        """With one more reading of a `current` [A]."""
        return MeanCurrent(total=self.total + current, count=self.count + 1)

    @property
    def mean(self) -> float | None:
        """[A]; None without a reading."""
        return self.total / self.count if self.count else None


@dataclass(frozen=True, kw_only=True, eq=False)
class Inputs:
    """What came in since the last tick."""

    messages: tuple[tuple[float, protocol.CanMessage], ...] = ()
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

    messages: tuple[protocol.CanMessage, ...] = ()
    """To the bus, in this order."""
    entries: tuple[Entry, ...] = ()
    """To be recorded: what the estimator took, in that order, on our clock and in the path frame, the power meter's
    readings, the estimate, what the controller decided if it was due, and what happened."""

    @property
    def events(self) -> tuple[Event, ...]:
        """What happened."""
        return tuple(entry for entry in self.entries if isinstance(entry, Event))


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


# ---- what came in ----------------------------------------------------------------------------------------------------


def take_in(
    operation: Operation, estimator: StateEstimator, state: OperatorState, now: float, inputs: Inputs
) -> tuple[OperatorState, tuple[Measurement, ...]]:
    """The latest of everything, and the estimate.

    Args:
        operation: Whose tank and calibration they are.
        estimator: The state estimation.
        state: Before.
        now: [s].
        inputs: What came in since the last tick.

    Returns:
        The state, and what the estimator got, in that order; then the power meter's readings.
    """
    modules = updated(state.modules, inputs.messages)
    samples: list[Sample] = [*_references(state), *(_joints(state, modules) if inputs.messages else ())]
    for arrival, frame in inputs.frames:
        clock = clock_after(state.clock, arrival, frame.time)
        pose = _pose(operation.tank, frame, clock.offset, state.prepared.marker_turned)
        samples.append(pose)
        state = replace(state, clock=clock, frame_time=state.frame_time if pose.is_lost else arrival)
    rotations = tuple(s.rotation for s in samples if isinstance(s, PoseSample) and s.rotation is not None)
    if state.phase == "calibrating":
        rotations = (*state.prepared.rotation, *rotations)
    state = replace(state, modules=modules, error="", prepared=replace(state.prepared, rotation=rotations))
    for reading in inputs.readings:
        idle = state.idle.step(reading.current) if state.phase == "idle_current" else state.idle
        drawn = state.drawn.step(reading.current) if state.phase == "running" else state.drawn
        state = replace(state, reading=reading, idle=idle, drawn=drawn)
    return _estimated(estimator, state, now, samples), (*samples, *inputs.readings)


def _pose(tank: CaptureVolume, frame: PoseSample, offset: float, turned: float) -> PoseSample:
    """A frame on our clock, in the path frame, and of a marker body that sits as the trial file says."""
    rotation = frame.rotation
    if rotation is not None:
        rotation = kinematics.turn("yaw", -tank.path_heading) @ rotation @ kinematics.turn("yaw", -turned)
    position = tank.to_path(frame.position)
    return PoseSample(time=frame.time + offset, position=position, rotation=rotation, residual=frame.residual)


def _estimated(estimator: StateEstimator, state: OperatorState, now: float, samples: list[Sample]) -> OperatorState:
    """The estimate with the samples; an error in it stops the robot, and not the program."""
    try:
        after = estimator.steps(state.estimator, samples)
        return replace(state, estimator=after, estimate=estimator.estimate(after, now))
    except Exception as error:
        return replace(state, estimate=None, error=f"state estimation: {error}")


def _references(state: OperatorState) -> tuple[ReferenceSample, ...]:
    """The references that went out at the last tick."""
    if state.now is None or not state.supervisor.sends_references:
        return ()
    gait = state.reference.command.gait if state.phase == "running" and state.reference.command else None
    frequency = 0.0 if gait is None else gait.frequency
    return (ReferenceSample(time=state.now, angle=state.reference.references, frequency=frequency),)


def _joints(state: OperatorState, modules: Modules) -> tuple[JointSample, ...]:
    """What the modules answered to the Sync with which the last tick ended."""
    fresh = modules.angle_time >= (np.inf if state.now is None else state.now)
    if state.now is None or not fresh.any():
        return ()
    angle, rate, torque = (np.where(fresh, one, np.nan) for one in (modules.angle, modules.rate, modules.torque))
    return (JointSample(time=state.now, angle=angle, rate=rate, torque=torque),)
