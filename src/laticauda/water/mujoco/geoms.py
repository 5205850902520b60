"""Elements fitted to the geoms of a model, where there are shapes but no measured coefficients."""

import math
import warnings
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from laticauda.values import (
    BadArgument,
    check_instance,
    check_positive,
    from_quaternion,
    load_mujoco,
    option,
    quantity,
    value_class,
)
from laticauda.water.fluid.laws import DragLaw, PolynomialDrag
from laticauda.water.mujoco.elements import Element, Quaternion, Shape, Three
from laticauda.water.mujoco.mesh_shapes import fit_mesh, read_mesh, volume_of
from laticauda.water.mujoco.shape_drag import drag_across_rod, drag_along_rod, drag_of_box
from laticauda.water.mujoco.shape_mass import AddedMass, MassShape, added_mass

DISK = math.pi / 4.0
"""Area of a circle over that of the square around it [-]."""
BALL = math.pi / 6.0
"""Volume of a ball over that of the cube around it [-]."""
COSINE_45 = 0.5**0.5
"""Cosine and sine of 45 deg: half of the angle from MuJoCo's cylinders, along z, to ours, along x [-]."""
UNTURNED: Quaternion = (1.0, 0.0, 0.0, 0.0)
"""Axes of a shape whose axes are the geom's."""
ALONG_Z: Quaternion = (COSINE_45, 0.0, -COSINE_45, 0.0)
"""Axes of a shape whose x axis is the geom's z axis."""
TOLERATED_OVERLAP = 0.1
"""Share of a geom that may lie in larger ones without a warning [-]."""
LARGEST_OVERLAP = 0.5
"""Share of a geom in larger ones beyond which it is left out [-]."""
POINTS_PER_SIDE = 12
"""Points along each axis of the box in which an element is filled with points."""


@value_class
class GeomCoefficients:
    """Dimensionless coefficients that turn a geom into an `Element`; areas are those of the geom's projections.

    Added mass and inertia are shares of those of the geom's own shape in unbounded water.
    """

    drag: Three = quantity(
        "", "C_D along the geom's axes, on the projected area", default=(0.2, 1.0, 1.0), ge=0.0
    )
    rotational_drag: float = quantity(
        "", "Share of the rotational drag that `drag` implies", default=0.0, ge=0.0
    )
    added_mass: float = quantity(
        "", "Share of what the shape has in unbounded water", default=1.0, ge=0.0
    )
    law: DragLaw = option(
        "Drag versus speed; quadratic if omitted", default=PolynomialDrag(reference_speed=0.0)
    )


def geom_element(
    model: Any,
    geom: str | int,
    coefficients: GeomCoefficients | None = None,
    *,
    density: float = 1000.0,
) -> Element:
    """Return the element that fits a geom: a sphere, capsule, ellipsoid, cylinder, box or mesh.

    Added mass and inertia are those of the shape in unbounded water. A mesh that is a box or a
    cylinder counts as one; any other as the ellipsoid with its moments of inertia and its own
    volume.

    Args:
        model: A `mujoco.MjModel`.
        geom: Its name or number.
        coefficients: Coefficients of the geom; None: the usual ones of such a shape, from a
            handbook of drag, including rotational drag.
        density: Density rho of the water [kg/m^3].

    Raises:
        ValueError: If there is no such geom, it has no volume, or it is of another type.
    """
    mujoco = load_mujoco()
    check_positive("density", density, "kg/m^3")
    number = _number_of_geom(model, geom)
    fit = _fit_shape(model, number)
    half = fit.half_size
    if coefficients is None:
        coefficients = _usual_coefficients(fit.mass_shape, half)
    volume = fit.share_of_box * 8.0 * half[0] * half[1] * half[2]
    loads = _added_mass_of(fit, volume)
    share_of_mass = coefficients.added_mass * density
    areas = _projected_areas(fit.shape, half)
    drag = [0.5 * density * k * area for k, area in zip(coefficients.drag, areas, strict=True)]
    spread = coefficients.rotational_drag
    axes = np.zeros(4)
    mujoco.mju_mulQuat(axes, model.geom_quat[number], np.array(fit.axes))
    body = int(model.geom_bodyid[number])
    offset = from_quaternion(*model.geom_quat[number]) @ fit.center
    return Element(
        body=model.body(body).name or str(body),
        position=_three(model.geom_pos[number] + offset),
        orientation=(axes[0], axes[1], axes[2], axes[3]),
        drag=_three(drag),
        torque_linear=_three(spread * _moment_about(i, drag, half, 2) / 3.0 for i in range(3)),
        torque_quadratic=_three(spread * _moment_about(i, drag, half, 3) / 4.0 for i in range(3)),
        added_mass=_three(share_of_mass * loads.mass),
        added_inertia=_three(share_of_mass * loads.inertia),
        volume=volume,
        shape=fit.shape,
        half_size=half,
        law=coefficients.law,
    )


