"""From a recording to a trial, and once more through the estimator and the controller."""

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float

from laticauda.errors import TrialFileError, instance, not_negative
from laticauda.interfaces import Command, Plant
from laticauda.operate.estimate import Estimate
from laticauda.operate.operation_log import Decision, OperationLog
from laticauda.operate.samples import Event, JointSample, PoseSample, PowerReading, ReferenceSample, Sample, yaw_joints
from laticauda.operate.twin import PlantRecord
from laticauda.trial import Trial

Column = Float[np.ndarray, " _n"]
Table = Float[np.ndarray, "_n _columns"]


@runtime_checkable
class AnyEstimator(Protocol):
    """What `Estimator` and `KinematicEstimator` share."""

    def init(self) -> Any:
        """Nothing seen yet."""
        ...

    def step(self, state: Any, sample: Sample) -> Any:
        """The state after one more sample."""
        ...

    def estimate(self, state: Any, time: float | None = None) -> Estimate | None:
        """Where the robot is."""
        ...


@dataclass(frozen=True, kw_only=True)
class Rerun:
    """The commands of a controller that ran again, beside those that were recorded."""

    recorded: tuple[Decision, ...]
    """What was decided then."""
    again: tuple[Decision, ...]
    """What is decided now, at the same instants."""

    @property
    def n_different(self) -> int:
        """Instants at which the two commands are not the same, bit for bit [-]."""
        return sum(one.command != two.command for one, two in zip(self.recorded, self.again, strict=True))

    @property
    def largest_difference(self) -> float:
        """Of the two offsets of the joints [rad]."""
        pairs = zip(self.recorded, self.again, strict=True)
        return max((abs(one.command.offset - two.command.offset) for one, two in pairs), default=0.0)


def run_of(log: OperationLog, estimates: list[Estimate] | None = None) -> list[Estimate]:
    """The estimates of the run: from the last `start` to the `stop` behind it, or to the end; without a start all.

    Args:
        log: The recording.
        estimates: Others than the recorded ones.

    Raises:
        TrialFileError: If there are fewer than two.
    """
    begin, end = run_span(log)
    found = log.of(Estimate) if estimates is None else estimates
    chosen: list[Estimate] = []
    for estimate in found:
        if begin <= estimate.time <= end and (not chosen or estimate.time > chosen[-1].time):
            chosen.append(estimate)
    if len(chosen) < 2:
        what = f" {log.lost}" if log.lost else ""
        raise TrialFileError(f"Cannot replay {log.path}: it holds no run of at least two estimates.{what}")
    return chosen


def run_span(log: OperationLog) -> tuple[float, float]:
    """When the run began and ended; without such events minus and plus infinity [s]."""
    events = log.of(Event)
    begin = max((event.time for event in events if event.kind == "start"), default=-np.inf)
    end = min((event.time for event in events if event.kind == "stop" and event.time >= begin), default=np.inf)
    return float(begin), float(end)


def trial_of(log: OperationLog, estimates: list[Estimate] | None = None) -> Trial:
    """The run of a recording as a trial.

    Positions, velocities, heading and joint angles are the estimator's; the references are those in force; torques are
    the modules' own, if they report them; the electrical work is the power meter's, (4): V times the current above
    the one at rest.

    Args:
        log: The recording.
        estimates: Others than the recorded ones, of `rerun_estimator` for instance.

    Raises:
        TrialFileError: If it holds no run.
    """
    run = run_of(log, estimates)
    time = np.array([estimate.time for estimate in run])
    rate = np.stack([estimate.joint_rate for estimate in run])
    torque = _torque(log, time)
    work = None if torque is None else _work(time, torque, rate)
    electrical, power_source = electrical_work(log, time)
    missing = () if torque is not None else ("joint_torque", "work")
    reference = _references(log, time)
    not_measured = (*missing, *(() if reference is not None else ("joint_angle_ref",)))
    header = log.header
    end = _ending(log)
    return Trial(
        time=time - time[0],
        center_of_mass=np.stack([estimate.center_of_mass for estimate in run]),
        center_of_mass_velocity=np.stack([estimate.center_of_mass_velocity for estimate in run]),
        heading=np.array([estimate.heading for estimate in run]),
        heading_rate=np.array([estimate.heading_rate for estimate in run]),
        link_angle=np.stack([estimate.link_angle for estimate in run]),
        joint_angle=np.stack([estimate.joint_angle for estimate in run]),
        joint_rate=rate,
        joint_angle_ref=np.zeros_like(rate) if reference is None else reference,
        joint_torque=np.zeros_like(rate) if torque is None else torque,
        work=np.zeros((time.size, 3)) if work is None else work,
        electrical_work=electrical,
        not_measured=not_measured,
        signals=_signals(log, time, run),
        robot=header.robot,
        gait=header.gait,
        environment=header.environment,
        settings={"source": "recording", **power_source, **header.settings},
        version=log.version,
        status=end.message if end is not None else "The recording reached its end.",
        succeeded=_succeeded(log, end),
    )


