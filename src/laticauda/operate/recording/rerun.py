"""A recording once more through an estimator and a controller."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from laticauda.errors import BadArgument, instance
from laticauda.estimation import Estimate, Estimator, JointSample, PoseSample, ReferenceSample, StateEstimator
from laticauda.interfaces import Command, Controller, Plant
from laticauda.operate.recording.entries import Decision
from laticauda.operate.recording.log import OperationLog
from laticauda.operate.recording.to_trial import run_span


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


def rerun_estimator(
    log: OperationLog, estimator: StateEstimator | None = None, *, plant: Callable[..., Plant[Any]] | None = None
) -> list[Estimate]:
    """What an estimator makes of the recorded samples, in their order, at the times of the recorded estimates.

    Args:
        log: The recording.
        estimator: None takes the recorded one; then the estimates are the recorded ones, bit for bit.
        plant: `laticauda.plant`, which makes a recorded estimator's digital twin again; needed only if it had one.

    Raises:
        ValueError: If there is no estimator, or its twin would have to be made and `plant` was not given.
    """
    chosen = _recorded_estimator(log, plant) if estimator is None else estimator
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


def rerun_controller(
    log: OperationLog, controller: Controller[Any] | None = None, estimates: list[Estimate] | None = None
) -> Rerun:
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
        raise BadArgument("controller", "must be given: the recording holds none, got None")
    begin, end = run_span(log)
    recorded = [item for item in log.of(Decision) if begin <= item.time <= end]
    known = {item.time: item for item in (log.of(Estimate) if estimates is None else estimates)}
    state, again = chosen.init(), list[Decision]()
    for decision in recorded:
        if decision.time not in known:
            raise BadArgument("estimates", f"must have one at every control instant, got none at {decision.time} s")
        state, command = chosen.step(state, known[decision.time])
        instance("command", command, Command)
        again.append(Decision(time=decision.time, command=command, signals={}))
    return Rerun(recorded=tuple(recorded), again=tuple(again))


def _recorded_estimator(log: OperationLog, plant: Callable[..., Plant[Any]] | None) -> StateEstimator:
    """The one of the recording, with its digital twin."""
    estimator, twin = log.header.estimator, log.header.twin
    if estimator is None:
        raise BadArgument("estimator", "must be given: the recording holds none, got None")
    if twin is None or not isinstance(estimator, Estimator):
        return estimator
    if plant is None:
        raise BadArgument("plant", "must be `laticauda.plant`, which makes the recorded twin again, got None")
    return replace(estimator, plant=plant(twin.robot, twin.environment, twin.model))
