"""Load of the water on one element, and the inertia of the water that moves with it.

For an element with velocity u relative to the water, angular velocity w (both in element axes),
spatial acceleration a for zero joint accelerations (due to the velocities alone), added mass m and
inertia I, in still water:

    relative     f = -m (a + w x V)                    tau = -I alpha
    kirchhoff    f = -m (a + w x V) - w x m u          tau = -I alpha - w x I w - u x m u
    classic      f = -m (a + w x (v + V))              tau = -I alpha

In water that accelerates and rotates, `fluid.inertia` defines what w, a and alpha are relative to.
The part that is linear in the joint accelerations is not a force but inertia: it is added to
MuJoCo's matrix M.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false
# pyright: reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false, reportConstantRedefinition=false

from laticauda.compiling import compile_scalar, kernel
from laticauda.compiling.formulas import PLACE, rows_from
from laticauda.water.fluid import edges, inertia
from laticauda.water.fluid.laws import plate
from laticauda.water.mujoco import hydrostatics
from laticauda.water.mujoco.ground import ground_load
from laticauda.water.mujoco.native import call_2, flags_at, number_at, stop, word_at
from laticauda.water.mujoco.table import *
from laticauda.water.mujoco.vectors import *

wetted = compile_scalar(hydrostatics.wetted)
wetting = compile_scalar(hydrostatics.wetting)
plate_law = compile_scalar(plate)
finite_span = compile_scalar(edges.finite_span)
edge_numbers = rows_from(EDGE, len(edges.Plate._fields))
carried = compile_scalar(inertia.carried)
load = compile_scalar(inertia.load)


@kernel
def element_load(E, o, T, P, S, body, model, data, law_io, step):
    """Add one element's load and inertia to those of its body in the scratch array `S`.

    `E` holds the elements' records, with this one's starting at `o`; `P` holds the water's
    parameters; S contains acceleration, force (6 each) and inertia (21) of every body.
    """
    R, place, arm = pose(E, o, T, body, data)
    V, flow, spin, elevation = flow_at(T, P, place, 0.0, model, data, law_io)
    wet = 1.0
    center = (0.0, 0.0, 0.0)
    covered = 0.0
    whole = 0.0
    if T[HAS_SURFACE]:
        depth = P[LEVEL] + elevation - place[2]
        wet, c_x, c_y, c_z = wetted(E[o + SHAPE], three(E, o + HALF), three(R, 6), depth)
        center = (c_x, c_y, c_z)
        if wet < 1.0 and T[HAS_INERTIA]:
            surface = P, place, elevation, model, law_io
            covered, whole = covering(T, E, o, R, wet, depth, arm, body, data, step, surface)
        if wet == 0.0 and covered == 0.0 and E[o + CONTACT] == 0.0:
            E[o + EDGE_MEMORY + 1] = 0.0
            return
    u, w, a, alpha = motion(T, P, S, R, arm, body, data, V, flow, spin)
    m = scaled(wet, three(E, o + MASS))
    i = scaled(wet, three(E, o + INERTIA))
    added, added_torque = added_mass(P[KIRCHHOFF], m, i, u, w, a, alpha)
    if covered > 0.0:
        own_m = E[o + OWN_MASS]
        own_i = E[o + OWN_INERTIA]
        ahead = whole * covered * step
        slowing = momentum_of_new_water(three(E, o + MASS), own_m, u, wet, covered, ahead)
        slowing_turn = momentum_of_new_water(three(E, o + INERTIA), own_i, w, wet, covered, ahead)
        added = plus(added, slowing)
        added_torque = plus(added_torque, slowing_turn)
    dragged, dragged_torque = drag(T, E, o, law_io, u, w, wet)
    if wet < 1.0 and E[o + HEAVE_DAMPING] != 0.0:
        slowed, slowed_torque = radiation(E, o, three(R, 6), u, w, wet)
        dragged = plus(dragged, slowed)
        dragged_torque = plus(dragged_torque, slowed_torque)
    own = effector(E, o, u)
    turn = (0.0, 0.0, 0.0)
    if E[o + EDGE_LAG] != 0.0:
        own, turn = edge_load(E, o, u, w)
    displaced = P[DENSITY] * wet * E[o + VOLUME]
    buoyancy = scaled(-displaced, gravity(T, model))
    carried_along = scaled(displaced, flow)
    lift = plus(buoyancy, carried_along)
    pull = three(E, o + PULL)
    if T[OUT] != 0:
        added_in_all = plus(added, to_own(R, carried_along))
        write_loads(T, o, R, dragged, added_in_all, buoyancy, own, pull, wet)
    own_force = plus(plus(added, dragged), own)
    own_torque = plus(plus(added_torque, dragged_torque), turn)
    force = plus(to_world(R, own_force), plus(lift, pull))
    torque = plus(to_world(R, own_torque), cross(to_world(R, center), lift))
    if E[o + CONTACT] != 0.0:
        pushed, pushed_torque = ground_load(T, E, o, P, R, place, arm, body, data)
        force = plus(force, pushed)
        torque = plus(torque, pushed_torque)
    torque = plus(torque, cross(arm, force))
    F = 6 * (T[N_BODIES] + body)
    for k in range(3):
        S[F + k] += torque[k]
        S[F + 3 + k] += force[k]
    if T[HAS_INERTIA]:
        if T[IMPLICIT_DRAG]:
            m = plus(m, implicit(dragged, u, step))
            i = plus(i, implicit(dragged_torque, w, step))
        add_inertia(S, 12 * T[N_BODIES] + 21 * body, R, arm, m, i)


@kernel
def pose(E, o, T, body, data):
    """Return the rotation from element to world axes, the center, and its offset from the tree's center of mass."""
    n_bodies = T[N_BODIES]
    xpos = field(data, T[AT.xpos], 3 * n_bodies)
    xmat = field(data, T[AT.xmat], 9 * n_bodies)
    root = integers(T[ROOT], n_bodies)[body]
    com = three(field(data, T[AT.subtree_com], 3 * n_bodies), 3 * root)
    B = nine(xmat, 9 * body)
    Q = nine(E, o + ROTATION)
    x = to_world(B, (Q[0], Q[3], Q[6]))
    y = to_world(B, (Q[1], Q[4], Q[7]))
    z = to_world(B, (Q[2], Q[5], Q[8]))
    R = (x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2])
    place = plus(three(xpos, 3 * body), to_world(B, three(E, o + POSITION)))
    return R, place, plus(place, scaled(-1.0, com))


