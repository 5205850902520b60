"""Base of the plants of both models: completed settings, a state that is one vector, marches and logs."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Generic, NamedTuple, TypeVar, cast

import numpy as np
from jaxtyping import Float

from laticauda.motion.gaits import WaveState, WaveTarget, first_state
from laticauda.motion.joints import JOINT, Drive, JointLaw
from laticauda.robot import Environment, Robot, check_fits, has_power_model
from laticauda.scenarios import (
    EFFECTORS,
    Command,
    Model,
    Observation,
    Start,
    check_waves,
    fin_signals,
)
from laticauda.values import BadArgument, Log, check_instance, check_positive

ModelType = TypeVar("ModelType", bound=Model)
Waves = tuple[WaveState, WaveState, WaveState]
Targets = tuple[WaveTarget, WaveTarget, WaveTarget]

FORCES = ("drag", "added_mass", "effector")
ELASTIC_DT = 0.005  # s, with a flexible fin
MOST_SAMPLES = 2_000_000  # a longer log would take gigabytes
# A wave of amplitude 1 that stands still at its crest, so that the joints' references equal their
# envelope.
CREST, STILL = WaveState(0.5 * math.pi, 1.0, *(0.0,) * 7), WaveTarget(1.0, 0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class PlantState:
    """Everything that a run needs to continue, as one vector; its model's `rows` define the layout."""

    values: Float[np.ndarray, " n"]


class Samples(NamedTuple):
    """Logged samples, by quantity; the first axis is time."""

    seen: dict[str, np.ndarray]
    """Fields of an `Observation`."""
    reference: np.ndarray
    """References that the joints followed [rad]."""
    offset: np.ndarray
    """phi_0 of every joint, or one for all [rad]."""
    torque: np.ndarray
    """Joint torques [N m]."""
    work: np.ndarray
    """Absolute, net, positive and electrical work [J]."""
    fin: tuple[np.ndarray, ...]
    """Angle, rate, reference and torque of the fin's joints."""
    signals: Mapping[str, np.ndarray]
    """Further signals."""
    link_force: Mapping[str, np.ndarray] | None = None
    """Forces on every link that are always logged, requested or not [N]."""


