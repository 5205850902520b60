"""Scene of the page: the robot in its water, with trail, path, forces, surroundings and a ghost."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from laticauda.models.dynamics import Plant
from laticauda.robot import Environment, Robot, kinematics
from laticauda.scenarios import Spatial
from laticauda.sensing import ShapeKind, Solid, Three
from laticauda.show.cockpit.bodies import Body
from laticauda.show.cockpit.lines import Line, Trail
from laticauda.show.cockpit.shapes import Color, Poses
from laticauda.show.cockpit.water import MovingWater
from laticauda.show.pictures import lift_to_space
from laticauda.values import series

FLOOR = -0.6
"""Height of the floor relative to the axis of a robot in the plane [m]."""
SURFACE = 0.25
"""Height of the water's surface relative to the axis of a robot in the plane [m]."""
LEAST_FLOOR = 1.5
"""Depth of the floor below the surface, for a robot in space, at least [m]."""
FLOOR_STEP = 0.5
"""Steps by which the floor sinks with a robot that dives deeper [m]."""
FLOOR_CLEARANCE = 0.3
"""Height of a robot in space above the floor, at least [m]."""
WIDE = 60.0
"""Width of unbounded objects [m]."""
GRID_SECTION = 2.5
"""Distance between two of the grid's thick lines [m]."""
GRID_ABOVE_FLOOR = 0.004
"""[m]."""
WATER: Color = (44, 112, 146)
SAND: Color = (52, 118, 138)
SURFACE_COLOR: Color = (120, 200, 220)
TRAIL: Color = (255, 190, 60)
PATH: Color = (120, 230, 140)
FORCE: Color = (215, 25, 25)
GHOST: Color = (190, 215, 235)
SOLID: Color = (204, 224, 230)
"""Color of what stands around the robot."""
GRID_LOOK: dict[str, Any] = {
    "plane": "xy",
    "cell_size": 0.5,
    "section_size": GRID_SECTION,
    "cell_color": [62, 118, 132],
    "section_color": [98, 158, 170],
    "fade_distance": 18.0,
    "shadow_opacity": 0.0,
}
"""Arguments of viser for the grid on the floor; lengths in m."""
FORCE_LOOK: dict[str, Any] = {
    "shaft_radius": 0.008,
    "head_radius": 0.02,
    "head_length": 0.045,
}
"""Arguments of viser for the forces on links; lengths in m."""
KINDS_OF_GEOMS: Mapping[int, ShapeKind] = {2: "sphere", 5: "cylinder", 6: "box"}
"""Kinds of shapes by MuJoCo's numbers of its types of geoms; others are not shown."""


