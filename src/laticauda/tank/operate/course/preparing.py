"""Preparations for the run, phase by phase: connect, check, calibrate, idle current, stillness, countdown."""

import math
from dataclasses import replace
from statistics import fmean

import numpy as np
from jaxtyping import Float

from laticauda.tank.operate.course.state import OperatorState, Places
from laticauda.tank.operate.recording.entries import Event
from laticauda.tank.operate.safety.limits import list_complaints
from laticauda.tank.operate.safety.supervisor import phase_after
from laticauda.tank.operate.settings import Operation
from laticauda.values.angles import wrap_to_pi
from laticauda.values.errors import LaticaudaError

GRANT_TIME = 5.0  # time within which the supervisor has to let the robot move [s]
CONNECT_TIME = 10.0  # devices that are silent for this long are not there [s]
COLLECT_TIME = 1.0  # time for collecting samples for a calibration [s]
LEAST_FRAMES = 5  # frames in that time that have to show the marker body [-]
LATE = 2.0  # periods after which an estimate is a guess: noise of the joints' rates times the gap is up to 7 deg [-]
Answer = tuple[OperatorState, tuple[Event, ...]]


class CalibrationFailed(LaticaudaError, RuntimeError):
    """The robot or its instruments are not as the calibration requires; the message says what to do."""


def step(operation: Operation, state: OperatorState, now: float) -> Answer:
    """Perform one tick of the phase that `state` is in.

    Args:
        operation: Operation to prepare.
        state: State before.
        now: Current time [s].

    Returns:
        The new state, and the events to log.
    """
    phase = _STEPS.get(state.phase)
    if phase is None or state.failure:
        return state, ()
    try:
        return phase(operation, state, now)
    except CalibrationFailed as error:
        return _given_up(state, now, str(error))


def _done(state: OperatorState, now: float, event: str, message: str, **data: object) -> Answer:
    """Go on to the next phase."""
    logged = Event(time=now, kind=state.phase, message=message, data=data)
    return replace(state, phase=phase_after(state.phase, event), since=now), (logged,)


def _given_up(state: OperatorState, now: float, why: str) -> Answer:
    return replace(state, failure=why), (Event(time=now, kind="failed", message=why),)


def _gone(state: OperatorState, now: float) -> float:
    return 0.0 if state.since is None else now - state.since


def _connecting(operation: Operation, state: OperatorState, now: float) -> Answer:
    """Wait until every module, the motion capture and the power meter have been heard."""
    modules, connection = state.modules, operation.connection
    missing: list[str] = []
    if unheard := modules.unheard:
        named = f"module {', '.join(map(str, unheard))} does not respond"
        which = "no module responds" if len(unheard) == modules.n else named
        missing.append(f"{which} on {connection.bus_address}: check power, cable and node")
    if state.frame_time is None:
        body = f"body {connection.mocap_body!r}" if connection.mocap_body else "a body"
        missing.append(
            f"the motion capture at {connection.mocap_address} does not see {body}: check that it measures, and that "
            "the robot is within its volume"
        )
    if connection.meter_address and state.reading is None:
        missing.append(
            f"the power meter at {connection.meter_address} is silent: check that it is on and connected"
        )
    if not missing:
        return _done(state, now, "connected", f"{modules.n} modules and the motion capture respond")
    if _gone(state, now) > CONNECT_TIME:
        return _given_up(state, now, _sentence("; ".join(missing)))
    return state, ()


def _checking(operation: Operation, state: OperatorState, now: float) -> Answer:
    """Check every module: firmware state, temperature, leak, voltage, and that it is limp."""
    limits = operation.limits
    found = list_complaints(
        state.modules, max_temperature=limits.max_temperature, min_voltage=limits.min_voltage
    )
    if not found and state.modules.is_limp(now, limits.heartbeat_timeout):
        beats = [beat for beat in state.modules.heartbeat if beat is not None]
        warm, low = max(beat.temperature for beat in beats), min(beat.voltage for beat in beats)
        message = f"all modules are OK: at most {warm:.0f} degC, at least {low:.1f} V"
        return _done(state, now, "well", message, temperature=warm, voltage=low)
    if _gone(state, now) > CONNECT_TIME / 2.0:
        return _given_up(state, now, _sentence("; ".join(found or ("the modules do not go limp",))))
    return state, ()


