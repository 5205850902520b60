"""Elements: pieces of a body in water, with drag, added mass and displaced volume in their own axes.

Where there are shapes but no measured coefficients, elements can be fitted to the geoms of a model.
"""

import math
import warnings
from collections.abc import Iterable, Sequence
from typing import Any, Literal, TypeAlias

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
from laticauda.water.mujoco.ground import Contact

Three: TypeAlias = tuple[float, float, float]
Quaternion: TypeAlias = tuple[float, float, float, float]
Shape: TypeAlias = Literal["ellipsoid", "cylinder", "box"]
_NONE: Three = (0.0, 0.0, 0.0)


@value_class
class Element:
    """Loads on one piece of a body. A body may have several; different kinds of drag take several at one place.

    With u the velocity of the element's center relative to the water and w its angular velocity,
    along each of its axes and for the default `law`,

        f = -c u |u|        tau = -lambda_3 |w| w

    At a trailing edge Lighthill's force is m'/2 u_y^2 along x and -m' u_x u_y along y. A `plate` is
    upright with its chord along x, and its numbers are the last five arguments of
    `laticauda.water.fluid.laws.plate`. Without a surface, `half_size` is not used.

    Raises:
        ValueError: If a field is out of range.
    """

    body: str = option(
        "Name of the MuJoCo body that it is fixed to; of an unnamed body its number, e.g. '2'"
    )
    position: Three = quantity("m", "Its middle in the body's frame", default=_NONE)
    orientation: Quaternion = quantity(
        "", "Its axes in the body's frame (w, x, y, z)", default=(1.0, 0.0, 0.0, 0.0)
    )
    drag: Three = quantity("N s^2/m^2", "c along x, y and z", default=_NONE, ge=0.0)
    torque_linear: Three = quantity("N s^2", "lambda_2 about x, y and z", default=_NONE, ge=0.0)
    torque_quadratic: Three = quantity(
        "N m s^2", "lambda_3 about x, y and z", default=_NONE, ge=0.0
    )
    added_mass: Three = quantity("kg", "Along x, y and z", default=_NONE, ge=0.0)
    added_inertia: Three = quantity(
        "kg m^2", "About x, y and z through the middle", default=_NONE, ge=0.0
    )
    thrust: Three = quantity(
        "N", "Constant force along x, y and z, e.g. of a thruster", default=_NONE
    )
    pull: Three = quantity("N", "Constant force in world axes, e.g. of a tether", default=_NONE)
    tether_drag: float = quantity("kg/m", "k of a force -k |u| u", default=0.0, ge=0.0)
    wake_mass: float = quantity(
        "kg/m", "m' of Lighthill's force at a trailing edge while u_x > 0", default=0.0, ge=0.0
    )
    plate: tuple[float, float, float, float, float] | None = quantity(
        "",
        "An upright plate with its chord along x: the last five arguments of `laticauda.water.fluid.laws.plate`",
        default=None,
        ge=0.0,
    )
    contact: Contact | None = option(
        "Contact with the ground of `water.attach`; None: no contact", default=None
    )
    volume: float = quantity(
        "m^3", "Volume of water that it displaces when submerged", default=0.0, ge=0.0
    )
    shape: Shape = option(
        "Shape cut by the surface; a cylinder is elliptic, with axis along x", default="ellipsoid"
    )
    half_size: Three = quantity(
        "m", "Half the length, width and height of the shape", default=(0.1, 0.1, 0.1), gt=0.0
    )
    law: DragLaw = option(
        "Drag versus speed; quadratic if omitted", default=PolynomialDrag(reference_speed=0.0)
    )

    def __post_init__(self) -> None:
        """Normalize the quaternion."""
        norm = math.sqrt(sum(q * q for q in self.orientation))
        if norm < 1e-6:
            raise BadArgument(
                "orientation", f"must be a quaternion that is not zero, got {self.orientation}"
            )
        w, x, y, z = (q / norm for q in self.orientation)
        object.__setattr__(self, "orientation", (w, x, y, z))

    @property
    def rotation(self) -> np.ndarray:
        """Rotation from its axes to the body's, (3, 3)."""
        return from_quaternion(*self.orientation)


