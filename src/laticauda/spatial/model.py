"""The robot in space as a `Plant`: MuJoCo with the water of `laticauda.mujoco_water`."""

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda import mujoco_water as water
from laticauda.errors import BadArgument
from laticauda.extras import load_mujoco
from laticauda.gaits.reference import first_state
from laticauda.interfaces import ORIENTATION, Command, Log, Observation, Start, check_waves, fin_signals
from laticauda.mujoco_water import ground
from laticauda.robot import has_power_model
from laticauda.spatial import rows
from laticauda.spatial.setup import LEAST_DT, SpatialSetup
from laticauda.spatial.twin import FORCES, Twin

CONTACT_SHARE = 2.0  # of the time in which the stiffest contact settles; Runge-Kutta is stable up to 2.8
USUAL_DT = 0.01  # of prescribed joints
ELASTIC_DT = 0.005  # with a fin that bends
# Of a state vector: both waves' phase, filtered values and their rates.
GENERATOR = (slice(rows.PHASE, rows.OFFSET_RATE + 1), slice(rows.PITCH, rows.FIN))


@dataclass(frozen=True, kw_only=True, eq=False)
class SpatialState:
    """Everything that a run needs to go on: what `rows` names, qpos, qvel, the links' angles."""

    values: Float[np.ndarray, " n"]


