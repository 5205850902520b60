"""Scene of the page: the robot in its water, with trail, path, forces and a ghost.

Moving water is shown as arrows around the robot, and as a surface that rises and falls.
"""

import math
from collections import deque
from typing import Any

import numpy as np

from laticauda.models.dynamics.plant import Plant
from laticauda.robot import Environment, Robot, Water, kinematics
from laticauda.show.cockpit.shapes import Color, Poses, build_shapes, compute_poses
from laticauda.show.pictures.camera import to_space
from laticauda.values import series
from laticauda.water.fluid.arrows import MOMENTS, Arrows, Surface, arrows_of, has_waves

FLOOR, SURFACE = (
    -0.6,
    0.25,
)  # heights of floor and surface relative to the axis of a robot in the plane [m]
LEAST_FLOOR = 1.5  # depth of the floor below the surface, for a robot in space [m]
WIDE = 60.0  # width of unbounded objects [m]
WATER: Color = (44, 112, 146)
SAND: Color = (52, 118, 138)
TRAIL: Color = (255, 190, 60)
PATH: Color = (120, 230, 140)
FORCE: Color = (215, 25, 25)
GHOST: Color = (190, 215, 235)
AHEAD = 0.35  # what a camera looks at, along x from the robot: the panel hides the right side of the page [m]
BALL, CYLINDER, BOX = 2, 5, 6  # MuJoCo's geom types
SOLID: Color = (204, 224, 230)
ABOVE = math.radians(34.0)  # initial elevation of a camera above the robot's plane [rad]
HOME = ((AHEAD - 0.5, -3.2 * math.cos(ABOVE), 3.2 * math.sin(ABOVE)), (AHEAD, 0.0, 0.0))
"""Initial position of a camera, beside and above the robot, and what it looks at [m]."""
BELOW = np.array(
    (0.0, 0.0, -1.35)
)  # what a phone's camera looks at, from the robot: the panel hides the bottom [m]
PHONE = (BELOW + 1.9 * np.subtract(*HOME), BELOW)
"""`HOME` for a page that is much taller than wide."""
FIELD_OF_VIEW = math.radians(55.0)  # vertical [rad]
PER_NEWTON = 0.06  # length of an arrow per newton [m]
LOOKS: dict[str, dict[str, Any]] = {
    "grid": {
        "plane": "xy",
        "cell_size": 0.5,
        "section_size": 2.5,
        "cell_color": [62, 118, 132],
        "section_color": [98, 158, 170],
        "fade_distance": 18.0,
        "shadow_opacity": 0.0,
    },
    "forces": {
        "shaft_radius": 0.008,
        "head_radius": 0.02,
        "head_length": 0.045,
    },
    "arrows": {
        "shaft_radius": 0.006,
        "head_radius": 0.018,
        "head_length": 0.05,
    },
    "surface": {
        "wireframe": True,
        "opacity": 0.35,
        "color": [120, 200, 220],
        "cast_shadow": False,
        "receive_shadow": False,
    },
}
"""Arguments of viser for the floor, forces on links, and moving water; lengths in m."""
TRAIL_STEP, N_TRAIL = (
    0.02,
    600,
)  # minimum distance between its points [m], and their maximum number [-]


