"""Body of a robot: rigid modules with their cross-sections, and the joints between them with their actuators.

The planar reduction merges modules that only bend out of the swimming plane into one rigid link.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from laticauda.values import BadArgument, add_up, option, quantity, value_class


@value_class
class Actuator:
    """Actuator of a joint: gains of the `pd` law, and the motor, gear and supply of the `servo` law.

    The servo's defaults are those of the Hitec HSR-5990TG, the servo of Mamba's joints, at 7.4 V.
    Hitec's figures, from a 2007 table of its robot servos [1], are 24 / 30 kg cm and 0.17 / 0.14 s
    per 60 deg at 6.0 / 7.4 V, hence 30 kg cm = 2.94 N m and 60 deg / 0.14 s = 7.48 rad/s. They
    apply at the output shaft, so they already include the gear's losses at stall and at full speed;
    the friction given here is added to them and is 0 by default.

    For a robot whose motors are not known, `stated` is false: the numbers are then Mamba's, and no
    run of the robot is judged by them (`Trial.feasibility`).

    `tracking` is the fraction of its reference, without the offset, that a `prescribed` joint
    reaches. Joints under `pd` control or with `servo`s lose amplitude by themselves and ignore it.

    Two defaults are not published figures. `stall_current` follows from 1.6 ohm, measured across
    the motor of the sister model HSR-5995TG [2]: 7.4 V / 1.6 ohm = 4.6 A, which makes the gear 64 %
    efficient. `servo_gain` is an assumption: full duty at an error of 10 deg.

    References:
        [1] "HSR Serial Communication", table "Hitec Robot Servos" of 2007-09-23, scribd.com/document/317975179.
        [2] RoboSavvy forum, topic 440, post by i-Bot of 2006-07-29.
    """

    stated: bool = option(
        "Whether the motor data are the robot's own and not Mamba's", default=True
    )
    proportional_gain: float = quantity("N m/rad", "k_p of the `pd` law", ge=0.0, default=20.0)
    derivative_gain: float = quantity("N m s/rad", "k_d of the `pd` law", ge=0.0, default=5.0)
    stall_torque: float = quantity(
        "N m", "Torque of the servo at full duty and standstill", gt=0.0, default=2.9
    )
    no_load_speed: float = quantity(
        "rad/s", "Speed of the servo at full duty and no torque", gt=0.0, default=7.5
    )
    servo_gain: float = quantity("1/rad", "Duty of the servo per angle error", gt=0.0, default=5.7)
    friction_torque: float = quantity(
        "N m", "Dry friction of the gear, on top of the motor data", ge=0.0, default=0.0
    )
    viscous_friction: float = quantity(
        "N m s/rad", "Viscous friction of the gear, likewise", ge=0.0, default=0.0
    )
    voltage: float = quantity("V", "Supply voltage of the servo", gt=0.0, default=7.4)
    stall_current: float = quantity(
        "A", "Current of the servo at full duty and standstill", gt=0.0, default=4.6
    )
    idle_current: float = quantity(
        "A", "Current of the servo at rest without load", ge=0.0, default=0.0
    )
    tracking: float = quantity(
        "", "Ratio of a `prescribed` joint's angle to the gait's", gt=0.0, le=1.5, default=1.0
    )

    @property
    def stall_power(self) -> float:
        """Power at full duty and standstill, V I_stall [W]."""
        return self.voltage * self.stall_current

    @property
    def idle_power(self) -> float:
        """Power at rest without load [W]."""
        return self.voltage * self.idle_current


@value_class
class Joint:
    """Driven hinge between two modules, with the skin that keeps the water out.

    The default limit is the servo's travel.
    """

    counted = ("axis",)
    """Keys that may be lists in a file entry with a `count`."""
    axis: Literal["yaw", "pitch"] = option(
        "`yaw` bends the body in the plane, `pitch` out of it", default="yaw"
    )
    limit: float = quantity(
        "rad", "Largest angle, to either side", gt=0.0, le=math.pi, default=math.pi / 2.0
    )
    actuator: Actuator = option("Actuator that drives it", default_factory=Actuator)
    stiffness: float = quantity("N m/rad", "k_s of the skin", ge=0.0, default=0.0)
    damping: float = quantity("N m s/rad", "d_s of the skin", ge=0.0, default=0.0)


@value_class
class Section:
    """Cross-section of a module, an ellipse unless it is a box."""

    half_height: float = quantity(
        "m", "a, vertical half-axis, across the swimming plane", gt=0.0, le=100.0
    )
    half_width: float = quantity(
        "m", "b, lateral half-axis, in the swimming plane", gt=0.0, le=100.0
    )
    shape: Literal["ellipse", "box"] = option(
        "Shape, for the volume and the textbook water", default="ellipse"
    )

    @property
    def area(self) -> float:
        """Area: pi a b for an ellipse, 4 a b for a box [m^2]."""
        factor = 4.0 if self.shape == "box" else math.pi
        return factor * self.half_height * self.half_width

    @property
    def perimeter(self) -> float:
        """Circumference; for an ellipse, by Ramanujan's first approximation [m]."""
        a, b = self.half_height, self.half_width
        if self.shape == "box":
            return 4.0 * (a + b)
        return math.pi * (3.0 * (a + b) - math.sqrt((3.0 * a + b) * (a + 3.0 * b)))


