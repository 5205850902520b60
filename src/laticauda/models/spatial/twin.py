"""The MuJoCo model of a spatial plant, and what the kernels need from it."""

from collections.abc import Sequence
from dataclasses import replace
from threading import RLock
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.compiling.templates import specialized
from laticauda.models.dynamics.sampled_loads import FORCES, FORCES_OF_WATER
from laticauda.models.spatial import mjcf, rows
from laticauda.models.spatial.bodies import straight_center_of_mass
from laticauda.models.spatial.load_sensors import LoadSensors, SensedLoads
from laticauda.models.spatial.places import (
    LocatedRobot,
    Member,
    build_joint_rows,
    build_places,
    build_setup,
    find_spins,
    index_motion,
    locate_robot,
)
from laticauda.models.spatial.settings import (
    build_plant_elements,
    build_plant_spec,
    is_floating,
    used_ballast_depth,
)
from laticauda.models.spatial.surroundings import reporting_scene_errors
from laticauda.models.spatial.water_robot import mounted_elements
from laticauda.motion.joints import JointLaw
from laticauda.robot import Environment, Ground, Robot, Scene, Water, fin_edge
from laticauda.scenarios import Spatial
from laticauda.sensing import HeadMotion
from laticauda.values import BadArgument, add_up, load_mujoco
from laticauda.water import mujoco as water
from laticauda.water.mujoco import callback, table

TEMPLATES = {"drives": ("joint_law",), "driven": ("joint_law",), "stepping": ("joint_law",)}
"""Templates of the kernels, and what each is specialized for; see `laticauda.compiling.templates`."""


class KernelInputs(NamedTuple):
    """What the kernels need to know of one robot's command."""

    command: Float[np.ndarray, " n_numbers"]
    """The command's numbers, then the table of a recording, if any; see `rows`."""
    joints: Float[np.ndarray, "n_joints n_numbers"]
    """Parameters of the joints."""
    effectors: list[water.Element]
    """Thrusters and pectoral fins with their current settings."""


class _StateParts(NamedTuple):
    """The parts of a state vector, as views on it."""

    rows: np.ndarray
    """The rows of `rows`."""
    motion: np.ndarray
    """qpos and qvel."""
    links: np.ndarray
    """Angles of the links and, in a scene, the contact forces on them."""


