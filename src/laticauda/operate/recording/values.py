"""Settings as JSON and back, exactly: gaits, controllers, estimators and what they are made of.

A recording says by this how it was made, so that the same controller can run again on it. Only the classes that are
listed here are ever built from a file.
"""

import json
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any, cast

from laticauda import control, estimation, gaits, interfaces
from laticauda.codec import decode, encode, keys_of
from laticauda.errors import BadArgument, instance
from laticauda.fluid.laws import FunctionDrag
from laticauda.interfaces import Plant
from laticauda.robot import Environment, Robot, law_of
from laticauda.robot.files import from_toml, to_toml
from laticauda.scenarios import Experiment, model_of, settings_of

KIND = "class"
ROBOT, PLANT = "robot", "plant"  # they are not written here: a robot has its own file, a plant its record


def record_of(plant: Plant[Any]) -> Experiment:
    """How a plant was made, as a recording keeps it.

    Args:
        plant: Made by `laticauda.simulate.plant`.

    Raises:
        ValueError: If it has a function as its law, or a shore, neither of which a recording can hold.
    """
    if isinstance(law_of(plant.environment), FunctionDrag) or getattr(plant.settings, "shore", None) is not None:
        raise BadArgument("plant", "must have a law that is a class, and no shore, to be recorded")
    return Experiment(robot=plant.robot, environment=plant.environment, model=plant.settings)


@cache
def _classes() -> dict[str, type[Any]]:
    """The classes that a file may name."""
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
        estimation.Estimator,
        estimation.KinematicEstimator,
        estimation.Mount,
        estimation.Noise,
    ]
    return {kind.__name__: kind for kind in known}


def to_json(value: object, *, twin: Experiment | None = None) -> str:
    """A value of one of these classes as JSON; floats keep all their digits.

    Args:
        value: Of a listed class, or None.
        twin: The record of an estimator's plant.

    Raises:
        ValueError: If it is of another class, or holds something that is.
    """
    plain = _plain(value)
    if twin is not None and twin.model is not None:
        described = {"robot": to_toml(twin.robot), "environment": to_toml(twin.environment)}
        plain[PLANT] = {KIND: "PlantRecord", **described, "settings": settings_of(twin.model)}
    return json.dumps(plain)


def from_json(text: str, *, robot: Robot | None = None) -> Any:
    """The value again; it equals the one that was written, but for a plant, of which `twin_from_json` has the record.

    Args:
        text: As `to_json` wrote it.
        robot: For what holds one: a robot is not written here, it has its own file.

    Raises:
        ValueError: If it is no such text, or a field is not as it may be.
    """
    try:
        return _built(json.loads(text), robot)
    except (TypeError, KeyError, json.JSONDecodeError) as error:
        raise BadArgument(
            "text", f"must be settings that this version of laticauda knows, got {text[:60]!r}"
        ) from error


def twin_from_json(text: str) -> Experiment | None:
    """The record of an estimator's plant; None without one.

    Args:
        text: As `to_json` wrote it.
    """
    plain: dict[str, Any] = json.loads(text) or {}
    given: dict[str, Any] | None = plain.get(PLANT)
    if given is None:
        return None
    robot, environment = from_toml(given["robot"], Robot), from_toml(given["environment"])
    settings = {name: one for name, one in given["settings"].items() if one is not None}
    model = model_of(settings.pop("model", "planar"), **settings)
    return Experiment(robot=robot, environment=cast("Environment", environment), model=model)


def _plain(value: object) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        if isinstance(value, gaits.Gait):  # as files have it: its envelope may be anybody's
            return {KIND: gaits.Gait.__name__, **encode(value)}
        instance("value", value, *_classes().values())
        names = [item.name for item in fields(value) if item.init and item.name not in (ROBOT, PLANT)]
        return {KIND: type(value).__name__, **{name: _plain(getattr(value, name)) for name in names}}
    if isinstance(value, tuple | list):
        return [_plain(item) for item in cast("tuple[object, ...]", value)]
    if value is None or isinstance(value, str | bool | int | float):
        return value
    raise BadArgument("value", f"must be made of numbers, texts and settings, got {type(value).__name__}")


def _built(plain: Any, robot: Robot | None) -> Any:
    if isinstance(plain, dict):
        given = dict(cast("dict[str, Any]", plain))
        kind = _classes()[given.pop(KIND)]
        if kind is gaits.Gait:
            with keys_of("gait", ValueError):
                return decode(gaits.Gait, {name: _without_class(value) for name, value in given.items()})
        own = {name: _built(value, robot) for name, value in given.items() if name != PLANT}
        if any(item.name == ROBOT for item in fields(kind)):
            own[ROBOT] = robot
        return kind(**own)
    if isinstance(plain, list):
        return tuple(_built(item, robot) for item in cast("list[Any]", plain))
    return plain


def _without_class(value: Any) -> Any:
    """A wave as files have it; older recordings said its class."""
    if not isinstance(value, dict):
        return value
    return {key: one for key, one in cast("dict[str, Any]", value).items() if key != KIND}
