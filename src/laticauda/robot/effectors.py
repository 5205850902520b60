"""Parts of a robot besides its body: caudal fin, thrusters, pectoral fins, drag areas, and the tether it drags.

Links are counted from the tail, starting at 0, here and in the files.

Hinges represent the bending of a fin. Their positions and stiffnesses follow from the bending
energy: a plate that is clamped at its root and free at its end stores, with the bending moment M,

    U = integral of M(s)^2 / (2 E I) ds,        s = 0 at the root, 1 at the free end.

Rigid pieces with a hinge at each s_j store sum of M(s_j)^2 D_j / (2 E I) if hinge j has the
stiffness E I / D_j: they approximate the plate as a quadrature rule approximates the integral. At a
free end, moment and shear force vanish, so M behaves as (1 - s)^2 there for any load, and the
integrand as (1 - s)^4. The matching rule is the Gauss-Jacobi rule of weight (1 - s)^4: exact for (1
- s)^4 times any polynomial up to degree 2 m - 1, with m hinges.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Literal

import numpy as np

from laticauda.robot.body import Joint
from laticauda.values import BadArgument, option, quantity, value_class

MOST_HINGES = 6
"""Most hinges that a fin may have."""
FREE_END_POWER = 4
"""Power of (1 - s) with which the bending energy vanishes at the free end."""


@dataclass(frozen=True, kw_only=True)
class Hinge:
    """Passive hinge that represents the bending of a part of a plate."""

    position: float
    """Distance from the root [m]."""
    length: float
    """D, length of the plate whose bending it represents [m]."""
    stiffness: float
    """k = E I / D [N m/rad]."""
    damping: float
    """d = eta I / D [N m s/rad]."""


@dataclass(frozen=True, kw_only=True)
class Piece:
    """Rigid part of a plate."""

    begin: float
    """Distance of its head end from the root [m]."""
    end: float
    """Distance of its tail end from the root [m]."""
    mass: float
    """Mass [kg]."""
    hinge: Hinge | None
    """Passive hinge at its head end; None at the root."""

    @property
    def length(self) -> float:
        """Length [m]."""
        return self.end - self.begin


@lru_cache(maxsize=MOST_HINGES)
def hinge_rule(n: int) -> tuple[tuple[float, float], ...]:
    """Return the position of each of n hinges and the length it represents, relative to the plate's, root first.

    Golub and Welsch, Math. Comput. 23, 1969: the nodes are the eigenvalues of a symmetric matrix
    built from the recurrence of the polynomials, here the Jacobi polynomials with the parameters 4
    and 0.

    Args:
        n: Number of hinges.
    """
    # Recurrence coefficients of the Jacobi polynomials, in the notation of Golub and Welsch.
    power = FREE_END_POWER
    k = np.arange(n)
    diagonal = -(power**2) / ((2.0 * k + power) * (2.0 * k + power + 2.0))
    k = k[1:]
    off_diagonal = (
        2.0 * k * (k + power) / ((2.0 * k + power) * np.sqrt((2.0 * k + power) ** 2 - 1.0))
    )
    matrix = np.diag(diagonal) + np.diag(off_diagonal, 1) + np.diag(off_diagonal, -1)
    node, vector = np.linalg.eigh(matrix)
    position = 0.5 * (1.0 + node)
    share = vector[0] ** 2 / (power + 1.0) / (1.0 - position) ** power
    return tuple(zip(position.tolist(), share.tolist(), strict=True))


@value_class
class CaudalFin:
    """Flat, thin, upright plate behind the tail end of link 0: rigid, flexible, or driven about its root.

    The models cut it into strips. Near its root there may be an opening, which has mass but no
    area. A coefficient of None means the water's. The defaults describe Mamba's fin, treated as
    rigid.

    With `n_hinges` the plate bends and is represented by rigid pieces between passive hinges. With
    a `joint` it turns about its root according to `Gait.fin`. Neither counts as a link or a joint
    of the body.
    """

    length: float = quantity(
        "m", "Length from root to trailing edge, opening included", gt=0.0, le=100.0, default=0.5
    )
    height: float = quantity(
        "m", "Height h across the swimming plane", gt=0.0, le=100.0, default=0.09
    )
    opening_length: float = quantity(
        "m", "Length of the opening, which begins at the root", ge=0.0, default=0.12
    )
    opening: Literal["open", "closed"] = option(
        "`closed`: the plate reaches to the root", default="open"
    )
    thickness: float = quantity(
        "m", "Thickness, used only for the mass", gt=0.0, le=10.0, default=0.005
    )
    n_strips: int = quantity(
        "", "Equal strips behind the opening, even if it is closed", ge=1, le=1000, default=8
    )
    tangential_friction: float | None = quantity(
        "", "C_f,fin, both faces; None for the water's", ge=0.0, default=None
    )
    normal_drag: float | None = quantity(
        "", "C_D,fin, or None for the water's", ge=0.0, default=None
    )
    added_mass: float | None = quantity(
        "", "C_A,fin, or None for the water's", ge=0.0, default=None
    )
    density: float = quantity(
        "kg/m^3", "Density; neutrally buoyant in fresh water if omitted", gt=0.0, default=1000.0
    )
    n_hinges: int = quantity(
        "", "Passive hinges that represent bending; 0: rigid", ge=0, le=MOST_HINGES, default=0
    )
    flexural_rigidity: float | None = quantity(
        "N m^2", "E I = E h t^3 / 12; needed with hinges", gt=0.0, default=None
    )
    bending_damping: float = quantity(
        "N m^2 s", "eta I of the plate, with its viscosity eta", ge=0.0, default=0.0
    )
    joint: Joint | None = option("A driven hinge at the root, or None", default=None)
    silhouette: tuple[tuple[float, ...], ...] | None = quantity(
        "m",
        "Corners of the upper half of its silhouette, swept or forked: distance behind the root and height; "
        "None: a rectangle",
        default=None,
    )

    def __post_init__(self) -> None:
        if self.silhouette is not None:
            self._check_silhouette(self.silhouette)
        if self.opening_length >= self.length:
            raise BadArgument(
                "opening_length",
                f"must be < {self.length:g} m, the `length`, got {self.opening_length}",
            )
        if self.n_hinges and self.flexural_rigidity is None:
            raise BadArgument(
                "flexural_rigidity",
                "must be given in N m^2 for a fin with `n_hinges` > 0, got None",
            )
        if self.joint is not None and self.joint.axis != "yaw":
            raise BadArgument(
                "joint.axis", f"must be `yaw`: the fin is upright, got `{self.joint.axis}`"
            )

    def _check_silhouette(self, corners: tuple[tuple[float, ...], ...]) -> None:
        """Reject a silhouette that is no area within the rectangle of length and height."""
        fits = len(corners) >= 3 and all(
            len(corner) == 2
            and 0.0 <= corner[0] <= self.length
            and 0.0 <= corner[1] <= 0.5 * self.height
            for corner in corners
        )
        if not fits or self.area <= 0.0:
            raise BadArgument(
                "silhouette",
                "must be at least three corners (distance behind the root from 0 to the `length`, height "
                f"from 0 to half the `height`, in m) around an area, got {corners}",
            )
        if self.opening_length > 0.0 or self.n_hinges > 0:
            raise BadArgument(
                "silhouette", "must be None for a fin with an opening or hinges, got corners"
            )

    @property
    def hinges(self) -> tuple[Hinge, ...]:
        """Passive hinges, from the root to the trailing edge; none for a rigid fin."""
        rigidity = self.flexural_rigidity
        if not self.n_hinges or rigidity is None:
            return ()
        return tuple(
            Hinge(
                position=position * self.length,
                length=share * self.length,
                stiffness=rigidity / (share * self.length),
                damping=self.bending_damping / (share * self.length),
            )
            for position, share in hinge_rule(self.n_hinges)
        )

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """Rigid pieces between the hinges, from the root to the trailing edge; one for a rigid fin."""
        edges = pairwise((0.0, *(hinge.position for hinge in self.hinges), self.length))
        return tuple(
            Piece(begin=begin, end=end, mass=self.mass * (end - begin) / self.length, hinge=hinge)
            for (begin, end), hinge in zip(edges, (None, *self.hinges), strict=True)
        )

    @property
    def area(self) -> float:
        """Area of one face, opening included [m^2]."""
        if self.silhouette is None:
            return self.length * self.height
        corners = self.silhouette
        doubled = 0.0
        for (x_0, z_0), (x_1, z_1) in zip(corners, (*corners[1:], corners[0]), strict=True):
            doubled += x_0 * z_1 - x_1 * z_0
        return abs(doubled)

    @property
    def volume(self) -> float:
        """Volume of the plate, opening included [m^3]."""
        return self.area * self.thickness

    @property
    def mass(self) -> float:
        """Mass, opening included [kg]."""
        return self.density * self.volume


@value_class
class Mounted:
    """Part mounted rigidly on a link. Its axes are the link's, turned about z, then tilted, then rolled about x.

    The planar model treats a mount above or below the link's axis as a mount on the axis.
    """

    link: int = quantity("", "Link that carries it, counted from 0 at the tail", ge=0)
    x: float = quantity(
        "m", "Position of the mount along the link, from mid-length toward the head", default=0.0
    )
    y: float = quantity(
        "m", "Position of the mount across the link, from its axis to the left", default=0.0
    )
    z: float = quantity("m", "Height of the mount above the link's axis", default=0.0)
    angle: float = quantity(
        "rad", "beta, from the link's x axis to its own, counter-clockwise", default=0.0
    )
    elevation: float = quantity(
        "rad", "Elevation of its x axis above the link's plane; in space only", default=0.0
    )
    roll: float = quantity(
        "rad", "Roll about its x axis; positive lifts its left side; in space only", default=0.0
    )

    @property
    def position(self) -> tuple[float, float, float]:
        """Position of the mount, from the middle of the link [m]."""
        return self.x, self.y, self.z


@value_class
class Thruster(Mounted):
    """Thruster along its x axis: constant, or driven by the command (`Command.thrusts`) if it has a `max_thrust`."""

    thrust: float = quantity("N", "Thrust T unless commanded; negative pushes backward")
    max_thrust: float | None = quantity(
        "N", "Limit of commanded thrust in either direction", ge=0.0, default=None
    )
    rise_time: float = quantity(
        "s", "Time in which commanded thrust goes from 10 % to 90 % of a step", ge=0.0, default=0.0
    )
    dead_band: float = quantity(
        "N", "Smaller commanded thrust in either direction is none", ge=0.0, default=0.0
    )


@value_class
class PectoralFin(Mounted):
    """Flat plate with lift, drag and stall, its chord along its x axis: upright, or rolled to form a dive plane.

    The lift blends the linear law with that of a flat plate in separated flow, as in Beard and
    McLain, Small Unmanned Aircraft, Princeton 2012, eqs. (4.9) and (4.10); their Aerosonde has a
    stall angle of 27 deg and a sharpness of 50. A slender-wing theory gives the slope 2 pi R / (R +
    2) for the aspect ratio R.

    With a `max_deflection` the fin is driven by the command (`Command.deflections`).
    """

    area: float = quantity("m^2", "Area of one face", gt=0.0, le=1e4)
    lift_slope: float = quantity("1/rad", "Slope of the lift coefficient before stall", ge=0.0)
    stall_angle: float = quantity(
        "rad", "Angle of attack at which the flow separates", gt=0.0, le=np.pi / 2.0
    )
    stall_sharpness: float = quantity("", "Sharpness of the stall", gt=0.0, default=50.0)
    parasitic_drag: float = quantity("", "Drag coefficient at zero lift", ge=0.0, default=0.0)
    deflection: float = quantity(
        "rad", "Rotation of the chord about its z axis unless commanded", default=0.0
    )
    max_deflection: float | None = quantity(
        "rad", "Limit of commanded deflection to either side", ge=0.0, default=None
    )
    rise_time: float = quantity(
        "s",
        "Time in which a commanded deflection goes from 10 % to 90 % of a step",
        ge=0.0,
        default=0.0,
    )
    dead_band: float = quantity(
        "rad", "Distance from what is commanded within which it stands still", ge=0.0, default=0.0
    )


@value_class
class DragArea:
    """Bar, arm, cable or other part on a link that only drags: it carries no water along and does not turn the link.

    Its drag is that of two areas times rho v^2 / 2, by the law of the water, at a place on the axis of the
    link; parts that stand out to both sides are one area. For a flat bar, multiply its frontal
    area by some 1.2, for a round rod by 1.0.
    """

    link: int = quantity("", "Link that carries it, counted from 0 at the tail", ge=0)
    x: float = quantity(
        "m", "Position along the link, from mid-length toward the head", default=0.0
    )
    along: float = quantity(
        "m^2",
        "C_D A for motion along the link: area seen from ahead times drag coefficient",
        ge=0.0,
        le=1e4,
        default=0.0,
    )
    across: float = quantity(
        "m^2",
        "C_D A for motion across the link: area seen from the side times drag coefficient",
        ge=0.0,
        le=1e4,
        default=0.0,
    )


@value_class
class Tether:
    """Cable at the tail end: F = -k |v| v plus a constant force."""

    drag: float = quantity("kg/m", "k, lumped for the whole cable", ge=0.0, default=0.0)
    force: tuple[float, float] = quantity("N", "Constant force in world axes", default=(0.0, 0.0))
