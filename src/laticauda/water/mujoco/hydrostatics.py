"""Submerged share of a body and its center of buoyancy, for a flat surface.

Plain functions of numbers and of triples along axes, compiled by the kernels. Lengths are in the
element's own axes, `up` is the world's upward direction in these axes, and `depth` is that of the
element's center below the surface. All return the submerged share of the volume and the centroid of
that part.

Ellipsoids, cylinders (elliptic, along x) and boxes are cut in closed form at any attitude. For a
level side the formulas of the latter two are 0/0, so the rise of each side is limited to at least
_LEVEL times that of the body: an error of 1e-5 of the volume, and no jump in value or slope at any
attitude.
"""

import math
from typing import TypeAlias

Three: TypeAlias = tuple[float, float, float]
Four: TypeAlias = tuple[float, float, float, float]
ELLIPSOID = 0
CYLINDER = 1
BOX = 2
_LEVEL = 3e-3
"""Rise of a side over that of the body, below which a side counts as level [-]."""
_TINY = 1e-12
"""Share of the volume, and size [m], that count as none."""


def wetted(shape: float, half: Three, up: Three, depth: float) -> Four:
    """Return the submerged share of the volume [-] and the centroid of that part in element axes [m].

    Args:
        shape: ELLIPSOID, CYLINDER or BOX.
        half: Half the length, width and height [m].
        up: The world's upward direction [-].
        depth: Depth of the element's center [m].
    """
    if shape == ELLIPSOID:
        return _ellipsoid(half, up, depth)
    if shape == CYLINDER:
        return _cylinder(half, up, depth)
    return _box(half, up, depth)


def wetting(
    share: float,
    shape: float,
    half: Three,
    up: Three,
    depth: float,
    turning: Three,
    sinking: float,
    t: float,
) -> float:
    """Return the growth rate of the submerged share over the time ahead, at constant motion of the body [1/s].

    Args:
        share: Submerged share now [-].
        shape: ELLIPSOID, CYLINDER or BOX.
        half: Half the length, width and height [m].
        up: The world's upward direction [-].
        depth: Depth of the element's center [m].
        turning: Angular velocity [rad/s].
        sinking: Rate of change of the depth [m/s].
        t: Time ahead [s].
    """
    z_x, z_y, z_z = up
    w_x, w_y, w_z = turning
    later = (
        z_x + t * (z_y * w_z - z_z * w_y),
        z_y + t * (z_z * w_x - z_x * w_z),
        z_z + t * (z_x * w_y - z_y * w_x),
    )
    later_share, _, _, _ = wetted(shape, half, later, depth + t * sinking)
    return (later_share - share) / t


def _ellipsoid(half: Three, up: Three, depth: float) -> Four:
    """Cut an ellipsoid: the cap of a sphere, stretched."""
    half_x, half_y, half_z = half
    z_x, z_y, z_z = up
    p_x = half_x * z_x
    p_y = half_y * z_y
    p_z = half_z * z_z
    height = math.sqrt(p_x * p_x + p_y * p_y + p_z * p_z)
    s = depth / height
    if s >= 1.0:
        return 1.0, 0.0, 0.0, 0.0
    if s <= -1.0:
        return 0.0, 0.0, 0.0, 0.0
    down = -0.75 * (1.0 - s) * (1.0 - s) / (2.0 - s) / height
    return (
        0.25 * (1.0 + s) * (1.0 + s) * (2.0 - s),
        down * half_x * p_x,
        down * half_y * p_y,
        down * half_z * p_z,
    )


def _cylinder(half: Three, up: Three, depth: float) -> Four:
    """Cut a cylinder: the mean over its length of a stretched circular segment, from s - reach to s + reach."""
    half_x, half_y, half_z = half
    z_x, z_y, z_z = up
    p_y = half_y * z_y
    p_z = half_z * z_z
    height = math.sqrt(p_y * p_y + p_z * p_z) + _TINY
    s = depth / height
    slope = half_x * z_x / height
    reach = math.sqrt(slope * slope + _LEVEL * _LEVEL)
    if s >= 1.0 + reach:
        return 1.0, 0.0, 0.0, 0.0
    if s <= -1.0 - reach:
        return 0.0, 0.0, 0.0, 0.0
    area, first, down = _segments(s + reach)
    area_0, first_0, down_0 = _segments(s - reach)
    share = 0.5 * (area - area_0) / reach
    if share < _TINY:
        return 0.0, 0.0, 0.0, 0.0
    along = -half_x * slope / (reach * reach) * (0.5 * (first - first_0) / reach - s * share)
    across = -0.5 * (down - down_0) / (reach * height)
    return share, along / share, across * half_y * p_y / share, across * half_z * p_z / share


def _segments(s: float) -> tuple[float, float, float]:
    """Return integrals up to s of the unit circle's share A below t, of t A, and of minus that segment's moment."""
    if s <= -1.0:
        return 0.0, 0.0, 0.0
    if s >= 1.0:
        return s, 0.5 * s * s - 0.125, 0.25
    root = math.sqrt(1.0 - s * s)
    angle = math.asin(s) + 0.5 * math.pi
    area = (s * angle + root - root * root * root / 3.0) / math.pi
    first = ((0.5 * s * s - 0.125) * angle + (0.125 + 0.25 * s * s) * s * root) / math.pi
    down = (s * root * root * root / 6.0 + 0.25 * (s * root + angle)) / math.pi
    return area, first, down


def _box(half: Three, up: Three, depth: float) -> Four:
    """Cut a box: its height is the sum of three uniform variables, distributed as a sum over the eight corners."""
    half_x, half_y, half_z = half
    z_x, z_y, z_z = up
    p_x = half_x * z_x
    p_y = half_y * z_y
    p_z = half_z * z_z
    least = _LEVEL * math.sqrt(p_x * p_x + p_y * p_y + p_z * p_z)
    a_x = math.sqrt(p_x * p_x + least * least)
    a_y = math.sqrt(p_y * p_y + least * least)
    a_z = math.sqrt(p_z * p_z + least * least)
    if abs(depth) >= a_x + a_y + a_z:
        if depth > 0.0:
            return 1.0, 0.0, 0.0, 0.0
        return 0.0, 0.0, 0.0, 0.0
    # The dry part, if at least half of the box is submerged, else the wet one.
    share = 0.0
    x = 0.0
    y = 0.0
    z = 0.0
    for corner in range(8):
        e_x = 2 * (corner & 1) - 1
        e_y = (corner & 2) - 1
        e_z = (corner & 4) // 2 - 1
        under = e_x * a_x + e_y * a_y + e_z * a_z - abs(depth)
        if under > 0.0:
            cube = e_x * e_y * e_z * under * under * under / (48.0 * a_x * a_y * a_z)
            share += cube
            x += cube * (0.25 * under - e_x * a_x)
            y += cube * (0.25 * under - e_y * a_y)
            z += cube * (0.25 * under - e_z * a_z)
    if depth >= 0.0:
        share = 1.0 - share
    if share < _TINY:
        return 0.0, 0.0, 0.0, 0.0
    x = x * half_x * p_x / (a_x * a_x)
    y = y * half_y * p_y / (a_y * a_y)
    z = z * half_z * p_z / (a_z * a_z)
    return share, x / share, y / share, z / share
