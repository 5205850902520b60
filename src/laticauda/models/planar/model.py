"""The closed-form planar model as a `Plant`."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property, partial
from itertools import accumulate
from types import MappingProxyType, ModuleType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from laticauda.models.dynamics.plant import Plant
from laticauda.models.dynamics.sampled_loads import SampledLoads
from laticauda.models.dynamics.samples import PlantState, Samples
from laticauda.models.planar import kernel_library, rows, sample_format
from laticauda.models.planar.internal_loads import compute_loads
from laticauda.models.planar.layout import Layout, build_layout, flow_rows, write_effectors
from laticauda.models.planar.sample_format import column_of, columns_of_joints
from laticauda.motion import gaits
from laticauda.motion.joints import JointLaw
from laticauda.robot import Coefficients, has_power_model, law_of, link_coefficients, move_head
from laticauda.scenarios import Command, Observation, Planar, Start
from laticauda.sensing import BodyLoads, HeadMotion, Reading
from laticauda.values import BadArgument, Formula, check_instance, make_quickly
from laticauda.water.fluid import DragLaw, PolynomialDrag, flow as flows

if TYPE_CHECKING:
    from laticauda.compiling import Target

FASTEST = 1.0
"""Speed above that of links of a swimming robot [m/s]."""
LEAST_DT = 1e-7
"""Time that drag may take to stop a link, at least; with smaller steps a run would take forever [s]."""
TEMPLATES = {
    "loads": ("n_lanes", "drag_law", "flow_parts"),
    "recursion": ("n_lanes", "drag_law", "flow_parts"),
    "drives": ("n_lanes", "joint_law"),
    "prescribed": ("n_lanes", "drag_law", "flow_parts"),
    "driven": ("n_lanes", "drag_law", "flow_parts", "joint_law"),
    "stepping": ("n_lanes", "drag_law", "flow_parts", "joint_law"),
}
"""Templates of the kernels in the order of their loading, and the names that each is loaded anew for.

