"""Simulation of a plant over time, with its log."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any, TypedDict, Unpack, cast

import numpy as np

from laticauda import gaits, packaging
from laticauda.dynamics.plant import Plant, Stretch, check_size
from laticauda.errors import BadArgument, SimulationFailed, check_instance
from laticauda.interfaces import Command, Controller, Observation, OpenLoop, Resumed, Start
from laticauda.robot import Robot
from laticauda.scenarios import Changes, Experiment, Motion, Scenario, build_scenario
from laticauda.simulate.plants import build_plant
from laticauda.trial import Trial
from laticauda.trial.contents import REACHED_END

Progress = Callable[[float], None]
Until = Callable[[Observation], bool]
States = Sequence[Any]
Marched = tuple[States, Sequence[Stretch], str | None]
"""States of all plants after a stretch of time, the resulting stretches of log, and a failure message, if any."""
March = Callable[[States, Sequence[Command], float, float], Marched]
"""Like `Plant.advance`, for all plants at once."""


def silent(*_: object) -> None:
    """Do nothing; the default callback."""


CLOSE = 1e-9  # [s]: times closer than this are equal
# Samples between two calls of `progress`: some tens of milliseconds of work.
CHUNK = 2000


class Watching(TypedDict, total=False):
    """Options of a run in addition to its scenario; see `run`."""

    link_forces: bool
    until: Until | None
    throw: bool
    progress: Progress


class Logging(Watching, total=False):
    """Options that control how a run is logged and ends; see `run`."""

    sample_interval: float


def run(
    plant: Plant[Any],
    controller: Controller[Any],
    duration: float,
    *,
    start: Start | Resumed | None = None,
    sample_interval: float = 0.05,
    link_forces: bool = False,
    until: Until | None = None,
    throw: bool = False,
    progress: Progress = silent,
) -> Trial:
    """Run a plant under a controller, starting straight and at rest.

    A command takes effect the plant's `loop_delay` after the observation from which it was
    computed; until the first one does, the controller's gait acts. `OpenLoop` ignores observations,
    and acts at once.

    Args:
        plant: The plant to run; see `plant`.
        controller: Computes the command at every control instant; `OpenLoop` holds one. Its signals
            are stored in the trial.
        duration: Duration of the run [s].
        start: Start of the run; None: at the origin, along x.
        sample_interval: Time between two samples of the log [s]; adjusted so that it divides the
            time between two control instants, and the duration.
        link_forces: Whether to log the force on every link as well.
        until: Called at every control instant after the first; when it returns True, the run ends
            early.
        throw: Whether to raise an error when the run blows up, instead of returning a trial that
            says so.
        progress: Called repeatedly with the time reached [s].

    Returns:
        The trial, including its final state.

    Raises:
        ValueError: If an argument is out of its range, or the controller rejects the robot.
        SimulationFailed: If the run blows up and `throw` is set.
    """
    scenario = Scenario(
        robot=plant.robot,
        motion=_motion(controller),
        environment=plant.environment,
        model=plant.settings,
        start=start or Start(),
        duration=duration,
        sample_interval=sample_interval,
    )
    return run_scenario(
        scenario, plant, link_forces=link_forces, until=until, throw=throw, progress=progress
    )


def run_scenario(scenario: Scenario, plant: Plant[Any], **how: Unpack[Watching]) -> Trial:
    """Run a scenario on its plant; errors as for `run`.

    Args:
        scenario: Everything that determines the run.
        plant: The plant made from the scenario.
        how: `link_forces`: log the force on every link as well; `until`: called at every control
            instant, ends the run when it returns True; `throw`: raise an error when the run blows
            up; `progress`: called repeatedly with the time reached [s].
    """
    # Record the robot that actually swims, such as its planar form, and what the scenario leaves
    # open, such as dt.
    scenario = replace(scenario, robot=plant.robot, model=plant.settings)
    link_forces = how.get("link_forces", False)

    def march(
        states: States, commands: Sequence[Command], share: float, interval: float
    ) -> Marched:
        state, stretch, failure = plant.advance(
            states[0], commands[0], share, interval, link_forces=link_forces
        )
        return [state], [stretch], failure

    (trial,) = run_all(
        [scenario], [plant], march, until=how.get("until"), progress=how.get("progress", silent)
    )
    if how.get("throw") and not trial.succeeded:
        raise SimulationFailed(trial.status)
    return trial


def run_all(
    scenarios: Sequence[Scenario],
    plants: Sequence[Plant[Any]],
    march: March,
    *,
    until: Until | None = None,
    check: Callable[[States], object] = lambda states: None,
    progress: Progress = silent,
) -> list[Trial]:
    """Run plants that advance together under the controllers of their scenarios; see `run`.

    Args:
        scenarios: One for each plant, all with the same duration and sample interval.
        plants: The plants to run.
        march: Like `Plant.advance`, for all plants at once.
        until: Called with the observation of the first plant.
        check: Rejects invalid initial states.
        progress: Called repeatedly with the time reached [s].

    Raises:
        ValueError: If an argument is out of its range, or a controller rejects its robot.
    """
    duration, sample_interval = scenarios[0].duration, scenarios[0].sample_interval
    check_size(duration, sample_interval)
    for one, body in zip(scenarios, plants, strict=True):
        one.controller.check(body.robot)
    swimmers = [
        _Swimmer(plant=body, scenario=one) for body, one in zip(plants, scenarios, strict=True)
    ]
    check([one.state for one in swimmers])
    pace = min(one.controller.interval for one in swimmers)
    failure: str | None = None
    reached, now = 0, 0.0
    for share, count, done in _stretches(duration, sample_interval, pace):
        seen = [one.plant.observe(one.state) for one in swimmers]
        if until is not None and reached and until(seen[0]):
            duration = _cut(duration, pace, reached)
            break
        for one, observation in zip(swimmers, seen):  # noqa: B905 - many times a second
            one.decide(observation, now, pace)
        failure = _march_on(swimmers, march, now, share, count)
        if failure is not None:
            break
        reached, now = reached + 1, done
        progress(done)
    return [one.trial(duration, failure) for one in swimmers]


class _Swimmer:
    """A plant during a run: its state, its controller, and what both have logged.

    Args:
        plant: The plant to run.
        scenario: Its scenario.
    """

    def __init__(self, plant: Plant[Any], scenario: Scenario) -> None:
        self.plant, self.scenario, self.controller = plant, scenario, scenario.controller
        self.state = _begun(plant, scenario.start, scenario.gait)
        self.mind = self.controller.init()
        self.delay = _delay(plant, self.controller, scenario.start)
        # The delay line between controller and joints: when each command takes effect [s]; the
        # first one already has.
        self.line = [(0.0, Command(gait=self.controller.gait))]
        self.log: list[Stretch] = []
        self.signals: list[Mapping[str, float]] = []
        self.counts: list[int] = []  # number of samples after each control instant

    def decide(self, seen: Observation, now: float, pace: float) -> None:
        """Perform one control step; a controller slower than the `pace` of the others keeps its first command."""
        controller, command = self.controller, self.line[-1][1]
        if not self.signals or controller.interval <= pace:
            self.mind, command = controller.step(self.mind, seen)
            check_instance("command", command, Command)
        self.signals.append(controller.signals(self.mind))
        self.counts.append(0)
        self.line.append((now + self.delay, command))
        while len(self.line) > 1 and self.line[1][0] <= now + CLOSE:
            del self.line[0]

    def trial(self, duration: float, failure: str | None) -> Trial:
        """Return the trial of a run of the given duration [s], which may have ended with a failure."""
        log, scenario = self.plant.log(self.log), self.scenario
        self.counts[-1] += (
            1  # a sample at a control instant has its signals, but the very last one those before it
        )
        said = {
            name: np.repeat([one[name] for one in self.signals], self.counts)
            for name in self.signals[0]
        }
        return Trial(
            **vars(replace(log, signals={**said, **log.signals})),
            scenario=scenario
            if duration == scenario.duration
            else replace(scenario, duration=duration),
            version=packaging.__version__,
            status=failure or REACHED_END,
            succeeded=failure is None,
            state=self.plant.pack(self.state) if failure is None else {},
        )


def _march_on(
    swimmers: Sequence[_Swimmer], march: March, now: float, share: float, count: int
) -> str | None:
    """Advance by a stretch of time, split where a command takes effect; return the failure message, if any."""
    interval = share / count
    turns = [due - now for one in swimmers for due, _ in one.line[1:] if due < now + share - CLOSE]
    samples, moments = [], (0.0, share)
    if turns:
        samples = [i * interval for i in range(count + 1)]
        between = {turn for turn in turns if min(abs(turn - sample) for sample in samples) > CLOSE}
        moments = sorted([*samples, *between])
    for begin, end in pairwise(moments):
        acting = [
            [command for due, command in one.line if due - now <= begin + CLOSE][-1]
            for one in swimmers
        ]
        length = end - begin
        states, found, failure = march(
            [one.state for one in swimmers], acting, length, length if turns else interval
        )
        for one, state, stretch in zip(swimmers, states, found):  # noqa: B905
            one.state = state
            one.log.append(stretch if not turns or end in samples else stretch.at(slice(None, -1)))
            one.counts[-1] += len(one.log[-1].samples) - 1
        if failure is not None:
            return failure
    return None


def _delay(plant: Plant[Any], controller: Controller[Any], start: Start | Resumed | None) -> float:
    """Return the delay after which commands take effect [s]."""
    delay = 0.0 if isinstance(controller, OpenLoop) else plant.settings.loop_delay
    if delay and isinstance(start, Resumed):
        rule = (
            "must be 0 to continue from the end of a trial, which does not store delayed commands"
        )
        raise BadArgument("loop_delay", f"{rule}, got {delay:g}")
    return delay


def _begun(plant: Plant[Any], start: Start | Resumed, gait: gaits.Gait) -> Any:
    """Return the plant's initial state: that of a start, or the final state of a trial."""
    if isinstance(start, Resumed):
        return plant.unpack({name: np.array(one) for name, one in start.state.items()})
    return plant.init(start, Command(gait=gait))


