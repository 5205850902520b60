"""The closed-form planar model as a `Plant`."""

import math
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import accumulate
from types import ModuleType
from typing import Any, ClassVar

import numpy as np

from laticauda.compiling import Target
from laticauda.compiling.templates import specialized
from laticauda.models.dynamics.plant import Plant, PlantState, Samples
from laticauda.models.planar import rows
from laticauda.models.planar.layout import Layout, build_layout, flow_rows, write_effectors
from laticauda.motion import gaits
from laticauda.motion.joints.laws import JointLaw
from laticauda.robot import law_of
from laticauda.robot.hydrodynamics import Coefficients, link_coefficients
from laticauda.scenarios import Planar
from laticauda.scenarios.interfaces import Command, Observation, Start
from laticauda.values.checks import check_instance
from laticauda.values.errors import BadArgument
from laticauda.values.formulas import Formula
from laticauda.water.fluid import flow as flows
from laticauda.water.fluid.laws import DragLaw, PolynomialDrag

LEAST_DT = 1e-7  # s; with smaller steps a run would take forever
TEMPLATES = {
    "loads": ("WIDTH", "law", "flow"),
    "recursion": ("WIDTH", "law", "flow"),
    "drives": ("WIDTH", "joint_law"),
    "stepping": ("WIDTH", "law", "flow", "joint_law"),
}
"""Templates of the kernels, and what each is specialized for; see `laticauda.compiling.templates`."""


def specialize(
    width: int = 1,
    law: DragLaw | None = None,
    joints: JointLaw | None = None,
    flow: tuple[Formula, ...] = (),
    target: Target | None = None,
) -> ModuleType:
    """Return the stepping kernels for `width` lanes, one drag law, one joint law and one kind of flow.

    Args:
        width: Number of trials that run side by side in one set of vector registers.
        law: Drag law to compile: its formula with all functions that it calls, but not its numbers.
            None: polynomial.
        joints: Joint law to compile in addition to the built-in ones, unless it is one of them.
        flow: Kinds of parts of the water's flow (`fluid.flow.rows_of`); empty: uniform, constant
            current or none.
        target: What to compile for; None: this machine's processor.

    Returns:
        The module `laticauda.models.planar.stepping`, compiled for these arguments on first call.
    """
    own = None if joints is None else joints.own
    names = {
        "WIDTH": width,
        "law": (law or PolynomialDrag()).formula,
        "joint_law": own,
        "flow": flow,
    }
    return specialized("laticauda.models.planar", TEMPLATES, names, target)


