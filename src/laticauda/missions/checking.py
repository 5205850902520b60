"""What a mission must have before it runs: kinds that are defined, and the sensors that its table relies on."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import is_dataclass
from typing import Any, cast

import numpy as np

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
from laticauda.robot import Robot
from laticauda.scenarios import Scenario
from laticauda.sensing import AcousticPosition, Sensor, Sonar
from laticauda.values import BadArgument, Extensible, Unknown, suggest_nearest

DOUBTFUL_LENGTH = 0.1
"""Share by which the length of a robot differs from the believed one, and it is doubtful whether that is meant."""
DOUBTFUL_DISTANCE = 0.01
"""Distance of a beacon from where it is believed to be, beyond which the same holds [m]."""
EQUAL_ANGLES = 1e-6
"""Difference of directions that count as equal [rad]."""


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
    _check_beams(scenario.model.sensors, mission.navigation)
    _check_depths(scenario.robot, mission)


def doubts_about(scenario: Scenario) -> Iterator[str]:
    """Yield what a mission believes of its robot and its beacon that is not so, each in a sentence.

    Args:
        scenario: The scenario, whose controller is a mission.
    """
    mission = scenario.motion
    assert isinstance(mission, Mission)
    navigation = mission.navigation
    length = scenario.robot.length
    if not math.isclose(navigation.body_length, length, rel_tol=DOUBTFUL_LENGTH):
        yield (
            f"`controller.navigation.body_length` is {navigation.body_length:.4g} m, but "
            f"`{scenario.robot.name}` is {length:.4g} m long: it believes to be elsewhere by half the difference."
        )
    for sensor in scenario.model.sensors:
        if not isinstance(sensor, AcousticPosition) or sensor.name != navigation.position:
            continue
        if not np.allclose(navigation.beacon, sensor.beacon[:2], atol=DOUBTFUL_DISTANCE):
            believed = describe_point(navigation.beacon)
            there = describe_point(sensor.beacon[:2])
            yield (
                f"`controller.navigation.beacon` is {believed} m, but the beacon of the sensor `{sensor.name}` "
                f"is at {there} m: it believes to be elsewhere by the difference."
            )


def describe_point(point: Sequence[float]) -> str:
    """Return a point as people write it: (1.5, 0).

    Args:
        point: Its coordinates.
    """
    return f"({', '.join(f'{coordinate:.4g}' for coordinate in point)})"


def _check_beams(sensors: Sequence[Sensor], navigation: Navigation) -> None:
    """Reject directions of beams that are not those of the sonar: all echoes would be elsewhere."""
    for sensor in sensors:
        if not isinstance(sensor, Sonar) or sensor.name != navigation.sonar:
            continue
        path = "controller.navigation.beams_deg"
        rule = f"must be those of the sensor `{sensor.name}` in the same order"
        if len(navigation.beams) != len(sensor.beams):
            numbers = f"{len(sensor.beams)} of them, got {len(navigation.beams)}"
            raise BadArgument(path, f"{rule}, {numbers}")
        for believed, beam in zip(navigation.beams, sensor.beams, strict=True):
            if abs(believed - beam) > EQUAL_ANGLES:
                differs = f"got {math.degrees(believed):g} where it has {math.degrees(beam):g}"
                raise BadArgument(path, f"{rule}, {differs}")


def _check_depths(robot: Robot, mission: Mission) -> None:
    """Reject the depth of a phase if the robot has no joints that could hold it."""
    if any(joint.axis == "pitch" for joint in robot.joints):
        return
    for index, phase in enumerate(mission.phases):
        if phase.depth is not None:
            rule = "must be left out for a robot without pitch joints"
            got = f"got {phase.depth:g} m for `{robot.name}`"
            raise BadArgument(f"controller.phases[{index}].depth", f"{rule}, {got}")


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