@value_class
class Module:
    """Rigid piece of the body with constant cross-section.

    A fluid coefficient of None means the water's; a number overrides the water's on this module
    only.
    """

    counted = ()
    """Keys that may be lists in a file entry with a `count`."""
    length: float = quantity("m", "Full length 2l", gt=0.0, le=100.0)
    mass: float = quantity("kg", "Mass m", gt=0.0)
    section: Section = option("Cross-section")
    tangential_friction: float | None = quantity(
        "", "C_f, or None for the water's", ge=0.0, default=None
    )
    normal_drag: float | None = quantity("", "C_D, or None for the water's", ge=0.0, default=None)
    added_mass: float | None = quantity("", "C_A, or None for the water's", ge=0.0, default=None)
    added_inertia: float | None = quantity("", "C_M, or None for the water's", ge=0.0, default=None)
    center: float = quantity(
        "m", "Center of mass, measured from mid-length towards the head", default=0.0
    )
    inertia: float | None = quantity(
        "kg m^2", "Yaw inertia about center of mass; None: a rod's", gt=0.0, default=None
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
        if self.inertia is not None:
            return self.inertia
        return self.mass * self.half_length**2 / 3.0

    @property
    def volume(self) -> float:
        """Displaced volume, area times length [m^3]."""
        return self.section.area * self.length


FLAT = 0.1
"""A module is flat if its section is at most so wide as it is high [-]."""


def is_flat(module: Module) -> bool:
    """Return whether a module is a thin upright plate.

    Args:
        module: The module.
    """
    return module.section.half_width <= FLAT * module.section.half_height


@dataclass(frozen=True, kw_only=True)
class Reduction:
    """Assignment of modules to links, and their positions in the links."""

    modules: tuple[Module, ...]
    """Links, tail first."""
    link: tuple[int, ...]
    """For each original module, the link that it is part of [-]."""
    shift: tuple[float, ...]
    """For each original module, the position of its middle relative to the middle of the link [m]."""


def reduce_to_plane(modules: Sequence[Module], joints: Sequence[Joint]) -> Reduction:
    """Merge modules joined by pitch joints, which are held at 0.

    Raises:
        ValueError: If modules to be merged differ in section or fluid coefficients. No single
            section has the drag and the added mass of two different ones, so no correct replacement
            exists.
    """
    groups: list[list[int]] = [[0]]
    for i, joint in enumerate(joints, start=1):
        if joint.axis == "pitch":
            _check_alike(modules, groups[-1][0], i)
            groups[-1].append(i)
        else:
            groups.append([i])
    links: list[Module] = []
    link_of_module: list[int] = []
    shifts: list[float] = []
    for k, group in enumerate(groups):
        group_modules = [modules[i] for i in group]
        middles = _middles(group_modules)
        links.append(_merge(group_modules, middles))
        link_of_module.extend(k for _ in group)
        shifts.extend(middles)
    return Reduction(modules=tuple(links), link=tuple(link_of_module), shift=tuple(shifts))


FIELDS_OF_ONE_LINK = (
    "section",
    "tangential_friction",
    "normal_drag",
    "added_mass",
    "added_inertia",
)
"""Fields in which modules that are merged must agree."""


def _check_alike(modules: Sequence[Module], first: int, second: int) -> None:
    for name in FIELDS_OF_ONE_LINK:
        value = getattr(modules[second], name)
        if value != getattr(modules[first], name):
            raise ValueError(
                f"`modules[{second}].{name}` must equal that of `modules[{first}]`, because a pitch "
                f"joint makes them one link of the planar model, got {value}."
            )


def _middles(modules: Sequence[Module]) -> list[float]:
    """Return the positions of the middles of consecutive modules, from the middle of all of them [m]."""
    if len(modules) == 1:
        return [0.0]
    middles: list[float] = []
    start = -0.5 * math.fsum(module.length for module in modules)
    for module in modules:
        middles.append(start + module.half_length)
        start += module.length
    return middles


def _merge(modules: Sequence[Module], middles: Sequence[float]) -> Module:
    """Merge consecutive modules, whose middles are at `middles`, into one rigid module."""
    if len(modules) == 1:
        return modules[0]
    length = math.fsum(module.length for module in modules)
    mass = math.fsum(module.mass for module in modules)
    centers = [middle + module.center for middle, module in zip(middles, modules, strict=True)]
    center = add_up(module.mass * x for module, x in zip(modules, centers, strict=True)) / mass
    inertia = add_up(
        module.moment_of_inertia + module.mass * (x - center) ** 2  # parallel axes
        for module, x in zip(modules, centers, strict=True)
    )
    return replace(modules[0], length=length, mass=mass, center=center, inertia=inertia)
