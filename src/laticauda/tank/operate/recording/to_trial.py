"""Conversion of the run in a recording to a trial, with (5) and (4)."""

import datetime
import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.control.estimation import Estimate, JointSample, Learned, ReferenceSample
from laticauda.robot import Robot
from laticauda.scenarios import Observation
from laticauda.tank.operate.recording.entries import Decision, Event, PowerReading, SensorSample
from laticauda.tank.operate.recording.log import OperationLog
from laticauda.trials import Trial, metrics
from laticauda.trials.logs import interpolate_columns
from laticauda.values import SERIES, TrialFileError, check_not_negative

OBSERVED = tuple(
    name for name in Observation.__dataclass_fields__ if name in SERIES and name != "time"
)
"""Fields of the estimates that a trial takes over unchanged."""
FIN_SIGNALS = {"angle": "fin_angle_0", "rate": "fin_rate_0", "torque": "fin_torque"}
"""Signals of a driven fin, as of a simulated one, by the fields of the joint samples."""
TIME_ROUNDING = 1e-9
"""A decision holds from its time on, although times of estimates may be rounded down [s]."""
Column = Float[np.ndarray, " _n"]
Table = Float[np.ndarray, "_n _columns"]
SelectJoints = Callable[[Robot, str, Column], Column]
"""Selects the joints that a trial has from all joints of a sample."""


@dataclass(frozen=True, kw_only=True)
class Ending:
    """How a run ended, and whether it counts."""

    status: str
    """How it ended, in one sentence."""
    succeeded: bool
    """Whether it counts."""


def estimates_of_run(log: OperationLog, estimates: list[Estimate] | None = None) -> list[Estimate]:
    """Return the estimates from the last `start` to the `stop` after it, or the end.

    Without a start, all estimates belong to the run.

    Args:
        log: The recording.
        estimates: Estimates to use instead of the recorded ones.

    Raises:
        TrialFileError: If there are fewer than two estimates.
    """
    begin, end = log.span
    if estimates is None:
        estimates = log.of(Estimate)
    chosen: list[Estimate] = []
    for estimate in estimates:
        is_in_run = begin <= estimate.time <= end
        is_later = not chosen or estimate.time > chosen[-1].time
        if is_in_run and is_later:
            chosen.append(estimate)
    if len(chosen) < 2:
        problem = f"Cannot replay {log.path}: it holds no run with at least two estimates."
        raise TrialFileError(f"{problem} {log.lost}" if log.lost else problem)
    return chosen


def trial_of(log: OperationLog, estimates: list[Estimate] | None = None) -> Trial:
    """Convert the run in a recording to a trial.

    Positions, velocities, heading and joint angles are the estimator's; the references are those in
    force; torques are the modules' own, if they report them; the electrical work is from the power
    meter, (4): V times the current above that at rest. The trial's creation time is the wall-clock
    time at which the run began, if the recording gives it.

    Args:
        log: The recording.
        estimates: Estimates to use instead of the recorded ones, for instance those of
            `rerun_estimator`.

    Raises:
        TrialFileError: If the recording holds no run.
    """
    run_estimates = estimates_of_run(log, estimates)
    time = np.array([estimate.time for estimate in run_estimates])
    observed: dict[str, Any] = {
        name: np.array([getattr(estimate, name) for estimate in run_estimates]) for name in OBSERVED
    }
    is_in_space = observed["center_of_mass"].shape[1] == 3
    select_joints = _select_body_joints if is_in_space else Robot.yaw_joints
    torque = _measured_torque(log, time, select_joints)
    fin = _fin_signals(log, time)
    electrical_work, power_source = measure_electrical_work(log, time)
    ending = _ending(log)
    learned: list[Learned] = log.of(Learned)
    notes: dict[str, Any] = {"source": "recording", **power_source}
    if learned:
        notes["learned"] = learned[-1].line
    created: dict[str, str] = {}
    if log.epoch:
        created["created"] = _wall_clock(log.epoch, time[0])
    return Trial.measured(
        {
            "time": time - time[0],
            **observed,
            "joint_torque": torque,
            "joint_angle_ref": _references_in_force(log, time, select_joints),
            "work": _work(time, observed["joint_rate"], torque, fin),
            "electrical_work": electrical_work,
        },
        signals={**_signals(log, time, run_estimates), **_readings(log, time), **fin},
        scenario=replace(log.header.run, notes={**notes, **log.header.run.notes}),
        version=log.version,
        **created,
        status=ending.status,
        succeeded=ending.succeeded,
    )


