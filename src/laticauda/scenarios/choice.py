"""The names with which a command, a file or a message chooses robot, environment and model."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Literal, NamedTuple, Protocol, TypeVar, cast

from laticauda import robot as robots
from laticauda.motion.gaits import Gait
from laticauda.scenarios.building import model_of
from laticauda.scenarios.scenario import Model
from laticauda.scenarios.waters import water_for
from laticauda.values import BadArgument, option, quantity, value_class

ORIGIN_BY_GAIT = {
    "eel_like": "the paper's for eel-like motion",
    "anguilliform": "the paper's for eel-like motion",
    "lateral_undulation": "the paper's for lateral undulation",
}
"""Where Mamba's default water comes from, by the kind of the gait."""
ORIGIN_FOR_OTHER_GAITS = f"{ORIGIN_BY_GAIT['lateral_undulation']}, for lack of others for this gait"

IDENTIFIED_PARAMETERS = {"mamba": "mamba-identified", "mamba-fin": "mamba-identified"}
"""Presets of parameters that were identified on a robot, by the name of the robot."""


def identified_parameters(robot_name: str) -> robots.Parameters | None:
    """Return the parameters that were identified on a robot; None: there are none.

    Args:
        robot_name: Name of the robot.
    """
    name = IDENTIFIED_PARAMETERS.get(robot_name)
    if name is None:
        return None
    return robots.load_parameters(name)


class NamesOfSwimmer(Protocol):
    """Names that say what swims: a `Choice`, or those of a command that has fewer of them."""

    @property
    def robot(self) -> str:
        """Name of the robot."""
        ...

    @property
    def parameters(self) -> str | None:
        """Name of the parameters; None: none."""
        ...


NamesT = TypeVar("NamesT", bound=NamesOfSwimmer)
DECIDING_NAMES = ("water", "ground", "parameters", "joints", "n_links")
"""Names that decide what swims in what: beside one of them, nothing is taken as identified."""


def take_identified_parameters(names: NamesT) -> NamesT:
    """Return names with the parameters that were identified on their robot, where nothing else is chosen.

    A water, a ground, parameters or a joint law that are named stay; so does a robot with another
    number of links than the one that was measured.

    Args:
        names: Names of robot and parameters, in a dataclass; some lack the others that decide.
    """
    if any(getattr(names, name, None) is not None for name in DECIDING_NAMES):
        return names
    changes: Any = {"parameters": IDENTIFIED_PARAMETERS.get(names.robot)}
    return replace(cast(Any, names), **changes)


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
    basis: str
    """What the numbers of the parameters rest on, in sentences; "" if that is not known."""


class _Surroundings(NamedTuple):
    """An environment, and where it comes from, in words."""

    environment: robots.Environment
    origin: str


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
            find_robot: Function that returns the robot for its name and another number of links (None:
                its own). Who has the robot already, such as that of a file, passes a function that
                returns it.

        Raises:
            ValueError: If a name is unknown.
            RobotFileError: If a file is wrong.
        """
        robot = find_robot(self.robot, self.n_links)
        parameters: robots.Parameters | None = None
        if self.parameters is not None:
            parameters = robots.load_parameters(self.parameters)
        environment, origin = self._surroundings(robot, gait, parameters)
        settings: dict[str, Any] = {"joints": self._joint_law(parameters)}
        if self.scene is not None:
            settings["scene"] = self.scene
        basis = ""
        if parameters is not None:
            robot = parameters.robot(robot, gait.kind)
            basis = parameters.basis
        return Chosen(
            robot=robot,
            environment=environment,
            model=model_of(self.model, **settings),
            origin=origin,
            basis=basis,
        )

    def _joint_law(self, parameters: robots.Parameters | None) -> Any:
        """Return the name of the joint law, or the law of the parameters."""
        if self.joints:
            return self.joints
        if parameters is not None and parameters.joints:
            return parameters.joints
        return "prescribed"

    def _surroundings(
        self, robot: robots.Robot, gait: Gait, parameters: robots.Parameters | None
    ) -> _Surroundings:
        if self.ground is not None:
            return _Surroundings(robots.load_ground(self.ground), "as requested")
        if parameters is not None:
            return _Surroundings(parameters.water(gait.kind), f"as {self.parameters} says")
        water = water_for(robot, self.water, gait)
        if water.name == robots.TEXTBOOK:
            return _Surroundings(water, "from tables, for this robot's shape; nothing fitted")
        if self.water is not None:
            return _Surroundings(water, "as requested")
        return _Surroundings(water, ORIGIN_BY_GAIT.get(gait.kind, ORIGIN_FOR_OTHER_GAITS))
