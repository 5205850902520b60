"""The only place where names become plants."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeAlias

from laticauda.errors import instance, one_of
from laticauda.interfaces import Plant
from laticauda.robot import Environment, Ground, Robot, Water
from laticauda.robot.files import from_toml
from laticauda.trial import Trial

FluidLaw: TypeAlias = Callable[..., tuple[float, float, float]]
MODELS = ("planar", "spatial")
ROOTS = ("free", "planar")


def plant(
    robot: Robot,
    environment: Environment,
    *,
    model: str = "planar",
    joints: str = "prescribed",
    dt: float | None = None,
    offset_bandwidth: float = 10.0,
    ramp: float | None = None,
    fluid_law: FluidLaw | None = None,
    root: str | None = None,
    gravity: bool | None = None,
    shore: Ground | None = None,
) -> Plant[Any]:
    """A robot in its environment as something that can be stepped.

    Args:
        robot: What swims.
        environment: The water it swims in or the ground it crawls on.
        model: planar (closed form), or spatial (MuJoCo; it needs the extra `spatial`).
        joints: How the joints follow the gait: prescribed (exactly), pd (the published simulations' law) or servo
            (the real robot's).
        dt: Largest time step [s]; None takes a converged one.
        offset_bandwidth: Of the reference generator's filters [rad/s].
        ramp: Duration of the smooth start [s]; None takes 1 s for prescribed joints and none for the others.
        fluid_law: Loads on one element, with the signature of `laticauda.fluid.laws.polynomial_drag`; None takes the
            environment's own.
        root: Spatial only: `free`, or `planar` for a tail module whose height and tilt are fixed. None: `planar` for a
            robot whose joints all turn about the vertical axis, else `free`.
        gravity: Spatial only: whether there is weight and buoyancy; None: yes. They do nothing to a planar root.
        shore: Spatial only: the ground of a shore on which the robot begins, and which leads down into the water.

    Returns:
        The plant.

    Raises:
        ValueError: If an argument is out of its range, or robot and environment do not fit together.
        MissingExtra: If the model needs a package that is not installed.
    """
    instance("robot", robot, Robot)
    instance("environment", environment, Water, Ground)
    one_of("model", model, MODELS)
    if model == "planar":
        for name, value in (("root", root), ("gravity", gravity), ("shore", shore)):
            if value is not None:
                raise ValueError(f"`{name}` must be left out unless `model` is `spatial`, got {value!r}.")
    from laticauda.planar.model import PlanarPlant
    from laticauda.planar.specialize import check_law

    if fluid_law is not None:
        check_law(fluid_law)
    settings: dict[str, Any] = {
        "robot": robot,
        "environment": environment,
        "joints": joints,
        "dt": dt,
        "offset_bandwidth": offset_bandwidth,
        "ramp": ramp,
        "fluid_law": fluid_law,
    }
    if model == "planar":
        return PlanarPlant(**settings)
    from laticauda.spatial.model import SpatialPlant

    if root is None:
        root = "free" if any(joint.axis == "pitch" for joint in robot.joints) else "planar"
    settings |= {"root": one_of("root", root, ROOTS), "gravity": gravity is None or bool(gravity), "shore": shore}
    return SpatialPlant(**settings)


def plant_of(trial: Trial) -> Plant[Any]:
    """The plant that a trial was made with, to go on with it.

    Args:
        trial: A simulated trial.

    Raises:
        ValueError: If it was made with a fluid law of one's own, which a trial does not hold.
    """
    settings: Any = trial.settings
    if settings.get("fluid_law", "built-in") != "built-in":
        raise ValueError(f"`trial` must be a trial with a built-in fluid law, got one with {settings['fluid_law']}.")
    names = ("model", "joints", "dt", "offset_bandwidth", "ramp", "root", "gravity")
    shore = from_toml(settings["shore"], Ground) if "shore" in settings else None
    chosen = {name: settings[name] for name in names if name in settings}
    body: Any = plant(trial.robot, trial.environment, **chosen, shore=shore)
    rest = {name: settings[name] for name in ("ballast_depth", "tank") if name in settings}
    return replace(body, **rest) if rest else body


def needs_compiling(environment: Environment, *, fluid_law: FluidLaw | None = None, model: str | None = None) -> bool:
    """Whether the first run in this environment will have to compile its kernels, which takes seconds.

    Args:
        environment: The water it swims in or the ground it crawls on.
        fluid_law: As for `plant`.
        model: As for `plant`; None: planar.

    Raises:
        MissingExtra: If the model needs a package that is not installed.
    """
    if model == "spatial":
        from laticauda.extras import load_mujoco
        from laticauda.spatial.stepping import is_compiled as is_spatial_compiled

        load_mujoco()
        return not is_spatial_compiled()
    from laticauda.planar.model import law_of
    from laticauda.planar.specialize import is_compiled

    return not is_compiled(fluid_law=law_of(environment, fluid_law))
