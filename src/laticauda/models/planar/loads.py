"""Loads of the water (or the ground) and the effectors on the bodies of the chain.

Forces are in link axes, moments about the link's tail end. `S` is the flat array of `rows`, `b` the
first row of a body's record, `e` that of an element, a strip or a pectoral fin. Which types its
numbers may have, and what follows from this for every line here, says `number_types`.

The classic form of the added mass differs from the others in three places, which belong together:
OWN_VELOCITY is 0 in `added_mass_velocity_terms` and `element_inertia`; `layout._write_bodies` adds
sum mu_t x to CENTRIPETAL, which the recursion takes as part of the body; and `added_mass_force`, which
shows the force of the added mass alone, adds that part again. KIRCHHOFF (`kirchhoff` below) is 1 for
the form of this name, and 0 for both others.

A template (see `templates`): this file is loaded anew for every drag law, kind of flow and number of
lanes. `bindings` holds those of this loading, under the names that `model.TEMPLATES` lists.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false, reportGeneralTypeIssues=false

from laticauda.compiling import compile_scalar, kernel
from laticauda.compiling.formulas import in_rows, rows_from, summed
from laticauda.compiling.functions import sincos
from laticauda.compiling.lanes import any_lane, differs, first_lane, magnitude, where
from laticauda.compiling.templates import bindings
from laticauda.models.planar import number_types
from laticauda.models.planar.rows import *
from laticauda.water.fluid import MOTION, Element, edges, flow, inertia
from laticauda.water.fluid.laws import plate

_specialization = bindings(__name__)
_drag_law = _specialization["drag_law"]
_flow_parts = _specialization["flow_parts"]

drag_law = in_rows(_drag_law, Element, MOTION)
drag_law_numbers = rows_from(LAW, len(_drag_law.fields))
plate_law = compile_scalar(plate)
finite_span = compile_scalar(edges.finite_span)
edge_numbers = rows_from(EDGE, len(edges.Plate._fields))
plate_numbers = rows_from(PLATE_LAW, PLATE_WATER - PLATE_LAW)
water_numbers = rows_from(0, WATER_ROWS)
HAS_FLOW = bool(_flow_parts)
flow_motion = summed(_flow_parts, len(flow.Motion._fields))
local_flow = compile_scalar(flow.local_flow)
frame_acceleration = compile_scalar(inertia.carried)
momentum_load = compile_scalar(inertia.load)
zero_like = compile_scalar(number_types.zero_like)


@kernel
def strip_row(n, strip):
    """Return the first row of a strip; the strips of all bodies are counted on."""
    return HEADER_ROWS + n * BODY_ROWS + strip * STRIP_ROWS


@kernel
def plate_row(n, n_strips, fin):
    """Return the first row of a pectoral fin; those of all bodies are counted on, as are the `n_strips` strips."""
    return strip_row(n, n_strips) + fin * PLATE_ROWS


@kernel
def water_around(S, n, first_strip, first_plate, tail_link, has_extras):
    """Set the water's motion at every element if the water has a flow; otherwise the velocities already include it."""
    if HAS_FLOW:
        locate_tail_ends(S, n)
        for i in range(n):
            b = HEADER_ROWS + i * BODY_ROWS
            strips = first_strip[i + 1] - first_strip[i]
            plates = first_plate[i + 1] - first_plate[i]
            # The body's own element, its strips and plates; then the tether, if this is the tail
            # link, and the trailing edge, if this is the last body: the same one without a fin.
            n_points = 1 + strips + plates
            if has_extras and i == tail_link:
                n_points += 1
            if has_extras and i == 0:
                n_points += 1
            zero = zero_like(S[b + CENTER])
            # One loop over all of them, because the whole flow is compiled into its call.
            for k in range(n_points):
                x, y = S[b + CENTER], zero
                water = b + WATER_T
                if 0 < k <= strips:
                    e = strip_row(n, first_strip[i] + k - 1)
                    x = S[e + POSITION_OF]
                    water = e + WATER_OF
                elif strips < k <= strips + plates:
                    e = plate_row(n, first_strip[n], first_plate[i] + k - 1 - strips)
                    x, y = S[e + PLATE_X], S[e + PLATE_Y]
                    water = e + PLATE_WATER
                elif k == strips + plates + 1 and i == tail_link:
                    x = zero
                    water = TETHER_WATER
                elif k > strips + plates:
                    x = S[WAKE_POSITION]
                    water = WAKE_WATER
                put_water(S, b, x, y, water)


