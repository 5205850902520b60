"""Drives of the joints: the reference generator, the joint laws, and the work of the joints.

The generator has a state of its own, the waves of body and fin. It advances in equal steps, which
may be shorter than a step of the run: `set_decay` prepares for steps of one length, and
`advance_reference` performs one of them.

`S` is the flat array of `rows`, `b` the first row of a body's record. The joint law is identified by
`law`, one number per joint (LOCKED ... OWN_DRIVEN). `shared` holds the scalar laws that both models
call (`dynamics.shared_laws`). Types of numbers: see `number_types`.

A template (see `templates`): this file is loaded anew for every joint law of one's own and number of
lanes. `bindings` holds that of this loading, under the name that `model.TEMPLATES` lists.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false, reportGeneralTypeIssues=false

from laticauda.compiling import compile_scalar, kernel
from laticauda.compiling.formulas import rows_from
from laticauda.compiling.functions import expm1, sincos
from laticauda.compiling.lanes import any_lane, differs, first_lane, where
from laticauda.compiling.templates import bindings
from laticauda.models.dynamics.semi_implicit import N_STAGES, NODES
from laticauda.models.dynamics.shared_laws import compile_shared_laws
from laticauda.models.planar import number_types
from laticauda.models.planar.rows import *
from laticauda.motion.gaits import reference
from laticauda.motion.joints import laws
from laticauda.motion.joints.kernels import actuator_of
from laticauda.motion.joints.laws import LAST_LINEAR, OWN_DRIVEN, SERVO_DRIVEN

_own_law = bindings(__name__)["joint_law"]
NEARBY = 1e-4
"""Change of a joint's rate over which a law shows its slope [rad/s]."""

shared = compile_shared_laws()
zero_like = compile_scalar(number_types.zero_like)
body_wave = rows_from(PHASE, len(reference.WaveState._fields))
body_target = rows_from(AMPLITUDE, OFFSET + 1 - AMPLITUDE)
fin_wave_before_offset = rows_from(FIN_PHASE, FIN_OFFSET_NOW - FIN_PHASE)
follow_law = actuator_of(_own_law)
drive_of = rows_from(DRIVE, len(laws.Drive._fields))
motor_of = rows_from(MOTOR, STALL_POWER + 1 - MOTOR)
law_numbers = rows_from(JOINT_LAW, 0 if _own_law is None else len(_own_law.fields))


@kernel
def set_decay(S, dt):
    """Prepare the generator for steps of `dt`: set the decay of its filters over one of them."""
    S[DECAY] = 1.0 + expm1(-S[BANDWIDTH] * dt)


@kernel
def advance_reference(S, n, law, tail_link, dt):
    """Advance the generator by one step, and set the reference; dt must be what `set_decay` was given last."""
    w, decay = S[BANDWIDTH], S[DECAY]
    if has_driven_fin(law, tail_link):
        fin = shared.advance_wave(fin_wave(S), fin_target(S), w, decay, dt)
        phase, amplitude, amplitude_rate, frequency, frequency_rate, _, _, offset, offset_rate = fin
        before_offset = phase, amplitude, amplitude_rate, frequency, frequency_rate
        for row, value in enumerate((*before_offset, offset, offset_rate)):
            S[FIN_PHASE + row] = value
    body = shared.advance_wave(body_wave(S), body_target(S), w, decay, dt)
    for row, value in enumerate(body):
        S[PHASE + row] = value
    S[TIME], S[TIME_REST] = shared.advance_time(S[TIME], S[TIME_REST], dt)
    set_reference(S, n, law, tail_link)


@kernel
def has_driven_fin(law, tail_link):
    """Return whether the joint between fin and tail link has an actuator."""
    return tail_link > 0 and law[tail_link] != LOCKED and law[tail_link] != PASSIVE


@kernel
def fin_wave(S):
    """Return the state of a driven fin's wave, which has one joint and no phase shift."""
    zero = zero_like(S[FIN_PHASE])
    return (*fin_wave_before_offset(S), zero, zero, S[FIN_OFFSET_NOW], S[FIN_OFFSET_RATE])


@kernel
def fin_target(S):
    """Return the target of a driven fin's wave."""
    return S[FIN_AMPLITUDE], S[FIN_FREQUENCY], zero_like(S[FIN_FREQUENCY]), S[FIN_OFFSET]