@kernel
def motion(T, P, S, R, arm, body, data, V, flow, spin):
    """Return u, w, a (with the turning of the axes) and alpha in element axes, given the water's V, Du/Dt and spin."""
    cvel = field(data, T[AT.cvel], 6 * T[N_BODIES])
    w = three(cvel, 6 * body)
    alpha = three(S, 6 * body)
    v = plus(three(cvel, 6 * body + 3), cross(w, arm))
    a = plus(three(S, 6 * body + 3), cross(alpha, arm))
    u = plus(v, scaled(-1.0, V))
    a = plus(a, cross(w, plus(V, scaled(1.0 - P[OWN_VELOCITY], v))))
    f_x, f_y, f_z = flow
    s_x, s_y, s_z = spin
    u_x, u_y, u_z = u
    with_x = carried(f_x, s_y, s_z, u_y, u_z)
    with_y = carried(f_y, s_z, s_x, u_z, u_x)
    with_z = carried(f_z, s_x, s_y, u_x, u_y)
    a = plus(a, scaled(-1.0, (with_x, with_y, with_z)))
    alpha = plus(alpha, cross(w, spin))
    w = plus(w, scaled(-1.0, spin))
    return to_own(R, u), to_own(R, w), to_own(R, a), to_own(R, alpha)


