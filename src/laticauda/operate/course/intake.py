"""What came in at a tick, made into samples on our clock and in the path frame, and into the estimate."""

from dataclasses import replace

import numpy as np

from laticauda.estimation import JointSample, PoseSample, ReferenceSample, Sample, StateEstimator
from laticauda.operate.course.calibration import ClockOffset
from laticauda.operate.course.state import Inputs, OperatorState
from laticauda.operate.recording.entries import Measurement
from laticauda.operate.safety.modules import Modules, updated
from laticauda.operate.settings import CaptureVolume, Operation


def step(
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
        clock = ClockOffset().step(state.clock, arrival, frame.time)
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
        rotation = _about_z(-tank.path_heading) @ rotation @ _about_z(-turned)
    position = tank.to_path(frame.position)
    return PoseSample(time=frame.time + offset, position=position, rotation=rotation, residual=frame.residual)


def _estimated(estimator: StateEstimator, state: OperatorState, now: float, samples: list[Sample]) -> OperatorState:
    """The estimate with the samples; an error in it stops the robot, and not the program."""
    after = state.estimator
    try:
        for sample in samples:
            after = estimator.step(after, sample)
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


def _about_z(angle: float) -> np.ndarray:
    """A rotation about the vertical [-]."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
