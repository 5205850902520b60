"""Simulation of plants over time, with their logs.

`timeline` splits a run into spans and legs with one command each.
`run_all` is the loop; `run`, `run_scenario`, `resume` and `swim` lead to it.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple, TypedDict, Unpack, cast

import numpy as np

from laticauda.models.dynamics.plant import Plant
from laticauda.models.dynamics.sampled_loads import SampledLoads, join_loads
from laticauda.models.dynamics.samples import Stretch, check_size, join_samples
from laticauda.models.simulate.plants import build_plant
from laticauda.models.simulate.timeline import (
    CommandQueue,
    Span,
    cut_duration,
    split_run,
    split_span,
)
from laticauda.motion import gaits
from laticauda.robot import Robot
from laticauda.scenarios import (
    Command,
    Controller,
    Experiment,
    Motion,
    Observation,
    OpenLoop,
    Resumed,
    Scenario,
    Start,
    SwimChanges,
    build_scenario,
    decide,
    warn_of_speed,
)
from laticauda.sensing import senses_of, signals_of_readings
from laticauda.trials import REACHED_END, Trial
from laticauda.trials.feasibility import exceeds_actuators
from laticauda.values import (
    BadArgument,
    InfeasibleWarning,
    SimulationFailed,
    check_instance,
    packaging,
)

Progress = Callable[[float], None]
"""Receives how far the computation has come."""
Until = Callable[[Observation], bool]
"""Decides at a control instant whether a run ends there."""
States = Sequence[Any]
"""States of all plants of a run."""
Marched = tuple[States, Sequence[Stretch], str | None]
"""States of all plants after a stretch of time, the resulting stretches of log, and a failure message, if any."""
March = Callable[[States, Sequence[Command], float, float], Marched]
"""Like `Plant.advance`, for all plants at once: states, commands, length [s], sample interval [s]."""


def silent(*_: object) -> None:
    """Do nothing; the default callback."""


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
        link_forces: Whether to log the force on every link, and what every joint carries, as well.
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


def _motion(controller: Controller[Any]) -> Motion:
    """Return the gait if the controller only holds one, otherwise the controller."""
    check_instance("controller", controller, Controller)
    if not isinstance(controller, OpenLoop):
        return controller
    if controller == OpenLoop(command=Command(gait=controller.gait)):
        return controller.gait
    return controller


def run_scenario(scenario: Scenario, plant: Plant[Any], **how: Unpack[Watching]) -> Trial:
    """Run a scenario on its plant; errors as for `run`.

    Args:
        scenario: Everything that determines the run.
        plant: The plant made from the scenario.
        how: `link_forces`: log the forces on links and in joints as well; `until`: called at every control
            instant, ends the run when it returns True; `throw`: raise an error when the run blows
            up; `progress`: called repeatedly with the time reached [s].
    """
    # Record the robot that actually swims, such as its planar form, and what the scenario leaves
    # open, such as dt.
    scenario = replace(scenario, robot=plant.robot, model=plant.settings)
    link_forces = how.get("link_forces", False)

    def march(
        states: States, commands: Sequence[Command], length: float, sample_interval: float
    ) -> Marched:
        state, stretch, failure = plant.advance(
            states[0], commands[0], length, sample_interval, link_forces=link_forces
        )
        return [state], [stretch], failure

    trials = run_all(
        [scenario],
        [plant],
        march,
        until=how.get("until"),
        progress=how.get("progress", silent),
    )
    trial = trials[0]
    if how.get("throw") and not trial.succeeded:
        raise SimulationFailed(trial.status)
    return trial


def run_all(
    scenarios: Sequence[Scenario],
    plants: Sequence[Plant[Any]],
    march: March,
    *,
    until: Until | None = None,
    check: Callable[[States], object] = silent,
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
    finished = _run_swimmers(scenarios, plants, march, until=until, check=check, progress=progress)
    return [swimmer.trial(finished.duration, finished.failure) for swimmer in finished.swimmers]


class RawLog(NamedTuple):
    """The samples of a run as the kernels wrote them."""

    samples: np.ndarray
    """The samples, up to the failure if the run diverged; the first axis is time."""
    loads: SampledLoads | None
    """Loads at the samples, if they were requested and the run reached its end."""


def run_samples(scenario: Scenario, plant: Plant[Any], *, link_forces: bool = False) -> RawLog:
    """Run a scenario on its plant, and return the raw samples of its log.

    Args:
        scenario: Everything that determines the run.
        plant: The plant made from the scenario.
        link_forces: Whether to keep the force on every link, and what every joint carries, too.
    """

    def march(
        states: States, commands: Sequence[Command], length: float, sample_interval: float
    ) -> Marched:
        state, stretch, failure = plant.advance(
            states[0], commands[0], length, sample_interval, link_forces=link_forces
        )
        return [state], [stretch], failure

    finished = _run_swimmers([scenario], [plant], march)
    stretches = finished.swimmers[0].stretches
    return RawLog(join_samples(stretches), join_loads(stretch.loads for stretch in stretches))


class _Finished(NamedTuple):
    """Swimmers after a run."""

    swimmers: "list[_Swimmer]"
    """The swimmers, with their logs."""
    duration: float
    """Duration of the run, shorter than that of the scenarios if it was cut [s]."""
    failure: str | None
    """What went wrong, in a sentence; None if nothing did."""


def _run_swimmers(
    scenarios: Sequence[Scenario],
    plants: Sequence[Plant[Any]],
    march: March,
    *,
    until: Until | None = None,
    check: Callable[[States], object] = silent,
    progress: Progress = silent,
) -> _Finished:
    """Run plants that advance together; arguments as for `run_all`."""
    duration = scenarios[0].duration
    sample_interval = scenarios[0].sample_interval
    check_size(duration, sample_interval)
    for scenario, plant in zip(scenarios, plants, strict=True):
        scenario.controller.check(plant.robot)
    swimmers = [
        _Swimmer(plant=plant, scenario=scenario)
        for plant, scenario in zip(plants, scenarios, strict=True)
    ]
    check([swimmer.state for swimmer in swimmers])
    control_interval = min(swimmer.controller.interval for swimmer in swimmers)
    failure: str | None = None
    n_instants = 0
    now = 0.0
    for span in split_run(duration, sample_interval, control_interval):
        if span.begins_at_control_instant:
            observations = [swimmer.observe() for swimmer in swimmers]
            if until is not None and n_instants and until(observations[0]):
                duration = cut_duration(duration, control_interval, n_instants)
                break
            for swimmer, observation in zip(swimmers, observations):  # noqa: B905 - many times a second
                swimmer.decide(observation, now, control_interval)
            n_instants += 1
        failure = _advance(swimmers, march, now, span)
        if failure is not None:
            break
        now = span.end
        progress(now)
    return _Finished(swimmers, duration, failure)


# ---- one robot of a run --------------------------------------------------------------------------


class _Swimmer:
    """A plant during a run: its state, its controller, and what both have logged.

    Args:
        plant: The plant to run.
        scenario: Its scenario.
    """

    def __init__(self, plant: Plant[Any], scenario: Scenario) -> None:
        self.plant = plant
        self.scenario = scenario
        self.controller = scenario.controller
        self.state = _initial_state(plant, scenario.start, scenario.gait)
        self.senses = senses_of(plant.settings, plant.environment)
        self.controller_state = self.controller.init()
        self.commands = CommandQueue[Command](
            Command(gait=self.controller.gait),
            delay=_delay(plant, self.controller, scenario.start),
        )
        self.last_command = self.commands.latest
        """The command that acted until now."""
        self.stretches: list[Stretch] = []
        self.signals: list[Mapping[str, float]] = []
        """Signals of the controller at every control instant."""
        self.n_samples: list[int] = []
        """Number of samples after each control instant."""

    def observe(self) -> Observation:
        """Return what the controller sees now, with what the sensors tell."""
        observation = self.plant.observe_under(self.state, self.last_command)
        if self.senses is None:
            return observation
        return observation.with_readings(self.senses.read(observation))

    def decide(self, observation: Observation, now: float, control_interval: float) -> None:
        """Perform one control step at a control instant of the run.

        A controller slower than the fastest one in the run keeps its first command.
        """
        command = self.commands.latest
        if not self.signals or self.controller.interval <= control_interval:
            self.controller_state, command = decide(
                self.controller, self.controller_state, observation
            )
        signals = self.controller.signals(self.controller_state)
        if self.senses is not None:
            sensors = self.plant.settings.sensors
            signals = {**signals, **signals_of_readings(sensors, observation.readings)}
        self.signals.append(signals)
        self.n_samples.append(0)
        self.commands.add(now, command)

    def log(self, stretch: Stretch) -> None:
        """Keep the samples of a stretch, whose first one the stretch before has, too."""
        self.stretches.append(stretch)
        self.n_samples[-1] += len(stretch.samples) - 1

    def trial(self, duration: float, failure: str | None) -> Trial:
        """Return the trial of a run of the given duration [s], which may have ended with a failure."""
        log = self.plant.log(self.stretches)
        scenario = self.scenario
        if duration != scenario.duration:
            scenario = replace(scenario, duration=duration)
        series = replace(log, signals={**self._sampled_signals(), **log.signals})
        return Trial(
            **vars(series),
            scenario=scenario,
            version=packaging.__version__,
            status=failure or REACHED_END,
            succeeded=failure is None,
            state=self.plant.pack(self.state) if failure is None else {},
        )

    def _sampled_signals(self) -> dict[str, np.ndarray]:
        """Return the signals of the controller at every sample.

        A sample at a control instant has the signals of that instant, but the very last one those
        before it.
        """
        n_samples = [*self.n_samples[:-1], self.n_samples[-1] + 1]
        series: dict[str, np.ndarray] = {}
        for name in self.signals[0]:
            values = [signals[name] for signals in self.signals]
            series[name] = np.repeat(values, n_samples)
        return series


def _delay(plant: Plant[Any], controller: Controller[Any], start: Start | Resumed | None) -> float:
    """Return the delay after which commands take effect [s]."""
    if isinstance(controller, OpenLoop):
        return 0.0
    delay = plant.settings.loop_delay
    if delay and isinstance(start, Resumed):
        rule = (
            "must be 0 to continue from the end of a trial, which does not store delayed commands"
        )
        raise BadArgument("loop_delay", f"{rule}, got {delay:g}")
    return delay


def _initial_state(plant: Plant[Any], start: Start | Resumed, gait: gaits.Gait) -> Any:
    """Return the plant's initial state: that of a start, or the final state of a trial."""
    if isinstance(start, Resumed):
        return plant.unpack({name: np.array(values) for name, values in start.state.items()})
    return plant.init(start, Command(gait=gait))