@kernel
def locate_tail_ends(S, n):
    """Set the world position of every body's tail end from that of the center of mass."""
    px, py, mean_x, mean_y = 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        b = HEADER_ROWS + i * BODY_ROWS
        S[b + PX] = px
        S[b + PY] = py
        c, s = S[b + COS], S[b + SIN]
        mean_x += S[b + MASS_SHARE] * px + S[b + FIRST_MOMENT_SHARE] * c
        mean_y += S[b + MASS_SHARE] * py + S[b + FIRST_MOMENT_SHARE] * s
        px += S[b + LENGTH] * c
        py += S[b + LENGTH] * s
    for i in range(n):
        b = HEADER_ROWS + i * BODY_ROWS
        S[b + PX] += S[X] - mean_x
        S[b + PY] += S[Y] - mean_y


@kernel
def put_water(S, b, x, y, water):
    """Write the water's motion at a point of body b, given in link axes, to the rows from `water` on."""
    c, s = S[b + COS], S[b + SIN]
    first = int(first_lane(S[FLOW].real))  # first row of the flow, the same in all lanes
    place_x, place_y = S[b + PX] + c * x - s * y, S[b + PY] + s * x + c * y
    u, v, _, a_x, a_y, _, _, _, spin, _ = local_flow(
        flow_motion(S, first, place_x, place_y, S[HEIGHT], S[TIME])
    )
    S[water + CURRENT_T] = c * u + s * v
    S[water + CURRENT_N] = c * v - s * u
    S[water + CURRENT_T_RATE] = c * a_x + s * a_y
    S[water + CURRENT_N_RATE] = c * a_y - s * a_x
    S[water + CURRENT_SPIN] = spin


@kernel
def through_water(S, b, x, water):
    """Return velocity and angular velocity of a point on the axis of body b, relative to the water there.

    The rows from `water` on hold the motion of the water there, if it has a flow.
    """
    rate = S[b + LINK_RATE]
    if HAS_FLOW:
        v_t = S[b + V_T] - S[water + CURRENT_T]
        v_n = S[b + V_N] + x * rate - S[water + CURRENT_N]
        return v_t, v_n, rate - S[water + CURRENT_SPIN]
    return S[b + V_T], S[b + V_N] + x * rate, rate


@kernel
def element_drag(S, b, e):
    """Return the drag of one element rigidly attached to body b, link axes, and its moment about the tail end of b.

    `e` is the first row of the element: that of a strip, or CENTER of body b.
    """
    x = S[e + POSITION_OF]
    return drag_at(S, e, x, through_water(S, b, x, e + WATER_OF))


@kernel
def drag_at(S, e, x, velocity):
    """Return the drag of one element, and its moment about the tail end of its body, from which it is x away.

    `velocity` is what `through_water` returns.
    """
    v_t, v_n, rate = velocity
    c_t, c_n = S[e + C_T_OF], S[e + C_N_OF]
    lambda_2, lambda_3 = S[e + LAMBDA_2_OF], S[e + LAMBDA_3_OF]
    f_t, f_n, tau = drag_law(
        v_t, v_n, magnitude(v_n), rate, c_t, c_n, lambda_2, lambda_3, *drag_law_numbers(S)
    )
    return f_t, f_n, tau + x * f_n


