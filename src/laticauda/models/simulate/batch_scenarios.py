"""The scenarios and runs of a batch, from arguments given once for all trials, or once for each."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple, TypeVar, Unpack, cast

from laticauda.models.planar.batch import Run
from laticauda.models.planar.model import PlanarPlant
from laticauda.models.simulate.plants import plant_of_scenario
from laticauda.motion.gaits import Gait
from laticauda.robot import Environment, Ground, Robot, Water, load_robot
from laticauda.scenarios import (
    Command,
    Controller,
    ModelChanges,
    OpenLoop,
    Planar,
    Scenario,
    Start,
    build_scenario,
    default_water,
)
from laticauda.values import BadArgument, check_instance, check_not_empty, make_quickly

Item = TypeVar("Item")

NOT_OF_BATCHES = {
    "environment": "`environments`, one for all trials or one for each",
    "start": "`starts`, one for all trials or one for each",
    "current": "`environments` with that current",
    "parameters": "`environments` and `joints`, or scenarios in place of robots",
}
"""Arguments of `swim` that a batch has not, and what it has instead."""


def scenarios_of_batch(
    robots: Sequence[Scenario] | Robot | Sequence[Robot] | str | Path,
    gaits: Gait | Sequence[Gait] | None,
    *,
    environments: Environment | Sequence[Environment] | None = None,
    starts: Start | Sequence[Start] | None = None,
    duration: float = 30.0,
    sample_interval: float = 0.05,
    **changes: Unpack[ModelChanges],
) -> Sequence[Scenario]:
    """Return the scenarios of a batch; arguments as for `swim_many`."""
    for name, instead in NOT_OF_BATCHES.items():
        if name in changes:
            raise TypeError(f"There is no argument `{name}` for many trials: give {instead}.")
    if isinstance(robots, str | Path):
        robots = load_robot(robots)
    if gaits is None:
        scenarios = cast("Sequence[Scenario]", check_instance("robots", robots, Sequence))
        return _one_per_trial("robots", scenarios, 0, Scenario)
    arguments = {"robots": robots, "gaits": gaits, "environments": environments, "starts": starts}
    n_trials = _common_length(arguments)
    robot_or_robots = cast("Robot | Sequence[Robot]", robots)
    robot_per_trial = _one_per_trial("robots", robot_or_robots, n_trials, Robot)
    gait_per_trial = _one_per_trial("gaits", gaits, n_trials, Gait)
    if starts is None:
        starts = Start()
    start_per_trial = _one_per_trial("starts", starts, n_trials, Start)
    environment_per_trial: Sequence[Environment]
    if environments is None:
        environment_per_trial = _default_waters(robot_per_trial, gait_per_trial)
    else:
        environment_per_trial = _one_per_trial(
            "environments", environments, n_trials, Water, Ground
        )
    first = build_scenario(
        robot_per_trial[0],
        gait_per_trial[0],
        duration,
        sample_interval=sample_interval,
        **changes,
    )
    return [
        _scenario_like(first, robot=robot, motion=gait, environment=environment, start=start)
        for robot, gait, environment, start in zip(
            robot_per_trial, gait_per_trial, environment_per_trial, start_per_trial, strict=True
        )
    ]


def _scenario_like(
    first: Scenario, *, robot: Robot, motion: Gait, environment: Environment, start: Start
) -> Scenario:
    """Return a scenario that differs from the first one of a batch in parts whose classes are checked."""
    if isinstance(first.model, Planar):
        # Nothing is left to check, which would take longer than all else that a trial needs in Python.
        return make_quickly(
            Scenario,
            robot=robot,
            motion=motion,
            environment=environment,
            model=first.model,
            start=start,
            duration=first.duration,
            sample_interval=first.sample_interval,
        )
    return replace(first, robot=robot, motion=motion, environment=environment, start=start)


def _default_waters(robots: Sequence[Robot], gaits: Sequence[Gait]) -> list[Environment]:
    """Return the default water of every trial, asked for once per robot and kind of envelope."""
    waters: dict[tuple[int, type], Environment] = {}
    water_per_trial: list[Environment] = []
    for robot, gait in zip(robots, gaits, strict=True):
        key = id(robot), type(gait.envelope)
        if key not in waters:
            waters[key] = default_water(robot, gait)
        water_per_trial.append(waters[key])
    return water_per_trial


class _PlantKey(NamedTuple):
    """The objects, not their values, that make a plant; the scenarios keep them alive."""

    robot: int
    """`id` of the robot."""
    environment: int
    """`id` of the environment."""
    model: int
    """`id` of the model."""

    @classmethod
    def of(cls, scenario: Scenario) -> "_PlantKey":
        return cls(
            robot=id(scenario.robot),
            environment=id(scenario.environment),
            model=id(scenario.model),
        )


def runs_of(scenarios: Sequence[Scenario], *, steered: bool = False) -> list[Run]:
    """Return the runs of a batch, with one plant for all that share robot, environment and model.

    Scenarios share these if they hold the same objects; equal ones are not looked for.

    Args:
        scenarios: Planar scenarios with the same duration and sample interval.
        steered: Whether they may have controllers that steer.

    Raises:
        ValueError: If they are not planar, or differ in these.
    """
    check_not_empty("scenarios", scenarios, "item")
    plants: dict[_PlantKey, PlanarPlant] = {}
    runs: list[Run] = []
    for i, scenario in enumerate(scenarios):
        key = _PlantKey.of(scenario)
        if key not in plants:
            check_instance(f"scenarios[{i}].model", scenario.model, Planar)
            plants[key] = cast(PlanarPlant, plant_of_scenario(scenario))
        _check_same_sampling(scenario, scenarios[0])
        start = cast(Start, check_instance(f"scenarios[{i}].start", scenario.start, Start))
        plant = plants[key]
        motion = scenario.motion
        if steered and isinstance(motion, Controller) and not isinstance(motion, OpenLoop):
            _check_controller(motion, plant, i)
            command = Command(gait=motion.gait)
            runs.append(Run(plant=plant, command=command, start=start, controller=motion))
        else:
            runs.append(Run(plant=plant, command=_command_of(scenario, i), start=start))
    return runs


def _check_controller(controller: Controller[Any], plant: PlanarPlant, i: int) -> None:
    """Reject a controller of scenario `i` that may command what its robot cannot do."""
    try:
        controller.check(plant.robot)
    except BadArgument as error:
        raise BadArgument(f"scenarios[{i}].motion.{error.name}", error.rule) from error


def _check_same_sampling(scenario: Scenario, first: Scenario) -> None:
    """Reject a scenario whose duration or sample interval differs from the first one's."""
    for name in ("duration", "sample_interval"):
        value = getattr(scenario, name)
        if value != getattr(first, name):
            raise BadArgument(name, f"must be the same in all scenarios, also got {value:g} s")