@dataclass(frozen=True, kw_only=True, eq=False)
class PlanarPlant(Plant[Planar]):
    """A robot in the plane: n links, joints prescribed or driven by a law; pitch joints are omitted.

    The default steps converge the paper's trials to 1e-6 of the distance with prescribed joints
    (RK5), 1e-4 with driven joints (ROS2) and 1e-5 with an elastic fin behind prescribed joints
    (ROS2): see `benchmarks/convergence.py`.
    """

    settings: Planar = Planar()  # noqa: RUF009 - frozen

    name: ClassVar[str] = "planar"
    usual_dt: ClassVar[float] = 0.05
    generator: ClassVar[tuple[slice, ...]] = (
        slice(rows.PHASE - rows.TIME, rows.OFFSET_RATE + 1 - rows.TIME),
        slice(rows.FIN_PHASE - rows.TIME, rows.FIN_OFFSET_RATE + 1 - rows.TIME),
    )

    def __post_init__(self) -> None:
        """Reduce the robot to the plane, and fill in unspecified settings."""
        object.__setattr__(self, "robot", self.robot.planar())
        super().__post_init__()

    def __getstate__(self) -> dict[str, Any]:
        """Return the fields without anything derived: rows may hold addresses, which are valid in one process only."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @cached_property
    def coefficients(self) -> Coefficients:
        """Load coefficients per link and fin strip."""
        return link_coefficients(self.robot, self.environment)

    @cached_property
    def layout(self) -> Layout:
        """The robot in the kernels' form."""
        return build_layout(
            self.robot, self.environment, joints=self.joints, coefficients=self.coefficients
        )

    def kernels_of(self, width: int) -> Any:
        """Return the compiled kernels for `width` trials side by side."""
        return specialize(width, self.law, self.joints, self.flow.kinds)

    @cached_property
    def _envelope(self) -> np.ndarray:
        """Rows of the envelope of the body's joints."""
        a = self.layout
        return (
            rows.HEADER_ROWS
            + np.arange(a.tail_link + 1, a.n_bodies) * rows.BODY_ROWS
            + rows.ENVELOPE
        )

    @cached_property
    def _state(self) -> np.ndarray:
        """Rows that make up a state vector."""
        joints = rows.HEADER_ROWS + np.arange(1, self.layout.n_bodies) * rows.BODY_ROWS
        return np.concatenate(
            (rows.TIME + np.arange(rows.LOG_STATE), joints + rows.ANGLE, joints + rows.RATE)
        )

    @cached_property
    def _kernels(self) -> Any:
        return self.kernels_of(1)

    @property
    def law(self) -> DragLaw:
        """Law of the loads on one element."""
        return law_of(self.environment)

    @cached_property
    def flow(self) -> flows.Rows:
        """The water's flow in the kernels' form."""
        return flow_rows(self.environment)

    def init(self, start: Start, command: Command) -> PlantState:
        """Return the initial state: straight, the generator at the commanded gait, its offset building up from zero."""
        check_instance("start", start, Start)
        check_instance("command", command, Command)
        start.check_planar()
        yaw, _, fin = self._first_waves(command)
        values = [0.0] * self._size
        values[_at(rows.HEADING)] = start.heading
        values[_at(rows.X) : _at(rows.Y) + 1] = start.center_of_mass
        values[_at(rows.VX)] = start.velocity * math.cos(start.heading)
        values[_at(rows.VY)] = start.velocity * math.sin(start.heading)
        values[self.generator[0]] = yaw
        values[_at(rows.FIN_PHASE) : _at(rows.FIN_PHASE) + 5] = fin[:5]
        return PlantState(values=np.array(values))

    def observe(self, state: PlantState) -> Observation:
        """Return the observation of a state."""
        seen = object.__new__(_Seen)
        vars(seen).update(self._named(state.values))
        return seen

    def rows(self, state: PlantState, command: Command) -> np.ndarray:
        """Return all rows: the layout's parameters, the command and the state."""
        gait, (kept, asked) = command.gait, self._kept
        if gait.pitch is not None or command.pitch_offset != 0.0:
            raise BadArgument(
                "gait.pitch",
                "must be None unless `model` is `spatial`: the planar model has no pitch joints, got "
                f"{'a pitch offset' if gait.pitch is None else gait.pitch}",
            )
        is_plain = (
            command.references is command.enabled is command.thrusts is command.deflections is None
        )
        if kept is not gait or not is_plain:
            asked = self._asked(command)
            vars(self)["_kept"] = gait if is_plain else None, asked
        S = asked.copy()
        S[self._state] = state.values if command.references is None else self._begun(state, command)
        if command.references is not None:
            return S
        S[rows.OFFSET] = gait.offset + command.offset
        if (table := self._recorded(command, self.layout.template[self._envelope])) is None:
            return S
        S[rows.KNOTS], S[rows.N_KNOTS] = S.size, len(table)
        return np.concatenate((S, table.ravel()))

    def _asked(self, command: Command) -> np.ndarray:
        """Return all rows except those of the offset, the state and a recording."""
        a = self.layout
        S, (yaw, _, fin) = a.template.copy(), self._targets(command)
        wave = *yaw[:3], 0.0, fin.amplitude, fin.frequency, fin.offset, fin.phase
        loop = self.settings.offset_bandwidth, self.ramp if command.references is None else 0.0
        S[rows.AMPLITUDE : rows.RAMP + 1] = *wave, *loop
        S[self._envelope] *= command.gait.joint_envelope(self.robot.n_links)
        if (robot := command.effectors(self.robot)) is not self.robot:
            write_effectors(
                S[: S.size - self.flow.numbers.size],
                robot,
                self.environment,
                first_link=a.tail_link,
            )
        if command.references is not None or command.enabled is not None:
            body = S[rows.HEADER_ROWS : rows.HEADER_ROWS + a.n_bodies * rows.BODY_ROWS].reshape(
                -1, rows.BODY_ROWS
            )
            driven = [*range(a.tail_link + 1, a.n_bodies), a.tail_link][
                : len(self.robot.driven_joints)
            ]
            joints = body[driven, : rows.JOINT_ROWS]
            self._hold(joints, command)
            body[driven, : rows.JOINT_ROWS] = joints
        return S

    @cached_property
    def _kept(self) -> tuple[gaits.Gait | None, np.ndarray]:
        """The last gait and its rows, cached because steering by the offset alone needs the same rows every time."""
        return None, self.layout.template

    def towing_load(self, speed: float, angle: float = 0.0) -> tuple[float, float, float]:
        """Return the load of the water on the straight robot when it is towed at a constant velocity.

        Args:
            speed: Speed through the water [m/s].
            angle: Angle from the direction of tow to the heading, counter-clockwise [rad].

        Returns:
            Force along the body, force across it to the left [N], yaw moment about the middle of
            its links [N m].
        """
        if self.flow.kinds:
            return replace(
                self, environment=replace(self.environment, current=(0.0, 0.0))
            ).towing_load(speed, angle)
        a, S = self.layout, self.layout.template.copy()
        S[rows.VX] = S[rows.CURRENT_X] + speed * math.cos(angle)
        S[rows.VY] = S[rows.CURRENT_Y] - speed * math.sin(angle)
        locked = np.zeros(a.n_bodies, dtype=bool)
        self._kernels.evaluate(
            S, a.n_bodies, a.first_strip, a.first_plate, locked, a.tail_link, a.has_extras
        )
        bodies = S[rows.HEADER_ROWS : rows.HEADER_ROWS + a.n_bodies * rows.BODY_ROWS].reshape(
            -1, rows.BODY_ROWS
        )
        moment, along, across = (
            -bodies[0, [rows.P0, rows.P1, rows.P2]]
        ).tolist()  # all bodies, about the tail end
        length = bodies[:, rows.LENGTH]
        middle = float(np.sum(length[: a.tail_link]) + 0.5 * np.sum(length[a.tail_link :]))
        return along, across, moment - middle * across

    @property
    def _size(self) -> int:
        return rows.LOG_STATE + 2 * (self.layout.n_bodies - 1)

    def stopping(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return pairs of drag slopes [kg/s] and masses [kg] of the elements, first across them, then along them."""
        along, across = self.law.steepest(1.0)  # links of a swimming robot are slower
        c, fin = self.coefficients, self.robot.caudal_fin
        free = [c] if c.fin is None or fin is None or not fin.hinges else [c, c.fin]
        pairs = [
            ((across * e.c_n, e.mass + e.mu_n), (along * e.c_t, e.mass + e.mu_t)) for e in free
        ]
        return [one for pair in pairs for one in pair]

    def _stable_step(self) -> float:
        """Return the time constant of the link that drag stops fastest."""
        rate = max(float((drag / mass).max()) for drag, mass in self.stopping())
        if not rate < 1.0 / LEAST_DT:
            raise BadArgument(
                "environment",
                f"must let a link glide for at least {LEAST_DT:g} s, but its drag or friction stops one "
                f"within {1.0 / rate:.3g} s; lower its coefficients",
            )
        return 1.0 / rate if rate > 0.0 else math.inf

    def _run(
        self, state: PlantState, command: Command, n_intervals: int, every: int, dt: float
    ) -> tuple[np.ndarray, np.ndarray]:
        raw = np.empty((1 + n_intervals, rows.LOG_STATE + 4 * (self.layout.n_bodies - 1), 1))
        S, chain = self.rows(state, command), self.layout.chain
        written = self._kernels.run(
            S, *chain, self.is_implicit, n_intervals * every, dt, every, raw
        )
        samples = raw[:written, :, 0]
        return (samples[-1, : self._size].copy() if written else state.values), samples

    def _sample_of(self, state: PlantState, command: Command) -> np.ndarray:
        raw = np.empty((1, rows.LOG_STATE + 4 * (self.layout.n_bodies - 1), 1))
        self._kernels.run(
            self.rows(state, command), *self.layout.chain, self.is_implicit, 0, 1.0, 1, raw
        )
        return np.nan_to_num(raw[:, :, 0], nan=0.0, posinf=0.0, neginf=0.0)

    def _link_forces(
        self, state: PlantState, command: Command, samples: np.ndarray, every: int, dt: float
    ) -> np.ndarray:
        a = self.layout
        force = np.empty((len(samples), 3, a.n_bodies, 2, 1))
        self._kernels.link_forces(
            self.rows(state, command), *a.chain, samples[:, :, np.newaxis], force
        )
        body = np.moveaxis(force[..., 0], 1, 0)
        body[:, :, a.tail_link] += body[:, :, : a.tail_link].sum(
            axis=2
        )  # fin bodies belong to the tail link
        return body[:, :, a.tail_link :]

    @cached_property
    def _columns(self) -> dict[str, Any]:
        """Columns of a sample for each field of an observation; the fin's joints are omitted."""
        fin, joints = rows.LOG_STATE + self.layout.tail_link, self.layout.n_bodies - 1
        return {
            "time": _at(rows.TIME),
            "center_of_mass": slice(_at(rows.X), _at(rows.Y) + 1),
            "center_of_mass_velocity": slice(_at(rows.VX), _at(rows.VY) + 1),
            "heading": _at(rows.HEADING),
            "heading_rate": _at(rows.HEADING_RATE),
            "joint_angle": slice(fin, rows.LOG_STATE + joints),
            "joint_rate": slice(fin + joints, rows.LOG_STATE + 2 * joints),
        }

    def _named(self, samples: np.ndarray) -> dict[str, np.ndarray]:
        """Return an observation's fields, except the link angles, of one or many samples."""
        columns = samples.T
        return {name: columns[which].T for name, which in self._columns.items()}

    def _samples(self, samples: np.ndarray) -> Samples:
        tail, joints, seen = self.layout.tail_link, self.layout.n_bodies - 1, self._named(samples)
        columns = np.moveaxis(samples[:, rows.LOG_STATE :].reshape(len(samples), 4, joints), 1, 0)
        return Samples(
            seen=seen | {"link_angle": _links(seen["heading"], seen["joint_angle"])},
            reference=columns[2, :, tail:],
            offset=samples[:, _at(rows.OFFSET_NOW), np.newaxis],
            torque=columns[3, :, tail:],
            work=samples[:, _at(rows.WORK_ABSOLUTE) :][:, :4],
            fin=tuple(columns[:, :, [tail - k - 1 for k in self.robot.fin_joints]]),
            signals={},
        )


class _Seen(Observation):
    """Observation in the plane; link angles are computed on first access."""

    @cached_property
    def link_angle(self) -> np.ndarray:  # pyright: ignore[reportIncompatibleVariableOverride]  # as frozen as a field
        """theta [rad]."""
        return _links(self.heading, self.joint_angle)


def _links(heading: Any, joint_angle: np.ndarray) -> np.ndarray:
    """Return link angles from their mean and the joint angles (last axis), for one or many samples [rad]."""
    # Sum one by one: NumPy's cumulative sums and matrix products may round differently depending on
    # the sample count.
    relative = [*accumulate(joint_angle.T, initial=0.0 * heading)]  # to the tail link
    *_, total = accumulate(relative)
    return (np.array(relative) + (heading - total / len(relative))).T


def _at(row: int) -> int:
    """Return the index of a state row of the header in a state vector or a sample."""
    return row - rows.TIME