class Body:
    """A robot in the scene: one frame per part, with the shapes in it.

    Args:
        scene: Scene of the page's server.
        name: Name of the body in the scene's tree.
        color: Color of all its shapes; None: their own.
        opacity: Opacity of its shapes; None: fully opaque [-].
    """

    def __init__(
        self, scene: Any, name: str, *, color: Color | None = None, opacity: float | None = None
    ) -> None:
        self._scene, self._name, self._color, self._opacity = scene, name, color, opacity
        self._robot: Robot | None = None
        self._frames: list[Any] = []
        self._root = scene.add_frame(f"/{name}", show_axes=False)

    def show(self, robot: Robot, sample: series.Log) -> Poses:
        """Draw the robot as in a sample; arguments as for `laticauda.show.cockpit.shapes.compute_poses`."""
        if robot != self._robot:
            self._build(robot)
        now = compute_poses(robot, sample)
        for frame, position, orientation in zip(
            self._frames, now.position, now.orientation, strict=True
        ):
            frame.position, frame.wxyz = position, orientation
        return now

    def set_visible(self, is_visible: bool) -> None:
        """Show the body, or hide it in place."""
        self._root.visible = is_visible

    def remove(self) -> None:
        """Remove the body from the scene."""
        for frame in self._frames:
            frame.remove()
        self._frames, self._robot = [], None

    def _build(self, robot: Robot) -> None:
        self.remove()
        found = build_shapes(robot)
        for part in range(1 + max(shape.part for shape in found)):
            self._frames.append(
                self._scene.add_frame(f"/{self._name}/part_{part}", show_axes=False)
            )
        for i, shape in enumerate(found):
            self._scene.add_mesh_simple(
                f"/{self._name}/part_{shape.part}/shape_{i}",
                vertices=shape.mesh.vertices.astype(np.float32),
                faces=shape.mesh.faces.astype(np.uint32),
                color=self._color or shape.color,
                opacity=self._opacity,
                side="double",
            )
        self._robot = robot


class Line:
    """A line through points, hidden if there are too few.

    Args:
        scene: Scene of the page's server.
        name: Name of the line in the scene's tree.
        color: Color of the line.
        thickness: Thickness of the line [m].
    """

    def __init__(self, scene: Any, name: str, color: Color, thickness: float) -> None:
        self._line = scene.add_line_segments(
            name,
            points=np.zeros((1, 2, 3), np.float32),
            colors=color,
            thickness=thickness,
            visible=False,
        )

    def draw(self, points: np.ndarray) -> None:
        """Draw the line through these points [m]; hide it if there are fewer than two."""
        if len(points) > 1:
            self._line.points = np.stack((points[:-1], points[1:]), axis=1).astype(np.float32)
        self._line.visible = len(points) > 1


