"""Bars of the references of all joints, taken back to the waves, their targets and the numbers of the joints.

Part of `adjoint`, whose letters these are.

A template (see `templates`), loaded anew for every drag law and number of lanes.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false, reportGeneralTypeIssues=false

from laticauda.compiling import kernel
from laticauda.compiling.lanes import first_lane
from laticauda.compiling.pullbacks import compile_pullback
from laticauda.compiling.templates import bindings
from laticauda.models.planar.rows import *

_specialization = bindings(__name__)
drives = _specialization["drives"]
kept_run = _specialization["kept_run"]
shared = drives.shared

_pullbacks = dict(_specialization["pullbacks"])
pull_reference = compile_pullback(_pullbacks["reference"])
pull_knots = compile_pullback(_pullbacks["knots"])
pull_body_motion = compile_pullback(_pullbacks["body_motion"])
pull_fin_motion = compile_pullback(_pullbacks["fin_motion"])
pull_body_wave = compile_pullback(_pullbacks["body_wave"])
pull_fin_wave = compile_pullback(_pullbacks["fin_wave"])


@kernel
def go_back_to_moment(S, G, n, law, tail_link, generator_step, moment):
    """Take the bars of the references back to a moment that was kept, and set the references of that moment."""
    pull_references(S, G, n, law, tail_link)
    kept_run.read_moment(S, law, tail_link, moment)
    pull_generator(S, G, law, tail_link, generator_step)
    drives.set_reference(S, n, law, tail_link)


@kernel
def pull_references(S, G, n, law, tail_link):
    """Take the bars of all references of a moment back to the waves and a recording, and set them to 0."""
    if first_lane(S[KNOTS]) > 0.0:
        pull_recorded(S, G, n, tail_link)
    if drives.has_driven_fin(law, tail_link):
        b = HEADER_ROWS + tail_link * BODY_ROWS
        ramp = shared.smooth_start(S[TIME], S[RAMP])
        wave = shared.wave_motion(drives.fin_wave(S), drives.fin_target(S), S[BANDWIDTH], ramp)
        s, c = drives.sincos(S[FIN_PHASE] + S[FIN_LEAD])
        motion, phase = pull_joint(S, G, b, s, c, 0.0, wave)
        pull_fin_motion(S, G, *motion)
        G[FIN_PHASE] += phase
        G[FIN_LEAD] += phase
    ramp = shared.smooth_start(S[TIME], S[RAMP])
    wave = shared.wave_motion(drives.body_wave(S), drives.body_target(S), S[BANDWIDTH], ramp)
    s, c = drives.sincos(S[PHASE])
    sin_shift, cos_shift = drives.sincos(S[PHASE_SHIFT_NOW])
    zero = drives.zero_like(S[PHASE])
    sums = zero, zero, zero, zero, zero, zero, zero, zero, zero, zero
    k = 0.0
    for i in range(tail_link + 1, n):
        if law[i] == PRESCRIBED:
            b = HEADER_ROWS + i * BODY_ROWS
            sine, cosine = drives.ahead_of_wave(S, b, s, c)
            motion, phase = pull_joint(S, G, b, sine, cosine, k, wave)
            sums = add_motions(sums, motion)
            G[PHASE] += phase
            G[b + LEAD] += phase
            G[PHASE_SHIFT_NOW] += k * phase
            s, c = s * cos_shift + c * sin_shift, c * cos_shift - s * sin_shift
            k += 1.0
    pull_body_motion(S, G, *sums)


@kernel
def pull_recorded(S, G, n, tail_link):
    """Take the bars of all references back to the knots before and after the current time."""
    width = 1 + 2 * (n - 1 - tail_link)
    before = drives.recorded_knot(S, width)
    after = before + width
    for i in range(tail_link + 1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        at_angle = 2 * (i - tail_link) - 1
        bars = pull_knots(
            S,
            G,
            S[TIME],
            S[before],
            S[after],
            S[before + at_angle],
            S[before + at_angle + 1],
            S[after + at_angle],
            S[after + at_angle + 1],
            G[b + ANGLE],
            G[b + RATE],
            G[b + REFERENCE_2],
        )
        G[before] += bars[0]
        G[after] += bars[1]
        G[before + at_angle] += bars[2]
        G[before + at_angle + 1] += bars[3]
        G[after + at_angle] += bars[4]
        G[after + at_angle + 1] += bars[5]


@kernel
def pull_joint(S, G, b, s, c, k, wave):
    """Take the bars of a joint's reference back; return those of its wave's motion, and that of its phase."""
    angle, rate, acceleration = G[b + ANGLE], G[b + RATE], G[b + REFERENCE_2]
    a, a_1, a_2, frequency, frequency_1, shift_1, shift_2, offset, offset_1, offset_2 = wave
    bars = pull_reference(
        S,
        G,
        s,
        c,
        S[b + ENVELOPE],
        a,
        a_1,
        a_2,
        frequency,
        frequency_1,
        shift_1,
        shift_2,
        offset,
        offset_1,
        offset_2,
        k,
        angle,
        rate,
        acceleration,
    )
    sine, cosine, envelope = bars[:3]
    G[b + ENVELOPE] += envelope
    zero = drives.zero_like(angle)
    G[b + ANGLE] = zero
    G[b + RATE] = zero
    G[b + REFERENCE_2] = zero
    return bars[3:], c * sine - s * cosine


@kernel
def add_motions(a, b):
    """Return the sum of the bars of a wave's motion from two joints."""
    return (
        a[0] + b[0],
        a[1] + b[1],
        a[2] + b[2],
        a[3] + b[3],
        a[4] + b[4],
        a[5] + b[5],
        a[6] + b[6],
        a[7] + b[7],
        a[8] + b[8],
        a[9] + b[9],
    )


@kernel
def pull_generator(S, G, law, tail_link, dt):
    """Take the bars of the waves back over one step of the generator, to the state in S."""
    if drives.has_driven_fin(law, tail_link):
        bars = pull_fin_wave(S, G, dt, *kept_run.fin_wave(G))
        for row, bar in enumerate(bars):
            G[FIN_PHASE + row] = bar
    bars = pull_body_wave(S, G, dt, *kept_run.body_wave(G))
    for row, bar in enumerate(bars):
        G[PHASE + row] = bar