def geom_elements(
    model: Any, coefficients: GeomCoefficients | None = None, *, density: float = 1000.0
) -> tuple[Element, ...]:
    """Return elements for all geoms that displace water: the default of `attach`.

    Excluded are geoms of bodies that cannot move; planes and height fields; if a body has geoms
    that can collide, those that cannot, as they are visual; and, both with a warning, geoms that
    lie mostly in larger ones of their body, or that have no volume.

    Args:
        model: A `mujoco.MjModel`.
        coefficients: Coefficients of all geoms; None: the usual ones of each shape.
        density: Density rho of the water [kg/m^3].

    Raises:
        ValueError: If no geom is left.
    """
    check_positive("density", density, "kg/m^3")
    check_instance("model", getattr(model, "ptr", model), load_mujoco().MjModel)
    pieces_by_body: dict[int, list[_Piece]] = {}
    empty: list[str] = []
    for number in _displacing_geoms(model):
        name = _name_of_geom(model, number)
        try:
            element = geom_element(model, number, coefficients, density=density)
        except BadArgument:
            empty.append(f"`{name}`")
            continue
        body = int(model.geom_bodyid[number])
        pieces_by_body.setdefault(body, []).append(_Piece(name, element))
    if empty:
        warnings.warn(f"geoms without volume get no water: {', '.join(empty)}", stacklevel=3)
    elements: list[Element] = []
    for pieces in pieces_by_body.values():
        elements.extend(_without_overlaps(pieces))
    if not elements:
        raise BadArgument("model", "must have a geom with a volume on a body that can move")
    return tuple(elements)


class _Piece(NamedTuple):
    """A geom of a body, as an element."""

    name: str
    """Name of the geom, for messages."""
    element: Element


class _FittedShape(NamedTuple):
    """The shape of an element that fits a geom."""

    shape: Shape
    """Shape cut by the surface."""
    mass_shape: MassShape
    """Shape whose added mass it has."""
    half_size: Three
    """Half the length, width and height of the shape [m]."""
    share_of_box: float
    """The geom's volume over that of the box around the shape [-]."""
    center: np.ndarray
    """Center of the shape, in the geom's axes [m]."""
    axes: Quaternion
    """Axes of the shape, in the geom's axes."""


def _number_of_geom(model: Any, geom: str | int) -> int:
    if isinstance(geom, str):
        mujoco = load_mujoco()
        number = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, geom))
    else:
        number = geom
    if not 0 <= number < model.ngeom:
        raise BadArgument("geom", f"must be a geom of the model, got {geom!r}")
    return number


def _displacing_geoms(model: Any) -> list[int]:
    """Return the geoms that displace water, see `geom_elements`."""
    can_collide = (model.geom_contype | model.geom_conaffinity) != 0
    numbers: list[int] = []
    for number, body in enumerate(model.geom_bodyid):
        is_fixed = model.body_weldid[body] == 0
        body_collides = np.any(can_collide[model.geom_bodyid == body])
        is_visual = not can_collide[number] and body_collides
        is_flat = _kind_of_geom(model, number) in ("plane", "hfield")
        if not (is_fixed or is_visual or is_flat):
            numbers.append(number)
    return numbers