@dataclass(frozen=True, kw_only=True, eq=False)
class SpatialPlant(SpatialSetup):
    """A robot in MuJoCo: its modules in three dimensions, joints prescribed or driven by a law.

    Yaw joints follow the gait, pitch joints its second wave (`Gait.pitch`); without one they are held straight.

    Raises:
        MissingExtra: If MuJoCo is not installed.
        ValueError: If a setting is out of its range, or robot and environment do not fit together.
    """

    def __post_init__(self) -> None:
        """Choose a time step, if none is given."""
        super().__post_init__()
        if self.dt is None:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                # A step at which the drag is well resolved, not only stable.
                limit = 0.5 * water.stable_step(self._twin.model, self._twin.water.elements, 0.5)
            contacts = [e.contact for e in self._twin.water.elements if e.contact is not None]
            if contacts:
                limit = min(limit, CONTACT_SHARE * ground.stable_step(contacts, -float(self.model.opt.gravity[2])))
            if self.is_implicit:
                limit = min(limit, ELASTIC_DT)
            object.__setattr__(self, "dt", min(self.joints.dt or USUAL_DT, limit))

    @property
    def model(self) -> Any:
        """The `mujoco.MjModel`, with its water attached."""
        return self._twin.model

    def data(self, state: SpatialState) -> Any:
        """A `mujoco.MjData` at `state`, to look at or to render; its own, not the plant's."""
        mujoco = load_mujoco()
        data = mujoco.MjData(self.model)
        data.time = state.values[rows.TIME]
        data.qpos[:], data.qvel[:] = self._positions(state), self._velocities(state)
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_comPos(self.model, data)
        return data

    def init(self, start: Start, command: Command) -> SpatialState:
        """Straight, the generator at the commanded gait, its offset building up from zero."""
        twin = self._twin
        self._check(command)
        values = np.zeros(rows.STATE_ROWS + twin.n_qpos + twin.n_qvel + self.robot.n_links)
        yaw, pitch, fin = map(first_state, command.gait.targets())
        values[rows.PHASE : rows.OFFSET_RATE + 1] = yaw
        values[rows.PITCH : rows.STATE_ROWS] = pitch + fin
        qpos = values[rows.STATE_ROWS : rows.STATE_ROWS + twin.n_qpos]
        c, s = math.cos(start.heading), math.sin(start.heading)
        # The first two speeds of either root are those along x and y.
        values[rows.STATE_ROWS + twin.n_qpos :][:2] = start.velocity * c, start.velocity * s
        x, y = start.center_of_mass
        x, y = x - c * twin.center, y - s * twin.center
        if self.root == "planar":
            qpos[:3] = x, y, start.heading
        else:
            half = 0.5 * start.heading
            qpos[:7] = x, y, twin.height, math.cos(half), 0.0, 0.0, math.sin(half)
        values[-self.robot.n_links :] = start.heading
        return SpatialState(values=values)

    def step(self, state: SpatialState, command: Command, dt: float) -> SpatialState:
        """The state `dt` [s] later, under a command that is held."""
        return self.march(state, command, dt, dt)[0]

    def observe(self, state: SpatialState) -> Observation:
        """What can be seen of a state."""
        sample = self._sample_of(state)
        log = self._named(sample)
        pitch = float(sample[0, rows.STATE_ROWS + rows.MEAN_PITCH])
        return Observation(**{name: value[0] for name, value in log.items()}, pitch=pitch)

    def march(
        self,
        state: SpatialState,
        command: Command,
        duration: float,
        sample_interval: float,
        *,
        link_forces: bool = False,
    ) -> tuple[SpatialState, Log, str | None]:
        """Many steps at once under one command; see `Plant.march`."""
        assert self.dt is not None
        n_intervals = max(1, round(duration / sample_interval))
        every = max(1, math.ceil(duration / n_intervals / self.dt - 1e-9))
        dt = duration / n_intervals / every
        begin = state if command.references is None else _at_rest(state)
        after, samples = self._go(begin, self._rows(command), n_intervals * every, dt, every)
        if len(samples) <= n_intervals:
            when = state.values[0] + len(samples) * duration / n_intervals
            if not len(samples):
                samples = self._sample_of(state)
            return state, self._log(samples), _what_went_wrong(when, self.joints.remedy, self.dt)
        log = self._log(samples)
        if link_forces:
            log = replace(log, link_force=self._link_forces(begin, command, n_intervals, every, dt))
        if command.references is not None:
            for part in GENERATOR:
                after.values[part] = state.values[part]
        return after, log, None

    def pack(self, state: SpatialState) -> dict[str, np.ndarray]:
        """A state as arrays that can be stored."""
        return {"spatial": state.values}

    def unpack(self, stored: Mapping[str, np.ndarray]) -> SpatialState:
        """The state back from `pack`.

        Raises:
            ValueError: If the arrays do not come from such a plant.
        """
        twin = self._twin
        expected = rows.STATE_ROWS + twin.n_qpos + twin.n_qvel + self.robot.n_links
        values = np.asarray(stored.get("spatial", ()), dtype=float)
        if values.shape != (expected,):
            raise BadArgument(
                "state",
                f"must be that of a spatial run of {self.robot.n_links} links with a {self.root} root "
                f"({expected} numbers), got {values.size} numbers",
            )
        return SpatialState(values=values)

    @cached_property
    def _twin(self) -> Twin:
        return Twin(self)

    def _positions(self, state: SpatialState) -> np.ndarray:
        return state.values[rows.STATE_ROWS : rows.STATE_ROWS + self._twin.n_qpos]

    def _velocities(self, state: SpatialState) -> np.ndarray:
        first = rows.STATE_ROWS + self._twin.n_qpos
        return state.values[first : first + self._twin.n_qvel]

    def _rows(self, command: Command | None) -> tuple[np.ndarray, np.ndarray]:
        """The command and the joints' parameters for the kernel; None: the joints are let go."""
        given = np.zeros(rows.COMMAND_ROWS)
        given[rows.BANDWIDTH], given[rows.RAMP] = self.offset_bandwidth, self.ramp
        numbers = self.joints.numbers
        given[rows.JOINT_LAW : rows.JOINT_LAW + len(numbers)] = numbers
        joints = self._twin.joints.copy()
        if command is not None:
            gait = command.gait
            self._check(command)
            given[rows.IS_LED] = 1.0
            given[rows.ACTIVE_POWER] = self.robot.active_power or 0.0
            yaw, pitch, fin = gait.targets(command.offset, command.pitch_offset)
            given[: rows.BANDWIDTH] = yaw + pitch + fin
            turned = joints[:, rows.WAVE] == rows.YAW_WAVE
            joints[turned, rows.ENVELOPE] *= gait.joint_envelope(int(turned.sum()) + 1)
            self._hold(given, joints[: self.robot.n_joints], command)
        return given, joints

    def _hold(self, given: np.ndarray, joints: np.ndarray, command: Command) -> None:
        """Put in references from outside, and switch motors off; see `_at_rest`."""
        command.check_held(self.robot.n_joints, self.joints)
        if command.references is not None:
            given[: rows.FIN_COMMAND] = 0.0
            given[rows.AMPLITUDE] = given[rows.PITCH_COMMAND + rows.AMPLITUDE] = 1.0
            given[rows.RAMP] = 0.0
            joints[:, rows.ENVELOPE] = command.references
        if command.enabled is not None:
            # No gain, no stall torque and no current: what is left of both laws is the friction of the servo's gear.
            off = np.logical_not(command.enabled)
            joints[off, rows.PROPORTIONAL_GAIN : rows.STALL_TORQUE + 1] = 0.0
            joints[off, rows.STALL_POWER] = 0.0

    def _check(self, command: Command) -> None:
        """Refuse what the robot cannot do."""
        gait = command.gait if command.pitch_offset == 0.0 else command.steered
        check_waves(self.robot, gait)
        if gait.pitch is not None and self.root == "planar":
            raise BadArgument("gait.pitch", f"must be None with a planar root, got {gait.pitch}")

    def _link_forces(
        self, state: SpatialState, command: Command, n: int, every: int, dt: float
    ) -> dict[str, np.ndarray]:
        """Force of drag, added mass and effectors on every link at the samples of a march; buoyancy is in none of them.

        The march is done once more, sample by sample, and stopped to look at each.
        """
        force = np.zeros((3, n + 1, self.robot.n_links, 3))
        given = self._rows(command)
        for sample in range(n + 1):
            if sample:
                state, _ = self._go(state, given, every, dt, every)
            self._go(state, given, 0, LEAST_DT * 1e-3, 1)  # with so small a step, the joint laws are not implicit
            force[:, sample] = self._twin.forces()
        return {name: force[i] for i, name in enumerate(FORCES)}

    def _go(
        self, state: SpatialState, given: tuple[np.ndarray, np.ndarray], steps: int, dt: float, every: int
    ) -> tuple[SpatialState, np.ndarray]:
        values = state.values.copy()
        n, joints = self.robot.n_links, len(self._twin.joints)
        log = np.empty((1 + steps // every, rows.STATE_ROWS + rows.SAMPLE_HEADER + n + 4 * joints))
        written = self._twin.run(values, given, steps, dt, every, log)
        return SpatialState(values=values), log[:written]

    def _sample_of(self, state: SpatialState) -> np.ndarray:
        """The sample of a state as it is: no reference takes the joints to where it would have them."""
        return self._go(state, self._rows(None), 0, 1.0, 1)[1]

    def _named(self, samples: np.ndarray) -> dict[str, np.ndarray]:
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

    def _log(self, samples: np.ndarray) -> Log:
        n = self.robot.n_links
        first = rows.STATE_ROWS + rows.SAMPLE_HEADER + 3 * n - 2
        at = rows.STATE_ROWS + rows.ORIENTATION
        signals = {name: samples[:, at + k] for k, name in enumerate((*ORIENTATION, "pitch"))}
        fin = samples[:, first + 2 * n - 2 :].reshape(len(samples), 4, -1)
        has_power = has_power_model(self.robot, self.joints)
        return Log(
            **self._named(samples),
            joint_angle_ref=self._commanded(samples, samples[:, first : first + n - 1]),
            joint_torque=samples[:, first + n - 1 : first + 2 * n - 2],
            work=samples[:, rows.WORK_ABSOLUTE : rows.WORK_ELECTRICAL],
            electrical_work=samples[:, rows.WORK_ELECTRICAL] if has_power else None,
            link_force=None,
            signals=signals | fin_signals(self.robot.caudal_fin, *np.moveaxis(fin, 1, 0)),
        )

    def _commanded(self, samples: np.ndarray, done: np.ndarray) -> np.ndarray:
        """The reference that the gait asks for; the kernels' own is what prescribed joints do of it (`tracking`)."""
        share = np.array([joint.actuator.tracking for joint in self.robot.joints])
        if not self.joints.prescribed or np.all(share == 1.0):
            return done
        first, second = rows.OFFSET_NOW, rows.SECOND + rows.OFFSET_NOW
        offset = samples[:, [second if joint.axis == "pitch" else first for joint in self.robot.joints]]
        return offset + (done - offset) / share


def _at_rest(state: SpatialState) -> SpatialState:
    """The state with both waves of amplitude 1, standing still at their crest: their envelope is the reference."""
    values = state.values.copy()
    for part in GENERATOR:
        values[part] = 0.0
    for first in (0, rows.SECOND):
        values[first + rows.PHASE], values[first + rows.AMPLITUDE_NOW] = 0.5 * math.pi, 1.0
    return SpatialState(values=values)


def _what_went_wrong(time: float, remedy: str, dt: float) -> str:
    """The sentence that a failed run ends with."""
    return (
        f"The run diverged at t = {time:.3g} s with dt = {dt:g} s (a position, angle, rate or torque went beyond all "
        f"bounds); try {remedy}."
    )
