"""Reference generator as an object: the same scalar functions that the kernels compile, for a robot or a test."""

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda.motion.gaits import reference
from laticauda.motion.gaits.gait import STRAIGHT, Gait
from laticauda.motion.gaits.reference import WaveState
from laticauda.values import BadArgument, option, quantity, value_class

Reference: TypeAlias = tuple[float, float, float]
"""Angle [rad], rate [rad/s] and acceleration [rad/s^2] of one joint."""


@dataclass(frozen=True, kw_only=True)
class GeneratorState:
    """State of the generator."""

    time: float
    """Time since the start [s]."""
    time_rest: float = 0.0
    """Accumulated rounding error of `time` [s]."""
    yaw: WaveState
    """Wave of the yaw joints."""
    pitch: WaveState
    """Wave of the pitch joints."""
    fin: WaveState
    """Wave of a driven fin."""


@value_class
class Generator:
    """Generator that turns a gait, which may change at any time, into joint references that a body can follow.

    Amplitude, frequency, phase shift and offset of every wave follow their targets through
    critically damped filters, so the references and their rates are continuous; see
    `laticauda.motion.gaits.reference`. The kernels compute the same references. The envelope is not
    filtered: bring the amplitude to zero before changing to another kind of gait.

    Raises:
        ValueError: If a field is out of its range.

    Example:
        >>> gait = Gait(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> generator = Generator(n_links=4)
        >>> state = generator.step(generator.init(gait), gait, 1.5)
        >>> generator.joints(state, gait)[0].round(3).tolist()
        [0.071, -0.265, -0.476]
    """

    n_links: int = quantity("", "n, the number of links", ge=1)
    axes: tuple[str, ...] | None = option(
        "Axis of every joint, tail first; None: all of them yaw", default=None
    )
    bandwidth: float = quantity(
        "rad/s", "Bandwidth of the filters on the gait's parameters", default=10.0, gt=0.0
    )
    ramp: float = quantity("s", "T of the smooth start; 0 means none", default=1.0, ge=0.0)

    def __post_init__(self) -> None:
        """Check the consistency of the fields."""
        if self.axes is not None and len(self.axes) != self.n_links - 1:
            n_joints = self.n_links - 1
            rule = f"must have one entry per joint, {n_joints}, got {len(self.axes)}"
            raise BadArgument("axes", rule)

    def init(self, gait: Gait) -> GeneratorState:
        """Return the initial state: the gait's amplitudes, frequencies and phase shifts; offsets build up from zero.

        Args:
            gait: Gait at the start.
        """
        yaw_target, pitch_target, fin_target = gait.targets()
        return GeneratorState(
            time=0.0,
            yaw=reference.first_state(yaw_target),
            pitch=reference.first_state(pitch_target),
            fin=reference.first_state(fin_target),
        )

    def step(self, state: GeneratorState, gait: Gait, dt: float) -> GeneratorState:
        """Return the state after a time step during which one gait is held; exact for steps of any size.

        Args:
            state: State before the step.
            gait: Gait held over the step; steering enters through its offset.
            dt: Time step [s].
        """
        decay = math.exp(-self.bandwidth * dt)
        yaw_target, pitch_target, fin_target = gait.targets()

        def advance_wave(wave: WaveState, target: reference.WaveTarget) -> WaveState:
            return reference.advance_wave(wave, target[:4], self.bandwidth, decay, dt)

        time, time_rest = reference.advance_time(state.time, state.time_rest, dt)
        return GeneratorState(
            time=time,
            time_rest=time_rest,
            yaw=advance_wave(state.yaw, yaw_target),
            pitch=advance_wave(state.pitch, pitch_target),
            fin=advance_wave(state.fin, fin_target),
        )

    def joints(self, state: GeneratorState, gait: Gait) -> Float[np.ndarray, "3 n_joints"]:
        """Return the references of every joint, tail first.

        Args:
            state: State of the generator.
            gait: Gait at that instant; the accelerations depend on it, angles and rates do not.

        Returns:
            phi_ref [rad], phi_ref' [rad/s] and phi_ref'' [rad/s^2], one row each.

        Raises:
            ValueError: If the gait has a custom envelope for a different number of joints.
        """
        axes = self.axes or ("yaw",) * (self.n_links - 1)
        yaw_target, pitch_target, _ = gait.targets()
        n_yaw_joints = axes.count("yaw")
        n_pitch_joints = len(axes) - n_yaw_joints
        pitch_envelope = (gait.pitch or STRAIGHT).envelope.joints(n_pitch_joints + 1)
        yaw_envelope = gait.joint_envelope(n_yaw_joints + 1)
        yaw_leads = gait.joint_phases(n_yaw_joints + 1)
        next_reference = {
            "yaw": iter(self._wave(state.yaw, yaw_target, state.time, yaw_envelope, yaw_leads)),
            "pitch": iter(self._wave(state.pitch, pitch_target, state.time, pitch_envelope)),
        }
        references = np.array([next(next_reference[axis]) for axis in axes]).reshape(-1, 3).T
        if gait.recorded is not None:
            is_yaw = [axis == "yaw" for axis in axes]
            references[:, is_yaw] += gait.recorded.at(state.time)
        return references

    def fin(self, state: GeneratorState, gait: Gait) -> Reference:
        """Return the references of a driven fin.

        Args:
            state: State of the generator.
            gait: Gait at that instant.
        """
        _, _, fin_target = gait.targets()
        (fin_reference,) = self._wave(state.fin, fin_target, state.time, envelope=(1.0,))
        return fin_reference

    def _wave(
        self,
        wave: WaveState,
        target: reference.WaveTarget,
        time: float,
        envelope: tuple[float, ...],
        leads: tuple[float, ...] | None = None,
    ) -> list[Reference]:
        """Return the references of the joints moved by one wave."""
        ramp = reference.smooth_start(time, self.ramp)
        motion = reference.wave_motion(wave, target[:4], self.bandwidth, ramp)
        phases = [wave.phase + k * wave.phase_shift + target.phase for k in range(len(envelope))]
        if leads is not None:
            phases = [phase + lead for phase, lead in zip(phases, leads, strict=True)]
        return [
            reference.wave_reference(math.sin(psi), math.cos(psi), g, k, motion)
            for k, (psi, g) in enumerate(zip(phases, envelope, strict=True))
        ]
