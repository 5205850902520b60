"""Session of one client: one answer line per request line, and the client's world; independent of sockets."""

import dataclasses
import math
import sys
import traceback
import warnings
from collections.abc import Mapping
from typing import Any, cast

import numpy as np

from laticauda import scenarios
from laticauda.connect import messages
from laticauda.connect.budget import Budget
from laticauda.connect.decoding import read_scenario
from laticauda.connect.messages import Message
from laticauda.connect.world import World, change_world, check_work, create_world, step_world
from laticauda.models import simulate
from laticauda.robot import Current, Robot, Water
from laticauda.sensing import Reading
from laticauda.values import (
    REQUESTED_SERIES,
    SERIES,
    BadArgument,
    InfeasibleWarning,
    LaticaudaError,
    check_choice,
    check_finite,
    check_positive,
    codec,
    packaging,
)

RUN_DURATION = 30.0
"""Duration of a run that does not state it [s]."""
BEFORE_START = -1.0
"""Time after which all samples of a log are [s]."""


class Session:
    """Requests and answers of one client.

    Args:
        own_robots: Robots, by name, that the server offers in addition to the presets.
        budget: Memory limits of the client.
    """

    def __init__(
        self, own_robots: Mapping[str, Robot] | None = None, budget: Budget | None = None
    ) -> None:
        self._own_robots = own_robots or {}
        self._budget = budget or Budget().share_among(1)
        self._world: World | None = None
        self._handlers = {
            "reset": self._reset,
            "step": self._step,
            "set": self._set,
            "get": self._get,
            "run": self._run,
        }

    def answer(self, line: bytes) -> bytes:
        """Answer a request; errors are returned as answers, never raised.

        Args:
            line: The request, without its line ending.
        """
        tag: dict[str, Any] = {}
        with self._budget.lock_for(len(line)):
            try:
                message = messages.read_message(line)
                if "id" in message:
                    tag["id"] = message["id"]
                return self._write({**tag, **self._handle(message)})
            except (ValueError, LaticaudaError) as error:
                return messages.write_message({**tag, "error": str(error)})
            except Exception as error:
                # One request that fails unexpectedly must not end the others.
                traceback.print_exc(file=sys.stderr)
                text = f"The server failed: {type(error).__name__}: {error}"
                return messages.write_message({**tag, "error": text})

    def _write(self, message: Message) -> bytes:
        """Return an answer as a line, unless its series are too long."""
        all_series = message.get("series", {})
        n_values = sum(np.size(values) for values in all_series.values())
        most = self._budget.max_answered
        if n_values > most:
            raise BadArgument(
                "series", f"must hold {most} numbers or fewer in one answer, got {n_values}"
            )
        with self._budget.lock_for(n_values):
            return messages.write_message(message)

    def _handle(self, message: Message) -> dict[str, Any]:
        """Return the answer to a request, without its id."""
        version = message.get("protocol", messages.PROTOCOL_VERSION)
        if version != messages.PROTOCOL_VERSION:
            raise BadArgument(
                "protocol",
                f"must be {messages.PROTOCOL_VERSION}, the server's version, got {version!r}",
            )
        request = check_choice("do", message.get("do"), tuple(self._handlers))
        known_fields = (*messages.COMMON_FIELDS, *messages.REQUEST_FIELDS[request])
        codec.check_keys(message, known_fields)
        doubts = dict[str, None]()  # in their order, each once
        with scenarios.telling(lambda sentence: doubts.update({sentence: None})):
            fields = self._handlers[request](message)
        if doubts:
            return {**fields, "warnings": list(doubts)}
        return fields

    def _reset(self, message: Message) -> dict[str, Any]:
        scenario = read_scenario(message, self._own_robots)
        world = create_world(scenario, self._budget)
        self._world = world
        return {**_describe_state(world), **_describe_robot(world)}

    def _step(self, message: Message) -> dict[str, Any]:
        duration = check_positive("duration", message.get("duration"), "s")
        changed_world = change_world(self._require_world(), message, is_tried=False)
        world = step_world(changed_world, duration)
        self._world = world
        if world.broken is not None:
            raise ValueError(world.broken)
        return _describe_state(world)

    def _set(self, message: Message) -> dict[str, Any]:
        world = change_world(self._require_world(), message)
        self._world = world
        return {"command": _describe_command(world)}

    def _get(self, message: Message) -> dict[str, Any]:
        world = self._require_world()
        if "series" not in message:
            command = {"command": _describe_command(world)}
            return {**_describe_state(world), **command, **_describe_robot(world)}
        since = check_finite("since", message.get("since", BEFORE_START), "s")
        names = _read_names(message["series"])
        return {"series": world.log.select(names, since), "dropped": world.log.n_dropped}

    def _run(self, message: Message) -> dict[str, Any]:
        names = _read_names(message.get("series", []))
        for name in names:
            check_choice("series", name, tuple(SERIES))
        duration = check_positive("duration", message.get("duration", RUN_DURATION), "s")
        scenario = read_scenario(message, self._own_robots, duration)
        world = create_world(scenario, self._budget)
        n_values = check_work(world, scenario.duration, scenario.sample_interval)
        with self._budget.lock_for(n_values), warnings.catch_warnings():
            # A warning would reach the server's terminal, not the client.
            warnings.simplefilter("ignore", InfeasibleWarning)
            has_loads = any(name in REQUESTED_SERIES for name in names)
            trial = simulate.swim(scenario, link_forces=has_loads)
        results: dict[str, Any] = {"figures": trial.summary()}
        if names:
            all_values = {name: getattr(trial, name) for name in names}
            results["series"] = {
                name: values for name, values in all_values.items() if values is not None
            }
        return results

    def _require_world(self) -> World:
        if self._world is None:
            raise BadArgument(
                "reset", "must come before this request: there is no robot in the water yet"
            )
        return self._world


def _read_names(value: object) -> list[str]:
    """Return a list of names, for which one name may stand alone."""
    names: list[Any] = [value]
    if isinstance(value, list):
        names = cast("list[Any]", value)
    for name in names:
        if not isinstance(name, str):
            raise BadArgument("series", f"must be an array of names, got {value!r}")
    return names


def _describe_state(world: World) -> dict[str, Any]:
    """Return the observation of a world's robot, and the loads of the last sample."""
    observation = world.plant.observe(world.state)
    names = [field.name for field in dataclasses.fields(observation)]
    observed = {name: getattr(observation, name) for name in names}
    observed["readings"] = {
        name: _describe_reading(reading) for name, reading in world.readings.items()
    }
    state: dict[str, Any] = {"observation": observed}
    last_sample = world.log.last
    for name in messages.LOAD_FIELDS:
        if name in last_sample:
            state[name] = last_sample[name]
    return state


def _describe_reading(reading: Reading) -> dict[str, Any]:
    """Return what a sensor told, with null for what it did not."""
    return {
        "time": _number_or_null(reading.time),
        "values": [_number_or_null(number) for number in reading.values.tolist()],
        "is_new": reading.is_new,
    }


def _number_or_null(number: float) -> float | None:
    """Return a number that JSON can write; None if it is not finite."""
    if math.isfinite(number):
        return number
    return None


def _describe_command(world: World) -> dict[str, Any]:
    command = dataclasses.asdict(world.command)
    water = world.plant.environment
    if isinstance(water, Water):
        command["current"] = codec.encode(water.current, Current)
    return command


def _describe_robot(world: World) -> dict[str, Any]:
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