@kernel
def added_mass_velocity_terms(S, b):
    """Return the velocity-dependent part of the added-mass force (link axes) and its moment about the tail end.

    It covers the body with its strips or, if the water has a flow, only the body's own element.
    """
    if HAS_FLOW:
        return element_inertia(S, b, b + CENTER)
    if is_known_still(S):
        return still_velocity_terms(S, b, S[b + V_T], S[b + V_N], S[b + LINK_RATE])
    c, s = S[b + COS], S[b + SIN]
    V_t = c * S[CURRENT_X] + s * S[CURRENT_Y]
    V_n = c * S[CURRENT_Y] - s * S[CURRENT_X]
    return uniform_velocity_terms(S, b, V_t, V_n, S[b + V_T], S[b + V_N], S[b + LINK_RATE])


@kernel
def uniform_velocity_terms(S, b, V_t, V_n, v_t, v_n, rate):
    """Return `added_mass_velocity_terms` of a body with its strips in a uniform current V, link axes.

    `v_t` and `v_n` are the velocity of its tail end relative to the current.
    """
    mu_t, mu_n = S[b + MU_T], S[b + MU_N]
    moment_t, moment_n = S[b + MOMENT_T], S[b + MOMENT_N]
    # The classic form includes the current only: its velocity is -V where the others have v - V.
    own, kirchhoff = S[OWN_VELOCITY], S[KIRCHHOFF]
    seen_t = own * (v_t + V_t) - V_t
    seen_n = own * (v_n + V_n) - V_n
    momentum_n = mu_n * v_n + moment_n * rate
    f_t = rate * (kirchhoff * momentum_n - mu_t * seen_n)
    f_n = rate * (mu_n * seen_t - kirchhoff * mu_t * v_t)
    munk = -kirchhoff * v_t * (momentum_n - mu_t * v_n - moment_t * rate)
    return f_t, f_n, munk + rate * (moment_n * seen_t - kirchhoff * moment_t * v_t)


@kernel
def still_velocity_terms(S, b, v_t, v_n, rate):
    """Return what is left of `uniform_velocity_terms` in still water and the relative form, to the last digit.

    The 0.0 stands for the Munk moment: without it the compiler would round the moment elsewhere.
    """
    f_t = rate * (-S[b + MU_T] * v_n)
    f_n = rate * (S[b + MU_N] * v_t)
    return f_t, f_n, 0.0 + rate * (S[b + MOMENT_N] * v_t)


@kernel
def is_still(S):
    """Return whether the water is still and the form the relative one, in all lanes and with no derivative."""
    is_moving = False
    for row, value in STILL_WATER:
        is_moving |= any_lane(differs(S[row], value))
    return not is_moving


@kernel
def is_known_still(S):
    """Return whether a run has found that the water is still in all lanes."""
    return first_lane(S[IS_STILL].real) > 0.0


@kernel
def note_still_water(S):
    """Set IS_STILL, which spares terms that are 0 in still water."""
    S[IS_STILL] = 0.0
    if is_still(S):
        S[IS_STILL] = 1.0


@kernel
def element_inertia(S, b, e):
    """Return the inertial load of moving water on one element, without terms of tail-end or angular acceleration.

    The laws are those of `fluid.inertia`, plus the force that accelerates the displaced water
    itself.
    """
    x, rate = S[e + POSITION_OF], S[b + LINK_RATE]
    own, kirchhoff = S[OWN_VELOCITY], S[KIRCHHOFF]
    u_t, u_n, turning = through_water(S, b, x, e + WATER_OF)
    mu_t, mu_n, displaced = S[e + MU_T_OF], S[e + MU_N_OF], S[e + DISPLACED_OF]
    V_t, V_n, flow_t, flow_n, spin = water_numbers(S, e + WATER_OF)
    # Seen from the tail end, whose axes rotate; the x rate^2 part of the classic form is in
    # CENTRIPETAL.
    rate_t = rate * (own * S[b + V_N] - V_n) - frame_acceleration(flow_t, 0.0, spin, u_n, 0.0)
    rate_n = -rate * (own * S[b + V_T] - V_t) - frame_acceleration(flow_n, spin, 0.0, 0.0, u_t)
    f_t = momentum_load(kirchhoff, mu_t, rate_t, -turning * mu_n * u_n) + displaced * flow_t
    f_n = momentum_load(kirchhoff, mu_n, rate_n, turning * mu_t * u_t) + displaced * flow_n
    munk = momentum_load(kirchhoff, 0.0, 0.0, (mu_n - mu_t) * u_t * u_n)
    return f_t, f_n, munk + x * f_n