def resume(
    plant: Plant[Any],
    trial: Trial,
    duration: float,
    *,
    controller: Controller[Any] | None = None,
    **how: Unpack[Logging],
) -> Trial:
    """Continue from the end of a trial; the rest of an open-loop run is the same as if it had never been interrupted.

    Args:
        plant: The plant of the trial (`laticauda.build_plant` of its scenario).
        trial: A trial that ran to its end.
        duration: Duration of the continuation [s].
        controller: The controller, which starts from its own initial state; None continues with the
            trial's gait.
        how: `link_forces`: log the force on every link as well; `until`: called at every control
            instant, ends the run when it returns True; `throw`: raise an error when the run blows
            up; `progress`: called repeatedly with the time reached [s];
            `sample_interval`: time between two samples of the log [s].

    Returns:
        The trial of the second part; `laticauda.joined` joins the two.

    Raises:
        ValueError: If the trial has no state to continue from, or a state that does not belong to
            this plant.
        SimulationFailed: If the run blows up and `throw` is set.
    """
    steered = getattr(trial.scenario, "motion", None)  # an experiment has none
    if isinstance(steered, Controller):
        _delay(plant, cast("Controller[Any]", steered), Resumed(state={}))
    if not trial.succeeded or not trial.state:
        raise ValueError(
            f"`trial` must have run to its end and hold its final state; its status: {trial.status}"
        )
    if controller is None:
        if trial.gait is None:
            raise BadArgument("controller", "must be given to continue a trial that has no gait")
        controller = OpenLoop(command=Command(gait=trial.gait))
    return run(plant, controller, duration, start=Resumed(state=trial.state), **how)


