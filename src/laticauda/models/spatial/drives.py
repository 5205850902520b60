"""Joint drives of a robot in MuJoCo: the reference generator, the joint laws, and the work that they do.

`shared` holds the scalar laws that both models call (`dynamics.shared_laws`). Arrays: X state, C
command, J joints, R reference with its two derivatives, U torques; `rows` defines their layout.
This is a template (see `templates`).
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false

import numpy as np

from laticauda.compiling import kernel
from laticauda.compiling.formulas import rows_from
from laticauda.compiling.templates import bindings
from laticauda.models.dynamics.shared_laws import compile_shared_laws
from laticauda.models.spatial.rows import *
from laticauda.motion.gaits import reference
from laticauda.motion.joints import laws
from laticauda.motion.joints.kernels import actuator_of

shared = compile_shared_laws()
wave_of = rows_from(PHASE, len(reference.WaveState._fields))
target_of = rows_from(AMPLITUDE, AHEAD - AMPLITUDE)
_own_law = bindings(__name__)["joint_law"]
follow_law = actuator_of(_own_law)
drive_of = rows_from(DRIVE, len(laws.Drive._fields))
motor_of = rows_from(MOTOR, STALL_POWER + 1 - MOTOR)
law_numbers = rows_from(JOINT_LAW, 0 if _own_law is None else len(_own_law.fields))


@kernel
def advance_reference(X, C, J, R, dt):
    """Advance the generator by dt and set the reference."""
    w = C[BANDWIDTH]
    decay = np.exp(-w * dt)
    advance_rows(X[:PITCH], C[:PITCH_COMMAND], w, decay, dt)
    advance_rows(X[SECOND:], C[PITCH_COMMAND:], w, decay, dt)
    advance_rows(X[THIRD:], C[FIN_COMMAND:], w, decay, dt)
    X[TIME], X[TIME_REST] = shared.advance_time(X[TIME], X[TIME_REST], dt)
    set_reference(X, C, J, R)


@kernel
def advance_rows(X, C, w, decay, dt):
    """Advance one wave, whose rows begin those of X and whose target begins C."""
    wave = shared.advance_wave(wave_of(X), target_of(C), w, decay, dt)
    for row, value in enumerate(wave):
        X[PHASE + row] = value


@kernel
def set_reference(X, C, J, R):
    """Set phi_ref of every driven joint and its derivatives, three rows of R; each wave moves its own joints."""
    ramp = shared.smooth_start(X[TIME], C[RAMP])
    set_wave(X[:PITCH], C[:PITCH_COMMAND], C[BANDWIDTH], ramp, YAW_WAVE, J, R)
    set_wave(X[SECOND:], C[PITCH_COMMAND:], C[BANDWIDTH], ramp, PITCH_WAVE, J, R)
    set_wave(X[THIRD:], C[FIN_COMMAND:], C[BANDWIDTH], ramp, FIN_WAVE, J, R)
    if C[N_KNOTS] > 0.0:
        add_recorded(X[TIME], C, C[COMMAND_ROWS:], J, R)


@kernel
def add_recorded(time, C, T, J, R):
    """Add the angles of a recording T to the references of the yaw joints."""
    n = int(C[N_KNOTS])
    width = T.size // n
    k = int(C[KNOT])
    while k < n - 2 and time >= T[(k + 1) * width]:
        k += 1
    while k > 0 and time < T[k * width]:
        k -= 1
    C[KNOT] = k
    a = T[k * width :]
    b = T[(k + 1) * width :]
    j = 1
    for i in range(J.shape[0]):
        if J[i, WAVE] == YAW_WAVE:
            recorded = shared.between_knots(time, a[0], b[0], a[j], a[j + 1], b[j], b[j + 1])
            for row in range(3):
                R[row, i] += recorded[row]
            j += 2


@kernel
def set_wave(X, C, w, ramp, wave, J, R):
    """Set the reference of the joints that one wave moves."""
    motion = shared.wave_motion(wave_of(X), target_of(C), w, ramp)
    k = 0.0
    for i in range(J.shape[0]):
        if J[i, WAVE] == wave:
            psi = X[PHASE] + k * X[PHASE_SHIFT_NOW] + C[AHEAD] + J[i, LEAD]
            R[0, i], R[1, i], R[2, i] = shared.wave_reference(
                np.sin(psi), np.cos(psi), J[i, ENVELOPE], k, motion
            )
            k += 1.0


@kernel
def drive_joint(C, J, i, angle, rate, R):
    """Return the torque of a free joint's actuator and its slopes."""
    motion = angle, rate, R[0, i], R[1, i], R[2, i]
    return follow_law(J[i, LAW], motion, drive_of(J[i]), law_numbers(C))


@kernel
def count_work(N, X, C, J, U, P, qvel, dt):
    """Add the work since the last step by the trapezoidal rule; P stores the powers."""
    nv = N[N_BASE_QVEL]
    absolute = 0.0
    net = 0.0
    positive = 0.0
    electrical = C[ACTIVE_POWER]
    for i in range(J.shape[0]):
        rate = qvel[nv + i]
        magnitude, signed, delivered = shared.joint_powers(U[i], rate)
        absolute += magnitude
        net += signed
        positive += delivered
        if J[i, STALL_POWER] > 0.0:
            electrical += shared.motor_power(U[i], rate, *motor_of(J[i]))
    for k, power in enumerate((absolute, net, positive, electrical)):
        X[WORK_ABSOLUTE + k] += 0.5 * dt * (P[k] + power)
        P[k] = power
