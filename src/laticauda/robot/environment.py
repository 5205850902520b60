"""What the robot moves in or on: `Water` and `Ground`. Both are data; the loads are computed elsewhere."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

from laticauda.errors import not_negative, one_of, positive, within
from laticauda.robot.checks import flag, label, pair, put, settle, settle_required
from laticauda.robot.robot import Robot

ADDED_MASS_FORMS = ("relative", "kirchhoff", "classic")
ROTATIONAL_FORMS = ("paper", "strip")
TRAILING_EDGES = ("none", "elongated")
FRICTIONS = ("viscous", "coulomb")


@dataclass(frozen=True, kw_only=True)
class Water:
    """Still or uniformly moving water, the coefficients of its loads and the form that they take.

    The coefficients hold for every module and the fin, apart from those that bring their own.
    """

    name: str = "custom"
    """What messages and stored trials call it."""
    density: float = 1000.0
    """rho [kg/m^3]."""
    tangential_friction: float
    """C_f, drag along the body [-]."""
    normal_drag: float
    """C_D, drag across the body [-]."""
    added_mass: float
    """C_A, added mass across the body [-]."""
    added_inertia: float = 1.0
    """C_M, added moment of inertia; the `strip` form does not use it [-]."""
    tangential_added_mass: float = 0.0
    """Added mass along the body as a share of the displaced mass [-]."""
    linear_drag: bool = True
    """Whether the drag has a part that is linear in the speed."""
    quadratic_drag: bool = True
    """Whether the drag has a part that is quadratic in the speed."""
    sway_friction: float = 0.0
    """gamma, drag along the body that grows with the local sideways speed: f_t = -c_t v_t (... + gamma |v_n|) [-]."""
    friction_taper: float = 0.0
    """Drag along the links from 1 + taper at the tail end to 1 - taper at the head end, times C_f; -1 to 1 [-]."""
    reference_speed: float = 1.0
    """U_ref, the speed at which linear and quadratic drag are equal [m/s]."""
    added_mass_form: Literal["relative", "kirchhoff", "classic"] = "relative"
    """`relative` is the paper's; `kirchhoff` keeps energy and momentum; `classic` is for comparison only."""
    rotational: Literal["paper", "strip"] = "paper"
    """Torque on a rotating link: the `paper`'s coefficients, or normal loads summed along the link (`strip`)."""
    trailing_edge: Literal["none", "elongated"] = "none"
    """`elongated` adds Lighthill's wake force at the fin's trailing edge; it needs `kirchhoff`."""
    current: tuple[float, float] = (0.0, 0.0)
    """V, the velocity that the water moves to, in world axes [m/s]."""
    depth: float | None = None
    """Depth of the body's axis below the surface; None for far below it [m]."""

    def __post_init__(self) -> None:
        label("name", self.name)
        settle_required(self, positive, "kg/m^3", "density")
        settle_required(self, not_negative, "", "tangential_friction", "normal_drag", "added_mass")
        settle_required(self, not_negative, "", "added_inertia", "tangential_added_mass")
        flag("linear_drag", self.linear_drag)
        flag("quadratic_drag", self.quadratic_drag)
        settle_required(self, not_negative, "m/s", "reference_speed")
        settle_required(self, not_negative, "", "sway_friction")
        put(self, "friction_taper", within("friction_taper", self.friction_taper, -1.0, 1.0))
        one_of("added_mass_form", self.added_mass_form, ADDED_MASS_FORMS)
        one_of("rotational", self.rotational, ROTATIONAL_FORMS)
        one_of("trailing_edge", self.trailing_edge, TRAILING_EDGES)
        put(self, "current", pair("current", self.current, "m/s"))
        settle(self, positive, "m", "depth")
        if self.trailing_edge == "elongated" and self.added_mass_form != "kirchhoff":
            raise ValueError(
                "`trailing_edge` must be `none` unless `added_mass_form` is `kirchhoff` "
                f"(here it is `{self.added_mass_form}`), got 'elongated'."
            )


@dataclass(frozen=True, kw_only=True)
class Ground:
    """Flat ground with anisotropic friction: `viscous`, in proportion to the speed, or dry (`coulomb`)."""

    name: str = "custom"
    """What messages and stored trials call it."""
    friction: Literal["viscous", "coulomb"]
    """The law: `viscous` or `coulomb`."""
    tangential: float
    """Coefficient along a link: viscous, per link [N s/m]; coulomb, share of the link's weight [-]."""
    normal: float
    """Coefficient across a link, in the same unit [N s/m] or [-]."""
    regularization_speed: float = 1e-3
    """eps, below which dry friction fades out; `viscous` does not use it [m/s]."""
    gravity: float = 9.81
    """g; `viscous` does not use it [m/s^2]."""

    def __post_init__(self) -> None:
        label("name", self.name)
        one_of("friction", self.friction, FRICTIONS)
        unit = "N s/m" if self.friction == "viscous" else ""
        settle_required(self, not_negative, unit, "tangential", "normal")
        settle_required(self, positive, "m/s", "regularization_speed")
        settle_required(self, not_negative, "m/s^2", "gravity")


Environment: TypeAlias = Water | Ground


def check_fits(robot: Robot, environment: Environment) -> None:
    """Refuse a robot and an environment that are both fine but do not go together.

    Args:
        robot: What swims.
        environment: What it swims in.

    Raises:
        ValueError: If the water's depth leaves part of the body or of the fin above the surface.
    """
    if isinstance(environment, Ground) or environment.depth is None:
        return
    highest = max((module.section.half_height, f"modules[{i}]") for i, module in enumerate(robot.modules))
    if robot.caudal_fin is not None:
        highest = max(highest, (0.5 * robot.caudal_fin.height, "caudal_fin"))
    half_height, owner = highest
    if environment.depth <= half_height:
        raise ValueError(
            f"`depth` must be > {half_height:g} m, the half height of `{owner}` of robot `{robot.name}`, "
            f"got {environment.depth}."
        )
