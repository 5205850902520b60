"""Session of one client: one answer line per request line, and the client's world; independent of sockets.

A world is a plant, its state, its command, and the log so far. Each change creates a new world, so
that a rejected request changes nothing; only the log is extended in place.
"""

import dataclasses
import sys
import traceback
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

import laticauda as lc
from laticauda import scenarios
from laticauda.connect import messages
from laticauda.connect.budget import Budget
from laticauda.connect.messages import Message
from laticauda.models import simulate
from laticauda.robot import Current, Robot, Water
from laticauda.values import codec, packaging, series
from laticauda.values.checks import check_choice, check_finite, check_positive, check_within
from laticauda.values.errors import BadArgument, LaticaudaError

MOST_SAMPLES = 100_000  # per request, and in a log
MOST_WORK = 20_000_000  # steps times links per request: seconds on one core for the planar model
PART = 0.3  # work for one part of a current, relative to that for a link
LONGEST = 36_000.0  # s, per request
MOMENT = 1e-6  # s

Series = dict[str, np.ndarray]


@dataclass(frozen=True, kw_only=True, eq=False)
class World:
    """State of a client's robot, and its command."""

    scenario: lc.Scenario
    """Robot, environment and model, with the held command as the motion."""
    plant: lc.Plant[Any]
    """Plant built from the scenario, which can be stepped."""
    state: Any
    """State of the plant."""
    log: "History"
    """Samples since the world was created."""
    budget: Budget
    """Memory limits."""
    broken: str | None = None
    """Why the world cannot be stepped any further; None if it can."""

    @property
    def command(self) -> lc.Command:
        """Held command."""
        return cast(lc.OpenLoop, self.scenario.motion).command


