"""The water's loads on a MuJoCo model, compiled: what runs in the passive callback.

All vectors of one tree are taken about the tree's center of mass, in world directions, rotation first, as MuJoCo's own
`cdof`, `cvel` and `crb` are. Per element with velocity u relative to the water, angular velocity w (both in element
axes), spatial acceleration a (at rest in the joints: what the velocities alone call for), added mass m and inertia I:

    relative     f = -m (a + w x V)                    tau = -I alpha
    kirchhoff    f = -m (a + w x V) - w x m u          tau = -I alpha - w x I w - u x m u
    classic      f = -m (a + w x (v + V))              tau = -I alpha

The part that is linear in the joint accelerations is not a force but inertia: it is added to MuJoCo's matrix M.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false

import hashlib
from pathlib import Path
from typing import Any, no_type_check

import llvmlite.binding
import numpy as np
from llvmlite import ir
from numba import (
    carray,  # pyright: ignore[reportPrivateImportUsage]
    cfunc,
    types,
)
from numba.extending import intrinsic

from laticauda.compiling import OPTIONS, compiled, kernel
from laticauda.fluid import laws
from laticauda.spatial import ground, hydrostatics
from laticauda.spatial.native import allocate, call_1, call_2, number_at, pointer, word_at

# --- The table of one model: 64-bit integers -----------------------------------------------------------------------
(
    N_BODIES,
    N_DOFS,
    N_ELEMENTS,
    HAS_INERTIA,  # 1: M is written anew
    IMPLICIT_DRAG,  # 1: the drag's secant slope, times the step, is added to the inertia
    HAS_SURFACE,
    # addresses
    PARENT,  # of each body
    FIRST_DOF,  # of each body, and the end
    ROOT,  # of each body
    DOF_BODY,
    DOF_PARENT,
    ROW_END,  # of each row of M: place of its diagonal element
    ROW_LENGTH,
    ELEMENT_BODY,
    ELEMENTS,  # records of numbers, see below
    WATER,  # numbers: see below
    LAW,  # cfunc: ten numbers in, three out behind them
    CURRENT,  # cfunc: x, y, z, t in, three out behind them; 0: constant
    HOLD,  # inertia and force to be added to each degree of freedom; 0: none
    OUT,  # loads per element; 0: not wanted
    FACTOR_M,
    MARK_STACK,
    FREE_STACK,
    ALLOCATE,
    # offsets in the model
    AT_GRAVITY,
    AT_TIME_STEP,
    AT_ARMATURE,
    # offsets in the data
    AT_QVEL,
    AT_QACC,
    AT_XPOS,
    AT_XMAT,
    AT_SUBTREE_COM,
    AT_CDOF,
    AT_CDOF_DOT,
    AT_CVEL,
    AT_CRB,
    AT_M,
    AT_QFRC_PASSIVE,
    AT_QFRC_FLUID,
    AT_TIME,
    TABLE_SIZE,
) = range(41)

# --- Numbers of the water
(DENSITY, LEVEL, V_X, V_Y, V_Z, OWN_VELOCITY, KIRCHHOFF, TERRAIN, WATER_SIZE) = (*range(8), 11)

# --- One record of numbers per element
POSITION = 0  # in the body's frame, 3
ROTATION = 3  # from element axes to the body's, 9, row by row
DRAG = 12  # 3
TORQUE_LINEAR = 15  # 3
TORQUE_QUADRATIC = 18  # 3
MASS = 21  # 3
INERTIA = 24  # 3
VOLUME = 27
SHAPE = 28
HALF = 29  # 3
REFERENCE_SPEED = 32
LINEAR = 33
QUADRATIC = 34
THRUST = 35  # 3
PULL = 38  # 3
TETHER_DRAG = 41
WAKE_MASS = 42
PLATE = 43  # 5, as in fluid.laws.plate
CONTACT = 48  # 5, as in ground.Contact; the terrain is the water's: 4 numbers
ELEMENT_SIZE = 53
OUT_SIZE = 13  # drag, added mass (its velocity part), buoyancy, effectors [N] in world axes, share under water [-]

# --- The registry: the callback that was there before, where a model has its mark, then mark and table of every model.
# The mark is a number below 2^52 that stands in the model as a denormal, so that copies of the model have it too; its
# last bits are the place in the registry.
PLACE_BITS = 12
MOST_MODELS = 1 << PLACE_BITS
registry = np.zeros(2 + 2 * MOST_MODELS, dtype=np.int64)

_SYMBOL = "laticauda_water_registry"
llvmlite.binding.add_symbol(_SYMBOL, registry.ctypes.data)
wetted = compiled(hydrostatics.wetted)
plate_law = compiled(laws.plate)
ground_force = compiled(ground.ground_force)


@intrinsic
def registry_address(typingctx):
    """Where the registry is; the linker fills it in, so that compiled code can be kept on disk."""
    del typingctx

    def codegen(context, builder, signature, arguments):
        module = builder.module
        symbol = module.globals.get(_SYMBOL)
        if symbol is None:
            symbol = ir.GlobalVariable(module, ir.IntType(64), _SYMBOL)
            symbol.linkage = "external"
        return builder.ptrtoint(symbol, ir.IntType(64))

    return types.int64(), codegen


@kernel
@no_type_check
def integers(where, n):
    """The `n` integers at an address."""
    return carray(pointer(where), (n,), np.int64)


@kernel
@no_type_check
def numbers(where, n):
    """The `n` numbers at an address."""
    return carray(pointer(where), (n,), np.float64)


@kernel
@no_type_check
def field(data, offset, n):
    """The `n` numbers of a field of the data."""
    return numbers(word_at(data + offset), n)


@kernel
@no_type_check
def element_load(E, o, T, P, S, body, model, data, law_io, step):
    """Add one element's load and inertia to those of its body in the scratch `S`.

    `E` holds the elements' records, this one's from `o` on; `P` is the water's numbers; S is laid out as acceleration,
    force (6 each) and inertia (21) of every body.
    """
    n_bodies = T[N_BODIES]
    xpos, xmat = field(data, T[AT_XPOS], 3 * n_bodies), field(data, T[AT_XMAT], 9 * n_bodies)
    com, cvel = field(data, T[AT_SUBTREE_COM], 3 * n_bodies), field(data, T[AT_CVEL], 6 * n_bodies)
    root = 3 * integers(T[ROOT], n_bodies)[body]
    b, x = 9 * body, 3 * body
    # Rotation from element to world axes, and the element's middle in the world and from the tree's center of mass.
    r00, r01, r02, r10, r11, r12, r20, r21, r22 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        e0, e1, e2 = E[o + ROTATION + 3 * k], E[o + ROTATION + 3 * k + 1], E[o + ROTATION + 3 * k + 2]
        b0, b1, b2 = xmat[b + k], xmat[b + 3 + k], xmat[b + 6 + k]
        r00 += b0 * e0
        r01 += b0 * e1
        r02 += b0 * e2
        r10 += b1 * e0
        r11 += b1 * e1
        r12 += b1 * e2
        r20 += b2 * e0
        r21 += b2 * e1
        r22 += b2 * e2
    p0, p1, p2 = E[o + POSITION], E[o + POSITION + 1], E[o + POSITION + 2]
    X = xpos[x] + xmat[b] * p0 + xmat[b + 1] * p1 + xmat[b + 2] * p2
    Y = xpos[x + 1] + xmat[b + 3] * p0 + xmat[b + 4] * p1 + xmat[b + 5] * p2
    Z = xpos[x + 2] + xmat[b + 6] * p0 + xmat[b + 7] * p1 + xmat[b + 8] * p2
    rx, ry, rz = X - com[root], Y - com[root + 1], Z - com[root + 2]
    # Share under water
    wet, c0, c1, c2 = 1.0, 0.0, 0.0, 0.0
    if T[HAS_SURFACE]:
        wet, c0, c1, c2 = wetted(
            E[o + SHAPE], E[o + HALF], E[o + HALF + 1], E[o + HALF + 2], r20, r21, r22, P[LEVEL] - Z
        )
        if wet == 0.0 and E[o + CONTACT] == 0.0:
            return
    # Velocities and accelerations at the middle, world directions
    v = 6 * body
    wx, wy, wz = cvel[v], cvel[v + 1], cvel[v + 2]
    vx = cvel[v + 3] + wy * rz - wz * ry
    vy = cvel[v + 4] + wz * rx - wx * rz
    vz = cvel[v + 5] + wx * ry - wy * rx
    ax = S[v + 3] + S[v + 1] * rz - S[v + 2] * ry
    ay = S[v + 4] + S[v + 2] * rx - S[v] * rz
    az = S[v + 5] + S[v] * ry - S[v + 1] * rx
    Vx, Vy, Vz = P[V_X], P[V_Y], P[V_Z]
    if T[CURRENT] != 0:
        law_io[0], law_io[1], law_io[2], law_io[3] = X, Y, Z, number_at(data + T[AT_TIME])
        call_1(T[CURRENT], law_io.ctypes.data)
        Vx, Vy, Vz = law_io[4], law_io[5], law_io[6]
    # What the frame's turning adds: w x V, and w x v too in the classic form.
    own = 1.0 - P[OWN_VELOCITY]
    tx, ty, tz = Vx + own * vx, Vy + own * vy, Vz + own * vz
    ax += wy * tz - wz * ty
    ay += wz * tx - wx * tz
    az += wx * ty - wy * tx
    # The same in element axes
    ux, uy, uz = vx - Vx, vy - Vy, vz - Vz
    u0, u1, u2 = r00 * ux + r10 * uy + r20 * uz, r01 * ux + r11 * uy + r21 * uz, r02 * ux + r12 * uy + r22 * uz
    w0, w1, w2 = r00 * wx + r10 * wy + r20 * wz, r01 * wx + r11 * wy + r21 * wz, r02 * wx + r12 * wy + r22 * wz
    a0, a1, a2 = r00 * ax + r10 * ay + r20 * az, r01 * ax + r11 * ay + r21 * az, r02 * ax + r12 * ay + r22 * az
    d0 = r00 * S[v] + r10 * S[v + 1] + r20 * S[v + 2]
    d1 = r01 * S[v] + r11 * S[v + 1] + r21 * S[v + 2]
    d2 = r02 * S[v] + r12 * S[v + 1] + r22 * S[v + 2]
    # Added mass
    m0, m1, m2 = wet * E[o + MASS], wet * E[o + MASS + 1], wet * E[o + MASS + 2]
    i0, i1, i2 = wet * E[o + INERTIA], wet * E[o + INERTIA + 1], wet * E[o + INERTIA + 2]
    g0, g1, g2 = m0 * u0, m1 * u1, m2 * u2
    keep = P[KIRCHHOFF]
    f0 = -m0 * a0 - keep * (w1 * g2 - w2 * g1)
    f1 = -m1 * a1 - keep * (w2 * g0 - w0 * g2)
    f2 = -m2 * a2 - keep * (w0 * g1 - w1 * g0)
    h0, h1, h2 = i0 * w0, i1 * w1, i2 * w2
    t0 = -i0 * d0 - keep * (w1 * h2 - w2 * h1 + u1 * g2 - u2 * g1)
    t1 = -i1 * d1 - keep * (w2 * h0 - w0 * h2 + u2 * g0 - u0 * g2)
    t2 = -i2 * d2 - keep * (w0 * h1 - w1 * h0 + u0 * g1 - u1 * g0)
    # Drag: the law of a plane, used for x and y about z, then for z about y, then for the roll about x.
    D, L, Q = o + DRAG, o + TORQUE_LINEAR, o + TORQUE_QUADRATIC
    q0, q1, s2 = drag(T, E, o, law_io, u0, u1, w2, E[D], E[D + 1], E[L + 2], E[Q + 2])
    _, q2, s1 = drag(T, E, o, law_io, 0.0, u2, w1, 0.0, E[D + 2], E[L + 1], E[Q + 1])
    s0 = 0.0
    if E[L] != 0.0 or E[Q] != 0.0:
        _, _, s0 = drag(T, E, o, law_io, 0.0, 0.0, w0, 0.0, 0.0, E[L], E[Q])
    q0, q1, q2, s0, s1, s2 = wet * q0, wet * q1, wet * q2, wet * s0, wet * s1, wet * s2
    if T[IMPLICIT_DRAG]:
        m0, m1, m2 = m0 + step * secant(q0, u0), m1 + step * secant(q1, u1), m2 + step * secant(q2, u2)
        i0, i1, i2 = i0 + step * secant(s0, w0), i1 + step * secant(s1, w1), i2 + step * secant(s2, w2)
    # Buoyancy, at the center of the displaced volume
    lift = -P[DENSITY] * wet * E[o + VOLUME]
    gravity = numbers(model + T[AT_GRAVITY], 3)
    bx, by, bz = lift * gravity[0], lift * gravity[1], lift * gravity[2]
    if T[OUT] != 0:
        out = numbers(T[OUT] + 8 * OUT_SIZE * (o // ELEMENT_SIZE), OUT_SIZE)
        out[0], out[1] = r00 * q0 + r01 * q1 + r02 * q2, r10 * q0 + r11 * q1 + r12 * q2
        out[2] = r20 * q0 + r21 * q1 + r22 * q2
        out[3], out[4] = r00 * f0 + r01 * f1 + r02 * f2, r10 * f0 + r11 * f1 + r12 * f2
        out[5] = r20 * f0 + r21 * f1 + r22 * f2
        out[6], out[7], out[8] = bx, by, bz
    f0, f1, f2, t0, t1, t2 = f0 + q0, f1 + q1, f2 + q2, t0 + s0, t1 + s1, t2 + s2
    e0, e1, e2 = effector(E, o, u0, u1, u2)
    if T[OUT] != 0:
        out = numbers(T[OUT] + 8 * OUT_SIZE * (o // ELEMENT_SIZE), OUT_SIZE)
        out[9] = r00 * e0 + r01 * e1 + r02 * e2 + E[o + PULL]
        out[10] = r10 * e0 + r11 * e1 + r12 * e2 + E[o + PULL + 1]
        out[11] = r20 * e0 + r21 * e1 + r22 * e2 + E[o + PULL + 2]
        out[12] = wet
    f0, f1, f2 = f0 + e0, f1 + e1, f2 + e2
    fx, fy, fz = r00 * f0 + r01 * f1 + r02 * f2, r10 * f0 + r11 * f1 + r12 * f2, r20 * f0 + r21 * f1 + r22 * f2
    fx, fy, fz = fx + bx + E[o + PULL], fy + by + E[o + PULL + 1], fz + bz + E[o + PULL + 2]
    cx, cy, cz = r00 * c0 + r01 * c1 + r02 * c2, r10 * c0 + r11 * c1 + r12 * c2, r20 * c0 + r21 * c1 + r22 * c2
    tx = r00 * t0 + r01 * t1 + r02 * t2 + cy * bz - cz * by
    ty = r10 * t0 + r11 * t1 + r12 * t2 + cz * bx - cx * bz
    tz = r20 * t0 + r21 * t1 + r22 * t2 + cx * by - cy * bx
    if E[o + CONTACT] != 0.0:
        c, h = o + CONTACT, o + HALF
        q0, q1, q2, s0, s1, s2 = ground_force(
            (X, Y, Z),
            (r00, r01, r02, r10, r11, r12, r20, r21, r22),
            (vx, vy, vz),
            (wx, wy, wz),
            (E[h], E[h + 1], E[h + 2]),
            (E[c], E[c + 1], E[c + 2], E[c + 3], E[c + 4]),
            (P[TERRAIN], P[TERRAIN + 1], P[TERRAIN + 2], P[TERRAIN + 3]),
        )
        fx, fy, fz, tx, ty, tz = fx + q0, fy + q1, fz + q2, tx + s0, ty + s1, tz + s2
        if T[OUT] != 0:
            out = numbers(T[OUT] + 8 * OUT_SIZE * (o // ELEMENT_SIZE), OUT_SIZE)
            out[0], out[1], out[2] = out[0] + q0, out[1] + q1, out[2] + q2
    F = 6 * n_bodies + 6 * body
    S[F] += tx + ry * fz - rz * fy
    S[F + 1] += ty + rz * fx - rx * fz
    S[F + 2] += tz + rx * fy - ry * fx
    S[F + 3] += fx
    S[F + 4] += fy
    S[F + 5] += fz
    if T[HAS_INERTIA] == 0:
        return
    # Inertia in world directions about the center of mass: [[K, B], [B^T, N]] with B = [r] N, K = I - B [r].
    n00 = m0 * r00 * r00 + m1 * r01 * r01 + m2 * r02 * r02
    n01 = m0 * r00 * r10 + m1 * r01 * r11 + m2 * r02 * r12
    n02 = m0 * r00 * r20 + m1 * r01 * r21 + m2 * r02 * r22
    n11 = m0 * r10 * r10 + m1 * r11 * r11 + m2 * r12 * r12
    n12 = m0 * r10 * r20 + m1 * r11 * r21 + m2 * r12 * r22
    n22 = m0 * r20 * r20 + m1 * r21 * r21 + m2 * r22 * r22
    B00, B01, B02 = ry * n02 - rz * n01, ry * n12 - rz * n11, ry * n22 - rz * n12
    B10, B11, B12 = rz * n00 - rx * n02, rz * n01 - rx * n12, rz * n02 - rx * n22
    B20, B21, B22 = rx * n01 - ry * n00, rx * n11 - ry * n01, rx * n12 - ry * n02
    A = 12 * n_bodies + 21 * body
    S[A] += i0 * r00 * r00 + i1 * r01 * r01 + i2 * r02 * r02 - B01 * rz + B02 * ry
    S[A + 1] += i0 * r00 * r10 + i1 * r01 * r11 + i2 * r02 * r12 + B00 * rz - B02 * rx
    S[A + 2] += i0 * r00 * r20 + i1 * r01 * r21 + i2 * r02 * r22 - B00 * ry + B01 * rx
    S[A + 3] += i0 * r10 * r10 + i1 * r11 * r11 + i2 * r12 * r12 + B10 * rz - B12 * rx
    S[A + 4] += i0 * r10 * r20 + i1 * r11 * r21 + i2 * r12 * r22 - B10 * ry + B11 * rx
    S[A + 5] += i0 * r20 * r20 + i1 * r21 * r21 + i2 * r22 * r22 - B20 * ry + B21 * rx
    S[A + 6] += B00
    S[A + 7] += B01
    S[A + 8] += B02
    S[A + 9] += B10
    S[A + 10] += B11
    S[A + 11] += B12
    S[A + 12] += B20
    S[A + 13] += B21
    S[A + 14] += B22
    S[A + 15] += n00
    S[A + 16] += n01
    S[A + 17] += n02
    S[A + 18] += n11
    S[A + 19] += n12
    S[A + 20] += n22


@kernel
@no_type_check
def drag(T, E, o, law_io, v_t, v_n, rate, c_t, c_n, lambda_2, lambda_3):
    """The fluid law on one plane of an element."""
    law_io[0], law_io[1], law_io[2] = v_t, v_n, rate
    law_io[3], law_io[4], law_io[5], law_io[6] = c_t, c_n, lambda_2, lambda_3
    law_io[7], law_io[8], law_io[9] = E[o + REFERENCE_SPEED], E[o + LINEAR], E[o + QUADRATIC]
    call_1(T[LAW], law_io.ctypes.data)
    return law_io[10], law_io[11], law_io[12]


@kernel
@no_type_check
def effector(E, o, u0, u1, u2):
    """Thrust, tether, wake and plate, in element axes: what only few elements have."""
    f0, f1, f2 = E[o + THRUST], E[o + THRUST + 1], E[o + THRUST + 2]
    if E[o + TETHER_DRAG] != 0.0:
        slope = E[o + TETHER_DRAG] * (u0 * u0 + u1 * u1 + u2 * u2) ** 0.5
        f0, f1, f2 = f0 - slope * u0, f1 - slope * u1, f2 - slope * u2
    if E[o + WAKE_MASS] != 0.0 and u0 > 0.0:
        f0, f1 = f0 + 0.5 * E[o + WAKE_MASS] * u1 * u1, f1 - E[o + WAKE_MASS] * u0 * u1
    if E[o + PLATE] != 0.0:
        k = o + PLATE
        p0, p1 = plate_law(u0, u1, E[k], E[k + 1], E[k + 2], E[k + 3], E[k + 4])
        f0, f1 = f0 + p0, f1 + p1
    return f0, f1, f2


@kernel
@no_type_check
def secant(force, velocity):
    """-f / v, what an implicit step adds per time; never negative for a drag."""
    return -force / velocity if abs(velocity) > 1e-12 else 0.0


@kernel
@no_type_check
def velocity_accelerations(T, data, S):
    """Spatial acceleration of every body if no joint accelerates."""
    n_bodies, n_dofs = T[N_BODIES], T[N_DOFS]
    qvel, cdof_dot = field(data, T[AT_QVEL], n_dofs), field(data, T[AT_CDOF_DOT], 6 * n_dofs)
    parent, first = integers(T[PARENT], n_bodies), integers(T[FIRST_DOF], n_bodies + 1)
    for k in range(6):
        S[k] = 0.0
    for b in range(1, n_bodies):
        for k in range(6):
            S[6 * b + k] = S[6 * parent[b] + k]
        for j in range(first[b], first[b + 1]):
            for k in range(6):
                S[6 * b + k] += cdof_dot[6 * j + k] * qvel[j]


@kernel
@no_type_check
def gather(T, data, S):
    """Forces from the leaves to the root, and onto the degrees of freedom; inertia likewise."""
    n_bodies, n_dofs = T[N_BODIES], T[N_DOFS]
    parent = integers(T[PARENT], n_bodies)
    for b in range(n_bodies - 1, 0, -1):
        p = parent[b]
        if p > 0:
            for k in range(6):
                S[6 * (n_bodies + p) + k] += S[6 * (n_bodies + b) + k]
            if T[HAS_INERTIA]:
                for k in range(21):
                    S[12 * n_bodies + 21 * p + k] += S[12 * n_bodies + 21 * b + k]
    body, cdof = integers(T[DOF_BODY], n_dofs), field(data, T[AT_CDOF], 6 * n_dofs)
    passive, fluid = field(data, T[AT_QFRC_PASSIVE], n_dofs), field(data, T[AT_QFRC_FLUID], n_dofs)
    for j in range(n_dofs):
        force = 0.0
        for k in range(6):
            force += cdof[6 * j + k] * S[6 * (n_bodies + body[j]) + k]
        passive[j] += force
        fluid[j] += force


@kernel
@no_type_check
def write_inertia(T, model, data, S):
    """M + A into MuJoCo's matrix, from MuJoCo's composite inertias, so that doing it twice does no harm."""
    n_bodies, n_dofs = T[N_BODIES], T[N_DOFS]
    body, above = integers(T[DOF_BODY], n_dofs), integers(T[DOF_PARENT], n_dofs)
    end, length = integers(T[ROW_END], n_dofs), integers(T[ROW_LENGTH], n_dofs)
    cdof, crb = field(data, T[AT_CDOF], 6 * n_dofs), field(data, T[AT_CRB], 10 * n_bodies)
    armature = field(model, T[AT_ARMATURE], n_dofs)
    M = field(data, T[AT_M], end[n_dofs - 1] + 1)
    for i in range(n_dofs):
        c, C, A = 6 * i, 10 * body[i], 12 * n_bodies + 21 * body[i]
        w0, w1, w2, v0, v1, v2 = cdof[c], cdof[c + 1], cdof[c + 2], cdof[c + 3], cdof[c + 4], cdof[c + 5]
        m0, m1, m2, m = crb[C + 6], crb[C + 7], crb[C + 8], crb[C + 9]
        K01, K02, K12 = crb[C + 3] + S[A + 1], crb[C + 4] + S[A + 2], crb[C + 5] + S[A + 4]
        B00, B01, B02 = S[A + 6], S[A + 7] - m2, S[A + 8] + m1
        B10, B11, B12 = S[A + 9] + m2, S[A + 10], S[A + 11] - m0
        B20, B21, B22 = S[A + 12] - m1, S[A + 13] + m0, S[A + 14]
        N01, N02, N12 = S[A + 16], S[A + 17], S[A + 19]
        h0 = (crb[C] + S[A]) * w0 + K01 * w1 + K02 * w2 + B00 * v0 + B01 * v1 + B02 * v2
        h1 = K01 * w0 + (crb[C + 1] + S[A + 3]) * w1 + K12 * w2 + B10 * v0 + B11 * v1 + B12 * v2
        h2 = K02 * w0 + K12 * w1 + (crb[C + 2] + S[A + 5]) * w2 + B20 * v0 + B21 * v1 + B22 * v2
        l0 = B00 * w0 + B10 * w1 + B20 * w2 + (m + S[A + 15]) * v0 + N01 * v1 + N02 * v2
        l1 = B01 * w0 + B11 * w1 + B21 * w2 + N01 * v0 + (m + S[A + 18]) * v1 + N12 * v2
        l2 = B02 * w0 + B12 * w1 + B22 * w2 + N02 * v0 + N12 * v1 + (m + S[A + 20]) * v2
        j = i
        for back in range(length[i]):
            d = 6 * j
            value = cdof[d] * h0 + cdof[d + 1] * h1 + cdof[d + 2] * h2
            value += cdof[d + 3] * l0 + cdof[d + 4] * l1 + cdof[d + 5] * l2
            M[end[i] - back] = value
            j = above[j]
        M[end[i]] += armature[i]


@kernel
@no_type_check
def add_hold(T, data):
    """What the joints' drives ask for: inertia on the diagonal, and a force, per degree of freedom."""
    n_dofs = T[N_DOFS]
    hold = numbers(T[HOLD], 2 * n_dofs)
    end, passive = integers(T[ROW_END], n_dofs), field(data, T[AT_QFRC_PASSIVE], n_dofs)
    M = field(data, T[AT_M], end[n_dofs - 1] + 1)
    for i in range(n_dofs):
        M[end[i]] += hold[i]
        passive[i] += hold[n_dofs + i]


