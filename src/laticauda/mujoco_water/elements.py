"""A piece of a body as the water sees it: drag, added mass and displaced volume, in axes of its own."""

import math
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from laticauda.errors import finite, instance, not_negative, one_of, positive
from laticauda.fluid.laws import DragLaw, PolynomialDrag
from laticauda.mujoco_water import hydrostatics
from laticauda.mujoco_water.ground import Contact

SHAPES = ("ellipsoid", "cylinder", "box")
Three: TypeAlias = tuple[float, float, float]
Shape: TypeAlias = Literal["ellipsoid", "cylinder", "box"]
_NONE: Three = (0.0, 0.0, 0.0)
_NAMES_OF_SHAPES = {
    "ellipsoid": hydrostatics.ELLIPSOID,
    "cylinder": hydrostatics.CYLINDER,
    "box": hydrostatics.BOX,
}


@dataclass(frozen=True, kw_only=True)
class Element:
    """Loads on one piece of a body. A body may have several; drags that differ in kind are elements on one place.

    With u the velocity of the element's middle relative to the water and w its angular velocity, per axis of its own
    and by default, see `law`,

        f = -c u |u|        tau = -lambda_3 |w| w

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
    pull: Three = _NONE
    """A constant force in world axes, of a tether say [N]."""
    tether_drag: float = 0.0
    """k of a force -k |u| u, not negative [kg/m]."""
    wake_mass: float = 0.0
    """m' of Lighthill's force at a trailing edge, while u_x > 0: m'/2 u_y^2 along x, -m' u_x u_y along y [kg/m]."""
    plate: tuple[float, float, float, float, float] | None = None
    """An upright plate with its chord along x: the last five arguments of `laticauda.fluid.laws.plate`."""
    contact: Contact | None = None
    """How it touches the ground that `water.attach` is given; None: not at all."""
    volume: float = 0.0
    """Of the water that it displaces when covered [m^3]."""
    shape: Shape = "ellipsoid"
    """What the surface cuts; a cylinder is elliptic, with its axis along x."""
    half_size: Three = (0.1, 0.1, 0.1)
    """Half the length, width and height of the shape; without a surface it plays no part [m]."""
    law: DragLaw = PolynomialDrag(reference_speed=0.0)
    """How drag depends on speed; by default it is quadratic."""

    def __post_init__(self) -> None:
        """Check every field once."""
        if not isinstance(self.body, str):  # pyright: ignore[reportUnnecessaryIsInstance]  # users need not use pyright
            raise ValueError(f"`body` must be the name of a body, got {self.body!r}.")
        self._settle("position", finite, "m")
        self._settle("thrust", finite, "N")
        self._settle("pull", finite, "N")
        object.__setattr__(self, "tether_drag", not_negative("tether_drag", self.tether_drag, "kg/m"))
        object.__setattr__(self, "wake_mass", not_negative("wake_mass", self.wake_mass, "kg/m"))
        if self.plate is not None:
            self._settle("plate", not_negative, "", 5)
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
        instance("law", self.law, DragLaw)
        one_of("shape", self.shape, SHAPES)

    def _settle(self, name: str, check: Any, unit: str, length: int = 3) -> None:
        value: Any = getattr(self, name)
        if np.shape(value) != (length,):
            raise ValueError(f"`{name}` must hold {length} numbers, got {value!r}.")
        clean = tuple(check(f"{name}[{i}]", x, unit) for i, x in enumerate(value))
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
