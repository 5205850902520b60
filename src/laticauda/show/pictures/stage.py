"""A robot in its surroundings as drawn by MuJoCo: light, shadows, water and the renderer; no simulation."""

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Float, UInt8

from laticauda.models.dynamics import Plant
from laticauda.models.spatial import (
    SpatialPlant,
    add_places,
    ballast_of,
    mjcf,
    reporting_scene_errors,
)
from laticauda.robot import Environment, Ground, Robot
from laticauda.scenarios import Model, Spatial
from laticauda.show.pictures.camera import VIEW_DEG, aim_camera, middle_ahead_of_center
from laticauda.show.pictures.posture import N_FREE_ROOT, Posture, choose_swimming_height
from laticauda.show.pictures.renderer import create_renderer
from laticauda.show.pictures.shadows import draw_shadows, find_shadow_casters
from laticauda.show.pictures.surroundings import add_surroundings
from laticauda.show.pictures.water import MovingWater
from laticauda.trials import Trial
from laticauda.values import load_mujoco, renamed_names
from laticauda.water.fluid import MOMENTS

LEAST_FLOOR = 1.5
"""Minimum depth of the floor [m]."""
DEEP = 2.0
"""Depth to which a robot in space may dive above the floor, if its range is unknown [m]."""
NEAR_SURFACE = 0.3
"""Distance to the surface within which the surface is shown [m]."""
NEARBY = np.array(((-2.0, -2.0), (2.0, 2.0)))
"""Two corners of the region in which a robot swims, if it is unknown [m]."""
CLEARANCE = 0.45
"""Minimum height above the floor [m]."""
N_TIMES = 12
"""Number of times of a trial at which moving water is sampled for its speed."""
SIZE = (640, 360)
"""Width and height of a picture [pixels]."""
Picture = UInt8[np.ndarray, "height width 3"]


