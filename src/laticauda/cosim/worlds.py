"""One client's world: a plant, its state, what is asked of it, and the log so far.

Each change makes another world, so that a request that is refused changes nothing; only the log is written on.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

import laticauda as lc
from laticauda.cosim.messages import Message, commanded
from laticauda.errors import BadArgument, one_of, positive, within
from laticauda.series import Log
from laticauda.simulate import plant

MOST_SAMPLES = 100_000  # of one request, and of a log: about 50 MB for nine links
MOST_WORK = 20_000_000  # steps times links of one request: seconds of a core for the planar model
PART = 0.3  # work for one part of a current, by that for a link
LONGEST = 36_000.0  # s, of one request
MOMENT = 1e-6  # s

Series = dict[str, np.ndarray]


@dataclass(frozen=True, kw_only=True, eq=False)
class World:
    """Where a client's robot is, and what it was told."""

    scenario: lc.Scenario
    """What swims, where, by which model, and as its motion the command that is held."""
    plant: lc.Plant[Any]
    """The same as something that can be stepped."""
    state: Any
    """The plant's."""
    log: "History"
    """Samples since it was made."""
    broken: str | None = None
    """Why it can go no further."""

    @property
    def command(self) -> lc.Command:
        """What is held."""
        return cast(lc.OpenLoop, self.scenario.motion).command


class History:
    """Samples in pieces, the oldest thrown away where there are too many."""

    def __init__(self) -> None:
        self.dropped = 0
        """Samples that were thrown away [-]."""
        self._parts: deque[Series] = deque()
        self._count = 0

    def add(self, part: Log) -> None:
        """Keep `part`."""
        self._parts.append({name: np.array(values) for name, values in part.series().items()})
        self._count += part.time.size
        while self._count > MOST_SAMPLES and len(self._parts) > 1:
            lost = self._parts.popleft()["time"].size
            self._count -= lost
            self.dropped += lost

    @property
    def last(self) -> Series:
        """The last sample of every quantity."""
        return {name: values[-1] for name, values in self._parts[-1].items()}

    def series(self, names: Sequence[str], since: float) -> Series:
        """The quantities of these names after a moment.

        Args:
            names: As in `Log.series`.
            since: Later samples only [s].

        Raises:
            ValueError: If there is no quantity of a name.
        """
        parts = [part for part in self._parts if part["time"][-1] > since]
        found: Series = {}
        for name in names:
            one_of("series", name, tuple(self._parts[-1]))
            pieces = [part[name][part["time"] > since] for part in parts]
            found[name] = np.concatenate(pieces) if pieces else self._parts[-1][name][:0]
        return found


def new_world(scenario: lc.Scenario) -> World:
    """A world at time 0.

    Args:
        scenario: What it is made from; its motion is a command.

    Raises:
        ValueError: If robot, water and command do not fit together.
    """
    body = plant(scenario)
    world = World(scenario=scenario, plant=body, state=None, log=History())
    world = replace(world, state=body.init(cast(lc.Start, scenario.start), world.command))
    world.log.add(_try(world).at(slice(1)))
    return world


def changed(world: World, message: Message, *, tried: bool = True) -> World:
    """The world with another command or current; no time goes by.

    Args:
        world: As it is.
        message: With any of `requests.HELD`.
        tried: Whether to find out at once if the plant takes the command; a step will find out by itself.

    Raises:
        BadKey: If a field is out of its range; the world is as it was then.
        ValueError: If the plant does not take the command.
    """
    scenario, body, state = commanded(world.scenario, message), world.plant, world.state
    if scenario.environment is not world.scenario.environment:
        body = plant(scenario)
        state = body.unpack(world.plant.pack(state))
    world = replace(world, scenario=scenario, plant=body, state=state)
    if tried:
        _try(world)
    return world


def stepped(world: World, duration: float) -> World:
    """The world some time later.

    Args:
        world: As it is.
        duration: How much later [s].

    Raises:
        ValueError: If the robot's motion diverged, now or earlier, or it would take too long.
    """
    if world.broken is not None:
        raise ValueError(f"{world.broken} `reset` begins anew.")
    interval = min(world.scenario.sample_interval, duration)
    check_work(world.plant, duration, interval)
    state, log, failure = world.plant.march(world.state, world.command, duration, interval)
    if failure is not None:
        return replace(world, broken=failure)
    world.log.add(log.at(slice(1, None)))
    return replace(world, state=state)


def check_work(plant: lc.Plant[Any], duration: float, sample_interval: float) -> None:
    """Refuse what would keep a core busy for minutes, or fill the memory.

    Args:
        plant: What is to be stepped.
        duration: How long [s].
        sample_interval: Between two samples [s].

    Raises:
        ValueError: If so.
    """
    within("duration", positive("duration", duration, "s"), 0.0, LONGEST, "s")
    dt, n, water = float(plant.settings.dt), plant.robot.n_links, plant.environment
    parts = len(water.flow.parts) if isinstance(water, lc.Water) and water.flow else 0
    among = f" in a current of {parts} parts" if parts else ""
    for most, where in (
        (MOST_SAMPLES * sample_interval, f"at a `sample_interval` of {sample_interval:g} s"),
        (MOST_WORK / (n * (1.0 + PART * parts)) * dt, f"in one request for {n} links{among} and steps of {dt:g} s"),
    ):
        if duration > most:
            raise BadArgument("duration", f"must be <= {most:g} s {where}, got {duration:g}")


def _try(world: World) -> Log:
    """Refuse a command that the plant would refuse later, while nothing has changed yet; the sample of now."""
    return world.plant.march(world.state, world.command, MOMENT, MOMENT)[1]