def _advance(swimmers: Sequence[_Swimmer], march: March, now: float, span: Span) -> str | None:
    """Advance by a span, leg by leg; return the failure message, if any."""
    queues = [swimmer.commands for swimmer in swimmers]
    for leg in split_span(queues, now, span):
        for swimmer in swimmers:
            swimmer.last_command = swimmer.commands.acting(now, leg.begin)
        states, stretches, failure = march(
            [swimmer.state for swimmer in swimmers],
            [swimmer.last_command for swimmer in swimmers],
            leg.end - leg.begin,
            leg.sample_interval,
        )
        for swimmer, state, stretch in zip(swimmers, states, stretches):  # noqa: B905
            swimmer.state = state
            if not leg.ends_at_sample:
                stretch = stretch.at(slice(None, -1))
            swimmer.log(stretch)
        if failure is not None:
            return failure
    return None


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
        how: `link_forces`: log the forces on links and in joints as well; `until`: called at every control
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
    motion = getattr(trial.scenario, "motion", None)  # an experiment has none
    if isinstance(motion, Controller):
        _delay(plant, cast("Controller[Any]", motion), Resumed(state={}))
    if not trial.succeeded or not trial.state:
        raise ValueError(
            f"`trial` must have run to its end and hold its final state; its status: {trial.status}"
        )
    if controller is None:
        if trial.gait is None:
            raise BadArgument("controller", "must be given to continue a trial that has no gait")
        controller = OpenLoop(command=Command(gait=trial.gait))
    return run(plant, controller, duration, start=Resumed(state=trial.state), **how)


