"""The three-dimensional robot as a `Plant`: MuJoCo with the water of `laticauda.water.mujoco`."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from laticauda.models.dynamics.plant import ELASTIC_DT, Plant, PlantState, Samples
from laticauda.models.spatial import rows, water_robot
from laticauda.models.spatial.scene import check_free
from laticauda.models.spatial.twin import Twin, land_of
from laticauda.robot import Ground, Scene, Water, to_quaternion, turn
from laticauda.scenarios import ORIENTATION, Command, Observation, Spatial, Start, check_waves
from laticauda.values import BadArgument, check_instance
from laticauda.water import mujoco as water
from laticauda.water.fluid import Flow
from laticauda.water.mujoco import Element, ground

CONTACT_SHARE = (
    2.0  # step in settling times of the stiffest contact; Runge-Kutta is stable up to 2.8
)
Given = tuple[np.ndarray, np.ndarray, list[Element]]
NO_STEP = 1e-9  # s; at so small a step the joint laws are not implicit


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
    generator: ClassVar[tuple[slice, ...]] = (
        slice(rows.PHASE, rows.WORK_ABSOLUTE),
        slice(rows.PITCH, rows.FIN),
        slice(rows.FIN, rows.STATE_ROWS),
    )

    def __post_init__(self) -> None:
        """Choose a root, reject incompatible settings, and fill in those left open."""
        settings, on_ground = self.settings, isinstance(self.environment, Ground)
        if settings.root is None:
            root = "free" if any(joint.axis == "pitch" for joint in self.robot.joints) else "planar"
            settings = replace(settings, root=root)
            object.__setattr__(self, "settings", settings)
        if on_ground and settings.root == "free" and not settings.gravity:
            raise BadArgument(
                "root", "must be `planar` on the ground without `gravity`, got 'free'"
            )
        scene = settings.scene or Scene()
        scene.check(self.environment)
        if scene.ground is not None and not (settings.root == "free" and settings.gravity):
            raise BadArgument(
                "root", "must be `free`, with `gravity`, for a robot that lies on a scene's ground"
            )
        super().__post_init__()

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
        if self.settings.root == "planar":
            start.check_planar()
        values = np.zeros(self._size)
        values[rows.STATE_ROWS : rows.STATE_ROWS + twin.n_qpos] = twin.model.qpos0
        yaw, pitch, fin = self._first_waves(command)
        values[rows.PHASE : rows.WORK_ABSOLUTE] = yaw
        values[rows.PITCH : rows.STATE_ROWS] = pitch + fin
        qpos = values[rows.STATE_ROWS : rows.STATE_ROWS + twin.n_qpos]
        axes = turn("yaw", start.heading) @ turn("pitch", start.pitch) @ turn("roll", start.roll)
        # The first two velocities of either root are those along x and y.
        speed = values[rows.STATE_ROWS + twin.n_qpos :]
        x, y, _ = axes @ twin.center
        if self.settings.root == "planar":
            qpos[:3] = start.center_of_mass[0] - x, start.center_of_mass[1] - y, start.heading
            speed[:2] = start.velocity * axes[:2, 0]
        else:
            qpos[:2] = start.center_of_mass[0] - x, start.center_of_mass[1] - y
            qpos[2:7] = (
                self._level(start, *qpos[:2]) - axes[2, 0] * twin.center[0],
                *to_quaternion(axes),
            )
            speed[:3] = start.velocity * axes[:, 0]
        values[rows.STATE_ROWS + twin.n_qpos + twin.n_qvel :][: self.robot.n_links] = start.heading
        state = PlantState(values=values)
        if self.settings.scene is not None:
            check_free(self.model, self.data(state), set(twin.order.tolist()))
        return state

    def _level(self, start: Start, x: float, y: float) -> float:
        """Return the axis height of a robot with its tail end at x, y [m]: at its depth, or on the highest ground."""
        scene, twin = self.settings.scene or Scene(), self._twin
        if start.depth is not None:
            return scene.level - start.depth
        if scene.terrain is None or land_of(self.environment, self.settings) is None:
            return twin.height
        c, s = math.cos(start.heading), math.sin(start.heading)
        along = [0.05 * self.robot.length * k for k in range(21)]
        highest = max(scene.terrain.at(x + a * c, y + a * s)[0] for a in along)
        return twin.height - scene.terrain.at(0.0, 0.0)[0] + highest

    def observe(self, state: PlantState) -> Observation:
        """Return the observation of a state."""
        sample = self._as_it_is(state)
        pitch = float(sample[0, rows.STATE_ROWS + rows.MEAN_PITCH])
        seen = {name: value[0] for name, value in self._seen(sample).items()}
        contact = None if self.settings.scene is None else self._contact(sample)[0]
        ranges = (
            self._twin.ranges(self.data(state), self.settings.rays) if self.settings.rays else None
        )
        return Observation(**seen, pitch=pitch, contact_force=contact, ranges=ranges)

    def in_current(self, current: Sequence[float] | Flow) -> "SpatialPlant":
        """Return this plant in other water; both share a MuJoCo model, so only one of them advances at a time.

        Args:
            current: Velocity of the water along x and y [m/s], or a flow.
        """
        before = self.environment
        if not isinstance(before, Water):
            raise BadArgument("environment", "must be a Water to have a current, got a Ground")
        if not isinstance(current, Flow):
            current = current[0], current[1], before.uniform[2]
        now = replace(before, current=current)
        other = replace(self, environment=now)
        if bool(now.flow) == bool(before.flow):  # otherwise the robot may be at another height
            vars(other)["_twin"] = self._twin
        return other

    @cached_property
    def _twin(self) -> Twin:
        return Twin(self.robot, self.environment, self.settings)

    @property
    def _size(self) -> int:
        per_link = 1 if self.settings.scene is None else 4
        return (
            rows.STATE_ROWS + self._twin.n_qpos + self._twin.n_qvel + per_link * self.robot.n_links
        )

    @property
    def _words(self) -> str:
        return f"{super()._words} with a {self.settings.root} root"

    def _stable_step(self) -> float:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # A step that resolves the drag well and is not merely stable.
            limit = 0.5 * water.stable_step(self._twin.model, self._twin.water.elements, 0.5)
        contacts = [e.contact for e in self._twin.water.elements if e.contact is not None]
        if contacts:
            limit = min(
                limit,
                CONTACT_SHARE * ground.stable_step(contacts, -float(self.model.opt.gravity[2])),
            )
        if self.settings.scene is not None:
            limit = min(limit, self.settings.scene.dt)
        return min(limit, ELASTIC_DT) if self.is_implicit else limit

    def _rows(self, command: Command) -> Given:
        """Return the command, the joint parameters and the effectors for the kernel."""
        self._check(command)
        given, joints, effectors = self._let_go()
        if (robot := command.effectors(self.robot)) is not self.robot:
            effectors = water_robot.mounted_elements(robot, self.environment)
        given[rows.IS_LED] = 1.0
        given[rows.ACTIVE_POWER] = self.robot.active_power or 0.0
        yaw, pitch, fin = self._targets(command)
        given[: rows.BANDWIDTH] = yaw + pitch + fin
        if command.references is not None:
            given[rows.RAMP] = 0.0
        turned = joints[:, rows.WAVE] == rows.YAW_WAVE
        table = self._recorded(command, joints[turned, rows.ENVELOPE])
        joints[turned, rows.ENVELOPE] *= command.gait.joint_envelope(int(turned.sum()) + 1)
        if command.gait.pitch is not None:
            turned = joints[:, rows.WAVE] == rows.PITCH_WAVE
            joints[turned, rows.ENVELOPE] *= command.gait.pitch.envelope.joints(
                int(turned.sum()) + 1
            )
        self._hold(joints, command)
        if table is not None:
            given[rows.N_KNOTS] = len(table)
            given = np.concatenate((given, table.ravel()))
        return given, joints, effectors

    def _let_go(self) -> Given:
        """Return the kernel's inputs without a command, so that no reference moves the joints."""
        given = np.zeros(rows.COMMAND_ROWS)
        given[rows.BANDWIDTH], given[rows.RAMP] = self.settings.offset_bandwidth, self.ramp
        numbers = self.joints.numbers
        given[rows.JOINT_LAW : rows.JOINT_LAW + len(numbers)] = numbers
        return (
            given,
            self._twin.joints.copy(),
            water_robot.mounted_elements(self.robot, self.environment),
        )

    def _check(self, command: Command) -> None:
        """Reject a command that the robot cannot follow."""
        gait = command.gait if command.pitch_offset == 0.0 else command.steered
        check_waves(self.robot, gait)
        if gait.pitch is not None and self.settings.root == "planar":
            raise BadArgument("gait.pitch", f"must be None with a planar root, got {gait.pitch}")

    def _run(
        self, state: PlantState, command: Command, n_intervals: int, every: int, dt: float
    ) -> tuple[np.ndarray, np.ndarray]:
        return self._go(
            self._begun(state, command), self._rows(command), n_intervals * every, dt, every
        )

    def _go(
        self, values: np.ndarray, given: Given, steps: int, dt: float, every: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Advance a copy of a state vector and log it."""
        values = values.copy()
        return values, self._twin.run([values], [given], steps, dt, every, self.environment)

    def _as_it_is(self, state: PlantState) -> np.ndarray:
        return self._go(state.values, self._let_go(), 0, 1.0, 1)[1]

    def _sample_of(self, state: PlantState, command: Command) -> np.ndarray:
        return self._as_it_is(state)

    def _link_forces(
        self, state: PlantState, command: Command, samples: np.ndarray, every: int, dt: float
    ) -> np.ndarray:
        """Return forces without buoyancy, by repeating the run sample by sample and evaluating the forces at each."""
        force = np.zeros((3, len(samples), self.robot.n_links, 3))
        values, given = self._begun(state, command), self._rows(command)
        for sample in range(len(samples)):
            if sample:
                values, _ = self._go(values, given, every, dt, every)
            with self._twin.lock:  # a run in another thread would change the twin's state
                self._go(values, given, 0, NO_STEP, 1)
                force[:, sample] = self._twin.forces()
        return force

    def _seen(self, samples: np.ndarray) -> dict[str, np.ndarray]:
        n, o = self.robot.n_links, rows.STATE_ROWS
        first = o + rows.SAMPLE_HEADER
        return {
            "time": samples[:, rows.TIME],
            "center_of_mass": samples[:, o + rows.COM : o + rows.COM_RATE],
            "center_of_mass_velocity": samples[:, o + rows.COM_RATE : o + rows.HEADING],
            "heading": samples[:, o + rows.HEADING],
            "heading_rate": samples[:, o + rows.HEADING_RATE],
            "link_angle": samples[:, first : first + n],
            "joint_angle": samples[:, first + n : first + 2 * n - 1],
            "joint_rate": samples[:, first + 2 * n - 1 : first + 3 * n - 2],
        }

    def _contact(self, samples: np.ndarray) -> np.ndarray:
        """Return the total contact force on every link at every sample, in a scene [N]."""
        n = self.robot.n_links
        return samples[:, -3 * n :].reshape(len(samples), n, 3)

    def _samples(self, samples: np.ndarray) -> Samples:
        n, o = self.robot.n_links, rows.STATE_ROWS
        first = o + rows.SAMPLE_HEADER + 3 * n - 2
        last = rows.STATE_ROWS + rows.SAMPLE_HEADER + n + 4 * len(self._twin.joints)
        waves = [rows.SECOND if joint.axis == "pitch" else 0 for joint in self.robot.joints]
        return Samples(
            seen=self._seen(samples),
            reference=samples[:, first : first + n - 1],
            offset=samples[:, [wave + rows.OFFSET_NOW for wave in waves]],
            torque=samples[:, first + n - 1 : first + 2 * n - 2],
            work=samples[:, rows.WORK_ABSOLUTE : rows.PITCH],
            fin=tuple(
                np.moveaxis(samples[:, first + 2 * n - 2 : last].reshape(len(samples), 4, -1), 1, 0)
            ),
            link_force=None if self.settings.scene is None else {"contact": self._contact(samples)},
            signals={
                name: samples[:, o + rows.ORIENTATION + k]
                for k, name in enumerate((*ORIENTATION, "pitch"))
            },
        )
