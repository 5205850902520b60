"""What texts say of a scenario: names of presets and files. The one place where such names become values."""

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any, Literal, NamedTuple

from laticauda.errors import BadArgument
from laticauda.gaits import Gait
from laticauda.quantities import option, quantity, value
from laticauda.robot import Environment, Parameters, Robot, Water, load_ground, load_parameters, load_robot, load_water
from laticauda.scenarios.building import default_water, model_of
from laticauda.scenarios.models import Model

ORIGINS = {
    "lateral_undulation": "the paper's for lateral undulation",
    "eel_like": "the paper's for eel-like motion",
}


class Chosen(NamedTuple):
    """What names stand for."""

    robot: Robot
    """What swims, with the numbers of the parameters."""
    environment: Environment
    """Where."""
    model: Model
    """By which model."""
    origin: str
    """Where the environment is from, in words."""


@value
class Choice:
    """What swims, where and by which model, in names.

    Raises:
        ValueError: If names are given that do not go together.
    """

    robot: str = option("A preset (`laticauda robots` lists them) or a TOML file", default="mamba")
    n_links: int | None = quantity(
        "", "Number of links to have instead, for robots whose links are all alike", ge=1, default=None
    )
    water: str | None = option("A preset or a TOML file; None: the paper's for the gait", default=None)
    ground: str | None = option("A preset or a TOML file: crawl on land instead", default=None)
    parameters: str | None = option(
        "A preset or a parameter file: its numbers for water, joints, fin and power instead of the paper's and the "
        "robot's (not with a water)",
        default=None,
    )
    model: Literal["planar", "spatial"] = option("The closed form in the plane, or MuJoCo in space", default="planar")
    joints: str | None = option(
        "How the joints follow the gait: prescribed (exactly), pd (the published simulations' law), servo (the real "
        "robot's) or a law of one's own; None: the parameters' law, or prescribed",
        default=None,
    )

    def __post_init__(self) -> None:
        """Refuse what says the same twice."""
        if self.parameters is not None and self.water is not None:
            raise BadArgument("parameters", "must not be given with `water`: both say what the water is")
        for name in ("water", "parameters"):
            if self.ground is not None and getattr(self, name) is not None:
                raise BadArgument(name, "must not be given with `ground`: it belongs to water")

    def resolved(self, gait: Gait, find_robot: Callable[[str, int | None], Robot] = load_robot) -> Chosen:
        """What the names stand for.

        Args:
            gait: It decides on the water, if none is named, and on the parameters' numbers.
            find_robot: From a robot's name and number of links to the robot.

        Raises:
            ValueError: If a name is not known.
            RobotFileError: If a file is wrong.
        """
        robot = find_robot(self.robot, self.n_links)
        parameters = None if self.parameters is None else load_parameters(self.parameters)
        joints = self.joints or (None if parameters is None else parameters.joints) or "prescribed"
        environment, origin = self._environment(gait, parameters)
        if parameters is not None:
            robot = parameters.robot(robot, gait.kind)
        return Chosen(robot, environment, model_of(self.model, joints=joints), origin)

    def _environment(self, gait: Gait, parameters: Parameters | None) -> tuple[Environment, str]:
        if self.ground is not None:
            return load_ground(self.ground), "as asked for"
        if parameters is not None:
            return parameters.water(gait.kind), f"as {self.parameters} says"
        if self.water is not None:
            return load_water(self.water), "as asked for"
        otherwise = f"{ORIGINS['lateral_undulation']}, in want of others for this gait"
        return load_water(default_water(gait)), ORIGINS.get(gait.kind, otherwise)


def named_after(changed: Water, before: Water) -> Water:
    """A water whose name says in what it differs from the one before.

    Args:
        changed: With the same name as the one before, and other numbers.
        before: As it was found.
    """
    listed = ", ".join(f"{name} {_plain(one)}" for name, one in _differences(changed, before).items())
    return replace(changed, name=f"{before.name} with {listed}") if listed else before


def _differences(changed: Any, before: Any) -> Mapping[str, Any]:
    found: dict[str, Any] = {}
    for field in fields(changed):
        new, old = getattr(changed, field.name), getattr(before, field.name, None)
        if new == old:
            continue
        found |= _differences(new, old) if is_dataclass(new) and type(new) is type(old) else {field.name: new}
    return found


def _plain(value: Any) -> str:
    """A field's value as a name shows it."""
    if isinstance(value, tuple):
        return f"({', '.join(map(_plain, value))})"  # pyright: ignore[reportUnknownArgumentType, reportUnknownVariableType]
    if isinstance(value, bool):
        return "on" if value else "off"
    return f"{value:g}" if isinstance(value, float) else str(value)