@kernel
@no_type_check
def apply(model, data, table):
    """All loads of one model's water."""
    T = integers(table, TABLE_SIZE)
    n_bodies = T[N_BODIES]
    call_1(T[MARK_STACK], data)
    S = numbers(allocate(T[ALLOCATE], data, 33 * n_bodies + 16), 33 * n_bodies + 16)
    law_io = S[33 * n_bodies :]
    for k in range(6 * n_bodies, 33 * n_bodies):
        S[k] = 0.0
    velocity_accelerations(T, data, S)
    n = T[N_ELEMENTS]
    body, E, P = integers(T[ELEMENT_BODY], n), numbers(T[ELEMENTS], n * ELEMENT_SIZE), numbers(T[WATER], WATER_SIZE)
    step = number_at(model + T[AT_TIME_STEP])
    for e in range(n):
        element_load(E, e * ELEMENT_SIZE, T, P, S, body[e], model, data, law_io, step)
    gather(T, data, S)
    if T[HAS_INERTIA]:
        write_inertia(T, model, data, S)
        if T[HOLD] != 0:
            add_hold(T, data)
        call_2(T[FACTOR_M], model, data)
    call_1(T[FREE_STACK], data)


@no_type_check
def _passive(model, data):
    R = integers(registry_address(), 2 + 2 * MOST_MODELS)
    if R[0] != 0:
        call_2(R[0], model, data)
    mark = word_at(model + R[1])
    place = 2 + 2 * (mark & (MOST_MODELS - 1))
    if mark != 0 and R[place] == mark:
        apply(model, data, R[place + 1])


def _digest() -> str:
    folder = Path(__file__).parent.parent
    digest = hashlib.sha256()
    for source in ("spatial/loads.py", "spatial/native.py", "spatial/hydrostatics.py", "spatial/ground.py"):
        digest.update((folder / source).read_bytes())
    for source in ("fluid/laws.py", "compiling.py"):
        digest.update((folder / source).read_bytes())
    return digest.hexdigest()[:16]


def callback() -> Any:
    """The passive callback for all models with water: a compiled function of the addresses of model and data."""
    # Numba files compiled code under the function's qualified name and looks at this file only.
    _passive.__qualname__ = f"_passive_{_digest()}"
    return cfunc(types.void(types.int64, types.int64), cache=True, **OPTIONS)(_passive)
