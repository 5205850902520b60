"""Scenarios in short form: a robot, a gait and deviations from the defaults; names of presets and files.

`Changes` lists everything that may deviate. `build_scenario` distributes it: what is the scenario's
goes into its fields, everything else to the model.
"""

import functools
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, Literal, TypeAlias, TypedDict, Unpack, cast

from laticauda import robot as robots
from laticauda.motion.gaits import Gait, GaitFields, gait_by_name, list_kinds
from laticauda.motion.joints import JointLaw
from laticauda.scenarios.interfaces import Controller, Start
from laticauda.scenarios.scenario import MODELS, Model, Scenario, Spatial
from laticauda.scenarios.waters import environment_of
from laticauda.sensing import Place, Sensor
from laticauda.values import BadArgument, check_choice, check_instance, hint_at

Motion: TypeAlias = Gait | Controller[Any]


class ModelChanges(TypedDict, total=False):
    """Settings of a model that may differ from its defaults: fields of `Planar` or `Spatial`; None means the default.

    A joint law may be given by name: ``"prescribed"``, ``"pd"``, ``"servo"``.
    """

    joints: JointLaw | str
    dt: float | None
    offset_bandwidth: float
    loop_delay: float
    ramp: float | None
    root: Literal["free", "planar"] | str | None
    gravity: bool | None
    ballast_depth: float
    scene: robots.Scene | Callable[[Any], None] | str | None
    rays: tuple[float, ...]
    sensors: tuple[Sensor, ...]
    places: tuple[Place, ...]


class Changes(ModelChanges, total=False):
    """Settings of a scenario that may differ from its defaults: its fields and those of its model, see `ModelChanges`.

    An environment, a current or parameters may be given by preset name or path, a model as
    ``"planar"`` or ``"spatial"``. The default environment is `default_water` of robot and gait; a
    current replaces that of the water. Parameters define the water, change the robot, and have the
    joint law that is used if `joints` is left out.
    """

    parameters: robots.Parameters | str | Path | None
    environment: robots.Environment | str | Path | None
    current: robots.Current | str | None
    model: Model | str
    start: Start | None
    sample_interval: float


class SwimChanges(Changes, GaitFields, total=False):
    """`Changes`, and the numbers of a gait that is given by name, as in ``"eel-like", amplitude_deg=30``."""


def build_scenario(
    robot: robots.Robot | str | Path,
    motion: Motion | str,
    duration: float = 30.0,
    **changes: Unpack[SwimChanges],
) -> Scenario:
    """Make a scenario from a robot, a motion and deviations from the defaults.

    Args:
        robot: The robot, the name of a preset, or the path of a file.
        motion: The gait, the name of its kind, or the controller.
        duration: Duration of the run [s].
        changes: The numbers of a gait that is given by name, such as `amplitude_deg`, and other
            deviations from the defaults: `environment`, `current`, `model`, `start`,
            `sample_interval` [s], `parameters`, or settings of the model: `joints`, `dt` [s] and
            the other fields of `laticauda.scenarios.ModelChanges`.

    Raises:
        ValueError: If an argument is out of its range, or arguments are incompatible.

    Example:
        >>> import laticauda as lc
        >>> gait = lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> build_scenario("mamba", gait, joints="servo", environment="paper-lateral").environment.name
        'paper-lateral'
    """
    stated_changes: dict[str, Any] = {
        name: value for name, value in changes.items() if value is not None
    }
    gait_numbers = {
        name: stated_changes.pop(name) for name in GAIT_NUMBERS if name in stated_changes
    }
    model_changes = {
        name: value for name, value in stated_changes.items() if name not in SCENARIO_CHANGES
    }
    optional_fields: dict[str, Any] = {
        name: stated_changes[name] for name in OPTIONAL_FIELDS if name in stated_changes
    }
    replaced_fields: dict[str, Any] = {}
    if "current" in stated_changes:
        replaced_fields["current"] = robots.current_of(stated_changes["current"])
    if isinstance(robot, Gait):
        raise BadArgument(
            "robot", "must be a robot, got a Gait; the robot comes first, then the gait"
        )
    motion = _motion_of(motion, gait_numbers)
    gait = motion if isinstance(motion, Gait) else motion.gait
    if isinstance(robot, str | Path):
        robot = robots.load_robot(robot)
    environment: Any = stated_changes.get("environment")
    if "parameters" in stated_changes:
        parameters = _load(stated_changes["parameters"])
        if environment is not None:
            rule = "must not be given with `environment`: both define the water"
            raise BadArgument("parameters", rule)
        robot = parameters.robot(robot, gait.kind)
        environment = parameters.water(gait.kind)
        if parameters.joints is not None:
            model_changes.setdefault("joints", parameters.joints)
    environment = environment_of(environment, robot, gait)
    if replaced_fields:
        if not isinstance(environment, robots.Water):
            raise BadArgument("current", "must be given only with a Water, which can move")
        environment = replace(environment, **replaced_fields)
    model: Any = stated_changes.get("model", "planar")
    return Scenario(
        robot=robot,
        motion=motion,
        environment=environment,
        model=model_of(model, **model_changes),
        duration=duration,
        **optional_fields,
    )


