"""One client's world: a plant, its state, what is asked of it, and the log so far.

Each change makes another world, so that a request that is refused changes nothing; only the log is written on.
"""

import threading
from collections import deque
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laticauda.cosim.messages import Message, known
from laticauda.cosim.setup import Setup, read_command, read_current
from laticauda.errors import BadArgument, positive, within
from laticauda.interfaces import Command, Log, OpenLoop, Plant
from laticauda.robot import Water
from laticauda.scenarios import Spatial
from laticauda.simulate import run
from laticauda.trial import Trial

MOST_SAMPLES = 100_000  # of one request, and of a log: about 50 MB for nine links
MOST_WORK = 20_000_000  # steps times links of one request: seconds of a core for the planar model
LONGEST = 36_000.0  # s, of one request
MOMENT = 1e-6  # s

Series = dict[str, np.ndarray]

# MuJoCo's callbacks belong to the whole process, so only one spatial world moves at a time.
_spatial = threading.Lock()


@dataclass(frozen=True, kw_only=True, eq=False)
class World:
    """Where a client's robot is, and what it was told."""

    setup: Setup
    """What it was made from."""
    plant: Plant[Any]
    """The robot in its water as it is now."""
    state: Any
    """The plant's."""
    command: Command
    """What is held."""
    log: "History"
    """Samples since it was made."""
    broken: str | None = None
    """Why it can go no further."""


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
        known("the log", names, self._parts[-1])
        found: Series = {}
        for name in names:
            pieces = [part[name][part["time"] > since] for part in parts]
            found[name] = np.concatenate(pieces) if pieces else self._parts[-1][name][:0]
        return found


def new_world(setup: Setup) -> World:
    """A world at time 0.

    Args:
        setup: What it is made from.

    Raises:
        ValueError: If robot, water and command do not fit together.
    """
    plant, command = setup.plant, setup.command
    with _alone(plant):
        state = plant.init(setup.start, command)
        log = _try(plant, state, command)
    world = World(setup=setup, plant=plant, state=state, command=command, log=History())
    world.log.add(log.at(slice(1)))
    return world


def changed(world: World, message: Message, *, tried: bool = True) -> World:
    """The world with another command or current; no time goes by.

    Args:
        world: As it is.
        message: With any of `setup.HELD`.
        tried: Whether to find out at once if the plant takes the command; a step will find out by itself.

    Raises:
        ValueError: If a field is out of its range; the world is as it was then.
    """
    command = read_command(message, world.command)
    plant, state = world.plant, world.state
    with _alone(plant):
        if message.get("current") is not None:
            water = plant.environment
            if not isinstance(water, Water):
                raise BadArgument("current", f"must be null on the ground, got {message['current']}")
            current = read_current(message["current"])
            if current != water.current:
                body: Any = plant
                moved: Plant[Any] = replace(body, environment=replace(water, current=current))
                plant, state = moved, moved.unpack(plant.pack(state))
        if tried:
            _try(plant, state, command)
    return replace(world, plant=plant, state=state, command=command)


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
    interval = min(world.setup.sample_interval, duration)
    check_work(world.plant, duration, interval)
    with _alone(world.plant):
        state, log, failure = world.plant.march(world.state, world.command, duration, interval)
    if failure is not None:
        return replace(world, broken=failure)
    world.log.add(log.at(slice(1, None)))
    return replace(world, state=state)


def whole_run(setup: Setup, duration: float) -> Trial:
    """A run from start to end under one command, in a world of its own.

    Args:
        setup: What it is made from.
        duration: [s].

    Raises:
        ValueError: If something is out of its range.
    """
    plant = setup.plant
    check_work(plant, duration, setup.sample_interval)
    with _alone(plant):
        return run(
            plant,
            OpenLoop(command=setup.command),
            duration,
            start=setup.start,
            sample_interval=setup.sample_interval,
        )


def check_work(plant: Plant[Any], duration: float, sample_interval: float) -> None:
    """Refuse what would keep a core busy for minutes, or fill the memory.

    Args:
        plant: What is to be stepped.
        duration: How long [s].
        sample_interval: Between two samples [s].

    Raises:
        ValueError: If so.
    """
    within("duration", positive("duration", duration, "s"), 0.0, LONGEST, "s")
    if duration / sample_interval > MOST_SAMPLES:
        raise BadArgument(
            "duration",
            f"must be <= {MOST_SAMPLES * sample_interval:g} s at a `sample_interval` of "
            f"{sample_interval:g} s, got {duration:g}",
        )
    dt = float(plant.settings.dt)
    most = MOST_WORK / plant.robot.n_links * dt
    if duration > most:
        raise BadArgument(
            "duration",
            f"must be <= {most:g} s in one request for {plant.robot.n_links} links and steps of "
            f"{dt:g} s, got {duration:g}",
        )


def _try(plant: Plant[Any], state: Any, command: Command) -> Log:
    """Refuse a command that the plant would refuse later, while nothing has changed yet; the sample of now."""
    return plant.march(state, command, MOMENT, MOMENT)[1]


def _alone(plant: Plant[Any]) -> AbstractContextManager[Any]:
    return _spatial if isinstance(plant.settings, Spatial) else nullcontext()
