"""What a robot carries besides its body: caudal fin, thrusters, pectoral fins, and the tether it drags.

Links are counted from the tail, starting at 0, here and in the files.
"""

import math
from dataclasses import dataclass
from typing import Literal

from laticauda.errors import finite, instance, not_negative, one_of, positive, whole, within
from laticauda.robot.bending import MOST_HINGES, Hinge, Piece, hinge_rule
from laticauda.robot.checks import pair, put, settle, settle_required
from laticauda.robot.joints import Joint


@dataclass(frozen=True, kw_only=True)
class CaudalFin:
    """A flat, thin, upright plate behind the tail end of link 0: rigid, or bending, or driven about its root.

    The models cut it into strips. Near its root there may be an opening, which has mass but no area. A coefficient that
    is None is the water's. The defaults are Mamba's fin, taken as rigid.

    With `n_hinges` the plate bends: rigid pieces between passive hinges stand for it (`laticauda.robot.bending`). With
    a `joint` it turns about its root, as `Gait.fin` says. Neither counts as a link or a joint of the body.
    """

    length: float = 0.5
    """Length from the root to the trailing edge, opening included [m]."""
    height: float = 0.09
    """Height h across the swimming plane [m]."""
    opening_length: float = 0.12
    """Length of the opening, which begins at the root [m]."""
    opening: Literal["open", "closed"] = "open"
    """`open`, or `closed` for a plate that reaches to the root [-]."""
    thickness: float = 0.005
    """Thickness, which counts for the mass only [m]."""
    n_strips: int = 8
    """Number of strips of equal length behind the opening, or behind where it would be [-]."""
    tangential_friction: float | None = None
    """C_f,fin, on both faces, or None for the water's [-]."""
    normal_drag: float | None = None
    """C_D,fin, or None for the water's [-]."""
    added_mass: float | None = None
    """C_A,fin, or None for the water's [-]."""
    density: float = 1000.0
    """Density of the material; the default floats in fresh water [kg/m^3]."""
    n_hinges: int = 0
    """Number of passive hinges, 1 to 6, that stand for its bending; 0 is a rigid plate [-]."""
    flexural_rigidity: float | None = None
    """E I of the plate, needed if it has hinges; E h t^3 / 12 for a plate of one material [N m^2]."""
    bending_damping: float = 0.0
    """eta I of the plate (Kelvin-Voigt), eta the material's viscosity [N m^2 s]."""
    joint: Joint | None = None
    """A driven hinge at the root, or None (its fields have their own units)."""

    def __post_init__(self) -> None:
        settle_required(self, positive, "m", "length", "height", "thickness")
        settle_required(self, not_negative, "m", "opening_length")
        one_of("opening", self.opening, ("open", "closed"))
        put(self, "n_strips", whole("n_strips", self.n_strips, 1))
        settle(self, not_negative, "", "tangential_friction", "normal_drag", "added_mass")
        settle_required(self, positive, "kg/m^3", "density")
        if self.opening_length >= self.length:
            raise ValueError(
                f"`opening_length` must be < {self.length:g} m, the fin's `length`, got {self.opening_length}."
            )
        self._check_bending()

    def _check_bending(self) -> None:
        put(self, "n_hinges", whole("n_hinges", self.n_hinges, 0))
        if self.n_hinges > MOST_HINGES:
            raise ValueError(f"`n_hinges` must be between 0 (rigid) and {MOST_HINGES}, got {self.n_hinges}.")
        settle(self, positive, "N m^2", "flexural_rigidity")
        settle_required(self, not_negative, "N m^2 s", "bending_damping")
        if self.n_hinges and self.flexural_rigidity is None:
            raise ValueError("`flexural_rigidity` must be given in N m^2 for a fin with `n_hinges` > 0, got None.")
        if self.joint is not None:
            instance("joint", self.joint, Joint)
            if self.joint.axis != "yaw":
                raise ValueError(f"`joint.axis` must be `yaw`: the fin is upright, got `{self.joint.axis}`.")

    @property
    def hinges(self) -> tuple[Hinge, ...]:
        """The passive hinges, from the root to the trailing edge; none for a rigid fin."""
        if not self.n_hinges:
            return ()
        rigidity = self.flexural_rigidity
        assert rigidity is not None
        return tuple(
            Hinge(
                position=place * self.length,
                length=share * self.length,
                stiffness=rigidity / (share * self.length),
                damping=self.bending_damping / (share * self.length),
            )
            for place, share in hinge_rule(self.n_hinges)
        )

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """The rigid pieces between its hinges, from the root to the trailing edge; one for a rigid fin."""
        hinges = (None, *self.hinges)
        edges = [0.0, *(hinge.position for hinge in self.hinges), self.length]
        return tuple(
            Piece(
                begin=edges[i], end=edges[i + 1], mass=self.mass * (edges[i + 1] - edges[i]) / self.length, hinge=hinge
            )
            for i, hinge in enumerate(hinges)
        )

    @property
    def volume(self) -> float:
        """Volume of the plate, opening included [m^3]."""
        return self.length * self.height * self.thickness

    @property
    def mass(self) -> float:
        """Mass, opening included [kg]."""
        return self.density * self.volume


