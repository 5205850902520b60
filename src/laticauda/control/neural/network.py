"""What controllers made of neurons share: a chain with cuts, feedback from the body, and steering from above.

A network tends to a gait, from which it takes frequency, amplitudes and phase shift. It commands the
reference of every joint, so it is for joints that take references: servos, pd control, muscles.
Another controller may steer it: the offset that it commands bends the body, and the amplitude and
frequency of its gait drive the network.

A network can stand for many (`many.stack_networks`): its numbers are then columns with one row per
network, and so are those of its neurons and its drive. The formulas of a network take either; joints
are always the last axis.
"""

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, ClassVar, Generic, TypeAlias, TypeVar

import numpy as np
from jaxtyping import Float

from laticauda.motion.gaits import Gait
from laticauda.robot import Robot
from laticauda.scenarios import (
    SHORTEST_INTERVAL,
    Command,
    Controller,
    Observation,
    Observations,
)
from laticauda.values import BadArgument, check_instance, option, quantity, value_class

Neurons = TypeVar("Neurons", bound=tuple[Any, ...])
PerJoint = Float[np.ndarray, "... n_joints"]
Signals: TypeAlias = Mapping[str, float | Float[np.ndarray, " n_networks"]]
PerNetwork: TypeAlias = Float[np.ndarray, "n_networks 1"]

LONGEST_INTERVAL = 1.0
"""Longest time between two control instants: joints hold still meanwhile, and no wave remains [s]."""
LONGEST_STEP = 0.01
"""Largest time step by which neurons are integrated [s]."""
FASTEST_PULL = 2.0 / LONGEST_STEP
"""Rate of decay beyond which the midpoint rule no longer follows neurons in such steps [1/s]."""
ROUNDING = 1e-9
"""Time by which an instant may be too early and still counts [s]."""


@value_class
class Feedback:
    """What a neuron feels of the body at its own joint; each kind pulls its phase, by the rate times its gain.

    A positive gain of either kind lets an oscillator advance while what it feels agrees with the bend
    that it commands.
    """

    stretch: float = quantity("1/(rad s)", "Gain of the joint's own angle", default=0.0)
    pressure: float = quantity(
        "1/(Pa s)",
        "Gain of the mean pressure difference on the two links of the joint",
        default=0.0,
    )

    def __bool__(self) -> bool:
        """Return whether anything is felt."""
        return bool(np.any(self.stretch != 0.0) or np.any(self.pressure != 0.0))

    def felt(self, observation: Observation | Observations) -> PerJoint:
        """Return the rate by which what is felt would pull a phase at most, for every joint [1/s].

        Args:
            observation: What the robot feels, or what many robots feel.
        """
        rate = self.stretch * observation.joint_angle
        if np.any(self.pressure != 0.0):
            pressure = observation.loads.pressure_difference
            at_joints = 0.5 * (pressure[..., :-1] + pressure[..., 1:])
            rate = rate + self.pressure * at_joints
        return rate


@dataclass(frozen=True)
class Drive:
    """What a network is asked for from above."""

    amplitude: PerJoint
    """Amplitude of every joint [rad]."""
    frequency: PerJoint
    """Natural angular frequency of every joint's neurons [rad/s]."""
    phase_shift: float | PerNetwork
    """Phase shift from joint to joint [rad]."""
    offset: float | PerNetwork
    """Bend of all joints; positive turns left [rad]."""

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return self.amplitude.shape[-1]


@dataclass(frozen=True, kw_only=True)
class NetworkState(Generic[Neurons]):
    """State of a network between two control instants."""

    neurons: Neurons | None = None
    """Its neurons; None before the first instant."""
    time: float = 0.0
    """Time of the last instant [s]."""
    steering: Any = None
    """State of the controller that steers."""
    steered_at: float = -math.inf
    """When it steered last [s]."""
    command: Command | None = None
    """What it commanded then."""
    signals: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """Signals of the last instant, for the log."""