def swim(
    robot: Scenario | Experiment | Robot | str | Path,
    gait: Motion | str | None = None,
    duration: float = 30.0,
    *,
    link_forces: bool = False,
    throw: bool = False,
    progress: Progress = silent,
    **changes: Unpack[SwimChanges],
) -> Trial:
    """Run a scenario, or simulate a robot that swims a gait, starting straight and at rest.

    Args:
        robot: The scenario, also that of a trial (`Trial.scenario`); or a robot (`load_robot`),
            together with its gait.
        gait: The commanded gait (`lateral_undulation`, `eel_like`, `custom_gait`), the name of its
            kind with its numbers among the changes, or a controller; omitted with a scenario.
        duration: With a robot: duration of the run [s].
        link_forces: Whether to log the force on every link, and what every joint carries, as well.
        throw: Whether to raise an error when the run blows up, instead of returning a trial that
            says so.
        progress: Called repeatedly with the time reached [s].
        changes: With a robot: the numbers of a gait that is given by name, such as
            `amplitude_deg=30`, and other deviations from the defaults. `parameters`, a set of
            numbers (name, path or value) for water, robot and joints; or `environment`, the water or ground;
            `current` of the water [m/s]; `joints` ("prescribed", "pd", "servo" or a joint law);
            `start`; `sample_interval` [s]; `dt`, the time step [s]; `offset_bandwidth` [rad/s] and
            `loop_delay` [s] of the steering; `ramp`, how long the gait fades in [s]. `model`,
            "planar" or "spatial"; of the latter `root`, `gravity`, `ballast_depth` [m], `scene` and
            `rays`. See `laticauda.scenarios.Changes`.

    Warns:
        ImplausibleWarning: If something hardly is as it is described, such as a robot that sinks,
            or if the robot swims many times its length per second.
        InfeasibleWarning: If the run demands more of a joint than the robot offers.

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
        plant = build_plant(robot)  # rejects an experiment
        scenario = cast(Scenario, robot)
    else:
        scenario = build_scenario(robot, cast(Motion, gait), duration, **changes)
        plant = build_plant(scenario)
    trial = run_scenario(scenario, plant, link_forces=link_forces, throw=throw, progress=progress)
    _warn_if_infeasible(trial)
    if trial.succeeded:
        warn_of_speed(trial.robot, trial.forward_velocity, trial.environment)
    return trial


def _warn_if_infeasible(trial: Trial) -> None:
    """Warn if the robot cannot do what a run demands."""
    if not trial.succeeded or not exceeds_actuators(trial.chain, trial, trial.period):
        return
    # The text is the same for all gaits of a robot, so that a study of many gaits shows it once.
    warnings.warn(
        f"{trial.robot.name} cannot do this: see `trial.feasibility.problems`. The figures hold for joints that "
        'follow the gait exactly; joints="servo" lets them lag.',
        InfeasibleWarning,
        stacklevel=4,  # the caller of `swim`, whose arguments are checked by a wrapper
    )
