"""The phases before the run: connect, check, calibrate, idle current, stillness.

Each phase is a function that is called at every tick. It returns the same state as long as it has
to wait, goes on to the next phase with an event, or gives the operation up with a reason.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from laticauda.tank.operate.procedure.calibration import (
    CalibrationFailed,
    measure_joint_zeros,
    measure_marker_yaw,
)
from laticauda.tank.operate.procedure.state import OperatorState
from laticauda.tank.operate.procedure.stillness import (
    Pose,
    StillnessRule,
    mean_pose,
    watch_stillness,
)
from laticauda.tank.operate.recording.entries import Event
from laticauda.tank.operate.safety.modules import list_complaints
from laticauda.tank.operate.safety.supervisor import phase_after
from laticauda.tank.operate.settings import Operation
from laticauda.values import wrap_to_pi

GRANT_TIME = 5.0
"""Time within which the supervisor has to let the robot move [s]."""
CONNECT_TIME = 10.0
"""Devices that are silent for this long are not there [s]."""
LIMP_TIME = 0.5 * CONNECT_TIME
"""Time within which all modules have to be sound and limp [s]."""
COLLECT_TIME = 1.0
"""Time for collecting samples for a calibration [s]."""
FEWEST_FRAMES = 5
"""Frames in that time that have to show the marker body [-]."""
LATE_PERIODS = 2.0
"""Periods of the loop after which an estimate is a guess [-].

