"""The rigid pieces of the body: a module (in the planar model: a link) and its cross-section."""

import math
from dataclasses import dataclass

from laticauda.errors import finite, instance, not_negative, positive
from laticauda.robot.checks import settle, settle_required


@dataclass(frozen=True, kw_only=True)
class Section:
    """Elliptic cross-section of a module."""

    half_height: float
    """a, vertical half-axis, across the swimming plane [m]."""
    half_width: float
    """b, lateral half-axis, in the swimming plane [m]."""

    def __post_init__(self) -> None:
        settle_required(self, positive, "m", "half_height", "half_width")

    @property
    def area(self) -> float:
        """Area pi a b [m^2]."""
        return math.pi * self.half_height * self.half_width


@dataclass(frozen=True, kw_only=True)
class Module:
    """One rigid piece of the body, of constant cross-section.

    A fluid coefficient that is None is the water's; a number overrides the water's on this module only.
    """

    length: float
    """Whole length 2l [m]."""
    mass: float
    """Mass m [kg]."""
    section: Section
    """Cross-section (half-axes in m)."""
    tangential_friction: float | None = None
    """C_f, or None for the water's [-]."""
    normal_drag: float | None = None
    """C_D, or None for the water's [-]."""
    added_mass: float | None = None
    """C_A, or None for the water's [-]."""
    added_inertia: float | None = None
    """C_M, or None for the water's [-]."""
    center: float = 0.0
    """Center of mass, measured from mid-length towards the head [m]."""
    inertia: float | None = None
    """Moment of inertia about the center of mass, vertical axis; None for a uniform rod's [kg m^2]."""

    def __post_init__(self) -> None:
        settle_required(self, positive, "m", "length")
        settle_required(self, positive, "kg", "mass")
        instance("section", self.section, Section)
        settle(self, not_negative, "", "tangential_friction", "normal_drag", "added_mass", "added_inertia")
        settle_required(self, finite, "m", "center")
        settle(self, positive, "kg m^2", "inertia")
        if abs(self.center) > self.half_length:
            raise ValueError(
                f"`center` must lie inside the module, between {-self.half_length:g} and "
                f"{self.half_length:g} m, got {self.center}."
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
