"""Scenes provided by the package: obstacles, walls and terrain around the robot.

A scene is a value (`laticauda.robot.Scene`) that edits a MuJoCo model; `spatial.surroundings` adds
it to the model of a robot.
"""

import math
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from laticauda.models.spatial.mounts import Quaternion
from laticauda.models.spatial.solids import add_solid
from laticauda.robot import Environment, Ground, Scene
from laticauda.values import BadArgument, load_mujoco, option, quantity, value_class
from laticauda.water.fluid import CoulombFriction
from laticauda.water.mujoco import Terrain

TANK_LENGTH = 40.0
"""Length of the tank in Trondheim in which the paper's robot swam [m]."""
TANK_WIDTH = 6.45
"""Width of that tank [m]."""
TANK_DEPTH = 1.5
"""Depth of that tank [m]."""
WALL_HALF_THICKNESS = 0.1
"""Half thickness of the tank's walls [m]."""
GROUND_HALF_THICKNESS = 0.2
"""Half thickness of the ground's boxes [m]."""
GROUND_LENGTH = 12.0
"""Length of ground that is not bounded otherwise [m]."""
PIPE_HALF_THICKNESS = 0.01
"""Half thickness of a pipe's wall [m]."""
N_STAVES = 24
"""Number of staves of a pipe."""
LEAST_RISE = 1e-3
"""Least difference between the heights of a terrain that MuJoCo accepts [m]."""
SCENE_PREFIX = "scene_"
"""Prefix of all names of a file in which a name is one of the robot's."""
NAMED_KINDS = (
    "bodies",
    "joints",
    "geoms",
    "sites",
    "cameras",
    "lights",
    "meshes",
    "hfields",
    "textures",
    "materials",
    "skins",
    "flexes",
    "pairs",
    "excludes",
    "equalities",
    "tendons",
    "actuators",
    "sensors",
)
"""Parts of a `mujoco.MjSpec` that have names, each kind for itself."""
SKIN = Ground(
    name="skin", friction=CoulombFriction(regularization_speed=1e-2), tangential=0.1, normal=0.5
)
"""Friction of a robot with a skin on a shore."""


def _pitch_up(angle: float) -> Quaternion:
    """Return the orientation after a rotation about y that turns x upward by an angle [rad]."""
    return (math.cos(0.5 * angle), 0.0, -math.sin(0.5 * angle), 0.0)


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
        begin, end = self.field
        size = (self.radius, 0.5 * TANK_DEPTH + 0.25, 0.0)
        for row in range(self.rows):
            y = (row + 0.5 - 0.5 * self.rows) * self.gap
            shift = self.stagger * (row % 2)
            for k, x in enumerate(np.arange(begin + shift, end, self.spacing)):
                peg = add_solid(
                    spec,
                    name=f"peg_{row}_{k}",
                    kind="CYLINDER",
                    size=size,
                    position=(float(x), y, -0.5),
                )
                peg.friction = (self.slip, 0.0, 0.0)
                # The pegs' friction counts, not that of the robot.
                peg.priority = 1


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
            rule = f"must be < `height` = {self.height:g} m, got {self.bottom:g}"
            raise BadArgument("bottom", rule)

    @property
    def terrain(self) -> Terrain:
        """See `Scene`."""
        return Terrain(
            height=self.height, edge=self.edge, slope=-math.tan(self.angle), floor=self.bottom
        )

    def __call__(self, spec: Any) -> None:
        """See `Scene`."""
        self._add_flat_ground(spec)
        self._add_ramp(spec)
        if self.angle < 0.0:
            floor = (0.0, 0.0, self.bottom)
            add_solid(spec, name="floor", kind="PLANE", size=(0.0, 0.0, 1.0), position=floor)

    def _add_flat_ground(self, spec: Any) -> None:
        half_length = 0.5 * GROUND_LENGTH
        add_solid(
            spec,
            name="shore",
            kind="BOX",
            size=(half_length, 0.5 * GROUND_LENGTH, GROUND_HALF_THICKNESS),
            position=(self.edge - half_length, 0.0, self.height - GROUND_HALF_THICKNESS),
        )

    def _add_ramp(self, spec: Any) -> None:
        """Add the slope; the middle of its box is half its thickness below the middle of its face."""
        sin = math.sin(self.angle)
        cos = math.cos(self.angle)
        length = GROUND_LENGTH
        if sin < 0.0:
            length = (self.bottom - self.height) / sin
        x = self.edge + 0.5 * length * cos + GROUND_HALF_THICKNESS * sin
        z = self.height + 0.5 * length * sin - GROUND_HALF_THICKNESS * cos
        add_solid(
            spec,
            name="ramp",
            kind="BOX",
            size=(0.5 * length, 0.5 * GROUND_LENGTH, GROUND_HALF_THICKNESS),
            position=(x, 0.0, z),
            orientation=_pitch_up(self.angle),
        )


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
        if not self.heights:
            return
        sizes = {len(row) for row in self.heights}
        if len(self.heights) < 2 or len(sizes) > 1 or min(sizes) < 2:
            rule = "must have at least two rows of at least two numbers, all of the same length"
            raise BadArgument("heights", rule)

    @property
    def terrain(self) -> Terrain:
        """See `Scene`."""
        grid = self._heights_of_nodes()
        length, width = self.extent
        x, y = self.middle
        n_x, n_y = grid.shape
        return Terrain(
            grid=grid,
            corner=(x - 0.5 * length, y - 0.5 * width),
            cell=(length / (n_x - 1), width / (n_y - 1)),
        )

    def _heights_of_nodes(self) -> np.ndarray:
        """Return the heights at the nodes of a grid, along x and y [m]."""
        if self.heights is not None:
            return np.array(self.heights)
        length, width = self.extent
        wavenumber = 2.0 * math.pi / self.wavelength
        along = np.cos(wavenumber * self._positions_of_nodes(length))
        across = np.cos(wavenumber * self._positions_of_nodes(width))
        return self.amplitude * np.outer(along, across)

    def _positions_of_nodes(self, size: float) -> np.ndarray:
        """Return the positions of 16 nodes per wavelength, from the middle [m]."""
        n_nodes = round(16.0 * size / self.wavelength) + 1
        return np.linspace(-0.5 * size, 0.5 * size, n_nodes)

    def __call__(self, spec: Any) -> None:
        """See `Scene`."""
        heights = self._heights_of_nodes().T
        lowest = float(heights.min())
        rise = max(float(np.ptp(heights)), LEAST_RISE)
        length, width = self.extent
        n_rows, n_columns = heights.shape
        spec.add_hfield(
            name="terrain",
            nrow=n_rows,
            ncol=n_columns,
            size=(0.5 * length, 0.5 * width, rise, GROUND_HALF_THICKNESS),
            userdata=(heights - lowest).ravel().tolist(),
        )
        ground = add_solid(
            spec,
            name="terrain",
            kind="HFIELD",
            size=(0.0, 0.0, 0.0),
            position=(*self.middle, lowest),
        )
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
        """Add the staves of which its wall consists."""
        pipe = spec.worldbody.add_body(name="pipe", pos=self.center, quat=_pitch_up(self.tilt))
        half_width = (self.bore + 2.0 * PIPE_HALF_THICKNESS) * math.tan(math.pi / N_STAVES)
        radius = self.bore + PIPE_HALF_THICKNESS
        for k in range(N_STAVES):
            angle = 2.0 * math.pi * k / N_STAVES
            add_solid(
                pipe,
                name=f"wall_{k}",
                kind="BOX",
                size=(0.5 * self.length, half_width, PIPE_HALF_THICKNESS),
                position=(0.0, math.sin(angle) * radius, math.cos(angle) * radius),
                orientation=(math.cos(0.5 * angle), -math.sin(0.5 * angle), 0.0, 0.0),
            )


