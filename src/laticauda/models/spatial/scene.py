"""Surroundings of the robot: the scenes provided by the package, and how a scene is added to a model.

A scene is a value (`laticauda.robot.Scene`) that edits a MuJoCo model. The robot touches its
objects through MuJoCo's contacts. Only the ground acts on the robot's elements instead
(`laticauda.water.mujoco.ground`) where a `Ground`, that of the scene or the environment, defines
the friction along and across the robot. The ground of a scene consists of its geoms with the names
in `GROUNDS`.
"""

import math
from collections.abc import Callable, Collection, Generator
from contextlib import contextmanager
from typing import Any, ClassVar

import numpy as np

from laticauda.models.spatial.bodies import Three
from laticauda.robot import Environment, Ground, Scene
from laticauda.values import BadArgument, load_mujoco, option, quantity, value_class
from laticauda.water.fluid import CoulombFriction
from laticauda.water.mujoco import Terrain

Quaternion = tuple[float, float, float, float]

# Size of the tank in Trondheim in which the paper's robot swam [m].
TANK_LENGTH, TANK_WIDTH, TANK_DEPTH = 40.0, 6.45, 1.5
WALL = 0.1  # half thickness [m]
DEEPEST = 2e-3  # maximum initial penetration of a robot [m]
THICK = 0.2  # half thickness of the ground's boxes [m]
FAR = 12.0  # length of ground that is not bounded otherwise [m]
STAVES = 24  # number of staves of a pipe
SURFACE = "water"  # visual only
GROUNDS = ("ground", "shore", "ramp", "floor", "terrain")
SKIN = Ground(
    name="skin", friction=CoulombFriction(regularization_speed=1e-2), tangential=0.1, normal=0.5
)
# Red, green, blue and opacity, by prefix of the name.
COLORS = {
    "water": (0.30, 0.65, 0.75, 0.22),
    "wall": (0.80, 0.88, 0.90, 0.25),
    "peg": (0.85, 0.78, 0.35, 1.0),
}
SAND = (0.66, 0.60, 0.48, 1.0)


@value_class
class Pegs(Scene):
    """A field of upright pegs in rows along x, with a passage for a straight robot between the two middle rows."""

    spacing: float = quantity("m", "Distance between pegs along a row", gt=0.0, default=0.5)
    gap: float = quantity("m", "Distance between rows", gt=0.0, default=0.35)
    stagger: float = quantity("m", "Shift of every other row", default=0.0)
    radius: float = quantity("m", "Radius of a peg", gt=0.0, default=0.04)
    rows: int = quantity("", "Number of rows, both sides together", ge=1, default=4)
    field: tuple[float, float] = quantity(
        "m", "Range along x in which they stand", default=(-2.0, 6.0)
    )
    slip: float = quantity("", "Friction coefficient of the pegs in MuJoCo", ge=0.0, default=0.05)

    def __call__(self, spec: Any) -> None:
        """See `Scene`."""
        first, last = self.field
        for row in range(self.rows):
            y = (row + 0.5 - 0.5 * self.rows) * self.gap
            for k, x in enumerate(np.arange(first + self.stagger * (row % 2), last, self.spacing)):
                size = (self.radius, 0.5 * TANK_DEPTH + 0.25, 0.0)
                peg = solid(spec, f"peg_{row}_{k}", "CYLINDER", size, (float(x), y, -0.5))
                peg.friction, peg.priority = (self.slip, 0.0, 0.0), 1


@value_class
class Slope(Scene):
    """Flat ground that continues from an edge as a slope along x, up or down."""

    height: float = quantity("m", "Height of the flat ground", default=0.0)
    edge: float = quantity("m", "x at which the slope begins", default=1.5)
    angle: float = quantity(
        "rad", "Angle of the slope, positive uphill", ge=-1.0, le=1.0, default=math.radians(10.0)
    )
    bottom: float = quantity(
        "m", "Height of the floor at the foot of a slope that leads down", default=-TANK_DEPTH
    )

    def __post_init__(self) -> None:
        """Reject a floor that is not below the ground from which the slope leads down."""
        if self.angle < 0.0 and self.bottom >= self.height:
            raise BadArgument(
                "bottom", f"must be < `height` = {self.height:g} m, got {self.bottom:g}"
            )

    @property
    def terrain(self) -> Terrain:
        """See `Scene`."""
        return Terrain(
            height=self.height, edge=self.edge, slope=-math.tan(self.angle), floor=self.bottom
        )

    def __call__(self, spec: Any) -> None:
        """See `Scene`."""
        sin, cos, width = math.sin(self.angle), math.cos(self.angle), 0.5 * FAR
        length = (self.bottom - self.height) / sin if sin < 0.0 else FAR
        flat = (self.edge - 0.5 * FAR, 0.0, self.height - THICK)
        # From the middle of the slope's face, half a thickness into the ground.
        x, z = (
            self.edge + 0.5 * length * cos + THICK * sin,
            self.height + 0.5 * length * sin - THICK * cos,
        )
        turned = (math.cos(0.5 * self.angle), 0.0, -math.sin(0.5 * self.angle), 0.0)
        solid(spec, "shore", "BOX", (0.5 * FAR, width, THICK), flat)
        solid(spec, "ramp", "BOX", (0.5 * length, width, THICK), (x, 0.0, z), turned)
        if sin < 0.0:
            solid(spec, "floor", "PLANE", (0.0, 0.0, 1.0), (0.0, 0.0, self.bottom))


