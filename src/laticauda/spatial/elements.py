"""A piece of a body as the water sees it: drag, added mass and displaced volume, in axes of its own."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from laticauda.errors import finite, not_negative, one_of, positive
from laticauda.spatial import hydrostatics

SHAPES = ("ellipsoid", "cylinder", "box")
Three = tuple[float, float, float]
_NONE: Three = (0.0, 0.0, 0.0)
_NAMES_OF_SHAPES = {
    "ellipsoid": hydrostatics.ELLIPSOID,
    "cylinder": hydrostatics.CYLINDER,
    "box": hydrostatics.BOX,
}


@dataclass(frozen=True, kw_only=True)
class Element:
    """Loads on one piece of a body. A body may have several; drags that differ in kind are elements on one place.

    With u the velocity of the element's middle relative to the water and w its angular velocity, per axis of its own:

        f = -c u (U_ref + |u|)        tau = -(U_ref lambda_2 + lambda_3 |w|) w

    Raises:
        ValueError: If a field is out of its range.
    """

    body: str
    """Name of the MuJoCo body that it is rigid on."""
    position: Three = _NONE
    """Its middle in the body's frame [m]."""
    orientation: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    """Its axes in the body's frame, as a quaternion (w, x, y, z) [-]."""
    drag: Three = _NONE
    """c along x, y and z, not negative [N s^2/m^2]."""
    torque_linear: Three = _NONE
    """lambda_2 about x, y and z, not negative [N s^2]."""
    torque_quadratic: Three = _NONE
    """lambda_3 about x, y and z, not negative [N m s^2]."""
    added_mass: Three = _NONE
    """Along x, y and z, not negative [kg]."""
    added_inertia: Three = _NONE
    """About x, y and z through the middle, not negative [kg m^2]."""
    thrust: Three = _NONE
    """A constant force along x, y and z, of a thruster say [N]."""
    volume: float = 0.0
    """Of the water that it displaces when covered [m^3]."""
    shape: Literal["ellipsoid", "cylinder", "box"] = "ellipsoid"
    """What the surface cuts; a cylinder is elliptic, with its axis along x."""
    half_size: Three = (0.1, 0.1, 0.1)
    """Half the length, width and height of the shape; without a surface it plays no part [m]."""
    reference_speed: float = 0.0
    """U_ref, at which linear and quadratic drag are equal; 0: no linear drag [m/s]."""
    quadratic: bool = True
    """Whether there is quadratic drag."""

    def __post_init__(self) -> None:
        """Check every field once."""
        if not isinstance(self.body, str):  # pyright: ignore[reportUnnecessaryIsInstance]  # users need not use pyright
            raise ValueError(f"`body` must be the name of a body, got {self.body!r}.")
        self._settle("position", finite, "m")
        self._settle("thrust", finite, "N")
        for name, unit in (
            ("drag", "N s^2/m^2"),
            ("torque_linear", "N s^2"),
            ("torque_quadratic", "N m s^2"),
            ("added_mass", "kg"),
            ("added_inertia", "kg m^2"),
        ):
            self._settle(name, not_negative, unit)
        self._settle("half_size", positive, "m")
        self._settle("orientation", finite, "", 4)
        norm = math.sqrt(sum(q * q for q in self.orientation))
        if norm < 1e-6:
            raise ValueError(f"`orientation` must be a quaternion that is not zero, got {self.orientation}.")
        w, x, y, z = (q / norm for q in self.orientation)
        object.__setattr__(self, "orientation", (w, x, y, z))
        object.__setattr__(self, "volume", not_negative("volume", self.volume, "m^3"))
        object.__setattr__(self, "reference_speed", not_negative("reference_speed", self.reference_speed, "m/s"))
        one_of("shape", self.shape, SHAPES)

    def _settle(self, name: str, check: Any, unit: str, length: int = 3) -> None:
        value: Any = getattr(self, name)
        if isinstance(value, str) or not isinstance(value, Sequence | np.ndarray) or len(value) != length:
            raise ValueError(f"`{name}` must hold {length} numbers, got {value!r}.")
        clean = tuple(check(f"{name}[{i}]", x, unit) for i, x in enumerate(value))  # pyright: ignore[reportUnknownArgumentType, reportUnknownVariableType]
        object.__setattr__(self, name, clean)

    @property
    def shape_number(self) -> int:
        """The shape as `hydrostatics` has it."""
        return _NAMES_OF_SHAPES[self.shape]

    @property
    def rotation(self) -> np.ndarray:
        """From its axes to the body's, (3, 3)."""
        w, x, y, z = self.orientation
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )


@dataclass(frozen=True, kw_only=True)
class GeomCoefficients:
    """Dimensionless coefficients that turn a geom into an `Element`; areas are those of the geom's projections."""

    drag: Three = (0.2, 1.0, 1.0)
    """C_D along the geom's axes, on the area that it shows in that direction [-]."""
    rotational_drag: float = 0.0
    """Share of what the normal drag, spread along the geom, sets against rotation about y and z [-]."""
    added_mass: float = 1.0
    """Share of the added mass and inertia of the ellipsoid that fits the geom (Lamb, 1932, art. 114 and 115) [-]."""
    reference_speed: float = field(default=0.0)
    """U_ref [m/s]."""


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