@value_class
class Tank(Scene):
    """The tank of the experiments: 40 m x 6.45 m, 1.5 m deep, with its floor and walls."""

    dt: ClassVar[float] = math.inf  # its walls are far away
    wet: ClassVar[bool] = True

    def __call__(self, spec: Any) -> None:
        """Add floor and walls around the middle of the world, with the water surface at z = 0."""
        x = 0.5 * TANK_LENGTH
        y = 0.5 * TANK_WIDTH
        z = 0.5 * TANK_DEPTH
        wall = WALL_HALF_THICKNESS
        floor = (0.0, 0.0, -TANK_DEPTH)
        side = (x, wall, z)
        end = (wall, y, z)
        add_solid(spec, name="floor", kind="PLANE", size=(x, y, 1.0), position=floor)
        add_solid(spec, name="wall_left", kind="BOX", size=side, position=(0.0, y + wall, -z))
        add_solid(spec, name="wall_right", kind="BOX", size=side, position=(0.0, -y - wall, -z))
        add_solid(spec, name="wall_front", kind="BOX", size=end, position=(x + wall, 0.0, -z))
        add_solid(spec, name="wall_back", kind="BOX", size=end, position=(-x - wall, 0.0, -z))


@value_class
class Mjcf(Scene):
    """Contents of an MJCF file: its bodies with their joints and assets; its options are ignored.

    If one of its names is the robot's, too, all of them get a prefix in the model, `scene_`.
    """

    file: str = option("The file (.xml), which must exist whenever the scenario runs")

    def __call__(self, spec: Any) -> None:
        """See `Scene`."""
        contents = load_mujoco().MjSpec.from_file(self.file)
        prefix = ""
        if names_in(contents) & names_in(spec):
            prefix = SCENE_PREFIX
        spec.attach(contents, frame=spec.worldbody.add_frame(), prefix=prefix)


def names_in(spec: Any) -> set[tuple[str, str]]:
    """Return the kinds and names of what is in a `mujoco.MjSpec`, other than the world."""
    names: set[tuple[str, str]] = set()
    for kind in NAMED_KINDS:
        for element in getattr(spec, kind, ()):
            names.add((kind, element.name))
    return {(kind, name) for kind, name in names if name not in ("", "world")}


@value_class
class Edited(Scene):
    """A user-defined function that edits a `mujoco.MjSpec`; a file stores only its name: write a class for more."""

    edit: Callable[[Any], None] = option("f(spec)")

    def check(self, environment: Environment) -> None:
        """See `Scene`."""
        if not callable(self.edit):
            rule = "must be given again: a file stores only the name of a function"
            raise BadArgument("scene", rule)

    def __call__(self, spec: Any) -> None:
        """See `Scene`."""
        self.edit(spec)
