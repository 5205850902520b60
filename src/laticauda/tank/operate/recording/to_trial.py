"""Conversion of the run in a recording to a trial, with (5) and (4)."""

import datetime
import itertools
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.control.estimation import Estimate, JointSample, Learned, ReferenceSample
from laticauda.robot import Robot
from laticauda.scenarios.interfaces import Observation
from laticauda.tank.operate.recording.entries import Decision, Event, PowerReading
from laticauda.tank.operate.recording.log import OperationLog
from laticauda.trials import Trial, metrics
from laticauda.trials.logs.loading import interpolated
from laticauda.values.checks import check_not_negative
from laticauda.values.errors import TrialFileError
from laticauda.values.series import SERIES

OBSERVED = tuple(
    name for name in Observation.__dataclass_fields__ if name in SERIES and name != "time"
)
"""Fields of the estimates that a trial takes over unchanged."""
Column = Float[np.ndarray, " _n"]
Table = Float[np.ndarray, "_n _columns"]
Own = Callable[[Robot, str, Column], Column]
"""Selects the joints that a trial has from all joints."""


def estimates_of_run(log: OperationLog, estimates: list[Estimate] | None = None) -> list[Estimate]:
    """Return the estimates of the run: from the last `start` to the `stop` after it, or the end; without a start, all.

    Args:
        log: The recording.
        estimates: Estimates to use instead of the recorded ones.

    Raises:
        TrialFileError: If there are fewer than two estimates.
    """
    begin, end = log.span
    found = log.of(Estimate) if estimates is None else estimates
    chosen: list[Estimate] = []
    for estimate in found:
        if begin <= estimate.time <= end and (not chosen or estimate.time > chosen[-1].time):
            chosen.append(estimate)
    if len(chosen) < 2:
        what = f" {log.lost}" if log.lost else ""
        raise TrialFileError(
            f"Cannot replay {log.path}: it holds no run with at least two estimates.{what}"
        )
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
    run = estimates_of_run(log, estimates)
    time = np.array([estimate.time for estimate in run])
    observed: dict[str, Any] = {
        name: np.array([getattr(estimate, name) for estimate in run]) for name in OBSERVED
    }
    electrical, power_source = measure_electrical_work(log, time)
    own = _all_joints if observed["center_of_mass"].shape[1] == 3 else Robot.yaw_joints
    torque = _torque(log, time, own)
    joints = {"joint_torque": torque, "joint_angle_ref": _references(log, time, own)}
    work = None if torque is None else metrics.joint_work(time, torque, observed["joint_rate"])
    fin = _of_fin(log, time)
    if work is not None and {"fin_torque", "fin_rate_0"} <= fin.keys():
        work = work + metrics.joint_work(
            time, fin["fin_torque"][:, np.newaxis], fin["fin_rate_0"][:, np.newaxis]
        )
    end = next((one for one in log.of_run(Event) if one.kind in ("stop", "fault")), None)
    wrong = [one for one in log.of(Event) if one.kind == "verdict" and not one.data["accepted"]]
    learned: list[Learned] = log.of(Learned)
    notes = {"learned": learned[-1].line} if learned else {}
    began = datetime.datetime.fromtimestamp((log.epoch + round(1e9 * time[0])) / 1e9, datetime.UTC)
    created = {"created": began.isoformat()} if log.epoch else {}
    counts = end is not None and end.kind == "stop" and end.data.get("succeeded", True) is True
    return Trial.measured(
        {"time": time - time[0], **observed, **joints, "work": work, "electrical_work": electrical},
        signals={**_signals(log, time, run), **fin},
        scenario=replace(
            log.header.run,
            notes={"source": "recording", **power_source, **notes, **log.header.run.notes},
        ),
        version=log.version,
        **created,
        status=wrong[0].message
        if wrong
        else end.message
        if end is not None
        else "The recording reached its end.",
        succeeded=counts and not (wrong or log.lost),
    )


