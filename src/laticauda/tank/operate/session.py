"""One operation from the connections to the trial: devices, loop, recording, verdict.

Its outcome is a `Result`, see `laticauda.tank.operate.results`.
"""

import math
import time
from collections.abc import Generator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from laticauda import scenarios
from laticauda.control.estimation import Learner
from laticauda.models.dynamics import Plant
from laticauda.tank import lab
from laticauda.tank.operate import drivers, loop, settings, terminal
from laticauda.tank.operate.devices import Devices, connected
from laticauda.tank.operate.procedure.operator import Operator
from laticauda.tank.operate.procedure.state import OperatorState, Outputs
from laticauda.tank.operate.recording.entries import Event
from laticauda.tank.operate.recording.header import Header
from laticauda.tank.operate.recording.log import EVENTS_TOPIC, OperationLog, entry_of, operation_in
from laticauda.tank.operate.recording.recorder import OperationRecorder, Sink
from laticauda.tank.operate.recording.timing import Timing
from laticauda.tank.operate.recording.writer import Writer
from laticauda.tank.operate.results import (
    Result as Result,
    format_summary as format_summary,
    result_of as result_of,
)
from laticauda.tank.operate.tank_devices import TankDevices
from laticauda.tank.operate.verdict import Verdict, verdict_of
from laticauda.trials import logs
from laticauda.values import BadArgument, TrialFileError, files

PATIENCE = 10.0
"""Longest wait until the recording is on disk [s, wall clock]."""
POLL_INTERVAL = 0.05
"""Time between two looks at whether it is [s, wall clock]."""
LONGEST_PREPARATION = 120.0
"""Longest time before and after a run, except for settling [s]."""
NOT_CHECKED = "The run has not been checked yet: `laticauda replay` does that."
"""Note about a run whose recording was not on disk in time."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Recording:
    """A recording that is being written."""

    path: Path
    """Path of the file."""
    sink: Sink | Writer
    """Keeps what is recorded."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LoopEnd:
    """What is known when the loop has ended, while the recording is still open."""

    state: OperatorState
    """Last state, with notes about the recording."""
    timing: Timing | None
    """Punctuality of the loop; None if it had no real clock."""
    log: OperationLog | None = None
    """What is in the recording, with its verdict; None if there was no run, or it was not read."""
    verdict: Verdict | None = None
    """Verdict on the run; None: there is none."""