_ROUND = math.pi / 4.0  # area of a circle over that of the square around it
_HALF_TURN = 0.5**0.5


@value_class
class GeomCoefficients:
    """Dimensionless coefficients that turn a geom into an `Element`; areas are those of the geom's projections.

    Added mass and inertia are shares of those of the fitted ellipsoid (Lamb, 1932, art. 114 and
    115).
    """

    drag: Three = quantity(
        "", "C_D along the geom's axes, on the projected area", default=(0.2, 1.0, 1.0), ge=0.0
    )
    rotational_drag: float = quantity(
        "", "Share of the rotational drag that `drag` implies", default=0.0, ge=0.0
    )
    added_mass: float = quantity(
        "", "Share of that of the fitted ellipsoid (Lamb)", default=1.0, ge=0.0
    )
    law: DragLaw = option(
        "Drag versus speed; quadratic if omitted", default=PolynomialDrag(reference_speed=0.0)
    )


def lamb(half_size: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Return added mass and inertia of an ellipsoid in unbounded water, relative to the displaced mass.

    Args:
        half_size: Half-axes [m].

    Returns:
        k_i = alpha_i / (2 - alpha_i) [-], and the added inertia over the displaced mass [m^2], per
        axis.

    References:
        H. Lamb, Hydrodynamics, 6th ed., Cambridge 1932, art. 114 and 115.
    """
    a = np.asarray(half_size, dtype=float)
    # alpha_i = abc int_0^inf dt / ((a_i^2 + t) Delta), with t = s^2 x^2 / (1 - x)^2 for Gauss' rule
    # on (0, 1)
    node, weight = np.polynomial.legendre.leggauss(200)
    x = 0.5 * (node + 1.0)
    scale = float(np.prod(a)) ** (2.0 / 3.0)
    t = scale * (x / (1.0 - x)) ** 2
    dt = scale * 2.0 * x / (1.0 - x) ** 3 * 0.5 * weight
    delta = np.sqrt(np.prod(a[:, np.newaxis] ** 2 + t, axis=0))
    alpha = np.prod(a) * np.sum(dt / ((a[:, np.newaxis] ** 2 + t) * delta), axis=1)
    inertia = np.zeros(3)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        b, c = a[j] ** 2, a[k] ** 2
        if abs(b - c) > 1e-12 * (b + c):
            gap = alpha[k] - alpha[j]
            inertia[i] = 0.2 * (b - c) ** 2 * gap / (2.0 * (b - c) + (b + c) * -gap)
    return alpha / (2.0 - alpha), inertia


def geom_element(
    model: Any,
    geom: str | int,
    coefficients: GeomCoefficients | None = None,
    *,
    density: float = 1000.0,
) -> Element:
    """Return the element that fits a geom: a sphere, capsule, ellipsoid, cylinder, box or mesh.

    A mesh is represented by the ellipsoid with its moments of inertia, and keeps its own volume.

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
    number = (
        mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, geom) if isinstance(geom, str) else geom
    )
    if not 0 <= number < model.ngeom:
        raise BadArgument("geom", f"must be a geom of the model, got {geom!r}")
    kind, shape, half, share_of_box, middle, turn = _fitted(model, number)
    coefficients = coefficients or _usual(kind, half)
    volume = share_of_box * 8.0 * half[0] * half[1] * half[2]
    share, turning = lamb(half)
    mass = coefficients.added_mass * density * volume
    round_ends, round_sides = (
        (1.0, 1.0) if shape == "box" else (_ROUND, 1.0 if shape == "cylinder" else _ROUND)
    )
    area = (
        4.0 * round_ends * half[1] * half[2],
        4.0 * round_sides * half[0] * half[2],
        4.0 * round_sides * half[0] * half[1],
    )
    c = [0.5 * density * k * a for k, a in zip(coefficients.drag, area, strict=True)]
    spread, axes = coefficients.rotational_drag, np.zeros(4)
    mujoco.mju_mulQuat(axes, model.geom_quat[number], np.array(turn))
    return Element(
        body=model.body(body := int(model.geom_bodyid[number])).name or str(body),
        position=_three(
            model.geom_pos[number] + from_quaternion(*model.geom_quat[number]) @ middle
        ),
        orientation=(axes[0], axes[1], axes[2], axes[3]),
        drag=_three(c),
        torque_linear=_three(spread * _about(i, c, half, 2) / 3.0 for i in range(3)),
        torque_quadratic=_three(spread * _about(i, c, half, 3) / 4.0 for i in range(3)),
        added_mass=_three(mass * k for k in share),
        added_inertia=_three(mass * k for k in turning),
        volume=volume,
        shape=shape,
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
    check_instance("model", getattr(model, "ptr", model), load_mujoco().MjModel)
    found: dict[int, list[tuple[str, Element]]] = {}
    empty: list[str] = []
    touching = (model.geom_contype | model.geom_conaffinity) != 0
    for i, body in enumerate(model.geom_bodyid):
        seen_only = not touching[i] and np.any(touching[model.geom_bodyid == body])
        if model.body_weldid[body] == 0 or seen_only or _kind(model, i) in ("plane", "hfield"):
            continue
        try:
            found.setdefault(int(body), []).append(
                (_name(model, i), geom_element(model, i, coefficients, density=density))
            )
        except BadArgument:
            empty.append(f"`{_name(model, i)}`")
    if empty:
        warnings.warn(f"geoms without volume get no water: {', '.join(empty)}", stacklevel=3)
    elements = tuple(element for pieces in found.values() for element in _apart(pieces))
    if not elements:
        raise BadArgument("model", "must have a geom with a volume on a body that can move")
    return elements


def _apart(pieces: list[tuple[str, Element]]) -> list[Element]:
    """Return the elements of one body that do not lie in larger ones, with warnings about overlaps."""
    kept: list[tuple[str, Element]] = []
    for name, element in sorted(pieces, key=lambda piece: -piece[1].volume):
        points: np.ndarray = element.position + _filling(element) @ element.rotation.T
        inside = np.array([_contains(other, points) for _, other in kept]).reshape(-1, len(points))
        share = float(np.any(inside, axis=0).mean())
        if share > 0.1:
            others = ", ".join(
                f"`{other}`"
                for (other, _), within in zip(kept, inside, strict=True)
                if np.any(within)
            )
            what = "is left out of the water" if share > 0.5 else "displaces that much water twice"
            warnings.warn(
                f"geom `{name}` overlaps {others} by {100 * share:.0f} %: it {what}", stacklevel=4
            )
        if share <= 0.5:
            kept.append((name, element))
    return [element for _, element in kept]


def _filling(element: Element) -> np.ndarray:
    """Return points that fill the element evenly, in its own axes [m]."""
    side = (np.arange(12) + 0.5) / 6.0 - 1.0
    points = np.stack(np.meshgrid(side, side, side), axis=-1).reshape(-1, 3) * element.half_size
    own = Element(body="", shape=element.shape, half_size=element.half_size)
    return points[_contains(own, points)]


def _contains(element: Element, points: np.ndarray) -> np.ndarray:
    """Return which points, in the body's frame, lie in an element."""
    x, y, z = (np.abs((points - element.position) @ element.rotation) / element.half_size).T
    if element.shape == "box":
        return (x < 1.0) & (y < 1.0) & (z < 1.0)
    return y**2 + z**2 + (x**2 if element.shape == "ellipsoid" else x > 1.0) < 1.0


def _usual(kind: str, half: Three) -> GeomCoefficients:
    """Return the drag of shapes that move along an axis; an ellipsoid's from plate (1.17) to sphere to slender body."""
    slender = [h / math.sqrt(half[(i + 1) % 3] * half[(i + 2) % 3]) for i, h in enumerate(half)]
    x, y, z = (1.17 / (1.0 + 1.5 * f) for f in slender)
    drag = {"box": (1.05, 1.05, 1.05), "cylinder": (0.87, 0.74, 0.74), "capsule": (x, 0.74, 0.74)}
    return GeomCoefficients(drag=drag.get(kind, (x, y, z)), rotational_drag=1.0)


def _name(model: Any, number: int) -> str:
    return model.geom(number).name or f"geom {number}"


def _kind(model: Any, number: int) -> str:
    return load_mujoco().mjtGeom(model.geom_type[number]).name.removeprefix("mjGEOM_").lower()


def _fitted(model: Any, number: int) -> tuple[str, Shape, Three, float, np.ndarray, Quaternion]:
    """Return a geom's kind, shape, half size, share of its bounding box, and the position and axes of its center."""
    kind = _kind(model, number)
    x, y, z = _three(model.geom_size[number])
    straight = (1.0, 0.0, 0.0, 0.0)
    along_z = (
        _HALF_TURN,
        0.0,
        -_HALF_TURN,
        0.0,
    )  # MuJoCo's cylinders have their axis along z, ours along x
    ball = math.pi / 6.0
    fitted: dict[str, tuple[Shape, Three, float, Quaternion]] = {
        "sphere": ("ellipsoid", (x, x, x), ball, straight),
        "ellipsoid": ("ellipsoid", (x, y, z), ball, straight),
        "box": ("box", (x, y, z), 1.0, straight),
        "cylinder": ("cylinder", (y, x, x), _ROUND, along_z),
        "capsule": ("cylinder", (y + x, x, x), (_ROUND * y + ball * x) / (y + x or 1.0), along_z),
    }
    if kind in ("mesh", "sdf"):
        return _mesh(model, number)
    if kind not in fitted:
        raise BadArgument(
            "geom",
            f"must be a sphere, capsule, ellipsoid, cylinder, box or mesh, got `{_name(model, number)}`, a {kind}",
        )
    shape, half, share, turn = fitted[kind]
    if not min(half) > 0.0:
        raise BadArgument(
            "geom", f"must have a volume, got `{_name(model, number)}`, whose size is {[x, y, z]}"
        )
    return kind, shape, half, share, np.zeros(3), turn


def _mesh(model: Any, number: int) -> tuple[str, Shape, Three, float, np.ndarray, Quaternion]:
    """Fit the ellipsoid with the moments of a mesh, summed over tetrahedra from the origin to its faces."""
    mesh = model.geom_dataid[number]
    vertices, faces = model.mesh_vertadr[mesh], model.mesh_faceadr[mesh]
    points = model.mesh_vert[vertices : vertices + model.mesh_vertnum[mesh]].astype(float)
    corners = points[model.mesh_face[faces : faces + model.mesh_facenum[mesh]]]
    share: np.ndarray = np.linalg.det(corners) / 6.0
    volume, total = float(share.sum()), corners.sum(axis=1)
    if not volume > 1e-6 * math.prod(np.ptp(points, axis=0).tolist()):
        raise BadArgument(
            "geom",
            f"must have a volume, got `{_name(model, number)}`, whose mesh has {volume:g} m^3",
        )
    middle = share @ total / 4.0 / volume
    second = np.einsum("n,ni,nj->ij", share, total, total) + np.einsum(
        "n,nki,nkj->ij", share, corners, corners
    )
    spread, axes = np.linalg.eigh(second / 20.0 / volume - np.outer(middle, middle))
    axes = axes[:, ::-1] * np.linalg.det(axes[:, ::-1])  # the longest first, and right-handed
    half = _three(np.sqrt(5.0 * spread[::-1]))
    turn = np.zeros(4)
    load_mujoco().mju_mat2Quat(turn, axes.ravel())
    return (
        "mesh",
        "ellipsoid",
        half,
        volume / (8.0 * math.prod(half)),
        middle,
        (turn[0], turn[1], turn[2], turn[3]),
    )


def _about(i: int, c: Sequence[float], half: Three, power: int) -> float:
    """Return the moment about axis i of the drags along the other two axes, each spread along the other one."""
    j, k = (i + 1) % 3, (i + 2) % 3
    return c[j] * half[k] ** power + c[k] * half[j] ** power


def _three(values: Iterable[Any]) -> Three:
    x, y, z = (float(v) for v in values)
    return x, y, z
