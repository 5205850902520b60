"""How the arrays of all robots in one MuJoCo model are laid out for the kernels; see `rows`."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.models.dynamics.joint_table import has_hinges, joint_table
from laticauda.models.spatial import rows
from laticauda.models.spatial.bodies import build_fin_bodies
from laticauda.models.spatial.settings import numbers_per_link
from laticauda.motion.joints import JointLaw
from laticauda.robot import Module, Robot
from laticauda.scenarios import Spatial
from laticauda.values import load_mujoco
from laticauda.water.mujoco import native

NUMBERS_PER_JOINT = 4
"""Numbers of a sample for each joint of body and fin: angle, rate, reference and torque."""
PLANAR_ROOT_SIZE = 3
"""Size of qpos and of qvel of a planar root: two slides and a hinge."""
FREE_ROOT_POSITIONS = 7
"""Size of qpos of a free root: a position and a quaternion."""
FREE_ROOT_RATES = 6
"""Size of qvel of a free root: a velocity and an angular velocity."""

AXES_OF_VELOCITY = 3
"""Rates of a free body that come before those of its rotation."""


class Member(NamedTuple):
    """One of the robots in a model."""

    robot: Robot
    """The robot."""
    setup: Spatial
    """Its settings."""
    prefix: str
    """What its names in the model begin with."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LocatedRobot:
    """A robot, located in a compiled model."""

    member: Member
    """The robot with its settings."""
    bodies: list[int]
    """Number of the body of every module and every piece of the fin."""
    is_own: Bool[np.ndarray, " n_bodies"]
    """Whether each body of the model is part of the robot."""
    n_joints: int
    """Joints of body and fin."""

    @property
    def n_state(self) -> int:
        """Numbers of its state, without qpos and qvel."""
        return rows.STATE_ROWS + self._n_link_numbers

    @property
    def n_columns(self) -> int:
        """Columns of its part of a sample."""
        header = rows.STATE_ROWS + rows.SAMPLE_HEADER
        return header + self._n_link_numbers + NUMBERS_PER_JOINT * self.n_joints

    @property
    def _n_link_numbers(self) -> int:
        return self.member.robot.n_links * numbers_per_link(self.member.setup)


def locate_robot(model: Any, member: Member) -> LocatedRobot:
    """Locate a robot in a compiled model.

    Args:
        model: A `mujoco.MjModel`.
        member: The robot with its settings.
    """
    robot = member.robot
    names = [f"module_{i}" for i in range(robot.n_links)]
    if robot.caudal_fin is not None:
        names += [body.name for body in build_fin_bodies(robot.caudal_fin)]
    bodies = [int(model.body(member.prefix + name).id) for name in names]
    return LocatedRobot(
        member=member,
        bodies=bodies,
        is_own=model.body_rootid == bodies[0],
        n_joints=len(build_joint_rows(robot, member.setup.joints)),
    )


def build_places(model: Any, robots: Sequence[LocatedRobot]) -> Int[np.ndarray, "n_rows n_places"]:
    """Return where each robot's part of the arrays of all robots begins; a last row holds the ends.

    The parts of the commands are not yet known, because a command may hold a recording.
    """
    places = np.zeros((len(robots) + 1, rows.PLACES), dtype=np.int64)
    for k, robot in enumerate(robots):
        begin = places[k]
        end = places[k + 1]
        root_joint = int(model.body_jntadr[robot.bodies[0]])
        begin[rows.FIRST_QPOS] = model.jnt_qposadr[root_joint]
        begin[rows.FIRST_QVEL] = model.jnt_dofadr[root_joint]
        end[rows.FIRST_STATE] = begin[rows.FIRST_STATE] + robot.n_state
        end[rows.FIRST_JOINT] = begin[rows.FIRST_JOINT] + robot.n_joints
        end[rows.FIRST_BODY] = begin[rows.FIRST_BODY] + len(robot.bodies)
        end[rows.FIRST_COLUMN] = begin[rows.FIRST_COLUMN] + robot.n_columns
    return places