class Twin:
    """Robots, surroundings and a model's settings in MuJoCo. A resource for one run at a time, guarded by `lock`.

    Args:
        robot: The first robot, to which all single-robot attributes refer; its names in the model
            have no prefix.
        environment: Environment of the robots.
        setup: Model settings of the first robot, with the scene.
        neighbors: Further robots with their settings; names of the k-th begin with `robot_k_`.
        senses_loads: Whether the robots have sensors of what their joints carry.
    """

    def __init__(
        self,
        robot: Robot,
        environment: Environment,
        setup: Spatial,
        neighbors: Sequence[tuple[Robot, Spatial]] = (),
        *,
        senses_loads: bool = False,
    ) -> None:
        self.lock = RLock()
        members = [Member(robot, setup, mjcf.robot_prefix(0))]
        for k, (neighbor, settings) in enumerate(neighbors, 1):
            members.append(Member(neighbor, settings, mjcf.robot_prefix(k)))
        self.model = _compile_model(members, environment, sensors=senses_loads)
        self.n_qpos = self.model.nq
        self.n_qvel = self.model.nv
        self.height = float(self.model.body("module_0").pos[2])
        """Initial height of the first robot [m]."""
        self.center = _center_of_mass(robot, used_ballast_depth(setup))
        """Center of mass of the straight first robot, from its tail end, in its axes [m]."""
        self.joints = build_joint_rows(robot, setup.joints)
        """Parameters of the joints of the first robot."""
        self._n_links = robot.n_links
        self._data = load_mujoco().MjData(self.model)
        robots = [locate_robot(self.model, member) for member in members]
        _set_contacts(self.model, robots)
        self.places = build_places(self.model, robots)
        """Where each robot's part of the arrays of all robots begins."""
        self.order = np.concatenate([located.bodies for located in robots])
        """Bodies of all robots, in the order of their links."""
        self._members = members
        self._load_sensors: list[LoadSensors] = []
        if senses_loads:
            for located in robots:
                sensors = LoadSensors(
                    self.model,
                    np.array(located.bodies[: located.member.robot.n_links]),
                    prefix=located.member.prefix,
                    has_driven_fin=0 in located.member.robot.fin_joints,
                )
                self._load_sensors.append(sensors)
        self._masses = np.array([_masses_of(self.model, located) for located in robots])
        self._setups = np.array(
            [build_setup(self.model, self._data, located) for located in robots]
        )
        self._motion_of_robots = index_motion(self.model, robots)
        self._spins = find_spins(self.model)
        self.water = self._attach_water(members, environment)
        # Stored with the water's own numbers, so that it lives as long as the compiled code may
        # read it.
        self._hold = np.zeros(2 * int(self.model.nv))
        self.water.numbers["hold"] = self._hold
        self.water.table[table.HOLD] = self._hold.ctypes.data
        # The kernels use their own integrators.
        self.water.table[table.HAS_INERTIA] = 1
        self.water.table[table.FIRST_ORDER] = 0
        # Height from which a flow measures z.
        self.water.numbers["water"][table.LEVEL] = (setup.surroundings or Scene()).level
        self._write_edges(members, environment)
        self._stepping = stepping(setup.joints)

    def _attach_water(self, members: Sequence[Member], environment: Environment) -> water.Water:
        """Attach water and ground to the elements of all robots, one robot after the other."""
        elements: list[water.Element] = []
        self._ends_of_elements: list[int] = []
        for member in members:
            for element in build_plant_elements(member.robot, environment, member.setup):
                elements.append(replace(element, body=member.prefix + element.body))
            self._ends_of_elements.append(len(elements))
        setup = members[0].setup
        scene = setup.surroundings or Scene()
        water.choose_right_solver(self.model)
        if isinstance(environment, Water):
            elements.extend(water.flex_elements(self.model, density=environment.density))
        if isinstance(environment, Ground):
            return water.attach(self.model, elements, terrain=scene.terrain)
        return water.attach(
            self.model,
            elements,
            density=environment.density,
            current=environment.flow or environment.uniform,
            surface=scene.level if is_floating(setup) else None,
            form=environment.added_mass_form,
            terrain=scene.terrain,
        )

    def _write_edges(self, members: Sequence[Member], environment: Environment) -> None:
        """Write the edges of finite span to the records of their elements, and where the kernels find their states."""
        if not isinstance(environment, Water):
            return
        records = self.water.numbers["elements"].reshape(-1, table.ELEMENT_SIZE)
        for k, (member, end) in enumerate(zip(members, self._ends_of_elements, strict=True)):
            edge = fin_edge(member.robot, environment)
            if edge is None:
                continue
            # The element of the edge comes right before the effectors.
            record = records[end - len(mounted_elements(member.robot, environment)) - 1]
            record[table.EDGE : table.EDGE + len(edge.plate)] = edge.plate
            self._setups[k, rows.EDGE_RECORD] = record[table.EDGE_MEMORY :].ctypes.data

    @property
    def elements_of_robots(self) -> tuple[water.Element, ...]:
        """Elements of all robots, without those of nets in the scene."""
        return self.water.elements[: self._ends_of_elements[-1]]

    def run(
        self,
        states: Sequence[np.ndarray],
        inputs: Sequence[KernelInputs],
        *,
        steps: int,
        dt: float,
        every: int,
        environment: Environment,
    ) -> np.ndarray:
        """Advance the state vectors of all robots in place, and return all samples.

        Args:
            states: State vector of each robot.
            inputs: Inputs of each robot.
            steps: Number of time steps.
            dt: Time step [s].
            every: Time steps from one sample to the next.
            environment: The water with its current motion, or the ground.
        """
        with self.lock:
            load_mujoco().mj_resetData(self.model, self._data)
            self.model.opt.timestep = dt
            # Another package may have replaced the callback since.
            callback.install()
            if isinstance(environment, Water):
                self.water.set_current(environment.flow or environment.uniform)
            self._set_effectors(inputs)
            places = self.places.copy()
            places[1:, rows.FIRST_COMMAND] = np.cumsum([robot.command.size for robot in inputs])
            parts = self._split_states(states)
            motion = self._gather_motion(parts)
            numbers = np.concatenate([np.concatenate((part.rows, part.links)) for part in parts])
            log = np.empty((1 + steps // every, places[-1, rows.FIRST_COLUMN]))
            written = self._stepping.run(
                self._setups,
                places,
                numbers,
                motion,
                np.concatenate([robot.command for robot in inputs]),
                np.concatenate([robot.joints for robot in inputs]),
                self._masses,
                self.order,
                self._spins,
                self._hold,
                steps,
                dt,
                every,
                log,
            )
            begins = places[:-1, rows.FIRST_STATE]
            for part, begin, indices in zip(parts, begins, self._motion_of_robots, strict=True):
                end_of_rows = begin + rows.STATE_ROWS
                part.rows[:] = numbers[begin:end_of_rows]
                part.motion[:] = motion[indices]
                part.links[:] = numbers[end_of_rows : end_of_rows + part.links.size]
            return log[:written]

    def _set_effectors(self, inputs: Sequence[KernelInputs]) -> None:
        """Write the effectors' settings to their records, the last ones of each robot."""
        records = self.water.numbers["elements"].reshape(-1, table.ELEMENT_SIZE)
        for end, robot in zip(self._ends_of_elements, inputs, strict=True):
            own_records = records[end - len(robot.effectors) : end]
            for record, element in zip(own_records, robot.effectors, strict=True):
                record[table.THRUST : table.THRUST + 3] = element.thrust
                record[table.ROTATION : table.ROTATION + 9] = element.rotation.ravel()

    def _split_states(self, states: Sequence[np.ndarray]) -> list[_StateParts]:
        """Split the state vector of each robot into its parts."""
        parts: list[_StateParts] = []
        for values, indices in zip(states, self._motion_of_robots, strict=True):
            end_of_motion = rows.STATE_ROWS + indices.size
            part = _StateParts(
                rows=values[: rows.STATE_ROWS],
                motion=values[rows.STATE_ROWS : end_of_motion],
                links=values[end_of_motion:],
            )
            parts.append(part)
        return parts

    def _gather_motion(self, parts: Sequence[_StateParts]) -> np.ndarray:
        """Return qpos and qvel of the whole model."""
        motion = np.empty(self.n_qpos + self.n_qvel)
        for part, indices in zip(parts, self._motion_of_robots, strict=True):
            motion[indices] = part.motion
        return motion

    def data(self, states: Sequence[np.ndarray]) -> Any:
        """Return a new `mujoco.MjData` at the robots' states, with kinematics, separate from the runs' own."""
        mujoco = load_mujoco()
        motion = self._gather_motion(self._split_states(states))
        data = mujoco.MjData(self.model)
        data.time = states[0][rows.TIME]
        data.qpos[:] = motion[: self.n_qpos]
        data.qvel[:] = motion[self.n_qpos :]
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_comPos(self.model, data)
        return data

    def forces(self, robot: int = 0) -> np.ndarray:
        """Return forces on every link of a robot after the last run, (3, n_links, 3) [N].

        The tail link's include the fin's.

        Args:
            robot: Index of the robot.
        """
        loads = self.water.forces(self._data)
        member = self._members[robot]
        begin = self._ends_of_elements[robot - 1] if robot > 0 else 0
        total = np.zeros((len(FORCES), member.robot.n_links, 3))
        for i in range(begin, self._ends_of_elements[robot]):
            body = str(self.water.elements[i].body)
            link = _link_of_body(body.removeprefix(member.prefix))
            for k, name in enumerate(FORCES):
                total[k, link] += loads[name][i]
        return total

    def loads(self, forces: np.ndarray, robot: int = 0) -> SensedLoads:
        """Return the loads of a robot, right after `forces`.

        Args:
            forces: What `forces` returned.
            robot: Index of the robot.

        Raises:
            ValueError: If the twin was made without their sensors.
        """
        if not self._load_sensors:
            raise BadArgument("senses_loads", "must be set when the twin is made")
        of_water = forces[FORCES_OF_WATER].sum(axis=0)
        return self._load_sensors[robot].read(self._data, of_water)

    def _head_tip(self, data: Any) -> np.ndarray:
        """Return the position of the tip of the head [m]."""
        tail_end = data.xpos[int(self.order[self._n_links - 1])]
        middle = data.site(f"module_{self._n_links - 1}_center").xpos
        return tail_end + 2.0 * (middle - tail_end)

    def head_motion(self, data: Any) -> HeadMotion:
        """Return where the tip of the head is and how it moves.

        Args:
            data: A `mujoco.MjData` with computed kinematics.
        """
        mujoco = load_mujoco()
        head = int(self.order[self._n_links - 1])
        tip = self._head_tip(data)
        mujoco.mj_comVel(self.model, data)
        of_frame = np.zeros(6)  # angular, then linear velocity of the frame's origin, world axes
        mujoco.mj_objectVelocity(self.model, data, mujoco.mjtObj.mjOBJ_XBODY, head, of_frame, 0)
        turn_rate = of_frame[:3]
        lever = tip - data.xpos[head]
        return HeadMotion(
            position=tip,
            axes=data.xmat[head].reshape(3, 3).copy(),
            velocity=of_frame[3:] + np.cross(turn_rate, lever),
            turn_rate=turn_rate,
        )

    def ranges(self, data: Any, rays: tuple[float, ...]) -> np.ndarray:
        """Return distances from the tip of the head [m], infinite where nothing is hit.

        Args:
            data: A `mujoco.MjData` with computed kinematics.
            rays: Directions in the head's plane, from its x axis to its left [rad].
        """
        head = int(self.order[self._n_links - 1])
        rotation = data.xmat[head].reshape(3, 3)
        tip = self._head_tip(data)
        mujoco = load_mujoco()
        hit_geom = np.zeros(1, dtype=np.int32)
        distances: list[float] = []
        for angle in rays:
            direction = rotation @ (np.cos(angle), np.sin(angle), 0.0)
            # All geom groups, static geoms included, but not the head.
            distance = mujoco.mj_ray(self.model, data, tip, direction, None, 1, head, hit_geom)
            distances.append(distance)
        measured = np.array(distances)
        return np.where(measured < 0.0, np.inf, measured)


def stepping(joints: JointLaw) -> ModuleType:
    """Return the module `laticauda.models.spatial.stepping`, compiled on first call.

    Args:
        joints: Joint law whose formula is compiled in addition to the built-in ones, unless it is
            one of them.
    """
    return specialized("laticauda.models.spatial", TEMPLATES, {"joint_law": joints.own})


def _compile_model(members: Sequence[Member], environment: Environment, *, sensors: bool) -> Any:
    """Return the `mujoco.MjModel` of all robots in the surroundings of the first one."""
    first = members[0]
    spec = build_plant_spec(first.robot, environment, first.setup, sensors=sensors)
    with reporting_scene_errors():
        for k, member in enumerate(members[1:], 1):
            alone = replace(member.setup, scene=Scene())
            spec_of_robot = build_plant_spec(member.robot, environment, alone, sensors=sensors)
            mjcf.add_robot(spec, spec_of_robot, k)
        model = water.compile_spec(spec)
    if first.setup.dt is not None:
        model.opt.timestep = first.setup.dt
    return model


def _set_contacts(model: Any, robots: Sequence[LocatedRobot]) -> None:
    """Set which joints have stops, and which robots touch one another."""
    for k, robot in enumerate(robots):
        if robot.member.setup.joints.prescribed:
            # They follow the gait; a stop would only push the rest of the body.
            model.jnt_limited[robot.is_own[model.jnt_bodyid]] = 0
        if len(robots) > 1:
            _let_touch_other_robots(model, robot, k, len(robots))


def _let_touch_other_robots(model: Any, robot: LocatedRobot, k: int, n_robots: int) -> None:
    """Let the shapes of robot k touch those of the others, but not each other.

    Bit 0 is that of the world, bit 1 + k that of robot k.
    """
    contype = 1 | 2 << k
    bits_of_others = (2 << n_robots) - 2 - (2 << k)
    is_touching = robot.is_own[model.geom_bodyid] & (model.geom_contype == 1)
    model.geom_contype[is_touching] = contype
    model.geom_conaffinity[is_touching] = bits_of_others
    # Those of bodies are checked first.
    model.body_contype[robot.is_own] = contype
    model.body_conaffinity[robot.is_own] = bits_of_others


def _masses_of(model: Any, robot: LocatedRobot) -> np.ndarray:
    """Return the mass of every body of the model, 0 for those that are not the robot's [kg]."""
    return np.where(robot.is_own, model.body_mass, 0.0)


def _center_of_mass(robot: Robot, ballast_depth: float) -> np.ndarray:
    """Return the center of mass of the straight robot, from its tail end [m]."""
    mass_of_modules = add_up(module.mass for module in robot.modules)
    z = -ballast_depth * mass_of_modules / robot.mass
    return np.array((straight_center_of_mass(robot), 0.0, z))


def _link_of_body(body: str) -> int:
    """Return the link to which the loads on a body count; those on the fin count to the tail link."""
    if body.startswith("module_"):
        return int(body.removeprefix("module_"))
    return 0
