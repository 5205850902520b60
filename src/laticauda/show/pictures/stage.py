"""A robot in its surroundings as drawn by MuJoCo: light, shadows, water and the renderer; no simulation."""

import os
import platform
from collections.abc import Callable, Sequence
from functools import cached_property
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, UInt8

from laticauda.models.dynamics import Plant, PlantState
from laticauda.models.planar import PlanarPlant, rows
from laticauda.models.spatial import SpatialPlant, ballast_of, mjcf
from laticauda.robot import Environment, Ground, Robot
from laticauda.scenarios import Model, Spatial
from laticauda.show.pictures.camera import (
    VIEW_DEG,
    aim_camera,
    lift_to_space,
    middle_ahead_of_center,
)
from laticauda.show.pictures.surroundings import (
    MovingWater,
    add_surroundings,
    draw_shadows,
    shadow_casters,
)
from laticauda.values import MissingProgram, load_mujoco, optional_import
from laticauda.water.fluid import MOMENTS, has_waves

PACKAGES = "libegl1 libegl-mesa0 libgl1-mesa-dri libopengl0"
MOST_SHAPES = 4000
MID_WATER, FLOOR = (
    1.0,
    1.5,
)  # depth at which a robot without one is shown, and minimum depth of the floor [m]
DEEP = 2.0  # depth to which a robot in space may dive above the floor, if its range is unknown [m]
NEAR = 0.3  # distance to the surface within which the surface is shown [m]
NEARBY = np.array(((-2.0, -2.0), (2.0, 2.0)))
CLEARANCE = 0.45  # minimum height above the floor [m]
SIZE = (640, 360)  # [pixels]
Picture = UInt8[np.ndarray, "height width 3"]


class Posture(NamedTuple):
    """Posture of a robot at one instant."""

    center_of_mass: Float[np.ndarray, "3"]
    """Position of the center of mass [m]."""
    orientation: Float[np.ndarray, "4"]
    """Orientation of module 0, a quaternion (w, x, y, z) [-]."""
    joint_angle: Float[np.ndarray, " n_joints"]
    """Angles of all joints of the robot, including those that the planar model holds straight [rad]."""
    fin_angle: Float[np.ndarray, " n_fin_joints"]
    """Angles of the joints of a driven or bending fin, starting at its root; straight if they are unknown [rad]."""
    time: float = 0.0
    """Time since the start of the run, which determines the motion of the water [s]."""


