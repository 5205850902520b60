"""The ground's load on one element, compiled; see `ground`."""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false
# pyright: reportWildcardImportFromLibrary=false

from laticauda.compiling import compiled, kernel
from laticauda.mujoco_water import ground
from laticauda.mujoco_water.table import *
from laticauda.mujoco_water.vectors import cross, field, numbers, plus, scaled, three, times, to_own, to_world

terrain = compiled(ground.terrain)
uneven = compiled(ground.uneven)
touch = compiled(ground.touch)


@kernel
def ground_load(T, E, o, P, R, place, arm, body, data):
    """Force on an element and its torque about the element's middle, world axes.

    Args:
        T: The model's table.
        E: The elements' records.
        o: Where this one's begins.
        P: The water's numbers.
        R: Rotation from element to world axes.
        place: The element's middle.
        arm: The same from the tree's center of mass.
        body: The element's body.
        data: The address of the data.
    """
    cvel = field(data, T[AT.cvel], 6 * T[N_BODIES])
    w = three(cvel, 6 * body)
    v = plus(three(cvel, 6 * body + 3), cross(w, arm))
    force, torque = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for sign in (-1.0, 1.0):
        to_point, normal = lowest_point(T, E, o, P, R, place, sign)
        at = plus(place, to_point)
        depth = (ground_at(T, P, at[0], at[1])[0] - at[2]) * normal[2]
        if depth > 0.0:
            push = push_of(E, o, R, depth, plus(v, cross(w, to_point)), normal)
            force, torque = plus(force, push), plus(torque, cross(to_point, push))
    if T[OUT] != 0:
        out = numbers(T[OUT] + 8 * OUT_SIZE * (o // ELEMENT_SIZE), OUT_SIZE)
        for k in range(3):
            out[k] += force[k]
    return force, torque


@kernel
def ground_at(T, P, x, y):
    """Height of the ground at a place, and the tangents of its fall along x and y."""
    height, fall = terrain(x, *three(P, TERRAIN), P[TERRAIN + 3])
    if T[GRID_SIZE] == 0:
        return height, fall, 0.0
    more, fall_x, fall_y = uneven(x, y, numbers(T[GRID], T[GRID_SIZE]))
    return height + more, fall + fall_x, fall_y


@kernel
def lowest_point(T, E, o, P, R, place, sign):
    """From the element's middle to the lowest point of the section at one end, and the ground's normal there."""
    half = three(E, o + HALF)
    _, fall, aside = ground_at(T, P, place[0] + sign * half[0] * R[0], place[1] + sign * half[0] * R[3])
    steep = (1.0 + fall * fall + aside * aside) ** -0.5
    normal = (fall * steep, aside * steep, steep)
    up = to_own(R, normal)
    reach = times((0.0, half[1], half[2]), up)
    size = (reach[1] * reach[1] + reach[2] * reach[2]) ** 0.5 + 1e-12
    own = plus((sign * half[0], 0.0, 0.0), scaled(-1.0 / size, times(half, reach)))
    return to_world(R, own), normal


@kernel
def push_of(E, o, R, depth, v, normal):
    """The force on a point that is in the ground, with friction along and across the element."""
    ahead = to_world(R, (1.0, 0.0, 0.0))
    aside = cross(normal, ahead)
    aside = scaled(1.0 / (length(aside) + 1e-12), aside)
    ahead = cross(aside, normal)
    c = o + CONTACT
    f_t, f_n, f_z = touch(depth, -dot(v, normal), dot(v, ahead), dot(v, aside), *three(E, c), E[c + 3], E[c + 4])
    return plus(plus(scaled(f_t, ahead), scaled(f_n, aside)), scaled(f_z, normal))


@kernel
def dot(a, b):
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def length(a):
    """|a|."""
    return dot(a, a) ** 0.5
