"""One oscillator per joint with a phase and an amplitude, coupled to its neighbors.

    theta_i' = omega + w (sin(theta_{i+1} - theta_i - delta) + sin(theta_{i-1} - theta_i + delta)) + f_i cos(theta_i)
    r_i'' = a (a (R_i - r_i) / 4 - r_i')        x'' likewise, toward the offset
    phi_ref,i = x + r_i sin(theta_i)

f_i is what joint i feels. Without feedback the phases settle at the phase shift delta from joint to
joint, and the network swims the gait of its frequency, amplitudes and phase shift.

References:
    A. J. Ijspeert et al., Science 315, 2007: from swimming to walking with a salamander robot.
    R. Thandiackal et al., Science Robotics 6, 2021: emergence of robust self-organized undulatory
    swimming based on local hydrodynamic force sensing.
"""

from typing import Any, NamedTuple

import numpy as np

from laticauda.control.neural.network import Drive, NeuralGait, PerJoint
from laticauda.values import quantity, value_class


class Oscillators(NamedTuple):
    """State of the oscillators."""

    phase: PerJoint
    """theta, of every joint [rad]."""
    amplitude: PerJoint
    """r [rad]."""
    amplitude_rate: PerJoint
    """r' [rad/s]."""
    offset: float
    """x, the bend of all joints [rad]."""
    offset_rate: float
    """x' [rad/s]."""


@value_class
class PhaseOscillators(NeuralGait[Oscillators]):
    """Phase oscillators, see the module."""

    coupling: float = quantity("1/s", "w, how fast neighbors pull", ge=0.0, default=4.0)
    amplitude_rate: float = quantity(
        "1/s", "a, how fast amplitudes and offset settle", gt=0.0, default=10.0
    )

    def begin(self, drive: Drive) -> Oscillators:
        """Return oscillators without amplitude.

        Args:
            drive: What is asked of them.
        """
        rest = np.zeros(drive.amplitude.size)
        return Oscillators(
            phase=self.initial_phases(drive),
            amplitude=rest,
            amplitude_rate=rest,
            offset=0.0,
            offset_rate=0.0,
        )

    def references(self, neurons: Oscillators, drive: Drive) -> PerJoint:
        """Return the reference of every joint [rad].

        Args:
            neurons: The oscillators.
            drive: Ignored: it is in the amplitudes already.
        """
        return neurons.offset + neurons.amplitude * np.sin(neurons.phase)

    def watch(self, neurons: Oscillators) -> dict[str, float]:
        """Return the phase of every oscillator for the log.

        Args:
            neurons: The oscillators.
        """
        return {f"phase_{i}": phase for i, phase in enumerate(neurons.phase.tolist())}

    def rates(self, neurons: Oscillators, drive: Drive, felt: PerJoint) -> Oscillators:
        """Return the time derivatives of all numbers of the neurons.

        Args:
            neurons: The neurons.
            drive: What is asked of them.
            felt: Rate by which feedback would pull each phase at most [1/s].
        """
        phase = neurons.phase
        pull = self.is_coupled(phase.size) * self.coupling
        pull = pull * np.sin(np.diff(phase) - drive.phase_shift)
        phase_rate = drive.frequency + felt * np.cos(phase)
        phase_rate[:-1] += pull
        phase_rate[1:] -= pull
        return Oscillators(
            phase=phase_rate,
            amplitude=neurons.amplitude_rate,
            amplitude_rate=self._settle(
                drive.amplitude - neurons.amplitude, neurons.amplitude_rate
            ),
            offset=neurons.offset_rate,
            offset_rate=self._settle(drive.offset - neurons.offset, neurons.offset_rate),
        )

    def _settle(self, distance: Any, rate: Any) -> Any:
        """Return the second derivative that brings a number to its aim without overshoot."""
        return self.amplitude_rate * (0.25 * self.amplitude_rate * distance - rate)