@kernel
def extra_loads(S, n, first_strip, first_plate, tail_link):
    """Set the loads that only some bodies have: thrusters, fin strips, pectoral fins, tether and trailing edge."""
    for i in range(n):
        b = HEADER_ROWS + i * BODY_ROWS
        S[b + EXTRA_T] = S[b + THRUST_T]
        S[b + EXTRA_N] = S[b + THRUST_N]
        S[b + EXTRA_MOMENT] = S[b + THRUST_MOMENT]
        for strip in range(first_strip[i], first_strip[i + 1]):
            e = strip_row(n, strip)
            add_extra(S, b, element_drag(S, b, e))
            add_strip_inertia(S, b, e)
        for fin in range(first_plate[i], first_plate[i + 1]):
            add_plate_load(S, b, plate_row(n, first_strip[n], fin))
    add_tether_force(S, HEADER_ROWS + tail_link * BODY_ROWS)
    if has_finite_span(S):
        add_finite_span_load(S)
    else:
        add_trailing_edge_load(S)


@kernel
def add_strip_inertia(S, b, e):
    """Add the inertial load of moving water on one strip; without a flow the body's own load includes it."""
    if HAS_FLOW:
        add_extra(S, b, element_inertia(S, b, e))


@kernel
def add_extra(S, b, force_and_moment):
    """Add a force and a moment to the extra loads of body b."""
    f_t, f_n, moment = force_and_moment
    S[b + EXTRA_T] += f_t
    S[b + EXTRA_N] += f_n
    S[b + EXTRA_MOMENT] += moment


@kernel
def add_plate_load(S, b, e):
    """Add lift and drag of one pectoral fin mounted on body b."""
    x, y = S[e + PLATE_X], S[e + PLATE_Y]
    v_t, v_n, _ = through_water(S, b, x, e + PLATE_WATER)
    v_t -= y * S[b + LINK_RATE]
    s, c = sincos(S[e + PLATE_ANGLE])
    f_chord, f_normal = plate_law(c * v_t + s * v_n, c * v_n - s * v_t, *plate_numbers(S, e))
    f_t = c * f_chord - s * f_normal
    f_n = s * f_chord + c * f_normal
    add_extra(S, b, (f_t, f_n, x * f_n - y * f_t))


@kernel
def add_tether_force(S, b):
    """Add the tether force F = -k |v| v + constant at the tail end of the tail link."""
    c, s = S[b + COS], S[b + SIN]
    v_t, v_n, _ = through_water(S, b, 0.0, TETHER_WATER)
    drag = S[TETHER_DRAG] * (v_t * v_t + v_n * v_n) ** 0.5
    S[b + EXTRA_T] += c * S[TETHER_FORCE_X] + s * S[TETHER_FORCE_Y] - drag * v_t
    S[b + EXTRA_N] += c * S[TETHER_FORCE_Y] - s * S[TETHER_FORCE_X] - drag * v_n


@kernel
def add_trailing_edge_load(S):
    """Add the momentum flux into the wake (Lighthill 1971): m'/2 w^2 t - m' u w n while u > 0."""
    b = HEADER_ROWS
    x = S[WAKE_POSITION]
    u, w, _ = through_water(S, b, x, WAKE_WATER)
    shed = where(u.real > 0.0, S[WAKE_MASS], zero_like(u))
    f_n = -shed * u * w
    add_extra(S, b, (0.5 * shed * w * w, f_n, x * f_n))