class History:
    """Log of samples in pieces, of which the oldest are discarded if there are too many.

    Args:
        most: Maximum number of values kept [-].
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self.dropped = 0
        """Number of discarded samples [-]."""
        self._parts: deque[Series] = deque()
        self._count = 0

    def add(self, part: series.Log) -> None:
        """Append `part`, and discard the oldest pieces if necessary."""
        self._parts.append({name: np.array(values) for name, values in part.series().items()})
        self._count += part.time.size
        while self._count > self.capacity and len(self._parts) > 1:
            lost = self._parts.popleft()["time"].size
            self._count -= lost
            self.dropped += lost

    @property
    def width(self) -> int:
        """Number of values in a sample [-]."""
        return sum(values.size for values in self.last.values())

    @property
    def capacity(self) -> int:
        """Maximum number of samples kept [-]."""
        return min(MOST_SAMPLES, self._most // self.width)

    @property
    def last(self) -> Series:
        """Last sample of every quantity."""
        return {name: values[-1] for name, values in self._parts[-1].items()}

    def series(self, names: Sequence[str], since: float) -> Series:
        """Return the named quantities after a given time.

        Args:
            names: Names of quantities of a sample (`Log`).
            since: Time after which samples are returned [s].

        Raises:
            ValueError: If there is no quantity with one of the names.
        """
        parts = [part for part in self._parts if part["time"][-1] > since]
        found: Series = {}
        for name in names:
            check_choice("series", name, tuple(self._parts[-1]))
            pieces = [part[name][part["time"] > since] for part in parts]
            found[name] = np.concatenate(pieces) if pieces else self._parts[-1][name][:0]
        return found


def new_world(scenario: lc.Scenario, budget: Budget) -> World:
    """Create a world at time 0.

    Args:
        scenario: Scenario of the world; its motion is a command.
        budget: Memory limits of the world.

    Raises:
        ValueError: If robot, water and command are incompatible.
    """
    budget.check_kind(scenario)
    body = simulate.build_plant(scenario)
    world = World(
        scenario=scenario, plant=body, state=None, log=History(budget.logged), budget=budget
    )
    world = replace(world, state=body.init(cast(lc.Start, scenario.start), world.command))
    world.log.add(_try(world).at(slice(1)))
    return world


def change_world(world: World, message: Message, *, tried: bool = True) -> World:
    """Return the world with another command or current, without advancing time.

    Args:
        world: Current world.
        message: Message with any of the fields in `messages.HELD`.
        tried: Whether to check at once that the plant accepts the command; a step performs this
            check itself.

    Raises:
        BadKey: If a field is out of range; the world then stays unchanged.
        ValueError: If the plant does not accept the command.
    """
    scenario, body, state = messages.commanded(world.scenario, message), world.plant, world.state
    if scenario.environment is not world.scenario.environment:
        world.budget.check_kind(scenario)
        body = simulate.build_plant(scenario)
        state = body.unpack(world.plant.pack(state))
    world = replace(world, scenario=scenario, plant=body, state=state)
    if tried:
        _try(world)
    return world


def stepped(world: World, duration: float) -> World:
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
    with world.budget.turn_for(check_work(world, duration, interval)):
        state, log, failure = world.plant.march(world.state, world.command, duration, interval)
        if failure is not None:
            return replace(world, broken=failure)
        world.log.add(log.at(slice(1, None)))
    return replace(world, state=state)


def check_work(world: World, duration: float, sample_interval: float) -> int:
    """Return how many values a step would log; reject steps that would take minutes or fill the memory.

    Args:
        world: World to be stepped.
        duration: Duration of the step [s].
        sample_interval: Time between two samples [s].

    Raises:
        ValueError: If the step exceeds a limit.
    """
    check_within("duration", check_positive("duration", duration, "s"), 0.0, LONGEST, "s")
    plant = world.plant
    dt, n, water = float(plant.settings.dt), plant.robot.n_links, plant.environment
    parts = len(water.flow.parts) if isinstance(water, Water) and water.flow else 0
    among = f" in a current of {parts} parts" if parts else ""
    for most, where in (
        (
            world.log.capacity * sample_interval,
            f"at a `sample_interval` of {sample_interval:g} s for {n} links",
        ),
        (
            MOST_WORK / (n * (1.0 + PART * parts)) * dt,
            f"in one request for {n} links{among} and steps of {dt:g} s",
        ),
    ):
        if duration > most:
            raise BadArgument("duration", f"must be <= {most:g} s {where}, got {duration:g}")
    return int(duration / sample_interval) * world.log.width


def _try(world: World) -> series.Log:
    """Check that the plant accepts the command, before anything changes; return the current sample."""
    return world.plant.march(world.state, world.command, MOMENT, MOMENT)[1]


# ---- the client ----------------------------------------------------------------------------------


class Session:
    """Requests and answers of one client.

    Args:
        own_robots: Robots, by name, that the server offers in addition to the presets.
        budget: Memory limits of the client.
    """

    def __init__(
        self, own_robots: Mapping[str, Robot] | None = None, budget: Budget | None = None
    ) -> None:
        self._own_robots, self._budget = own_robots or {}, budget or Budget().shared(1)
        self._world: World | None = None
        self._requests = {do: getattr(self, f"_{do}") for do in messages.REQUESTS}

    def answer(self, line: bytes) -> bytes:
        """Answer a request; errors are returned as answers, never raised.

        Args:
            line: The request, without its line ending.
        """
        tag: dict[str, Any] = {}
        with self._budget.turn_for(len(line)):
            try:
                message = messages.read_message(line)
                if "id" in message:
                    tag["id"] = message["id"]
                return self._written({**tag, **self._answer(message)})
            except (ValueError, LaticaudaError) as error:
                return messages.write_message({**tag, "error": str(error)})
            except (
                Exception
            ) as error:  # one request that fails unexpectedly must not end the others
                traceback.print_exc(file=sys.stderr)
                return messages.write_message(
                    {**tag, "error": f"The server failed: {type(error).__name__}: {error}"}
                )

    def _written(self, message: Message) -> bytes:
        count, most = (
            sum(np.size(values) for values in message.get("series", {}).values()),
            self._budget.answered,
        )
        if count > most:
            raise BadArgument(
                "series", f"must hold {most} numbers or fewer in one answer, got {count}"
            )
        with self._budget.turn_for(count):
            return messages.write_message(message)

    def _answer(self, message: Message) -> dict[str, Any]:
        asked = message.get("protocol", messages.PROTOCOL_VERSION)
        if asked != messages.PROTOCOL_VERSION:
            raise BadArgument(
                "protocol",
                f"must be {messages.PROTOCOL_VERSION}, the server's version, got {asked!r}",
            )
        do = check_choice("do", message.get("do"), tuple(self._requests))
        codec.check_keys(message, (*messages.COMMON, *messages.REQUESTS[do]))
        return self._requests[do](message)

    def _reset(self, message: Message) -> dict[str, Any]:
        world = self._world = new_world(
            messages.read_scenario(message, self._own_robots), self._budget
        )
        return {**_seen(world), **_about(world)}

    def _step(self, message: Message) -> dict[str, Any]:
        duration = check_positive("duration", message.get("duration"), "s")
        world = stepped(change_world(self._there(), message, tried=False), duration)
        self._world = world
        if world.broken is not None:
            raise ValueError(world.broken)
        return _seen(world)

    def _set(self, message: Message) -> dict[str, Any]:
        self._world = change_world(self._there(), message)
        return {"command": _command(self._world)}

    def _get(self, message: Message) -> dict[str, Any]:
        world = self._there()
        if "series" not in message:
            return {**_seen(world), "command": _command(world), **_about(world)}
        since = check_finite("since", message.get("since", -1.0), "s")
        return {
            "series": world.log.series(_names(message["series"]), since),
            "dropped": world.log.dropped,
        }

    def _run(self, message: Message) -> dict[str, Any]:
        names = _names(message.get("series", []))
        for name in names:
            check_choice("series", name, tuple(series.SERIES))
        duration = check_positive("duration", message.get("duration", 30.0), "s")
        scenario = messages.read_scenario(message, self._own_robots, duration)
        numbers = check_work(
            new_world(scenario, self._budget), scenario.duration, scenario.sample_interval
        )
        with self._budget.turn_for(numbers):
            trial = simulate.swim(scenario)
        found: dict[str, Any] = {"figures": trial.summary()}
        if names:
            found["series"] = {
                name: values for name in names if (values := getattr(trial, name)) is not None
            }
        return found

    def _there(self) -> World:
        if self._world is None:
            raise BadArgument(
                "reset", "must come before this request: there is no robot in the water yet"
            )
        return self._world


def _names(value: object) -> list[str]:
    names: list[Any] = cast("list[Any]", value) if isinstance(value, list) else [value]
    if not all(isinstance(name, str) for name in names):
        raise BadArgument("series", f"must be an array of names, got {value!r}")
    return names


def _seen(world: World) -> dict[str, Any]:
    seen, last = world.plant.observe(world.state), world.log.last
    observed = {field.name: getattr(seen, field.name) for field in dataclasses.fields(seen)}
    return {
        "observation": observed,
        **{name: last[name] for name in messages.LOADS if name in last},
    }


def _command(world: World) -> dict[str, Any]:
    water = world.plant.environment
    current = {"current": codec.encode(water.current, Current)} if isinstance(water, Water) else {}
    return {**dataclasses.asdict(world.command), **current}


def _about(world: World) -> dict[str, Any]:
    robot = world.plant.robot
    return {
        "protocol": messages.PROTOCOL_VERSION,
        "version": packaging.__version__,
        "robot": robot.name,
        "n_links": robot.n_links,
        "n_joints": robot.n_joints,
        "link_length": [2.0 * module.half_length for module in robot.modules],
        "settings": scenarios.settings_of(world.plant.settings),
    }
