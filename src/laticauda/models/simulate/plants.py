"""Conversion of scenarios to plants; this is the only place where it happens."""

import functools
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Unpack, cast

from laticauda.models.dynamics.plant import Plant
from laticauda.models.dynamics.school import School
from laticauda.robot import Environment, Ground, Robot, Water, law_of, load_robot
from laticauda.scenarios import (
    Command,
    Experiment,
    Model,
    ModelChanges,
    Planar,
    Scenario,
    Spatial,
    check_described,
    check_plausible,
    environment_of,
    model_of,
    unknown_in,
)
from laticauda.values import BadArgument, check_instance, load_mujoco

MOST_KEPT_PLANTS = 8
"""Plants that are kept for later runs of the same robot, at most."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PlantDescription:
    """What a plant is made from. Two descriptions are the same if they hold the same objects.

    Values never change, and comparing those of a robot would take as long as a short run.
    """

    robot: Robot
    environment: Environment
    model: Model

    @classmethod
    def of(cls, scenario: Scenario) -> "PlantDescription":
        """Return the description of a scenario's plant.

        Args:
            scenario: The scenario.
        """
        return cls(robot=scenario.robot, environment=scenario.environment, model=scenario.model)

    def __eq__(self, description: object) -> bool:
        """Return whether another description holds the same objects."""
        return (
            isinstance(description, PlantDescription)
            and self.robot is description.robot
            and self.environment is description.environment
            and self.model is description.model
        )

    def __hash__(self) -> int:
        """Return a number that follows from the identities."""
        return hash((id(self.robot), id(self.environment), id(self.model)))


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
        check_plausible(robot)
        return scenario_plant
    if isinstance(robot, str | Path):
        robot = load_robot(robot)
    check_instance("robot", robot, Robot)
    surroundings = environment_of(environment, robot)
    check_instance("environment", surroundings, Water, Ground)
    stated_changes = {name: value for name, value in changes.items() if value is not None}
    description = PlantDescription(
        robot=robot,
        environment=cast(Environment, surroundings),
        model=model_of(model, **stated_changes),
    )
    robot_plant = _plant_of_description(description)
    check_described(robot, robot_plant.environment)
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
    return _plant_of_description(PlantDescription.of(scenario))


def _check_defined(scenario: Scenario) -> None:
    """Reject a scenario that names a law or a controller that is not defined here."""
    for stand_in in unknown_in(scenario):
        rule = f"cannot be run here: its `{stand_in.kind}` is not defined"
        advice = "import the module that defines it, or install its package"
        raise BadArgument("scenario", f"{rule}; {advice}")


def _plant_of_description(description: PlantDescription) -> Plant[Any]:
    """Return the plant that a model is computed by, which may be that of an earlier run."""
    law_of(description.environment).check()
    description.model.joints.check()
    if _is_worth_keeping(description):
        return kept_plant(description)
    return _make_plant(description)


def _is_worth_keeping(description: PlantDescription) -> bool:
    """Return whether the plant of a description is always the same, and small.

    In space, it holds the state of MuJoCo. A law of the user's own may depend on what changes
    between two runs. Flowing water may have been measured at millions of points.
    """
    if not isinstance(description.model, Planar):
        return False
    formulas = [law_of(description.environment).formula]
    if description.model.joints.own is not None:
        formulas.append(description.model.joints.own)
    is_still = getattr(description.environment, "flow", None) is None
    return is_still and all(formula.is_own for formula in formulas)


def _make_plant(description: PlantDescription) -> Plant[Any]:
    """Make the plant that a model is computed by; its module is imported only now."""
    if isinstance(description.model, Planar):
        from laticauda.models.planar.model import PlanarPlant

        return PlanarPlant(
            robot=description.robot, environment=description.environment, settings=description.model
        )
    from laticauda.models.spatial.model import SpatialPlant

    return SpatialPlant(
        robot=description.robot, environment=description.environment, settings=description.model
    )


kept_plant = functools.lru_cache(maxsize=MOST_KEPT_PLANTS)(_make_plant)
"""Does the same, and keeps the plants that were last asked for."""


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
    model = model_of(model or "planar")
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
