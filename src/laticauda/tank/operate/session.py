"""One operation from the connections to the trial: devices, loop, recording, figures."""

import itertools
import math
import time
import tomllib
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from laticauda import scenarios
from laticauda.control.estimation import Learner
from laticauda.models.dynamics.plant import Plant
from laticauda.tank import lab
from laticauda.tank.operate import drivers, loop, settings, terminal
from laticauda.tank.operate.course.operator import Operator
from laticauda.tank.operate.course.state import OperatorState, Outputs
from laticauda.tank.operate.recording import log, to_trial
from laticauda.tank.operate.recording.entries import Event, Header, Timing, punctuality
from laticauda.tank.operate.recording.log import OperationRecorder, Sink
from laticauda.tank.operate.recording.writer import Writer
from laticauda.tank.operate.safety.supervisor import BY_EVENT, cause_of
from laticauda.tank.operate.verdict import Verdict, verdict_of
from laticauda.trials import Trial, following, logs
from laticauda.values import files
from laticauda.values.errors import BadArgument, TrialFileError

TOLD: dict[str, Any] = tomllib.loads(Path(__file__).with_name("figures.toml").read_text())
"""How the figures of a `run` and of a `series` are shown."""
PATIENCE = 10.0  # longest wait until the recording is on disk [s]
LONGEST_PREPARATION = 120.0  # longest time before and after a run, except for settling [s]


@dataclass(frozen=True, kw_only=True, eq=False)
class Result:
    """Outcome of an operation."""

    name: str
    """Name of the operation."""
    accepted: bool
    """Whether the run counts: neither a fault nor the operator ended it, and its verdict found nothing wrong."""
    reason: str
    """How the run ended, or why it does not count."""
    trial: Trial | None
    """The run; None if there was none."""
    start: tuple[float, float, float] | None = None
    """Center of mass [m, m] and heading [rad] before the run."""
    idle_current: float | None = None
    """I_0 [A]; None: not measured."""
    supply_voltage: float | None = None
    """V of (4) [V]; None without a power meter."""
    notes: tuple[str, ...] = ()
    """Problems that did not stop the run."""
    recording: Path | None = None
    """File of the recording."""
    timing: Timing | None = None
    """Punctuality of the loop; None if it had no real clock."""
    aftermath: str = ""
    """What went wrong while the robot stopped after a run that counts, to be inspected before the next; "" if nothing
    did."""
    verdict: Verdict | None = None
    """Verdict on the run; None if there was no run, or it was not recorded."""
    stopped: bool = False
    """Whether the operator has asked to stop, during the run or after it."""
    needs_acknowledgment: bool = False
    """Whether a fault has stopped the robot: somebody has to look at it before it gets torque again."""

    def summary(self) -> dict[str, Any]:
        """Return the figures of the run by name, ready for JSON."""
        found: dict[str, Any] = {
            "name": self.name,
            "accepted": self.accepted,
            "reason": self.reason,
        }
        if self.start is not None:
            found |= {"initial_cross_track_error": self.start[1], "initial_heading": self.start[2]}
        found["idle_current"], trial = self.idle_current, self.trial
        if trial is not None:
            found |= {"duration": trial.duration, "forward_velocity": trial.forward_velocity}
            has_power = trial.electrical_work is not None and not self.notes
            found["electrical_power"] = trial.electrical_power if has_power else None
            idle = (
                0.0
                if self.idle_current is None
                else (self.supply_voltage or 0.0) * self.idle_current
            )
            found["total_power"] = trial.electrical_power + idle if has_power else None
            error = trial.signals.get("cross_track_error")
            if error is not None:
                found["final_cross_track_error"] = float(error[-1])
                reached = following.summarize_following(trial)
                found |= {
                    name: reached[name] for name in ("convergence_time", "steady_error", "ripple")
                }
        parts = {"timing": self.timing, "verdict": self.verdict}
        found |= {"notes": list(self.notes), "aftermath": self.aftermath}
        found["learned"] = None if trial is None else trial.settings.get("learned")
        found["recording"] = None if self.recording is None else str(self.recording)
        return found | {
            name: None if part is None else part.summary() for name, part in parts.items()
        }


def header_of(operator: Operator, text: str = "") -> Header:
    """Return the header of the recording of an operation.

    Args:
        operator: Operator of the operation.
        text: The trial file as it was read.
    """
    how = operator.operation
    made = {"ramp": how.ramp, "offset_bandwidth": how.offset_bandwidth, "rate": how.rate}
    return Header(
        run=scenarios.Experiment(
            robot=operator.robot,
            gait=how.gait,
            environment=how.pool(),
            notes={"model": "robot", "joints": "modules", **made},
        ),
        controller=None if how.following is None else how.controller(),
        estimator=operator.estimator,
        supply_voltage=how.supply_voltage,
        learning=how.learning,
        operation=text,
    )


