"""A piece of a body as the water sees it: drag, added mass and displaced volume, in axes of its own.

For those who have shapes and no measured coefficients, there are elements that fit the geoms of a model.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np

from laticauda.angles import from_quaternion
from laticauda.errors import BadArgument, positive
from laticauda.extras import load_mujoco
from laticauda.fluid.laws import DragLaw, PolynomialDrag
from laticauda.mujoco_water.ground import Contact
from laticauda.quantities import option, quantity, value

Three: TypeAlias = tuple[float, float, float]
Shape: TypeAlias = Literal["ellipsoid", "cylinder", "box"]
_NONE: Three = (0.0, 0.0, 0.0)


@value
class Element:
    """Loads on one piece of a body. A body may have several; drags that differ in kind are elements on one place.

    With u the velocity of the element's middle relative to the water and w its angular velocity, per axis of its own
    and by default, see `law`,

        f = -c u |u|        tau = -lambda_3 |w| w

    Raises:
        ValueError: If a field is out of its range.
    """

    body: str = option("Name of the MuJoCo body that it is rigid on")
    position: Three = quantity("m", "Its middle in the body's frame", default=_NONE)
    orientation: tuple[float, float, float, float] = quantity(
        "", "Its axes in the body's frame, as a quaternion (w, x, y, z)", default=(1.0, 0.0, 0.0, 0.0)
    )
    drag: Three = quantity("N s^2/m^2", "c along x, y and z", default=_NONE, ge=0.0)
    torque_linear: Three = quantity("N s^2", "lambda_2 about x, y and z", default=_NONE, ge=0.0)
    torque_quadratic: Three = quantity("N m s^2", "lambda_3 about x, y and z", default=_NONE, ge=0.0)
    added_mass: Three = quantity("kg", "Along x, y and z", default=_NONE, ge=0.0)
    added_inertia: Three = quantity("kg m^2", "About x, y and z through the middle", default=_NONE, ge=0.0)
    thrust: Three = quantity("N", "A constant force along x, y and z, of a thruster say", default=_NONE)
    pull: Three = quantity("N", "A constant force in world axes, of a tether say", default=_NONE)
    tether_drag: float = quantity("kg/m", "k of a force -k |u| u", default=0.0, ge=0.0)
    wake_mass: float = quantity(
        "kg/m",
        "m' of Lighthill's force at a trailing edge, while u_x > 0: m'/2 u_y^2 along x, -m' u_x u_y along y",
        default=0.0,
        ge=0.0,
    )
    plate: tuple[float, float, float, float, float] | None = quantity(
        "",
        "An upright plate with its chord along x: the last five arguments of `laticauda.fluid.laws.plate`",
        default=None,
        ge=0.0,
    )
    contact: Contact | None = option(
        "How it touches the ground that `water.attach` is given; None: not at all", default=None
    )
    volume: float = quantity("m^3", "Of the water that it displaces when covered", default=0.0, ge=0.0)
    shape: Shape = option("What the surface cuts; a cylinder is elliptic, with its axis along x", default="ellipsoid")
    half_size: Three = quantity(
        "m",
        "Half the length, width and height of the shape; without a surface it plays no part",
        default=(0.1, 0.1, 0.1),
        gt=0.0,
    )
    law: DragLaw = option(
        "How drag depends on speed; by default it is quadratic", default=PolynomialDrag(reference_speed=0.0)
    )

    def __post_init__(self) -> None:
        """Normalize the quaternion."""
        norm = math.sqrt(sum(q * q for q in self.orientation))
        if norm < 1e-6:
            raise BadArgument("orientation", f"must be a quaternion that is not zero, got {self.orientation}")
        w, x, y, z = (q / norm for q in self.orientation)
        object.__setattr__(self, "orientation", (w, x, y, z))

    @property
    def rotation(self) -> np.ndarray:
        """From its axes to the body's, (3, 3)."""
        return from_quaternion(*self.orientation)


_ROUND = math.pi / 4.0  # share of a circle in the square around it
_HALF_TURN = 0.5**0.5


@value
class GeomCoefficients:
    """Dimensionless coefficients that turn a geom into an `Element`; areas are those of the geom's projections."""

    drag: Three = quantity(
        "", "C_D along the geom's axes, on the area that it shows in that direction", default=(0.2, 1.0, 1.0), ge=0.0
    )
    rotational_drag: float = quantity(
        "", "Share of what the drags, spread over the geom, set against its rotation", default=0.0, ge=0.0
    )
    added_mass: float = quantity(
        "",
        "Share of the added mass and inertia of the ellipsoid that fits the geom (Lamb, 1932, art. 114 and 115)",
        default=1.0,
        ge=0.0,
    )
    law: DragLaw = option(
        "How drag depends on speed; by default it is quadratic", default=PolynomialDrag(reference_speed=0.0)
    )