class Trail:
    """Trail of a robot: a growing line with at most `N_TRAIL` points.

    Args:
        scene: Scene of the page's server.
        name: Name of the line in the scene's tree.
        color: Color of the line.
    """

    def __init__(self, scene: Any, name: str, color: Color) -> None:
        self._line = Line(scene, name, color, 0.012)
        self._points: deque[np.ndarray] = deque(maxlen=N_TRAIL)
        self._end: np.ndarray | None = None

    def grow(self, place: np.ndarray) -> None:
        """Extend the trail to a position, in the plane or in space [m]."""
        place = to_space(place, 0.0)
        if not self._points or float(np.linalg.norm(place - self._points[-1])) > TRAIL_STEP:
            self._points.append(place)

    def draw(self) -> None:
        """Draw the trail up to its last point."""
        if self._points and self._points[-1] is not self._end:
            self._end = self._points[-1]
            self._line.draw(np.array(self._points))

    def forget(self) -> None:
        """Clear the trail."""
        self._points.clear()
        self._line.draw(np.empty((0, 3)))


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
        self._around: list[Any] = []
        self._place: Any = None
        # In a separate frame at the center of mass: a slow page updates positions sooner than
        # shapes.
        self._forces_at = scene.add_frame("/forces", show_axes=False, visible=False)
        arrow = np.array([[(0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]], np.float32)  # invisible
        self._forces = scene.add_arrows("/forces/arrows", arrow, FORCE, **LOOKS["forces"])
        scene.set_up_direction("+z")
        scene.configure_fog(near=4.0, far=20.0, color=_linear(WATER))
        scene.set_background_image(np.full((8, 8, 3), WATER, dtype=np.uint8), format="png")
        # Three lights instead of an environment map: shadows are deep, and a weak computer renders
        # faster.
        scene.configure_environment_map(None)
        scene.add_light_hemisphere(
            "/light", sky_color=(215, 240, 250), ground_color=(70, 110, 125), intensity=2.4
        )
        scene.add_light_directional(
            "/lamp", color=(255, 244, 225), intensity=2.0, position=(-2.0, -4.0, 3.0)
        )
        self._floor = _plane(scene, "/floor", FLOOR, SAND, None)
        above = (0.0, 0.0, FLOOR + 0.004)
        self._grid = scene.add_grid(
            "/grid", width=WIDE, height=WIDE, position=above, **LOOKS["grid"]
        )
        self._water = MovingWater(scene)
        self._surface = _plane(scene, "/surface", SURFACE, (120, 200, 220), 0.35)  # seen from below

    def show(
        self, robot: Robot, environment: Environment, sample: series.Log, *, forces: bool
    ) -> None:
        """Draw the robot and its water, and the force on every link if it is requested and in the sample."""
        now = self._body.show(robot, sample)
        self._water.show(environment, robot, sample.center_of_mass, float(sample.time))
        place = to_space(sample.center_of_mass, 0.0)
        self.trail.grow(place)
        arrows = _arrows(now, sample, place) if forces else None
        if arrows is not None:
            self._forces.points, self._forces_at.position = arrows, place
        self._forces_at.visible = arrows is not None
        # Floor and surface are unbounded: they follow the robot in steps of one grid section.
        x, y = (2.5 * round(float(value) / 2.5) for value in sample.center_of_mass[:2])
        floor, surface = FLOOR, SURFACE
        if (
            sample.center_of_mass.size == 3
        ):  # the floor sinks in steps with a robot that dives deeper
            floor, surface = -max(LEAST_FLOOR, 0.5 * math.ceil(2.0 * (0.3 - float(place[2])))), 0.0
        self._surface.visible = self._water.surface is None
        if (x, y, floor + 0.004) != tuple(self._grid.position):
            for handle, z in (
                (self._floor, floor),
                (self._grid, floor + 0.004),
                (self._surface, surface),
            ):
                handle.position = (x, y, z)

    def path(self, points: np.ndarray) -> None:
        """Draw the path through these points [m]; hide it if there are none."""
        self._path.draw(points)

    def surroundings(self, plant: Plant[Any], state: Any) -> None:
        """Draw the boxes, cylinders and balls around the robot of a plant in a given state."""
        if (scene := getattr(plant.settings, "scene", None)) is self._place:
            return
        for handle in self._around:
            handle.remove()
        self._around, self._place = [], scene
        if scene is None:
            return
        spatial: Any = plant
        model, data = spatial.model, spatial.data(state)
        own = model.body_rootid[model.geom_bodyid] == model.body("module_0").id
        for k in np.flatnonzero(~own):
            kind, size, name = model.geom_type[k], model.geom_size[k], f"/around/{k}"
            turned = kinematics.to_quaternion(data.geom_xmat[k].reshape(3, 3))
            look: Any = {
                "color": SOLID,
                "opacity": 0.4,
                "wxyz": turned,
                "position": data.geom_xpos[k],
            }
            if kind == BOX:
                self._around.append(self._scene.add_box(name, dimensions=2.0 * size, **look))
            elif kind == CYLINDER:
                self._around.append(
                    self._scene.add_cylinder(name, radius=size[0], height=2.0 * size[1], **look)
                )
            elif kind == BALL:
                self._around.append(self._scene.add_icosphere(name, radius=size[0], **look))

    def set_visible(self, is_visible: bool) -> None:
        """Show or hide the robot; its trail and its path stay."""
        self._body.set_visible(is_visible)

    def ghost(self, robot: Robot | None, sample: series.Log | None = None) -> None:
        """Draw a ghost as in a sample, or remove it."""
        if robot is None or sample is None:
            self._ghost.remove()
        else:
            self._ghost.show(robot, sample)


def _plane(scene: Any, name: str, height: float, color: Color, opacity: float | None) -> Any:
    """Add a plane; if opaque, its upper side is visible, with the shadows on it, otherwise its lower side."""
    half = 0.5 * WIDE
    corners = np.array(
        [[x, y, 0.0] for x in (-half, half) for y in (-half, half)], dtype=np.float32
    )
    faces = np.array([[0, 2, 1], [1, 2, 3]], dtype=np.uint32)
    return scene.add_mesh_simple(
        name,
        vertices=corners,
        faces=faces,
        color=color,
        opacity=opacity,
        side="front" if opacity is None else "back",
        cast_shadow=False,
        receive_shadow=opacity is None,
        position=(0.0, 0.0, height),
    )


def _linear(color: Color) -> tuple[float, float, float]:
    """Convert a color to linear light for the page's fog; all other colors are in perceptually uniform steps."""
    r, g, b = (((share + 0.055) / 1.055) ** 2.4 for share in (value / 255.0 for value in color))
    return r, g, b


def _arrows(now: Poses, sample: series.Log, place: np.ndarray) -> np.ndarray | None:
    """Return arrows proportional to the forces from the links' midpoints, relative to `place`; None without forces."""
    if not sample.link_force:
        return None
    force = np.sum(list(sample.link_force.values()), axis=0)
    if force.shape[1] == 2:
        force = np.column_stack((force, np.zeros(len(force))))
    size = np.linalg.norm(force, axis=1, keepdims=True)
    longest = np.minimum(1.0, 1.0 / np.maximum(PER_NEWTON * size, 1e-9))  # at most a meter
    begin = now.middle - place
    return np.stack((begin, begin + PER_NEWTON * longest * force), axis=1).astype(np.float32)


# ---- moving water --------------------------------------------------------------------------------

REACH, CORNERS = (
    10.0,
    29,
)  # of the surface: distance from the robot to its sides [m], and corners along one side
ARROW = (205, 240, 255)


class MovingWater:
    """The water of a scene, if it moves.

    Args:
        scene: Scene of the page's server.
    """

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._shown: tuple[Environment, Robot] | None = None
        self._drawn: object = None
        self._arrows: Arrows | None = None
        self.surface: Surface | None = None
        """Surface of the water, if it moves."""
        self._handles: list[Any] = []  # of the arrows and the surface

    def show(self, environment: Environment, robot: Robot, place: np.ndarray, t: float) -> None:
        """Update arrows and surface.

        Args:
            environment: Environment of the robot.
            robot: Robot around which the water is shown.
            place: Center of mass of the robot, in the plane or in space [m].
            t: Time since the start of the run [s].
        """
        if (environment, robot) != self._shown:
            self._shown = environment, robot
            self._begin(environment, robot, place, t)
        if not isinstance(environment, Water) or self._arrows is None:
            return
        step, axes = self._arrows.spacing, self._arrows.axes
        near = np.array((*(step * np.round(place[:2] / step)), 0.0 if axes == 2 else place[2]))
        now = (near.tolist(), None if environment.flow is None else t)
        if now != self._drawn:  # a uniform current is sent once
            self._drawn, self._handles[0].points = (
                now,
                self._arrows.around(near, t).astype(np.float32),
            )
            if self.surface is not None:  # above a robot in the plane, which is at 0
                level = np.array((0.0, 0.0, (environment.depth or 0.0) if axes == 2 else 0.0))
                self._handles[1].vertices = (self.surface.at(near, t) + level).astype(np.float32)

    def _begin(self, environment: Environment, robot: Robot, place: np.ndarray, t: float) -> None:
        """Recreate arrows and surface for other water, or another robot."""
        for handle in self._handles:
            handle.remove()
        self._handles, self.surface, self._arrows, self._drawn = [], None, None, None
        if not isinstance(environment, Water):
            return
        flow, times = environment.flow, [t + moment for moment in MOMENTS]
        self._arrows = arrows_of(environment.velocity, place, place, times, robot.reach, flow)
        if self._arrows is not None:
            arrows = self._arrows.around(np.append(place, 0.0)[:3], t).astype(np.float32)
            self._handles.append(
                self._scene.add_arrows("/water/arrows", arrows, ARROW, **LOOKS["arrows"])
            )
        if self._arrows is not None and flow is not None and has_waves(flow, place):
            self.surface = Surface(flow, REACH, CORNERS)
            corners, faces = (
                self.surface.at(place, t).astype(np.float32),
                self.surface.faces.astype(np.uint32),
            )
            self._handles.append(
                self._scene.add_mesh_simple("/water/surface", corners, faces, **LOOKS["surface"])
            )
