"""The MuJoCo model of a spatial plant, and what the kernels need from it."""

from collections.abc import Sequence
from dataclasses import replace
from threading import RLock
from types import ModuleType
from typing import Any

import numpy as np

from laticauda.compiling.templates import specialized
from laticauda.models.dynamics.plant import FORCES, has_hinges, joint_table
from laticauda.models.spatial import mjcf, rows, scene, water_robot
from laticauda.models.spatial.bodies import fin_bodies, straight_center_of_mass
from laticauda.motion.joints import JointLaw
from laticauda.robot import Environment, Ground, Robot, Scene, Water
from laticauda.scenarios import Spatial
from laticauda.values import load_mujoco
from laticauda.water import mujoco as water
from laticauda.water.mujoco import callback, native, table

TEMPLATES = {"drives": ("joint_law",), "stepping": ("joint_law",)}


class Twin:
    """Robots, surroundings and a model's settings in MuJoCo. A resource for one run at a time, guarded by `lock`.

    Args:
        robot: The first robot, to which all single-robot attributes refer; its names in the model
            have no prefix.
        environment: Environment of the robots.
        setup: Model settings of the first robot, with the scene.
        others: Further robots with their settings; names of the k-th begin with `robot_k_`.
    """

    def __init__(
        self,
        robot: Robot,
        environment: Environment,
        setup: Spatial,
        others: Sequence[tuple[Robot, Spatial]] = (),
    ) -> None:
        self.lock = RLock()
        ballast = setup.ballast_depth if is_floating(setup) else 0.0
        spec = spec_of(robot, environment, setup)
        members = [(*one, mjcf.robot_prefix(k)) for k, one in enumerate(((robot, setup), *others))]
        with scene.reporting_scene_errors():
            for k, (other, own) in enumerate(others, 1):
                mjcf.add_robot(spec, spec_of(other, environment, replace(own, scene=Scene())), k)
            self.model = water.compile_spec(spec)
        if setup.dt is not None:
            self.model.opt.timestep = setup.dt
        self._data, self._n_links = load_mujoco().MjData(self.model), robot.n_links
        self.n_qpos, self.n_qvel = self.model.nq, self.model.nv
        self.height = float(self.model.body("module_0").pos[2])
        self.center = np.array(
            (
                straight_center_of_mass(robot),
                0.0,
                -ballast * sum(m.mass for m in robot.modules) / robot.mass,
            )
        )
        self.joints = _joint_rows(robot, setup.joints)
        self._lay_out(members)
        found = [
            [replace(e, body=p + e.body) for e in _elements(r, environment, s)]
            for r, s, p in members
        ]
        self._ends = np.cumsum([len(one) for one in found]).tolist()
        self.water = self._attach([e for one in found for e in one], environment, setup)
        # Stored with the water's own numbers, so that it lives as long as the compiled code may
        # read it.
        self._hold = self.water.numbers["hold"] = np.zeros(2 * int(self.model.nv))
        self.water.table[table.HOLD] = self._hold.ctypes.data
        self.water.table[table.HAS_INERTIA], self.water.table[table.FIRST_ORDER] = (
            1,
            0,
        )  # it uses its own integrators
        self.water.numbers["water"][table.LEVEL] = (
            setup.scene or Scene()
        ).level  # height from which a flow measures z
        self._stepping = stepping(setup.joints)

    def _attach(
        self, elements: Sequence[water.Element], environment: Environment, setup: Spatial
    ) -> water.Water:
        around = setup.scene or Scene()
        if isinstance(environment, Ground):
            return water.attach(self.model, elements, terrain=around.terrain)
        return water.attach(
            self.model,
            elements,
            density=environment.density,
            current=environment.flow or environment.uniform,
            surface=around.level if is_floating(setup) else None,
            form=environment.added_mass_form,
            terrain=around.terrain,
        )

    def _lay_out(self, members: Sequence[tuple[Robot, Spatial, str]]) -> None:
        """Set the layout of each robot's arrays, its setup for the kernels, and what its shapes can touch."""
        model, n_all = self.model, len(members)
        self.places, self._masses = (
            np.zeros((n_all + 1, rows.PLACES), dtype=np.int64),
            np.zeros((n_all, model.nbody)),
        )
        setups: list[np.ndarray] = []
        order: list[int] = []
        for k, (robot, setup, prefix) in enumerate(members):
            fin = fin_bodies(robot.caudal_fin) if robot.caudal_fin is not None else []
            names = [*(f"module_{i}" for i in range(robot.n_links)), *(body.name for body in fin)]
            bodies = [int(model.body(prefix + name).id) for name in names]
            mine, root = model.body_rootid == bodies[0], int(model.body_jntadr[bodies[0]])
            self._masses[k] = np.where(mine, model.body_mass, 0.0)
            if (
                setup.joints.prescribed
            ):  # they follow the gait; a stop would only push the rest of the body
                model.jnt_limited[mine[model.jnt_bodyid]] = 0
            if n_all > 1:  # its shapes touch those of the others but not each other
                touching, others = (
                    mine[model.geom_bodyid] & (model.geom_contype == 1),
                    (2 << n_all) - 2 - (2 << k),
                )
                model.geom_contype[touching], model.geom_conaffinity[touching] = 1 | 2 << k, others
                model.body_contype[mine], model.body_conaffinity[mine] = (
                    1 | 2 << k,
                    others,
                )  # checked first
            n_joints = len(_joint_rows(robot, setup.joints))
            of_links = robot.n_links * (1 if setup.scene is None else 4)
            columns = rows.STATE_ROWS + rows.SAMPLE_HEADER + of_links + 4 * n_joints
            sizes = rows.STATE_ROWS + of_links, 0, n_joints, len(bodies), columns
            self.places[k + 1, : len(sizes)] = self.places[k, : len(sizes)] + sizes
            self.places[k, [rows.FIRST_QPOS, rows.FIRST_QVEL]] = (
                model.jnt_qposadr[root],
                model.jnt_dofadr[root],
            )
            setups.append(self._numbers(robot, setup, len(bodies)))
            order += bodies
        self._setups, self.order = np.array(setups), np.array(order)
        of_q, robots = (
            np.repeat(model.jnt_bodyid, np.diff([*model.jnt_qposadr, model.nq])),
            self._masses > 0.0,
        )
        # Indices of each robot's qpos and qvel, and of those of other moving parts of the scene,
        # among those of all.
        seen = [own | ~robots.any(axis=0) for own in robots]
        self._here = [np.flatnonzero(np.r_[one[of_q], one[model.dof_bodyid]]) for one in seen]

    def _numbers(self, robot: Robot, setup: Spatial, n_bodies: int) -> np.ndarray:
        base = (3, 3) if setup.root == "planar" else (7, 6)
        return np.array(
            [
                *native.offsets(),
                self.model._address,
                self._data._address,
                self.n_qpos,
                self.n_qvel,
                *base,
                robot.n_links,
                self.model.nbody,
                not setup.joints.prescribed or has_hinges(robot),
                setup.root == "planar",
                setup.scene is not None,
                n_bodies - robot.n_links,
            ],
            dtype=np.int64,
        )

    def run(
        self,
        each: Sequence[np.ndarray],
        given: Sequence[tuple[np.ndarray, np.ndarray, list[water.Element]]],
        steps: int,
        dt: float,
        every: int,
        environment: Environment,
    ) -> np.ndarray:
        """Advance the states `each` in place and return all samples; `environment` has the water's current motion."""
        with self.lock:
            load_mujoco().mj_resetData(self.model, self._data)
            self.model.opt.timestep = dt
            callback.install()  # another package may have replaced the callback since
            if isinstance(environment, Water):
                self.water.set_current(environment.flow or environment.uniform)
            records = self.water.numbers["elements"].reshape(-1, table.ELEMENT_SIZE)
            for end, (_, _, effectors) in zip(self._ends, given, strict=True):
                for record, element in zip(
                    records[end - len(effectors) : end], effectors, strict=True
                ):
                    record[table.THRUST : table.THRUST + 3] = element.thrust
                    record[table.ROTATION : table.ROTATION + 9] = element.rotation.ravel()
            at, (parts, moving) = rows.STATE_ROWS, self._parts(each)
            states = np.concatenate([part for head, _, tail in parts for part in (head, tail)])
            places, log = (
                self.places.copy(),
                np.empty((1 + steps // every, self.places[-1, rows.FIRST_COLUMN])),
            )
            places[1:, rows.FIRST_GIVEN] = np.cumsum([one[0].size for one in given])
            told = (
                np.concatenate([one[0] for one in given]),
                np.concatenate([one[1] for one in given]),
            )
            robots = self._masses, self.order, self._hold
            written = self._stepping.run(
                self._setups, places, states, moving, *told, *robots, steps, dt, every, log
            )
            for (head, own, tail), here, a in zip(
                parts, self._here, places[:, rows.FIRST_STATE], strict=False
            ):
                own[:], head[:] = moving[here], states[a : a + at]
                tail[:] = states[a + at :][: tail.size]
            return log[:written]

    def _parts(self, each: Sequence[np.ndarray]) -> tuple[list[list[np.ndarray]], np.ndarray]:
        """Split each state into its rows, qpos with qvel, and the rest; also return qpos and qvel of all."""
        at, moving = rows.STATE_ROWS, np.empty(self.n_qpos + self.n_qvel)
        parts = [
            np.split(values, [at, at + here.size])
            for values, here in zip(each, self._here, strict=True)
        ]
        for (_, own, _), here in zip(parts, self._here, strict=True):
            moving[here] = own
        return parts, moving

    def data(self, each: Sequence[np.ndarray]) -> Any:
        """Return a new `mujoco.MjData` at the robots' states `each`, with kinematics, separate from the runs' own."""
        data, (_, moving) = load_mujoco().MjData(self.model), self._parts(each)
        data.time, (data.qpos[:], data.qvel[:]) = (
            each[0][rows.TIME],
            np.split(moving, [self.n_qpos]),
        )
        load_mujoco().mj_kinematics(self.model, data)
        load_mujoco().mj_comPos(self.model, data)
        return data

    def forces(self) -> np.ndarray:
        """Return forces on every link after the last run, (3, n_links, 3) [N]; the tail link's include the fin's."""
        loads_on = self.water.forces(self._data)
        total = np.zeros((len(FORCES), self._n_links, 3))
        for i, element in enumerate(self.water.elements):
            link = (
                int(str(element.body).removeprefix("module_"))
                if str(element.body).startswith("module_")
                else 0
            )
            for k, name in enumerate(FORCES):
                total[k, link] += loads_on[name][i]
        return total

    def ranges(self, data: Any, rays: tuple[float, ...]) -> np.ndarray:
        """Return distances from the tip of the head [m], infinite where nothing is hit.

        Args:
            data: A `mujoco.MjData` with computed kinematics.
            rays: Directions in the head's plane, from its x axis to its left [rad].
        """
        mujoco, n = load_mujoco(), self._n_links
        head, geom = int(self.order[n - 1]), np.zeros(1, dtype=np.int32)
        turned, tip = data.xmat[head].reshape(3, 3), data.site(f"module_{n - 1}_center").xpos
        tip = data.xpos[head] + 2.0 * (tip - data.xpos[head])
        ways = [turned @ (np.cos(angle), np.sin(angle), 0.0) for angle in rays]
        found = np.array(
            [mujoco.mj_ray(self.model, data, tip, way, None, 1, head, geom) for way in ways]
        )
        return np.where(found < 0.0, np.inf, found)


def stepping(joints: JointLaw) -> ModuleType:
    """Return the module `laticauda.models.spatial.stepping`, compiled on first call.

    Args:
        joints: Joint law whose formula is compiled in addition to the built-in ones, unless it is
            one of them.
    """
    return specialized("laticauda.models.spatial", TEMPLATES, {"joint_law": joints.own})


def _elements(robot: Robot, environment: Environment, setup: Spatial) -> tuple[water.Element, ...]:
    """Return the elements of a robot on which the water and the ground act."""
    found = water_robot.robot_elements(robot, environment, floats=is_floating(setup))
    land = land_of(environment, setup)
    return (
        found
        if land is None
        else water_robot.lay_on_ground(found, robot, land, wet=not isinstance(environment, Ground))
    )


def spec_of(robot: Robot, environment: Environment, setup: Spatial) -> Any:
    """Return the `mujoco.MjSpec` of a robot in its surroundings.

    Args:
        robot: The robot.
        environment: The water it swims in, or the ground.
        setup: The model's settings.
    """
    mujoco, land = load_mujoco(), land_of(environment, setup)
    spec = mjcf.build_spec(
        robot,
        environment,
        root=setup.root or "free",
        sensors=False,
        visuals=False,
        scene=setup.scene,
        ballast_depth=setup.ballast_depth if is_floating(setup) else 0.0,
    )
    if setup.scene is not None:  # the solver's initial guess must not depend on earlier runs
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_WARMSTART
        # At low friction, MuJoCo's pyramidal cones make contacts hundreds of times stiffer than
        # intended.
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    if land is not None:
        for geom in spec.geoms:
            if geom.name in scene.GROUNDS:  # it acts through the loads
                geom.contype = geom.conaffinity = 0
        spec.option.gravity = (0.0, 0.0, -land.gravity)
    if not setup.gravity or setup.root == "planar":
        spec.option.gravity = (0.0, 0.0, 0.0)
    return spec


def is_floating(setup: Spatial) -> bool:
    """Return whether `setup` has weight and buoyancy, and a root that they can move."""
    return setup.gravity and setup.root == "free"


def land_of(environment: Environment, setup: Spatial) -> Ground | None:
    """Return the ground on which the robot lies with its weight; None if there is none, or if it slides in the plane.

    Args:
        environment: The water it swims in, or the ground.
        setup: The model's settings.
    """
    own = None if setup.scene is None else setup.scene.ground
    if isinstance(environment, Ground):
        return (own or environment) if setup.root == "free" and setup.gravity else None
    return own


def _joint_rows(robot: Robot, law: JointLaw) -> np.ndarray:
    """Return the joint parameters for the kernels in MuJoCo's order: the body's, then the fin's from its root."""
    waves = [rows.YAW_WAVE if joint.axis == "yaw" else rows.PITCH_WAVE for joint in robot.joints]
    waves += [rows.NO_WAVE if k else rows.FIN_WAVE for k in robot.fin_joints]
    laws = [rows.PASSIVE if wave == rows.NO_WAVE else law.code for wave in waves]
    return np.column_stack((joint_table(robot, law), laws, waves))