def operate(
    operation: settings.Operation,
    folder: Path | None,
    *,
    clock: drivers.Clock | None = None,
    tank: lab.Tank | None = None,
    keys: terminal.Keys | None = None,
    show: loop.Show | None = None,
    clears: bool = False,
    check_only: bool = False,
    text: str = "",
    twin: Plant[Any] | None = None,
    frames: bool = True,
) -> Result:
    """Operate the robot once.

    Args:
        operation: Operation to run.
        folder: Folder for the recording, ``NAME.mcap``, and the trial, ``NAME.nc``; ``NAME-2`` and
            so on if there is
            one already. None: nothing is kept.
        clock: Clock of the operation; None: real time.
        tank: Tank to operate instead: stepped, without wires and as fast as possible; `operation`
            need not give its addresses, only whether there is a power meter.
        keys: What the operator presses, entered; None: nothing.
        show: Function that is called with every tick; must be fast.
        clears: Whether to clear faults of the modules first.
        check_only: Whether to stop before anything moves.
        text: The trial file as it was read.
        twin: Simulated robot that serves as the motion model of the state estimation; None: it does
            without.
        frames: Whether the raw frames of the bus are also recorded.

    Returns:
        The outcome; a refusal or a fault does not raise an exception.

    Raises:
        DeviceFailed: If a device cannot be reached.
        StorageFailed: If the recording cannot be written at the start.
        RuntimeError: If the operation of a tank does not end, or ticks fail again and again.
        ValueError: If something is to be learned, but there is no `twin`, or nothing can be learned
            with it.
    """
    if folder is not None:
        operation = replace(operation, name=_free_name(operation.name, folder))
    operator = Operator(operation=operation, clears=clears, check_only=check_only, twin=twin)
    header = header_of(operator, text)  # rejects an unsuitable robot before anything is connected
    keys, learner = keys or terminal.Keys(), _learner(operator)
    path = None if folder is None else folder / f"{operation.name}.mcap"
    with ExitStack() as stack:
        sink, longest = None, math.inf
        if tank is None:
            devices = stack.enter_context(
                loop.connected(operation.connection, clock or drivers.Clock())
            )
        else:
            devices = loop.TankDevices(tank, has_meter=bool(operation.connection.meter_address))
            longest = operation.duration + operation.calibration.patience + LONGEST_PREPARATION
        if path is not None:
            files.local(path).parent.mkdir(parents=True, exist_ok=True)
            epoch = time.time_ns() - round(1e9 * devices.clock.now())
            if tank is None:
                sink = stack.enter_context(
                    Writer(path, header, frames=frames, learner=learner, epoch=epoch)
                )
            else:
                recorder = stack.enter_context(OperationRecorder(path, header, epoch=epoch))
                sink = Sink(recorder, frames=frames, learner=learner)
            show = show and _with_news(show, sink)
        state, timing = loop.run_loop(
            operator, devices, keys=lambda _: keys.events, sink=sink, show=show, longest=longest
        )
        read = verdict = None
        if path is not None and sink is not None and state.begun is not None:
            now = state.now or 0.0
            if show is not None:
                show(
                    state,
                    Outputs(
                        entries=(
                            Event(time=now, kind="checking", message="the run, from its recording"),
                        )
                    ),
                )
            if isinstance(sink, Writer):
                sink.flush()
            read = _read(path)
            if read is None:
                note = "The run has not been checked yet: `laticauda replay` does that."
                state = replace(state, notes=(*state.notes, note))
            else:
                verdict = verdict_of(read, operation.acceptance, twin)
                message = verdict.reason or "The run passed all checks."
                found = Event(time=now, kind="verdict", message=message, data=verdict.summary())
                sink.keep(now, (found,))
                read = replace(read, entries=(*read.entries, found))
    return replace(
        result_of(operator, state, path, timing, verdict, read), stopped=bool(keys.events)
    )


def _learner(operator: Operator) -> Learner | None:
    """Return the learner that learns from the recording; None if nothing is to be learned."""
    how, twin = operator.operation, operator.twin
    if how.learning is None:
        return None
    if twin is None:
        raise BadArgument("twin", "must be given with `learning`, got None")
    return Learner(
        settings=how.learning, robot=operator.robot, plant=twin, mount=how.calibration.mount
    )


