"""Ground contact of an element: normal force from penetration depth, and anisotropic friction proportional to it.

MuJoCo's friction has its axes in the contact frame, which turns with the body only for a capsule on
a plane, and hence not on a ramp. Here friction acts along and across the element wherever it lies,
by `fluid.laws` with the normal force N in place of a weight. An element touches the ground at the
lowest point of its elliptic section at either end:

    N = k d max(0, 1 + beta d')        f = -mu N v / sqrt(v^2 + eps^2), or -mu N v for viscous ground

d is the penetration depth of the point. An element lying flat under its own weight should sink in
by SINK; beta damps its bounce. Plain scalar functions, and the load on one element, which the
kernels compile from them.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false
# pyright: reportWildcardImportFromLibrary=false

import math
from dataclasses import dataclass

import numpy as np

from laticauda.compiling import compile_scalar, kernel
from laticauda.water.fluid.laws import dry
from laticauda.water.mujoco.table import *
from laticauda.water.mujoco.vectors import (
    cross,
    field,
    numbers,
    plus,
    scaled,
    three,
    times,
    to_own,
    to_world,
)

SINK = 1e-3
"""Depth to which an element that lies flat should sink in under its own weight [m]."""
ROLL = 3.5
"""How much faster friction stops the lowest point of a section than its center, as it may also roll [-]."""


@dataclass(frozen=True, kw_only=True)
class Contact:
    """Ground contact parameters of an element."""

    stiffness: float
    """Stiffness k at each end [N/m]."""
    damping: float
    """Damping beta [s/m]."""
    along: float
    """Friction along the element per normal force: mu_t, or in s/m if viscous [-]."""
    across: float
    """Friction across the element per normal force, with the same units as `along` [-]."""
    regularization_speed: float
    """Regularization speed eps of dry friction; 0 for viscous friction [m/s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Terrain:
    """Flat ground that may end in a slope along x, down to a floor, with optional uneven heights on top."""

    height: float = 0.0
    """Height of the flat ground [m]."""
    edge: float = 0.0
    """x at which the slope begins [m]."""
    slope: float = 0.0
    """Tangent of the slope; 0 if flat everywhere [-]."""
    floor: float = 0.0
    """Height of the floor at the foot of the slope [m]."""
    grid: np.ndarray | None = None
    """Additional heights at nodes, by x and y; bilinear in between, level beyond the edges [m]."""
    corner: tuple[float, float] = (0.0, 0.0)
    """x and y of the first node [m]."""
    cell: tuple[float, float] = (1.0, 1.0)
    """Node spacing along x and y [m]."""

    @property
    def profile(self) -> tuple[float, float, float, float]:
        """Arguments of `terrain` after x."""
        return self.height, self.edge, self.slope, self.floor

    @property
    def nodes(self) -> np.ndarray:
        """The grid for compiled code: corner, cell, numbers of nodes, then their heights; empty if there is no grid."""
        if self.grid is None:
            return np.zeros(0)
        return np.array([*self.corner, *self.cell, *self.grid.shape, *self.grid.ravel()])

    def at(self, x: float, y: float) -> tuple[float, float, float]:
        """Return the height of the ground at `x`, `y` [m], and its downward slopes along both [-].

        Args:
            x: World x coordinate [m].
            y: World y coordinate [m].
        """
        height, fall = terrain(x, *self.profile)
        if self.grid is None:
            return height, fall, 0.0
        more, fall_x, fall_y = uneven(x, y, self.nodes)
        return height + more, fall + fall_x, fall_y


def stable_step(contacts: list[Contact], gravity: float) -> float:
    """Return a step [s] that resolves contacts well: spring and friction of a piece that carries its own weight."""
    rate = math.sqrt(gravity / SINK)
    for contact in contacts:
        friction_rate = ROLL * max(contact.along, contact.across) * gravity
        if contact.regularization_speed > 0.0:
            friction_rate = friction_rate / contact.regularization_speed
        rate = max(rate, friction_rate)
    return 1.0 / rate


def terrain(
    x: float, height: float, edge: float, slope: float, floor: float
) -> tuple[float, float]:
    """Return the height of the ground at x [m] and its downward slope along x [-]; arguments as in `Terrain`."""
    if slope == 0.0 or x <= edge:
        return height, 0.0
    on_slope = height - slope * (x - edge)
    if on_slope > floor:
        return on_slope, slope
    return floor, 0.0


def uneven(x: float, y: float, nodes: np.ndarray) -> tuple[float, float, float]:
    """Return the height that a grid adds at x, y [m], and its downward slopes [-].

    Args:
        x: World x coordinate [m].
        y: World y coordinate [m].
        nodes: Corner, cell and numbers of nodes of the grid along x and y, then their heights, as
            in `Terrain.nodes`.
    """
    n = int(nodes[4])
    m = int(nodes[5])
    u = (x - nodes[0]) / nodes[2]
    v = (y - nodes[1]) / nodes[3]
    in_x = 0.0 <= u <= n - 1.0
    in_y = 0.0 <= v <= m - 1.0
    u = min(max(u, 0.0), n - 1.0)
    v = min(max(v, 0.0), m - 1.0)
    i = min(int(u), n - 2)
    j = min(int(v), m - 2)
    a = u - i
    b = v - j
    k = 6 + i * m + j
    low = nodes[k] + b * (nodes[k + 1] - nodes[k])
    high = nodes[k + m] + b * (nodes[k + m + 1] - nodes[k + m])
    left = nodes[k] + a * (nodes[k + m] - nodes[k])
    right = nodes[k + 1] + a * (nodes[k + m + 1] - nodes[k + 1])
    fall_x = 0.0
    if in_x:
        fall_x = (low - high) / nodes[2]
    fall_y = 0.0
    if in_y:
        fall_y = (left - right) / nodes[3]
    return low + a * (high - low), fall_x, fall_y


def touch(
    depth: float,
    rate: float,
    v_t: float,
    v_n: float,
    k: float,
    beta: float,
    along: float,
    across: float,
    eps: float,
) -> tuple[float, float, float]:
    """Return the forces of the ground on a point: along the piece, across it, and normal to the ground [N].

    Args:
        depth: Penetration depth of the point [m].
        rate: Penetration rate of the point [m/s].
        v_t: Its velocity along the piece, in the plane of the ground [m/s].
        v_n: Its velocity across the piece, in the plane of the ground [m/s].
        k: `Contact.stiffness` [N/m].
        beta: `Contact.damping` [s/m].
        along: `Contact.along`.
        across: `Contact.across`.
        eps: `Contact.regularization_speed` [m/s].
    """
    normal = k * depth * (1.0 + beta * rate)
    if depth <= 0.0 or normal <= 0.0:
        return 0.0, 0.0, 0.0
    c_t = along * normal
    c_n = across * normal
    if eps > 0.0:
        return dry(v_t, c_t, eps), dry(v_n, c_n, eps), normal
    return -c_t * v_t, -c_n * v_n, normal


_terrain = compile_scalar(terrain)
_uneven = compile_scalar(uneven)
_touch = compile_scalar(touch)


@kernel
def ground_load(T, E, o, P, R, place, arm, body, data):
    """Return the force on an element and its torque about the element's center, in world axes.

    Args:
        T: The model's table.
        E: The elements' records.
        o: Start of this element's record.
        P: The water's parameters.
        R: Rotation from element to world axes.
        place: The element's center.
        arm: The element's center relative to the tree's center of mass.
        body: The element's body.
        data: The address of the data.
    """
    cvel = field(data, T[AT.cvel], 6 * T[N_BODIES])
    w = three(cvel, 6 * body)
    v = plus(three(cvel, 6 * body + 3), cross(w, arm))
    force = (0.0, 0.0, 0.0)
    torque = (0.0, 0.0, 0.0)
    for sign in (-1.0, 1.0):
        to_point, normal = lowest_point(T, E, o, P, R, place, sign)
        at = plus(place, to_point)
        depth = (ground_at(T, P, at[0], at[1])[0] - at[2]) * normal[2]
        if depth > 0.0:
            velocity = plus(v, cross(w, to_point))
            push = push_of(E, o, R, depth, velocity, normal)
            force = plus(force, push)
            torque = plus(torque, cross(to_point, push))
    if T[OUT] != 0:
        out = numbers(T[OUT] + WORD * OUT_SIZE * (o // ELEMENT_SIZE), OUT_SIZE)
        for k in range(3):
            out[k] += force[k]
    return force, torque


@kernel
def ground_at(T, P, x, y):
    """Return the height of the ground at a place, and its downward slopes along x and y."""
    height, fall = _terrain(x, *three(P, TERRAIN), P[TERRAIN + 3])
    if T[GRID_SIZE] == 0:
        return height, fall, 0.0
    more, fall_x, fall_y = _uneven(x, y, numbers(T[GRID], T[GRID_SIZE]))
    return height + more, fall + fall_x, fall_y


@kernel
def lowest_point(T, E, o, P, R, place, sign):
    """Return the lowest point of one end section, relative to the element's center, and the ground's normal there."""
    half = three(E, o + HALF)
    x = place[0] + sign * half[0] * R[0]
    y = place[1] + sign * half[0] * R[3]
    _, fall, aside = ground_at(T, P, x, y)
    steep = (1.0 + fall * fall + aside * aside) ** -0.5
    normal = (fall * steep, aside * steep, steep)
    up = to_own(R, normal)
    reach = times((0.0, half[1], half[2]), up)
    size = (reach[1] * reach[1] + reach[2] * reach[2]) ** 0.5 + 1e-12
    own = plus((sign * half[0], 0.0, 0.0), scaled(-1.0 / size, times(half, reach)))
    return to_world(R, own), normal


@kernel
def push_of(E, o, R, depth, v, normal):
    """Return the force on a point in the ground, with friction along and across the element."""
    ahead = to_world(R, (1.0, 0.0, 0.0))
    aside = cross(normal, ahead)
    aside = scaled(1.0 / (length(aside) + 1e-12), aside)
    ahead = cross(aside, normal)
    c = o + CONTACT
    rate = -dot(v, normal)
    v_t = dot(v, ahead)
    v_n = dot(v, aside)
    f_t, f_n, f_z = _touch(depth, rate, v_t, v_n, *three(E, c), E[c + 3], E[c + 4])
    return plus(plus(scaled(f_t, ahead), scaled(f_n, aside)), scaled(f_z, normal))


@kernel
def dot(a, b):
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def length(a):
    """Return |a|."""
    return dot(a, a) ** 0.5
