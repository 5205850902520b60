"""Base of the plants of both models: completed settings, a state that is one vector, marches and logs."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import ClassVar, Generic, TypeVar, cast

import numpy as np

from laticauda.models.dynamics.effector_dynamics import EffectorDynamics
from laticauda.models.dynamics.joint_table import DRIVE, ENVELOPE, MOTOR, STALL_POWER, has_hinges
from laticauda.models.dynamics.pieces import advance_in_pieces
from laticauda.models.dynamics.sampled_loads import (
    FORCES,
    SampledLoads,
    fin_load_signals,
    join_loads,
)
from laticauda.models.dynamics.samples import (
    Advance,
    Grid,
    March,
    PlantState,
    Samples,
    Stretch,
    check_size,
    count_samples,
    count_steps,
    divide_into_steps,
    join_samples,
)
from laticauda.motion.gaits import WaveState, WaveTarget, first_state
from laticauda.motion.joints import JointLaw
from laticauda.robot import Environment, Robot, check_fits, has_power_model
from laticauda.scenarios import (
    Command,
    Model,
    Observation,
    Start,
    check_waves,
    fin_signals,
)
from laticauda.sensing import BodyLoads
from laticauda.trials import side_areas
from laticauda.values import REQUESTED_SERIES, BadArgument, Log, check_instance, check_positive

ModelType = TypeVar("ModelType", bound=Model)
Waves = tuple[WaveState, WaveState, WaveState]
Targets = tuple[WaveTarget, WaveTarget, WaveTarget]

CREST = WaveState(
    phase=0.5 * math.pi,
    amplitude=1.0,
    amplitude_rate=0.0,
    frequency=0.0,
    frequency_rate=0.0,
    phase_shift=0.0,
    phase_shift_rate=0.0,
    offset=0.0,
    offset_rate=0.0,
)
"""A wave of amplitude 1 at its crest, so that the joints' references equal their envelope."""
EFFECTORS_NOW = "effectors"
"""Name of what effectors do at the end of a run, in a stored state."""
STILL = WaveTarget(1.0, 0.0, 0.0, 0.0, 0.0)
"""Target of a wave of amplitude 1 that stands still."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Plant(ABC, Generic[ModelType]):
    """A model of a robot in an environment. The same state and command always give the same next state.

    Raises:
        ValueError: If robot and environment do not fit together.
    """

    robot: Robot
    """Robot to simulate."""
    environment: Environment
    """Water or ground that the robot moves in or on."""
    settings: ModelType
    """Settings of the simulation; unspecified ones are filled in."""

    name: ClassVar[str]
    """Name of the model."""
    usual_dt: ClassVar[float]
    """Default time step with prescribed joints [s]."""
    longest_driven_dt: ClassVar[float]
    """Longest default time step with joints that a law drives [s]."""
    elastic_dt: ClassVar[float]
    """Longest default time step with a fin that bends [s]."""
    generator: ClassVar[tuple[slice, ...]]
    """Waves in a state vector that external references replace; that of a driven fin comes last."""

    def __post_init__(self) -> None:
        """Fill in unspecified settings."""
        check_fits(self.robot, self.environment)
        dt = self.settings.dt
        ramp = self.settings.ramp
        if dt is None:
            dt = self._choose_dt()
        if ramp is None:
            ramp = self.joints.ramp
        complete_settings = replace(self.settings, dt=dt, ramp=ramp)
        object.__setattr__(self, "settings", complete_settings)

    def _choose_dt(self) -> float:
        """Return the largest time step at which joints, fin and loads are resolved [s]."""
        dt = self.usual_dt
        if self.joints.dt is not None:
            dt = min(self.joints.dt, self.longest_driven_dt)
        if has_hinges(self.robot):
            dt = min(dt, self.elastic_dt)
        return min(dt, self._stable_step())

    @property
    def joints(self) -> JointLaw:
        """Law by which the joints follow their references."""
        return self.settings.joints

    @cached_property
    def dt(self) -> float:
        """Largest time step [s]."""
        return cast(float, self.settings.dt)

    @cached_property
    def ramp(self) -> float:
        """T of the smooth start [s]."""
        return cast(float, self.settings.ramp)

    @cached_property
    def is_implicit(self) -> bool:
        """Whether any joint is free, which makes the steps implicit (`laticauda.models.planar.stepping`)."""
        return not self.joints.prescribed or has_hinges(self.robot)

    def steps_in(self, interval: float) -> int:
        """Return the number of equal steps, none longer than `dt`, in an `interval` [s] between two samples."""
        return count_steps(interval, self.dt)

    @abstractmethod
    def init(self, start: Start, command: Command) -> PlantState:
        """Return the state at time 0: straight at `start`, the generator at the gait of `command`, its offset zero."""

    @abstractmethod
    def observe(self, state: PlantState) -> Observation:
        """Return the observation of `state`."""

    def observe_under(self, state: PlantState, command: Command) -> Observation:
        """Return the observation of `state`, with `loads` under `command`."""
        if state.effectors is not None:
            command = self.effector_dynamics.in_effect(command, np.array(state.effectors))
        observation = self.observe(state)
        observation.give_loads(partial(self.evaluate_loads, state, command))
        return observation

    @abstractmethod
    def evaluate_loads(self, state: PlantState, command: Command) -> BodyLoads:
        """Return what links and joints bear in `state` under `command`."""

    @cached_property
    def _side_areas(self) -> np.ndarray:
        """Area of a side of every link [m^2]."""
        return side_areas(self.robot)

    def step(self, state: PlantState, command: Command, dt: float) -> PlantState:
        """Return the state `dt` [s] after `state`, while `command` is held."""
        return self.advance(state, command, dt, dt).state

    def march(
        self,
        state: PlantState,
        command: Command,
        duration: float,
        sample_interval: float,
        *,
        link_forces: bool = False,
    ) -> March:
        """Run many steps under one command.

        Args:
            state: Initial state.
            command: Command, held throughout.
            duration: Duration [s].
            sample_interval: Time between two samples of the log [s]; adjusted so that it divides
                the duration.
            link_forces: Whether to log the force on every link, and what every joint carries, too.

        Returns:
            The state after `duration` [s], the samples including both ends, and a sentence that
            describes the failure, or None. A failed run returns the samples up to the failure.

        Raises:
            ValueError: If an argument is of the wrong class or out of range.
        """
        check_instance("state", state, PlantState)
        check_instance("command", command, Command)
        duration = check_positive("duration", duration, "s")
        sample_interval = check_positive("sample_interval", sample_interval, "s")
        check_size(duration, sample_interval)
        advance = self.advance(state, command, duration, sample_interval, link_forces=link_forces)
        log = self.log([advance.stretch])
        return March(state=advance.state, log=log, failure=advance.failure)

    def advance(
        self,
        state: PlantState,
        command: Command,
        duration: float,
        sample_interval: float,
        *,
        link_forces: bool = False,
    ) -> Advance:
        """Run many steps under one command as `march` does, but return raw samples.

        Args:
            state: Initial state.
            command: Command, held throughout.
            duration: Duration [s].
            sample_interval: Time between two samples of the log [s]; adjusted so that it divides
                the duration.
            link_forces: Whether to keep the force on every link, and what every joint carries, too.
        """
        grid = divide_into_steps(duration, sample_interval, self.dt)
        if self.effector_dynamics.has_memory:
            return advance_in_pieces(self, state, command, grid, link_forces=link_forces)
        return self.advance_on_grid(state, command, grid, link_forces=link_forces)

    def advance_on_grid(
        self, state: PlantState, command: Command, grid: Grid, *, link_forces: bool
    ) -> Advance:
        """Run many steps with effectors that do what a command says at once.

        Args:
            state: Initial state.
            command: Command, held throughout.
            grid: Its steps.
            link_forces: Whether to keep the force on every link, and what every joint carries, too.
        """
        n_intervals, every, dt = grid
        end, samples = self._run(state, command, n_intervals, every, dt)
        if len(samples) <= n_intervals:
            time = state.values[0] + len(samples) * every * dt
            if len(samples) == 0:
                # The first evaluation is already out of range; the state itself is kept.
                samples = self._sample_of(state, command)
            return Advance(
                state=state,
                stretch=Stretch(samples, command),
                failure=self.describe_divergence(time),
            )
        loads = None
        if link_forces:
            loads = self._compute_loads(state, command, samples, every, dt)
        return Advance(
            state=self.state_after(state, command, end),
            stretch=Stretch(samples, command, loads),
            failure=None,
        )

    @cached_property
    def effector_dynamics(self) -> EffectorDynamics:
        """How the driven effectors follow their commands."""
        return EffectorDynamics(self.robot)

    def state_after(self, state: PlantState, command: Command, end: np.ndarray) -> PlantState:
        """Return the state after a march; waves that references replaced continue from where they were.

        Args:
            state: State before the march.
            command: Command, held throughout.
            end: State vector as the kernels left it; it is changed.
        """
        if command.references is not None:
            for wave in self._held_waves(command):
                end[wave] = state.values[wave]
        return PlantState(values=end)

    def describe_divergence(self, time: float) -> str:
        """Return the message of a run that diverged at `time` [s]."""
        remedy = self.joints.remedy
        flow = getattr(self.environment, "flow", None)
        limits = getattr(flow, "limits", "")
        if limits:
            remedy += f", unless it left its water: {limits}"
        return (
            f"The run diverged at t = {time:.3g} s with dt = {self.dt:g} s "
            f"(a position, angle, rate or torque went beyond all bounds); try {remedy}."
        )

    def pack(self, state: PlantState) -> dict[str, np.ndarray]:
        """Return `state` as arrays that can be stored."""
        stored = {self.name: state.values}
        if state.effectors is not None:
            stored[EFFECTORS_NOW] = np.array(state.effectors)
        return stored

    def unpack(self, stored: Mapping[str, np.ndarray]) -> PlantState:
        """Return the state from the arrays `stored` that `pack` returned.

        Raises:
            ValueError: If the arrays do not come from such a plant.
        """
        values = np.asarray(stored.get(self.name, ()), dtype=float)
        if values.shape != (self._size,):
            plant = self._description
            rule = f"must be that of {plant} ({self._size} numbers), got {values.size} numbers"
            raise BadArgument("state", rule)
        return PlantState(values=values, effectors=self._unpack_effectors(stored))

    def _unpack_effectors(self, stored: Mapping[str, np.ndarray]) -> tuple[float, ...] | None:
        """Return what the effectors did at the end of a stored run, if they have a memory."""
        dynamics = self.effector_dynamics
        if EFFECTORS_NOW not in stored or not dynamics.has_memory:
            return None
        values = np.asarray(stored[EFFECTORS_NOW], dtype=float)
        if values.size != dynamics.n:
            rule = (
                f"must have one number per driven effector, {dynamics.n} in all, got {values.size}"
            )
            raise BadArgument("state", rule)
        return tuple(values.tolist())

    @property
    @abstractmethod
    def _size(self) -> int:
        """Size of a state vector."""

    @property
    def _description(self) -> str:
        """Description of the plant for messages."""
        return f"a {self.name} run of {self.robot.n_links} links"

    @abstractmethod
    def _stable_step(self) -> float:
        """Return the largest step with which all loads may be treated explicitly [s]."""

    @abstractmethod
    def _run(
        self, state: PlantState, command: Command, n_intervals: int, every: int, dt: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the state vector at the end, and the samples: fewer than n_intervals + 1 if the run diverged."""

    @abstractmethod
    def _sample_of(self, state: PlantState, command: Command) -> np.ndarray:
        """Return the single sample of a state from which no step is possible, in finite numbers."""

    @abstractmethod
    def _samples(self, samples: np.ndarray) -> Samples:
        """Return the samples by quantity."""

    @abstractmethod
    def _compute_loads(
        self, state: PlantState, command: Command, samples: np.ndarray, every: int, dt: float
    ) -> SampledLoads:
        """Return the force on every link, and what every joint carries, at the samples of a march."""

    def log(self, stretches: Sequence[Stretch]) -> Log:
        """Return the log of consecutive stretches.

        Args:
            stretches: Consecutive stretches; each begins with the last sample of the previous one.
        """
        samples = self._samples(join_samples(stretches))
        loads = join_loads(stretch.loads for stretch in stretches)
        forces = dict(samples.link_force or {})
        of_request: dict[str, np.ndarray] = {}
        loads_of_fin: dict[str, np.ndarray] = {}
        if loads is not None:
            forces = {**dict(zip(FORCES, loads.link_force, strict=True)), **forces}
            of_request = {name: getattr(loads, name) for name in REQUESTED_SERIES}
            if 0 in self.robot.fin_joints:
                loads_of_fin = fin_load_signals(loads)
        electrical_work = None
        if has_power_model(self.robot, self.joints):
            electrical_work = samples.work[:, 3]
        return Log(
            **samples.observed,
            joint_angle_ref=self._references_of_gait(samples.reference, samples.offset),
            joint_torque=samples.torque,
            work=samples.work[:, :3],
            electrical_work=electrical_work,
            **of_request,
            link_force=forces or None,
            signals={
                **samples.signals,
                **self._effector_signals(stretches),
                **fin_signals(self.robot.fin_joints, *samples.fin),
                **loads_of_fin,
            },
        )

    def _effector_signals(self, stretches: Sequence[Stretch]) -> dict[str, np.ndarray]:
        """Return what the effectors that a command drives did, at every sample of a log."""
        names = self.effector_dynamics.names
        if not names:
            return {}
        columns: list[np.ndarray] = []
        for stretch, count in zip(stretches, count_samples(stretches), strict=True):
            values = stretch.effectors
            if values is None:
                values = self.effector_dynamics.targets_of(stretch.command)[np.newaxis]
                values = np.repeat(values, count, axis=0)
            columns.append(values[len(values) - count :])
        table = np.concatenate(columns)
        return {name: table[:, column] for column, name in enumerate(names)}

    def _references_of_gait(self, reference: np.ndarray, offset: np.ndarray) -> np.ndarray:
        """Return the gait's reference; the kernels' reference is the share that prescribed joints do (`tracking`)."""
        shares = np.array([joint.actuator.tracking for joint in self.robot.joints])
        if not self.joints.prescribed or np.all(shares == 1.0):
            return reference
        return offset + (reference - offset) / shares

    def _first_waves(self, command: Command) -> Waves:
        """Return the initial states of the waves of yaw joints, pitch joints and fin."""
        yaw, pitch, fin = map(first_state, command.gait.targets())
        return yaw, pitch, fin

    def _targets(self, command: Command) -> Targets:
        """Return the targets of the three waves; held references use waves that stand still."""
        check_waves(self.robot, command.gait)
        yaw, pitch, fin = command.gait.targets(command.offset, command.pitch_offset)
        if command.references is None:
            return yaw, pitch, fin
        if self._holds_fin(command):
            return STILL, STILL, STILL
        return STILL, STILL, fin

    def _recorded(self, command: Command, shares: np.ndarray) -> np.ndarray | None:
        """Return the knots of the recording in a command's gait, if any, with angles scaled by the joints' shares."""
        if command.gait.recorded is None or command.references is not None:
            return None
        return command.gait.recorded.scaled(shares)

    def _holds_fin(self, command: Command) -> bool:
        """Return whether a command's references include one for the driven fin."""
        return command.references is not None and len(command.references) > self.robot.n_joints

    def _held_waves(self, command: Command) -> tuple[slice, ...]:
        """Return the waves in a state vector that a command's references replace."""
        if command.references is None:
            return ()
        if self._holds_fin(command):
            return self.generator
        return self.generator[:-1]

    def _start_values(self, state: PlantState, command: Command) -> np.ndarray:
        """Return a copy of the state vector in which waves with held references stand still at their crest."""
        values = state.values.copy()
        for wave in self._held_waves(command):
            values[wave] = CREST[: wave.stop - wave.start]
        return values

    def _hold(self, joints: np.ndarray, command: Command) -> None:
        """Write external references to the numbers of the driven joints (`joint_table`), and switch motors off."""
        command.check_held(self.robot, self.joints)
        if command.references is not None:
            joints[: len(command.references), ENVELOPE] = command.references
        if command.enabled is not None:
            # No gain, no stall torque and no current: only the friction of the servo's gear remains
            # of both laws.
            off = np.flatnonzero(np.logical_not(command.enabled))
            joints[off, DRIVE : MOTOR + 1] = 0.0
            joints[off, STALL_POWER] = 0.0
