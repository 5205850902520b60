"""The references of the joints: straight, straightening, or the controller's gait through the reference generator."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from laticauda import gaits, interfaces
from laticauda.gaits.generator import GeneratorState
from laticauda.gaits.reference import smooth_start
from laticauda.operate.safety.limits import Numbers as References
from laticauda.robot import Robot

ROUNDING = 1e-9  # of sums of ticks [s]


@dataclass(frozen=True, kw_only=True, eq=False)
class ReferenceState:
    """The references so far, and what makes them."""

    references: References
    """phi_ref of every joint, all axes, then of a driven fin [rad]."""
    origin: References
    """Where straightening began [rad]."""
    since: float = 0.0
    """When it began [s]."""
    controller_state: Any = None
    """Of the controller; None before the run."""
    command: interfaces.Command | None = None
    """Its last command; None before the run."""
    n_decisions: int = 0
    """How often the controller has decided [-]."""
    due: float = 0.0
    """When the controller decides next [s]."""
    generator: GeneratorState | None = None
    """Where the reference generator stands; None before the run."""
    time: float = 0.0
    """Of the generator [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ReferenceSource:
    """From observations to joint references: the controller, and the generator of the simulation."""

    robot: Robot
    """Whose joints they are."""
    controller: interfaces.Controller[Any]
    """What decides, as in simulation."""
    ramp: float
    """Of the smooth start [s]."""
    offset_bandwidth: float
    """Of the generator [rad/s]."""

    @cached_property
    def generator(self) -> gaits.Generator:
        """The one reference generator."""
        axes = tuple(joint.axis for joint in self.robot.joints)
        return gaits.Generator(n_links=self.robot.n_links, axes=axes, bandwidth=self.offset_bandwidth, ramp=self.ramp)

    def init(self) -> ReferenceState:
        """Straight."""
        straight = np.zeros(len(self.robot.driven_joints))
        return ReferenceState(references=straight, origin=straight)

    def start_straightening(self, state: ReferenceState, now: float, angle: References) -> ReferenceState:
        """Straightening begins.

        Args:
            state: As the last call returned it, or `init`.
            now: [s].
            angle: Where the joints are, or their references [rad]; nan counts as straight.
        """
        origin = np.where(np.isfinite(angle), angle, 0.0)
        return replace(state, references=origin, origin=origin, since=now)

    def straighten(self, state: ReferenceState, now: float, duration: float) -> ReferenceState:
        """On the way to straight, smoothly.

        Args:
            state: As `start_straightening` returned it, or this.
            now: [s].
            duration: Of the whole way [s].
        """
        share = smooth_start(max(now - state.since, 0.0), duration)[0]
        return replace(state, references=state.origin * (1.0 - share))

    def begin(self, state: ReferenceState, now: float) -> ReferenceState:
        """The run begins, straight."""
        gait = self.controller.gait
        return replace(
            state,
            controller_state=self.controller.init(),
            command=interfaces.Command(gait=gait),
            due=now,
            generator=self.generator.init(gait),
            time=now,
        )

    def decide(self, state: ReferenceState, now: float, observation: interfaces.Observation) -> ReferenceState:
        """Let the controller decide, if it is due.

        Args:
            state: After `begin`.
            now: [s].
            observation: What the estimator says.
        """
        if now < state.due - ROUNDING:
            return state
        controller_state, command = self.controller.step(state.controller_state, observation)
        due = state.due + self.controller.interval
        due = due if due > now else now
        decided = state.n_decisions + 1
        return replace(state, controller_state=controller_state, command=command, due=due, n_decisions=decided)

    def follow(self, state: ReferenceState, now: float) -> ReferenceState:
        """The references at this moment.

        Args:
            state: After `decide`.
            now: [s].
        """
        assert state.command is not None and state.generator is not None  # `begin` made them
        gait = state.command.steered
        generator = self.generator.step(state.generator, gait, now - state.time)
        fin = self.generator.fin(generator, gait)[0]
        references = np.append(self.generator.joints(generator, gait)[0], fin)[: state.references.size]
        return replace(state, references=references, generator=generator, time=now)

    def signals(self, state: ReferenceState) -> dict[str, float]:
        """The controller's signals; empty before the run, or if it has none."""
        return {} if state.controller_state is None else dict(self.controller.signals(state.controller_state))
