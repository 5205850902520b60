"""The closed-form planar model as a `Plant`."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.actuation.laws import JointLaw, Prescribed
from laticauda.errors import BadArgument, instance, not_negative, positive, within
from laticauda.fluid.laws import DragLaw
from laticauda.gaits.reference import first_state
from laticauda.hydrodynamics import Coefficients, link_coefficients
from laticauda.interfaces import Command, Log, Observation, Start, check_waves, fin_signals
from laticauda.planar import rows
from laticauda.planar.layout import Layout, layout
from laticauda.planar.specialize import specialize
from laticauda.robot import Environment, Robot, check_fits, has_power_model, law_of
from laticauda.scenarios import Planar

FORCES = ("drag", "added_mass", "effector")

# Steps at which the paper's trials are converged: prescribed joints to 1e-6 of the distance (RK5), driven joints to
# 1e-4 (ROS2), an elastic fin behind prescribed joints to 1e-5 (ROS2). `benchmarks/convergence.py` prints them.
LEAST_DT = 1e-7  # s; a run with smaller steps would not end
USUAL_DT = 0.05  # of prescribed joints
ELASTIC_DT = 0.005  # with a fin that bends
# Of a state vector: the phase, the filtered values and their rates.
GENERATOR = slice(rows.PHASE - rows.TIME, rows.OFFSET_RATE + 1 - rows.TIME)


@dataclass(frozen=True, kw_only=True, eq=False)
class PlanarState:
    """Everything that a run needs to go on: the header's state rows (time to work), then angle and rate per joint."""

    values: Float[np.ndarray, " n"]