def measure_electrical_work(
    log: OperationLog, time: Column
) -> tuple[Column | None, Mapping[str, float | str]]:
    """Return the electrical work above idle at some times [J], and its parameters.

    It is None without at least two readings, and if the meter was silent during the run.
    W(t) = V (Q(t) - Q(0)) - V I_0 t, with the charge Q from the meter's own average if it keeps one
    (Q is that average times the duration of its record, so nothing between two readings is missed),
    else from its readings. The slope of W over a run is (4): P = V I_avg - V I_0. V is taken from
    the recording.

    Args:
        log: The recording.
        time: Times at which the work is wanted [s].

    Raises:
        TrialFileError: If the recording holds readings but not the supply voltage.
    """
    readings: list[PowerReading] = log.of(PowerReading)
    if len(readings) < 2:
        return None, {}
    voltage = log.header.supply_voltage
    if voltage is None:
        raise TrialFileError(
            f"Cannot replay {log.path}: it holds power readings, but no `supply_voltage`."
        )
    idle_current = find_idle_current(log, voltage)
    parameters = {"supply_voltage": voltage, "idle_current": idle_current}
    if _was_meter_silent(log, readings):
        return None, parameters
    reading_times = np.array([reading.time for reading in readings])
    charge = np.interp(time, reading_times, _charge_at(readings))
    work = voltage * (charge - charge[0] - idle_current * (time - time[0]))
    return work, parameters


def find_idle_current(log: OperationLog, supply_voltage: float) -> float:
    """Return I_0 as noted before the run, or else from the idle power in the robot's file [A].

    Args:
        log: The recording.
        supply_voltage: V of (4) [V].
    """
    noted_current = log.notes.get("idle", {}).get("current")
    if noted_current is not None:
        return check_not_negative("idle current", float(noted_current), "A")
    return log.header.run.robot.idle_power / supply_voltage


# ---- power ---------------------------------------------------------------------------------------


def _was_meter_silent(log: OperationLog, readings: Sequence[PowerReading]) -> bool:
    """Return whether the meter fell silent during the run, or before it and did not come back in time.

    Between its last reading and the next one, the charge would be a guess.
    """
    begin, end = log.span
    for event in log.of(Event):
        if event.data.get("event") != "lost_meter" or event.time > end:
            continue
        if event.time >= begin:
            return True
        if not any(event.time < reading.time <= begin for reading in readings):
            return True
    return False


def _charge_at(readings: Sequence[PowerReading]) -> Column:
    """Return the charge from the first reading to each one [A s]."""
    times = np.array([reading.time for reading in readings])
    current = np.array([reading.current for reading in readings])
    steps = np.diff(times) * 0.5 * (current[1:] + current[:-1])
    for i, (earlier, later) in enumerate(itertools.pairwise(readings)):
        charge = _charge_by_averages(earlier, later)
        if charge is not None:
            steps[i] = charge
    return np.concatenate(([0.0], np.cumsum(steps)))


def _charge_by_averages(earlier: PowerReading, later: PowerReading) -> float | None:
    """Return the charge between two readings from the meter's averages [A s]; None: not known."""
    if earlier.average is None or later.average is None:
        return None
    since = earlier.since
    if since is None or since != later.since:
        return None
    return later.average * (later.time - since) - earlier.average * (earlier.time - since)


def _work(
    time: Column, joint_rate: Table, joint_torque: Table | None, fin: Mapping[str, Column]
) -> Table | None:
    """Return the mechanical work of every joint [J]; None if torques are not reported."""
    if joint_torque is None:
        return None
    work = metrics.joint_work(time, joint_torque, joint_rate)
    if {"fin_torque", "fin_rate_0"} <= fin.keys():
        fin_torque = fin["fin_torque"][:, np.newaxis]
        fin_rate = fin["fin_rate_0"][:, np.newaxis]
        work = work + metrics.joint_work(time, fin_torque, fin_rate)
    return work


# ---- joints --------------------------------------------------------------------------------------


def _select_body_joints(robot: Robot, name: str, values: Column) -> Column:
    return values[: robot.n_joints]


def _measured_torque(log: OperationLog, time: Column, select_joints: SelectJoints) -> Table | None:
    """Return joint torques at some times [N m], bridged linearly; None if not reported."""
    samples = [sample for sample in log.of(JointSample) if sample.torque is not None]
    if not samples:
        return None
    samples.sort(key=lambda sample: sample.time)
    robot = log.header.run.robot
    sample_times = np.array([sample.time for sample in samples])
    torque = np.stack([select_joints(robot, "torque", sample.torque) for sample in samples])
    return np.nan_to_num(interpolate_columns(time, sample_times, torque))