def _calibrating(operation: Operation, state: OperatorState, now: float) -> Answer:
    """Measure joint zeros and marker body if requested; meanwhile, compare the clocks."""
    how, prepared = operation.calibration, state.prepared
    prepared = replace(prepared, angle=(*prepared.angle, state.modules.angle))
    state = replace(state, prepared=prepared)
    if _gone(state, now) < COLLECT_TIME:
        return state, ()
    offset = 0.0 if state.clock is None else state.clock.offset
    words = [f"clock of the cameras {1e3 * offset:+.1f} ms"]
    unset = sum(beat is not None and beat.not_calibrated for beat in state.modules.heartbeat)
    if unset and not how.joint_zeros:
        words.append(f"{unset} modules have had no zero since power-on")
    elif unset:
        zeros = measure_joint_zeros(np.array(prepared.angle), largest=how.max_joint_zero)
        words.append(f"joint zeros up to {math.degrees(np.max(np.abs(zeros))):.1f} deg")
        prepared = replace(prepared, sets_zero=True)
    if how.straight_heading is not None:
        rotation = np.array(prepared.rotation).reshape(-1, 3, 3)
        if len(rotation) < LEAST_FRAMES:
            raise CalibrationFailed(
                "The marker body cannot be calibrated: the motion capture hardly sees it."
            )
        yaw = measure_marker_yaw(
            rotation, heading=how.straight_heading - operation.tank.path_heading
        )
        words.append(f"marker body at {math.degrees(yaw):+.2f} deg to its module")
        prepared = replace(prepared, marker_turned=wrap_to_pi(yaw - how.marker_yaw))
    found = {"without_zero": 0 if how.joint_zeros else unset}
    return _done(replace(state, prepared=prepared), now, "calibrated", "; ".join(words), **found)


def _idle_current(operation: Operation, state: OperatorState, now: float) -> Answer:
    """Measure I_0: the mean current while the robot is limp."""
    if not operation.connection.meter_address:
        return _done(state, now, "measured", "no power meter: power is not measured")
    if _gone(state, now) < operation.calibration.idle_time:
        return state, ()
    mean = state.idle.mean
    if mean is None:
        return _given_up(
            state, now, "The power meter fell silent while the current at rest was measured."
        )
    message = f"I_0 = {mean:.3f} A from {state.idle.count} readings"
    return _done(state, now, "measured", message, current=mean, readings=state.idle.count)


def _settling(operation: Operation, state: OperatorState, now: float) -> Answer:
    """Hold the robot straight until the water is calm and the robot is where it is to start."""
    how, estimate = operation.calibration, state.estimate
    if (
        state.supervisor.state == "idle"
    ):  # not yet granted because something is wrong; wait, but not forever
        if _gone(state, now) > GRANT_TIME:
            why = (
                ", ".join(sorted(state.supervisor.present)).replace("_", " ")
                or "a module does not answer."
            )
            return _given_up(state, now, f"The robot must not move: {why}")
        return state, ()
    if _gone(state, now) > how.patience:
        return _given_up(
            state,
            now,
            f"The robot was not still for {how.still_time:g} s within {how.patience:g} s.",
        )
    if estimate is None or state.supervisor.state != "ready" or np.any(state.reference.references):
        return replace(state, prepared=replace(state.prepared, places=())), ()
    if state.now is not None and now - state.now > LATE / operation.rate:
        return state, ()
    start = (
        float(estimate.center_of_mass[0]),
        float(estimate.center_of_mass[1]),
        float(estimate.heading),
    )
    still = {"speed": how.still_speed, "rate": how.still_rate, "duration": how.still_time}
    places, is_still = stayed(state.prepared.places, now, start, **still)
    state = replace(state, prepared=replace(state.prepared, places=places, start=_mean(places)))
    if not is_still:
        return state, ()
    start = _mean(places)
    off = _off_place(operation, start)
    if off:
        return _given_up(state, now, off)
    message = f"still at p_y(0) = {start[1]:.4f} m, theta(0) = {math.degrees(start[2]):.2f} deg"
    return _done(state, now, "still", message, x=start[0], y=start[1], heading=start[2])


