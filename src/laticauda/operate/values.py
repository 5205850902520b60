"""Settings as JSON and back, exactly: gaits, controllers, estimators and what they are made of.

A recording says by this how it was made, so that the same controller can run again on it. Only the classes that are
listed here are ever built from a file.
"""

import json
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any, cast

from laticauda.errors import instance
from laticauda.interfaces import Plant
from laticauda.operate.twin import PlantRecord, record_of
from laticauda.robot import Environment, Robot
from laticauda.robot.files import from_toml, to_toml

KIND = "class"
ROBOT = "robot"


@cache
def _classes() -> dict[str, type[Any]]:
    """The classes that a file may name."""
    from laticauda import control, gaits, interfaces
    from laticauda.operate.estimate import Mount
    from laticauda.operate.estimation import Estimator
    from laticauda.operate.kinematic import KinematicEstimator
    from laticauda.operate.noise import Noise

    known: list[type[Any]] = [
        control.HeadingController,
        control.IntegralLineOfSight,
        control.LineOfSight,
        control.PathFollowing,
        control.Polyline,
        control.Spline,
        control.StraightLine,
        gaits.Gait,
        gaits.Wave,
        interfaces.Command,
        interfaces.OpenLoop,
        Estimator,
        KinematicEstimator,
        Mount,
        Noise,
    ]
    return {kind.__name__: kind for kind in known}


def to_json(value: object) -> str:
    """A value of one of these classes as JSON; floats keep all their digits.

    Args:
        value: Of a listed class, or None.

    Raises:
        ValueError: If it is of another class, or holds something that is.
    """
    return json.dumps(_plain(value))


def from_json(text: str, *, robot: Robot | None = None) -> Any:
    """The value again; it equals the one that was written.

    Args:
        text: As `to_json` wrote it.
        robot: For what holds one: a robot is not written here, it has its own file.

    Raises:
        ValueError: If it is no such text, or a field is not as it may be.
    """
    try:
        return _built(json.loads(text), robot)
    except (TypeError, KeyError, json.JSONDecodeError) as error:
        raise ValueError(f"`text` must be settings that this version of laticauda knows, got {text[:60]!r}.") from error


def _plain(value: object) -> Any:
    if isinstance(value, PlantRecord):
        described = {"robot": to_toml(value.robot), "environment": to_toml(value.environment)}
        return {KIND: PlantRecord.__name__, **described, "settings": dict(value.settings)}
    if is_dataclass(value) and not isinstance(value, type):
        instance("value", value, *_classes().values())
        names = [item.name for item in fields(value) if item.init and item.name != ROBOT]
        own = {name: _plain(_recorded(name, getattr(value, name))) for name in names}
        return {KIND: type(value).__name__, **own}
    if isinstance(value, tuple | list):
        return [_plain(item) for item in cast("tuple[object, ...]", value)]
    if value is None or isinstance(value, str | bool | int | float):
        return value
    raise ValueError(f"`value` must be made of numbers, texts and settings, got {type(value).__name__}.")


def _recorded(name: str, value: object) -> object:
    """Of a plant only how it was made."""
    return record_of(cast("Plant[Any]", value)) if name == "plant" and isinstance(value, Plant) else value


def _built(plain: Any, robot: Robot | None) -> Any:
    if isinstance(plain, dict):
        given = dict(cast("dict[str, Any]", plain))
        name = given.pop(KIND)
        if name == PlantRecord.__name__:
            robot, environment = from_toml(given["robot"], Robot), from_toml(given["environment"])
            return PlantRecord(robot=robot, environment=cast("Environment", environment), settings=given["settings"])
        kind = _classes()[name]
        own = {name: _built(value, robot) for name, value in given.items()}
        if any(item.name == ROBOT for item in fields(kind)):
            own[ROBOT] = robot
        return kind(**own)
    if isinstance(plain, list):
        return tuple(_built(item, robot) for item in cast("list[Any]", plain))
    return plain