def header_of(operator: Operator, text: str = "") -> Header:
    """Return the header of the recording of an operation.

    Args:
        operator: Operator of the operation.
        text: The trial file as it was read.
    """
    operation = operator.operation
    controller = None
    if operation.following is not None or operation.steering is not None:
        controller = operation.controller()
    return Header(
        run=scenarios.Experiment(
            robot=operator.robot,
            gait=operation.gait,
            environment=operation.pool(),
            notes={
                "model": "robot",
                "joints": "modules",
                "ramp": operation.ramp,
                "offset_bandwidth": operation.offset_bandwidth,
                "rate": operation.rate,
            },
        ),
        controller=controller,
        estimator=operator.estimator,
        supply_voltage=operation.supply_voltage,
        learning=operation.learning,
        operation=text,
        joints=operation.joint_law(),
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
            so on if there is one already. None: nothing is kept.
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
    path = None
    if folder is not None:
        operation = replace(operation, name=_free_name(operation.name, folder))
        path = folder / f"{operation.name}.mcap"
    operator = Operator(operation=operation, clears=clears, check_only=check_only, twin=twin)
    header = header_of(operator, text)  # rejects an unsuitable robot before anything is connected
    learner = _learner(operator)
    if keys is None:
        keys = terminal.Keys()
    with (
        _connect(operation, clock, tank) as devices,
        _record(path, header, devices, learner, frames=frames) as recording,
    ):
        end = _run_and_judge(operator, devices, recording, keys=keys, show=show)
    result = result_of(operator, end.state, path, end.timing, end.verdict, end.log)
    return replace(result, stopped=bool(keys.events))


def _run_and_judge(
    operator: Operator,
    devices: Devices,
    recording: Recording | None,
    *,
    keys: terminal.Keys,
    show: loop.Show | None,
) -> LoopEnd:
    """Run the loop, and judge the run by its recording, which keeps the verdict."""
    if show is not None and recording is not None:
        show = _show_with_news(show, recording.sink)
    is_tank = isinstance(devices, TankDevices)
    longest = _longest_operation(operator.operation) if is_tank else math.inf
    state, timing = loop.run_loop(
        operator,
        devices,
        keys=lambda _: keys.events,
        sink=None if recording is None else recording.sink,
        show=show,
        longest=longest,
    )
    if recording is None or state.begun is None:
        return LoopEnd(state=state, timing=timing)
    now = state.now or 0.0
    if show is not None:
        checking = Event(time=now, kind="checking", message="the run, from its recording")
        show(state, Outputs(entries=(checking,)))
    if isinstance(recording.sink, Writer):
        recording.sink.flush()
    log = _read_when_complete(recording.path)
    if log is None:
        state = replace(state, notes=(*state.notes, NOT_CHECKED))
        return LoopEnd(state=state, timing=timing)
    verdict = verdict_of(log, operator.operation.acceptance, operator.twin)
    event = Event(
        time=now,
        kind="verdict",
        message=verdict.reason or "The run passed all checks.",
        data=verdict.summary(),
    )
    recording.sink.keep(now, (event,))
    log = replace(log, entries=(*log.entries, event))
    return LoopEnd(state=state, timing=timing, log=log, verdict=verdict)


@contextmanager
def _connect(
    operation: settings.Operation, clock: drivers.Clock | None, tank: lab.Tank | None
) -> Generator[Devices]:
    """Connect the devices, or those of a tank without wires."""
    if tank is not None:
        has_meter = bool(operation.connection.meter_address)
        yield TankDevices(tank, has_meter=has_meter)
        return
    with connected(operation.connection, clock or drivers.Clock()) as devices:
        yield devices


@contextmanager
def _record(
    path: Path | None,
    header: Header,
    devices: Devices,
    learner: Learner | None,
    *,
    frames: bool,
) -> Generator[Recording | None]:
    """Open the recording: in a separate program, unless a tank is stepped; None without a path."""
    if path is None:
        yield None
        return
    files.local(path).parent.mkdir(parents=True, exist_ok=True)
    epoch = time.time_ns() - round(1e9 * devices.clock.now())
    if isinstance(devices, TankDevices):
        with OperationRecorder(path, header, epoch=epoch) as recorder:
            yield Recording(path=path, sink=Sink(recorder, frames=frames, learner=learner))
        return
    with Writer(path, header, frames=frames, learner=learner, epoch=epoch) as writer:
        yield Recording(path=path, sink=writer)


def _longest_operation(operation: settings.Operation) -> float:
    """Return the time after which an operation of a tank is given up [s]."""
    return operation.duration + operation.calibration.patience + LONGEST_PREPARATION


def _learner(operator: Operator) -> Learner | None:
    """Return the learner that learns from the recording; None if nothing is to be learned."""
    operation = operator.operation
    if operation.learning is None:
        return None
    if operator.twin is None:
        raise BadArgument("twin", "must be given with `learning`, got None")
    return Learner(
        settings=operation.learning,
        robot=operator.robot,
        plant=operator.twin,
        mount=operation.calibration.mount,
    )


def _show_with_news(show: loop.Show, sink: Sink | Writer) -> loop.Show:
    """Wrap a function so that its entries include what was learned in the meantime."""

    def show_with_news(state: OperatorState, outputs: Outputs) -> None:
        n_news = len(sink.news)  # meanwhile, another thread may add some
        news = [sink.news.popleft() for _ in range(n_news)]
        show(state, replace(outputs, entries=(*outputs.entries, *news)))

    return show_with_news


def _read_when_complete(path: Path) -> OperationLog | None:
    """Return a recording that is still open, as soon as the end of the operation is in it.

    It is None if it cannot be read, or its end does not come.
    """
    with suppress(TrialFileError):
        recording = logs.open_recording(path)
        latest = time.monotonic() + PATIENCE
        while time.monotonic() < latest:
            new_events = [entry_of(logged) for logged in recording.more(EVENTS_TOPIC)]
            if any(_ends_operation(event) for event in new_events):
                return replace(operation_in(recording), lost="")
            time.sleep(POLL_INTERVAL)
    return None


def _ends_operation(event: object) -> bool:
    return isinstance(event, Event) and event.kind == "phase" and event.data.get("after") == "done"


def kept_runs(folder: Path) -> set[str]:
    """Return the names of all runs in a folder, whatever their outcome."""
    return {path.stem for path in folder.glob("*") if path.suffix in (".mcap", ".nc")}


def _free_name(name: str, folder: Path) -> str:
    """Return a name for a run that no run in the folder has yet."""
    names_in_folder = kept_runs(folder)
    free_name = name
    number = 2
    while free_name in names_in_folder:
        free_name = f"{name}-{number}"
        number += 1
    return free_name