def _mean(places: Places) -> tuple[float, float, float]:
    n = len(places)
    return (
        sum(p[1] for p in places) / n,
        sum(p[2] for p in places) / n,
        sum(p[3] for p in places) / n,
    )


def _off_place(operation: Operation, place: tuple[float, float, float]) -> str:
    start = operation.start
    if start is None:
        return ""
    away = math.hypot(place[0] - start.position[0], place[1] - start.position[1])
    turned = wrap_to_pi(place[2] - start.heading)
    if away <= start.tolerance and abs(turned) <= start.heading_tolerance:
        return ""
    return (
        f"The robot lies {away:.2f} m and {math.degrees(turned):+.0f} deg from its start; put it at "
        f"({start.position[0]:.2f}, {start.position[1]:.2f}) m, heading {math.degrees(start.heading):.0f} deg."
    )


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."


_PHASES = _connecting, _checking, _calibrating, _idle_current, _settling
_STEPS = {phase.__name__.removeprefix("_"): phase for phase in _PHASES}


# ---- what is measured before a run ---------------------------------------------------------------


def measure_joint_zeros(
    angle: Float[np.ndarray, "n_samples n_joints"], *, largest: float
) -> Float[np.ndarray, " n_joints"]:
    """Return what every joint reports while the robot lies straight: the median of the samples.

    Args:
        angle: Angles that the limp joints reported [rad]; nan where one did not.
        largest: Largest zero; beyond this, the robot was not straight [rad].

    Returns:
        Zeros of the joints [rad].

    Raises:
        CalibrationFailed: If a joint was not heard, or is further from zero than `largest`.
    """
    if not np.isfinite(angle).any(axis=0).all():
        node = int(np.argmin(np.isfinite(angle).any(axis=0))) + 1
        raise CalibrationFailed(
            f"The joint zeros cannot be measured: module {node} did not report its angle."
        )
    zero = np.nanmedian(angle, axis=0)
    worst = int(np.argmax(np.abs(zero)))
    if abs(zero[worst]) > largest:
        raise CalibrationFailed(
            f"The joint zeros cannot be measured: module {worst + 1} reports {math.degrees(zero[worst]):.1f} deg, more "
            f"than {math.degrees(largest):.1f}; lay the robot straight against a ruler."
        )
    return zero


def measure_marker_yaw(rotation: Float[np.ndarray, "n_samples 3 3"], *, heading: float) -> float:
    """Return the direction of the marker body relative to its module, from the straight robot.

    All links of a straight robot point the same way, so the module's direction is the robot's,
    which is known: it lies along a wall, or along a rope.

    Args:
        rotation: Rotations from the marker body to the tank frame [-].
        heading: Heading of the straight robot, tank frame [rad].

    Returns:
        Direction [rad], in [-pi, pi).

    Raises:
        CalibrationFailed: If there is no sample.
    """
    if not len(rotation):
        raise CalibrationFailed(
            "The marker body cannot be calibrated: the motion capture did not see it."
        )
    yaw = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0])
    mean = math.atan2(float(np.mean(np.sin(yaw))), float(np.mean(np.cos(yaw))))
    return wrap_to_pi(mean - heading)


def stayed(
    places: Places,
    now: float,
    place: tuple[float, float, float],
    *,
    speed: float,
    rate: float,
    duration: float,
) -> tuple[Places, bool]:
    """Return whether something has been still for long enough, after one more look.

    Means over the two halves of the time are compared, so noise does not count as motion.

    Args:
        places: Places returned by the last call; () at the start.
        now: Current time [s].
        place: Center of mass [m, m] and heading [rad].
        speed: Largest speed that counts as still [m/s].
        rate: Largest turning rate that counts as still [rad/s].
        duration: Time for which it has to be still [s].

    Returns:
        The places within that time, and whether it was still throughout.
    """
    begin = now - duration
    places = (*(place for place in places if place[0] > begin - 1e-9), (now, *place))
    middle = now - 0.5 * duration
    early = [place for place in places if place[0] <= middle]
    late = [place for place in places if place[0] > middle]
    if places[0][0] > begin + 0.1 * duration or not early or not late:
        return places, False
    gone, *way = (
        fmean(place[i] for place in late) - fmean(place[i] for place in early) for i in range(4)
    )
    return places, math.hypot(way[0], way[1]) / gone <= speed and abs(way[2] / gone) <= rate