def _fin_signals(log: OperationLog, time: Column) -> dict[str, Column]:
    """Return motion and reference of a driven fin at some times, as a simulated fin has them."""
    fin_column = log.header.run.robot.n_joints
    samples: list[JointSample] = [
        sample for sample in log.of(JointSample) if np.isfinite(sample.angle[fin_column:]).any()
    ]
    samples.sort(key=lambda sample: sample.time)
    signals: dict[str, Column] = {}
    for field, signal in FIN_SIGNALS.items():
        reporting = [sample for sample in samples if getattr(sample, field) is not None]
        if reporting:
            sample_times = [sample.time for sample in reporting]
            values = [getattr(sample, field)[fin_column] for sample in reporting]
            signals[signal] = np.interp(time, sample_times, values)
    references: list[ReferenceSample] = [
        reference for reference in log.of(ReferenceSample) if reference.angle.size > fin_column
    ]
    if references:
        angles = np.stack(
            [reference.angle[fin_column : fin_column + 1] for reference in references]
        )
        signals["fin_angle_ref"] = _in_force(references, angles, time)[:, 0]
    return signals


def _references_in_force(
    log: OperationLog, time: Column, select_joints: SelectJoints
) -> Table | None:
    """Return the references in force at some times [rad]; None if none were sent."""
    references: list[ReferenceSample] = log.of(ReferenceSample)
    if not references:
        return None
    robot = log.header.run.robot
    angles = np.stack([select_joints(robot, "angle", reference.angle) for reference in references])
    return _in_force(references, angles, time)


def _in_force(references: Sequence[ReferenceSample], angles: Table, time: Column) -> Table:
    """Return the angles that were in force at some times [rad]; straight before the first one."""
    sent_at = [reference.time for reference in references]
    latest = np.searchsorted(sent_at, time, side="right") - 1
    return np.where(latest[:, np.newaxis] >= 0, angles[latest], 0.0)


# ---- the rest of a trial -------------------------------------------------------------------------


def _ending(log: OperationLog) -> Ending:
    """Return how the run ended: by its verdict if that rejects it, else by its `stop` or a fault.

    There is none of them if the program was killed, or the file was cut.
    """
    for event in log.of(Event):
        if event.kind == "verdict" and not event.data["accepted"]:
            return Ending(status=event.message, succeeded=False)
    for event in log.of_run(Event):
        if event.kind in ("stop", "fault"):
            is_success = event.kind == "stop" and event.data.get("succeeded", True) is True
            return Ending(status=event.message, succeeded=is_success and not log.lost)
    return Ending(status="The recording ends before the run does.", succeeded=False)


def _wall_clock(epoch: int, time: float) -> str:
    """Return the wall-clock time at a `time` [s] of a recording whose time 0 was at `epoch` [ns]."""
    moment = datetime.datetime.fromtimestamp((epoch + round(1e9 * time)) / 1e9, datetime.UTC)
    return moment.isoformat()


def _signals(
    log: OperationLog, time: Column, run_estimates: Sequence[Estimate]
) -> dict[str, Column]:
    """Return the estimator's standard deviations, and the controller's signals.

    Signals of a controller are held from one control instant to the next.
    """
    names = ["age", "center_of_mass_std", "heading_std"]
    if run_estimates[0].center_of_mass.size == 3:
        names.append("pitch")
    signals: dict[str, Column] = {}
    for name in names:
        signals[name] = np.array([getattr(estimate, name) for estimate in run_estimates])
    decisions: list[Decision] = [decision for decision in log.of_run(Decision) if decision.signals]
    if decisions:
        decided_at = np.array([decision.time for decision in decisions])
        latest = np.searchsorted(decided_at, time + TIME_ROUNDING, side="right") - 1
        for name in decisions[0].signals:
            values = np.array([decision.signals.get(name, 0.0) for decision in decisions])
            signals[name] = values[np.maximum(latest, 0)]
    return signals


def _readings(log: OperationLog, time: Column) -> dict[str, Column]:
    """Return the values of the robot's own sensors, held from one measurement to the next.

    Those that are missing at some time, such as echoes, are in the recording alone: a measured trial
    has finite signals.
    """
    samples_of: dict[str, list[SensorSample]] = {}
    for sample in log.of(SensorSample):
        if sample.has_values:
            samples_of.setdefault(sample.sensor, []).append(sample)
    signals: dict[str, Column] = {}
    for sensor, samples in samples_of.items():
        columns = samples[-1].columns
        fitting = [sample for sample in samples if sample.columns == columns]
        fitting.sort(key=lambda sample: sample.time)
        measured_at = [sample.time for sample in fitting]
        values = np.stack([sample.values for sample in fitting])
        latest = np.searchsorted(measured_at, time + TIME_ROUNDING, side="right") - 1
        latest_values = np.where(latest[:, np.newaxis] >= 0, values[np.maximum(latest, 0)], np.nan)
        for column, name in enumerate(columns):
            if np.isfinite(latest_values[:, column]).all():
                signals[f"{sensor}_{name}"] = latest_values[:, column]
    return signals
