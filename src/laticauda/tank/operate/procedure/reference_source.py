"""References of the joints: straight, straightening, or the controller's gait.

A gait goes through the reference generator of the simulation.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from laticauda.motion import gaits
from laticauda.motion.gaits import GeneratorState, smooth_start
from laticauda.robot import Robot
from laticauda.scenarios import interfaces
from laticauda.tank.operate.safety.modules import JointValues as References

TIME_ROUNDING = 1e-9
"""Rounding error of sums of ticks [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ReferenceState:
    """State of the references, and of what generates them."""

    references: References
    """phi_ref of every joint, all axes, then that of a driven fin [rad]."""
    origin: References
    """References at which straightening began [rad]."""
    since: float = 0.0
    """Time at which straightening began [s]."""
    controller_state: Any = None
    """State of the controller; None before the run."""
    command: interfaces.Command | None = None
    """Last command of the controller; None before the run."""
    n_decisions: int = 0
    """Number of decisions of the controller so far [-]."""
    due: float = 0.0
    """Time of the controller's next decision [s]."""
    generator: GeneratorState | None = None
    """State of the reference generator; None before the run."""
    time: float = 0.0
    """Time of the generator [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ReferenceSource:
    """Turns observations into joint references: a controller, and the simulation's generator."""

    robot: Robot
    """Robot with these joints."""
    controller: interfaces.Controller[Any]
    """Controller, as in simulation."""
    ramp: float
    """Duration of the smooth start [s]."""
    offset_bandwidth: float
    """Bandwidth of the generator [rad/s]."""

    @cached_property
    def generator(self) -> gaits.Generator:
        """The reference generator."""
        axes = tuple(joint.axis for joint in self.robot.joints)
        return gaits.Generator(
            n_links=self.robot.n_links, axes=axes, bandwidth=self.offset_bandwidth, ramp=self.ramp
        )

    def init(self) -> ReferenceState:
        """Return the initial state: straight."""
        straight = np.zeros(len(self.robot.driven_joints))
        return ReferenceState(references=straight, origin=straight)

    def start_straightening(
        self, state: ReferenceState, now: float, angle: References
    ) -> ReferenceState:
        """Start straightening.

        Args:
            state: State returned by the last call, or by `init`.
            now: Current time [s].
            angle: Angles of the joints, or their references [rad]; nan counts as straight.
        """
        origin = np.where(np.isfinite(angle), angle, 0.0)
        return replace(state, references=origin, origin=origin, since=now)

    def straighten(self, state: ReferenceState, now: float, duration: float) -> ReferenceState:
        """Continue straightening, smoothly.

        Args:
            state: State returned by `start_straightening`, or by this method.
            now: Current time [s].
            duration: Duration of the whole straightening [s].
        """
        share, _rate, _acceleration = smooth_start(max(now - state.since, 0.0), duration)
        return replace(state, references=state.origin * (1.0 - share))

    def begin(self, state: ReferenceState, now: float) -> ReferenceState:
        """Begin the run, straight."""
        gait = self.controller.gait
        return replace(
            state,
            controller_state=self.controller.init(),
            command=interfaces.Command(gait=gait),
            due=now,
            generator=self.generator.init(gait),
            time=now,
        )

    def decide(
        self, state: ReferenceState, now: float, observation: interfaces.Observation
    ) -> ReferenceState:
        """Let the controller decide, if a decision is due.

        Args:
            state: State after `begin`.
            now: Current time [s].
            observation: Observation from the estimator.
        """
        if now < state.due - TIME_ROUNDING:
            return state
        controller_state, command = self.controller.step(state.controller_state, observation)
        return replace(
            state,
            controller_state=controller_state,
            command=command,
            due=max(state.due + self.controller.interval, now),
            n_decisions=state.n_decisions + 1,
        )

    def follow(self, state: ReferenceState, now: float) -> ReferenceState:
        """Compute the references at this moment.

        Args:
            state: State after `decide`.
            now: Current time [s].
        """
        assert state.command is not None and state.generator is not None  # `begin` sets them
        gait = state.command.steered
        generator = self.generator.step(state.generator, gait, now - state.time)
        joint_angles = self.generator.joints(generator, gait)[0]
        fin_angle = self.generator.fin(generator, gait)[0]
        n_driven = state.references.size  # without a driven fin, its angle is left out
        references = np.append(joint_angles, fin_angle)[:n_driven]
        return replace(state, references=references, generator=generator, time=now)

    def signals(self, state: ReferenceState) -> dict[str, float]:
        """Return the controller's signals; empty before the run, or if it has none."""
        if state.controller_state is None:
            return {}
        return dict(self.controller.signals(state.controller_state))
