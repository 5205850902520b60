"""What the joints are asked for: straight, straightening, or the controller's gait through the reference generator."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from laticauda.gaits import Generator
from laticauda.gaits.generator import GeneratorState
from laticauda.gaits.reference import smooth_start
from laticauda.interfaces import Command, Controller, Observation
from laticauda.operate.modules import Numbers as References
from laticauda.robot import Robot

ROUNDING = 1e-9  # of sums of ticks [s]


@dataclass(frozen=True, kw_only=True, eq=False)
class Asking:
    """What has been asked for so far."""

    references: References
    """phi_ref of every joint, all axes [rad]."""
    origin: References
    """Where straightening began [rad]."""
    since: float = 0.0
    """When it began [s]."""
    thought: Any = None
    """State of the controller; None before the run."""
    command: Command | None = None
    """Its last command; None before the run."""
    thoughts: int = 0
    """How often the controller has been asked [-]."""
    due: float = 0.0
    """When the controller is asked next [s]."""
    generator: GeneratorState | None = None
    """Where the reference generator stands; None before the run."""
    time: float = 0.0
    """Of the generator [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Asker:
    """From observations to joint references: the controller, and the generator of the simulation."""

    robot: Robot
    """Whose joints they are."""
    controller: Controller[Any]
    """What decides, as in simulation."""
    ramp: float
    """Of the smooth start [s]."""
    offset_bandwidth: float
    """Of the generator [rad/s]."""

    @cached_property
    def generator(self) -> Generator:
        """The one reference generator."""
        return Generator(n_links=self.robot.planar().n_links, bandwidth=self.offset_bandwidth, ramp=self.ramp)

    @cached_property
    def yaw(self) -> np.ndarray:
        """Which joints turn in the swimming plane; the others are held at zero."""
        return np.array([joint.axis == "yaw" for joint in self.robot.joints], dtype=bool)

    def init(self) -> Asking:
        """Straight."""
        straight = np.zeros(self.robot.n_joints)
        return Asking(references=straight, origin=straight)

    def from_here(self, state: Asking, now: float, angle: References) -> Asking:
        """Straightening begins.

        Args:
            state: As the last call returned it, or `init`.
            now: [s].
            angle: Where the joints are, or what they were asked for [rad]; nan counts as straight.
        """
        origin = np.where(np.isfinite(angle), angle, 0.0)
        return replace(state, references=origin, origin=origin, since=now)

    def straighten(self, state: Asking, now: float, duration: float) -> Asking:
        """On the way to straight, smoothly.

        Args:
            state: As `from_here` returned it, or this.
            now: [s].
            duration: Of the whole way [s].
        """
        share = smooth_start(max(now - state.since, 0.0), duration)[0]
        return replace(state, references=state.origin * (1.0 - share))

    def begin(self, state: Asking, now: float) -> Asking:
        """The run begins, straight."""
        gait = self.controller.gait
        return replace(
            state,
            thought=self.controller.init(),
            command=Command(gait=gait),
            due=now,
            generator=self.generator.init(gait),
            time=now,
        )

    def think(self, state: Asking, now: float, observation: Observation) -> Asking:
        """Ask the controller, if it is due.

        Args:
            state: After `begin`.
            now: [s].
            observation: What the estimator says.
        """
        if now < state.due - ROUNDING:
            return state
        thought, command = self.controller.step(state.thought, observation)
        due = state.due + self.controller.interval
        due = due if due > now else now
        return replace(state, thought=thought, command=command, due=due, thoughts=state.thoughts + 1)

    def follow(self, state: Asking, now: float) -> Asking:
        """The references at this moment.

        Args:
            state: After `think`.
            now: [s].
        """
        assert state.command is not None and state.generator is not None  # `begin` made them
        gait = replace(state.command.gait, offset=state.command.gait.offset + state.command.offset)
        generator = self.generator.step(state.generator, gait, now - state.time)
        references = np.zeros(self.robot.n_joints)
        references[self.yaw] = self.generator.joints(generator, gait)[0]
        return replace(state, references=references, generator=generator, time=now)

    def signals(self, state: Asking) -> dict[str, float]:
        """What the controller had in mind; empty before the run, or if it says nothing."""
        return {} if state.thought is None else dict(self.controller.signals(state.thought))
