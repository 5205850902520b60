"""Scenarios from a robot, a gait and a few changes, in the shortest words that say it."""

import functools
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, Literal, TypeAlias, TypedDict, Unpack, cast

from laticauda.actuation.laws import JointLaw
from laticauda.errors import BadArgument, instance, nearest, one_of
from laticauda.gaits import Gait
from laticauda.interfaces import Controller, Start
from laticauda.robot import (
    Environment,
    Ground,
    Robot,
    from_toml,
    ground_names,
    load_ground,
    load_robot,
    load_water,
    water_names,
)
from laticauda.robot.files import find
from laticauda.scenarios.models import MODELS, Model, Spatial
from laticauda.scenarios.scenario import Scenario

Motion: TypeAlias = Gait | Controller[Any]


class ModelChanges(TypedDict, total=False):
    """What a model may differ in from its defaults: fields of `Planar` or `Spatial`; one that is None has its default.

    A joint law may be its name: ``"prescribed"``, ``"pd"``, ``"servo"``.
    """

    joints: JointLaw | str
    dt: float | None
    offset_bandwidth: float
    ramp: float | None
    root: Literal["free", "planar"] | str | None
    gravity: bool | None
    ballast_depth: float
    tank: bool
    shore: Ground | None


class Changes(ModelChanges, total=False):
    """What a scenario may differ in from its defaults: its fields and those of its model, see `ModelChanges`.

    An environment may be a preset's name or a path, a model ``"planar"`` or ``"spatial"``. The environment's default is
    the paper's water for the gait.
    """

    environment: Environment | str | Path | None
    model: Model | str
    start: Start | None
    sample_interval: float


def scenario(robot: Robot | str | Path, motion: Motion, duration: float = 30.0, **changes: Unpack[Changes]) -> Scenario:
    """A scenario from a robot, a motion and what differs from the defaults.

    Args:
        robot: What swims, or a preset's name, or the path of a file.
        motion: The gait, or the controller.
        duration: Of the run [s].
        changes: See `Changes`.

    Raises:
        ValueError: If something is out of its range, or does not go together.

    Example:
        >>> import laticauda as lc
        >>> gait = lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> scenario("mamba", gait, joints="servo", environment="paper-lateral").environment.name
        'paper-lateral'
    """
    given = {name: one for name, one in changes.items() if one is not None}
    own: dict[str, Any] = {name: given.pop(name) for name in ("start", "sample_interval") if name in given}
    environment, kind = given.pop("environment", None), cast(Any, given.pop("model", "planar"))
    instance("gait", motion, Gait, Controller)
    gait = motion if isinstance(motion, Gait) else motion.gait
    return Scenario(
        robot=load_robot(robot) if isinstance(robot, str | Path) else robot,
        motion=motion,
        environment=preset_water(default_water(gait)) if environment is None else _environment(environment),
        model=model_of(kind, **given),
        duration=duration,
        **own,
    )


def model_of(model: Model | str, **changes: Any) -> Model:
    """A model with other settings.

    Args:
        model: One, or its name.
        changes: Fields of it; ``joints`` may be a name.

    Raises:
        ValueError: If there is no such model, or a field is out of its range.
        TypeError: If no model has such a field.
    """
    if not isinstance(model, str):
        instance("model", model, *MODELS.values())
    base = MODELS[one_of("model", model, tuple(MODELS))]() if isinstance(model, str) else model
    known = [field.name for field in fields(base)]
    for name, given in changes.items():
        if name in known:
            continue
        if name in {field.name for field in fields(Spatial)}:
            raise BadArgument(name, f"must be left out unless `model` is `spatial`, got {given!r}")
        raise TypeError(f"There is no argument `{name}`{nearest(name, [*Changes.__annotations__])}.")
    if "joints" in changes:
        changes["joints"] = JointLaw.of(changes["joints"])
    return replace(base, **changes) if changes else base


def default_water(gait: Gait) -> str:
    """Name of the paper's coefficient set for `gait`: it identified one for each kind."""
    return "paper-eel" if gait.kind == "eel_like" else "paper-lateral"


preset_water = functools.cache(load_water)


def _environment(given: object) -> Any:
    """A water or ground by its name or path; anything else as it is, for the scenario to check."""
    if not isinstance(given, str | Path):
        return given
    if str(given) in ground_names():
        return load_ground(given)
    return load_water(given) if str(given) in water_names() else from_toml(find(given, "water"))
