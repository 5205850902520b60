"""The three-dimensional robot as a `Plant`: MuJoCo with the water of `laticauda.water.mujoco`."""

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np

from laticauda.models.dynamics.plant import Plant
from laticauda.models.dynamics.sampled_loads import SampledLoads
from laticauda.models.dynamics.samples import PlantState, Samples
from laticauda.models.spatial import rows, water_robot
from laticauda.models.spatial.columns import HEADER, SampleColumns, columns_of
from laticauda.models.spatial.settings import land_of, numbers_per_link
from laticauda.models.spatial.surroundings import check_free
from laticauda.models.spatial.twin import KernelInputs, Twin
from laticauda.robot import Ground, Scene, Water, has_power_model, to_quaternion, turn
from laticauda.scenarios import (
    ORIENTATION,
    Command,
    Observation,
    Spatial,
    Start,
    check_waves,
)
from laticauda.sensing import BodyLoads, HeadMotion
from laticauda.values import BadArgument, check_instance
from laticauda.water import mujoco as water
from laticauda.water.fluid import Flow
from laticauda.water.mujoco import ground

CONTACT_SHARE = 2.0
"""Step in settling times of the stiffest contact; Runge-Kutta is stable up to 2.8 [-]."""
DRIVEN_SHARE = 2.0
"""How much longer steps with free joints are where contacts set them: robots that crawl are still right to 1e-4 [-]."""
DRAG_SHARE = 0.5
"""Step relative to the largest stable one, so that the drag is resolved well and not merely stable [-]."""
NO_STEP = 1e-9
"""A step so small that what happens at a state does not depend on it [s]."""
TERRAIN_SAMPLES = 21
"""Places along a robot at which the ground under it is looked up."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SpatialPlant(Plant[Spatial]):
    """A robot in MuJoCo: three-dimensional modules, with joints prescribed or driven by a law.

    Yaw joints follow the gait, pitch joints its second wave (`Gait.pitch`); without that wave they
    are held straight.

    Raises:
        MissingExtra: If MuJoCo is not installed.
        ValueError: If settings, robot and environment are incompatible.
    """

    settings: Spatial = Spatial()  # noqa: RUF009 - frozen

    name: ClassVar[str] = "spatial"
    usual_dt: ClassVar[float] = 0.01
    longest_driven_dt: ClassVar[float] = 0.01
    elastic_dt: ClassVar[float] = 0.01
    generator: ClassVar[tuple[slice, ...]] = (
        slice(rows.PHASE, rows.WORK_ABSOLUTE),
        slice(rows.PITCH, rows.FIN),
        slice(rows.FIN, rows.EDGE_MEMORY),
    )

    def __post_init__(self) -> None:
        """Choose a root, reject incompatible settings, and fill in those left open."""
        if self.settings.root is None:
            has_pitch_joints = any(joint.axis == "pitch" for joint in self.robot.joints)
            root = "planar"
            if has_pitch_joints:
                root = "free"
            object.__setattr__(self, "settings", replace(self.settings, root=root))
        self._check_root()
        super().__post_init__()

    def _check_root(self) -> None:
        """Reject a root that does not go with the ground."""
        settings = self.settings
        is_on_ground = isinstance(self.environment, Ground)
        if is_on_ground and settings.root == "free" and not settings.gravity:
            rule = "must be `planar` on the ground without `gravity`, got 'free'"
            raise BadArgument("root", rule)
        scene = settings.surroundings or Scene()
        scene.check(self.environment)
        if scene.ground is not None and not (settings.root == "free" and settings.gravity):
            rule = "must be `free`, with `gravity`, for a robot that lies on a scene's ground"
            raise BadArgument("root", rule)

    @property
    def model(self) -> Any:
        """The `mujoco.MjModel`, with its water attached."""
        return self._twin.model

    def data(self, state: PlantState) -> Any:
        """Return a new `mujoco.MjData` at `state`, for inspection or rendering, separate from the plant's own."""
        return self._twin.data([state.values])

    def init(self, start: Start, command: Command) -> PlantState:
        """Return the straight robot's state, with the generator at the commanded gait and its offset still zero."""
        check_instance("start", start, Start)
        check_instance("command", command, Command)
        twin = self._twin
        self._check(command)
        values = np.zeros(self._size)
        parts = self._split(values)
        yaw, pitch, fin = self._first_waves(command)
        values[rows.PHASE : rows.WORK_ABSOLUTE] = yaw
        values[rows.PITCH : rows.EDGE_MEMORY] = pitch + fin
        parts.qpos[:] = twin.model.qpos0
        if self.settings.root == "planar":
            start.check_planar()
            self._place_in_plane(parts, start)
        else:
            self._place_in_space(parts, start)
        parts.link_angle[:] = start.heading
        state = PlantState(values=values)
        if self.settings.surroundings is not None:
            check_free(self.model, self.data(state), set(twin.order.tolist()))
        return state

    def _split(self, values: np.ndarray) -> "_StateParts":
        """Return the parts of a state vector, as views on it."""
        end_of_qpos = rows.STATE_ROWS + self._twin.n_qpos
        end_of_qvel = end_of_qpos + self._twin.n_qvel
        return _StateParts(
            qpos=values[rows.STATE_ROWS : end_of_qpos],
            qvel=values[end_of_qpos:end_of_qvel],
            link_angle=values[end_of_qvel : end_of_qvel + self.robot.n_links],
        )

    def _place_in_plane(self, parts: "_StateParts", start: Start) -> None:
        """Set position, heading and velocity of a planar root."""
        axes = _axes_at(start)
        x, y, _ = axes @ self._twin.center
        parts.qpos[0] = start.center_of_mass[0] - x
        parts.qpos[1] = start.center_of_mass[1] - y
        parts.qpos[2] = start.heading
        parts.qvel[:2] = start.velocity * axes[:2, 0]

    def _place_in_space(self, parts: "_StateParts", start: Start) -> None:
        """Set position, orientation and velocity of a free root."""
        axes = _axes_at(start)
        x, y, _ = axes @ self._twin.center
        parts.qpos[0] = start.center_of_mass[0] - x
        parts.qpos[1] = start.center_of_mass[1] - y
        height = self._height_at(start, x=float(parts.qpos[0]), y=float(parts.qpos[1]))
        parts.qpos[2] = height - axes[2, 0] * self._twin.center[0]
        parts.qpos[3:7] = to_quaternion(axes)
        parts.qvel[:3] = start.velocity * axes[:, 0]

    def _height_at(self, start: Start, *, x: float, y: float) -> float:
        """Return the axis height of a robot with its tail end at x, y [m]: at its depth, or on the highest ground."""
        scene = self.settings.surroundings or Scene()
        height = self._twin.height
        if start.depth is not None:
            return scene.level - start.depth
        terrain = scene.terrain
        if terrain is None or land_of(self.environment, self.settings) is None:
            return height
        cos = math.cos(start.heading)
        sin = math.sin(start.heading)
        heights_of_ground: list[float] = []
        for k in range(TERRAIN_SAMPLES):
            distance = 0.05 * self.robot.length * k
            height_of_ground, _, _ = terrain.at(x + distance * cos, y + distance * sin)
            heights_of_ground.append(height_of_ground)
        height_at_origin, _, _ = terrain.at(0.0, 0.0)
        return height - height_at_origin + max(heights_of_ground)

    def observe(self, state: PlantState) -> Observation:
        """Return the observation of a state."""
        sample = self._sample_at(state)
        observed = {name: values[0] for name, values in self._observed(sample).items()}
        contact_force = None
        if self.settings.surroundings is not None:
            contact_force = self._contact_forces(sample)[0]
        ranges = None
        if self.settings.rays:
            ranges = self._twin.ranges(self.data(state), self.settings.rays)
        row_of_energy = rows.WORK_ABSOLUTE
        if has_power_model(self.robot, self.joints):
            row_of_energy = rows.WORK_ELECTRICAL
        observation = _SpatialObservation(
            **observed,
            pitch=float(sample[0, HEADER + rows.MEAN_PITCH]),
            contact_force=contact_force,
            ranges=ranges,
            energy=float(state.values[row_of_energy]),
        )
        vars(observation)["_plant"] = self
        vars(observation)["_state"] = state
        return observation

    def head_motion(self, state: PlantState) -> HeadMotion:
        """Return where the head is and how it moves.

        Args:
            state: The state.
        """
        return self._twin.head_motion(self.data(state))

    def in_current(self, current: Sequence[float] | Flow) -> "SpatialPlant":
        """Return this plant in other water; both share a MuJoCo model, so only one of them advances at a time.

        Args:
            current: Velocity of the water along x and y [m/s], or a flow.
        """
        environment = self.environment
        if not isinstance(environment, Water):
            raise BadArgument("environment", "must be a Water to have a current, got a Ground")
        if not isinstance(current, Flow):
            current = current[0], current[1], environment.uniform[2]
        water_now = replace(environment, current=current)
        plant = replace(self, environment=water_now)
        # With a flow, the robot may be at another height than without.
        if bool(water_now.flow) == bool(environment.flow):
            vars(plant)["_twin"] = self._twin
        return plant

    @cached_property
    def _twin(self) -> Twin:
        return Twin(self.robot, self.environment, self.settings)

    @cached_property
    def _sensing_twin(self) -> Twin:
        """The twin with sensors of what its joints carry, which others do without."""
        return Twin(self.robot, self.environment, self.settings, senses_loads=True)

    def unpack(self, stored: Mapping[str, np.ndarray]) -> PlantState:
        """Return the state from stored arrays; those of older versions, without the state of an edge, have it at 0."""
        values = np.asarray(stored.get(self.name, ()), dtype=float)
        if values.shape == (self._size - 1,):
            return PlantState(values=np.insert(values, rows.EDGE_MEMORY, 0.0))
        return super().unpack(stored)

    @property
    def _size(self) -> int:
        twin = self._twin
        n_link_numbers = self.robot.n_links * numbers_per_link(self.settings)
        return rows.STATE_ROWS + twin.n_qpos + twin.n_qvel + n_link_numbers

    @property
    def _description(self) -> str:
        return f"{super()._description} with a {self.settings.root} root"

    def _stable_step(self) -> float:
        elements = self._twin.elements_of_robots
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            dt = DRAG_SHARE * water.stable_step(self._twin.model, elements, 0.5)
        share = 1.0
        if self.is_implicit:
            share = DRIVEN_SHARE
        contacts = [element.contact for element in elements if element.contact is not None]
        if contacts:
            gravity = -float(self.model.opt.gravity[2])
            dt = min(dt, share * CONTACT_SHARE * ground.stable_step(contacts, gravity))
        if self.settings.surroundings is not None:
            dt = min(dt, share * self.settings.surroundings.dt)
        return dt

    def _inputs(self, command: Command) -> KernelInputs:
        """Return the command, the joint parameters and the effectors for the kernel."""
        self._check(command)
        inputs = self._inputs_without_command()
        numbers = inputs.command
        joints = inputs.joints
        yaw, pitch, fin = self._targets(command)
        numbers[: rows.BANDWIDTH] = yaw + pitch + fin
        numbers[rows.IS_LED] = 1.0
        numbers[rows.ACTIVE_POWER] = self.robot.active_power or 0.0
        if command.references is not None:
            numbers[rows.RAMP] = 0.0
        is_yaw = joints[:, rows.WAVE] == rows.YAW_WAVE
        recording = self._recorded(command, joints[is_yaw, rows.ENVELOPE])
        n_yaw_links = int(is_yaw.sum()) + 1
        joints[is_yaw, rows.ENVELOPE] *= command.gait.joint_envelope(n_yaw_links)
        if command.references is None:
            joints[is_yaw, rows.LEAD] = command.gait.joint_phases(n_yaw_links)
        if command.gait.pitch is not None:
            is_pitch = joints[:, rows.WAVE] == rows.PITCH_WAVE
            envelope = command.gait.pitch.envelope
            joints[is_pitch, rows.ENVELOPE] *= envelope.joints(int(is_pitch.sum()) + 1)
        self._hold(joints, command)
        if recording is not None:
            numbers[rows.N_KNOTS] = len(recording)
            numbers = np.concatenate((numbers, recording.ravel()))
        effectors = inputs.effectors
        robot = command.effectors(self.robot)
        if robot is not self.robot:
            effectors = water_robot.mounted_elements(robot, self.environment)
        return KernelInputs(command=numbers, joints=joints, effectors=effectors)

    def _inputs_without_command(self) -> KernelInputs:
        """Return the kernel's inputs without a command, so that no reference moves the joints."""
        numbers = np.zeros(rows.COMMAND_ROWS)
        numbers[rows.BANDWIDTH] = self.settings.offset_bandwidth
        numbers[rows.RAMP] = self.ramp
        numbers_of_law = self.joints.numbers
        numbers[rows.JOINT_LAW : rows.JOINT_LAW + len(numbers_of_law)] = numbers_of_law
        return KernelInputs(
            command=numbers,
            joints=self._twin.joints.copy(),
            effectors=self._own_effectors,
        )

    @cached_property
    def _own_effectors(self) -> list[water.Element]:
        """Thrusters and pectoral fins as built, without a command; nobody changes the list."""
        return water_robot.mounted_elements(self.robot, self.environment)

    def _check(self, command: Command) -> None:
        """Reject a command that the robot cannot follow."""
        gait = command.gait
        if command.pitch_offset != 0.0:
            gait = command.steered
        check_waves(self.robot, gait)
        if gait.pitch is not None and self.settings.root == "planar":
            raise BadArgument("gait.pitch", f"must be None with a planar root, got {gait.pitch}")

    def _run(
        self, state: PlantState, command: Command, n_intervals: int, every: int, dt: float
    ) -> tuple[np.ndarray, np.ndarray]:
        values = self._start_values(state, command)
        inputs = self._inputs(command)
        return self._run_kernels(values, inputs, steps=n_intervals * every, dt=dt, every=every)

    def _run_kernels(
        self, values: np.ndarray, inputs: KernelInputs, *, steps: int, dt: float, every: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Advance a copy of a state vector; return it with the samples."""
        values = values.copy()
        samples = self._twin.run(
            [values], [inputs], steps=steps, dt=dt, every=every, environment=self.environment
        )
        return values, samples

    def _sample_at(self, state: PlantState) -> np.ndarray:
        """Return the single sample of a state, without a command."""
        inputs = self._inputs_without_command()
        _, samples = self._run_kernels(state.values, inputs, steps=0, dt=1.0, every=1)
        return samples

    def _sample_of(self, state: PlantState, command: Command) -> np.ndarray:
        return self._sample_at(state)

    def _compute_loads(
        self, state: PlantState, command: Command, samples: np.ndarray, every: int, dt: float
    ) -> SampledLoads:
        """Return forces without buoyancy, and loads, by repeating the run and evaluating them at each sample."""
        loads = SampledLoads.zeros(n_samples=len(samples), n_links=self.robot.n_links, n_axes=3)
        values = self._start_values(state, command)
        inputs = self._inputs(command)
        for k in range(len(samples)):
            if k > 0:
                values, _ = self._run_kernels(values, inputs, steps=every, dt=dt, every=every)
            self._sense(values, inputs, loads, k)
        return loads

    def _sense(
        self, values: np.ndarray, inputs: KernelInputs, loads: SampledLoads, sample: int
    ) -> np.ndarray:
        """Write the loads at a state vector to a sample, and return what a log has of it."""
        twin = self._sensing_twin
        # A run in another thread would change the twin's state.
        with twin.lock:
            logged = twin.run(
                [values.copy()],
                [inputs],
                steps=0,
                dt=NO_STEP,
                every=1,
                environment=self.environment,
            )
            forces = twin.forces()
            sensed = twin.loads(forces)
        sensed.write(loads, sample, forces)
        return logged

    def evaluate_loads(self, state: PlantState, command: Command) -> BodyLoads:
        """Return what links and joints bear in `state` under `command`, apart from contacts with other robots."""
        loads = SampledLoads.zeros(n_samples=1, n_links=self.robot.n_links, n_axes=3)
        values = self._start_values(state, command)
        logged = self._sense(values, self._inputs(command), loads, 0)
        return loads.body_loads(logged[0, self._columns.joint_torque], self._side_areas)

    @cached_property
    def _columns(self) -> SampleColumns:
        """Columns of a sample."""
        n_fin_joints = len(self._twin.joints) - self.robot.n_joints
        return columns_of(self.robot.n_links, n_fin_joints)

    def _observed(self, samples: np.ndarray) -> dict[str, np.ndarray]:
        """Return an observation's fields at every sample."""
        center_of_mass = slice(HEADER + rows.COM, HEADER + rows.COM_RATE)
        velocity = slice(HEADER + rows.COM_RATE, HEADER + rows.HEADING)
        return {
            "time": samples[:, rows.TIME],
            "center_of_mass": samples[:, center_of_mass],
            "center_of_mass_velocity": samples[:, velocity],
            "heading": samples[:, HEADER + rows.HEADING],
            "heading_rate": samples[:, HEADER + rows.HEADING_RATE],
            "link_angle": samples[:, self._columns.link_angle],
            "joint_angle": samples[:, self._columns.joint_angle],
            "joint_rate": samples[:, self._columns.joint_rate],
        }

    def _contact_forces(self, samples: np.ndarray) -> np.ndarray:
        """Return the total contact force on every link at every sample, in a scene [N]."""
        forces = samples[:, self._columns.contact_force]
        return forces.reshape(len(samples), self.robot.n_links, 3)

    def _samples(self, samples: np.ndarray) -> Samples:
        n_samples = len(samples)
        offset_of_axis = {"yaw": rows.OFFSET_NOW, "pitch": rows.SECOND + rows.OFFSET_NOW}
        offset_rows = [offset_of_axis[joint.axis] for joint in self.robot.joints]
        # Angle, rate, reference and torque, each of all of the fin's joints.
        fin = samples[:, self._columns.fin].reshape(n_samples, 4, -1)
        link_force = None
        if self.settings.surroundings is not None:
            link_force = {"contact": self._contact_forces(samples)}
        signals: dict[str, np.ndarray] = {}
        for k, name in enumerate(ORIENTATION):
            signals[name] = samples[:, HEADER + rows.ORIENTATION + k]
        signals["pitch"] = samples[:, HEADER + rows.MEAN_PITCH]
        return Samples(
            observed=self._observed(samples),
            reference=samples[:, self._columns.joint_reference],
            offset=samples[:, offset_rows],
            torque=samples[:, self._columns.joint_torque],
            work=samples[:, rows.WORK_ABSOLUTE : rows.PITCH],
            fin=tuple(np.moveaxis(fin, 1, 0)),
            link_force=link_force,
            signals=signals,
        )


class _StateParts(NamedTuple):
    """Parts of a state vector that a start determines, as views on it."""

    qpos: np.ndarray
    """Position and orientation of the root, then the joint angles [m, rad]."""
    qvel: np.ndarray
    """Velocity of the root, of which the first entries are those along x and y, then the joint rates [m/s, rad/s]."""
    link_angle: np.ndarray
    """Angles of the links about the vertical [rad]."""


def _axes_at(start: Start) -> np.ndarray:
    """Return the axes of a straight robot at a start, as the columns of a rotation matrix [-]."""
    turned = turn("yaw", start.heading) @ turn("pitch", start.pitch)
    return turned @ turn("roll", start.roll)


class _SpatialObservation(Observation):
    """Observation in space; the motion of the head is computed on first access."""

    _plant: SpatialPlant
    _state: PlantState

    @cached_property
    def head(self) -> HeadMotion:  # pyright: ignore[reportIncompatibleMethodOverride]  # as frozen as a field
        """Where the head is and how it moves."""
        return self._plant.head_motion(self._state)