The noise of the joints' rates times the gap is then up to 7 deg.
"""


class PreparationStep(NamedTuple):
    """One tick of a phase before the run."""

    state: OperatorState
    """State after it."""
    events: tuple[Event, ...]
    """Events to log."""


def step(operation: Operation, state: OperatorState, now: float) -> PreparationStep:
    """Perform one tick of the phase that `state` is in.

    Args:
        operation: Operation to prepare.
        state: State before.
        now: Current time [s].

    Returns:
        The new state, and the events to log.
    """
    perform_phase = PHASES.get(state.phase)
    if perform_phase is None or state.failure:
        return _wait(state)
    try:
        return perform_phase(operation, state, now)
    except CalibrationFailed as error:
        return _give_up(state, now, str(error))


# ---- phases --------------------------------------------------------------------------------------


def _connect(operation: Operation, state: OperatorState, now: float) -> PreparationStep:
    """Wait until every module, the motion capture and the power meter have been heard."""
    missing = _list_missing_devices(operation, state)
    if not missing:
        message = f"{state.modules.n} modules and the motion capture respond"
        return _go_on(state, now, "connected", message)
    if _time_in_phase(state, now) > CONNECT_TIME:
        return _give_up(state, now, _sentence("; ".join(missing)))
    return _wait(state)


def _check(operation: Operation, state: OperatorState, now: float) -> PreparationStep:
    """Check every module: firmware state, temperature, leak, voltage, and that it is limp.

    A module that is still starting up is waited for.
    """
    limits = operation.limits
    complaints = list_complaints(
        state.modules, max_temperature=limits.max_temperature, min_voltage=limits.min_voltage
    )
    if not complaints and state.modules.is_limp(now, limits.heartbeat_timeout):
        heartbeats = [beat for beat in state.modules.heartbeat if beat is not None]
        highest_temperature = max(beat.temperature for beat in heartbeats)
        lowest_voltage = min(beat.voltage for beat in heartbeats)
        return _go_on(
            state,
            now,
            "well",
            f"all modules are OK: at most {highest_temperature:.0f} degC, "
            f"at least {lowest_voltage:.1f} V",
            temperature=highest_temperature,
            voltage=lowest_voltage,
        )
    if _time_in_phase(state, now) > LIMP_TIME:
        reasons = complaints or ("the modules do not go limp",)
        return _give_up(state, now, _sentence("; ".join(reasons)))
    return _wait(state)


def _calibrate(operation: Operation, state: OperatorState, now: float) -> PreparationStep:
    """Measure joint zeros and marker body if requested; meanwhile, compare the clocks."""
    calibration = operation.calibration
    prepared = state.prepared
    prepared = replace(prepared, angle=(*prepared.angle, state.modules.angle))
    state = replace(state, prepared=prepared)
    if _time_in_phase(state, now) < COLLECT_TIME:
        return _wait(state)
    clock_offset = 0.0 if state.clock is None else state.clock.offset
    findings = [f"clock of the cameras {1e3 * clock_offset:+.1f} ms"]
    n_without_zero = sum(
        beat is not None and beat.not_calibrated for beat in state.modules.heartbeat
    )
    if n_without_zero and calibration.joint_zeros:
        zeros = measure_joint_zeros(np.array(prepared.angle), largest=calibration.max_joint_zero)
        findings.append(f"joint zeros up to {math.degrees(np.max(np.abs(zeros))):.1f} deg")
        prepared = replace(prepared, sets_zero=True)
    elif n_without_zero:
        findings.append(f"{n_without_zero} modules have had no zero since power-on")
    if calibration.straight_heading is not None:
        rotations = np.array(prepared.rotation).reshape(-1, 3, 3)
        if len(rotations) < FEWEST_FRAMES:
            raise CalibrationFailed(
                "The marker body cannot be calibrated: the motion capture hardly sees it."
            )
        heading = calibration.straight_heading - operation.tank.path_heading
        marker_yaw = measure_marker_yaw(rotations, heading=heading)
        findings.append(f"marker body at {math.degrees(marker_yaw):+.2f} deg to its module")
        turned = wrap_to_pi(marker_yaw - calibration.marker_yaw)
        prepared = replace(prepared, marker_turned=turned)
    return _go_on(
        replace(state, prepared=prepared),
        now,
        "calibrated",
        "; ".join(findings),
        without_zero=0 if calibration.joint_zeros else n_without_zero,
    )


def _measure_idle_current(
    operation: Operation, state: OperatorState, now: float
) -> PreparationStep:
    """Measure I_0: the mean current while the robot is limp."""
    if not operation.connection.meter_address:
        return _go_on(state, now, "measured", "no power meter: power is not measured")
    if _time_in_phase(state, now) < operation.calibration.idle_time:
        return _wait(state)
    mean = state.idle.mean
    n_readings = state.idle.count
    if mean is None:
        return _give_up(
            state, now, "The power meter fell silent while the current at rest was measured."
        )
    message = f"I_0 = {mean:.3f} A from {n_readings} readings"
    return _go_on(state, now, "measured", message, current=mean, readings=n_readings)


def _settle(operation: Operation, state: OperatorState, now: float) -> PreparationStep:
    """Hold the robot straight until the water is calm and the robot is where it is to start."""
    calibration = operation.calibration
    estimate = state.estimate
    if state.supervisor.state == "idle":
        return _wait_until_it_may_move(state, now)
    if _time_in_phase(state, now) > calibration.patience:
        return _give_up(
            state,
            now,
            f"The robot was not still for {calibration.still_time:g} s "
            f"within {calibration.patience:g} s.",
        )
    is_straightening = np.any(state.reference.references)
    if estimate is None or state.supervisor.state != "ready" or is_straightening:
        return _wait(replace(state, prepared=replace(state.prepared, recent_poses=())))
    if state.now is not None and now - state.now > LATE_PERIODS / operation.rate:
        return _wait(state)
    watch = watch_stillness(
        state.prepared.recent_poses,
        now,
        Pose(
            x=float(estimate.center_of_mass[0]),
            y=float(estimate.center_of_mass[1]),
            heading=float(estimate.heading),
        ),
        StillnessRule(
            speed=calibration.still_speed,
            rate=calibration.still_rate,
            duration=calibration.still_time,
        ),
    )
    start = mean_pose(watch.poses)
    state = replace(state, prepared=replace(state.prepared, recent_poses=watch.poses, start=start))
    if not watch.is_still:
        return _wait(state)
    complaint = _complain_about_start(operation, start)
    if complaint:
        return _give_up(state, now, complaint)
    return _go_on(
        state,
        now,
        "still",
        f"still at p_y(0) = {start.y:.4f} m, theta(0) = {math.degrees(start.heading):.2f} deg",
        x=start.x,
        y=start.y,
        heading=start.heading,
    )


Phase = Callable[[Operation, OperatorState, float], PreparationStep]
PHASES: Mapping[str, Phase] = {
    "connecting": _connect,
    "checking": _check,
    "calibrating": _calibrate,
    "idle_current": _measure_idle_current,
    "settling": _settle,
}
"""The phases before the countdown, by the names that the supervisor's table has for them."""