class Studio:
    """The model of a robot and its surroundings, its state, and a camera; a resource to be closed.

    Args:
        robot: The robot to show.
        environment: Environment of the robot.
        model: Model whose settings define what else is there; None: nothing.
        others: Further robots in the same surroundings.
        way: Two corners of the region of its center of mass, in space or, for a planar run, in the
            plane [m].
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
        others: Sequence[Robot] = (),
        way: Float[np.ndarray, "2 n_axes"] = NEARBY,
        times: Sequence[float] = MOMENTS,
        size: tuple[int, int] = SIZE,
    ) -> None:
        self.robot, self.height = robot, swimming_height(robot, environment)
        scene = model.scene if isinstance(model, Spatial) else None
        spec = mjcf.build_spec(
            robot, environment, sensors=False, scene=scene, ballast_depth=ballast_of(robot, model)
        )
        for k, other in enumerate(others, 1):
            alone = mjcf.build_spec(
                other, environment, sensors=False, ballast_depth=ballast_of(other, model)
            )
            mjcf.add_robot(spec, alone, k)
        on_land, (lowest, highest) = (
            isinstance(environment, Ground),
            np.append(way, [[self.height]] * 2, axis=1)[:, 2],
        )
        self.floor = 0.0 if on_land else min(-FLOOR, lowest - CLEARANCE)
        """Height of the floor of the water, or of the ground [m]."""
        level = 0.0 if scene is None else scene.level
        self.water = MovingWater(environment, robot.reach, way, times)
        """Motion of the water."""
        waves = self.water.mesh(spec)
        level = level if not on_land and (waves or highest > level - NEAR) else None
        add_surroundings(
            spec, environment, floor=self.floor, length=robot.reach, level=level, waves=waves
        )
        picture = spec.visual.global_
        (picture.offwidth, picture.offheight), picture.fovy = size, VIEW_DEG
        self.model: Any = spec.compile()
        self.data: Any = load_mujoco().MjData(self.model)
        self._casters = shadow_casters(self.model)

    def take(self, posture: Posture, *others: Posture) -> int | None:
        """Set the postures of the robot and of the others; return the mesh to be sent to a renderer, if any."""
        mujoco, data = load_mujoco(), self.data
        for k, one in enumerate((posture, *others)):
            body = self.model.body(f"{mjcf.robot_prefix(k)}module_0")
            angles = np.append(one.joint_angle, one.fin_angle)
            q = data.qpos[int(self.model.jnt_qposadr[body.jntadr[0]]) :]
            q[:3], q[3:7] = 0.0, one.orientation
            q[7 : 7 + angles.size] = angles
            mujoco.mj_kinematics(self.model, data)
            mujoco.mj_comPos(self.model, data)
            q[:3] = one.center_of_mass - data.subtree_com[body.id]
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_comPos(self.model, data)
        mujoco.mj_camlight(self.model, data)
        return self.water.move(self.model, posture.center_of_mass, posture.time)

    @classmethod
    def of(cls, plant: Plant[Any], size: tuple[int, int] = SIZE) -> "Studio":
        """Return a studio for states of a plant."""
        heights = [[-DEEP], [swimming_height(plant.robot, plant.environment)]]
        way = np.append(NEARBY, heights, axis=1) if isinstance(plant, SpatialPlant) else NEARBY
        return cls(plant.robot, plant.environment, plant.settings, way=way, size=size)

    @cached_property
    def _renderer(self) -> Any:
        return renderer_of(self.model)

    def picture(
        self,
        posture: Posture,
        camera: Any = None,
        decorate: Callable[[Any], None] | None = None,
        others: Sequence[Posture] = (),
    ) -> Picture:
        """Return the picture seen by a camera.

        Args:
            posture: Posture of the robot.
            camera: A `MjvCamera`; None: beside the robot, always in the same direction.
            decorate: Called with the `MjvScene` before it is drawn, to add what is not in the
                model.
            others: Postures of the other robots.
        """
        surface, renderer, flags = (
            self.take(posture, *others),
            self._renderer,
            load_mujoco().mjtRndFlag,
        )
        if surface is not None:
            renderer._gl_context.make_current()
            load_mujoco().mjr_uploadMesh(self.model, renderer._mjr_context, surface)
        aspect = renderer.width / renderer.height
        wide = self.robot.reach + 2.0 * abs(
            middle_ahead_of_center(self.robot)
        )  # the robot may face in any direction
        camera = camera or aim_camera(self.robot, posture.center_of_mass, 0.0, aspect, wide=wide)
        # Infinite planes are placed where the camera was before.
        load_mujoco().mjv_updateCamera(self.model, self.data, camera, renderer.scene)
        renderer.update_scene(self.data, camera)
        scene = renderer.scene
        scene.flags[flags.mjRND_FOG] = (
            camera.distance < 0.5 * self.model.vis.map.fogend
        )  # else it hides the robot
        scene.flags[flags.mjRND_HAZE] = scene.flags[flags.mjRND_SHADOW] = scene.flags[
            flags.mjRND_REFLECTION
        ] = False
        draw_shadows(scene, self.model, self.data, self._casters)
        self.water.draw(scene, posture.center_of_mass, posture.time)
        if decorate is not None:
            decorate(scene)
        return renderer.render()

    def close(self) -> None:
        """Release the graphics memory."""
        if "_renderer" in vars(self):
            self._renderer.close()


def posture_of(plant: Plant[Any], state: PlantState) -> Posture:
    """Return the posture of a plant's robot in a state.

    Args:
        plant: A plant of either model.
        state: A state of the plant.
    """
    seen, robot = plant.observe(state), plant.robot
    if isinstance(plant, SpatialPlant):
        qpos = plant.data(state).qpos
        turned = upright(float(qpos[2])) if plant.settings.root == "planar" else qpos[3:7]
        first = (
            3 if plant.settings.root == "planar" else 7
        )  # moving parts of its scene may follow the robot's
        angles, n = qpos[first:][: len(robot.joints) + len(robot.fin_joints)], robot.n_joints
        return Posture(seen.center_of_mass, turned, angles[:n], angles[n:], float(seen.time))
    assert isinstance(plant, PlanarPlant)
    fin = [state.values[rows.LOG_STATE + plant.layout.tail_link - 1 - k] for k in robot.fin_joints]
    height = swimming_height(robot, plant.environment)
    flat = flat_posture(
        robot, seen.center_of_mass, seen.link_angle[0], seen.joint_angle, np.array(fin), height
    )
    return flat._replace(time=float(seen.time))


def flat_posture(
    robot: Robot,
    center: np.ndarray,
    tail: float,
    joint_angle: np.ndarray,
    fin_angle: np.ndarray,
    height: float,
) -> Posture:
    """Return the posture of an upright robot.

    Args:
        robot: The robot with all its joints; if only angles of its yaw joints are known, the others
            are straight.
        center: Center of mass, in the plane or in space [m].
        tail: Angle of its tail link [rad].
        joint_angle: Angles of all joints, or of the yaw joints only [rad].
        fin_angle: Angles of the fin's joints [rad].
        height: Its height if `center` is planar [m].
    """
    if joint_angle.size < robot.n_joints:
        yaw, joint_angle = (
            joint_angle,
            np.zeros(robot.n_joints),
        )  # the planar model holds the others straight
        joint_angle[[i for i, joint in enumerate(robot.joints) if joint.axis == "yaw"]] = yaw
    return Posture(lift_to_space(center, height), upright(tail), joint_angle, fin_angle)


def upright(angle: float) -> Float[np.ndarray, "4"]:
    """Return the orientation after a rotation about the vertical [rad]."""
    return np.array([np.cos(0.5 * angle), 0.0, 0.0, np.sin(0.5 * angle)])


def swimming_height(robot: Robot, environment: Environment) -> float:
    """Return the height at which a planar robot is shown [m]; the water surface, or the ground, is at 0."""
    if isinstance(environment, Ground):
        return mjcf.start_height(robot, environment)
    if environment.depth is None:  # a flow acts on it as if at the surface
        return 0.0 if has_waves(environment.flow, np.zeros(2)) else -MID_WATER
    return -environment.depth


def check_offscreen() -> None:
    """Check that rendering is possible here; raises the same errors as `Studio`."""
    renderer_of(load_mujoco().MjSpec().compile()).close()


def renderer_of(model: Any) -> Any:
    """Return MuJoCo's renderer of a model, as large as its off-screen buffer.

    If the environment variable `MUJOCO_GL` is not set, it draws with EGL on Linux, which needs no
    screen; MuJoCo's own choice, made when it was imported, may need one.
    """
    mujoco = load_mujoco()
    optional_import("Rendering", "PyOpenGL", "spatial", "OpenGL")
    try:
        contexts = import_module(mujoco.Renderer.__module__).gl_context
        usual = contexts.GLContext
        if platform.system() == "Linux" and not os.environ.get("MUJOCO_GL"):
            contexts.GLContext = import_module("mujoco.egl").GLContext
        try:
            size = model.vis.global_
            return mujoco.Renderer(model, size.offheight, size.offwidth, MOST_SHAPES)
        finally:
            contexts.GLContext = usual
    except Exception as error:
        # Depending on what is missing, PyOpenGL raises an AttributeError, an ImportError or an
        # error of its own.
        raise MissingProgram(
            "Rendering without a screen", "EGL with a driver (Mesa's will do)", PACKAGES
        ) from error
