"""Elements: pieces of a body in water, with drag, added mass and displaced volume in their own axes.

Where there are shapes but no measured coefficients, `laticauda.water.mujoco.geoms` fits elements to the
geoms of a model.
"""

import math
from typing import Literal, TypeAlias

import numpy as np

from laticauda.values import BadArgument, add_up, from_quaternion, option, quantity, value_class
from laticauda.water.fluid.laws import DragLaw, PolynomialDrag
from laticauda.water.mujoco.ground import Contact

Three: TypeAlias = tuple[float, float, float]
Quaternion: TypeAlias = tuple[float, float, float, float]
"""w, x, y, z."""
Shape: TypeAlias = Literal["ellipsoid", "cylinder", "box"]
_NONE: Three = (0.0, 0.0, 0.0)
_SMALLEST_NORM = 1e-6
"""Norm below which a quaternion counts as zero [-]."""


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
    heave_damping: float = quantity(
        "N s/m", "By the waves that it makes, half submerged: of its rise", default=0.0, ge=0.0
    )
    tilt_damping: Three = quantity(
        "N m s",
        "Likewise, of its turning out of the level, about x, y and z",
        default=_NONE,
        ge=0.0,
    )

    def __post_init__(self) -> None:
        """Normalize the quaternion."""
        norm = math.sqrt(add_up(q * q for q in self.orientation))
        if norm < _SMALLEST_NORM:
            rule = f"must be a quaternion that is not zero, got {self.orientation}"
            raise BadArgument("orientation", rule)
        w, x, y, z = (q / norm for q in self.orientation)
        object.__setattr__(self, "orientation", (w, x, y, z))

    @property
    def rotation(self) -> np.ndarray:
        """Rotation from its axes to the body's, (3, 3)."""
        return from_quaternion(*self.orientation)
