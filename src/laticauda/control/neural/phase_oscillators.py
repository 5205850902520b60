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

import math
from collections.abc import Sequence
from functools import cache
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from laticauda.control.neural.many import vectorize_networks
from laticauda.control.neural.network import (
    FASTEST_PULL,
    Drive,
    NeuralGait,
    PerJoint,
    PerNetwork,
    Signals,
)
from laticauda.scenarios import VectorController
from laticauda.values import quantity, value_class


class Oscillators(NamedTuple):
    """State of the oscillators."""

    phase: PerJoint
    """theta, of every joint [rad]."""
    amplitude: PerJoint
    """r [rad]."""
    amplitude_rate: PerJoint
    """r' [rad/s]."""
    offset: float | PerNetwork
    """x, the bend of all joints [rad]."""
    offset_rate: float | PerNetwork
    """x' [rad/s]."""


FASTEST_COUPLING = 0.25 * FASTEST_PULL
"""Largest w: in a chain, differences of phases decay at up to 4 w [1/s]."""
FASTEST_SETTLING = 2.0 * FASTEST_PULL
"""Largest a: amplitudes settle at a / 2 [1/s]."""


@value_class
class PhaseOscillators(NeuralGait[Oscillators]):
    """Phase oscillators, see the module."""

    coupling: float = quantity(
        "1/s", "w, how fast neighbors pull", ge=0.0, le=FASTEST_COUPLING, default=4.0
    )
    amplitude_rate: float = quantity(
        "1/s",
        "a, how fast amplitudes and offset settle",
        gt=0.0,
        le=FASTEST_SETTLING,
        default=10.0,
    )

    @classmethod
    def vectorize(cls, controllers: Sequence[Any]) -> VectorController | None:
        """Return one object that steps the networks of many robots by arrays.

        Args:
            controllers: The networks, one for each robot.
        """
        return vectorize_networks(controllers)

    def begin(self, drive: Drive) -> Oscillators:
        """Return oscillators without amplitude.

        Args:
            drive: What is asked of them.
        """
        at_rest = np.zeros(drive.n_joints)
        return Oscillators(
            phase=self.initial_phases(drive),
            amplitude=at_rest,
            amplitude_rate=at_rest,
            offset=0.0,
            offset_rate=0.0,
        )

    def references(self, neurons: Oscillators, drive: Drive) -> PerJoint:
        """Return the reference of every joint [rad].

        Args:
            neurons: The oscillators.
            drive: Ignored: it is in the amplitudes already.
        """
        phase = np.atleast_2d(neurons.phase)
        waves = np.empty_like(phase)
        _motion().write_waves(
            phase,
            _table_of(neurons.amplitude, phase.shape),
            _column_of(neurons.offset, len(phase)),
            waves,
        )
        return waves.reshape(neurons.phase.shape)

    def watch(self, neurons: Oscillators) -> Signals:
        """Return the phase of every oscillator for the log.

        Args:
            neurons: The oscillators.
        """
        phases = np.moveaxis(neurons.phase, -1, 0)
        return {f"phase_{i}": phase for i, phase in enumerate(phases)}

    def move(self, neurons: Oscillators, drive: Drive, felt: PerJoint, dt: float) -> Oscillators:
        """Return the oscillators a time step later, by the midpoint rule.

        Args:
            neurons: The oscillators.
            drive: What is asked of them.
            felt: Rate by which feedback would pull each phase at most [1/s].
            dt: Time step [s].
        """
        tables = _tables_of(neurons)
        phase = tables.phase
        n_networks, n_joints = phase.shape
        asked = (
            _table_of(drive.frequency, phase.shape),
            _table_of(drive.amplitude, phase.shape),
            _column_of(drive.phase_shift, n_networks),
            _column_of(drive.offset, n_networks),
        )
        moved = Oscillators(*map(np.empty_like, tables))
        _motion().move(
            tuple(tables),
            asked,
            _table_of(felt, phase.shape),
            _table_of(self._couplings(n_joints), (n_networks, n_joints - 1)),
            _column_of(self.amplitude_rate, n_networks),
            dt,
            tuple(moved),
        )
        shape = neurons.phase.shape
        return Oscillators(
            phase=moved.phase.reshape(shape),
            amplitude=moved.amplitude.reshape(shape),
            amplitude_rate=moved.amplitude_rate.reshape(shape),
            offset=np.reshape(moved.offset, (n_networks, 1)),
            offset_rate=np.reshape(moved.offset_rate, (n_networks, 1)),
        )

    def _couplings(self, n_joints: int) -> PerJoint:
        """Return w between every joint and the next one, 0 at cuts [1/s]."""
        if self.members:
            return self._stack("_couplings", n_joints)
        return self.coupling * self.is_coupled(n_joints)


def _tables_of(neurons: Oscillators) -> Oscillators:
    """Return the oscillators as tables and columns, with one row for each network."""
    phase = np.atleast_2d(neurons.phase)
    return Oscillators(
        phase=np.ascontiguousarray(phase),
        amplitude=_table_of(neurons.amplitude, phase.shape),
        amplitude_rate=_table_of(neurons.amplitude_rate, phase.shape),
        offset=_column_of(neurons.offset, len(phase)),
        offset_rate=_column_of(neurons.offset_rate, len(phase)),
    )


def _table_of(numbers: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Return numbers as a table: one for all, a column, a row, or a table."""
    table = np.asarray(numbers)
    if table.size == math.prod(shape):  # as of one network, nearly always
        return np.ascontiguousarray(table).reshape(shape)
    return np.ascontiguousarray(np.broadcast_to(table, shape))


def _column_of(numbers: Any, n_networks: int) -> np.ndarray:
    """Return numbers as a column: one for all, or one for each network."""
    column = np.ravel(numbers)
    if column.size != n_networks:
        column = np.broadcast_to(column, n_networks)
    return np.ascontiguousarray(column)


@cache
def _motion() -> ModuleType:
    """Return the compiled functions of `oscillator_motion`."""
    from laticauda.compiling.templates import specialized  # Numba is slow to import

    return specialized("laticauda.control.neural", {"oscillator_motion": ()}, {})