@dataclass(frozen=True, kw_only=True, eq=False)
class PlanarPlant:
    """A robot in the plane: n links, joints prescribed or driven by a law.

    Raises:
        ValueError: If a setting is out of its range, or robot and environment do not fit together.
    """

    robot: Robot
    """What swims; modules with pitch joints are reduced to the plane."""
    environment: Environment
    """The water it swims in or the ground it crawls on."""
    joints: JointLaw = Prescribed()
    """How they follow their references."""
    dt: float | None = None
    """Largest time step; None takes a converged one [s]."""
    offset_bandwidth: float = 10.0
    """Of the filters in the reference generator [rad/s]."""
    ramp: float | None = None
    """T of the smooth start; None: 1 s for prescribed joints, none for the others [s]."""
    fin_as_links: bool = False
    """Keep the fin's strips as links with locked joints; slower, with the same result."""

    def __post_init__(self) -> None:
        """Check every setting once and fill in what was left open."""
        instance("joints", self.joints, JointLaw)
        check_fits(self.robot, self.environment)
        object.__setattr__(self, "robot", self.robot.planar())
        if self.dt is None:
            limit = _stable_step(self.robot, self.coefficients, self.environment)
            object.__setattr__(self, "dt", min(self._default_dt, limit))
        object.__setattr__(self, "dt", within("dt", self.dt, LEAST_DT, 1e3, "s"))
        object.__setattr__(self, "offset_bandwidth", positive("offset_bandwidth", self.offset_bandwidth, "rad/s"))
        ramp = self.joints.ramp if self.ramp is None else self.ramp
        object.__setattr__(self, "ramp", not_negative("ramp", ramp, "s"))

    @property
    def is_implicit(self) -> bool:
        """Whether any joint is free, so that steps are linearly implicit (`laticauda.planar.stepping`)."""
        return not self.joints.prescribed or self._has_hinges

    @property
    def _default_dt(self) -> float:
        return min(self.joints.dt or USUAL_DT, ELASTIC_DT if self._has_hinges else math.inf)

    @property
    def _has_hinges(self) -> bool:
        return self.robot.caudal_fin is not None and self.robot.caudal_fin.n_hinges > 0

    @property
    def settings(self) -> Planar:
        """How the plant was made."""
        return Planar(**{name: getattr(self, name) for name in Planar.__dataclass_fields__})

    @cached_property
    def coefficients(self) -> Coefficients:
        """Loads per link and fin strip."""
        return link_coefficients(self.robot, self.environment)

    @cached_property
    def layout(self) -> Layout:
        """The robot as the kernels see it."""
        return layout(
            self.robot,
            self.environment,
            joints=self.joints,
            fin_as_links=self.fin_as_links,
            coefficients=self.coefficients,
        )

    @cached_property
    def kernels(self) -> Any:
        """The compiled kernels."""
        return self.kernels_of(1)

    def kernels_of(self, width: int) -> Any:
        """The same for `width` trials side by side."""
        return specialize(width, self.law, self.joints)

    @property
    def law(self) -> DragLaw:
        """Loads on one element."""
        return law_of(self.environment)

    def steps_in(self, interval: float) -> int:
        """How many equal steps, none longer than `dt`, make up an interval [s] between two samples."""
        assert self.dt is not None
        return max(1, math.ceil(interval / self.dt - 1e-9))

    def init(self, start: Start, command: Command) -> PlanarState:
        """Straight, the generator at the commanded gait, its offset building up from zero."""
        values = np.zeros(rows.LOG_STATE + 2 * (self.layout.n_bodies - 1))
        values[_at(rows.HEADING)] = start.heading
        values[_at(rows.X)], values[_at(rows.Y)] = start.center_of_mass
        values[_at(rows.VX)] = start.velocity * math.cos(start.heading)
        values[_at(rows.VY)] = start.velocity * math.sin(start.heading)
        yaw, _, fin = map(first_state, command.gait.targets())
        values[GENERATOR] = yaw
        values[_at(rows.FIN_PHASE) :][:5] = fin[:5]
        return PlanarState(values=values)

    def step(self, state: PlanarState, command: Command, dt: float) -> PlanarState:
        """The state `dt` [s] later, under a command that is held."""
        return self.march(state, command, dt, dt)[0]

    def observe(self, state: PlanarState) -> Observation:
        """What can be seen of a state."""
        log = self._named(state.values[np.newaxis, :])
        return Observation(**{name: value[0] for name, value in log.items()})

    def march(
        self,
        state: PlanarState,
        command: Command,
        duration: float,
        sample_interval: float,
        *,
        link_forces: bool = False,
    ) -> tuple[PlanarState, Log, str | None]:
        """Many steps at once under one command; see `Plant.march`."""
        n_intervals = max(1, round(duration / sample_interval))
        every = self.steps_in(duration / n_intervals)
        dt = duration / n_intervals / every
        S = self.rows(state, command)
        a, chain = self.layout, self.layout.chain
        raw = np.empty((1 + n_intervals, rows.LOG_STATE + 4 * (a.n_bodies - 1), 1))
        steps = n_intervals * every
        written = self.kernels.run(S, *chain, self.is_implicit, steps, dt, every, raw)
        samples = raw[:written, :, 0]
        if written <= n_intervals:
            when = state.values[0] + written * duration / n_intervals
            if written == 0:  # what the state calls for at once is out of range; the state itself is kept
                samples = np.nan_to_num(raw[:1, :, 0], nan=0.0, posinf=0.0, neginf=0.0)
            return state, self._log(samples), self.what_went_wrong(when)
        log = self._log(samples)
        if link_forces:
            force = np.empty((len(samples), len(FORCES), a.n_bodies, 2, 1))
            self.kernels.link_forces(self.rows(state, command), *chain, raw, force)
            body = force[..., 0]
            body[:, :, a.tail_link] += body[:, :, : a.tail_link].sum(axis=2)  # fin bodies belong to the tail link
            log = replace(log, link_force={name: body[:, i, a.tail_link :] for i, name in enumerate(FORCES)})
        values = samples[-1, : state.values.size].copy()
        if command.references is not None:
            values[GENERATOR] = state.values[GENERATOR]
        return PlanarState(values=values), log, None

    def pack(self, state: PlanarState) -> dict[str, np.ndarray]:
        """A state as arrays that can be stored."""
        return {"planar": state.values}

    def unpack(self, stored: Mapping[str, np.ndarray]) -> PlanarState:
        """The state back from `pack`.

        Raises:
            ValueError: If the arrays do not come from a plant with as many links.
        """
        expected = rows.LOG_STATE + 2 * (self.layout.n_bodies - 1)
        values = np.asarray(stored.get("planar", ()), dtype=float)
        if values.shape != (expected,):
            raise BadArgument(
                "state",
                f"must be that of a planar run of {self.robot.n_links} links ({expected} numbers), "
                f"got {values.size} numbers",
            )
        return PlanarState(values=values)

    def rows(self, state: PlanarState, command: Command) -> np.ndarray:
        """All rows: the layout's parameters, the command, the state."""
        a, gait = self.layout, command.gait
        if gait.pitch is not None or command.pitch_offset != 0.0:
            raise BadArgument(
                "gait.pitch",
                "must be None unless `model` is `spatial`: the planar model has no pitch joints, got "
                f"{'an offset of them' if gait.pitch is None else gait.pitch}",
            )
        check_waves(self.robot, gait)
        S = a.template.copy()
        yaw, _, fin = gait.targets(command.offset)
        S[rows.AMPLITUDE : rows.OFFSET + 1] = yaw[:4]
        S[rows.FIN_AMPLITUDE : rows.FIN_LEAD + 1] = fin.amplitude, fin.frequency, fin.offset, fin.phase
        S[rows.BANDWIDTH], S[rows.RAMP] = self.offset_bandwidth, self.ramp
        S[rows.TIME : rows.TIME + rows.LOG_STATE] = state.values[: rows.LOG_STATE]
        body = S[rows.HEADER_ROWS : rows.HEADER_ROWS + a.n_bodies * rows.BODY_ROWS].reshape(-1, rows.BODY_ROWS)
        joints = state.values[rows.LOG_STATE :].reshape(2, -1)
        body[1:, rows.ANGLE], body[1:, rows.RATE] = joints
        body[a.tail_link + 1 :, rows.ENVELOPE] *= gait.joint_envelope(self.robot.n_links)
        self._hold(S, body[a.tail_link + 1 :], command)
        return S

    def _hold(self, S: np.ndarray, joints: np.ndarray, command: Command) -> None:
        """Put in references from outside, and switch motors off."""
        command.check_held(self.robot.n_joints, self.joints)
        if command.references is not None:
            # A wave of amplitude 1 that stands still at its crest, the references its envelope.
            S[rows.AMPLITUDE : rows.OFFSET + 1] = 1.0, 0.0, 0.0, 0.0
            S[rows.RAMP] = 0.0
            S[rows.PHASE : rows.OFFSET_RATE + 1] = 0.0
            S[rows.PHASE], S[rows.AMPLITUDE_NOW] = 0.5 * math.pi, 1.0
            joints[:, rows.ENVELOPE] = command.references
        if command.enabled is not None:
            # No gain, no stall torque and no current: what is left of both laws is the friction of the servo's gear.
            off = np.logical_not(command.enabled)
            joints[off, rows.PROPORTIONAL_GAIN : rows.STALL_TORQUE + 1] = 0.0
            joints[off, rows.STALL_POWER] = 0.0

    def what_went_wrong(self, time: float) -> str:
        """The sentence that a run ends with that diverged at `time` [s]."""
        return (
            f"The run diverged at t = {time:.3g} s with dt = {self.dt:g} s (a position, angle, rate or torque went "
            f"beyond all bounds); try {self.joints.remedy}."
        )

    def _named(self, samples: np.ndarray) -> dict[str, np.ndarray]:
        """State rows by their names; the fin's locked joints are left out."""
        heading = samples[:, _at(rows.HEADING)]
        fin, joints = self.layout.tail_link, self.layout.n_bodies - 1
        angle = samples[:, rows.LOG_STATE + fin : rows.LOG_STATE + joints]
        rate = samples[:, rows.LOG_STATE + joints + fin : rows.LOG_STATE + 2 * joints]
        relative = np.cumsum(angle, axis=1)  # of every link but the tail's to the tail link
        # The last of running sums: sums and matrix products may round differently with the number of samples.
        tail = heading - np.cumsum(relative, axis=1)[:, -1:].sum(axis=1) / self.robot.n_links
        links = np.empty((len(samples), self.robot.n_links))
        links[:, 0] = tail
        np.add(tail[:, np.newaxis], relative, out=links[:, 1:])
        return {
            "time": samples[:, _at(rows.TIME)],
            "center_of_mass": samples[:, _at(rows.X) : _at(rows.Y) + 1],
            "center_of_mass_velocity": samples[:, _at(rows.VX) : _at(rows.VY) + 1],
            "heading": heading,
            "heading_rate": samples[:, _at(rows.HEADING_RATE)],
            "link_angle": links,
            "joint_angle": angle,
            "joint_rate": rate,
        }

    def _log(self, samples: np.ndarray) -> Log:
        fin, joints = self.layout.tail_link, self.layout.n_bodies - 1
        first = _at(rows.WORK_ABSOLUTE)
        has_power = has_power_model(self.robot, self.joints)
        return Log(
            **self._named(samples),
            joint_angle_ref=self._asked_for(samples),
            joint_torque=samples[:, rows.LOG_STATE + 3 * joints + fin : rows.LOG_STATE + 4 * joints],
            work=samples[:, first : first + 3],
            electrical_work=samples[:, _at(rows.WORK_ELECTRICAL)] if has_power else None,
            link_force=None,
            signals=self._fin_signals(samples),
        )

    def _fin_signals(self, samples: np.ndarray) -> dict[str, np.ndarray]:
        """What the fin's own joints do."""
        law, joints = self.layout.law, self.layout.n_bodies - 1
        own = [i - 1 for i in range(self.layout.tail_link, 0, -1) if law[i] != rows.LOCKED]
        columns = samples[:, rows.LOG_STATE :].reshape(len(samples), 4, joints)[:, :, own]
        return fin_signals(self.robot.caudal_fin, *np.moveaxis(columns, 1, 0))

    def _asked_for(self, samples: np.ndarray) -> np.ndarray:
        """The reference that the gait asks for; the kernels' own is what prescribed joints do of it (`tracking`)."""
        fin, joints = self.layout.tail_link, self.layout.n_bodies - 1
        done = samples[:, rows.LOG_STATE + 2 * joints + fin : rows.LOG_STATE + 3 * joints]
        share = np.array([joint.actuator.tracking for joint in self.robot.joints])
        if not self.joints.prescribed or np.all(share == 1.0):
            return done
        offset = samples[:, _at(rows.OFFSET_NOW), np.newaxis]
        return offset + (done - offset) / share


def _at(row: int) -> int:
    """Where a state row of the header stands in a state vector or a sample."""
    return row - rows.TIME


def _stable_step(robot: Robot, c: Coefficients, environment: Environment) -> float:
    """Step up to which drag may be treated explicitly: the time constant of the link that it stops fastest [s]."""
    along, across = law_of(environment).steepest(1.0)  # links of a swimming robot are slower
    free = [c] if c.fin is None or robot.caudal_fin is None or not robot.caudal_fin.hinges else [c, c.fin]
    rate = max(
        float(slope.max())
        for e in free
        for slope in (across * e.c_n / (e.mass + e.mu_n), along * e.c_t / (e.mass + e.mu_t))
    )
    if not rate < 1.0 / LEAST_DT:
        raise BadArgument(
            "environment",
            f"must let a link glide for at least {LEAST_DT:g} s, but its drag or friction stops one "
            f"within {1.0 / rate:.3g} s; lower its coefficients",
        )
    return 1.0 / rate if rate > 0.0 else math.inf
