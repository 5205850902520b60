"""How the inputs of a tick become samples and an estimate."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from laticauda.control.estimation import (
    JointSample,
    PoseSample,
    ReferenceSample,
    Sample,
    StateEstimator,
)
from laticauda.robot import kinematics
from laticauda.tank.operate.procedure.clocks import update_clock
from laticauda.tank.operate.procedure.sensed import take_in_sensed
from laticauda.tank.operate.procedure.state import Inputs, OperatorState
from laticauda.tank.operate.recording.entries import Measurement, PowerReading
from laticauda.tank.operate.safety.modules import Modules, update_modules
from laticauda.tank.operate.settings import CaptureVolume, Operation


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
        readings and those of the robot's own sensors.
    """
    modules = update_modules(state.modules, inputs.messages)
    samples: list[Sample] = list(_sent_references(state))
    if inputs.messages:
        samples += _joint_answers(state, modules)
    state, poses = _take_in_frames(operation.tank, state, inputs)
    samples += poses
    state = replace(state, modules=modules, error="")
    for reading in inputs.readings:
        state = _take_in_reading(state, reading)
    sensed, sensor_samples = take_in_sensed(state.sensed, inputs.sensed)
    state = replace(state, sensed=sensed)
    state = _update_estimate(estimator, state, now, samples)
    return state, (*samples, *inputs.readings, *sensor_samples)


def _sent_references(state: OperatorState) -> tuple[ReferenceSample, ...]:
    """Return the references that were sent at the last tick."""
    if state.now is None or not state.supervisor.sends_references:
        return ()
    frequency = 0.0
    if state.phase == "running" and state.reference.command is not None:
        frequency = state.reference.command.gait.frequency
    sample = ReferenceSample(time=state.now, angle=state.reference.references, frequency=frequency)
    return (sample,)


def _joint_answers(state: OperatorState, modules: Modules) -> tuple[JointSample, ...]:
    """Return the modules' answers to the Sync that ended the last tick; nan where one is late."""
    if state.now is None:
        return ()
    is_fresh = modules.angle_time >= state.now
    if not is_fresh.any():
        return ()
    sample = JointSample(
        time=state.now,
        angle=np.where(is_fresh, modules.angle, np.nan),
        rate=np.where(is_fresh, modules.rate, np.nan),
        torque=np.where(is_fresh, modules.torque, np.nan),
    )
    return (sample,)


def _take_in_frames(
    tank: CaptureVolume, state: OperatorState, inputs: Inputs
) -> tuple[OperatorState, list[PoseSample]]:
    """Take in the cameras' frames: their clock, and poses on our clock and in the path frame.

    Rotations are kept: those of the whole calibration while it lasts, else those of this tick.
    """
    poses: list[PoseSample] = []
    rotations: list[np.ndarray] = []
    if state.phase == "calibrating":
        rotations += state.prepared.rotation
    for arrival, frame in inputs.frames:
        clock = update_clock(state.clock, arrival, frame.time)
        pose = _to_path_frame(tank, frame, clock.offset, state.prepared.marker_turned)
        poses.append(pose)
        if pose.rotation is not None:
            rotations.append(pose.rotation)
        frame_time = state.frame_time if pose.is_lost else arrival
        state = replace(state, clock=clock, frame_time=frame_time)
    prepared = replace(state.prepared, rotation=tuple(rotations))
    return replace(state, prepared=prepared), poses


def _to_path_frame(
    tank: CaptureVolume, frame: PoseSample, clock_offset: float, marker_turned: float
) -> PoseSample:
    """Convert a frame to our clock, to the path frame, and to a marker body as in the trial file.

    Args:
        tank: Where the path lies.
        frame: Frame on the cameras' clock, tank frame.
        clock_offset: Our clock minus the cameras' [s].
        marker_turned: Measured rotation of the marker body relative to the trial file [rad].
    """
    rotation = frame.rotation
    if rotation is not None:
        to_path = kinematics.turn("yaw", -tank.path_heading)
        to_mount = kinematics.turn("yaw", -marker_turned)
        rotation = to_path @ rotation @ to_mount
    return PoseSample(
        time=frame.time + clock_offset,
        position=tank.to_path(frame.position),
        rotation=rotation,
        residual=frame.residual,
    )


def _take_in_reading(state: OperatorState, reading: PowerReading) -> OperatorState:
    """Take in a reading of the power meter."""
    state = replace(state, reading=reading)
    if state.phase == "idle_current":
        return replace(state, idle=state.idle.step(reading.current))
    if state.phase == "running":
        return replace(state, drawn=state.drawn.step(reading.current))
    return state


def _update_estimate(
    estimator: StateEstimator, state: OperatorState, now: float, samples: Sequence[Sample]
) -> OperatorState:
    """Update the estimate with the samples; an error in it stops the robot, not the program."""
    try:
        estimator_state = estimator.steps(state.estimator, samples)
        estimate = estimator.estimate(estimator_state, now)
        return replace(state, estimator=estimator_state, estimate=estimate)
    except Exception as error:
        return replace(state, estimate=None, error=f"state estimation: {error}")
