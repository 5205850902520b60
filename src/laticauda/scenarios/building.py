"""Scenarios in short form: a robot, a gait and deviations from the defaults; names of presets and files."""

import functools
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeAlias, TypedDict, Unpack, cast

from laticauda import robot as robots
from laticauda.motion.gaits import EelLike, Gait
from laticauda.motion.joints.laws import JointLaw
from laticauda.robot.files import find
from laticauda.scenarios.interfaces import Controller, Start
from laticauda.scenarios.scenario import MODELS, Model, Scenario, Spatial
from laticauda.values import extensions
from laticauda.values.checks import check_choice, check_instance, suggest_nearest
from laticauda.values.errors import BadArgument
from laticauda.values.formulas import Law
from laticauda.values.quantities import option, quantity, value_class

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


class Changes(ModelChanges, total=False):
    """Settings of a scenario that may differ from its defaults: its fields and those of its model, see `ModelChanges`.

    An environment or a current may be given by preset name or path, a model as ``"planar"`` or
    ``"spatial"``. The default environment is `default_water` of robot and gait; a current replaces
    that of the water.
    """

    environment: robots.Environment | str | Path | None
    current: robots.Current | str | None
    model: Model | str
    start: Start | None
    sample_interval: float


def build_scenario(
    robot: robots.Robot | str | Path,
    motion: Motion,
    duration: float = 30.0,
    **changes: Unpack[Changes],
) -> Scenario:
    """Make a scenario from a robot, a motion and deviations from the defaults.

    Args:
        robot: The robot, the name of a preset, or the path of a file.
        motion: The gait, or the controller.
        duration: Duration of the run [s].
        changes: Other deviations from the defaults: `environment`, `current`, `model`, `start`,
            `sample_interval` [s],
            or settings of the model: `joints`, `dt` [s] and the other fields of
                `laticauda.scenarios.ModelChanges`.

    Raises:
        ValueError: If an argument is out of its range, or arguments are incompatible.

    Example:
        >>> import laticauda as lc
        >>> gait = lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> build_scenario("mamba", gait, joints="servo", environment="paper-lateral").environment.name
        'paper-lateral'
    """
    given = {name: one for name, one in changes.items() if one is not None}
    own: dict[str, Any] = {
        name: given.pop(name) for name in ("start", "sample_interval") if name in given
    }
    environment, kind = given.pop("environment", None), cast(Any, given.pop("model", "planar"))
    moving = {"current": robots.current_of(given.pop("current"))} if "current" in given else {}
    check_instance("gait", motion, Gait, Controller)
    gait = motion if isinstance(motion, Gait) else motion.gait
    body = robots.load_robot(robot) if isinstance(robot, str | Path) else robot
    where = environment_of(environment, body, gait)
    if moving and not isinstance(where, robots.Water):
        raise BadArgument("current", "must be given only with a Water, which can move")
    return Scenario(
        robot=body,
        motion=motion,
        environment=replace(where, **moving) if moving else where,
        model=model_of(kind, **given),
        duration=duration,
        **own,
    )


def model_of(model: Model | str, **changes: Any) -> Model:
    """Return a model with changed settings.

    Args:
        model: The model, or its name.
        changes: New values of its fields; ``joints`` may be a name.

    Raises:
        ValueError: If there is no such model, or a field is out of its range.
        TypeError: If no model has such a field.
    """
    if not isinstance(model, str):
        check_instance("model", model, *MODELS.values())
    base = (
        MODELS[check_choice("model", model, tuple(MODELS))]() if isinstance(model, str) else model
    )
    known = [field.name for field in fields(base)]
    for name, given in changes.items():
        if name in known:
            continue
        if name in {field.name for field in fields(Spatial)}:
            raise BadArgument(name, f"must be left out unless `model` is `spatial`, got {given!r}")
        raise TypeError(
            f"There is no argument `{name}`{suggest_nearest(name, [*Changes.__annotations__])}."
        )
    if "joints" in changes:
        changes["joints"] = JointLaw.of(changes["joints"])
    return replace(base, **changes) if changes else base


def default_water(robot: robots.Robot, gait: Gait | None = None) -> robots.Water:
    """Return the default water: the textbook's for the robot's shape, or for Mamba the paper's for the gait.

    Args:
        robot: The robot; it is Mamba if its name is one of `MAMBA`.
        gait: Gait of its joints; the paper identified coefficients for each kind, and None selects
            those of lateral undulation.
    """
    check_instance("robot", robot, robots.Robot)
    if robot.name not in MAMBA:
        return robots.textbook_of(robot)
    return preset_water(
        "paper-eel" if gait is not None and isinstance(gait.envelope, EelLike) else "paper-lateral"
    )


def water_for(robot: robots.Robot, name: str | None, gait: Gait | None = None) -> robots.Water:
    """Return the water of a given name, or the default water.

    Args:
        robot: The robot.
        name: Name of a preset or a file, or ``textbook``; None: `default_water`.
        gait: Gait of its joints, which selects the coefficients of Mamba's default water; None:
            lateral undulation.

    Raises:
        RobotFileError: If there is no water of that name, or its file is wrong.
    """
    return default_water(robot, gait) if name is None else robots.load_water(name, robot)


preset_water = functools.cache(robots.load_water)


def environment_of(given: object, robot: robots.Robot, gait: Gait | None = None) -> Any:
    """Load a water or ground by name or path; anything else is returned unchanged, for others to check.

    Args:
        given: The environment as the caller gives it; None: `default_water`.
        robot: The robot that is to be in it.
        gait: Gait of its joints, for `default_water`.
    """
    if not isinstance(given, str | Path):
        return default_water(robot, gait) if given is None else given
    if str(given) in robots.ground_names():
        return robots.load_ground(given)
    return (
        robots.load_water(given, robot)
        if str(given) in (*robots.water_names(), robots.TEXTBOOK)
        else robots.from_toml(find(given, "water"))
    )


