"""The motion of phase oscillators in compiled code, which moves all networks at once (a template).

A table has one row per network and one column per joint; a column has one number per network. Steps in
time are those of the midpoint rule.
"""

# pyright: basic
# pyright: reportCallIssue=false

import numpy as np

from laticauda.compiling import entry, kernel
from laticauda.compiling.functions import sincos


@entry
def move_phases(phase, natural_rate, felt, coupling, phase_shift, dt, moved):
    """Compute the phases a time step later.

    Args:
        phase: Table of theta [rad].
        natural_rate: Table of omega [rad/s].
        felt: Table of f, what every joint feels [1/s].
        coupling: Table of w between every joint and the next one, 0 at cuts [1/s].
        phase_shift: Column of delta [rad].
        dt: Time step [s].
        moved: Table of the phases then, which is written [rad].
    """
    n_joints = phase.shape[1]
    pull = np.zeros(n_joints + 1)  # also that before the first joint and after the last: none
    rate = np.empty(n_joints)
    middle = np.empty(n_joints)
    for k in range(len(phase)):
        of_network = natural_rate[k], felt[k], coupling[k], phase_shift[k]
        write_phase_rates(phase[k], of_network, pull, rate)
        for i in range(n_joints):
            middle[i] = phase[k, i] + 0.5 * dt * rate[i]
        write_phase_rates(middle, of_network, pull, rate)
        for i in range(n_joints):
            moved[k, i] = phase[k, i] + dt * rate[i]


@kernel
def write_phase_rates(phase, of_network, pull, rate):
    """Write theta' of every joint of one network."""
    natural_rate, felt, coupling, phase_shift = of_network
    for i in range(phase.size - 1):
        pull[i + 1] = coupling[i] * sincos(phase[i + 1] - phase[i] - phase_shift)[0]
    for i in range(phase.size):
        rate[i] = natural_rate[i] + felt[i] * sincos(phase[i])[1] + pull[i + 1] - pull[i]


@entry
def settle(number, rate, aim, settling, dt, moved, moved_rate):
    """Compute numbers that settle without overshoot a time step later, such as amplitudes and offsets.

    Args:
        number: Table of the numbers.
        rate: Table of their rates.
        aim: Table of where they settle.
        settling: Column of a, how fast [1/s].
        dt: Time step [s].
        moved: Table of the numbers then, which is written.
        moved_rate: Table of the rates then, which is written.
    """
    half = 0.5 * dt
    for k in range(len(number)):
        a = settling[k]
        for i in range(number.shape[1]):
            acceleration = a * (0.25 * a * (aim[k, i] - number[k, i]) - rate[k, i])
            middle = number[k, i] + half * rate[k, i]
            middle_rate = rate[k, i] + half * acceleration
            acceleration = a * (0.25 * a * (aim[k, i] - middle) - middle_rate)
            moved[k, i] = number[k, i] + dt * middle_rate
            moved_rate[k, i] = rate[k, i] + dt * acceleration


@entry
def write_waves(phase, amplitude, offset, wave):
    """Write the reference of every joint.

    Args:
        phase: Table of theta [rad].
        amplitude: Table of r [rad].
        offset: Column of x [rad].
        wave: Table of x + r sin(theta), which is written [rad].
    """
    for k in range(len(phase)):
        for i in range(phase.shape[1]):
            wave[k, i] = offset[k] + amplitude[k, i] * sincos(phase[k, i])[0]