While a template is loaded, its `bindings` hold the values of these names (`specialize`) and the
templates before it; see `laticauda.compiling.templates`."""
RUN = "run"
"""Name of the kernel in `stepping` that runs any plant."""
RUN_PRESCRIBED = "run_prescribed"
"""Name of the kernel for plants whose shape is known beforehand; see `Layout.has_known_shape`."""
LOGGED_OF_FIN = (rows.ANGLE, rows.RATE, rows.REFERENCE, rows.TORQUE)
"""Rows of a joint in the order of `Samples.fin`."""


def specialize(
    width: int = 1,
    law: DragLaw | None = None,
    joints: JointLaw | None = None,
    flow: tuple[Formula, ...] = (),
    target: "Target | None" = None,
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
    from laticauda.compiling.templates import specialized  # Numba is slow to import

    own_joint_law = None if joints is None else joints.own
    names = {
        "n_lanes": width,
        "drag_law": (law or PolynomialDrag()).formula,
        "joint_law": own_joint_law,
        "flow_parts": flow,
    }
    return specialized("laticauda.models.planar", TEMPLATES, names, target)


@dataclass(frozen=True, kw_only=True)
class Kernels:
    """The entry points of `stepping` that a plant calls, each compiled on first call."""

    run: Any
    """`stepping.run`, or what does the same faster for this plant."""
    evaluate: Any
    """`stepping.evaluate`."""
    link_forces: Any
    """`stepping.link_forces`."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PlanarPlant(Plant[Planar]):
    """A robot in the plane: n links, joints prescribed or driven by a law; pitch joints are omitted.

    At the default steps, speeds are right to 1e-5 and mean powers to 1e-4 (with prescribed joints
    1e-6 and 4e-4): see `benchmarks/convergence.py` and tests/models/planar/test_accuracy.py.
    """

    settings: Planar = Planar()  # noqa: RUF009 - frozen

    name: ClassVar[str] = "planar"
    usual_dt: ClassVar[float] = 0.05
    longest_driven_dt: ClassVar[float] = 0.05
    elastic_dt: ClassVar[float] = 0.01
    generator: ClassVar[tuple[slice, ...]] = (
        slice(column_of(rows.PHASE), column_of(rows.OFFSET_RATE) + 1),
        slice(column_of(rows.FIN_PHASE), column_of(rows.FIN_OFFSET_RATE) + 1),
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

    @cached_property
    def run_name(self) -> str:
        """Name of the kernel in `stepping` that runs this plant."""
        if self.is_implicit or self.flow.kinds or not self.layout.has_known_shape:
            return RUN
        return RUN_PRESCRIBED

    @cached_property
    def _kernels_by_width(self) -> dict[int, Any]:
        return {}

    def kernels_of(self, width: int) -> Any:
        """Return the compiled kernels for `width` trials side by side: a `Kernels`, or those of the library."""
        if width not in self._kernels_by_width:
            self._kernels_by_width[width] = self._find_kernels(width)
        return self._kernels_by_width[width]

    def _find_kernels(self, width: int) -> Any:
        compiled = partial(self._compile_kernels, width)
        if width == 1 and not self.flow.kinds:
            run = kernel_library.find_run(self.run_name, self.law.formula, self.joints.own)
            if run is not None:
                return kernel_library.LibraryKernels(run, compiled)
        return compiled()

    def _compile_kernels(self, width: int) -> "Kernels":
        stepping = specialize(width, self.law, self.joints, self.flow.kinds)
        return Kernels(
            run=getattr(stepping, self.run_name),
            evaluate=stepping.evaluate,
            link_forces=stepping.link_forces,
        )

    @cached_property
    def _envelope(self) -> np.ndarray:
        """Rows of the envelope of the body's joints."""
        bodies = np.arange(self.layout.tail_link + 1, self.layout.n_bodies)
        return rows.HEADER_ROWS + bodies * rows.BODY_ROWS + rows.ENVELOPE

    @cached_property
    def _lead(self) -> np.ndarray:
        """Rows of the lead of the body's joints over the wave."""
        return self._envelope + (rows.LEAD - rows.ENVELOPE)

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
        values[column_of(rows.HEADING)] = start.heading
        values[column_of(rows.X) : column_of(rows.Y) + 1] = start.center_of_mass
        values[column_of(rows.VX)] = start.velocity * math.cos(start.heading)
        values[column_of(rows.VY)] = start.velocity * math.sin(start.heading)
        values[self.generator[0]] = yaw
        values[self.generator[1]] = [getattr(fin, name) for name in rows.FIN_WAVE]
        return PlantState(values=np.array(values))

    def observe(self, state: PlantState) -> Observation:
        """Return the observation of a state."""
        values = state.values
        columns = self.columns_of_state
        return make_quickly(
            _PlanarObservation,
            time=float(values[columns["time"]]),
            center_of_mass=values[columns["center_of_mass"]],
            heading=float(values[columns["heading"]]),
            readings=NO_READINGS,
            _plant=self,
            _state_values=values,
        )

    def head_motion(self, observation: Observation, values: np.ndarray) -> HeadMotion:
        """Return where the head is and how it moves.

        Args:
            observation: The observation of a state.
            values: The numbers of that state.
        """
        n_joints = self.layout.n_joints
        angles = values[columns_of_joints(rows.ANGLE, n_joints)]
        rates = values[columns_of_joints(rows.RATE, n_joints)]
        fin_joints = [self.layout.tail_link - 1 - joint for joint in self.robot.fin_joints]
        link_rate = _links(observation.heading_rate, observation.joint_rate)
        tip = move_head(
            self.robot,
            center_of_mass=observation.center_of_mass,
            velocity=observation.center_of_mass_velocity,
            link_angle=observation.link_angle,
            link_rate=link_rate,
            fin_angle=angles[fin_joints],
            fin_rate=rates[fin_joints],
        )
        angle = float(observation.link_angle[-1])
        cos = math.cos(angle)
        sin = math.sin(angle)
        height = -(getattr(self.environment, "depth", None) or 0.0)
        return HeadMotion(
            position=np.array((*tip.position, height)),
            axes=np.array(((cos, -sin, 0.0), (sin, cos, 0.0), (0.0, 0.0, 1.0))),
            velocity=np.array((*tip.velocity, 0.0)),
            turn_rate=np.array((0.0, 0.0, link_rate[-1])),
        )

    def rows(self, state: PlantState, command: Command) -> np.ndarray:
        """Return all rows: the layout's parameters, the command and the state."""
        gait = command.gait
        if gait.pitch is not None or command.pitch_offset != 0.0:
            pitch = "a pitch offset" if gait.pitch is None else gait.pitch
            raise BadArgument(
                "gait.pitch",
                "must be None unless `model` is `spatial`: "
                f"the planar model has no pitch joints, got {pitch}",
            )
        S = self._rows_of_command(command).copy()
        if command.references is not None:
            S[self.layout.state_rows] = self._start_values(state, command)
            return S
        S[self.layout.state_rows] = state.values
        S[rows.OFFSET] = gait.offset + command.offset
        table = self._recorded(command, self.layout.template[self._envelope])
        if table is None:
            return S
        S[rows.KNOTS] = S.size
        S[rows.N_KNOTS] = len(table)
        return np.concatenate((S, table.ravel()))

    def _rows_of_command(self, command: Command) -> np.ndarray:
        """Return all rows except those of the offset, the state and a recording.

        Steering by the offset alone needs the same rows every time, and so do the loads after a run: the last are kept.
        """
        is_gait_alone = (
            command.references is None
            and command.enabled is None
            and command.thrusts is None
            and command.deflections is None
        )
        source = command.gait if is_gait_alone else command
        last_source, last_rows = self._last_rows
        if source is last_source:
            return last_rows
        new_rows = self._compute_rows(command)
        vars(self)["_last_rows"] = source, new_rows
        return new_rows

    def _compute_rows(self, command: Command) -> np.ndarray:
        """Return all rows except those of the offset, the state and a recording."""
        layout = self.layout
        S = layout.template.copy()
        yaw, _, fin = self._targets(command)
        wave = (*yaw[:3], 0.0, fin.amplitude, fin.frequency, fin.offset, fin.phase)
        ramp = self.ramp if command.references is None else 0.0
        S[rows.AMPLITUDE : rows.RAMP + 1] = (*wave, self.settings.offset_bandwidth, ramp)
        S[self._envelope] *= command.gait.joint_envelope(self.robot.n_links)
        if command.references is None:
            S[self._lead] = command.gait.joint_phases(self.robot.n_links)
        robot = command.effectors(self.robot)
        if robot is not self.robot:
            without_flow = S[: S.size - self.flow.numbers.size]
            write_effectors(without_flow, robot, self.environment, first_link=layout.tail_link)
        if command.references is not None or command.enabled is not None:
            bodies = layout.bodies_of(S)
            # The joint of a driven fin comes last.
            joint_bodies = [*range(layout.tail_link + 1, layout.n_bodies), layout.tail_link]
            driven = joint_bodies[: len(self.robot.driven_joints)]
            joints = bodies[driven, : rows.JOINT_ROWS]
            self._hold(joints, command)
            bodies[driven, : rows.JOINT_ROWS] = joints
        return S

    @cached_property
    def _last_rows(self) -> tuple[gaits.Gait | Command | None, np.ndarray]:
        """The last command, or its gait if it commanded no more, and its rows."""
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
            still_water = replace(self.environment, current=(0.0, 0.0))
            return replace(self, environment=still_water).towing_load(speed, angle)
        layout = self.layout
        S = layout.template.copy()
        S[rows.VX] = S[rows.CURRENT_X] + speed * math.cos(angle)
        S[rows.VY] = S[rows.CURRENT_Y] - speed * math.sin(angle)
        no_joint_is_free = np.zeros(layout.n_bodies, dtype=bool)
        self._kernels.evaluate(
            S,
            layout.n_bodies,
            layout.first_strip,
            layout.first_plate,
            no_joint_is_free,
            layout.tail_link,
            layout.has_extras,
        )
        bodies = layout.bodies_of(S)
        # The bias force of body 0 contains that of all bodies, since no joint is free. Where nothing
        # rotates, a bias force is minus the loads that do not depend on acceleration: here those of the
        # whole robot, about its tail end. At heading 0, world axes are link axes.
        moment, along, across = (-bodies[0, [rows.P0, rows.P1, rows.P2]]).tolist()
        length = bodies[:, rows.LENGTH]
        length_of_fin = np.sum(length[: layout.tail_link])
        length_of_links = np.sum(length[layout.tail_link :])
        middle = float(length_of_fin + 0.5 * length_of_links)
        return along, across, moment - middle * across

    def unpack(self, stored: Mapping[str, np.ndarray]) -> PlantState:
        """Return the state from stored arrays; those of older versions, without the state of an edge, have it at 0."""
        values = np.asarray(stored.get(self.name, ()), dtype=float)
        if values.shape == (self._size - 1,):
            values = np.insert(values, column_of(rows.EDGE_MEMORY), 0.0)
            return PlantState(values=values)
        return super().unpack(stored)

    @property
    def _size(self) -> int:
        return self.layout.state_size

    def stopping(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return pairs of drag slopes [kg/s] and masses [kg] of the elements, first across them, then along them."""
        along, across = self.law.steepest(FASTEST)
        links = self.coefficients
        fin = self.robot.caudal_fin
        elements = [links]
        if links.fin is not None and fin is not None and fin.hinges:
            elements.append(links.fin)
        pairs: list[tuple[np.ndarray, np.ndarray]] = []
        for e in elements:
            pairs.append((across * e.c_n, e.mass + e.mu_n))
            pairs.append((along * e.c_t, e.mass + e.mu_t))
        return pairs

    def _stable_step(self) -> float:
        """Return the time constant of the link that drag stops fastest, or of the wake of an edge."""
        rate = max(float((drag / mass).max()) for drag, mass in self.stopping())
        lag = float(self.layout.template[rows.EDGE_LAG])
        if lag > 0.0:
            rate = max(rate, FASTEST / lag)
        if not rate < 1.0 / LEAST_DT:
            raise BadArgument(
                "environment",
                f"must let a link glide for at least {LEAST_DT:g} s, but its drag or friction stops one "
                f"within {1.0 / rate:.3g} s; lower its coefficients",
            )
        if rate > 0.0:
            return 1.0 / rate
        return math.inf

    def _run(
        self, state: PlantState, command: Command, n_intervals: int, every: int, dt: float
    ) -> tuple[np.ndarray, np.ndarray]:
        raw = np.empty((1 + n_intervals, self.layout.sample_size, 1))
        S = self.rows(state, command)
        n_written = self._kernels.run(
            S, *self.layout.chain, self.is_implicit, n_intervals * every, dt, every, raw
        )
        samples = raw[:n_written, :, 0]
        if not n_written:
            return state.values, samples
        return samples[-1, : self._size].copy(), samples

    def _sample_of(self, state: PlantState, command: Command) -> np.ndarray:
        raw = np.empty((1, self.layout.sample_size, 1))
        S = self.rows(state, command)
        n_steps, dt, every = 0, 1.0, 1
        self._kernels.run(S, *self.layout.chain, self.is_implicit, n_steps, dt, every, raw)
        return np.nan_to_num(raw[:, :, 0], nan=0.0, posinf=0.0, neginf=0.0)

    def evaluate_loads(self, state: PlantState, command: Command) -> BodyLoads:
        """Return what links and joints bear in `state` under `command`."""
        return self.loads_of_rows(self.rows(state, command))

    def loads_of_rows(self, S: np.ndarray) -> BodyLoads:
        """Return what links and joints bear.

        Args:
            S: All rows of one lane, as `rows` returns them; they are changed.
        """
        layout = self.layout
        raw = np.empty((1, layout.sample_size, 1))
        n_steps, dt, every = 0, self.dt, 1
        self._kernels.run(S, *layout.chain, self.is_implicit, n_steps, dt, every, raw)
        samples = raw[:, :, 0]
        loads = compute_loads(self._kernels.link_forces, layout, S, samples, self._mass)
        of_joints = sample_format.view_joints(samples, layout.n_joints)
        torque = of_joints[0, sample_format.place_of(rows.TORQUE), layout.tail_link :]
        return loads.body_loads(torque, self._side_areas)

    @cached_property
    def _mass(self) -> float:
        return self.robot.mass

    def _compute_loads(
        self, state: PlantState, command: Command, samples: np.ndarray, every: int, dt: float
    ) -> SampledLoads:
        S = self.rows(state, command)
        link_forces = self._kernels.link_forces
        return compute_loads(link_forces, self.layout, S, samples, self._mass)

    @cached_property
    def columns_of_state(self) -> dict[str, Any]:
        """Columns of a state vector, and of a sample, by field of an observation; the fin's joints are omitted."""
        n_joints = self.layout.n_joints
        n_fin_joints = self.layout.tail_link
        angles = columns_of_joints(rows.ANGLE, n_joints)
        rates = columns_of_joints(rows.RATE, n_joints)
        return {
            "time": column_of(rows.TIME),
            "center_of_mass": slice(column_of(rows.X), column_of(rows.Y) + 1),
            "center_of_mass_velocity": slice(column_of(rows.VX), column_of(rows.VY) + 1),
            "heading": column_of(rows.HEADING),
            "heading_rate": column_of(rows.HEADING_RATE),
            "joint_angle": slice(angles.start + n_fin_joints, angles.stop),
            "joint_rate": slice(rates.start + n_fin_joints, rates.stop),
        }

    def _fields_of(self, samples: np.ndarray) -> dict[str, np.ndarray]:
        """Return the fields of observations, except the link angles, of many samples."""
        columns = samples.T
        return {name: columns[selection].T for name, selection in self.columns_of_state.items()}

    def _samples(self, samples: np.ndarray) -> Samples:
        tail = self.layout.tail_link
        # `Robot.fin_joints` counts from the fin's root, where joint 0 is at the tail end of the tail link;
        # samples count from the tail, where joint 0 is at the tail end of body 1.
        fin_joints = [tail - 1 - joint for joint in self.robot.fin_joints]
        fields = self._fields_of(samples)
        of_joints = sample_format.view_joints(samples, self.layout.n_joints)
        logged = {row: of_joints[:, sample_format.place_of(row)] for row in rows.LOGGED_OF_JOINT}
        return Samples(
            observed=fields | {"link_angle": _links(fields["heading"], fields["joint_angle"])},
            reference=logged[rows.REFERENCE][:, tail:],
            offset=samples[:, column_of(rows.OFFSET_NOW), np.newaxis],
            torque=logged[rows.TORQUE][:, tail:],
            work=samples[:, column_of(rows.WORK_ABSOLUTE) :][:, : rows.N_WORKS],
            fin=tuple(logged[row][:, fin_joints] for row in LOGGED_OF_FIN),
            signals={},
        )


NO_READINGS: Mapping[str, Reading] = MappingProxyType({})
"""Readings of a robot without sensors."""


class _PlanarObservation(Observation):
    """Observation in the plane; what few controllers ask for is read or computed on first access."""

    _plant: PlanarPlant
    _state_values: np.ndarray

    @cached_property
    def center_of_mass_velocity(self) -> np.ndarray:  # pyright: ignore[reportIncompatibleVariableOverride]  # as frozen as a field
        """Velocity of the center of mass [m/s]."""
        return self._read("center_of_mass_velocity")

    @cached_property
    def heading_rate(self) -> float:  # pyright: ignore[reportIncompatibleVariableOverride]  # as frozen as a field
        """Rate of the heading [rad/s]."""
        return float(self._read("heading_rate"))

    @cached_property
    def joint_angle(self) -> np.ndarray:  # pyright: ignore[reportIncompatibleVariableOverride]  # as frozen as a field
        """phi [rad]."""
        return self._read("joint_angle")

    @cached_property
    def joint_rate(self) -> np.ndarray:  # pyright: ignore[reportIncompatibleVariableOverride]  # as frozen as a field
        """phi' [rad/s]."""
        return self._read("joint_rate")

    def _read(self, name: str) -> Any:
        return self._state_values[self._plant.columns_of_state[name]]

    @cached_property
    def link_angle(self) -> np.ndarray:  # pyright: ignore[reportIncompatibleVariableOverride]  # as frozen as a field
        """theta [rad]."""
        return _links(self.heading, self.joint_angle)

    @cached_property
    def energy(self) -> float:  # pyright: ignore[reportIncompatibleVariableOverride]  # as frozen as a field
        """Electrical energy, or the joints' work without a power model [J]."""
        plant = self._plant
        row = rows.WORK_ABSOLUTE
        if has_power_model(plant.robot, plant.joints):
            row = rows.WORK_ELECTRICAL
        return float(self._state_values[column_of(row)])

    @cached_property
    def head(self) -> HeadMotion:  # pyright: ignore[reportIncompatibleMethodOverride]  # as frozen as a field
        """Where the head is and how it moves."""
        return self._plant.head_motion(self, self._state_values)


def _links(heading: Any, joint_angle: np.ndarray) -> np.ndarray:
    """Return link angles from their mean and the joint angles (last axis), for one or many samples [rad]."""
    # Sum one by one: NumPy's cumulative sums and matrix products may round differently depending on
    # the sample count.
    relative = [*accumulate(joint_angle.T, initial=0.0 * heading)]  # to the tail link
    *_, total = accumulate(relative)
    return (np.array(relative) + (heading - total / len(relative))).T