class Stretch(NamedTuple):
    """Raw samples of one march; `Plant.log` makes a log of several stretches at once."""

    samples: np.ndarray
    """Samples as the kernels logged them; the first axis is time."""
    command: Command
    """Command, held throughout."""
    force: np.ndarray | None = None
    """Force on every link, if requested: component, time, link, axis [N]."""

    def at(self, index: slice) -> "Stretch":
        """Return the stretch with a slice of its samples."""
        return Stretch(
            self.samples[index], self.command, None if self.force is None else self.force[:, index]
        )


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
    generator: ClassVar[tuple[slice, ...]]
    """Waves in a state vector that external references replace; that of a driven fin comes last."""

    def __post_init__(self) -> None:
        """Fill in unspecified settings."""
        check_fits(self.robot, self.environment)
        settings = self.settings
        dt, ramp = settings.dt, settings.ramp
        if dt is None:
            elastic = ELASTIC_DT if has_hinges(self.robot) else math.inf
            dt = min(self.joints.dt or self.usual_dt, elastic, self._stable_step())
        closed = replace(settings, dt=dt, ramp=self.joints.ramp if ramp is None else ramp)
        object.__setattr__(self, "settings", closed)

    @property
    def joints(self) -> JointLaw:
        """Law by which the joints follow their references."""
        return self.settings.joints

    @property
    def dt(self) -> float:
        """Largest time step [s]."""
        return cast(float, self.settings.dt)

    @property
    def ramp(self) -> float:
        """T of the smooth start [s]."""
        return cast(float, self.settings.ramp)

    @cached_property
    def is_implicit(self) -> bool:
        """Whether any joint is free, which makes the steps linearly implicit (`laticauda.models.planar.stepping`)."""
        return not self.joints.prescribed or has_hinges(self.robot)

    def steps_in(self, interval: float) -> int:
        """Return the number of equal steps, none longer than `dt`, in an `interval` [s] between two samples."""
        return max(1, math.ceil(interval / self.dt - 1e-9))

    @abstractmethod
    def init(self, start: Start, command: Command) -> PlantState:
        """Return the state at time 0: straight at `start`, the generator at the gait of `command`, its offset zero."""

    @abstractmethod
    def observe(self, state: PlantState) -> Observation:
        """Return the observation of `state`."""

    def step(self, state: PlantState, command: Command, dt: float) -> PlantState:
        """Return the state `dt` [s] after `state`, while `command` is held."""
        return self.advance(state, command, dt, dt)[0]

    def march(
        self,
        state: PlantState,
        command: Command,
        duration: float,
        sample_interval: float,
        *,
        link_forces: bool = False,
    ) -> tuple[PlantState, Log, str | None]:
        """Run many steps under one command.

        Args:
            state: Initial state.
            command: Command, held throughout.
            duration: Duration [s].
            sample_interval: Time between two samples of the log [s]; adjusted so that it divides
                the duration.
            link_forces: Whether to log the force on every link too.

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
        state, stretch, failure = self.advance(
            state, command, duration, sample_interval, link_forces=link_forces
        )
        return state, self.log([stretch]), failure

    def advance(
        self,
        state: PlantState,
        command: Command,
        duration: float,
        sample_interval: float,
        *,
        link_forces: bool = False,
    ) -> tuple[PlantState, Stretch, str | None]:
        """Run many steps under one command as `march` does, but return raw samples.

        Args:
            state: Initial state.
            command: Command, held throughout.
            duration: Duration [s].
            sample_interval: Time between two samples of the log [s]; adjusted so that it divides
                the duration.
            link_forces: Whether to keep the force on every link too.
        """
        n_intervals = max(1, round(duration / sample_interval))
        every = self.steps_in(duration / n_intervals)
        dt = duration / n_intervals / every
        end, samples = self._run(state, command, n_intervals, every, dt)
        if len(samples) <= n_intervals:
            when = state.values[0] + len(samples) * duration / n_intervals
            if not len(
                samples
            ):  # the first evaluation is already out of range; the state itself is kept
                samples = self._sample_of(state, command)
            return state, Stretch(samples, command), self.what_went_wrong(when)
        force = self._link_forces(state, command, samples, every, dt) if link_forces else None
        return self._ended(state, command, end), Stretch(samples, command, force), None

    def _ended(self, state: PlantState, command: Command, end: np.ndarray) -> PlantState:
        """Return the state after a march; waves that references replaced continue from where they were."""
        for wave in self._held_waves(command):
            end[wave] = state.values[wave]
        return PlantState(values=end)

    def what_went_wrong(self, time: float) -> str:
        """Return the message of a run that diverged at `time` [s]."""
        limits = getattr(getattr(self.environment, "flow", None), "limits", "")
        return (
            f"The run diverged at t = {time:.3g} s with dt = {self.dt:g} s (a position, angle, rate or torque went "
            f"beyond all bounds); try {self.joints.remedy}{limits and f', unless it left its water: {limits}'}."
        )

    def pack(self, state: PlantState) -> dict[str, np.ndarray]:
        """Return `state` as arrays that can be stored."""
        return {self.name: state.values}

    def unpack(self, stored: Mapping[str, np.ndarray]) -> PlantState:
        """Return the state from the arrays `stored` that `pack` returned.

        Raises:
            ValueError: If the arrays do not come from such a plant.
        """
        values = np.asarray(stored.get(self.name, ()), dtype=float)
        if values.shape != (self._size,):
            rule = (
                f"must be that of {self._words} ({self._size} numbers), got {values.size} numbers"
            )
            raise BadArgument("state", rule)
        return PlantState(values=values)

    @property
    @abstractmethod
    def _size(self) -> int:
        """Size of a state vector."""

    @property
    def _words(self) -> str:
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
    def _link_forces(
        self, state: PlantState, command: Command, samples: np.ndarray, every: int, dt: float
    ) -> np.ndarray:
        """Return the force on every link at the samples of a march: component, time, link, axis."""

    def log(self, stretches: Sequence[Stretch]) -> Log:
        """Return the log of consecutive stretches.

        Args:
            stretches: Consecutive stretches; each begins with the last sample of the previous one.
        """
        samples, *more = [one.samples for one in stretches]
        counts = [len(samples), *(len(one) - 1 for one in more)]
        found = self._samples(
            np.concatenate([samples, *(one[1:] for one in more)]) if more else samples
        )
        driven: dict[str, np.ndarray] = {}
        for _, group, number, _ in EFFECTORS:
            for i, one in enumerate(getattr(self.robot, group)):
                if getattr(one, f"max_{number}") is not None:
                    given = [
                        getattr(getattr(of.command.effectors(self.robot), group)[i], number)
                        for of in stretches
                    ]
                    driven[f"{number}_{i}"] = np.repeat(np.array(given, dtype=float), counts)
        force = dict(found.link_force or {})
        if all(one.force is not None for one in stretches):
            first, *more = [cast(np.ndarray, one.force) for one in stretches]
            every = np.concatenate([first, *(one[:, 1:] for one in more)], axis=1)
            force = dict(zip(FORCES, every, strict=True)) | force
        return Log(
            **found.seen,
            joint_angle_ref=self._commanded(found.reference, found.offset),
            joint_torque=found.torque,
            work=found.work[:, :3],
            electrical_work=found.work[:, 3] if has_power_model(self.robot, self.joints) else None,
            link_force=force or None,
            signals={**found.signals, **driven, **fin_signals(self.robot.fin_joints, *found.fin)},
        )

    def _commanded(self, done: np.ndarray, offset: np.ndarray) -> np.ndarray:
        """Return the gait's reference; the kernels' reference is the share that prescribed joints do (`tracking`)."""
        share = np.array([joint.actuator.tracking for joint in self.robot.joints])
        if not self.joints.prescribed or np.all(share == 1.0):
            return done
        return offset + (done - offset) / share

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
        return STILL, STILL, STILL if self._holds_fin(command) else fin

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
        return self.generator if self._holds_fin(command) else self.generator[:-1]

    def _begun(self, state: PlantState, command: Command) -> np.ndarray:
        """Return a copy of the state vector in which waves with held references stand still at their crest."""
        values = state.values.copy()
        for wave in self._held_waves(command):
            values[wave] = CREST[: wave.stop - wave.start]
        return values

    def _hold(self, joints: np.ndarray, command: Command) -> None:
        """Write external references to the numbers of the driven joints (`joint_table`), and switch motors off."""
        command.check_held(self.robot, self.joints)
        if command.references is not None:
            joints[: len(command.references), 0] = command.references
        if command.enabled is not None:
            # No gain, no stall torque and no current: only the friction of the servo's gear remains
            # of both laws.
            off = np.flatnonzero(np.logical_not(command.enabled))
            joints[off, _DRIVE : _MOTOR + 1] = 0.0
            joints[off, _STALL_POWER] = 0.0


_, _, _, _DRIVE, _MOTOR, _STALL_POWER, _JOINT_ROWS = JOINT


def joint_table(robot: Robot, law: JointLaw) -> Float[np.ndarray, "n_joints n_numbers"]:
    """Return the kernels' numbers of every joint (`laticauda.motion.joints.laws.JOINT`): body, then fin from its root.

    Args:
        robot: Robot with the joints; the passive hinges of its fin have stiffness and damping only.
        law: Law by which the driven joints follow their references.
    """
    has_power = has_power_model(robot, law)
    known: dict[int, tuple[float, ...]] = {}
    for joint in {
        id(joint): joint for joint in robot.driven_joints
    }.values():  # most joints are the same object
        motor, power = joint.actuator, joint.actuator.stall_power if has_power else 0.0
        drive = (getattr(motor, name) for name in Drive._fields)
        known[id(joint)] = (
            motor.tracking if law.prescribed else 1.0,
            joint.stiffness,
            joint.damping,
            *drive,
            power,
        )
    found = [known[id(joint)] for joint in robot.driven_joints]
    for hinge in robot.caudal_fin.hinges if robot.caudal_fin is not None else ():
        found.append((0.0, hinge.stiffness, hinge.damping, *(0.0,) * (_JOINT_ROWS - 3)))
    return np.array(found).reshape(-1, _JOINT_ROWS)


def has_hinges(robot: Robot) -> bool:
    """Return whether a robot has a flexible fin.

    Args:
        robot: Robot to check.
    """
    return robot.caudal_fin is not None and robot.caudal_fin.n_hinges > 0


def check_size(duration: float, sample_interval: float) -> None:
    """Reject a log that is too large for memory.

    Args:
        duration: Duration of the run [s].
        sample_interval: Time between two samples [s].

    Raises:
        ValueError: If there would be more than `MOST_SAMPLES` samples.
    """
    longest = MOST_SAMPLES * sample_interval
    if duration > longest:
        rule = f"must be <= {longest:g} s at a `sample_interval` of {sample_interval:g} s, got {duration:g}"
        raise BadArgument("duration", f"{rule}; a longer `sample_interval` allows a longer run")