def _with_news(show: loop.Show, sink: Sink | Writer) -> loop.Show:
    """Wrap a function so that its entries include what was learned in the meantime."""

    def shown(state: OperatorState, outputs: Outputs) -> None:
        news = [sink.news.popleft() for _ in range(len(sink.news))]
        show(state, replace(outputs, entries=(*outputs.entries, *news)))

    return shown


def _read(path: Path) -> log.OperationLog | None:
    """Return a recording that is still open, as soon as its end is in it; None if it cannot be read, or has no end."""
    with suppress(TrialFileError):
        recording, patience = logs.open_recording(path), time.monotonic() + PATIENCE
        while time.monotonic() < patience:
            if any("-> done" in one.content["msg"] for one in recording.more("/events")):
                return replace(log.operation_in(recording), lost="")
            time.sleep(0.05)
    return None


def kept_runs(folder: Path) -> set[str]:
    """Return the names of all runs in a folder, whatever their outcome."""
    return {path.stem for path in folder.glob("*") if path.suffix in (".mcap", ".nc")}


def _free_name(name: str, folder: Path) -> str:
    """Return a name for a run that no run in the folder has yet."""
    names, taken = (
        itertools.chain((name,), (f"{name}-{number}" for number in itertools.count(2))),
        kept_runs(folder),
    )
    return next(one for one in names if one not in taken)


def result_of(
    operator: Operator,
    state: OperatorState,
    recording: Path | None,
    timing: Timing | None,
    verdict: Verdict | None = None,
    read: log.OperationLog | None = None,
) -> Result:
    """Return the outcome of an operation, from its last state and its recording.

    Args:
        operator: Operator of the operation.
        state: Last state.
        recording: Closed file of the recording; None if nothing was recorded.
        timing: Punctuality of the loop; None: not known.
        verdict: Verdict on the run; None: there is none.
        read: What is in the recording; None: it is still to be read.
    """
    trial: Trial | None = None
    if recording is not None and state.begun is not None:
        try:
            trial = to_trial.trial_of(read or log.read_operation(recording))
            trial.save(recording.with_suffix(".nc"))
        except TrialFileError as error:
            state = replace(state, notes=(*state.notes, str(error)))
    accepted, reason = _judged(operator, state)
    if accepted and verdict is not None and verdict.reason:
        accepted, reason = False, verdict.reason
    return Result(
        name=operator.operation.name,
        accepted=accepted and (trial is not None or recording is None),
        reason=reason,
        trial=trial,
        start=state.prepared.start,
        idle_current=state.idle.mean,
        supply_voltage=operator.operation.supply_voltage,
        notes=state.notes,
        recording=recording,
        timing=timing,
        aftermath=_aftermath(state) if accepted else "",
        verdict=verdict,
        needs_acknowledgment=state.supervisor.is_fault,
    )


def _aftermath(state: OperatorState) -> str:
    """Return what happened to the robot after the run; it does not affect the run, but prevents the next."""
    cause = state.supervisor.cause
    if cause not in BY_EVENT or not state.supervisor.is_fault:
        return ""
    return f"After the run, {cause_of(cause)}. Check the robot, then start with `--clear`."


def _judged(operator: Operator, state: OperatorState) -> tuple[bool, str]:
    """Return whether the run counts, and how it ended."""
    if operator.check_only and not state.failure:
        return True, "All devices are OK."
    if state.begun is None:
        cause = cause_of(state.supervisor.cause) or "the run did not start"
        return False, state.failure or f"{cause[:1].upper()}{cause[1:]}."
    if not state.stopped_by:
        return True, "The run reached its end."
    if state.stopped_by == "edge":
        return True, f"The run ended: {cause_of(state.stopped_by)}."
    return False, f"The run was ended: {cause_of(state.stopped_by)}."


def format_summary(summary: Mapping[str, Any]) -> str:
    """Return a summary as text, one figure per line.

    Args:
        summary: Summary of a `Result`.
    """
    lines = [
        f"{summary['name']}: {'accepted' if summary['accepted'] else 'rejected'}. {summary['reason']}"
    ]
    for name, (says, unit, digits) in TOLD["run"].items():
        if summary.get(name) is not None:
            lines.append(f"  {says:<24}{summary[name]:>12.{digits}f} {unit}")
    if summary.get("timing"):
        lines.append(f"  loop: {punctuality(summary['timing'])}")
    lines += [f"  {line}" for line in summary["verdict"]["lines"]] if summary.get("verdict") else []
    lines += [f"  learned: {summary['learned']}"] if summary.get("learned") else []
    lines += [
        f"  note: {note}" for note in (*summary.get("notes", ()), summary.get("aftermath")) if note
    ]
    if summary.get("recording"):
        lines.append(f"  recording: {summary['recording']}")
    return "\n".join(lines)