GAIT_NUMBERS = frozenset(GaitFields.__annotations__)
"""Names in `SwimChanges` that are the numbers of a gait."""


def _motion_of(motion: Any, gait_numbers: dict[str, Any]) -> Motion:
    """Return a gait or a controller; a gait may be given by name, with its numbers."""
    if isinstance(motion, str):
        return _gait_by_name(motion, gait_numbers)
    _check_motion(motion)
    for name in gait_numbers:
        rule = "must be given only with the name of a gait, such as `eel-like`"
        raise BadArgument(name, f"{rule}; change a gait with `dataclasses.replace`")
    return motion


def _gait_by_name(name: str, numbers: dict[str, Any]) -> Gait:
    kind = name.replace(" ", "-").replace("_", "-")
    kinds = [listed_kind.replace("_", "-") for listed_kind in list_kinds()]
    check_choice("gait", kind, kinds)
    if not numbers:
        example = "amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40"
        raise BadArgument("gait", f'by name needs its numbers, too: "{kind}", {example}')
    return gait_by_name(kind, **numbers)


def _check_motion(motion: object) -> None:
    """Reject what is no motion, and say which ones there are."""
    if isinstance(motion, Gait | Controller):
        return
    rule = f"must be of class Gait or Controller, got {type(motion).__name__}"
    if isinstance(motion, list | tuple):
        raise BadArgument("gait", f"{rule}; did you mean swim_many?")
    raise BadArgument("gait", f"{rule}; `lateral_undulation(...)` makes one, for instance")


def _load(parameters: object) -> robots.Parameters:
    """Return parameters, which may be given by name or path."""
    if isinstance(parameters, str | Path):
        return robots.load_parameters(parameters)
    check_instance("parameters", parameters, robots.Parameters)
    return cast(robots.Parameters, parameters)


SCENARIO_CHANGES = frozenset(Changes.__annotations__) - frozenset(ModelChanges.__annotations__)
"""Names in `Changes` that are not settings of the model."""
OPTIONAL_FIELDS = ("start", "sample_interval")
"""Those that are fields of `Scenario` as they are."""


def model_of(model: Model | str, **changes: Any) -> Model:
    """Return a model with changed settings.

    Args:
        model: The model, or its name.
        changes: New values of its fields; ``joints`` may be a name.

    Raises:
        ValueError: If there is no such model, or a field is out of its range.
        TypeError: If no model has such a field.
    """
    if isinstance(model, str):
        model = _model_named(check_choice("model", model, tuple(MODELS)))
    check_instance("model", model, *MODELS.values())
    for name, value in changes.items():
        if name not in model.__dataclass_fields__:
            _refuse_setting(name, value)
    if "joints" in changes:
        changes["joints"] = JointLaw.of(changes["joints"])
    # The same object, if it stays the same: its plant is found by it (`simulate.plants`).
    if all(value is getattr(model, name) for name, value in changes.items()):
        return model
    return replace(model, **changes)


@functools.cache
def _model_named(name: str) -> Model:
    """Return the model of a name with its defaults, always the same object."""
    return MODELS[name]()


def _refuse_setting(name: str, value: object) -> None:
    """Say why a model does not have a setting."""
    if name in {field.name for field in fields(Spatial)}:
        raise BadArgument(name, f"must be left out unless `model` is `spatial`, got {value!r}")
    arguments = ["duration", *SwimChanges.__annotations__]
    hint = hint_at(name, MEANT, arguments)
    if not hint:
        hint = "."
    raise TypeError(f"There is no argument `{name}`{hint}")


MEANT = {
    "actuation": ("joints",),
    "actuators": ("joints",),
    "controller": ("the controller as second argument, in place of the gait",),
    "dimension": ("model",),
    "drag": ("environment",),
    "engine": ("model",),
    "fluid": ("environment",),
    "gait": ("the gait as second argument",),
    "initial_state": ("start",),
    "length": ("duration",),
    "motors": ("joints",),
    "n_links": ("load_robot(name, n_links)",),
    "n_steps": ("duration",),
    "params": ("parameters",),
    "sample_rate": ("sample_interval",),
    "seconds": ("duration",),
    "servo": ("joints",),
    "sampling": ("sample_interval",),
    "steps": ("duration",),
    "t": ("duration",),
    "t_end": ("duration",),
    "time": ("duration",),
    "timestep": ("dt",),
    "time_step": ("dt",),
    "velocity": ("start",),
    "water": ("environment",),
    "waters": ("environment",),
}
"""Names of arguments by names that people try in vain."""
