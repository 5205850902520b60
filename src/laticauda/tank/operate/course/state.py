"""Inputs, state and outputs of a tick of an operation, and how inputs become samples and an estimate."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from laticauda.control.estimation import (
    Estimate,
    JointSample,
    PoseSample,
    ReferenceSample,
    Sample,
    StateEstimator,
)
from laticauda.robot import kinematics
from laticauda.tank import protocol
from laticauda.tank.operate.course.reference_source import ReferenceState
from laticauda.tank.operate.recording.entries import Entry, Event, Measurement, PowerReading
from laticauda.tank.operate.safety.limits import LimitState, Modules, updated
from laticauda.tank.operate.safety.supervisor import PHASES, SupervisorState
from laticauda.tank.operate.settings import CaptureVolume, Operation

CLOCK_WINDOW = 5.0  # window in which the smallest latency of the cameras is found [s]
Places = tuple[tuple[float, float, float, float], ...]


class ClockState(NamedTuple):
    """What is known about another clock: the smallest differences in this time window and in the one before."""

    smallest: float
    """Smallest difference since the window began, own clock minus the other [s]."""
    before: float
    """Smallest difference in the window before [s]."""
    began: float
    """Time at which the window began, own clock [s]."""

    @property
    def offset(self) -> float:
        """Own clock minus the other, including the smallest latency [s]."""
        return min(self.smallest, self.before)


def clock_after(
    state: ClockState | None, arrival: float, stamp: float, window: float = CLOCK_WINDOW
) -> ClockState:
    """Update what is known about the difference of two clocks with one more frame.

    A frame is never early: its arrival on our own clock minus its stamp is the offset plus a
    latency >= 0. The smallest difference of the last seconds is the best estimate; it includes the
    smallest latency. Older ones are forgotten: clocks drift, and the cameras' clock may jump when
    their computer stalls or the measurement is restarted.

    Args:
        state: State returned by the last call; None: nothing is known.
        arrival: Arrival time of the frame, own clock [s].
        stamp: Timestamp of the frame, the other clock [s].
        window: Shortest time for which a smallest latency counts; the longest is twice this [s].
    """
    difference = arrival - stamp
    if state is None or arrival - state.began >= 2.0 * window:
        return ClockState(smallest=difference, before=difference, began=arrival)
    if arrival - state.began >= window:
        return ClockState(smallest=difference, before=state.smallest, began=arrival)
    return state._replace(smallest=min(state.smallest, difference))


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
        return self.total / self.count if self.count else None


@dataclass(frozen=True, kw_only=True, eq=False)
class Inputs:
    """Data received since the last tick."""

    messages: tuple[tuple[float, protocol.CanMessage], ...] = ()
    """Messages from the bus, with their arrival times [s]."""
    frames: tuple[tuple[float, PoseSample], ...] = ()
    """Frames from the motion capture, with their arrival times [s]; their own times are on the cameras' clock, and they
    are in the tank frame."""
    readings: tuple[PowerReading, ...] = ()
    """Readings of the power meter, on our clock."""
    events: Mapping[str, str] = field(default_factory=dict[str, str])
    """Events from drivers, recorder and operator, by their names in the supervisor's table, each with a sentence."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Outputs:
    """Outputs of a tick."""

    messages: tuple[protocol.CanMessage, ...] = ()
    """Messages to the bus, in this order."""
    entries: tuple[Entry, ...] = ()
    """Entries to record: the samples that the estimator got, in that order, on our clock and in the path frame, the
    power meter's readings, the estimate, the controller's decision if one was due, and events."""

    @property
    def events(self) -> tuple[Event, ...]:
        """Events among the entries."""
        return tuple(entry for entry in self.entries if isinstance(entry, Event))


