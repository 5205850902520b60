"""A piece of a body as the water sees it: drag, added mass and displaced volume, in axes of its own."""

import math
from typing import Literal, TypeAlias

import numpy as np

from laticauda.errors import BadArgument
from laticauda.fluid.laws import DragLaw, PolynomialDrag
from laticauda.mujoco_water import hydrostatics
from laticauda.mujoco_water.ground import Contact
from laticauda.quantities import option, quantity, value

Three: TypeAlias = tuple[float, float, float]
Shape: TypeAlias = Literal["ellipsoid", "cylinder", "box"]
_NONE: Three = (0.0, 0.0, 0.0)
_NAMES_OF_SHAPES = {
    "ellipsoid": hydrostatics.ELLIPSOID,
    "cylinder": hydrostatics.CYLINDER,
    "box": hydrostatics.BOX,
}


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