@dataclass(frozen=True, kw_only=True)
class Thruster:
    """A constant thrust at a fixed place and direction of a link."""

    link: int
    """Link that carries it, counted from the tail, from 0 [-]."""
    thrust: float
    """Thrust T; negative pushes backward [N]."""
    angle: float = 0.0
    """beta, direction of the thrust from the link's own axis, counter-clockwise [rad]."""
    x: float = 0.0
    """Mount along the link from its mid-length, headward positive [m]."""
    y: float = 0.0
    """Mount across the link from its axis, to the left positive [m]."""

    def __post_init__(self) -> None:
        put(self, "link", whole("link", self.link, 0))
        settle_required(self, finite, "N", "thrust")
        settle_required(self, finite, "rad", "angle")
        settle_required(self, finite, "m", "x", "y")


@dataclass(frozen=True, kw_only=True)
class PectoralFin:
    """An upright flat plate that gives lift and drag, and stalls.

    Lift blends the linear law with that of a flat plate in separated flow, as in Beard and McLain, Small Unmanned
    Aircraft, Princeton 2012, eqs. (4.9) and (4.10); their Aerosonde has a stall angle of 27 deg and a sharpness of 50.
    A slender wing theory for the slope: 2 pi R / (R + 2) for the aspect ratio R.
    """

    link: int
    """Link that carries it, counted from the tail, from 0 [-]."""
    area: float
    """Area of one face [m^2]."""
    lift_slope: float
    """Slope of the lift coefficient before the stall [1/rad]."""
    stall_angle: float
    """Angle of attack at which the flow separates [rad]."""
    x: float = 0.0
    """Mount along the link from its mid-length, headward positive [m]."""
    y: float = 0.0
    """Mount across the link from its axis, to the left positive [m]."""
    angle: float = 0.0
    """Direction of the chord from the link's own axis, counter-clockwise [rad]."""
    stall_sharpness: float = 50.0
    """How sudden the stall is [-]."""
    parasitic_drag: float = 0.0
    """Drag coefficient without lift [-]."""

    def __post_init__(self) -> None:
        put(self, "link", whole("link", self.link, 0))
        settle_required(self, positive, "m^2", "area")
        settle_required(self, not_negative, "1/rad", "lift_slope")
        settle_required(self, positive, "rad", "stall_angle")
        within("stall_angle", self.stall_angle, 0.0, math.pi / 2.0, "rad")
        settle_required(self, finite, "m", "x", "y")
        settle_required(self, finite, "rad", "angle")
        settle_required(self, positive, "", "stall_sharpness")
        settle_required(self, not_negative, "", "parasitic_drag")


@dataclass(frozen=True, kw_only=True)
class Tether:
    """A cable at the tail end: F = -k |v| v plus a constant force."""

    drag: float = 0.0
    """k, lumped over the cable [kg/m]."""
    force: tuple[float, float] = (0.0, 0.0)
    """Constant force in world axes [N]."""

    def __post_init__(self) -> None:
        settle_required(self, not_negative, "kg/m", "drag")
        put(self, "force", pair("force", self.force, "N"))
