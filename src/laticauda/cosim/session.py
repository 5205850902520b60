"""One client: a line in, a line out. Knows nothing of sockets."""

import dataclasses
import sys
import traceback
from collections.abc import Callable, Mapping
from typing import Any, cast

from laticauda import codec, packaging, scenarios, series, simulate
from laticauda.cosim import messages
from laticauda.cosim.messages import Message
from laticauda.cosim.worlds import World, changed, check_work, new_world, stepped
from laticauda.errors import BadArgument, LaticaudaError, finite, one_of, positive
from laticauda.robot import Current, Robot, Water

LOADS = ("joint_angle_ref", "joint_torque", "work", "electrical_work")  # of the last sample, beside the observation


class Session:
    """What one client says and hears.

    Args:
        own_robots: Robots by name that the server has besides the presets.
    """

    def __init__(self, own_robots: Mapping[str, Robot] | None = None) -> None:
        self._own_robots = own_robots or {}
        self._world: World | None = None
        self._requests: dict[str, tuple[Callable[[Message], dict[str, Any]], tuple[str, ...]]] = {
            "reset": (self._reset, messages.MADE_FROM),
            "step": (self._step, ("duration", *messages.HELD)),
            "set": (self._set, messages.HELD),
            "get": (self._get, ("series", "since")),
            "run": (self._run, ("duration", "series", *messages.MADE_FROM)),
        }
        """By what is to be done: what does it, and the fields that it has besides those of every request."""

    def answer(self, line: bytes) -> bytes:
        """The answer to a line, which is never an exception.

        Args:
            line: The request, without its end.
        """
        tag: dict[str, Any] = {}
        try:
            message = messages.read_message(line)
            if "id" in message:
                tag["id"] = message["id"]
            return messages.write_message({**tag, **self._answer(message)})
        except codec.BadKey as bad:
            return messages.write_message({**tag, "error": str(BadArgument(bad.key, bad.rule))})
        except (ValueError, LaticaudaError) as error:
            return messages.write_message({**tag, "error": str(error)})
        except Exception as error:  # one request that we cannot make sense of must not end the others
            traceback.print_exc(file=sys.stderr)
            return messages.write_message({**tag, "error": f"The server failed: {type(error).__name__}: {error}"})

    def _answer(self, message: Message) -> dict[str, Any]:
        asked = message.get("protocol", messages.PROTOCOL_VERSION)
        if asked != messages.PROTOCOL_VERSION:
            raise BadArgument("protocol", f"must be {messages.PROTOCOL_VERSION}, which it speaks, got {asked!r}")
        request, fields = self._requests[one_of("do", message.get("do"), tuple(self._requests))]
        codec.check_keys(message, ("do", "id", "protocol", *fields))
        return request(message)

    def _reset(self, message: Message) -> dict[str, Any]:
        world = self._world = new_world(messages.read_scenario(message, self._own_robots))
        return {**_seen(world), **_about(world)}

    def _step(self, message: Message) -> dict[str, Any]:
        duration = positive("duration", message.get("duration"), "s")
        world = stepped(changed(self._there(), message, tried=False), duration)
        self._world = world
        if world.broken is not None:
            raise ValueError(world.broken)
        return _seen(world)

    def _set(self, message: Message) -> dict[str, Any]:
        self._world = changed(self._there(), message)
        return {"command": _command(self._world)}

    def _get(self, message: Message) -> dict[str, Any]:
        world = self._there()
        if "series" not in message:
            return {**_seen(world), "command": _command(world), **_about(world)}
        since = finite("since", message.get("since", -1.0), "s")
        return {"series": world.log.series(_names(message["series"]), since), "dropped": world.log.dropped}

    def _run(self, message: Message) -> dict[str, Any]:
        names = _names(message.get("series", []))
        for name in names:
            one_of("series", name, tuple(series.SERIES))
        duration = positive("duration", message.get("duration", 30.0), "s")
        scenario = messages.read_scenario(message, self._own_robots, duration)
        check_work(simulate.plant(scenario), scenario.duration, scenario.sample_interval)
        trial = simulate.swim(scenario)
        found: dict[str, Any] = {"figures": trial.summary()}
        if names:
            found["series"] = {name: values for name in names if (values := getattr(trial, name)) is not None}
        return found

    def _there(self) -> World:
        if self._world is None:
            raise BadArgument("reset", "must come before this request: there is no robot in the water yet")
        return self._world


def _names(value: object) -> list[str]:
    names: list[Any] = cast("list[Any]", value) if isinstance(value, list) else [value]
    if not all(isinstance(name, str) for name in names):
        raise BadArgument("series", f"must be an array of names, got {value!r}")
    return names


def _seen(world: World) -> dict[str, Any]:
    seen, last = world.plant.observe(world.state), world.log.last
    return {"observation": vars(seen), **{name: last[name] for name in LOADS if name in last}}


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