def measure_electrical_work(
    log: OperationLog, time: Column
) -> tuple[Column | None, Mapping[str, float | str]]:
    """Return the electrical work above idle at some times [J], and its parameters; None without at least two readings.

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
    volts = log.header.supply_voltage
    if volts is None:
        raise TrialFileError(
            f"Cannot replay {log.path}: it holds power readings, but no `supply_voltage`."
        )
    when = np.array([reading.time for reading in readings])
    current = np.array([reading.current for reading in readings])
    steps = np.diff(when) * 0.5 * (current[1:] + current[:-1])
    for i, (one, two) in enumerate(itertools.pairwise(readings)):
        charge = _charge_between(one, two)
        if charge is not None:
            steps[i] = charge
    charge = np.concatenate(([0.0], np.cumsum(steps)))
    idle = find_idle_current(log, volts)
    drawn = np.interp(time, when, charge)
    work = volts * (drawn - drawn[0] - idle * (time - time[0]))
    return work, {"supply_voltage": volts, "idle_current": idle}


def find_idle_current(log: OperationLog, supply_voltage: float) -> float:
    """Return I_0 as noted before the run, or else from the idle power in the robot's file, at `supply_voltage` [A]."""
    noted = log.notes.get("idle", {}).get("current")
    if noted is not None:
        return check_not_negative("idle current", float(noted), "A")
    return log.header.run.robot.idle_power / supply_voltage


# ---- inside --------------------------------------------------------------------------------------


def _charge_between(one: PowerReading, two: PowerReading) -> float | None:
    """Return the charge between two readings of a meter that averages from `since` on [A s]; None if not known."""
    if one.average is None or two.average is None or one.since is None or one.since != two.since:
        return None
    return two.average * (two.time - one.since) - one.average * (one.time - one.since)


def _all_joints(robot: Robot, name: str, values: Column) -> Column:
    return values[: robot.n_joints]


def _torque(log: OperationLog, time: Column, own: Own) -> Table | None:
    """Return the torques of those joints at some times, interpolated linearly, ignoring nan; None if not reported."""
    samples = sorted(
        (one for one in log.of(JointSample) if one.torque is not None), key=lambda one: one.time
    )
    if not samples:
        return None
    when = np.array([sample.time for sample in samples])
    table = np.stack([own(log.header.run.robot, "torque", sample.torque) for sample in samples])
    return np.nan_to_num(interpolated(time, when, table))


def _of_fin(log: OperationLog, time: Column) -> dict[str, Column]:
    """Return the motion of a driven fin at some times and its reference, as the signals of a simulated fin."""
    n, found = log.header.run.robot.n_joints, dict[str, Column]()
    samples = sorted(
        (one for one in log.of(JointSample) if np.isfinite(one.angle[n:]).any()),
        key=lambda one: one.time,
    )
    for name, signal in (
        ("angle", "fin_angle_0"),
        ("rate", "fin_rate_0"),
        ("torque", "fin_torque"),
    ):
        known = [
            (one.time, getattr(one, name)[n]) for one in samples if getattr(one, name) is not None
        ]
        if known:
            found[signal] = np.interp(time, *np.array(known).T)
    references = [one for one in log.of(ReferenceSample) if one.angle.size > n]
    if references:
        found["fin_angle_ref"] = _in_force(references, time, lambda angle: angle[n : n + 1])[:, 0]
    return found


def _references(log: OperationLog, time: Column, own: Own) -> Table | None:
    """Return the references in force at some times; None if none were sent."""
    samples: list[ReferenceSample] = log.of(ReferenceSample)
    return (
        _in_force(samples, time, lambda angle: own(log.header.run.robot, "angle", angle))
        if samples
        else None
    )


def _in_force(
    samples: list[ReferenceSample], time: Column, some: Callable[[Column], Column]
) -> Table:
    """Return some of the references in force at some times; straight before the first one."""
    table = np.stack([some(sample.angle) for sample in samples])
    held = np.searchsorted([sample.time for sample in samples], time, side="right") - 1
    return np.where(held[:, np.newaxis] >= 0, table[held], 0.0)


def _signals(log: OperationLog, time: Column, run: list[Estimate]) -> dict[str, Column]:
    """Return the controller's signals, held between control instants, and the estimator's standard deviations."""
    pitch = ("pitch",) if run[0].center_of_mass.size == 3 else ()
    names = "age", "center_of_mass_std", "heading_std", *pitch
    found = {name: np.array([getattr(estimate, name) for estimate in run]) for name in names}
    decisions = [item for item in log.of_run(Decision) if item.signals]
    if decisions:
        when = np.array([item.time for item in decisions])
        held = np.maximum(np.searchsorted(when, time + 1e-9, side="right") - 1, 0)
        for name in decisions[0].signals:
            found[name] = np.array([item.signals.get(name, 0.0) for item in decisions])[held]
    return found