@dataclass(frozen=True, kw_only=True, eq=False)
class Prepared:
    """Results of the preparations."""

    marker_turned: float = 0.0
    """Measured rotation of the marker body on its module relative to what the trial file says [rad]."""
    angle: tuple[np.ndarray, ...] = ()
    """Joint angles of the limp robot [rad]."""
    rotation: tuple[np.ndarray, ...] = ()
    """Rotations of the marker body, path frame [-]."""
    sets_zero: bool = False
    """Whether the modules are to take their present angles as zero."""
    places: Places = ()
    """Places of the robot in the last moments."""
    start: tuple[float, float, float] | None = None
    """Center of mass [m, m] and heading [rad] of the robot at rest, path frame: p_y(0) and theta(0)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OperatorState:
    """State of an operation."""

    phase: str = PHASES[0]
    """One of `PHASES`."""
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
    ordered: float = -1e9
    """Time at which the last order was sent that is waiting to be obeyed [s]."""
    sync: int = 0
    """Counter of the next Sync [-]."""

    @property
    def is_done(self) -> bool:
        """Whether nothing is left to do."""
        return self.phase == "done"


# ---- what came in --------------------------------------------------------------------------------


def take_in(
    operation: Operation,
    estimator: StateEstimator,
    state: OperatorState,
    now: float,
    inputs: Inputs,
) -> tuple[OperatorState, tuple[Measurement, ...]]:
    """Take in the inputs of a tick, and update the estimate.

    Args:
        operation: Operation that defines tank and calibration.
        estimator: The state estimation.
        state: State before.
        now: Current time [s].
        inputs: Data received since the last tick.

    Returns:
        The new state; and the samples that the estimator got, in that order, then the power meter's
        readings.
    """
    modules = updated(state.modules, inputs.messages)
    samples: list[Sample] = [
        *_references(state),
        *(_joints(state, modules) if inputs.messages else ()),
    ]
    for arrival, frame in inputs.frames:
        clock = clock_after(state.clock, arrival, frame.time)
        pose = _pose(operation.tank, frame, clock.offset, state.prepared.marker_turned)
        samples.append(pose)
        state = replace(
            state, clock=clock, frame_time=state.frame_time if pose.is_lost else arrival
        )
    rotations = tuple(
        s.rotation for s in samples if isinstance(s, PoseSample) and s.rotation is not None
    )
    if state.phase == "calibrating":
        rotations = (*state.prepared.rotation, *rotations)
    state = replace(
        state, modules=modules, error="", prepared=replace(state.prepared, rotation=rotations)
    )
    for reading in inputs.readings:
        idle = state.idle.step(reading.current) if state.phase == "idle_current" else state.idle
        drawn = state.drawn.step(reading.current) if state.phase == "running" else state.drawn
        state = replace(state, reading=reading, idle=idle, drawn=drawn)
    return _estimated(estimator, state, now, samples), (*samples, *inputs.readings)


def _pose(tank: CaptureVolume, frame: PoseSample, offset: float, turned: float) -> PoseSample:
    """Convert a frame to our clock, to the path frame, and to a marker body mounted as in the trial file."""
    rotation = frame.rotation
    if rotation is not None:
        rotation = (
            kinematics.turn("yaw", -tank.path_heading) @ rotation @ kinematics.turn("yaw", -turned)
        )
    position = tank.to_path(frame.position)
    return PoseSample(
        time=frame.time + offset, position=position, rotation=rotation, residual=frame.residual
    )


def _estimated(
    estimator: StateEstimator, state: OperatorState, now: float, samples: list[Sample]
) -> OperatorState:
    """Update the estimate with the samples; an error in it stops the robot, not the program."""
    try:
        after = estimator.steps(state.estimator, samples)
        return replace(state, estimator=after, estimate=estimator.estimate(after, now))
    except Exception as error:
        return replace(state, estimate=None, error=f"state estimation: {error}")


def _references(state: OperatorState) -> tuple[ReferenceSample, ...]:
    """Return the references that were sent at the last tick."""
    if state.now is None or not state.supervisor.sends_references:
        return ()
    gait = (
        state.reference.command.gait
        if state.phase == "running" and state.reference.command
        else None
    )
    frequency = 0.0 if gait is None else gait.frequency
    return (ReferenceSample(time=state.now, angle=state.reference.references, frequency=frequency),)


def _joints(state: OperatorState, modules: Modules) -> tuple[JointSample, ...]:
    """Return the modules' answers to the Sync that ended the last tick."""
    fresh = modules.angle_time >= (np.inf if state.now is None else state.now)
    if state.now is None or not fresh.any():
        return ()
    angle, rate, torque = (
        np.where(fresh, one, np.nan) for one in (modules.angle, modules.rate, modules.torque)
    )
    return (JointSample(time=state.now, angle=angle, rate=rate, torque=torque),)
