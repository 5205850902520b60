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
def move(oscillators, asked, felt, coupling, settling, dt, moved):
    """Compute the oscillators a time step later.

    Args:
        oscillators: Tables of theta, r and r', columns of x and x' [rad, rad, rad/s, rad, rad/s].
        asked: Tables of omega and R, columns of delta and of where x settles [rad/s, rad, rad, rad].
        felt: Table of f, what every joint feels [1/s].
        coupling: Table of w between every joint and the next one, 0 at cuts [1/s].
        settling: Column of a, how fast amplitudes and offsets settle [1/s].
        dt: Time step [s].
        moved: Tables and columns like `oscillators`, which are written.
    """
    phase, amplitude, amplitude_rate, offset, offset_rate = oscillators
    natural_rate, aim, phase_shift, offset_aim = asked
    moved_phase, moved_amplitude, moved_amplitude_rate, moved_offset, moved_offset_rate = moved
    move_phases(phase, (natural_rate, felt, coupling, phase_shift), dt, moved_phase)
    pace = spread_over_joints(settling, phase)
    settle(amplitude, amplitude_rate, aim, pace, dt, moved_amplitude, moved_amplitude_rate)
    settle(offset, offset_rate, offset_aim, settling, dt, moved_offset, moved_offset_rate)


@kernel
def move_phases(phase, of_networks, dt, moved):
    """Write the table of the phases a time step later."""
    rate, middle = np.empty_like(phase), np.empty_like(phase)
    scratch = np.empty_like(phase), np.empty_like(phase)
    write_phase_rates(phase, of_networks, scratch, rate)
    step_along(phase, rate, 0.5 * dt, middle)
    write_phase_rates(middle, of_networks, scratch, rate)
    step_along(phase, rate, dt, moved)


@kernel
def write_phase_rates(phase, of_networks, scratch, rate):
    """Write the table of theta'; the sines of differences follow from those of the phases."""
    natural_rate, felt, coupling, phase_shift = of_networks
    sine, cosine = scratch
    write_sines_and_cosines(phase, sine, cosine)
    n_joints = phase.shape[1]
    pull = np.zeros(n_joints + 1)  # also that before the first joint and after the last: none
    for k in range(len(phase)):
        sine_shift, cosine_shift = sincos(phase_shift[k])
        for i in range(n_joints - 1):
            sine_ahead = sine[k, i + 1] * cosine[k, i] - cosine[k, i + 1] * sine[k, i]
            cosine_ahead = cosine[k, i + 1] * cosine[k, i] + sine[k, i + 1] * sine[k, i]
            ahead = sine_ahead * cosine_shift - cosine_ahead * sine_shift
            pull[i + 1] = coupling[k, i] * ahead
        for i in range(n_joints):
            feeling = felt[k, i] * cosine[k, i]
            rate[k, i] = natural_rate[k, i] + feeling + pull[i + 1] - pull[i]


@kernel
def write_sines_and_cosines(phase, sine, cosine):
    """Write tables of the sines and cosines, by a single loop over all numbers, which fills vector registers."""
    flat_phase, flat_sine, flat_cosine = phase.ravel(), sine.ravel(), cosine.ravel()
    for i in range(phase.size):
        flat_sine[i], flat_cosine[i] = sincos(flat_phase[i])


@kernel
def step_along(number, rate, duration, moved):
    """Write the table of numbers that have moved at constant rates for a duration."""
    flat_number, flat_rate, flat_moved = number.ravel(), rate.ravel(), moved.ravel()
    for i in range(number.size):
        flat_moved[i] = flat_number[i] + duration * flat_rate[i]


@kernel
def spread_over_joints(column, like):
    """Return a table with the numbers of a column in all joints."""
    table = np.empty_like(like)
    for k in range(len(column)):
        for i in range(like.shape[1]):
            table[k, i] = column[k]
    return table


@kernel
def settle(number, rate, aim, settling, dt, moved, moved_rate):
    """Write the tables of numbers that settle without overshoot a time step later, and of their rates."""
    x, v, target, pace = number.ravel(), rate.ravel(), aim.ravel(), settling.ravel()
    new_x, new_v = moved.ravel(), moved_rate.ravel()
    for i in range(number.size):
        a = pace[i]
        acceleration = a * (0.25 * a * (target[i] - x[i]) - v[i])
        middle = x[i] + 0.5 * dt * v[i]
        middle_rate = v[i] + 0.5 * dt * acceleration
        acceleration = a * (0.25 * a * (target[i] - middle) - middle_rate)
        new_x[i] = x[i] + dt * middle_rate
        new_v[i] = v[i] + dt * acceleration


@entry
def write_waves(phase, amplitude, offset, wave):
    """Write the reference of every joint.

    Args:
        phase: Table of theta [rad].
        amplitude: Table of r [rad].
        offset: Column of x [rad].
        wave: Table of x + r sin(theta), which is written [rad].
    """
    cosine = np.empty_like(phase)
    write_sines_and_cosines(phase, wave, cosine)
    for k in range(len(phase)):
        for i in range(phase.shape[1]):
            wave[k, i] = offset[k] + amplitude[k, i] * wave[k, i]