@kernel
def set_reference(S, n, law, tail_link):
    """Set phi_ref and its derivatives for every driven joint from the generator's state."""
    ramp = shared.smooth_start(S[TIME], S[RAMP])
    if has_driven_fin(law, tail_link):
        b = HEADER_ROWS + tail_link * BODY_ROWS
        wave = shared.wave_motion(fin_wave(S), fin_target(S), S[BANDWIDTH], ramp)
        s, c = sincos(S[FIN_PHASE] + S[FIN_LEAD])
        take_reference(
            S, b, law[tail_link], shared.wave_reference(s, c, S[b + ENVELOPE], 0.0, wave)
        )
    wave = shared.wave_motion(body_wave(S), body_target(S), S[BANDWIDTH], ramp)
    S[SIN_PHASE], S[COS_PHASE] = sincos(S[PHASE])
    S[SIN_SHIFT], S[COS_SHIFT] = sincos(S[PHASE_SHIFT_NOW])
    k = 0.0
    for i in range(tail_link + 1, n):
        if law[i] != LOCKED and law[i] != PASSIVE:
            b = HEADER_ROWS + i * BODY_ROWS
            s, c = S[SIN_PHASE], S[COS_PHASE]
            sine, cosine = ahead_of_wave(S, b, s, c)
            take_reference(
                S, b, law[i], shared.wave_reference(sine, cosine, S[b + ENVELOPE], k, wave)
            )
            # Rotate to the next joint; stored in rows, so that the compiler rounds the products one
            # at a time.
            S[SIN_PHASE] = s * S[COS_SHIFT] + c * S[SIN_SHIFT]
            S[COS_PHASE] = c * S[COS_SHIFT] - s * S[SIN_SHIFT]
            k += 1.0
    if first_lane(S[KNOTS].real) > 0.0:
        add_recorded(S, n, law, tail_link)


@kernel
def note_rest(S, law, tail_link):
    """Set RESTS: whether all references stay as `set_reference` has set them, as those that a command holds do."""
    moves = any_lane((S[TIME].real < S[RAMP].real) | (S[KNOTS].real > 0.0))
    moves |= not is_at_rest(body_wave(S), body_target(S))
    if has_driven_fin(law, tail_link):
        moves |= not is_at_rest(fin_wave(S), fin_target(S))
    S[RESTS] = 0.0
    if not moves:
        S[RESTS] = 1.0


@kernel
def is_at_rest(wave, target):
    """Return whether a wave without frequency stands still at its target, in all lanes and with no derivative."""
    frequencies = wave[3], target[1]
    errors = wave[1] - target[0], wave[5] - target[2], wave[7] - target[3]
    rates = wave[2], wave[4], wave[6], wave[8]
    moves = False
    for number in (*frequencies, *errors, *rates):
        moves |= any_lane(differs(number, 0.0))
    return not moves


@kernel
def ahead_of_wave(S, b, s, c):
    """Return sine and cosine of a joint's phase from those of the wave, which it may lead."""
    lead = S[b + LEAD]
    if any_lane(differs(lead, 0.0)):
        sin_lead, cos_lead = sincos(lead)
        return s * cos_lead + c * sin_lead, c * cos_lead - s * sin_lead
    return s, c