MAMBA = ("mamba", "mamba-fin", "mamba-modules", "mamba-modules-fin")
"""The robots whose trials were used to identify the paper's waters."""
ORIGINS: dict[str, str] = dict.fromkeys(
    ("eel_like", "anguilliform"), "the paper's for eel-like motion"
)
ORIGINS["lateral_undulation"] = "the paper's for lateral undulation"


class Chosen(NamedTuple):
    """Resolved values of the names in a `Choice`."""

    robot: robots.Robot
    """The robot, with the numbers of the parameters."""
    environment: robots.Environment
    """The environment."""
    model: Model
    """The model."""
    origin: str
    """Origin of the environment, in words."""


@value_class
class Choice:
    """Choice of robot, environment and model, by name.

    The numbers for water, joints, fin and power in a parameter file replace those of the paper and
    the robot. Its joint law is used if `joints` is omitted; without one, joints are prescribed.
    `pd` is the law of the published simulations, `servo` that of the real robot, `speed-servo` one
    that controls its speed.

    Raises:
        ValueError: If incompatible names are given.
    """

    robot: str = option("A preset (`laticauda robots` lists them) or a TOML file", default="mamba")
    n_links: int | None = quantity(
        "", "Another number of links, if all links are alike", ge=1, default=None
    )
    water: str | None = option(
        "A preset, a TOML file or textbook; None: see `default_water`", default=None
    )
    ground: str | None = option("A preset or a TOML file: crawl on land instead", default=None)
    parameters: str | None = option(
        "A preset or a parameter file: its numbers for water, joints, fin and power instead of the paper's and the "
        "robot's (not with a water)",
        default=None,
    )
    model: Literal["planar", "spatial"] = option(
        "The closed form in the plane, or MuJoCo in space", default="planar"
    )
    joints: str | None = option(
        "How the joints follow the gait: prescribed (exactly), pd (the published simulations' law), servo (the real "
        "robot's), speed-servo (with speed control) or a law of your own; if omitted, the parameters' or prescribed",
        default=None,
    )
    scene: str | None = option(
        "Surroundings in space, e.g. pegs, slope, pipe, shore, tank, MJCF file", default=None
    )

    def __post_init__(self) -> None:
        """Reject options that specify the same thing twice."""
        if self.parameters is not None and self.water is not None:
            raise BadArgument("parameters", "must not be given with `water`: both define the water")
        for name in ("water", "parameters"):
            if self.ground is not None and getattr(self, name) is not None:
                raise BadArgument(name, "must not be given with `ground`: it applies to water only")

    def resolved(
        self, gait: Gait, find_robot: Callable[[str, int | None], robots.Robot] = robots.load_robot
    ) -> Chosen:
        """Resolve the names.

        Args:
            gait: Determines the water, if none is named, and the numbers of the parameters.
            find_robot: Function that returns the robot for a name and a number of links.

        Raises:
            ValueError: If a name is unknown.
            RobotFileError: If a file is wrong.
        """
        robot = find_robot(self.robot, self.n_links)
        parameters = None if self.parameters is None else robots.load_parameters(self.parameters)
        joints = self.joints or (None if parameters is None else parameters.joints) or "prescribed"
        environment, origin = self._environment(robot, gait, parameters)
        if parameters is not None:
            robot = parameters.robot(robot, gait.kind)
        scene = {} if self.scene is None else {"scene": self.scene}
        return Chosen(robot, environment, model_of(self.model, joints=joints, **scene), origin)

    def _environment(
        self, robot: robots.Robot, gait: Gait, parameters: robots.Parameters | None
    ) -> tuple[robots.Environment, str]:
        if self.ground is not None:
            return robots.load_ground(self.ground), "as requested"
        if parameters is not None:
            return parameters.water(gait.kind), f"as {self.parameters} says"
        water = water_for(robot, self.water, gait)
        if water.name == robots.TEXTBOOK:
            return water, "from tables, for this robot's shape; nothing fitted"
        otherwise = f"{ORIGINS['lateral_undulation']}, for lack of others for this gait"
        return water, ORIGINS.get(gait.kind, otherwise) if self.water is None else "as requested"


def named_after(changed: robots.Water, before: robots.Water) -> robots.Water:
    """Return a water whose name states how it differs from an earlier one.

    Args:
        changed: The changed water, with the same name as the earlier one.
        before: The earlier water.
    """
    listed = ", ".join(
        f"{name} {_plain(one)}" for name, one in _differences(changed, before).items()
    )
    return replace(changed, name=f"{before.name} with {listed}") if listed else before


def _differences(changed: Any, before: Any) -> Mapping[str, Any]:
    found: dict[str, Any] = {}
    for field in fields(changed):
        new, old = getattr(changed, field.name), getattr(before, field.name, None)
        if new == old:
            continue
        found |= (
            _differences(new, old)
            if is_dataclass(new) and type(new) is type(old)
            else {field.name: new}
        )
    return found


def _plain(value: Any) -> str:
    """Return a field's value as it is shown in a name."""
    if isinstance(value, Law):
        return extensions.name_of(type(value))
    if isinstance(value, tuple):
        return f"({', '.join(map(_plain, value))})"  # pyright: ignore[reportUnknownArgumentType, reportUnknownVariableType]
    if isinstance(value, bool):
        return "on" if value else "off"
    return f"{value:g}" if isinstance(value, float) else str(value)
