"""What the robot moves in or on: `Water` and `Ground`. Both are data; the loads are computed elsewhere."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Literal, TypeAlias, cast

import numpy as np

from laticauda.errors import BadArgument, label, one_of
from laticauda.extensions import Extensible, name_of
from laticauda.fluid.flow import Flow
from laticauda.fluid.laws import DragLaw, PolynomialDrag
from laticauda.quantities import option, quantity, value
from laticauda.robot.robot import Robot

Current: TypeAlias = tuple[float, float] | tuple[float, float, float] | Flow


@value
class Water:
    """Still or moving water, the coefficients of its loads and the form that they take.

    The coefficients hold for every module and the fin, apart from those that bring their own.
    """

    name: str = option("What messages and stored trials call it", default="custom", check=label)
    density: float = quantity("kg/m^3", "rho", gt=0.0, default=1000.0)
    tangential_friction: float = quantity("", "C_f, drag along the body", ge=0.0)
    normal_drag: float = quantity("", "C_D, drag across the body", ge=0.0)
    added_mass: float = quantity("", "C_A, added mass across the body", ge=0.0)
    added_inertia: float = quantity("", "C_M, added moment of inertia; not with `strip`", ge=0.0, default=1.0)
    tangential_added_mass: float = quantity("", "Added per displaced mass, along the body", ge=0.0, default=0.0)
    friction_taper: float = quantity(
        "", "C_f from 1 + taper times it at the tail end to 1 - taper at the head end", ge=-1.0, le=1.0, default=0.0
    )
    drag: DragLaw = option("How the drag depends on the speed: a law with numbers of its own", default=PolynomialDrag())
    added_mass_form: Literal["relative", "kirchhoff", "classic"] = option(
        "`relative`, the paper's; `kirchhoff`, which keeps energy; `classic`, for comparison only", default="relative"
    )
    rotational: Literal["paper", "strip"] = option(
        "Torque of a link: by the `paper`'s coefficients, or by normal loads along it (`strip`)", default="paper"
    )
    trailing_edge: Literal["none", "elongated"] = option(
        "`elongated` adds Lighthill's wake force at the fin's or the tail's end; it needs `kirchhoff`", default="none"
    )
    current: Current = quantity("m/s", "V, velocity of the water in world axes, or a flow", default=(0.0, 0.0))
    depth: float | None = quantity("m", "Axis depth; None: far below, flows as at the surface", gt=0.0, default=None)

    def __post_init__(self) -> None:
        current = self.current if not isinstance(self.current, Flow) else self.current.constant or self.current
        if not isinstance(current, Flow) and current[2:] == (0.0,):
            current = current[:2]
        object.__setattr__(self, "current", current)
        bed = min(getattr(one, "depth", None) or math.inf for one in getattr(current, "flows", (current,)))
        if (self.depth or 0.0) > bed:
            raise BadArgument("depth", f"must be <= {bed:g} m, where the bed of its flow is, got {self.depth:g}")
        if self.trailing_edge == "elongated" and self.added_mass_form != "kirchhoff":
            raise BadArgument(
                "trailing_edge",
                "must be `none` unless `added_mass_form` is `kirchhoff`, the only form that carries the momentum which "
                f"an edge sheds (here it is `{self.added_mass_form}`), got 'elongated'",
            )

    @property
    def flow(self) -> Flow | None:
        """How it moves, if not everywhere and always the same."""
        return self.current if isinstance(self.current, Flow) else None

    @property
    def still(self) -> "Water":
        """The same water without its current."""
        return replace(self, current=(0.0, 0.0))

    @property
    def uniform(self) -> tuple[float, float, float]:
        """Its velocity, if that is everywhere and always the same, else none: a flow has it all [m/s]."""
        x, y, z = (0.0,) * 3 if isinstance(self.current, Flow) else (*self.current, 0.0)[:3]
        return x, y, z

    @property
    def current_words(self) -> str:
        """What its motion is, for people."""
        if isinstance(self.current, Flow):
            return self.current.words
        return f"({', '.join(f'{one:g}' for one in self.current)}) m/s"

    def velocity(self, points: Any, t: Any = 0.0) -> np.ndarray:
        """Velocity of the water at many points.

        Args:
            points: In space, or x and y in the plane, which is at `-depth`, or at the surface; world axes [m].
            t: Since the start of the run, the same for all or one for each [s].

        Returns:
            As many components as the points have [m/s].
        """
        points = np.asarray(points, dtype=float)
        size = points.shape[-1]
        if self.flow is None:
            return np.broadcast_to(self.uniform[:size], points.shape)
        height = np.broadcast_to(-(self.depth or 0.0), (*points.shape[:-1], 3 - size))
        return self.flow.velocity(np.concatenate((points, height), axis=-1), t)[..., :size]


@value
class Ground:
    """Flat ground with anisotropic friction: `viscous`, in proportion to the speed, or dry (`coulomb`)."""

    name: str = option("What messages and stored trials call it", default="custom", check=label)
    friction: DragLaw = option("The law: `viscous` or `coulomb`")
    tangential: float = quantity("", "Coefficient along a link: N s/m, or share of its weight", ge=0.0)
    normal: float = quantity("", "Coefficient across a link, likewise", ge=0.0)
    gravity: float = quantity("m/s^2", "g; `viscous` does not use it", ge=0.0, default=9.81)


Environment: TypeAlias = Water | Ground


@value
class Scene(Extensible, group="scenes"):
    """What is around a robot in space: obstacles, walls, terrain. One's own is a class below this one.

    This one is `open`: nothing but water or flat ground, in which robots meet nothing but each other.

    World axes: z is up, and 0 the height of the ground, or of the water's surface unless it says otherwise.
    """

    called: ClassVar[str] = "open"
    dt: ClassVar[float] = 0.002
    """Step at which contacts with it are resolved [s]."""
    wet: ClassVar[bool] = False
    """Whether it makes no sense without water."""
    level: float = quantity("m", "Height of the water's surface", default=0.0)
    ground: Ground | None = option("How its ground rubs on the robot; left out, as MuJoCo has it", default=None)

    def __call__(self, spec: Any) -> None:
        """Put it into a `mujoco.MjSpec` in which the robots are already."""

    @property
    def terrain(self) -> Any:
        """Its ground, as a `laticauda.mujoco_water.Terrain`; None: it brings none of its own."""
        return None

    def check(self, environment: "Environment") -> None:
        """Raise a ValueError if it cannot be in `environment`.

        Args:
            environment: What the robot is to swim in or crawl on.
        """
        if self.wet and isinstance(environment, Ground):
            word = name_of(type(self))
            raise BadArgument("scene", f"must not be `{word}` without water, got the ground `{environment.name}`")

    @classmethod
    def of(cls, given: "Scene | Callable[[Any], None] | str | None") -> "Scene | None":
        """A scene, which may be `given` by its name, as an MJCF file, or as a function that edits a `mujoco.MjSpec`.

        Args:
            given: The scene, its name, an MJCF file that ends in .xml, or the function; None is none.

        Raises:
            ValueError: If there is none of that name.
        """
        if given is None or isinstance(given, Scene):
            return given
        if isinstance(given, str | Path) and Path(given).suffix == ".xml":
            return cast("Any", cls.named("mjcf"))(file=str(given))
        if callable(given):
            return cast("Any", cls.named("edited"))(edit=given)
        return cls.named(one_of("scene", given, cls.names()))()


def law_of(environment: Environment) -> DragLaw:
    """The law of the loads on one element.

    Args:
        environment: Water or ground.
    """
    return environment.friction if isinstance(environment, Ground) else environment.drag


def check_fits(robot: Robot, environment: Environment) -> None:
    """Refuse a robot and an environment that are both fine but do not go together.

    Args:
        robot: What swims.
        environment: What it swims in.

    Raises:
        ValueError: If the water's depth leaves part of the body or of the fin above the surface.
    """
    if isinstance(environment, Ground) or environment.depth is None:
        return
    highest = max((module.section.half_height, f"modules[{i}]") for i, module in enumerate(robot.modules))
    if robot.caudal_fin is not None:
        highest = max(highest, (0.5 * robot.caudal_fin.height, "caudal_fin"))
    half_height, owner = highest
    if environment.depth <= half_height:
        rule = f"must be > {half_height:g} m, the half height of `{owner}` of robot `{robot.name}`"
        raise BadArgument("depth", f"{rule}, got {environment.depth}")