@kernel
def add_recorded(S, n, law, tail_link):
    """Add the angles of a recording to the references of the body's joints.

    A knot is the time, then angle and rate of every joint.
    """
    width = 1 + 2 * (n - 1 - tail_link)
    before = recorded_knot(S, width)
    after = before + width
    for i in range(tail_link + 1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        at_angle = 2 * (i - tail_link) - 1
        at_rate = at_angle + 1
        angle, rate, acceleration = shared.between_knots(
            S[TIME],
            S[before],
            S[after],
            S[before + at_angle],
            S[before + at_rate],
            S[after + at_angle],
            S[after + at_rate],
        )
        reference = (
            S[b + REFERENCE] + angle,
            S[b + REFERENCE_1] + rate,
            S[b + REFERENCE_2] + acceleration,
        )
        take_reference(S, b, law[i], reference)


@kernel
def recorded_knot(S, width):
    """Return the first row of the last knot before the current time, the same in all lanes."""
    first, last = int(first_lane(S[KNOTS].real)), int(first_lane(S[N_KNOTS].real)) - 2
    k, time = int(first_lane(S[KNOT].real)), first_lane(S[TIME].real)
    while k < last and time >= first_lane(S[first + (k + 1) * width].real):
        k += 1
    while k > 0 and time < first_lane(S[first + k * width].real):
        k -= 1
    S[KNOT] = float(k)
    return first + k * width


@kernel
def take_reference(S, b, law, reference):
    """Store a joint's reference, which a prescribed joint follows immediately."""
    angle, rate, acceleration = reference
    S[b + REFERENCE] = angle
    S[b + REFERENCE_1] = rate
    S[b + REFERENCE_2] = acceleration
    if law == PRESCRIBED:
        S[b + ANGLE] = angle
        S[b + RATE] = rate


@kernel
def keep_generator(S):
    """Store the generator's state at the begin of a step."""
    S[SAVED_TIME] = S[TIME]
    S[SAVED_TIME + 1] = S[TIME_REST]
    for r in range(WAVE_ROWS):
        S[SAVED_WAVES + r] = S[PHASE + r]


@kernel
def set_stage_decays(S, dt):
    """Prepare the generator for stages of steps of `dt`."""
    for stage in range(N_STAGES):
        S[STAGE_DECAYS + stage] = 1.0 + expm1(-S[BANDWIDTH] * (NODES[stage] * dt))


@kernel
def go_to_stage(S, n, law, tail_link, stage, elapsed):
    """Advance the generator from its stored state to the time of a stage, and set the reference."""
    S[TIME] = S[SAVED_TIME]
    S[TIME_REST] = S[SAVED_TIME + 1]
    if first_lane(S[RESTS].real) > 0.0:
        S[TIME], S[TIME_REST] = shared.advance_time(S[TIME], S[TIME_REST], elapsed)
        return
    for r in range(WAVE_ROWS):
        S[PHASE + r] = S[SAVED_WAVES + r]
    S[DECAY] = S[STAGE_DECAYS + stage]
    advance_reference(S, n, law, tail_link, elapsed)


@kernel
def joint_torques(S, n, law):
    """Set the torque of every free joint in the state in S; accelerations that follow are those of the state."""
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if law[i] >= FIRST_FREE:
            torque, _, _ = actuator(S, b, law[i], S[b + ANGLE], S[b + RATE])
            S[b + TORQUE] = torque
            S[b + TOTAL_TORQUE] = torque - skin(S, b)
            S[b + IMPLICIT] = 0.0


@kernel
def is_curved(law):
    """Return whether the torque of a joint may depend on its state in a way that no tangent shows."""
    return law > LAST_LINEAR


@kernel
def lay_tangent(S, b, law, gamma_dt):
    """Replace the law of a joint by its tangent at the acceleration GUESS, as a torque and an inertia.

    The slopes that a law of one's own states need not be its derivatives (`motion.joints.speed_servo`
    has a reason for steeper ones), so the torque at a second rate nearby tells.
    """
    guess = S[b + GUESS]
    angle, rate = implicit_state(S, b, guess, gamma_dt)
    torque, slope_p, slope_d = actuator(S, b, law, angle, rate)
    torque -= skin_at(S, b, angle, rate)
    inertia = shared.implicit_inertia(
        slope_p + S[b + STIFFNESS], slope_d + S[b + DAMPING], gamma_dt
    )
    if law == OWN_DRIVEN:
        further = NEARBY / gamma_dt
        inertia = (torque - torque_along(S, b, law, guess + further, gamma_dt)) / further
    S[b + GUESS_TORQUE] = torque
    S[b + IMPLICIT] = inertia
    S[b + TOTAL_TORQUE] = torque + inertia * guess


@kernel
def lay_chord(S, b, is_off, torque):
    """Replace, in lanes where `is_off`, the tangent by the chord to the solution, where the law has this `torque`."""
    acceleration = S[b + ACCELERATION]
    distance = where(is_off, acceleration - S[b + GUESS], 1.0 + zero_like(acceleration))
    inertia = (S[b + GUESS_TORQUE] - torque) / distance
    S[b + GUESS] = where(is_off, acceleration, S[b + GUESS])
    S[b + GUESS_TORQUE] = where(is_off, torque, S[b + GUESS_TORQUE])
    S[b + IMPLICIT] = where(is_off, inertia, S[b + IMPLICIT])
    S[b + TOTAL_TORQUE] = where(is_off, torque + inertia * acceleration, S[b + TOTAL_TORQUE])


@kernel
def torque_along(S, b, law, acceleration, gamma_dt):
    """Return the torque of law and skin in the implicit state that belongs to an acceleration."""
    angle, rate = implicit_state(S, b, acceleration, gamma_dt)
    torque, _, _ = actuator(S, b, law, angle, rate)
    return torque - skin_at(S, b, angle, rate)


@kernel
def torque_on_tangent(S, b, acceleration):
    """Return the torque of the tangent or chord for an acceleration."""
    return S[b + TOTAL_TORQUE] - S[b + IMPLICIT] * acceleration


@kernel
def implicit_state(S, b, acceleration, gamma_dt):
    """Return angle and rate of a joint in the implicit state that belongs to an acceleration."""
    change = gamma_dt * acceleration
    return S[b + COAST_ANGLE] + gamma_dt * change, S[b + COAST_RATE] + change


@kernel
def skin(S, b):
    """Return the torque of the skin (or a hinge) against the joint's angle and rate."""
    return skin_at(S, b, S[b + ANGLE], S[b + RATE])


@kernel
def skin_at(S, b, angle, rate):
    """Return the torque of the skin (or a hinge) against an angle and a rate."""
    return S[b + STIFFNESS] * angle + S[b + DAMPING] * rate


@kernel
def actuator(S, b, law, angle, rate):
    """Return the torque of the joint's actuator at an angle and a rate, and its slopes."""
    motion = angle, rate, S[b + REFERENCE], S[b + REFERENCE_1], S[b + REFERENCE_2]
    return follow_law(law, motion, drive_of(S, b), law_numbers(S))


@kernel
def add_work(S, n, law, gamma_dt, duration):
    """Add the work at the powers of a stage for a duration, once its accelerations are known."""
    none = zero_like(S[TIME])
    absolute, net, positive = none, none, none
    electrical = none + S[ACTIVE_POWER]
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if law[i] == PRESCRIBED or law[i] > PASSIVE:
            angle, rate = S[b + ANGLE], S[b + RATE]
            torque = S[b + TOTAL_TORQUE]
            if law[i] != PRESCRIBED:
                acceleration = S[b + ACCELERATION]
                angle, rate = implicit_state(S, b, acceleration, gamma_dt)
                torque = torque_on_tangent(S, b, acceleration)
            torque += skin_at(S, b, angle, rate)
            exchanged, signed, delivered = shared.joint_powers(torque, rate)
            absolute += exchanged
            net += signed
            positive += delivered
            if any_lane(S[b + STALL_POWER].real > 0.0):
                electrical += electrical_power(S, b, law[i], torque, angle, rate)
    for k, power in enumerate((absolute, net, positive, electrical)):
        S[WORK_ABSOLUTE + k] += duration * power


@kernel
def electrical_power(S, b, law, torque, angle, rate):
    """Return the electrical power of a joint's motor, in a servo from its duty, whatever its gear rubs."""
    if law == SERVO_DRIVEN:
        gain, no_load_speed = S[b + SERVO_GAIN], S[b + NO_LOAD_SPEED]
        return shared.servo_power(
            angle, rate, S[b + REFERENCE], gain, no_load_speed, S[b + STALL_POWER]
        )
    return shared.motor_power(torque, rate, *motor_of(S, b))


@kernel
def count_work(S, n, law, dt):
    """Set the torques and powers of the actuators, and add the work since work was counted last, dt ago.

    By the trapezoidal rule: the powers of that time are still in their rows.
    """
    half = 0.5 * dt
    for k, power in enumerate(deliver_powers(S, n, law)):
        S[WORK_ABSOLUTE + k] += half * (S[POWER_ABSOLUTE + k] + power)
        S[POWER_ABSOLUTE + k] = power


@kernel
def set_powers(S, n, law):
    """Set the torques and powers of the actuators."""
    for k, power in enumerate(deliver_powers(S, n, law)):
        S[POWER_ABSOLUTE + k] = power


@kernel
def deliver_powers(S, n, law):
    """Set the torques that the actuators deliver in the state in S, and return their powers.

    The actuator of a joint whose motion is known delivers what `recursion.holding_torques` found,
    and the torque of its skin. A locked joint has neither rate nor skin: it does no work.
    """
    absolute = zero_like(S[TIME])
    net, positive = absolute, absolute
    electrical = absolute + S[ACTIVE_POWER]
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if law[i] < FIRST_FREE:
            S[b + TORQUE] = S[b + TOTAL_TORQUE] + skin(S, b)
        exchanged, signed, delivered = shared.joint_powers(S[b + TORQUE], S[b + RATE])
        if any_lane(S[b + STALL_POWER].real > 0.0):
            electrical += shared.motor_power(S[b + TORQUE], S[b + RATE], *motor_of(S, b))
        absolute += exchanged
        net += signed
        positive += delivered
    return absolute, net, positive, electrical
