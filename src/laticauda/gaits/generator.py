"""The reference generator as an object: the same scalar functions that the kernels compile, for a robot or a test."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.errors import not_negative, positive, whole
from laticauda.gaits import reference
from laticauda.gaits.gait import Gait


@dataclass(frozen=True, kw_only=True)
class GeneratorState:
    """Where the generator stands: values after the filters, with their rates."""

    time: float
    """Since the start [s]."""
    phase: float
    """Integral of the frequency [rad]."""
    amplitude: tuple[float, float]
    """alpha [rad] and its rate [rad/s]."""
    frequency: tuple[float, float]
    """omega [rad/s] and its rate [rad/s^2]."""
    phase_shift: tuple[float, float]
    """delta [rad] and its rate [rad/s]."""
    offset: tuple[float, float]
    """phi_0 [rad] and its rate [rad/s]."""


@dataclass(frozen=True, kw_only=True)
class Generator:
    """Turns a gait, which may change at any time, into joint references that a body can follow.

    Amplitude, frequency, phase shift and offset follow what is asked for through critically damped filters, so the
    references and their rates are continuous; see `laticauda.gaits.reference`. The planar kernels compute the same.
    The envelope is not filtered: bring the amplitude to zero before asking for another kind of gait.

    Raises:
        ValueError: If a field is out of its range.

    Example:
        >>> gait = Gait(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> generator = Generator(n_links=4)
        >>> state = generator.step(generator.init(gait), gait, 1.5)
        >>> generator.joints(state, gait)[0].round(3).tolist()
        [0.071, -0.265, -0.476]
    """

    n_links: int
    """n, the number of links [-]."""
    bandwidth: float = 10.0
    """Of the critically damped filters on amplitude, frequency, phase shift and offset [rad/s]."""
    ramp: float = 1.0
    """T of the smooth start; 0 means none [s]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        object.__setattr__(self, "n_links", whole("n_links", self.n_links, 1))
        object.__setattr__(self, "bandwidth", positive("bandwidth", self.bandwidth, "rad/s"))
        object.__setattr__(self, "ramp", not_negative("ramp", self.ramp, "s"))

    def init(self, gait: Gait) -> GeneratorState:
        """The start: at the gait's amplitude, frequency and phase shift; the offset builds up from zero.

        Args:
            gait: What is asked for at the start.
        """
        return GeneratorState(
            time=0.0,
            phase=0.0,
            amplitude=(gait.amplitude, 0.0),
            frequency=(gait.frequency, 0.0),
            phase_shift=(gait.phase_shift, 0.0),
            offset=(0.0, 0.0),
        )

    def step(self, state: GeneratorState, gait: Gait, dt: float) -> GeneratorState:
        """The state after a time step during which one gait is asked for; exact for steps of any size.

        Args:
            state: Before the step.
            gait: What is asked for; steering goes into its offset.
            dt: Step [s].
        """
        w = self.bandwidth
        decay = math.exp(-w * dt)
        amplitude = reference.filter_step(*state.amplitude, gait.amplitude, w, decay, dt)
        frequency = reference.filter_step(*state.frequency, gait.frequency, w, decay, dt)
        phase_shift = reference.filter_step(*state.phase_shift, gait.phase_shift, w, decay, dt)
        offset = reference.filter_step(*state.offset, gait.offset, w, decay, dt)
        return GeneratorState(
            time=state.time + dt,
            phase=state.phase + frequency[2],
            amplitude=amplitude[:2],
            frequency=frequency[:2],
            phase_shift=phase_shift[:2],
            offset=offset[:2],
        )

    def joints(self, state: GeneratorState, gait: Gait) -> Float[np.ndarray, "3 n_joints"]:
        """The references of every joint, tail first.

        Args:
            state: Where the generator stands.
            gait: What is asked for at that instant; the accelerations depend on it, angles and rates do not.

        Returns:
            phi_ref [rad], phi_ref' [rad/s] and phi_ref'' [rad/s^2], one row each.

        Raises:
            ValueError: If the gait has a custom envelope for another number of joints.
        """
        w = self.bandwidth
        second = [
            reference.filter_acceleration(*value, target, w)
            for value, target in (
                (state.amplitude, gait.amplitude),
                (state.phase_shift, gait.phase_shift),
                (state.offset, gait.offset),
            )
        ]
        ramp = reference.smooth_start(state.time, self.ramp)
        amplitude = reference.ramped(*state.amplitude, second[0], *ramp)
        columns: list[tuple[float, float, float]] = []
        for i, g in enumerate(gait.joint_envelope(self.n_links)):
            psi = state.phase + i * state.phase_shift[0]
            columns.append(
                reference.joint_reference(
                    math.sin(psi),
                    math.cos(psi),
                    g,
                    *amplitude,
                    state.frequency[0] + i * state.phase_shift[1],
                    state.frequency[1] + i * second[1],
                    *state.offset,
                    second[2],
                )
            )
        return np.array(columns).reshape(-1, 3).T