@value_class
class NeuralGait(Controller[NetworkState[Neurons]], Generic[Neurons]):
    """Base of controllers made of neurons.

    Raises:
        ValueError: If a field is out of its range.
    """

    gait: Gait = option("The gait to which the network tends, unless `steering` asks for another")
    feedback: Feedback = option("What every neuron feels of the body", default=Feedback())
    cuts: tuple[int, ...] = option(
        "Joints, 0 = tail, whose coupling to the next joint is severed", default=()
    )
    steering: Controller[Any] | None = option(
        "Controller that drives and steers it, such as path following", default=None
    )
    seed: int | None = quantity(
        "",
        "Seed of random initial phases and of the spread; None: the phases of the gait, no spread",
        ge=0,
        default=None,
    )
    spread: float = quantity(
        "", "Standard deviation of the natural frequencies, per frequency", ge=0.0, default=0.0
    )
    interval: float = quantity(
        "s",
        "Time between two control instants",
        default=0.02,
        ge=SHORTEST_INTERVAL,
        le=LONGEST_INTERVAL,
    )

    members: "ClassVar[Sequence[NeuralGait[Any]]]" = ()
    """The networks that this one stands for, if it stands for many."""

    def __post_init__(self) -> None:
        if self.gait.recorded is not None:
            rule = "must be a wave, with an amplitude and a frequency, got a recorded motion"
            raise BadArgument("gait", rule)
        if self.steering is None:
            return
        check_instance("steering", self.steering, Controller)
        if isinstance(self.steering, NeuralGait):
            rule = "must be a controller that commands a gait, got a network, which commands joints"
            raise BadArgument("steering", rule)

    def check(self, robot: Robot) -> None:
        """Reject a `robot` with pitch joints or none, or cuts where it has no joints."""
        if not robot.joints:
            raise BadArgument("robot", f"must have joints to be moved by neurons, got {robot.name}")
        if any(joint.axis != "yaw" for joint in robot.joints):
            rule = "must have yaw joints only to be moved by neurons"
            advice = "in the plane (model `planar`) those of its yaw joints alone count"
            raise BadArgument("robot", f"{rule}, got `{robot.name}` with pitch joints; {advice}")
        last = robot.n_joints - 2
        for cut in self.cuts:
            if not 0 <= cut <= last:
                raise BadArgument("cuts", f"must be joints from 0 to {last}, got {cut}")
        if self.steering is not None:
            self.steering.check(robot)

    def init(self) -> NetworkState[Neurons]:
        """Return the state before the first control instant."""
        if self.steering is None:
            return NetworkState()
        return NetworkState(steering=self.steering.init())

    def step(
        self, state: NetworkState[Neurons], observation: Observation
    ) -> tuple[NetworkState[Neurons], Command]:
        """Return the state after the observation, and the references until the next instant.

        Args:
            state: State returned by the last control instant or by `init`.
            observation: What the robot feels, and what steering sees.
        """
        state = self._steer(state, observation)
        drive = self.drive(state.command, observation.joint_angle.size)
        now = float(observation.time)
        neurons = state.neurons
        if neurons is None:
            neurons = self.begin(drive)
        elapsed = now - state.time
        if elapsed > 0.0:
            neurons = self.advance(neurons, drive, observation, elapsed)
        references = self.references(neurons, drive)
        next_state = replace(state, neurons=neurons, time=now, signals=self.watch(neurons))
        return next_state, Command(gait=self.gait, references=tuple(references.tolist()))

    @abstractmethod
    def begin(self, drive: Drive) -> Neurons:
        """Return the neurons at the start.

        Args:
            drive: What is asked of them.
        """

    def rates(self, neurons: Neurons, drive: Drive, felt: PerJoint) -> Neurons:
        """Return the time derivatives of all numbers of the neurons; for `move`, unless a class has its own.

        Args:
            neurons: The neurons.
            drive: What is asked of them.
            felt: Rate by which feedback would pull each phase at most [1/s].
        """
        raise NotImplementedError(f"{type(self).__name__} has neither `rates` nor `move`.")

    @abstractmethod
    def references(self, neurons: Neurons, drive: Drive) -> PerJoint:
        """Return the reference of every joint [rad].

        Args:
            neurons: The neurons.
            drive: What is asked of them.
        """

    @abstractmethod
    def watch(self, neurons: Neurons) -> Signals:
        """Return signals for the log.

        Args:
            neurons: The neurons.
        """

    def move(self, neurons: Neurons, drive: Drive, felt: PerJoint, dt: float) -> Neurons:
        """Return the neurons a time step later, by the midpoint rule.

        Args:
            neurons: The neurons.
            drive: What is asked of them.
            felt: Rate by which feedback would pull each phase at most [1/s].
            dt: Time step [s].
        """
        middle = _moved(neurons, self.rates(neurons, drive, felt), 0.5 * dt)
        return _moved(neurons, self.rates(middle, drive, felt), dt)

    def is_coupled(self, n_joints: int) -> Float[np.ndarray, "... n_joints_but_one"]:
        """Return 1 where a joint is coupled to the next one, 0 at cuts [-].

        Args:
            n_joints: Number of joints.
        """
        if self.members:
            return self._stack("is_coupled", n_joints)
        coupled = np.ones(n_joints - 1)
        coupled[list(self.cuts)] = 0.0
        return coupled

    def initial_phases(self, drive: Drive) -> PerJoint:
        """Return the phases at the start: those of the gait, or random ones [rad].

        Args:
            drive: What is asked of the network.
        """
        n_joints = drive.n_joints
        if self.members:
            shifts = np.ravel(drive.phase_shift)
            phases = [
                member.first_phases(n_joints, float(shift))
                for member, shift in zip(self.members, shifts, strict=True)
            ]
            return np.stack(phases)
        return self.first_phases(n_joints, float(drive.phase_shift))

    def first_phases(self, n_joints: int, phase_shift: float) -> PerJoint:
        """Return the phases of one network at the start [rad].

        Args:
            n_joints: Number of joints.
            phase_shift: Phase shift from joint to joint of its gait [rad].
        """
        if self.seed is None:
            return phase_shift * np.arange(n_joints)
        random = np.random.default_rng(self.seed)
        return random.uniform(-math.pi, math.pi, n_joints)

    def natural_shares(self, n_joints: int) -> PerJoint:
        """Return the natural frequency of every joint's neurons, per frequency of the gait [-].

        Args:
            n_joints: Number of joints.
        """
        if self.members:
            return self._stack("natural_shares", n_joints)
        if self.seed is None or self.spread == 0.0:
            return np.ones(n_joints)
        return 1.0 + self.spread * _standard_deviates(self.seed, n_joints)

    def _steer(
        self, state: NetworkState[Neurons], observation: Observation
    ) -> NetworkState[Neurons]:
        """Ask the controller that steers, if it is its turn."""
        if self.steering is None:
            return state
        now = float(observation.time)
        if now < state.steered_at + self.steering.interval - ROUNDING:
            return state
        steering, command = self.steering.step(state.steering, observation)
        return replace(state, steering=steering, command=command, steered_at=now)

    def drive(self, command: Command | None, n_joints: int) -> Drive:
        """Return what is asked of one network.

        Args:
            command: What steering commands; None: nothing steers.
            n_joints: Number of joints.
        """
        gait = self.gait
        offset = gait.offset
        if command is not None:
            gait = command.gait
            offset = gait.offset + command.offset
        envelope = np.array(gait.envelope.joints(n_joints + 1))
        return Drive(
            amplitude=gait.amplitude * envelope,
            frequency=gait.frequency * self.natural_shares(n_joints),
            phase_shift=gait.phase_shift,
            offset=offset,
        )

    def check_drive(self, drive: Drive) -> None:
        """Reject what neurons cannot follow in their steps; here they follow everything.

        Args:
            drive: What is asked of them.

        Raises:
            ValueError: If they cannot follow it.
        """

    def advance(
        self,
        neurons: Neurons,
        drive: Drive,
        observation: Observation | Observations,
        elapsed: float,
    ) -> Neurons:
        """Return the neurons some time later, moved in steps that are short enough.

        Args:
            neurons: The neurons.
            drive: What is asked of them.
            observation: What the robot feels, or what many robots feel.
            elapsed: The time [s].

        Raises:
            ValueError: If neurons, or the pull of feedback, are faster than their steps can follow.
        """
        self.check_drive(drive)
        felt = np.zeros(drive.amplitude.shape)
        if self.feedback:
            felt = self.feedback.felt(observation)
            _check_pull(felt)
        n_steps = math.ceil(elapsed / LONGEST_STEP - ROUNDING)
        for _ in range(n_steps):
            neurons = self.move(neurons, drive, felt, elapsed / n_steps)
        return neurons

    def _stack(self, method: str, n_joints: int) -> np.ndarray:
        """Return what a method returns for every network that this one stands for, computed once."""
        stacks: dict[Any, np.ndarray] = vars(self).setdefault("_stacks", {})
        if (method, n_joints) not in stacks:
            results = [getattr(member, method)(n_joints) for member in self.members]
            stacks[method, n_joints] = np.stack(results)
        return stacks[method, n_joints]


def _moved(neurons: Neurons, rates: Neurons, dt: float) -> Neurons:
    """Return the neurons, a named tuple, after a time step at constant rates."""
    moved = [number + dt * rate for number, rate in zip(neurons, rates, strict=True)]
    return type(neurons)(*moved)


@lru_cache(maxsize=1024)  # asked for at every control instant
def _standard_deviates(seed: int, n_joints: int) -> PerJoint:
    """Return the deviates of a seed that spread natural frequencies."""
    deviates = np.random.default_rng((seed, 1)).standard_normal(n_joints)
    deviates.flags.writeable = False
    return deviates


def _check_pull(felt: PerJoint) -> None:
    """Reject feedback that is too strong for the steps of the neurons."""
    pull = float(np.max(np.abs(felt)))
    if pull > FASTEST_PULL:
        rule = f"must pull phases by at most {FASTEST_PULL:g} 1/s, which steps of {LONGEST_STEP:g} s follow"
        raise BadArgument("feedback", f"{rule}, got gains that pull by {pull:.3g} 1/s")
