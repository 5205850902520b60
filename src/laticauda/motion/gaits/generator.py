"""Reference generator as an object: the same scalar functions that the kernels compile, for a robot or a test."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.motion.gaits import reference
from laticauda.motion.gaits.gait import STRAIGHT, Gait
from laticauda.motion.gaits.reference import WaveState
from laticauda.values import BadArgument, option, quantity, value_class

Reference = tuple[float, float, float]


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
            raise BadArgument(
                "axes", f"must have one entry per joint, {self.n_links - 1}, got {len(self.axes)}"
            )

    def init(self, gait: Gait) -> GeneratorState:
        """Return the initial state: the gait's amplitudes, frequencies and phase shifts; offsets build up from zero.

        Args:
            gait: Gait at the start.
        """
        yaw, pitch, fin = map(reference.first_state, gait.targets())
        return GeneratorState(time=0.0, yaw=yaw, pitch=pitch, fin=fin)

    def step(self, state: GeneratorState, gait: Gait, dt: float) -> GeneratorState:
        """Return the state after a time step during which one gait is held; exact for steps of any size.

        Args:
            state: State before the step.
            gait: Gait held over the step; steering enters through its offset.
            dt: Time step [s].
        """
        decay = math.exp(-self.bandwidth * dt)
        waves = zip((state.yaw, state.pitch, state.fin), gait.targets(), strict=True)
        yaw, pitch, fin = (
            reference.advance_wave(wave, aim[:4], self.bandwidth, decay, dt) for wave, aim in waves
        )
        time, rest = reference.advance_time(state.time, state.time_rest, dt)
        return GeneratorState(time=time, time_rest=rest, yaw=yaw, pitch=pitch, fin=fin)

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
        yaw, pitch, _ = gait.targets()
        n_yaw = axes.count("yaw")
        of_pitch = (gait.pitch or STRAIGHT).envelope.joints(len(axes) - n_yaw + 1)
        found = {
            "yaw": self._wave(state.yaw, yaw, state.time, gait.joint_envelope(n_yaw + 1)),
            "pitch": self._wave(state.pitch, pitch, state.time, of_pitch),
        }
        each = {axis: iter(some) for axis, some in found.items()}
        references = np.array([next(each[axis]) for axis in axes]).reshape(-1, 3).T
        if gait.recorded is not None:
            references[:, [axis == "yaw" for axis in axes]] += gait.recorded.at(state.time)
        return references

    def fin(self, state: GeneratorState, gait: Gait) -> Reference:
        """Return the references of a driven fin.

        Args:
            state: State of the generator.
            gait: Gait at that instant.
        """
        return self._wave(state.fin, gait.targets()[2], state.time, (1.0,))[0]

    def _wave(
        self,
        wave: WaveState,
        target: reference.WaveTarget,
        time: float,
        envelope: tuple[float, ...],
    ) -> list[Reference]:
        """Return the references of the joints moved by one wave."""
        ramp = reference.smooth_start(time, self.ramp)
        motion = reference.wave_motion(wave, target[:4], self.bandwidth, ramp)
        phases = [wave.phase + k * wave.phase_shift + target.phase for k in range(len(envelope))]
        return [
            reference.wave_reference(math.sin(psi), math.cos(psi), g, k, motion)
            for k, (psi, g) in enumerate(zip(phases, envelope, strict=True))
        ]
