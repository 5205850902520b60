"""World of one client: a plant, its state, its command, and the log so far.

Each change creates a new world, so that a rejected request changes nothing; only the log is
extended in place.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, cast

import laticauda as lc
from laticauda.connect.budget import Budget
from laticauda.connect.decoding import change_scenario
from laticauda.connect.history import History
from laticauda.connect.messages import Message
from laticauda.models import simulate
from laticauda.robot import Water
from laticauda.scenarios import check_plausible
from laticauda.sensing import Reading, Senses, senses_of
from laticauda.values import BadArgument, Log, check_positive, check_within

MOST_WORK = 20_000_000
"""Steps times links per request at most: seconds on one core for the planar model [-]."""
WORK_OF_CURRENT_PART = 0.3
"""Work for one part of a current, relative to that for a link [-]."""
LONGEST_DURATION = 36_000.0
"""Duration of a request at most [s]."""
MOMENT = 1e-6
"""Duration of the step by which a command is tried [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class World:
    """State of a client's robot, and its command."""

    scenario: lc.Scenario
    """Robot, environment and model, with the held command as the motion."""
    plant: lc.Plant[Any]
    """Plant built from the scenario, which can be stepped."""
    state: Any
    """State of the plant."""
    log: History
    """Samples since the world was created."""
    budget: Budget
    """Memory limits."""
    senses: Senses | None
    """Sensors of the robot, if it has any; like the log, they go on in place."""
    readings: Mapping[str, Reading]
    """What each sensor told last."""
    broken: str | None = None
    """Why the world cannot be stepped any further; None if it can."""

    @property
    def command(self) -> lc.Command:
        """Held command."""
        return cast(lc.OpenLoop, self.scenario.motion).command


def create_world(scenario: lc.Scenario, budget: Budget) -> World:
    """Create a world at time 0.

    Args:
        scenario: Scenario of the world; its motion is a command.
        budget: Memory limits of the world.

    Raises:
        ValueError: If robot, water and command are incompatible.
    """
    budget.check_current(scenario)
    plant = simulate.build_plant(scenario)
    command = cast(lc.OpenLoop, scenario.motion).command
    state = plant.init(cast(lc.Start, scenario.start), command)
    senses = senses_of(plant.settings, plant.environment)
    world = World(
        scenario=scenario,
        plant=plant,
        state=state,
        log=History(budget.max_logged),
        budget=budget,
        senses=senses,
        readings={},
    )
    log = _try_command(world)
    world.log.append(log.at(slice(1)))
    return replace(world, readings=_read_sensors(world))


def change_world(world: World, message: Message, *, is_tried: bool = True) -> World:
    """Return the world with another command or current, without advancing time.

    Args:
        world: Current world.
        message: Message with any of the fields in `messages.COMMAND_FIELDS`.
        is_tried: Whether to check at once that the plant accepts the command; a step performs this
            check itself.

    Raises:
        BadKey: If a field is out of range; the world then stays unchanged.
        ValueError: If the plant does not accept the command.
    """
    scenario = change_scenario(world.scenario, message)
    if "gait" in message or "current" in message:
        check_plausible(scenario, before=world.scenario)
    plant = world.plant
    state = world.state
    if scenario.environment is not world.scenario.environment:
        world.budget.check_current(scenario)
        plant = simulate.plant_of_scenario(scenario)
        state = plant.unpack(world.plant.pack(state))
    changed_world = replace(world, scenario=scenario, plant=plant, state=state)
    if is_tried:
        _try_command(changed_world)
    return changed_world


def step_world(world: World, duration: float) -> World:
    """Return the world after a given duration.

    Args:
        world: Current world.
        duration: Duration of the step [s].

    Raises:
        ValueError: If the robot's motion diverged earlier, or if the step would take too long.
    """
    if world.broken is not None:
        raise ValueError(f"{world.broken} `reset` starts again.")
    interval = min(world.scenario.sample_interval, duration)
    n_values = check_work(world, duration, interval)
    with world.budget.lock_for(n_values):
        state, log, failure = world.plant.march(world.state, world.command, duration, interval)
        if failure is not None:
            return replace(world, broken=failure)
        world.log.append(log.at(slice(1, None)))
    later = replace(world, state=state)
    return replace(later, readings=_read_sensors(later))


def _read_sensors(world: World) -> Mapping[str, Reading]:
    """Return what each sensor of the robot tells now."""
    if world.senses is None:
        return {}
    return world.senses.read(world.plant.observe_under(world.state, world.command))


def check_work(world: World, duration: float, sample_interval: float) -> int:
    """Return how many values a step would log; reject steps that would take minutes or fill the memory.

    Args:
        world: World to be stepped.
        duration: Duration of the step [s].
        sample_interval: Time between two samples [s].

    Raises:
        ValueError: If the step exceeds a limit.
    """
    positive_duration = check_positive("duration", duration, "s")
    check_within("duration", positive_duration, 0.0, LONGEST_DURATION, "s")
    plant = world.plant
    n_links = plant.robot.n_links
    log_duration = world.log.capacity * sample_interval
    _check_duration(
        duration,
        most=log_duration,
        condition=f"at a `sample_interval` of {sample_interval:g} s for {n_links} links",
    )
    n_parts = 0
    current = ""
    water = plant.environment
    if isinstance(water, Water) and water.flow:
        n_parts = len(water.flow.parts)
        current = f" in a current of {n_parts} parts"
    dt = float(plant.settings.dt)
    work_per_step = n_links * (1.0 + WORK_OF_CURRENT_PART * n_parts)
    _check_duration(
        duration,
        most=MOST_WORK / work_per_step * dt,
        condition=f"in one request for {n_links} links{current} and steps of {dt:g} s",
    )
    return int(duration / sample_interval) * world.log.width


def _check_duration(duration: float, *, most: float, condition: str) -> None:
    if duration > most:
        raise BadArgument("duration", f"must be <= {most:g} s {condition}, got {duration:g}")


def _try_command(world: World) -> Log:
    """Check that the plant accepts the command, before anything changes; return the current sample."""
    _, log, _ = world.plant.march(world.state, world.command, MOMENT, MOMENT)
    return log