def _without_overlaps(pieces: list[_Piece]) -> list[Element]:
    """Return the elements of one body that do not lie in larger ones, with warnings about overlaps."""
    accepted: list[_Piece] = []
    for piece in sorted(pieces, key=lambda piece: -piece.element.volume):
        element = piece.element
        points: np.ndarray = element.position + _points_in(element) @ element.rotation.T
        inside = [_contains(larger.element, points) for larger in accepted]
        is_covered = np.any(np.array(inside).reshape(-1, len(points)), axis=0)
        share = float(is_covered.mean())
        if share > TOLERATED_OVERLAP:
            larger_names = ", ".join(
                f"`{larger.name}`"
                for larger, within in zip(accepted, inside, strict=True)
                if np.any(within)
            )
            _warn_of_overlap(piece.name, larger_names, share)
        if share <= LARGEST_OVERLAP:
            accepted.append(piece)
    return [piece.element for piece in accepted]


def _warn_of_overlap(name: str, larger_names: str, share: float) -> None:
    consequence = "displaces that much water twice"
    if share > LARGEST_OVERLAP:
        consequence = "is left out of the water"
    warnings.warn(
        f"geom `{name}` overlaps {larger_names} by {100 * share:.0f} %: it {consequence}",
        stacklevel=4,
    )


def _points_in(element: Element) -> np.ndarray:
    """Return points that fill the element evenly, in its own axes [m]."""
    side = (np.arange(POINTS_PER_SIDE) + 0.5) / (0.5 * POINTS_PER_SIDE) - 1.0
    cube = np.stack(np.meshgrid(side, side, side), axis=-1).reshape(-1, 3)
    points = cube * element.half_size
    in_own_axes = Element(body="", shape=element.shape, half_size=element.half_size)
    return points[_contains(in_own_axes, points)]


def _contains(element: Element, points: np.ndarray) -> np.ndarray:
    """Return which points, in the body's frame, lie in an element."""
    own = np.abs((points - element.position) @ element.rotation) / element.half_size
    x, y, z = own.T
    if element.shape == "box":
        return (x < 1.0) & (y < 1.0) & (z < 1.0)
    if element.shape == "ellipsoid":
        return y**2 + z**2 + x**2 < 1.0
    return (y**2 + z**2 < 1.0) & (x <= 1.0)


def _added_mass_of(fit: _FittedShape, volume: float) -> AddedMass:
    """Return added mass and inertia of a fitted shape for water of 1 kg/m^3; an ellipsoid's go with the volume."""
    loads = added_mass(fit.mass_shape, fit.half_size)
    if fit.mass_shape != "ellipsoid":
        return loads
    of_ellipsoid = BALL * 8.0 * math.prod(fit.half_size)
    share = volume / of_ellipsoid
    return AddedMass(mass=share * loads.mass, inertia=share * loads.inertia)


def _usual_coefficients(shape: MassShape, half: Three) -> GeomCoefficients:
    """Return the drag of shapes that move along an axis; an ellipsoid's from plate (1.17) to sphere to slender body."""
    x, y, z = (_drag_of_ellipsoid(half, i) for i in range(3))
    if shape == "box":
        x, y, z = (drag_of_box(half, i) for i in range(3))
    elif shape != "ellipsoid":
        slenderness = half[0] / half[1]
        y = drag_across_rod(slenderness)
        z = y
        if shape == "cylinder":
            x = drag_along_rod(slenderness)
    return GeomCoefficients(drag=(x, y, z), rotational_drag=1.0)


def _drag_of_ellipsoid(half: Three, axis: int) -> float:
    """Return C_D along an axis, from the length over the mean of both widths."""
    slenderness = half[axis] / math.sqrt(half[(axis + 1) % 3] * half[(axis + 2) % 3])
    return 1.17 / (1.0 + 1.5 * slenderness)