def lamb(half_size: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Added mass and inertia of an ellipsoid in unbounded water, as shares of what it displaces.

    Args:
        half_size: Half-axes [m].

    Returns:
        k_i = alpha_i / (2 - alpha_i) [-], and the added inertia over the displaced mass [m^2], per axis.

    References:
        H. Lamb, Hydrodynamics, 6th ed., Cambridge 1932, art. 114 and 115.
    """
    a = np.asarray(half_size, dtype=float)
    # alpha_i = abc int_0^inf dt / ((a_i^2 + t) Delta), substituted t = s^2 x^2 / (1 - x)^2 for Gauss' rule on (0, 1)
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


def geom_element(model: Any, geom: str | int, coefficients: GeomCoefficients, *, density: float = 1000.0) -> Element:
    """The element that fits a geom: a sphere, capsule, ellipsoid, cylinder or box.

    Args:
        model: A `mujoco.MjModel`.
        geom: Its name or number.
        coefficients: What the water does to it.
        density: rho [kg/m^3].

    Raises:
        ValueError: If there is no such geom, it has no volume, or it is of another type.
    """
    mujoco = load_mujoco()
    positive("density", density, "kg/m^3")
    number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, geom) if isinstance(geom, str) else geom
    if not 0 <= number < model.ngeom:
        raise BadArgument("geom", f"must be a geom of the model, got {geom!r}")
    shape, half, share_of_box, turn = _fitted(model, number)
    volume = share_of_box * 8.0 * half[0] * half[1] * half[2]
    share, turning = lamb(half)
    mass = coefficients.added_mass * density * volume
    round_ends, round_sides = (1.0, 1.0) if shape == "box" else (_ROUND, 1.0 if shape == "cylinder" else _ROUND)
    area = (
        4.0 * round_ends * half[1] * half[2],
        4.0 * round_sides * half[0] * half[2],
        4.0 * round_sides * half[0] * half[1],
    )
    c = [0.5 * density * k * a for k, a in zip(coefficients.drag, area, strict=True)]
    spread = coefficients.rotational_drag
    return Element(
        body=model.body(int(model.geom_bodyid[number])).name,
        position=_three(model.geom_pos[number]),
        orientation=_product(model.geom_quat[number], turn),
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


def _fitted(model: Any, number: int) -> tuple[Shape, Three, float, tuple[float, float, float, float]]:
    """Shape of a geom, half its size, its share of the box around it, and how its axes are turned into ours."""
    mujoco = load_mujoco()
    kind = mujoco.mjtGeom(model.geom_type[number]).name.removeprefix("mjGEOM_").lower()
    name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, number) or f"geom {number}"
    x, y, z = _three(model.geom_size[number])
    straight = (1.0, 0.0, 0.0, 0.0)
    along_z = (_HALF_TURN, 0.0, -_HALF_TURN, 0.0)  # MuJoCo's axis of a cylinder is z, ours x
    ball = math.pi / 6.0
    fitted: dict[str, tuple[Shape, Three, float, tuple[float, float, float, float]]] = {
        "sphere": ("ellipsoid", (x, x, x), ball, straight),
        "ellipsoid": ("ellipsoid", (x, y, z), ball, straight),
        "box": ("box", (x, y, z), 1.0, straight),
        "cylinder": ("cylinder", (y, x, x), _ROUND, along_z),
        "capsule": ("cylinder", (y + x, x, x), (_ROUND * y + ball * x) / (y + x or 1.0), along_z),
    }
    if kind not in fitted:
        raise BadArgument("geom", f"must be a sphere, capsule, ellipsoid, cylinder or box, got `{name}`, a {kind}")
    if not min(fitted[kind][1]) > 0.0:
        raise BadArgument("geom", f"must have a volume, got `{name}`, whose size is {[x, y, z]}")
    return fitted[kind]


def _about(i: int, c: Sequence[float], half: Three, power: int) -> float:
    """Drags across the other two axes, each spread along the other one, as they act about axis i."""
    j, k = (i + 1) % 3, (i + 2) % 3
    return c[j] * half[k] ** power + c[k] * half[j] ** power


def _three(values: Iterable[Any]) -> Three:
    x, y, z = (float(v) for v in values)
    return x, y, z


def _product(a: Sequence[float], b: Sequence[float]) -> tuple[float, float, float, float]:
    """Product of two quaternions."""
    result = np.zeros(4)
    load_mujoco().mju_mulQuat(result, np.asarray(a, dtype=float), np.asarray(b, dtype=float))
    w, x, y, z = (float(q) for q in result)
    return w, x, y, z