@value_class
class Shore(Slope):
    """A shore above the water, on which the robot starts, and a slope down into the water."""

    height: float = quantity("m", "Height of the flat ground", default=0.10)
    edge: float = quantity("m", "x at which the slope begins", default=2.5)
    angle: float = quantity(
        "rad", "Angle of the slope, positive uphill", ge=-1.0, le=1.0, default=math.radians(-12.0)
    )
    ground: Ground | None = option(
        "Friction of its ground along and across the robot", default=SKIN
    )

    wet: ClassVar[bool] = True


@value_class
class HeightField(Scene):
    """Uneven ground: heights at the nodes of a grid, or waves in both directions."""

    heights: tuple[tuple[float, ...], ...] | None = quantity(
        "m", "One row along y per x; None: waves", default=None
    )
    amplitude: float = quantity("m", "Amplitude of the waves", ge=0.0, default=0.03)
    wavelength: float = quantity("m", "Wavelength of the waves", gt=0.0, default=1.0)
    extent: tuple[float, float] = quantity(
        "m", "Size along x and y; level ground beyond", gt=0.0, default=(12.0, 6.0)
    )
    middle: tuple[float, float] = quantity("m", "x and y of its middle", default=(3.0, 0.0))

    def __post_init__(self) -> None:
        """Reject heights that do not form a grid."""
        rows = self.heights or ((0.0, 0.0),) * 2
        if len(rows) < 2 or len({len(row) for row in rows} - {0, 1}) != 1:
            raise BadArgument(
                "heights",
                "must have at least two rows of at least two numbers, all of the same length",
            )

    @property
    def terrain(self) -> Terrain:
        """See `Scene`."""
        grid = self._nodes()
        cell = [size / (n - 1) for size, n in zip(self.extent, grid.shape, strict=True)]
        corner = [at - 0.5 * size for at, size in zip(self.middle, self.extent, strict=True)]
        return Terrain(grid=grid, corner=(corner[0], corner[1]), cell=(cell[0], cell[1]))

    def _nodes(self) -> np.ndarray:
        if self.heights is not None:
            return np.array(self.heights)
        x, y = (
            np.linspace(-0.5 * one, 0.5 * one, round(16.0 * one / self.wavelength) + 1)
            for one in self.extent
        )
        k = 2.0 * math.pi / self.wavelength
        return self.amplitude * np.outer(np.cos(k * x), np.cos(k * y))

    def __call__(self, spec: Any) -> None:
        """See `Scene`."""
        nodes = self._nodes()
        low, rise = float(nodes.min()), max(float(np.ptp(nodes)), 1e-3)
        size = (0.5 * self.extent[0], 0.5 * self.extent[1], rise, THICK)
        rows, columns = nodes.T.shape
        spec.add_hfield(
            name="terrain",
            nrow=rows,
            ncol=columns,
            size=size,
            userdata=(nodes.T - low).ravel().tolist(),
        )
        ground = solid(spec, "terrain", "HFIELD", (0.0, 0.0, 0.0), (*self.middle, low))
        ground.hfieldname = "terrain"


@value_class
class Pipe(Scene):
    """A pipe to swim through or around, with its axis along x unless tilted."""

    bore: float = quantity("m", "Its inner radius", gt=0.0, default=0.35)
    length: float = quantity("m", "From end to end", gt=0.0, default=8.0)
    center: tuple[float, float, float] = quantity("m", "Its middle", default=(2.0, 0.0, -0.5))
    tilt: float = quantity(
        "rad", "Tilt, positive nose up; 90 degrees: upright", ge=-2.0, le=2.0, default=0.0
    )

    def __call__(self, spec: Any) -> None:
        """See `Scene`."""
        thick = 0.01
        turned = (math.cos(0.5 * self.tilt), 0.0, -math.sin(0.5 * self.tilt), 0.0)
        pipe = spec.worldbody.add_body(name="pipe", pos=self.center, quat=turned)
        size = (0.5 * self.length, (self.bore + 2.0 * thick) * math.tan(math.pi / STAVES), thick)
        for k in range(STAVES):
            angle = 2.0 * math.pi * k / STAVES
            y, z = math.sin(angle) * (self.bore + thick), math.cos(angle) * (self.bore + thick)
            about = (math.cos(0.5 * angle), -math.sin(0.5 * angle), 0.0, 0.0)
            solid(pipe, f"wall_{k}", "BOX", size, (0.0, y, z), about)