@kernel
def has_finite_span(S):
    """Return whether a plate of finite span is at the tail, with a state of its own; the same in all lanes."""
    return first_lane(S[EDGE_LAG].real) > 0.0


@kernel
def add_finite_span_load(S):
    """Add the load at the edge of a plate of finite span, and set the rate of the edge's state."""
    b = HEADER_ROWS
    x = S[WAKE_POSITION]
    u, w, turning = through_water(S, b, x, WAKE_WATER)
    f_t, f_n, moment, memory_rate = finite_span(u, w, turning, S[EDGE_MEMORY], *edge_numbers(S))
    add_extra(S, b, (f_t, f_n, moment + x * f_n))
    S[EDGE_MEMORY_RATE] = memory_rate


@kernel
def body_forces(S, n, first_strip, force):
    """Store drag, added-mass and effector force on every body, world axes, once the accelerations are known.

    `force` holds two rows per body, x and y: first the drag on all bodies, then the added-mass
    force (including the force of accelerating water on the displaced volume), then the effector
    force. The rows EXTRA hold effectors and strips together; the part of the strips is computed
    again, in these rows, and goes from the effectors to drag and added mass.
    """
    for i in range(n):
        b = HEADER_ROWS + i * BODY_ROWS
        drag, added_mass, effector = 2 * i, 2 * (n + i), 2 * (2 * n + i)
        effector_t, effector_n = S[b + EXTRA_T], S[b + EXTRA_N]
        # Drag: of the strips, which add up in the emptied rows, and of the body's own element.
        S[b + EXTRA_T] = 0.0
        S[b + EXTRA_N] = 0.0
        for strip in range(first_strip[i], first_strip[i + 1]):
            add_extra(S, b, element_drag(S, b, strip_row(n, strip)))
        f_t, f_n, _ = element_drag(S, b, b + CENTER)
        put_force(S, b, force, drag, f_t + S[b + EXTRA_T], f_n + S[b + EXTRA_N])
        effector_t -= S[b + EXTRA_T]
        effector_n -= S[b + EXTRA_N]
        # Inertia of the strips in moving water, in the same rows.
        S[b + EXTRA_T] = 0.0
        S[b + EXTRA_N] = 0.0
        for strip in range(first_strip[i], first_strip[i + 1]):
            add_strip_inertia(S, b, strip_row(n, strip))
        # Effectors: what is left of the sum without the strips. Added mass: the body's, and that
        # inertia.
        put_force(S, b, force, effector, effector_t - S[b + EXTRA_T], effector_n - S[b + EXTRA_N])
        f_t, f_n = added_mass_force(S, b)
        put_force(S, b, force, added_mass, f_t + S[b + EXTRA_T], f_n + S[b + EXTRA_N])


@kernel
def put_force(S, b, force, row, f_t, f_n):
    """Store a force, given in link axes of body b, in world axes."""
    c, s = S[b + COS], S[b + SIN]
    force[row] = c * f_t - s * f_n
    force[row + 1] = s * f_t + c * f_n


@kernel
def added_mass_force(S, b):
    """Return the total added-mass force on body b, link axes, due to its acceleration and its velocity."""
    f_t, f_n, _ = added_mass_velocity_terms(S, b)
    c, s = S[b + COS], S[b + SIN]
    rate = S[b + LINK_RATE]
    a_t = c * S[b + QX] + s * S[b + QY]
    a_n = c * S[b + QY] - s * S[b + QX]
    # Only in the classic form; in the others it cancels with a velocity term. The recursion has it
    # in CENTRIPETAL.
    centripetal = (1.0 - S[OWN_VELOCITY]) * S[b + MOMENT_T] * rate * rate
    f_t += centripetal - S[b + MU_T] * a_t
    f_n -= S[b + MU_N] * a_n + S[b + MOMENT_N] * S[b + LINK_ACCELERATION]
    return f_t, f_n