def electrical_work(log: OperationLog, time: Column) -> tuple[Column | None, Mapping[str, float | str]]:
    """Electrical work above idle at some times [J], and how it was made; None without at least two readings.

    W(t) = V (Q(t) - Q(0)) - V I_0 t, with the charge Q from the meter's own average where it keeps one (it is that
    average times the time of its record, so nothing between two readings is missed), else from its readings. Its slope
    over a run is (4): P = V I_avg - V I_0. V is the one of the recording.

    Args:
        log: The recording.
        time: When [s].

    Raises:
        TrialFileError: If it holds readings and does not say the supply's voltage.
    """
    readings: list[PowerReading] = log.of(PowerReading)
    if len(readings) < 2:
        return None, {}
    volts = log.header.supply_voltage
    if volts is None:
        raise TrialFileError(f"Cannot replay {log.path}: it holds power readings, and no `supply_voltage`.")
    when = np.array([reading.time for reading in readings])
    current = np.array([reading.current for reading in readings])
    steps = np.diff(when) * 0.5 * (current[1:] + current[:-1])
    for i, (one, two) in enumerate(itertools.pairwise(readings)):
        charge = _charge_between(one, two)
        if charge is not None:
            steps[i] = charge
    charge = np.concatenate(([0.0], np.cumsum(steps)))
    idle = idle_current(log, volts)
    drawn = np.interp(time, when, charge)
    work = volts * (drawn - drawn[0] - idle * (time - time[0]))
    return work, {"supply_voltage": volts, "idle_current": idle}


def idle_current(log: OperationLog, supply_voltage: float) -> float:
    """I_0: as it was noted before the run, or what the robot draws at rest by its file, at a `supply_voltage` [A]."""
    noted = log.notes.get("idle", {}).get("current")
    if noted is not None:
        return not_negative("idle current", float(noted), "A")
    return log.header.robot.idle_power / supply_voltage


def rerun_estimator(
    log: OperationLog, estimator: AnyEstimator | None = None, *, plant: Callable[..., Plant[Any]] | None = None
) -> list[Estimate]:
    """What an estimator makes of the recorded samples, in their order, at the times of the recorded estimates.

    Args:
        log: The recording.
        estimator: None takes the recorded one; then the estimates are the recorded ones, bit for bit.
        plant: `laticauda.plant`, which makes a recorded estimator's digital twin again; needed only if it had one.

    Raises:
        ValueError: If there is no estimator, or its twin would have to be made and `plant` was not given.
    """
    chosen: Any = log.header.estimator if estimator is None else estimator
    record = getattr(chosen, "plant", None)
    if plant is not None and isinstance(record, PlantRecord):
        chosen = replace(chosen, plant=record.made(plant))
    if chosen is None:
        raise ValueError("`estimator` must be given: the recording holds none, got None.")
    state = chosen.init()
    found: list[Estimate] = []
    for entry in log.entries:
        if isinstance(entry, PoseSample | JointSample | ReferenceSample):
            state = chosen.step(state, entry)
        elif isinstance(entry, Estimate):
            estimate = chosen.estimate(state, entry.time)
            if estimate is not None:
                found.append(estimate)
    return found


