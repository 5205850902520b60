"""A spatial plant's model in MuJoCo, and what the kernels need of it."""

import math
from threading import RLock
from types import ModuleType

import numpy as np

from laticauda import mujoco_water as water
from laticauda.actuation.laws import JointLaw
from laticauda.compiling.templates import specialized
from laticauda.dynamics.plant import FORCES, has_hinges, joint_table
from laticauda.extras import load_mujoco
from laticauda.mujoco_water import native, registry, table
from laticauda.robot import Environment, Ground, Robot
from laticauda.scenarios import Spatial
from laticauda.spatial import mjcf, rows, scene
from laticauda.spatial.bodies import center_of_mass
from laticauda.spatial.water_robot import on_ground, robot_elements

TEMPLATES = {"drives": ("joint_law",), "stepping": ("joint_law",)}


class Twin:
    """A robot, its place and a model's settings in MuJoCo. A resource: one march at a time, whoever has the `lock`."""

    def __init__(self, robot: Robot, environment: Environment, setup: Spatial) -> None:
        mujoco = load_mujoco()
        self.lock = RLock()
        land = land_of(environment, setup)
        ballast = setup.ballast_depth if setup.root == "free" and setup.gravity else 0.0
        spec = mjcf.spec(
            robot,
            environment,
            root=setup.root or "free",
            actuators="none",
            sensors=False,
            visuals=False,
            tank=setup.tank,
            ground=None if setup.shore is None else "ramp",
            ballast_depth=ballast,
        )
        if land is not None:
            spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT  # the ground is among the loads
            spec.option.gravity = (0.0, 0.0, -land.gravity)
        if not setup.gravity or setup.root == "planar":
            spec.option.gravity = (0.0, 0.0, 0.0)
        self.model = water.compiled(spec)
        if setup.joints.prescribed:  # they go where the gait says; a stop would only push the rest of the body
            self.model.jnt_limited[:] = 0
        if setup.dt is not None:
            self.model.opt.timestep = setup.dt
        self._data = mujoco.MjData(self.model)
        self.n_qpos, self.n_qvel = self.model.nq, self.model.nv
        self.height = float(self.model.body("module_0").pos[2])
        self.center = np.array((center_of_mass(robot), 0.0, -ballast * sum(m.mass for m in robot.modules) / robot.mass))
        self.joints = _joint_rows(robot, setup.joints)
        self.water = self._attach(robot, environment, setup)
        # Among the water's own numbers, so that it lives as long as the compiled code may read it.
        self._hold = np.zeros(2 * int(self.model.nv))
        self.water.numbers["hold"] = self._hold
        self.water.table[table.HOLD] = self._hold.ctypes.data
        self.water.table[table.HAS_INERTIA] = 1
        self._order = np.array([self.model.body(f"module_{i}").id for i in range(robot.n_links)])
        own = self.model.body_rootid == self._order[0]
        self._mass = np.where(own, self.model.body_mass, 0.0)
        self._setup = self._numbers(robot, setup)
        self._stepping = stepping(setup.joints)

    def _attach(self, robot: Robot, environment: Environment, setup: Spatial) -> water.Water:
        elements = robot_elements(robot, environment, floats=setup.gravity and setup.root == "free")
        land = land_of(environment, setup)
        if land is not None:
            elements = on_ground(elements, robot, land, wet=setup.shore is not None)
        if isinstance(environment, Ground):
            return water.attach(self.model, elements)
        terrain = None
        if setup.shore is not None:
            terrain = water.Terrain(
                height=scene.SHORE_HEIGHT, edge=scene.SHORE_END, slope=math.tan(scene.SLOPE), floor=-scene.TANK_DEPTH
            )
        return water.attach(
            self.model,
            elements,
            density=environment.density,
            current=(*environment.current, 0.0)[:3],
            surface=0.0 if setup.root == "free" and setup.gravity else None,
            form=environment.added_mass_form,
            terrain=terrain,
        )

    def _numbers(self, robot: Robot, setup: Spatial) -> np.ndarray:
        base = (3, 3) if setup.root == "planar" else (7, 6)
        fields = ("qpos", "qvel", "qacc", "xmat", "xipos", "subtree_com", "cvel")
        return np.array(
            [
                self.model._address,
                self._data._address,
                self.n_qpos,
                self.n_qvel,
                *base,
                robot.n_links,
                self.model.nbody,
                not setup.joints.prescribed or has_hinges(robot),
                setup.root == "planar",
                *native.offsets(*fields),
            ],
            dtype=np.int64,
        )

    def run(
        self,
        values: np.ndarray,
        given: tuple[np.ndarray, np.ndarray, list[water.Element]],
        steps: int,
        dt: float,
        every: int,
        log: np.ndarray,
    ) -> int:
        """Advance `values` in place; see `stepping.run`."""
        with self.lock:
            load_mujoco().mj_resetData(self.model, self._data)
            self.model.opt.timestep = dt
            registry.install()  # somebody else may have taken the callback since
            records = self.water.numbers["elements"].reshape(-1, table.ELEMENT_SIZE)
            for record, element in zip(records[len(records) - len(given[2]) :], given[2], strict=True):
                record[table.THRUST : table.THRUST + 3] = element.thrust
                record[table.ROTATION : table.ROTATION + 9] = element.rotation.ravel()
            robot = (self._mass, self._order, self._hold)
            return int(self._stepping.run(self._setup, values, *given[:2], *robot, steps, dt, every, log))

    def forces(self) -> np.ndarray:
        """Forces on every link where the last run ended, (3, n_links, 3) [N]; the fin's are the tail link's."""
        loads_on = self.water.forces(self._data)
        total = np.zeros((len(FORCES), self._order.size, 3))
        for i, element in enumerate(self.water.elements):
            link = int(element.body.removeprefix("module_")) if element.body.startswith("module_") else 0
            for k, name in enumerate(FORCES):
                total[k, link] += loads_on[name][i]
        return total


def stepping(joints: JointLaw) -> ModuleType:
    """The module `laticauda.spatial.stepping`, compiled on first call.

    Args:
        joints: Whose formula is compiled beside the built-in ones, if it is none of them.
    """
    return specialized("laticauda.spatial", TEMPLATES, {"joint_law": joints.own})


def land_of(environment: Environment, setup: Spatial) -> Ground | None:
    """The ground on which the robot lies with its weight; None: there is none, or it slides on it in the plane.

    Args:
        environment: The water it swims in, or the ground.
        setup: The model's settings.
    """
    if isinstance(environment, Ground) and setup.root == "free" and setup.gravity:
        return environment
    return setup.shore


def _joint_rows(robot: Robot, law: JointLaw) -> np.ndarray:
    """What the kernels know of every joint, in MuJoCo's order: the body's, then the fin's from its root on."""
    waves = [rows.YAW_WAVE if joint.axis == "yaw" else rows.PITCH_WAVE for joint in robot.joints]
    waves += [rows.NO_WAVE if k else rows.FIN_WAVE for k in robot.fin_joints]
    laws = [rows.PASSIVE if wave == rows.NO_WAVE else law.code for wave in waves]
    return np.column_stack((joint_table(robot, law), laws, waves))