@kernel
def flow_at(T, P, place, ahead, model, data, io):
    """Return the water's velocity, material acceleration and rotation in world axes, and its elevation, at a place.

    Args:
        T: The model's table.
        P: The water's parameters.
        place: Position, world axes.
        ahead: Offset from the time in the data [s].
        model: Address of the model, which holds the velocity or the number of the flow.
        data: Address of the data.
        io: Scratch array.
    """
    own = numbers(model + T[IN_MODEL.o_friction], 4)
    number = int(own[3])
    if number == 0:  # a constant velocity, see `currents`
        return three(own, 0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0
    row = T[FLOWS] + FLOW_COLUMNS * WORD * (number % MOST_FLOWS)
    if word_at(row) != number:
        stop(T[FLOW_LOST])
    io[0] = place[0]
    io[1] = place[1]
    io[2] = place[2] - P[LEVEL]
    io[3] = number_at(data + T[AT.time]) + ahead
    function = word_at(row + WORD)
    numbers_of_parts = word_at(row + 2 * WORD)
    call_2(function, io.ctypes.data, numbers_of_parts)
    return three(io, PLACE), three(io, PLACE + 3), three(io, PLACE + 6), io[PLACE + 9]


@kernel
def gravity(T, model):
    """Return the model's gravity, or zero if it is disabled."""
    if flags_at(model + T[IN_MODEL.disableflags]) & T[NO_GRAVITY] != 0:
        return 0.0, 0.0, 0.0
    return three(numbers(model + T[IN_MODEL.gravity], 3), 0)


@kernel
def added_mass(keep, m, i, u, w, a, alpha):
    """Return force and torque of the added mass for zero joint accelerations; keep: 1 for kirchhoff, else 0."""
    momentum = times(m, u)
    turned = cross(w, momentum)
    twisted = plus(cross(w, times(i, w)), cross(u, momentum))
    force = added_load(keep, m, a, turned)
    torque = added_load(keep, i, alpha, twisted)
    return force, torque


@kernel
def added_load(keep, m, rate, turned):
    """Return the added mass's force or torque along all three axes."""
    x = load(keep, m[0], rate[0], turned[0])
    y = load(keep, m[1], rate[1], turned[1])
    z = load(keep, m[2], rate[2], turned[2])
    return x, y, z


@kernel
def covering(T, E, o, R, wet, depth, arm, body, data, step, surface):
    """Return the growth rate of the submerged share, 0 while it falls; and 1 if it is taken over the whole next step.

    That is the case for steps of first order, and for those in which the moving mass grows by more
    than half.
    """
    rate = 0.0
    whole = 1.0
    for share in (1.0, 1e-3):
        ahead = max(share * step, 1e-6)
        rate = wetting_in(T, E, o, R, wet, depth, arm, body, data, ahead, surface)
        x = added_share(rate * step, max(three(E, o + MASS)), E[o + OWN_MASS], wet)
        if T[FIRST_ORDER] or x > 0.5:
            break
        whole = 0.0
    return rate, whole


@kernel
def wetting_in(T, E, o, R, wet, depth, arm, body, data, ahead, surface):
    """Return the growth rate of the submerged share over the time ahead, at constant motion of body and surface."""
    P, place, elevation, model, io = surface
    cvel = field(data, T[AT.cvel], 6 * T[N_BODIES])
    w = three(cvel, 6 * body)
    half = three(E, o + HALF)
    up = three(R, 6)
    v = plus(three(cvel, 6 * body + 3), cross(w, arm))
    later_place = plus(place, scaled(ahead, v))
    _, _, _, later_elevation = flow_at(T, P, later_place, ahead, model, data, io)
    rising = (later_elevation - elevation) / ahead
    rate = wetting(wet, E[o + SHAPE], half, up, depth, to_own(R, w), rising - v[2], ahead)
    return max(0.0, rate)


@kernel
def added_share(grown, m, own, wet):
    """Return newly added water over all that moves; `own` is the body's mass or inertia."""
    return grown * m / (own + wet * m + 1e-12)


@kernel
def momentum_of_new_water(m, own, u, wet, rate, ahead):
    """Return minus the momentum per time that new water takes; with 1 / (1 + x) a step `ahead` conserves momentum."""
    x = added_share(ahead, m[0], own, wet)
    y = added_share(ahead, m[1], own, wet)
    z = added_share(ahead, m[2], own, wet)
    return (
        -rate * m[0] * u[0] / (1.0 + x),
        -rate * m[1] * u[1] / (1.0 + y),
        -rate * m[2] * u[2] / (1.0 + z),
    )


@kernel
def drag(T, E, o, law_io, u, w, wet):
    """Return force and torque by the law: with y across and about z, with z across and about y, then roll about x."""
    c = three(E, o + DRAG)
    linear = three(E, o + TORQUE_LINEAR)
    quadratic = three(E, o + TORQUE_QUADRATIC)
    law = integers(T[LAWS], T[N_ELEMENTS])[o // ELEMENT_SIZE]
    own = E[o + LAW_NUMBERS :].ctypes.data
    across = (u[1] * u[1] + u[2] * u[2]) ** 0.5
    in_plane = (u[0], u[1], across, w[2])
    f_x, f_y, t_z = by_law(law, own, law_io, in_plane, (c[0], c[1], linear[2], quadratic[2]))
    upright = (u[0], u[2], across, w[1])
    _, f_z, t_y = by_law(law, own, law_io, upright, (c[0], c[2], linear[1], quadratic[1]))
    t_x = 0.0
    if linear[0] != 0.0 or quadratic[0] != 0.0:
        rolling = (0.0, 0.0, 0.0, w[0])
        _, _, t_x = by_law(law, own, law_io, rolling, (0.0, 0.0, linear[0], quadratic[0]))
    return scaled(wet, (f_x, f_y, f_z)), scaled(wet, (t_x, t_y, t_z))


@kernel
def radiation(E, o, up, u, w, wet):
    """Return force and torque of the waves that an element makes, whose momentum is vertical, in element axes.

    A torque has no vertical part: else each roll with a pitch would leave a yaw that nothing ends.
    """
    share = -4.0 * wet * (1.0 - wet)
    force = scaled(share * E[o + HEAVE_DAMPING] * along(u, up), up)
    tilting = plus(w, scaled(-along(w, up), up))
    torque = scaled(share, times(three(E, o + TILT_DAMPING), tilting))
    return force, plus(torque, scaled(-along(torque, up), up))


@kernel
def along(a, direction):
    """Return the part of a along a direction of length 1."""
    return a[0] * direction[0] + a[1] * direction[1] + a[2] * direction[2]


@kernel
def by_law(law, own, law_io, motion, element):
    """Return the loads of the law at the address `law`, whose parameters are at the address `own`."""
    for k in range(MOTION):
        law_io[k] = motion[k]
        law_io[MOTION + k] = element[k]
    call_2(law, law_io.ctypes.data, own)
    return three(law_io, LOADS)


@kernel
def effector(E, o, u):
    """Return thrust, tether, wake and plate forces in element axes, which only a few elements have."""
    force = three(E, o + THRUST)
    if E[o + TETHER_DRAG] != 0.0:
        speed = (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]) ** 0.5
        force = plus(force, scaled(-E[o + TETHER_DRAG] * speed, u))
    if E[o + WAKE_MASS] != 0.0 and u[0] > 0.0:
        direction = (0.5 * u[1] * u[1], -u[0] * u[1], 0.0)
        force = plus(force, scaled(E[o + WAKE_MASS], direction))
    if E[o + PLATE] != 0.0:
        k = o + PLATE
        along, across = plate_law(u[0], u[1], E[k], E[k + 1], E[k + 2], E[k + 3], E[k + 4])
        force = plus(force, (along, across, 0.0))
    return force


@kernel
def edge_load(E, o, u, w):
    """Return force and torque of an edge of finite span about its element, and set the rate of its state."""
    z = E[o + EDGE_MEMORY]
    along, across, torque, rate = finite_span(u[0], u[1], w[2], z, *edge_numbers(E, o))
    E[o + EDGE_MEMORY + 1] = rate
    return (along, across, 0.0), (0.0, 0.0, torque)


@kernel
def implicit(load, velocity, step):
    """Return a drag's secant slopes -f / v, never negative, times the step: what an implicit step adds."""
    return (
        secant(load[0], velocity[0], step),
        secant(load[1], velocity[1], step),
        secant(load[2], velocity[2], step),
    )


@kernel
def secant(load, velocity, step):
    """Return the secant slope times the step along one axis."""
    if abs(velocity) > 1e-12:
        return -step * load / velocity
    return 0.0


@kernel
def write_loads(T, o, R, dragged, added, lift, own, pull, wet):
    """Write the loads that `Water.forces` returns, in world axes."""
    out = numbers(T[OUT] + WORD * OUT_SIZE * (o // ELEMENT_SIZE), OUT_SIZE)
    dragged = to_world(R, dragged)
    added = to_world(R, added)
    own = plus(to_world(R, own), pull)
    for k in range(3):
        out[k] = dragged[k]
        out[3 + k] = added[k]
        out[6 + k] = lift[k]
        out[9 + k] = own[k]
    out[12] = wet


@kernel
def add_inertia(S, A, R, arm, m, i):
    """Add an element's inertia about the center of mass, world axes: [[K, B], [B^T, N]], B = [r] N, K = I - B [r]."""
    N = symmetric(R, m)
    k = symmetric(R, i)
    x = cross(arm, (N[0], N[1], N[2]))
    y = cross(arm, (N[1], N[3], N[4]))
    z = cross(arm, (N[2], N[4], N[5]))
    rx, ry, rz = arm
    S[A] += k[0] - y[0] * rz + z[0] * ry
    S[A + 1] += k[1] + x[0] * rz - z[0] * rx
    S[A + 2] += k[2] - x[0] * ry + y[0] * rx
    S[A + 3] += k[3] + x[1] * rz - z[1] * rx
    S[A + 4] += k[4] - x[1] * ry + y[1] * rx
    S[A + 5] += k[5] - x[2] * ry + y[2] * rx
    for row in range(3):  # of B, whose columns are x, y and z
        for column, value in enumerate((x[row], y[row], z[row])):
            S[A + 6 + 3 * row + column] += value
    for place, value in enumerate(N):
        S[A + 15 + place] += value


@kernel
def symmetric(R, d):
    """Return the upper triangle of R diag(d) R^T, row by row."""
    x = times(d, three(R, 0))
    y = times(d, three(R, 3))
    z = times(d, three(R, 6))
    return (
        x[0] * R[0] + x[1] * R[1] + x[2] * R[2],
        x[0] * R[3] + x[1] * R[4] + x[2] * R[5],
        x[0] * R[6] + x[1] * R[7] + x[2] * R[8],
        y[0] * R[3] + y[1] * R[4] + y[2] * R[5],
        y[0] * R[6] + y[1] * R[7] + y[2] * R[8],
        z[0] * R[6] + z[1] * R[7] + z[2] * R[8],
    )