@value_class
class Tank(Scene):
    """The tank of the experiments: 40 m x 6.45 m, 1.5 m deep, with its floor and walls."""

    dt: ClassVar[float] = math.inf  # its walls are far away
    wet: ClassVar[bool] = True

    def __call__(self, spec: Any) -> None:
        """Add floor and walls around the middle of the world, with the water surface at z = 0."""
        x, y, z = 0.5 * TANK_LENGTH, 0.5 * TANK_WIDTH, 0.5 * TANK_DEPTH
        solid(spec, "floor", "PLANE", (x, y, 1.0), (0.0, 0.0, -TANK_DEPTH))
        solid(spec, "wall_left", "BOX", (x, WALL, z), (0.0, y + WALL, -z))
        solid(spec, "wall_right", "BOX", (x, WALL, z), (0.0, -y - WALL, -z))
        solid(spec, "wall_front", "BOX", (WALL, y, z), (x + WALL, 0.0, -z))
        solid(spec, "wall_back", "BOX", (WALL, y, z), (-x - WALL, 0.0, -z))


@value_class
class Mjcf(Scene):
    """Contents of an MJCF file: its bodies with their joints and assets; its options are ignored."""

    file: str = option("The file (.xml), which must exist whenever the scenario runs")

    def __call__(self, spec: Any) -> None:
        """See `Scene`."""
        spec.attach(
            load_mujoco().MjSpec.from_file(self.file), frame=spec.worldbody.add_frame(), prefix=""
        )


@value_class
class Edited(Scene):
    """A user-defined function that edits a `mujoco.MjSpec`; a file stores only its name: write a class for more."""

    edit: Callable[[Any], None] = option("f(spec)")

    def check(self, environment: Environment) -> None:
        """See `Scene`."""
        if not callable(self.edit):
            raise BadArgument(
                "scene", "must be given again: a file stores only the name of a function"
            )

    def __call__(self, spec: Any) -> None:
        """See `Scene`."""
        self.edit(spec)


def add_scene(model: Any, environment: Environment, scene: Scene | None, *, visuals: bool) -> None:
    """Add the surroundings to a model that already has its robots; arguments as for `mjcf.spec`.

    Raises:
        ValueError: If the scene is incompatible with the environment, or MuJoCo rejects it.
    """
    if isinstance(environment, Ground) and (scene is None or scene.terrain is None):
        solid(model, "ground", "PLANE", (0.0, 0.0, 1.0))
    if scene is None:
        return
    scene.check(environment)
    with reporting_scene_errors():
        scene(model)
    if visuals and not isinstance(environment, Ground):
        size = (
            0.5 * TANK_LENGTH,
            0.5 * (TANK_WIDTH if isinstance(scene, Tank) else TANK_LENGTH),
            1.0,
        )
        solid(model, SURFACE, "PLANE", size, (0.0, 0.0, scene.level)).conaffinity = 0


def solid(
    where: Any,
    name: str,
    kind: str,
    size: Three,
    pos: Three = (0.0, 0.0, 0.0),
    quat: Quaternion = (1.0, 0.0, 0.0, 0.0),
) -> Any:
    """Add a geom that the robot can touch.

    Args:
        where: A `mujoco.MjSpec`, or a body of one.
        name: Its name in messages and pictures.
        kind: Its type in MuJoCo, such as BOX or PLANE.
        size: Its size as defined by MuJoCo [m].
        pos: Position of its center [m].
        quat: Its orientation, as a quaternion [-].
    """
    body = getattr(where, "worldbody", where)
    shape = getattr(load_mujoco().mjtGeom, f"mjGEOM_{kind}")
    color = COLORS.get(name.partition("_")[0], SAND)
    return body.add_geom(
        name=name, type=shape, size=size, pos=pos, quat=quat, rgba=color, contype=0, conaffinity=1
    )


@contextmanager
def reporting_scene_errors() -> Generator[None]:
    """Turn errors of MuJoCo within this context into errors about the scene; the robot alone causes none."""
    try:
        yield
    except ValueError as error:
        said = " ".join(str(error).removeprefix("Error: ").split())
        raise BadArgument(
            "scene", f"must compile in MuJoCo together with the robot; MuJoCo says: {said}"
        ) from error


def check_free(model: Any, data: Any, robots: Collection[int]) -> None:
    """Reject a start at which a robot is inside another object.

    Args:
        model: A `mujoco.MjModel` with a scene.
        data: A `mujoco.MjData` at the start, with computed kinematics.
        robots: IDs of the robots' bodies.
    """
    load_mujoco().mj_collision(model, data)
    for touch in data.contact[: data.ncon]:
        link, other = sorted(
            map(int, touch.geom), key=lambda geom: int(model.geom_bodyid[geom]) not in robots
        )
        if touch.dist < -DEEPEST and int(model.geom_bodyid[link]) in robots:
            depth = f"{model.geom(link).name.removesuffix('_hull')} is {-1e3 * touch.dist:.0f} mm deep in it"
            name = model.geom(other).name or model.body(int(model.geom_bodyid[other])).name
            raise BadArgument(
                "start", f"must not put the robot into `{name}` of the scene, but {depth}"
            )
