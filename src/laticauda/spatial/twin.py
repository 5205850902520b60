"""A spatial plant's model in MuJoCo, and what the kernels need of it."""

import math
from threading import Lock

import numpy as np

from laticauda import mujoco_water as water
from laticauda.actuation.laws import Drive, JointLaw
from laticauda.extras import load_mujoco
from laticauda.mujoco_water import native, registry, table
from laticauda.robot import Ground, Joint, Robot, has_power_model
from laticauda.spatial import mjcf, rows, scene
from laticauda.spatial.bodies import center_of_mass
from laticauda.spatial.setup import SpatialSetup
from laticauda.spatial.specialize import specialize
from laticauda.spatial.water_robot import on_ground, robot_elements

FORCES = ("drag", "added_mass", "effector")


class Twin:
    """The model of a setup in MuJoCo and what the kernels need of it. A resource: one march at a time."""

    def __init__(self, setup: SpatialSetup) -> None:
        mujoco = load_mujoco()
        self._lock = Lock()
        robot, environment = setup.robot, setup.environment
        spec = mjcf.spec(
            robot,
            environment,
            root=setup.root,
            actuators="none",
            sensors=False,
            visuals=False,
            tank=setup.tank,
            ground=None if setup.shore is None else "ramp",
        )
        if setup.land is not None:
            spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT  # the ground is among the loads
            spec.option.gravity = (0.0, 0.0, -setup.land.gravity)
        if not setup.gravity or setup.root == "planar":
            spec.option.gravity = (0.0, 0.0, 0.0)
        else:
            for i in range(robot.n_links):
                body = spec.body(f"module_{i}")
                body.ipos = (body.ipos[0], body.ipos[1], body.ipos[2] - setup.ballast_depth)
        self.model = water.compiled(spec)
        if setup.joints.prescribed:  # they go where the gait says; a stop would only push the rest of the body
            self.model.jnt_limited[:] = 0
        if setup.dt is not None:
            self.model.opt.timestep = setup.dt
        self._data = mujoco.MjData(self.model)
        self.n_qpos, self.n_qvel = self.model.nq, self.model.nv
        self.height = float(self.model.body("module_0").pos[2])
        self.center = center_of_mass(robot)
        self.joints = np.array(_joint_rows(robot, setup.joints)).reshape(-1, rows.JOINT_SIZE)
        self.water = self._attach(setup)
        # Among the water's own numbers, so that it lives as long as the compiled code may read it.
        self._hold = np.zeros(2 * int(self.model.nv))
        self.water.numbers["hold"] = self._hold
        self.water.table[table.HOLD] = self._hold.ctypes.data
        self.water.table[table.HAS_INERTIA] = 1
        self._order = np.array([self.model.body(f"module_{i}").id for i in range(robot.n_links)])
        own = self.model.body_rootid == self._order[0]
        self._mass = np.where(own, self.model.body_mass, 0.0)
        self._setup = self._numbers(setup)
        self._stepping = specialize(setup.joints)

    def _attach(self, setup: SpatialSetup) -> water.Water:
        environment = setup.environment
        elements = robot_elements(setup.robot, environment, floats=setup.gravity and setup.root == "free")
        if setup.land is not None:
            elements = on_ground(elements, setup.robot, setup.land, wet=setup.shore is not None)
        if isinstance(environment, Ground):
            return water.attach(self.model, elements)
        terrain = None
        if setup.shore is not None:
            terrain = water.Terrain(
                height=scene.SHORE_HEIGHT, edge=scene.SHORE_END, slope=math.tan(scene.SLOPE), floor=-scene.TANK_DEPTH
            )
        x, y = environment.current
        return water.attach(
            self.model,
            elements,
            density=environment.density,
            current=(x, y, 0.0),
            surface=0.0 if setup.root == "free" and setup.gravity else None,
            form=environment.added_mass_form,
            terrain=terrain,
        )

    def _numbers(self, setup: SpatialSetup) -> np.ndarray:
        where = native.offsets()
        base = (3, 3) if setup.root == "planar" else (7, 6)
        fields = ("qpos", "qvel", "qacc", "xmat", "xipos", "subtree_com", "cvel")
        return np.array(
            [
                self.model._address,
                self._data._address,
                native.address("mj_forwardSkip"),
                native.address("mj_integratePos"),
                self.n_qpos,
                self.n_qvel,
                *base,
                setup.robot.n_links,
                self.model.nbody,
                setup.is_implicit,
                setup.root == "planar",
                *(where[name] for name in fields),
            ],
            dtype=np.int64,
        )

    def run(
        self,
        values: np.ndarray,
        given: tuple[np.ndarray, np.ndarray],
        steps: int,
        dt: float,
        every: int,
        log: np.ndarray,
    ) -> int:
        """Advance `values` in place; see `stepping.run`."""
        with self._lock:
            load_mujoco().mj_resetData(self.model, self._data)
            self.model.opt.timestep = dt
            registry.install()  # somebody else may have taken the callback since
            robot = (self._mass, self._order, self._hold)
            return int(self._stepping.run(self._setup, values, *given, *robot, steps, dt, every, log))

    def forces(self) -> np.ndarray:
        """Forces on every link where the last run ended, (3, n_links, 3) [N]; the fin's are the tail link's."""
        loads_on = self.water.forces(self._data)
        total = np.zeros((len(FORCES), self._order.size, 3))
        for i, element in enumerate(self.water.elements):
            link = int(element.body.removeprefix("module_")) if element.body.startswith("module_") else 0
            for k, name in enumerate(FORCES):
                total[k, link] += loads_on[name][i]
        return total


def _joint_rows(robot: Robot, law: JointLaw) -> list[np.ndarray]:
    """What the kernels know of every joint, in MuJoCo's order: the body's, then the fin's from its root on."""
    waves = {"yaw": rows.YAW_WAVE, "pitch": rows.PITCH_WAVE}
    has_power = has_power_model(robot, law)
    found = [_joint_row(joint, law, waves[joint.axis], has_power=has_power) for joint in robot.joints]
    fin = robot.caudal_fin
    if fin is not None and fin.joint is not None:
        found.append(_joint_row(fin.joint, law, rows.FIN_WAVE, has_power=has_power))
    for hinge in fin.hinges if fin is not None else ():
        row = np.zeros(rows.JOINT_SIZE)
        row[[rows.LAW, rows.WAVE]] = rows.PASSIVE, rows.NO_WAVE
        row[[rows.STIFFNESS, rows.DAMPING]] = hinge.stiffness, hinge.damping
        found.append(row)
    return found


def _joint_row(joint: Joint, law: JointLaw, wave: int, *, has_power: bool) -> np.ndarray:
    row, actuator = np.zeros(rows.JOINT_SIZE), joint.actuator
    row[[rows.LAW, rows.WAVE]] = law.code, wave
    row[rows.ENVELOPE] = actuator.tracking if law.prescribed else 1.0
    row[rows.STIFFNESS], row[rows.DAMPING] = joint.stiffness, joint.damping
    row[rows.PROPORTIONAL_GAIN : rows.STALL_POWER] = [getattr(actuator, name) for name in Drive._fields]
    row[rows.STALL_POWER] = actuator.stall_power if has_power else 0.0
    return row
