"""Joint drives of a robot in MuJoCo: the reference generator, the joint laws, and the work that they do.

`shared` holds the scalar laws that both models call (`dynamics.shared_laws`). Arrays: X state, C
command, J joints, R reference with its two derivatives, U torques, K what a stage knows of free
joints; W holds those of all robots; `rows` defines their layout.
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
from laticauda.models.spatial.states import put_on_reference, select_robot
from laticauda.motion.gaits import reference
from laticauda.motion.joints import laws
from laticauda.motion.joints.kernels import actuator_of
from laticauda.motion.joints.laws import LAST_LINEAR, OWN_DRIVEN
from laticauda.water.mujoco import numbers

NEARBY = 1e-4
"""Change of a joint's rate over which a law shows its slope [rad/s]."""

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
def advance_generator(N, X, C, J, R, dt):
    """Advance one robot's generator, and the time in the data, at which the water is evaluated."""
    advance_reference(X, C, J, R, dt)
    numbers(N[DATA] + N[AT.time], 1)[0] = X[TIME]


@kernel
def put_all_on_reference(W, qpos, qvel, hold, dt):
    """Apply `put_on_reference` to all robots, after advancing their generators by dt."""
    for r in range(len(W[0])):
        N, X, C, J, R, _, _, q, v = select_robot(W, r)
        if dt > 0.0:
            advance_generator(N, X, C, J, R, dt)
        put_on_reference(N, qpos[q:], qvel[v:], J, R, hold[v:])


@kernel
def drive_joint(C, J, i, angle, rate, R):
    """Return the torque of a free joint's actuator and its slopes."""
    motion = angle, rate, R[0, i], R[1, i], R[2, i]
    return follow_law(J[i, LAW], motion, drive_of(J[i]), law_numbers(C))


@kernel
def set_torques(W, qpos, qvel, hold):
    """Set the torque of every free joint in the state; accelerations that follow are those of the state."""
    for r in range(len(W[0])):
        N, _, C, J, R, U, _, q, v = select_robot(W, r)
        for i in range(len(J)):
            if J[i, LAW] == PRESCRIBED:
                continue
            k = v + N[N_BASE_QVEL] + i
            U[i], _, _ = drive_joint(C, J, i, qpos[q + N[N_BASE_QPOS] + i], qvel[k], R)
            hold[k] = 0.0
            hold[N[N_QVEL] + k] = U[i]


@kernel
def is_curved(law):
    """Return whether the torque of a joint may depend on its state in a way that no tangent shows."""
    return law > LAST_LINEAR


@kernel
def lay_tangent(C, J, i, R, K, gamma_dt):
    """Replace the law of a joint by its tangent at the acceleration GUESS, as a torque and an inertia.

    The slopes that a law of one's own states need not be its derivatives, so the torque at a second
    rate nearby tells.
    """
    guess = K[GUESS, i]
    angle, rate = implicit_state(K, i, guess, gamma_dt)
    torque, slope_p, slope_d = drive_joint(C, J, i, angle, rate, R)
    torque -= skin(J, i, angle, rate)
    inertia = shared.implicit_inertia(slope_p + J[i, STIFFNESS], slope_d + J[i, DAMPING], gamma_dt)
    if J[i, LAW] == OWN_DRIVEN:
        further = NEARBY / gamma_dt
        inertia = (torque - torque_along(C, J, i, R, K, guess + further, gamma_dt)) / further
    K[GUESS_TORQUE, i] = torque
    K[IMPLICIT, i] = inertia
    K[TOTAL_TORQUE, i] = torque + inertia * guess


@kernel
def lay_chord(K, i, acceleration, torque):
    """Replace the tangent by the chord to the solution, where the law has this `torque`."""
    K[IMPLICIT, i] = (K[GUESS_TORQUE, i] - torque) / (acceleration - K[GUESS, i])
    K[GUESS, i] = acceleration
    K[GUESS_TORQUE, i] = torque
    K[TOTAL_TORQUE, i] = torque + K[IMPLICIT, i] * acceleration


@kernel
def torque_along(C, J, i, R, K, acceleration, gamma_dt):
    """Return the torque of law and skin in the implicit state that belongs to an acceleration."""
    angle, rate = implicit_state(K, i, acceleration, gamma_dt)
    torque, _, _ = drive_joint(C, J, i, angle, rate, R)
    return torque - skin(J, i, angle, rate)


@kernel
def torque_on_tangent(K, i, acceleration):
    """Return the torque of the tangent or chord for an acceleration."""
    return K[TOTAL_TORQUE, i] - K[IMPLICIT, i] * acceleration


@kernel
def implicit_state(K, i, acceleration, gamma_dt):
    """Return angle and rate of a joint in the implicit state that belongs to an acceleration."""
    change = gamma_dt * acceleration
    return K[COAST_ANGLE, i] + gamma_dt * change, K[COAST_RATE, i] + change


@kernel
def skin(J, i, angle, rate):
    """Return the torque of the skin (or a hinge) against an angle and a rate."""
    return J[i, STIFFNESS] * angle + J[i, DAMPING] * rate


@kernel
def count_work(N, X, C, J, U, P, qvel, dt):
    """Add the work since the last step by the trapezoidal rule; P stores the powers."""
    for k, power in enumerate(powers(C, J, U, qvel[N[N_BASE_QVEL] :])):
        X[WORK_ABSOLUTE + k] += 0.5 * dt * (P[k] + power)
        P[k] = power


@kernel
def powers(C, J, U, rates):
    """Return the absolute, net, positive and electrical power of joints with these torques and rates."""
    absolute = 0.0
    net = 0.0
    positive = 0.0
    electrical = C[ACTIVE_POWER]
    for i in range(len(J)):
        magnitude, signed, delivered = shared.joint_powers(U[i], rates[i])
        absolute += magnitude
        net += signed
        positive += delivered
        if J[i, STALL_POWER] > 0.0:
            electrical += shared.motor_power(U[i], rates[i], *motor_of(J[i]))
    return absolute, net, positive, electrical