# ---- how a phase goes on -------------------------------------------------------------------------


def _wait(state: OperatorState) -> PreparationStep:
    return PreparationStep(state=state, events=())


def _go_on(
    state: OperatorState, now: float, phase_event: str, message: str, **data: object
) -> PreparationStep:
    """Go on to the phase that follows after an event, and log it.

    Args:
        state: State before.
        now: Current time [s].
        phase_event: Event in the table of phases.
        message: What was found, as a sentence.
        data: The same as numbers by name.
    """
    event = Event(time=now, kind=state.phase, message=message, data=data)
    next_phase = phase_after(state.phase, phase_event)
    return PreparationStep(state=replace(state, phase=next_phase, since=now), events=(event,))


def _give_up(state: OperatorState, now: float, reason: str) -> PreparationStep:
    event = Event(time=now, kind="failed", message=reason)
    return PreparationStep(state=replace(state, failure=reason), events=(event,))


def _time_in_phase(state: OperatorState, now: float) -> float:
    """Return the time since the phase began [s]."""
    if state.since is None:
        return 0.0
    return now - state.since


# ---- what is wrong, as sentences -----------------------------------------------------------------


def _list_missing_devices(operation: Operation, state: OperatorState) -> list[str]:
    """Return what has not been heard yet, each with what to check."""
    connection = operation.connection
    missing: list[str] = []
    unheard = state.modules.unheard
    if unheard:
        silent = f"module {', '.join(map(str, unheard))} does not respond"
        if len(unheard) == state.modules.n:
            silent = "no module responds"
        missing.append(f"{silent} on {connection.bus_address}: check power, cable and node")
    if state.frame_time is None:
        body = f"body {connection.mocap_body!r}" if connection.mocap_body else "a body"
        missing.append(
            f"the motion capture at {connection.mocap_address} does not see {body}: "
            "check that it measures, and that the robot is within its volume"
        )
    if connection.meter_address and state.reading is None:
        missing.append(
            f"the power meter at {connection.meter_address} is silent: "
            "check that it is on and connected"
        )
    return missing


def _wait_until_it_may_move(state: OperatorState, now: float) -> PreparationStep:
    """Wait while the supervisor does not let the robot move because something is wrong."""
    if _time_in_phase(state, now) <= GRANT_TIME:
        return _wait(state)
    present = ", ".join(sorted(state.supervisor.present)).replace("_", " ")
    reason = present or "a module does not answer."
    return _give_up(state, now, f"The robot must not move: {reason}")


def _complain_about_start(operation: Operation, pose: Pose) -> str:
    """Return how far the robot is from where it is to start; "" if it is there."""
    start = operation.start
    if start is None:
        return ""
    x, y = start.position
    distance = math.hypot(pose.x - x, pose.y - y)
    turned = wrap_to_pi(pose.heading - start.heading)
    if distance <= start.tolerance and abs(turned) <= start.heading_tolerance:
        return ""
    return (
        f"The robot lies {distance:.2f} m and {math.degrees(turned):+.0f} deg from its start; "
        f"put it at ({x:.2f}, {y:.2f}) m, heading {math.degrees(start.heading):.0f} deg."
    )


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."
