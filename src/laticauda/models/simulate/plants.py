"""Conversion of scenarios to plants; this is the only place where it happens."""

from pathlib import Path
from typing import Any, Unpack, cast

from laticauda import scenarios
from laticauda.models.dynamics.plant import Plant
from laticauda.models.dynamics.school import School
from laticauda.robot import Environment, Ground, Robot, Water, law_of, load_robot
from laticauda.scenarios import Command, Experiment, Model, ModelChanges, Planar, Scenario, Spatial
from laticauda.values import BadArgument, check_instance, load_mujoco


def build_plant(
    robot: Scenario | Experiment | Robot | str | Path,
    environment: Environment | str | Path | None = None,
    model: Model | str = "planar",
    **changes: Unpack[ModelChanges],
) -> Plant[Any]:
    """Make the plant of a scenario, which can be stepped.

    Args:
        robot: The scenario, also that of a trial (`Trial.scenario`); or a robot alone, with its
            environment: a `Robot`, the name of a preset, or the path of a file.
        environment: With a robot: where it swims, also by name or path; None:
            `laticauda.scenarios.default_water`.
        model: With a robot: the model or its name.
        changes: With a robot: the model's settings; see `laticauda.scenarios.ModelChanges`.

    Warns:
        ImplausibleWarning: If something of it hardly is, such as a robot that sinks.

    Returns:
        The plant.

    Raises:
        ValueError: If an argument is out of its range, or robot and environment are incompatible.
        MissingExtra: If the model needs a package that is not installed.
    """
    if isinstance(robot, Experiment):
        rule = "must be that of a simulated run to be run again"
        raise BadArgument("scenario", f"{rule}; this one lacks {robot.lacks}")
    if isinstance(robot, Scenario):
        scenario_plant = plant_of_scenario(robot)
        scenarios.check_plausible(robot)
        return scenario_plant
    if isinstance(robot, str | Path):
        robot = load_robot(robot)
    check_instance("robot", robot, Robot)
    surroundings = scenarios.environment_of(environment, robot)
    check_instance("environment", surroundings, Water, Ground)
    stated_changes = {name: value for name, value in changes.items() if value is not None}
    robot_plant = _plant_of_model(
        robot, cast(Environment, surroundings), scenarios.model_of(model, **stated_changes)
    )
    scenarios.check_described(robot, robot_plant.environment)
    return robot_plant


def plant_of_scenario(scenario: Scenario) -> Plant[Any]:
    """Make the plant of a scenario that was judged already, or is one of many between such ones.

    Args:
        scenario: The scenario.

    Raises:
        ValueError: As `build_plant` does.
        MissingExtra: If the model needs a package that is not installed.
    """
    _check_defined(scenario)
    return _plant_of_model(scenario.robot, scenario.environment, scenario.model)


def _check_defined(scenario: Scenario) -> None:
    """Reject a scenario that names a law or a controller that is not defined here."""
    for stand_in in scenarios.unknown_in(scenario):
        rule = f"cannot be run here: its `{stand_in.kind}` is not defined"
        advice = "import the module that defines it, or install its package"
        raise BadArgument("scenario", f"{rule}; {advice}")


def _plant_of_model(robot: Robot, environment: Environment, model: Model) -> Plant[Any]:
    """Make the plant that a model is computed by; its module is imported only now."""
    law_of(environment).check()
    model.joints.check()
    if isinstance(model, Planar):
        from laticauda.models.planar.model import PlanarPlant

        return PlanarPlant(robot=robot, environment=environment, settings=model)
    from laticauda.models.spatial.model import SpatialPlant

    return SpatialPlant(robot=robot, environment=environment, settings=model)


def school_of(
    plant: Plant[Any], command: Command, n: int, interval: float, *, threads: int | None
) -> School[Any]:
    """Make a `School` of many copies of a plant's robot; arguments as for the `School` of its model."""
    if isinstance(plant.settings, Planar):
        from laticauda.models.planar import school
    else:
        from laticauda.models.spatial import school
    return school.School(cast(Any, plant), command, n, interval, threads=threads)


def needs_compiling(
    environment: Environment, model: Model | str | None = None, robot: Robot | None = None
) -> bool:
    """Return whether the first run in this environment will have to compile its kernels, which takes seconds.

    Args:
        environment: The water in which the robot swims, or the ground on which it crawls.
        model: The model or its name; None: planar.
        robot: The robot; None: one without a fin.

    Raises:
        MissingExtra: If the model needs a package that is not installed.
    """
    model = scenarios.model_of(model or "planar")
    if isinstance(model, Spatial):
        from laticauda.compiling.templates import is_kept
        from laticauda.models.spatial.twin import stepping

        load_mujoco()
        return not is_kept(stepping(model.joints).run)
    from laticauda.models.planar.kernel_library import LibraryKernels
    from laticauda.models.planar.model import PlanarPlant

    plant = PlanarPlant(robot=robot or load_robot("mamba"), environment=environment, settings=model)
    kernels = plant.kernels_of(1)
    if isinstance(kernels, LibraryKernels):
        return False
    from laticauda.compiling.templates import is_kept

    return not is_kept(kernels.run)