def _projected_areas(shape: Shape, half: Three) -> Three:
    """Return the areas that a shape shows along its axes [m^2]."""
    round_ends = DISK
    round_sides = DISK
    if shape == "box":
        round_ends = 1.0
    if shape in ("box", "cylinder"):
        round_sides = 1.0
    return (
        4.0 * round_ends * half[1] * half[2],
        4.0 * round_sides * half[0] * half[2],
        4.0 * round_sides * half[0] * half[1],
    )


def _name_of_geom(model: Any, number: int) -> str:
    return model.geom(number).name or f"geom {number}"


def _kind_of_geom(model: Any, number: int) -> str:
    """Return MuJoCo's name of a geom's type, e.g. `capsule`."""
    return load_mujoco().mjtGeom(model.geom_type[number]).name.removeprefix("mjGEOM_").lower()


def _fit_shape(model: Any, number: int) -> _FittedShape:
    """Return the shape that fits a geom."""
    kind = _kind_of_geom(model, number)
    if kind in ("mesh", "sdf"):
        return _fit_mesh(model, number)
    fit = _fit_plain_shape(kind, _three(model.geom_size[number]))
    if fit is None:
        rule = "must be a sphere, capsule, ellipsoid, cylinder, box or mesh"
        raise BadArgument("geom", f"{rule}, got `{_name_of_geom(model, number)}`, a {kind}")
    if not min(fit.half_size) > 0.0:
        size = [*_three(model.geom_size[number])]
        name = _name_of_geom(model, number)
        raise BadArgument("geom", f"must have a volume, got `{name}`, whose size is {size}")
    return fit


def _fit_plain_shape(kind: str, size: Three) -> _FittedShape | None:
    """Return the shape that is a geom's own; None: it has none.

    Args:
        kind: MuJoCo's name of the geom's type.
        size: The geom's size; radius first, then half the length of a cylinder or capsule [m].
    """
    x, y, _ = size
    axes = UNTURNED
    shape: Shape = "ellipsoid"
    mass_shape: MassShape = "ellipsoid"
    half = size
    share = BALL
    if kind == "sphere":
        half = (x, x, x)
    elif kind == "box":
        shape = "box"
        mass_shape = "box"
        share = 1.0
    elif kind == "cylinder":
        shape = "cylinder"
        mass_shape = "cylinder"
        half = (y, x, x)
        share = DISK
        axes = ALONG_Z
    elif kind == "capsule":
        shape = "cylinder"
        mass_shape = "capsule"
        half = (y + x, x, x)
        share = (DISK * y + BALL * x) / (y + x or 1.0)
        axes = ALONG_Z
    elif kind != "ellipsoid":
        return None
    return _FittedShape(
        shape=shape,
        mass_shape=mass_shape,
        half_size=half,
        share_of_box=share,
        center=np.zeros(3),
        axes=axes,
    )


def _fit_mesh(model: Any, number: int) -> _FittedShape:
    """Return the shape that a mesh is, or the ellipsoid with its moments."""
    mesh = read_mesh(model, number)
    if volume_of(mesh) == 0.0:
        name = _name_of_geom(model, number)
        rule = f"must have a volume, got `{name}`, whose mesh has none of note"
        raise BadArgument("geom", rule)
    fit = fit_mesh(mesh)
    cut_as: Shape = "ellipsoid"
    if fit.shape in ("box", "cylinder"):
        cut_as = fit.shape
    return _FittedShape(
        shape=cut_as,
        mass_shape=fit.shape,
        half_size=fit.half_size,
        share_of_box=fit.volume / (8.0 * math.prod(fit.half_size)),
        center=fit.center,
        axes=fit.axes,
    )


def _moment_about(i: int, drag: Sequence[float], half: Three, power: int) -> float:
    """Return the moment about axis i of the drags along the other two axes, each spread along the other one."""
    j = (i + 1) % 3
    k = (i + 2) % 3
    return drag[j] * half[k] ** power + drag[k] * half[j] ** power


def _three(values: Iterable[Any]) -> Three:
    x, y, z = (float(value) for value in values)
    return x, y, z
