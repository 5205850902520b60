"""The rigid pieces of the body: a module (in the planar model: a link) and its cross-section."""

import math

from laticauda.errors import BadArgument
from laticauda.quantities import option, quantity, value


@value
class Section:
    """Elliptic cross-section of a module."""

    half_height: float = quantity("m", "a, vertical half-axis, across the swimming plane", gt=0.0, le=100.0)
    half_width: float = quantity("m", "b, lateral half-axis, in the swimming plane", gt=0.0, le=100.0)

    @property
    def area(self) -> float:
        """Area pi a b [m^2]."""
        return math.pi * self.half_height * self.half_width


@value
class Module:
    """One rigid piece of the body, of constant cross-section.

    A fluid coefficient that is None is the water's; a number overrides the water's on this module only.
    """

    counted = ()  # keys that may be lists in an entry of a file with a `count`
    length: float = quantity("m", "Whole length 2l", gt=0.0, le=100.0)
    mass: float = quantity("kg", "Mass m", gt=0.0)
    section: Section = option("Cross-section")
    tangential_friction: float | None = quantity("", "C_f, or None for the water's", ge=0.0, default=None)
    normal_drag: float | None = quantity("", "C_D, or None for the water's", ge=0.0, default=None)
    added_mass: float | None = quantity("", "C_A, or None for the water's", ge=0.0, default=None)
    added_inertia: float | None = quantity("", "C_M, or None for the water's", ge=0.0, default=None)
    center: float = quantity("m", "Center of mass, measured from mid-length towards the head", default=0.0)
    inertia: float | None = quantity(
        "kg m^2", "About the center of mass, vertical axis; None for a uniform rod's", gt=0.0, default=None
    )

    def __post_init__(self) -> None:
        if abs(self.center) > self.half_length:
            raise BadArgument(
                "center",
                f"must lie inside the module, between {-self.half_length:g} and "
                f"{self.half_length:g} m, got {self.center}",
            )

    @property
    def half_length(self) -> float:
        """Half length l [m]."""
        return 0.5 * self.length

    @property
    def moment_of_inertia(self) -> float:
        """J about the center of mass: `inertia` if given, else m l^2 / 3 [kg m^2]."""
        return self.mass * self.half_length**2 / 3.0 if self.inertia is None else self.inertia

    @property
    def volume(self) -> float:
        """Displaced volume pi a b 2l [m^3]."""
        return self.section.area * self.length