class Scene:
    """Everything that is shown of a simulation.

    Args:
        scene: Scene of the page's server.
    """

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._body = Body(scene, "robot")
        self._ghost = Body(scene, "ghost", color=GHOST, opacity=0.35)
        self.trail = Trail(scene, "/trail", TRAIL)
        """Trail of the center of mass, as far as it was shown."""
        self._path = Line(scene, "/path", PATH, 0.016)
        self._surroundings: list[Any] = []
        self._shown_surroundings: Any = None
        self._forces = ForceArrows(scene)
        scene.set_up_direction("+z")
        _light_water(scene)
        self._floor = _add_plane(scene, "/floor", FLOOR, SAND)
        self._grid = scene.add_grid(
            "/grid",
            width=WIDE,
            height=WIDE,
            position=(0.0, 0.0, FLOOR + GRID_ABOVE_FLOOR),
            **GRID_LOOK,
        )
        self._water = MovingWater(scene)
        self._surface = _add_plane(scene, "/surface", SURFACE, SURFACE_COLOR, opacity=0.35)

    def show(
        self, robot: Robot, environment: Environment, sample: series.Log, *, forces: bool
    ) -> None:
        """Draw the robot and its water, and the force on every link if it is requested and in the sample."""
        center = sample.center_of_mass
        poses = self._body.show(robot, sample)
        self._water.show(environment, robot, center, float(sample.time))
        self.trail.grow(center)
        if forces and sample.link_force:
            self._forces.show(poses, sample.link_force, lift_to_space(center, 0.0))
        else:
            self._forces.hide()
        self._surface.visible = self._water.surface is None
        self._move_planes(center)

    def _move_planes(self, center: np.ndarray) -> None:
        """Let floor and surface, which are unbounded, follow the robot, by whole sections of the grid."""
        x, y = (GRID_SECTION * round(float(value) / GRID_SECTION) for value in center[:2])
        floor = FLOOR
        surface = SURFACE
        if center.size == 3:
            floor = -_floor_depth(float(center[2]))
            surface = 0.0
        grid = floor + GRID_ABOVE_FLOOR
        if (x, y, grid) == tuple(self._grid.position):
            return
        self._floor.position = (x, y, floor)
        self._grid.position = (x, y, grid)
        self._surface.position = (x, y, surface)

    def draw_path(self, points: np.ndarray) -> None:
        """Draw the path through these points [m]; hide it if there are none."""
        self._path.draw(points)

    def draw_surroundings(self, plant: Plant[Any], state: Any) -> None:
        """Draw places and the boxes, cylinders and balls of a scene around the robot of a plant in a given state."""
        settings = plant.settings
        surroundings = settings.places, getattr(settings, "scene", None)
        if surroundings == self._shown_surroundings:
            return
        for handle in self._surroundings:
            handle.remove()
        self._surroundings = []
        self._shown_surroundings = surroundings
        for number, solid in enumerate(_solids_around(plant, state)):
            self._add_solid(f"/around/{number}", solid)

    def _add_solid(self, name: str, solid: Solid) -> None:
        """Add a shape, by its name on the page."""
        look: Any = {
            "color": SOLID,
            "opacity": 0.4,
            "wxyz": kinematics.to_quaternion(np.transpose(solid.axes)),
            "position": solid.center,
        }
        radius, _, half_height = solid.size
        if solid.kind == "box":
            sides = 2.0 * np.array(solid.size)
            handle = self._scene.add_box(name, dimensions=sides, **look)
        elif solid.kind == "cylinder":
            handle = self._scene.add_cylinder(name, radius=radius, height=2.0 * half_height, **look)
        else:
            handle = self._scene.add_icosphere(name, radius=radius, **look)
        self._surroundings.append(handle)

    def set_visible(self, is_visible: bool) -> None:
        """Show or hide the robot; its trail and its path stay."""
        self._body.set_visible(is_visible)

    def show_ghost(self, robot: Robot, sample: series.Log) -> None:
        """Draw the ghost as in a sample."""
        self._ghost.show(robot, sample)

    def remove_ghost(self) -> None:
        """Remove the ghost."""
        self._ghost.remove()


def _solids_around(plant: Plant[Any], state: Any) -> list[Solid]:
    """Return the shapes around the robot of a plant in a given state."""
    settings = plant.settings
    solids: list[Solid] = []
    if not isinstance(settings, Spatial):
        for place in settings.places:
            solids += place.solids()
        return solids
    if settings.surroundings is None:
        return []
    spatial: Any = plant
    model = spatial.model
    data = spatial.data(state)
    is_robot = model.body_rootid[model.geom_bodyid] == model.body("module_0").id
    for geom in np.flatnonzero(~is_robot).tolist():
        kind = KINDS_OF_GEOMS.get(int(model.geom_type[geom]))
        if kind is None:
            continue
        x_axis, y_axis, z_axis = data.geom_xmat[geom].reshape(3, 3).T.tolist()
        center: Any = tuple(data.geom_xpos[geom].tolist())
        axes: Any = tuple(x_axis), tuple(y_axis), tuple(z_axis)
        solids.append(
            Solid(kind, center, _size_of_geom(kind, *model.geom_size[geom].tolist()), axes)
        )
    return solids


def _size_of_geom(kind: ShapeKind, first: float, second: float, third: float) -> Three:
    """Return the size of a shape by the three numbers that MuJoCo has for its kind [m]."""
    if kind == "box":
        return first, second, third
    if kind == "cylinder":
        return first, first, second
    return first, first, first