def rerun_controller(log: OperationLog, controller: Any = None, estimates: list[Estimate] | None = None) -> Rerun:
    """What a controller decides on the recorded estimates, at the recorded control instants of the run.

    Args:
        log: The recording.
        controller: None takes the recorded one; then the commands are the recorded ones, bit for bit.
        estimates: Others than the recorded ones.

    Raises:
        ValueError: If there is no controller, or an instant has no estimate.
    """
    chosen: Any = log.header.controller if controller is None else controller
    if chosen is None:
        raise ValueError("`controller` must be given: the recording holds none, got None.")
    begin, end = run_span(log)
    recorded = [item for item in log.of(Decision) if begin <= item.time <= end]
    seen = {item.time: item for item in (log.of(Estimate) if estimates is None else estimates)}
    state, again = chosen.init(), list[Decision]()
    for decision in recorded:
        if decision.time not in seen:
            raise ValueError(f"`estimates` must have one at every control instant, got none at {decision.time} s.")
        state, command = chosen.step(state, seen[decision.time].observation())
        instance("command", command, Command)
        again.append(Decision(time=decision.time, command=command, signals={}))
    return Rerun(recorded=tuple(recorded), again=tuple(again))


# ---- inside --------------------------------------------------------------------------------------------------------


def _charge_between(one: PowerReading, two: PowerReading) -> float | None:
    """Charge between two readings of a meter that averages since `since` [A s]; None if that does not say."""
    if one.average is None or two.average is None or one.since is None or one.since != two.since:
        return None
    return two.average * (two.time - one.since) - one.average * (one.time - one.since)


def _torque(log: OperationLog, time: Column) -> Table | None:
    """Torques of the yaw joints at some times; None if they are not reported."""
    samples = [sample for sample in log.of(JointSample) if sample.torque is not None]
    if not samples:
        return None
    return _at_times(time, samples, [yaw_joints(log.header.robot, "torque", sample.torque) for sample in samples])


def _at_times(time: Column, samples: list[JointSample], values: list[Column]) -> Table:
    """Values of samples at other times, straight between them; those that are nan are left out."""
    when, table = np.array([sample.time for sample in samples]), np.stack(values)
    order = np.argsort(when, kind="stable")
    when, table = when[order], table[order]
    columns: list[Column] = []
    for i in range(table.shape[1]):
        column = table[:, i]
        known = np.isfinite(column)
        columns.append(np.interp(time, when[known], column[known]) if known.any() else np.zeros(time.size))
    return np.stack(columns, axis=1)


def _references(log: OperationLog, time: Column) -> Table | None:
    """What was in force at some times; None if nothing was asked for. Before the first one, straight."""
    samples: list[ReferenceSample] = log.of(ReferenceSample)
    if not samples:
        return None
    when = np.array([sample.time for sample in samples])
    table = np.stack([yaw_joints(log.header.robot, "angle", sample.angle) for sample in samples])
    held = np.searchsorted(when, time, side="right") - 1
    return np.where(held[:, np.newaxis] >= 0, table[held], 0.0)


def _work(time: Column, torque: Table, rate: Table) -> Table:
    """Work of the joints so far: of sum |u phi'|, of sum u phi', of sum max(u phi', 0)."""
    power = torque * rate
    kinds = np.stack((np.abs(power).sum(1), power.sum(1), np.maximum(power, 0.0).sum(1)), axis=1)
    steps = 0.5 * np.diff(time)[:, np.newaxis] * (kinds[1:] + kinds[:-1])
    return np.concatenate((np.zeros((1, 3)), np.cumsum(steps, axis=0)))


def _signals(log: OperationLog, time: Column, run: list[Estimate]) -> dict[str, Column]:
    """What the controller had in mind, held between control instants, and how sure the estimator was."""
    found = {
        "age": np.array([estimate.age for estimate in run]),
        "center_of_mass_std": np.array([estimate.center_of_mass_std for estimate in run]),
        "heading_std": np.array([estimate.heading_std for estimate in run]),
    }
    begin, end = run_span(log)
    told = [item for item in log.of(Decision) if begin <= item.time <= end and item.signals]
    if told:
        when = np.array([item.time for item in told])
        held = np.maximum(np.searchsorted(when, time + 1e-9, side="right") - 1, 0)
        for name in told[0].signals:
            found[name] = np.array([item.signals.get(name, 0.0) for item in told])[held]
    return found


def _ending(log: OperationLog) -> Event | None:
    """The event that ended the run."""
    begin, end = run_span(log)
    return next((e for e in log.of(Event) if e.kind in ("stop", "fault") and begin <= e.time <= end), None)


def _succeeded(log: OperationLog, end: Event | None) -> bool:
    return end is not None and end.kind == "stop" and end.data.get("succeeded", True) is True and not log.lost
