"""Environment in or on which a robot moves: `Water` and `Ground`. Both are data; the loads are computed elsewhere."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Literal, TypeAlias

import numpy as np

from laticauda.robot.robot import Robot
from laticauda.robot.silhouettes import fin_plate
from laticauda.values import (
    BadArgument,
    Extensible,
    check_choice,
    check_label,
    name_of,
    option,
    quantity,
    value_class,
)
from laticauda.water.fluid import DragLaw, Flow, PolynomialDrag
from laticauda.water.fluid.edges import SLENDER, plate_functions

Current: TypeAlias = tuple[float, float] | tuple[float, float, float] | Flow


@value_class
class Water:
    """Still or moving water, with the coefficients and the form of its loads.

    The coefficients apply to every module and to the fin, except those with coefficients of their
    own.
    """

    name: str = option(
        "Name used in messages and stored trials", default="custom", check=check_label
    )
    density: float = quantity("kg/m^3", "rho", gt=0.0, default=1000.0)
    tangential_friction: float = quantity("", "C_f, drag along the body", ge=0.0)
    normal_drag: float = quantity("", "C_D, drag across the body", ge=0.0)
    added_mass: float = quantity("", "C_A, added mass across the body", ge=0.0)
    added_inertia: float = quantity(
        "", "C_M, added moment of inertia; unused with `strip`", ge=0.0, default=1.0
    )
    tangential_added_mass: float = quantity(
        "", "Added mass along the body per displaced mass", ge=0.0, default=0.0
    )
    plate_drag: float | None = quantity(
        "",
        "C_D of fins and flat modules over that of plates of their proportions; None: they have `normal_drag`",
        ge=0.0,
        default=None,
    )
    plate_added_mass: float | None = quantity(
        "",
        "C_A of fins and flat modules over that of plates of their proportions; None: they have `added_mass`",
        ge=0.0,
        default=None,
    )
    friction_taper: float = quantity(
        "",
        "C_f is 1 + taper times as large at the tail end, 1 - taper at the head end",
        ge=-1.0,
        le=1.0,
        default=0.0,
    )
    drag: DragLaw = option(
        "Drag as a function of speed: a law with its own parameters", default=PolynomialDrag()
    )
    added_mass_form: Literal["relative", "kirchhoff", "classic"] = option(
        "`relative`: as in the paper; `kirchhoff`: conserves energy; `classic`: for comparison only",
        default="relative",
    )
    rotational: Literal["paper", "strip"] = option(
        "Torque on a link: from the `paper`'s coefficients, or from normal loads along it (`strip`)",
        default="paper",
    )
    trailing_edge: Literal["none", "elongated", "finite-span"] = option(
        "`elongated` adds Lighthill's wake force at the end of the fin or tail, `finite-span` that of a "
        "fin of any shape with its added mass; both require `kirchhoff`",
        default="none",
    )
    edge_clip: float | None = quantity(
        "",
        "A0, most of the suction of a `finite-span` fin, beyond which its flow separates; None: it never does",
        gt=0.0,
        le=1.0,
        default=None,
    )
    current: Current = quantity(
        "m/s", "V, velocity of the water in world axes, or a flow", default=(0.0, 0.0)
    )
    depth: float | None = quantity(
        "m", "Depth of the axis; None: deep, flows as at the surface", gt=0.0, default=None
    )

    def __post_init__(self) -> None:
        object.__setattr__(self, "current", _simplest(self.current))
        flows = getattr(self.current, "flows", (self.current,))
        bed = min(getattr(flow, "depth", None) or math.inf for flow in flows)
        if (self.depth or 0.0) > bed:
            raise BadArgument(
                "depth", f"must be <= {bed:g} m, the bed depth of its flow, got {self.depth:g}"
            )
        if self.edge_clip is not None and self.trailing_edge != "finite-span":
            raise BadArgument(
                "edge_clip",
                "must be None unless `trailing_edge` is `finite-span`, whose suction it limits "
                f"(here it is `{self.trailing_edge}`), got {self.edge_clip}",
            )
        if self.trailing_edge != "none" and self.added_mass_form != "kirchhoff":
            raise BadArgument(
                "trailing_edge",
                "must be `none` unless `added_mass_form` is `kirchhoff`, the only form that includes "
                "the momentum that an edge sheds "
                f"(here it is `{self.added_mass_form}`), got '{self.trailing_edge}'",
            )

    @property
    def flow(self) -> Flow | None:
        """Flow of the water; None if its velocity is uniform and constant."""
        return self.current if isinstance(self.current, Flow) else None

    @property
    def still(self) -> "Water":
        """The same water without its current."""
        return replace(self, current=(0.0, 0.0))

    @property
    def is_still(self) -> bool:
        """Whether the water does not move: no flow, and no current."""
        return self.flow is None and not any(self.uniform)

    @property
    def uniform(self) -> tuple[float, float, float]:
        """Velocity of the water if it is uniform and constant; 0 if a flow describes the motion [m/s]."""
        if isinstance(self.current, Flow):
            return 0.0, 0.0, 0.0
        if len(self.current) == 2:
            return (*self.current, 0.0)
        return self.current

    @property
    def current_words(self) -> str:
        """Motion of the water in words."""
        if isinstance(self.current, Flow):
            return self.current.words
        components = ", ".join(f"{component:g}" for component in self.current)
        return f"({components}) m/s"

    def velocity(self, points: Any, t: Any = 0.0) -> np.ndarray:
        """Return the velocity of the water at many points.

        Args:
            points: Points in space, or x and y in the plane at height `-depth`, or at the surface;
                world axes [m].
            t: Time since the start of the run, one for all points or one for each [s].

        Returns:
            Velocities with as many components as the points [m/s].
        """
        points = np.asarray(points, dtype=float)
        size = points.shape[-1]
        if self.flow is None:
            return np.broadcast_to(self.uniform[:size], points.shape)
        height = np.broadcast_to(-(self.depth or 0.0), (*points.shape[:-1], 3 - size))
        return self.flow.velocity(np.concatenate((points, height), axis=-1), t)[..., :size]


def _simplest(current: Current) -> Current:
    """Return the simplest current that is the same: of a uniform flow its velocity, without a height of 0."""
    if isinstance(current, Flow):
        current = current.constant or current
    if not isinstance(current, Flow) and current[2:] == (0.0,):
        return current[0], current[1]
    return current


@value_class
class Ground:
    """Flat ground with anisotropic friction: `viscous`, proportional to the speed, or dry (`coulomb`)."""

    name: str = option(
        "Name used in messages and stored trials", default="custom", check=check_label
    )
    friction: DragLaw = option("Friction law: `viscous` or `coulomb`")
    tangential: float = quantity(
        "", "Coefficient along a link: N s/m, or fraction of its weight", ge=0.0
    )
    normal: float = quantity("", "Coefficient across a link, likewise", ge=0.0)
    gravity: float = quantity("m/s^2", "g; not used by `viscous`", ge=0.0, default=9.81)


Environment: TypeAlias = Water | Ground


@value_class
class Scene(Extensible, group="scenes"):
    """Surroundings of a robot in space: obstacles, walls, terrain. Custom scenes subclass this class.

    This class is the `open` scene: only water or flat ground, where robots can touch only each
    other.

    World axes: z is up, and 0 is the height of the ground or, unless `level` says otherwise, of the
    water's surface.
    """

    called: ClassVar[str] = "open"
    dt: ClassVar[float] = 0.002
    """Time step at which contacts with the scene are resolved [s]."""
    wet: ClassVar[bool] = False
    """Whether the scene requires water."""
    level: float = quantity("m", "Height of the water's surface", default=0.0)
    ground: Ground | None = option(
        "Friction of its ground on the robot; MuJoCo's if omitted", default=None
    )

    def __call__(self, spec: Any) -> None:
        """Add the scene to a `mujoco.MjSpec` that already contains the robots."""

    @property
    def terrain(self) -> Any:
        """Ground of the scene, as a `laticauda.water.mujoco.Terrain`; None if it has no ground of its own."""
        return None

    def check(self, environment: "Environment") -> None:
        """Raise a ValueError if the scene does not go with `environment`.

        Args:
            environment: Environment in which the robot swims or on which it crawls.
        """
        if self.wet and isinstance(environment, Ground):
            raise BadArgument(
                "scene",
                f"must not be `{name_of(type(self))}` without water, "
                f"got the ground `{environment.name}`",
            )

    @classmethod
    def of(cls, scene: "Scene | Callable[[Any], None] | str | None") -> "Scene | None":
        """Return a scene from its name, an MJCF file, or a function that edits a `mujoco.MjSpec`.

        Args:
            scene: The scene, its name, an MJCF file that ends in .xml, or the function; None for no
                scene.

        Raises:
            ValueError: If there is no scene of that name.
        """
        if scene is None or isinstance(scene, Scene):
            return scene
        if isinstance(scene, str | Path) and Path(scene).suffix == ".xml":
            mjcf_scene: Any = cls.named("mjcf")
            return mjcf_scene(file=str(scene))
        if callable(scene):
            edited_scene: Any = cls.named("edited")
            return edited_scene(edit=scene)
        return cls.named(check_choice("scene", scene, cls.names()))()


def law_of(environment: Environment) -> DragLaw:
    """Return the law of the loads on one element.

    Args:
        environment: Water or ground.
    """
    if isinstance(environment, Ground):
        return environment.friction
    return environment.drag


def check_fits(robot: Robot, environment: Environment) -> None:
    """Reject a robot and an environment that are each valid but do not go together.

    Args:
        robot: Robot that swims.
        environment: Environment in which it swims.

    Raises:
        ValueError: If the water's depth leaves part of the body or of the fin above the surface, or
            if its law of the trailing edge does not hold for the robot.
    """
    if isinstance(environment, Ground):
        return
    fin = robot.caudal_fin
    if fin is not None and fin.silhouette is not None and environment.trailing_edge == "elongated":
        raise BadArgument(
            "trailing_edge",
            "must be `finite-span` or `none` for a fin with a `silhouette`, got 'elongated'",
        )
    if environment.trailing_edge == "finite-span":
        refusal = finite_span_refusal(robot)
        if refusal is not None:
            raise refusal
        _check_clip(robot, environment)
    if environment.depth is None:
        return
    half_heights = {
        f"modules[{i}]": module.section.half_height for i, module in enumerate(robot.modules)
    }
    if robot.caudal_fin is not None:
        half_heights["caudal_fin"] = 0.5 * robot.caudal_fin.height
    half_height, part = max((value, name) for name, value in half_heights.items())
    if environment.depth <= half_height:
        raise BadArgument(
            "depth",
            f"must be > {half_height:g} m, the half height of `{part}` of robot `{robot.name}`, "
            f"got {environment.depth}",
        )


def _check_clip(robot: Robot, water: Water) -> None:
    """Reject a limit of the suction of a leading edge for a body, or a slender fin, that has none of its own."""
    if water.edge_clip is None:
        return
    plate = fin_plate(robot)
    if plate is None or plate.lift >= SLENDER:
        raise BadArgument(
            "edge_clip",
            f"must be None for robot `{robot.name}`, whose trailing edge ends a slender body: no flow "
            f"separates at a leading edge there, got {water.edge_clip}",
        )


def finite_span_refusal(robot: Robot) -> BadArgument | None:
    """Return why `finite-span` does not hold for a robot: its edge ends no rigid plate and no slender body.

    Args:
        robot: The robot.

    Returns:
        The error of who names this law for the robot; None if it holds.
    """
    fin = robot.caudal_fin
    if fin is not None and fin.hinges:
        return BadArgument(
            "trailing_edge",
            "must be `elongated` or `none` for a fin that bends "
            f"(`caudal_fin.n_hinges` is {fin.n_hinges}), because the law of a finite span is that of a "
            "rigid plate, got 'finite-span'",
        )
    aspect = 2.0 * robot.modules[0].section.half_height / robot.length
    if fin is None and plate_functions(aspect).lift < SLENDER:
        return BadArgument(
            "trailing_edge",
            "must be `elongated` or `none` for a body without a fin that is not slender "
            f"(its height is {aspect:.2g} times its length), got 'finite-span'",
        )
    return None