def _floor_depth(height: float) -> float:
    """Return how deep the floor is below a robot in space at some height [m]."""
    steps_per_meter = 1.0 / FLOOR_STEP
    depth = FLOOR_STEP * math.ceil(steps_per_meter * (FLOOR_CLEARANCE - height))
    return max(LEAST_FLOOR, depth)


def _light_water(scene: Any) -> None:
    """Add fog, background and light.

    There are three lights instead of an environment map: shadows are deep, and a weak computer
    renders faster.
    """
    scene.configure_fog(near=4.0, far=20.0, color=_linear_color(WATER))
    scene.set_background_image(np.full((8, 8, 3), WATER, dtype=np.uint8), format="png")
    scene.configure_environment_map(None)
    scene.add_light_hemisphere(
        "/light", sky_color=(215, 240, 250), ground_color=(70, 110, 125), intensity=2.4
    )
    scene.add_light_directional(
        "/lamp", color=(255, 244, 225), intensity=2.0, position=(-2.0, -4.0, 3.0)
    )


def _add_plane(
    scene: Any, name: str, height: float, color: Color, opacity: float | None = None
) -> Any:
    """Add a plane; if opaque, its upper side is visible, with the shadows on it, otherwise its lower side."""
    half = 0.5 * WIDE
    corners = [(-half, -half, 0.0), (-half, half, 0.0), (half, -half, 0.0), (half, half, 0.0)]
    is_opaque = opacity is None
    return scene.add_mesh_simple(
        name,
        vertices=np.array(corners, dtype=np.float32),
        faces=np.array([[0, 2, 1], [1, 2, 3]], dtype=np.uint32),
        color=color,
        opacity=opacity,
        side="front" if is_opaque else "back",
        cast_shadow=False,
        receive_shadow=is_opaque,
        position=(0.0, 0.0, height),
    )


def _linear_color(color: Color) -> tuple[float, ...]:
    """Convert a color to linear light for the page's fog; all other colors are in perceptually uniform steps."""
    shares = [value / 255.0 for value in color]
    return tuple(((share + 0.055) / 1.055) ** 2.4 for share in shares)


# ---- forces on links -----------------------------------------------------------------------------

LENGTH_PER_NEWTON = 0.06
"""Length of an arrow per newton [m]."""
LONGEST_FORCE = 1.0
"""Largest length of an arrow [m]."""


class ForceArrows:
    """Arrows from the links' midpoints, proportional to the forces on them.

    They are in a separate frame at the center of mass: a slow page updates positions sooner than
    shapes.

    Args:
        scene: Scene of the page's server.
    """

    def __init__(self, scene: Any) -> None:
        self.frame = scene.add_frame("/forces", show_axes=False, visible=False)
        """Frame of the arrows, on the page."""
        placeholder = np.array([[(0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]], np.float32)
        self.arrows = scene.add_arrows("/forces/arrows", placeholder, FORCE, **FORCE_LOOK)
        """The arrows on the page."""

    def show(self, poses: Poses, forces: Mapping[str, np.ndarray], center: np.ndarray) -> None:
        """Draw the sum of the forces on every link.

        Args:
            poses: Poses of the robot's parts.
            forces: Forces on the links, by what causes them [N].
            center: Center of mass [m].
        """
        force = np.sum(list(forces.values()), axis=0)
        if force.shape[1] == 2:
            force = np.column_stack((force, np.zeros(len(force))))
        size = np.linalg.norm(force, axis=1, keepdims=True)
        length = np.maximum(LENGTH_PER_NEWTON * size, 1e-9)
        shrink = np.minimum(1.0, LONGEST_FORCE / length)
        begin = poses.middle - center
        end = begin + LENGTH_PER_NEWTON * shrink * force
        self.arrows.points = np.stack((begin, end), axis=1).astype(np.float32)
        self.frame.position = center
        self.frame.visible = True

    def hide(self) -> None:
        """Hide all arrows."""
        self.frame.visible = False