def _motion(controller: Controller[Any]) -> Motion:
    """Return the gait if the controller only holds one, otherwise the controller."""
    check_instance("controller", controller, Controller)
    held = isinstance(controller, OpenLoop) and controller == OpenLoop(
        command=Command(gait=controller.gait)
    )
    return controller.gait if held else controller


def _cut(duration: float, interval: float, n_reached: int) -> float:
    """Return the shortened duration of a run that ends after `n_reached` control instants [s]."""
    length = duration / max(1, math.ceil(duration / interval - 1e-9))
    cut = length * n_reached
    around = cut, math.nextafter(cut, 0.0), math.nextafter(cut, 2.0 * cut)
    return next((duration for duration in around if duration / n_reached == length), cut)


def _stretches(
    duration: float, sample_interval: float, control_interval: float
) -> Iterator[tuple[float, int, float]]:
    """Split a run at its control instants, and split long stretches so that `progress` is called often enough.

    Yields:
        Length of the stretch [s], samples in it, time reached at its end [s].
    """
    n_stretches = max(1, math.ceil(duration / control_interval - 1e-9))
    length = duration / n_stretches
    n_samples = max(1, round(length / sample_interval))
    for i in range(n_stretches):
        for first in range(0, n_samples, CHUNK):
            count = min(CHUNK, n_samples - first)
            yield length * count / n_samples, count, length * (i + (first + count) / n_samples)


def swim(
    robot: Scenario | Experiment | Robot | str | Path,
    gait: Motion | None = None,
    duration: float = 30.0,
    *,
    link_forces: bool = False,
    throw: bool = False,
    progress: Progress = silent,
    **changes: Unpack[Changes],
) -> Trial:
    """Run a scenario, or simulate a robot that swims a gait, starting straight and at rest.

    Args:
        robot: The scenario, also that of a trial (`Trial.scenario`); or a robot (`load_robot`),
            together with its gait.
        gait: The commanded gait (`lateral_undulation`, `eel_like`, `custom_gait`), or a controller;
            omitted with a scenario.
        duration: With a robot: duration of the run [s].
        link_forces: Whether to log the force on every link as well.
        throw: Whether to raise an error when the run blows up, instead of returning a trial that
            says so.
        progress: Called repeatedly with the time reached [s].
        changes: With a robot: other deviations from the defaults, such as `environment`, `model`,
            `joints` and `dt`; see `laticauda.scenarios.Changes`.

    Returns:
        The trial; a run that blows up also returns one, whose `status` says when it did and what to
        try.

    Raises:
        ValueError: If an argument is out of its range.
        SimulationFailed: If the run blows up and `throw` is set.

    Example:
        >>> import laticauda as lc
        >>> gait = lc.lateral_undulation(amplitude=0.5236, frequency=2.2689, phase_shift=0.6981)
        >>> trial = lc.swim(lc.load_robot("mamba"), gait, duration=30.0)
        >>> round(trial.forward_velocity, 3)
        0.148
    """
    if isinstance(robot, Scenario | Experiment):
        body, chosen = build_plant(robot), cast(Scenario, robot)
    else:
        chosen = build_scenario(robot, cast(Motion, gait), duration, **changes)
        body = build_plant(chosen)
    return run_scenario(chosen, body, link_forces=link_forces, throw=throw, progress=progress)
