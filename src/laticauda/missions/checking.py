"""What a mission must have before it runs: kinds that are defined, and the sensors that its table relies on."""

from collections.abc import Iterator
from dataclasses import is_dataclass
from typing import Any, cast

from laticauda.missions.behaviours import FollowWall, Search
from laticauda.missions.mission import Mission
from laticauda.missions.navigation import Navigation
from laticauda.missions.phases import (
    BatteryLow,
    Captured,
    Condition,
    SensorHeard,
    SensorSilent,
    Touched,
)
from laticauda.scenarios import Scenario
from laticauda.values import BadArgument, Extensible, Unknown, suggest_nearest


def check_mission(scenario: Scenario) -> None:
    """Reject a mission that could not do what its table says: a part would stay undone, and nobody would be told.

    Args:
        scenario: The scenario, whose controller is a mission.

    Raises:
        ValueError: If a kind is not defined here, or the table relies on a sensor that the robot has not.
    """
    for name in ("places", "sensors"):
        _check_defined(getattr(scenario.model, name), f"model.{name}")
    mission = scenario.motion
    assert isinstance(mission, Mission)
    _check_defined(mission.always, "controller.always")
    _check_defined(mission.phases, "controller.phases")
    names = tuple(sensor.name for sensor in scenario.model.sensors)
    for path, sensor in _find_needed_sensors(mission):
        if sensor not in names:
            listed = ", ".join(f"`{name}`" for name in names) or "none"
            hint = suggest_nearest(sensor, names)
            rule = f"needs the sensor `{sensor}`, which is not among those of `model.sensors`"
            raise BadArgument(path, f"{rule}: {listed}{hint}")


def _check_defined(parts: tuple[Any, ...], path: str) -> None:
    """Reject stand-ins for what a file names but nobody defines, with the kinds that are defined."""
    for at, stand_in in _find_stand_ins(parts, path):
        base: Any = next(kind for kind in type(stand_in).__mro__ if "_homes" in vars(kind))
        try:
            base.named(stand_in.kind)
        except BadArgument as error:
            raise BadArgument(f"{at}.kind", error.rule) from None


def _find_stand_ins(part: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield the stand-ins in a part of a mission, each with its path."""
    if isinstance(part, Unknown):
        assert isinstance(part, Extensible)
        yield path, part
    elif isinstance(part, tuple):
        for index, member in enumerate(cast("tuple[Any, ...]", part)):
            yield from _find_stand_ins(member, f"{path}[{index}]")
    elif is_dataclass(part):
        for name, value in vars(part).items():
            yield from _find_stand_ins(value, f"{path}.{name}")


def _find_needed_sensors(mission: Mission) -> Iterator[tuple[str, str]]:
    """Yield the names of sensors without which a part of the table has no effect, each with the path of that part."""
    navigation = mission.navigation
    for index, transition in enumerate(mission.always):
        path = f"controller.always[{index}].when"
        for sensor in _sensors_of_condition(transition.when, navigation):
            yield path, sensor
    for index, phase in enumerate(mission.phases):
        if isinstance(phase.behaviour, Search | FollowWall):
            yield f"controller.phases[{index}].behaviour", navigation.sonar
        for number, transition in enumerate(phase.transitions):
            path = f"controller.phases[{index}].transitions[{number}].when"
            for sensor in _sensors_of_condition(transition.when, navigation):
                yield path, sensor


def _sensors_of_condition(condition: Condition, navigation: Navigation) -> tuple[str, ...]:
    """Return the names of the sensors without which a condition is never met, or always."""
    if isinstance(condition, SensorSilent | SensorHeard):
        return (condition.sensor,)
    if isinstance(condition, BatteryLow):
        return (navigation.battery,)
    if isinstance(condition, Captured):
        return (navigation.position, condition.beacon)
    if isinstance(condition, Touched):
        return (navigation.contact,)
    return ()
