"""The only place where scenarios become plants."""

from typing import Any, Unpack, cast

from laticauda.errors import instance
from laticauda.extensions import name_of
from laticauda.interfaces import Plant
from laticauda.robot import Environment, Ground, Robot, Water, law_of
from laticauda.robot.files import from_toml
from laticauda.scenarios import Model, ModelChanges, Planar, Scenario, Spatial, model_of
from laticauda.trial import Trial


def plant(
    robot: Scenario | Robot,
    environment: Environment | None = None,
    model: Model | str = "planar",
    **changes: Unpack[ModelChanges],
) -> Plant[Any]:
    """What a scenario is about as something that can be stepped.

    Args:
        robot: The scenario; or a robot alone, that comes with its environment.
        environment: Where it swims; left out with a scenario.
        model: With a robot, the model or its name.
        changes: With a robot, the model's settings; see `laticauda.scenarios.ModelChanges`.

    Returns:
        The plant.

    Raises:
        ValueError: If an argument is out of its range, or robot and environment do not fit together.
        MissingExtra: If the model needs a package that is not installed.
    """
    if isinstance(robot, Scenario):
        return _plant(robot.robot, robot.environment, robot.model)
    instance("robot", robot, Robot)
    instance("environment", environment, Water, Ground)
    given = {name: one for name, one in changes.items() if one is not None}
    return _plant(robot, cast(Environment, environment), model_of(model, **given))


def _plant(robot: Robot, environment: Environment, model: Model) -> Plant[Any]:
    law_of(environment).check()
    settings: dict[str, Any] = {**vars(model), "joints": name_of(type(model.joints))}
    if isinstance(model, Planar):
        from laticauda.planar.model import PlanarPlant

        return PlanarPlant(robot=robot, environment=environment, **settings)
    from laticauda.spatial.model import SpatialPlant

    if model.root is None:
        settings["root"] = "free" if any(joint.axis == "pitch" for joint in robot.joints) else "planar"
    return SpatialPlant(robot=robot, environment=environment, **settings)


def plant_of(trial: Trial) -> Plant[Any]:
    """The plant that a trial was made with, to go on with it.

    Args:
        trial: A simulated trial.

    Raises:
        ValueError: If it was made with a fluid law that stood in no file, as laticauda could before laws were values.
    """
    settings: Any = trial.settings
    if settings.get("fluid_law", "built-in") != "built-in":
        raise ValueError(f"`trial` must be a trial with a built-in fluid law, got one with {settings['fluid_law']}.")
    names = ("model", "joints", "dt", "offset_bandwidth", "ramp", "root", "gravity", "ballast_depth", "tank")
    shore = from_toml(settings["shore"], Ground) if "shore" in settings else None
    chosen = {name: settings[name] for name in names if name in settings}
    return plant(trial.robot, trial.environment, **chosen, shore=shore)


def needs_compiling(environment: Environment, model: Model | str | None = None) -> bool:
    """Whether the first run in this environment will have to compile its kernels, which takes seconds.

    Args:
        environment: The water it swims in or the ground it crawls on.
        model: By which model, or its name; None: planar.

    Raises:
        MissingExtra: If the model needs a package that is not installed.
    """
    model = model_of(model or "planar")
    if isinstance(model, Spatial):
        from laticauda.extras import load_mujoco
        from laticauda.spatial.stepping import is_compiled as is_spatial_compiled

        load_mujoco()
        return not is_spatial_compiled()
    from laticauda.planar.specialize import is_compiled

    return not is_compiled(law=law_of(environment))
