"""Run a plant on a clock and keep the log."""

from collections.abc import Callable
from typing import Any

import numpy as np

from laticauda import __version__
from laticauda.errors import SimulationFailed, positive
from laticauda.interfaces import Command, Log, Plant, Start
from laticauda.trial import Trial

Progress = Callable[[float], None]

# Samples between two calls of `progress`: some tens of milliseconds of work.
CHUNK = 2000


def run(
    plant: Plant[Any],
    command: Command,
    duration: float,
    *,
    start: Start | None = None,
    sample_interval: float = 0.05,
    link_forces: bool = False,
    throw: bool = False,
    progress: Progress | None = None,
) -> Trial:
    """Let a plant swim under one command, from straight and at rest.

    Args:
        plant: What swims; see `plant`.
        command: The gait, and a steering offset.
        duration: [s].
        start: Where it begins; None: at the origin, along x.
        sample_interval: Between two samples of the log [s]; adjusted so that it divides the duration.
        link_forces: Log the force on every link too.
        throw: Raise when the run blows up, instead of returning a trial that says so.
        progress: Called now and then with the time reached [s].

    Returns:
        The trial, its final state included.

    Raises:
        ValueError: If an argument is out of its range.
        SimulationFailed: If the run blows up and `throw` is set.
    """
    state = plant.init(start or Start(), command)
    return _go(plant, state, command, duration, sample_interval, link_forces, throw, progress)


def resume(
    plant: Plant[Any],
    trial: Trial,
    duration: float,
    *,
    command: Command | None = None,
    sample_interval: float = 0.05,
    link_forces: bool = False,
    throw: bool = False,
    progress: Progress | None = None,
) -> Trial:
    """Go on from where a trial ended; the rest of a run is the same as if it had never been cut.

    Args:
        plant: The same plant as that of the trial (`plant_of` makes it again).
        trial: A trial that ran to its end.
        duration: How much longer [s].
        command: None goes on with the trial's gait.
        sample_interval: As for `run` [s].
        link_forces: As for `run`.
        throw: As for `run`.
        progress: As for `run`.

    Returns:
        The trial of the second part; `laticauda.trial.joined` puts the two together.

    Raises:
        ValueError: If the trial has no state to go on from, or not one of this plant.
        SimulationFailed: If the run blows up and `throw` is set.
    """
    if not trial.succeeded or not trial.state:
        raise ValueError(f"`trial` must have run to its end and hold its final state; it says: {trial.status}")
    if command is None:
        if trial.gait is None:
            raise ValueError("`command` must be given to go on with a trial that has no gait.")
        command = Command(gait=trial.gait)
    state = plant.unpack(trial.state)
    return _go(plant, state, command, duration, sample_interval, link_forces, throw, progress)


def _go(
    plant: Plant[Any],
    state: Any,
    command: Command,
    duration: float,
    sample_interval: float,
    link_forces: bool,
    throw: bool,
    progress: Progress | None,
) -> Trial:
    positive("duration", duration, "s")
    positive("sample_interval", sample_interval, "s")
    n_samples = max(1, round(duration / sample_interval))
    logs: list[Log] = []
    failure: str | None = None
    for first in range(0, n_samples, CHUNK):
        count = min(CHUNK, n_samples - first)
        share = duration * count / n_samples
        state, log, failure = plant.march(state, command, share, share / count, link_forces=link_forces)
        logs.append(log if first == 0 else {name: values[1:] for name, values in log.items()})
        if failure is not None:
            break
        if progress is not None:
            progress(duration * (first + count) / n_samples)
    if throw and failure is not None:
        raise SimulationFailed(failure)
    log = logs[0] if len(logs) == 1 else {name: np.concatenate([part[name] for part in logs]) for name in logs[0]}
    return _trial(plant, command, log, failure, state)


def _trial(plant: Plant[Any], command: Command, log: Log, failure: str | None, state: Any) -> Trial:
    force = {name[len("force_") :]: log.pop(name) for name in list(log) if name.startswith("force_")}
    gait = command.gait
    return Trial(
        **log,  # pyright: ignore[reportArgumentType]  # the plant's names are Trial's own
        link_force=force or None,
        robot=plant.robot,
        gait=gait,
        environment=plant.environment,
        settings={**plant.settings, "command_offset": command.offset},
        version=__version__,
        status=failure or "The run reached its end.",
        succeeded=failure is None,
        state=plant.pack(state) if failure is None else {},
    )


__all__ = ["resume", "run"]