def build_setup(model: Any, data: Any, robot: LocatedRobot) -> Int[np.ndarray, " n_integers"]:
    """Return the integers that the kernels need to know of a robot.

    Args:
        model: A `mujoco.MjModel`.
        data: Its `mujoco.MjData`, in which the kernels work.
        robot: The robot.
    """
    settings = robot.member.setup
    n_links = robot.member.robot.n_links
    is_planar = settings.root == "planar"
    setup = np.zeros(rows.SETUP_SIZE, dtype=np.int64)
    setup[: rows.MODEL] = native.offsets()
    setup[rows.MODEL] = model._address
    setup[rows.DATA] = data._address
    setup[rows.N_QPOS] = model.nq
    setup[rows.N_QVEL] = model.nv
    setup[rows.N_BASE_QPOS] = FREE_ROOT_POSITIONS
    setup[rows.N_BASE_QVEL] = FREE_ROOT_RATES
    if is_planar:
        setup[rows.N_BASE_QPOS] = PLANAR_ROOT_SIZE
        setup[rows.N_BASE_QVEL] = PLANAR_ROOT_SIZE
    setup[rows.N_LINKS] = n_links
    setup[rows.N_BODIES] = model.nbody
    setup[rows.IS_IMPLICIT] = not settings.joints.prescribed or has_hinges(robot.member.robot)
    setup[rows.IS_PLANAR] = is_planar
    setup[rows.HAS_SCENE] = settings.surroundings is not None
    setup[rows.N_FLEXES] = model.nflex
    setup[rows.CONTACTS : rows.GEOM_BODY] = native.contact_layout()
    setup[rows.GEOM_BODY] = model.geom_bodyid.ctypes.data
    setup[rows.N_FIN_BODIES] = len(robot.bodies) - n_links
    return setup


def find_spins(model: Any) -> Int[np.ndarray, " n_spins"]:
    """Return the first of the three rates of every body or joint that turns freely, among those of the model.

    Args:
        model: A `mujoco.MjModel`.
    """
    kinds = load_mujoco().mjtJoint
    free = model.jnt_dofadr[model.jnt_type == kinds.mjJNT_FREE] + AXES_OF_VELOCITY
    balls = model.jnt_dofadr[model.jnt_type == kinds.mjJNT_BALL]
    return np.sort(np.concatenate((free, balls))).astype(np.int64)


def index_motion(model: Any, robots: Sequence[LocatedRobot]) -> list[Int[np.ndarray, " n_own"]]:
    """Return the indices of each robot's qpos and qvel among those of all.

    They include those of the moving parts of the scene, which belong to no robot.
    """
    is_of_robots = np.any([robot.is_own for robot in robots], axis=0)
    body_of_qpos = np.repeat(model.jnt_bodyid, np.diff([*model.jnt_qposadr, model.nq]))
    body_of_motion = np.concatenate((body_of_qpos, model.dof_bodyid))
    indices: list[np.ndarray] = []
    for robot in robots:
        is_moved = robot.is_own | ~is_of_robots
        indices.append(np.flatnonzero(is_moved[body_of_motion]))
    return indices


def build_joint_rows(robot: Robot, law: JointLaw) -> Float[np.ndarray, "n_joints n_numbers"]:
    """Return the joint parameters for the kernels in MuJoCo's order: the body's, then the fin's from its root.

    Args:
        robot: The robot.
        law: Law by which its driven joints follow their references.
    """
    wave_of_axis = {"yaw": rows.YAW_WAVE, "pitch": rows.PITCH_WAVE}
    waves = [wave_of_axis[joint.axis] for joint in robot.joints]
    laws = [law.code] * robot.n_joints
    inertias = [_inertia_about_end(module) for module in robot.modules[1:]]
    for k in robot.fin_joints:
        inertias.append(_inertia_about_end(robot.modules[0]))
        is_driven = k == 0
        if is_driven:
            waves.append(rows.FIN_WAVE)
            laws.append(law.code)
        else:
            waves.append(rows.NO_WAVE)
            laws.append(rows.PASSIVE)
    return np.column_stack((joint_table(robot, law), laws, waves, inertias))


def _inertia_about_end(module: Module) -> float:
    """Return the inertia of a module about its end, as that of a thin rod [kg m^2]."""
    return module.mass * module.length**2 / 3.0