class Studio:
    """The model of a robot and its surroundings, its state, and a camera; a resource to be closed.

    Args:
        robot: The robot to show.
        environment: Environment of the robot.
        model: Model whose settings define what else is there; None: nothing.
        more_robots: Further robots in the same surroundings.
        region: Two corners of the region of its center of mass, in space or, for a planar run, in
            the plane [m].
        times: Some of the times at which it will be shown [s].
        size: Width and height of the pictures [pixels].

    Raises:
        MissingExtra: If MuJoCo or, at the first picture, PyOpenGL is not installed.
        MissingProgram: If the system has no EGL, at the first picture.
    """

    def __init__(
        self,
        robot: Robot,
        environment: Environment,
        model: Model | None = None,
        *,
        more_robots: Sequence[Robot] = (),
        region: Float[np.ndarray, "2 n_axes"] = NEARBY,
        times: Sequence[float] = MOMENTS,
        size: tuple[int, int] = SIZE,
    ) -> None:
        self.robot = robot
        self.height = choose_swimming_height(robot, environment)
        """Height at which the robot is shown if it is planar [m]."""
        lowest, highest = _height_range(region, self.height)
        self.floor = 0.0
        """Height of the floor of the water, or of the ground [m]."""
        if not isinstance(environment, Ground):
            self.floor = min(-LEAST_FLOOR, lowest - CLEARANCE)
        self.water = MovingWater(environment, robot.reach, region, times)
        """Motion of the water."""
        spec = _build_spec(robot, more_robots, environment, model)
        waves = self.water.add_mesh(spec)
        add_surroundings(
            spec,
            environment,
            floor=self.floor,
            length=robot.reach,
            level=_visible_level(environment, model, highest, has_waves=waves is not None),
            waves=waves,
        )
        _set_picture(spec, size)
        with reporting_scene_errors():
            self.model: Any = spec.compile()
        self.data: Any = load_mujoco().MjData(self.model)
        self._shadow_casters = find_shadow_casters(self.model)

    @classmethod
    def of(cls, plant: Plant[Any], size: tuple[int, int] = SIZE) -> "Studio":
        """Return a studio for states of a plant.

        Args:
            plant: The plant.
            size: Width and height of the pictures [pixels].
        """
        region = NEARBY
        if isinstance(plant, SpatialPlant):
            highest = choose_swimming_height(plant.robot, plant.environment)
            region = np.append(NEARBY, [[-DEEP], [highest]], axis=1)
        return cls(plant.robot, plant.environment, plant.settings, region=region, size=size)

    @classmethod
    def of_trial(
        cls, trial: Trial, *, more_robots: Sequence[Robot] = (), size: tuple[int, int] = SIZE
    ) -> "Studio":
        """Return the studio that shows a trial.

        Args:
            trial: Any trial, simulated or real.
            more_robots: Further robots in the same surroundings.
            size: Width and height of the pictures [pixels].
        """
        center = trial.center_of_mass
        step = max(trial.time.size // N_TIMES, 1)
        return cls(
            trial.robot,
            trial.environment,
            trial.scenario.model,
            more_robots=more_robots,
            region=np.array((center.min(axis=0), center.max(axis=0))),
            times=trial.time[::step].tolist(),
            size=size,
        )

    def take(self, posture: Posture, *more_postures: Posture) -> int | None:
        """Set the postures of the robot and of more robots; return the mesh to be sent to a renderer, if any.

        Args:
            posture: Posture of the robot.
            more_postures: Postures of the other robots.
        """
        for index, robot_posture in enumerate((posture, *more_postures)):
            self._set_posture(index, robot_posture)
        self._update_kinematics()
        load_mujoco().mj_camlight(self.model, self.data)
        return self.water.move(self.model, posture.center_of_mass, posture.time)

    def _set_posture(self, index: int, posture: Posture) -> None:
        """Set the posture of one of the robots, so that its center of mass is where it belongs."""
        tail = self.model.body(f"{mjcf.robot_prefix(index)}module_0")
        root_joint = tail.jntadr[0]
        coordinates = self.data.qpos[int(self.model.jnt_qposadr[root_joint]) :]
        position = coordinates[:3]
        angles = np.append(posture.joint_angle, posture.fin_angle)
        position[:] = 0.0
        coordinates[3:7] = posture.orientation
        end = N_FREE_ROOT + angles.size
        coordinates[N_FREE_ROOT:end] = angles
        of_scene = posture.scene_coordinates
        coordinates[end : end + of_scene.size] = of_scene
        self._update_kinematics()
        position[:] = posture.center_of_mass - self.data.subtree_com[tail.id]

    def _update_kinematics(self) -> None:
        mujoco = load_mujoco()
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_flex(self.model, self.data)

    @cached_property
    def _renderer(self) -> Any:
        return create_renderer(self.model)

    @cached_property
    def _option(self) -> Any:
        return _show_twine()

    def picture(
        self,
        posture: Posture,
        camera: Any = None,
        decorate: Callable[[Any], None] | None = None,
        more_postures: Sequence[Posture] = (),
    ) -> Picture:
        """Return the picture seen by a camera.

        Args:
            posture: Posture of the robot.
            camera: A `MjvCamera`; None: beside the robot, always in the same direction.
            decorate: Called with the `MjvScene` before it is drawn, to add what is not in the
                model.
            more_postures: Postures of the other robots.
        """
        changed_mesh = self.take(posture, *more_postures)
        renderer = self._renderer
        if changed_mesh is not None:
            renderer._gl_context.make_current()
            load_mujoco().mjr_uploadMesh(self.model, renderer._mjr_context, changed_mesh)
        if camera is None:
            camera = self._default_camera(posture)
        scene = self._update_scene(camera)
        draw_shadows(scene, self.model, self.data, self._shadow_casters)
        self.water.draw(scene, posture.center_of_mass, posture.time)
        if decorate is not None:
            decorate(scene)
        return renderer.render()

    def _default_camera(self, posture: Posture) -> Any:
        """Return a camera beside the robot, which may face in any direction."""
        width = self.robot.reach + 2.0 * abs(middle_ahead_of_center(self.robot))
        return aim_camera(
            self.robot,
            center=posture.center_of_mass,
            heading=0.0,
            aspect=self._renderer.width / self._renderer.height,
            wide=width,
        )

    def _update_scene(self, camera: Any) -> Any:
        """Return the scene that a camera sees, without shadows and lines."""
        renderer = self._renderer
        scene = renderer.scene
        # Infinite planes are placed where the camera was before.
        load_mujoco().mjv_updateCamera(self.model, self.data, camera, scene)
        renderer.update_scene(self.data, camera, self._option)
        flags = load_mujoco().mjtRndFlag
        # From a large distance, fog would hide the robot.
        scene.flags[flags.mjRND_FOG] = camera.distance < 0.5 * self.model.vis.map.fogend
        scene.flags[flags.mjRND_HAZE] = False
        scene.flags[flags.mjRND_SHADOW] = False
        scene.flags[flags.mjRND_REFLECTION] = False
        return scene

    def close(self) -> None:
        """Release the graphics memory."""
        has_renderer = "_renderer" in vars(self)
        if has_renderer:
            self._renderer.close()


def _height_range(region: np.ndarray, planar_height: float) -> tuple[float, float]:
    """Return the lowest and the highest position of a robot; in the plane, it has one height [m]."""
    n_axes = region.shape[1]
    if n_axes == 2:
        return planar_height, planar_height
    lowest, highest = region[:, 2]
    return lowest, highest


def _build_spec(
    robot: Robot, more_robots: Sequence[Robot], environment: Environment, model: Model | None
) -> Any:
    """Return the `MjSpec` of robots in a scene, without floor, light and water."""
    spec = mjcf.build_spec(
        robot,
        environment,
        sensors=False,
        scene=_scene_of(model),
        ballast_depth=ballast_of(robot, model),
    )
    for index, next_robot in enumerate(more_robots, 1):
        next_spec = mjcf.build_spec(
            next_robot, environment, sensors=False, ballast_depth=ballast_of(next_robot, model)
        )
        mjcf.add_robot(spec, next_spec, index)
    if model is not None:
        add_places(spec, model.places)
    return spec


def _scene_of(model: Model | None) -> Any:
    """Return what is around a robot according to a model's settings, or None."""
    if isinstance(model, Spatial):
        return model.scene
    return None


def _visible_level(
    environment: Environment, model: Model | None, highest: float, *, has_waves: bool
) -> float | None:
    """Return the height of the water's surface; None if it is out of sight [m]."""
    if isinstance(environment, Ground):
        return None
    scene = _scene_of(model)
    level = 0.0
    if scene is not None:
        level = scene.level
    if has_waves or highest > level - NEAR_SURFACE:
        return level
    return None


def _show_twine() -> Any:
    """Return what is drawn: of nets and ropes (flexes) the edges, without a skin between them."""
    mujoco = load_mujoco()
    option = mujoco.MjvOption()
    option.flags[mujoco.mjtVisFlag.mjVIS_FLEXEDGE] = True
    option.flags[mujoco.mjtVisFlag.mjVIS_FLEXSKIN] = False
    return option


def _set_picture(spec: Any, size: tuple[int, int]) -> None:
    """Set the size of the pictures of a `MjSpec`, and their angle of view."""
    width, height = size
    settings = spec.visual.global_
    settings.offwidth = width
    settings.offheight = height
    settings.fovy = VIEW_DEG


__getattr__ = renamed_names(
    __name__, {"posture_of": "laticauda.show.pictures.posture:read_posture"}
)
