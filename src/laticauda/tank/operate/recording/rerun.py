"""An operation's estimator, learner or controller, run once more on what was recorded."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from laticauda.control.estimation import (
    Estimate,
    Estimator,
    Learned,
    Learner,
    Learning,
    Mount,
    Sample,
    StateEstimator,
)
from laticauda.models.dynamics import Plant
from laticauda.scenarios import interfaces
from laticauda.sensing import Reading
from laticauda.tank.operate.procedure.sensed import SensedState
from laticauda.tank.operate.recording.entries import Decision, SensorSample
from laticauda.tank.operate.recording.log import OperationLog
from laticauda.values import BadArgument, check_instance


@dataclass(frozen=True, kw_only=True)
class Rerun:
    """Commands of a controller that was run again, and the recorded commands."""

    recorded: tuple[Decision, ...]
    """Recorded decisions."""
    again: tuple[Decision, ...]
    """New decisions at the same instants."""

    @property
    def n_different(self) -> int:
        """Number of instants at which the two commands are not the same, bit for bit [-]."""
        pairs = zip(self.recorded, self.again, strict=True)
        return sum(recorded.command != again.command for recorded, again in pairs)

    @property
    def largest_difference(self) -> float:
        """Largest difference between the two offsets of the joints [rad]."""
        pairs = zip(self.recorded, self.again, strict=True)
        return max(
            (abs(recorded.command.offset - again.command.offset) for recorded, again in pairs),
            default=0.0,
        )


def rerun_estimator(
    log: OperationLog,
    estimator: StateEstimator | None = None,
    *,
    plant: Callable[..., Plant[Any]] | None = None,
) -> list[Estimate]:
    """Run an estimator on the recorded samples, in their order, and estimate at the recorded times.

    Args:
        log: The recording.
        estimator: Estimator to run; None: the recorded one, whose estimates equal the recorded ones
            bit for bit.
        plant: `laticauda.build_plant`, which rebuilds a recorded estimator's digital twin; needed
            only if it had one.

    Raises:
        ValueError: If there is no estimator, or its twin has to be rebuilt and `plant` is not
            given.
    """
    if estimator is None:
        estimator = _recorded_estimator(log, plant)
    state = estimator.init()
    estimates: list[Estimate] = []
    new_samples: list[Sample] = []
    for entry in log.entries:
        if isinstance(entry, Sample):
            new_samples.append(entry)
        elif isinstance(entry, Estimate):
            state = estimator.steps(state, new_samples)
            new_samples.clear()
            estimate = estimator.estimate(state, entry.time)
            if estimate is not None:
                estimates.append(estimate)
    return estimates


def rerun_learner(
    log: OperationLog, plant: Callable[..., Plant[Any]], settings: Learning | None = None
) -> list[Learned]:
    """Return what a twin learns from the recorded samples.

    If that was recorded, too, the two agree bit for bit.

    Args:
        log: The recording.
        plant: `laticauda.build_plant`, which builds the twin.
        settings: What is learned; None: the recorded settings, or else the default.

    Raises:
        ValueError: If nothing can be learned about such a robot.
    """
    run = log.header.run
    learner = Learner(
        settings=settings or log.header.learning or Learning(),
        robot=run.robot,
        plant=plant(run.robot, run.environment, joints=log.header.joint_law),
        mount=getattr(log.header.estimator, "mount", Mount()),
    )
    state = learner.init()
    results: list[Learned] = []
    samples = [entry for entry in log.entries if isinstance(entry, Sample)]
    for sample in samples:
        state = learner.step(state, sample)
        if state.learned is not None:
            results.append(state.learned)
    return results


def rerun_controller(
    log: OperationLog,
    controller: interfaces.Controller[Any] | None = None,
    estimates: list[Estimate] | None = None,
) -> Rerun:
    """Run a controller on the recorded estimates, at the recorded control instants of the run.

    Args:
        log: The recording.
        controller: Controller to run; None: the recorded one, whose commands equal the recorded
            ones bit for bit.
        estimates: Estimates to use instead of the recorded ones.

    Raises:
        ValueError: If there is no controller, or an instant has no estimate.
    """
    rerun: Any = log.header.controller if controller is None else controller
    if rerun is None:
        raise BadArgument("controller", "must be given: the recording holds none, got None")
    if estimates is None:
        estimates = log.of(Estimate)
    estimate_at = {estimate.time: estimate for estimate in estimates}
    recorded: list[Decision] = log.of_run(Decision)
    again: list[Decision] = []
    state = rerun.init()
    for decision, readings in zip(recorded, _readings_at(log, recorded), strict=True):
        time = decision.time
        if time not in estimate_at:
            raise BadArgument(
                "estimates", f"must have one at every control instant, got none at {time} s"
            )
        observation = estimate_at[time].with_readings(readings)
        state, command = rerun.step(state, observation)
        check_instance("command", command, interfaces.Command)
        again.append(Decision(time=time, command=command, signals={}))
    return Rerun(recorded=tuple(recorded), again=tuple(again))


def _readings_at(log: OperationLog, decisions: Sequence[Decision]) -> list[Mapping[str, Reading]]:
    """Return what the robot's own sensors had told at each of some decisions, in their order."""
    first = decisions[0].time if decisions else math.inf
    sensed = SensedState()
    readings: list[Mapping[str, Reading]] = []
    for entry in log.of(SensorSample, Decision):
        if isinstance(entry, SensorSample):
            sensed = sensed.with_sample(entry)
        elif entry.time >= first and len(readings) < len(decisions):
            readings.append(sensed.readings)
            sensed = sensed.after_decision()
    return readings


def _recorded_estimator(
    log: OperationLog, plant: Callable[..., Plant[Any]] | None
) -> StateEstimator:
    """Return the recorded estimator, with its digital twin."""
    estimator = log.header.estimator
    twin = log.header.twin
    if estimator is None:
        raise BadArgument("estimator", "must be given: the recording holds none, got None")
    if twin is None or not isinstance(estimator, Estimator):
        return estimator
    if plant is None:
        raise BadArgument(
            "plant", "must be `laticauda.build_plant`, which rebuilds the recorded twin, got None"
        )
    return replace(estimator, plant=plant(twin.robot, twin.environment, twin.model))
