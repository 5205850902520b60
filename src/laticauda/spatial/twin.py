"""A spatial plant's model in MuJoCo, and what the kernels need of it."""

from threading import RLock
from types import ModuleType
from typing import Any

import numpy as np

from laticauda import mujoco_water as water
from laticauda.actuation.laws import JointLaw
from laticauda.compiling.templates import specialized
from laticauda.dynamics.plant import FORCES, has_hinges, joint_table
from laticauda.errors import BadArgument
from laticauda.extras import load_mujoco
from laticauda.mujoco_water import native, registry, table
from laticauda.robot import Environment, Ground, Robot, Scene
from laticauda.scenarios import Spatial
from laticauda.spatial import mjcf, rows, scene
from laticauda.spatial.bodies import center_of_mass, fin_bodies
from laticauda.spatial.water_robot import on_ground, robot_elements

DEEPEST = 2e-3  # how deep a robot may begin in a scene's geoms [m]
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
            scene=setup.scene,
            ballast_depth=ballast,
        )
        if setup.scene is not None:  # where the solver begins must not depend on what was marched before
            spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_WARMSTART
            # With little friction, MuJoCo's pyramids make contacts hundreds of times as stiff as they are meant to be.
            spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        if land is not None:
            for geom in spec.geoms:
                if geom.name in scene.GROUNDS:  # it is among the loads
                    geom.contype = geom.conaffinity = 0
            spec.option.gravity = (0.0, 0.0, -land.gravity)
        if not setup.gravity or setup.root == "planar":
            spec.option.gravity = (0.0, 0.0, 0.0)
        with scene.blamed():
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
        self.water.table[table.HAS_INERTIA], self.water.table[table.FIRST_ORDER] = 1, 0  # its steps are its own
        fin = fin_bodies(robot.caudal_fin) if robot.caudal_fin is not None else []
        names = [*(f"module_{i}" for i in range(robot.n_links)), *(body.name for body in fin)]
        self._order = np.array([self.model.body(name).id for name in names])
        own = self.model.body_rootid == self._order[0]
        self._mass = np.where(own, self.model.body_mass, 0.0)
        self._setup = self._numbers(robot, setup)
        self._stepping = stepping(setup.joints)

    def _attach(self, robot: Robot, environment: Environment, setup: Spatial) -> water.Water:
        elements = robot_elements(robot, environment, floats=setup.gravity and setup.root == "free")
        land = land_of(environment, setup)
        if land is not None:
            elements = on_ground(elements, robot, land, wet=not isinstance(environment, Ground))
        around = setup.scene or Scene()
        if isinstance(environment, Ground):
            return water.attach(self.model, elements, terrain=around.terrain)
        return water.attach(
            self.model,
            elements,
            density=environment.density,
            current=(*environment.current, 0.0)[:3],
            surface=around.level if setup.root == "free" and setup.gravity else None,
            form=environment.added_mass_form,
            terrain=around.terrain,
        )

    def _numbers(self, robot: Robot, setup: Spatial) -> np.ndarray:
        base = (3, 3) if setup.root == "planar" else (7, 6)
        fields = ("qpos", "qvel", "qacc", "xmat", "xipos", "subtree_com", "cvel", "cfrc_ext")
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
                setup.scene is not None,
                self._order.size - robot.n_links,
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
        current: tuple[float, ...] | None,
    ) -> int:
        """Advance `values` in place; see `stepping.run`. The `current` is that of the water now [m/s]."""
        with self.lock:
            load_mujoco().mj_resetData(self.model, self._data)
            self.model.opt.timestep = dt
            registry.install()  # somebody else may have taken the callback since
            if current is not None:
                self.water.set_current((*current, 0.0)[:3])
            records = self.water.numbers["elements"].reshape(-1, table.ELEMENT_SIZE)
            for record, element in zip(records[len(records) - len(given[2]) :], given[2], strict=True):
                record[table.THRUST : table.THRUST + 3] = element.thrust
                record[table.ROTATION : table.ROTATION + 9] = element.rotation.ravel()
            robot = (self._mass, self._order, self._hold)
            return int(self._stepping.run(self._setup, values, *given[:2], *robot, steps, dt, every, log))

    def forces(self) -> np.ndarray:
        """Forces on every link where the last run ended, (3, n_links, 3) [N]; the fin's are the tail link's."""
        loads_on = self.water.forces(self._data)
        total = np.zeros((len(FORCES), int(self._setup[rows.N_LINKS]), 3))
        for i, element in enumerate(self.water.elements):
            link = int(str(element.body).removeprefix("module_")) if str(element.body).startswith("module_") else 0
            for k, name in enumerate(FORCES):
                total[k, link] += loads_on[name][i]
        return total

    def check_free(self, data: Any) -> None:
        """Refuse a start at which the robot is inside something.

        Args:
            data: A `mujoco.MjData` at the start, with its kinematics.
        """
        load_mujoco().mj_collision(self.model, data)
        for touch in data.contact[: data.ncon]:
            bodies = [int(self.model.geom_bodyid[k]) for k in touch.geom]
            mine = [k for k, body in enumerate(bodies) if body in self._order]
            if touch.dist < -DEEPEST and len(mine) == 1:
                link, other = (self.model.geom(int(touch.geom[k])).name for k in (mine[0], 1 - mine[0]))
                depth = f"{link.removesuffix('_hull')} is {-1e3 * touch.dist:.0f} mm deep in it"
                raise BadArgument("start", f"must not put the robot into `{other}` of the scene, but {depth}")

    def ranges(self, data: Any, rays: tuple[float, ...]) -> np.ndarray:
        """Distances from the tip of the head [m], infinite where there is nothing.

        Args:
            data: A `mujoco.MjData` with its kinematics.
            rays: Directions in the head's plane, from its x axis to its left [rad].
        """
        mujoco, n = load_mujoco(), int(self._setup[rows.N_LINKS])
        head, geom = int(self._order[n - 1]), np.zeros(1, dtype=np.int32)
        turned, tip = data.xmat[head].reshape(3, 3), data.site(f"module_{n - 1}_center").xpos
        tip = data.xpos[head] + 2.0 * (tip - data.xpos[head])
        ways = [turned @ (np.cos(angle), np.sin(angle), 0.0) for angle in rays]
        found = np.array([mujoco.mj_ray(self.model, data, tip, way, None, 1, head, geom) for way in ways])
        return np.where(found < 0.0, np.inf, found)


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
    own = None if setup.scene is None else setup.scene.ground
    if isinstance(environment, Ground):
        return (own or environment) if setup.root == "free" and setup.gravity else None
    return own


def _joint_rows(robot: Robot, law: JointLaw) -> np.ndarray:
    """What the kernels know of every joint, in MuJoCo's order: the body's, then the fin's from its root on."""
    waves = [rows.YAW_WAVE if joint.axis == "yaw" else rows.PITCH_WAVE for joint in robot.joints]
    waves += [rows.NO_WAVE if k else rows.FIN_WAVE for k in robot.fin_joints]
    laws = [rows.PASSIVE if wave == rows.NO_WAVE else law.code for wave in waves]
    return np.column_stack((joint_table(robot, law), laws, waves))