def _command_of(scenario: Scenario, i: int) -> Command:
    """Return the command that scenario `i` holds throughout, of a gait or of references."""
    motion = check_instance(f"scenarios[{i}].motion", scenario.motion, Gait, OpenLoop)
    if isinstance(motion, OpenLoop):
        return motion.command
    return Command(gait=scenario.gait)


def _common_length(arguments: Mapping[str, object]) -> int:
    """Return the number of trials that the sequences among the arguments state."""
    lengths: dict[str, int] = {}
    for name, value in arguments.items():
        if isinstance(value, Sequence):
            lengths[name] = len(cast(Sequence[object], value))
    if len(set(lengths.values())) > 1:
        names = "`, `".join(lengths)
        counts = ", ".join(f"{length} {name}" for name, length in lengths.items())
        raise ValueError(f"`{names}` must be of equal length, got {counts}.")
    return next(iter(lengths.values()), 1)


def _one_per_trial(
    name: str, argument: Item | Sequence[Item], n_trials: int, *classes: type
) -> Sequence[Item]:
    """Return an argument once per trial, after checking its class."""
    if not isinstance(argument, Sequence):
        check_instance(name, argument, *classes)
        return [argument] * n_trials
    items = cast("Sequence[Item]", argument)
    check_not_empty(name, items, "item")
    for i, item in enumerate(items):
        check_instance(f"{name}[{i}]", item, *classes)
    return items
