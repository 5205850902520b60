"""How much of a body is under water, and where its center of buoyancy is, for a flat surface.

Plain scalar functions, which the kernels compile. Lengths are in the element's own axes, `z_x, z_y, z_z` is the world's
upward direction in them, and `depth` is that of the element's middle below the surface. All return the share of the
volume that is under water and the centroid of that part. Ellipsoids are exact at any attitude. Cylinders (elliptic,
along x) and boxes are cut into slices along x: exact for a level axis, and when covered; else the step from slice to
slice is smoothed over a slice's own height. All are continuous in depth and attitude.
"""

import math

ELLIPSOID, CYLINDER, BOX = range(3)
N_SLICES = 8
_TINY = 1e-12


def wetted(
    shape: float,
    half_x: float,
    half_y: float,
    half_z: float,
    z_x: float,
    z_y: float,
    z_z: float,
    depth: float,
) -> tuple[float, float, float, float]:
    """Share of the volume under water [-] and its centroid in element axes [m].

    Args:
        shape: ELLIPSOID, CYLINDER or BOX.
        half_x: Half the length [m].
        half_y: Half the width [m].
        half_z: Half the height [m].
        z_x: Upward direction along x [-].
        z_y: Upward direction along y [-].
        z_z: Upward direction along z [-].
        depth: Of the element's middle [m].
    """
    if shape == ELLIPSOID:
        return _ellipsoid(half_x, half_y, half_z, z_x, z_y, z_z, depth)
    share, x, y, z = 0.0, 0.0, 0.0, 0.0
    half_slice = half_x / N_SLICES
    blur = abs(z_x) * half_slice
    for i in range(N_SLICES):
        at = (2 * i + 1) * half_slice - half_x
        if shape == CYLINDER:
            part, y_part, z_part = _ellipse(half_y, half_z, z_y, z_z, depth - at * z_x, blur)
        else:
            part, y_part, z_part = _rectangle(half_y, half_z, z_y, z_z, depth - at * z_x, blur)
        share += part
        x += part * at
        y += y_part
        z += z_part
    if share < _TINY:
        return 0.0, 0.0, 0.0, 0.0
    return share / N_SLICES, x / share, y / share, z / share


def _ellipsoid(
    half_x: float, half_y: float, half_z: float, z_x: float, z_y: float, z_z: float, depth: float
) -> tuple[float, float, float, float]:
    """The cap of a sphere, stretched."""
    p_x, p_y, p_z = half_x * z_x, half_y * z_y, half_z * z_z
    height = math.sqrt(p_x * p_x + p_y * p_y + p_z * p_z)
    s = depth / height
    if s >= 1.0:
        return 1.0, 0.0, 0.0, 0.0
    if s <= -1.0:
        return 0.0, 0.0, 0.0, 0.0
    down = -0.75 * (1.0 - s) * (1.0 - s) / (2.0 - s) / height
    return 0.25 * (1.0 + s) * (1.0 + s) * (2.0 - s), down * half_x * p_x, down * half_y * p_y, down * half_z * p_z


def _ellipse(
    half_y: float, half_z: float, z_y: float, z_z: float, depth: float, blur: float
) -> tuple[float, float, float]:
    """Share of an ellipse's area under water and that share's moments: the segment of a circle, stretched."""
    p_y, p_z = half_y * z_y, half_z * z_z
    height = math.sqrt(p_y * p_y + p_z * p_z)
    s = depth / (height + blur + _TINY)
    if s >= 1.0:
        return 1.0, 0.0, 0.0
    if s <= -1.0:
        return 0.0, 0.0, 0.0
    root = math.sqrt(1.0 - s * s)
    share = 1.0 - (math.acos(s) - s * root) / math.pi
    down = -2.0 / (3.0 * math.pi) * root * root * root / (height + _TINY)
    return share, down * half_y * p_y, down * half_z * p_z


def _rectangle(
    half_y: float, half_z: float, z_y: float, z_z: float, depth: float, blur: float
) -> tuple[float, float, float]:
    """Share of a rectangle's area under water and that share's moments.

    Over the rectangle, the height is the sum of two uniform variables; the share is the distribution of that sum.
    """
    p, q = half_y * abs(z_y) + 0.5 * blur + _TINY, half_z * abs(z_z) + 0.5 * blur + _TINY
    if depth >= p + q:
        return 1.0, 0.0, 0.0
    if depth <= -p - q:
        return 0.0, 0.0, 0.0
    most, least = max(p, q), min(p, q)
    size = abs(depth)
    if size <= most - least:
        below = 0.5 + 0.5 * size / most
    else:
        rest = most + least - size
        below = 1.0 - rest * rest / (8.0 * most * least)
    share = below if depth >= 0.0 else 1.0 - below
    y = half_y * _first_moment(p, q, depth) / p * (1.0 if z_y >= 0.0 else -1.0)
    z = half_z * _first_moment(q, p, depth) / q * (1.0 if z_z >= 0.0 else -1.0)
    return share, y, z


def _first_moment(p: float, q: float, depth: float) -> float:
    """Mean of u where u + v <= depth, else 0, for u and v uniform within p and q."""
    q = max(q, 1e-6 * p)
    return (_moment_integral(p, depth + q) - _moment_integral(p, depth - q)) / (2.0 * q)


def _moment_integral(p: float, c: float) -> float:
    """Integral from -p to c of the mean of u where u <= t."""
    if c <= -p:
        return 0.0
    if c >= p:
        c = p
    return ((c * c / 3.0 - p * p) * c - 2.0 / 3.0 * p * p * p) / (4.0 * p)
