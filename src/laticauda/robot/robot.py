"""`Robot`: the complete description of a swimming robot. Modules and joints are counted from the tail."""

import math
from dataclasses import replace
from typing import Literal, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from laticauda.motion.joints import JointLaw
from laticauda.robot import body, effectors
from laticauda.values import (
    BadArgument,
    Suggesting,
    add_up,
    check_label,
    check_whole_number,
    html_table,
    option,
    quantity,
    value_class,
)

Numbers: TypeAlias = NDArray[np.float64]
Effector = TypeVar("Effector", effectors.Thruster, effectors.PectoralFin, effectors.DragArea)
MOST_LINKS = 10_000
"""Upper limit: more links are assumed to be a mistake and would exhaust the memory."""
Surface: TypeAlias = Literal["smooth", "jointed", "skinned"]
End: TypeAlias = Literal["faired", "round", "blunt"]


MEANT = {
    "diameter": ("modules[0].half_height", "modules[0].half_width"),
    "dof": ("n_joints",),
    "fin": ("caudal_fin",),
    "from_file": ("laticauda.load_robot",),
    "from_toml": ("laticauda.load_robot",),
    "links": ("n_links", "modules"),
    "load": ("laticauda.load_robot",),
    "motors": ("driven_joints",),
    "n": ("n_links",),
    "n_modules": ("n_links",),
    "num_joints": ("n_joints",),
    "num_links": ("n_links",),
    "preset": ("laticauda.load_robot",),
    "read": ("laticauda.load_robot",),
    "save": ("laticauda.robot.to_toml",),
    "segments": ("n_links", "modules"),
    "servos": ("driven_joints",),
    "swim": ("laticauda.swim",),
    "weight": ("mass",),
}
"""Names of a robot by names that people try in vain; a name that is merely mistyped needs no entry."""


@value_class
class Robot(Suggesting):
    """Chain of modules and joints, tail first, with the parts mounted on it.

    For a sweep, use `dataclasses.replace`; every copy is validated again. With an `active_power`, a
    trial has an electrical power under any joint law; without it, only with `servo` joints, where
    it counts as 0.
    """

    _meant = MEANT

    name: str = option("Name used in messages and stored trials", check=check_label)
    description: str = option("One-line description", default="")
    modules: tuple[body.Module, ...] = option("The rigid pieces, from tail to head")
    joints: tuple[body.Joint, ...] = option("Joint i connects modules i and i + 1", default=())
    caudal_fin: effectors.CaudalFin | None = option(
        "The fin behind module 0, or None", default=None
    )
    thrusters: tuple[effectors.Thruster, ...] = option("Thrusters, in any order", default=())
    pectoral_fins: tuple[effectors.PectoralFin, ...] = option(
        "Pectoral fins, in any order", default=()
    )
    drag_areas: tuple[effectors.DragArea, ...] = option(
        "Bars, arms and cables that drag, in any order", default=()
    )
    tether: effectors.Tether = option("The cable at the tail end", default_factory=effectors.Tether)
    surface: Surface = option(
        "Surface: smooth, with gaps at the joints, or with a loose skin", default="jointed"
    )
    nose: End = option("Shape of the body's head end", default="round")
    tail: End = option("Shape of the body's tail end", default="round")
    electronics_power: float = quantity(
        "W", "Power at rest, excluding the actuators' idle power", ge=0.0, default=0.0
    )
    active_power: float | None = quantity(
        "W", "Additional power of electronics while swimming", ge=0.0, default=None
    )

    def __post_init__(self) -> None:
        n = len(self.modules)
        if n == 0:
            raise BadArgument("modules", "must hold at least one Module, got none")
        if len(self.joints) != n - 1:
            raise BadArgument(
                "joints",
                f"must hold one Joint fewer than there are modules, {n - 1} for {n} modules, "
                f"got {len(self.joints)}",
            )
        for group in ("thrusters", "pectoral_fins", "drag_areas"):
            for i, effector in enumerate(getattr(self, group)):
                if effector.link >= n:
                    raise BadArgument(
                        f"{group}[{i}].link",
                        f"must be 0 (tail) to {n - 1} (head), got {effector.link}",
                    )

    @property
    def words(self) -> str:
        """One-line summary."""
        fin = ", with a caudal fin" if self.caudal_fin else ""
        return f"{self.name}: {self.n_links} links, {self.length:.4g} m, {self.mass:.4g} kg{fin}"

    def __repr__(self) -> str:
        """Return `words` instead of the many fields."""
        return f"<Robot {self.words}>"

    def _repr_html_(self) -> str:
        from laticauda.robot.describe import robot_rows

        return html_table(self.words, robot_rows(self))

    @property
    def n_links(self) -> int:
        """Number of modules n, without the fin."""
        return len(self.modules)

    @property
    def n_joints(self) -> int:
        """Number of joints, n - 1."""
        return len(self.joints)

    @property
    def length(self) -> float:
        """Length of the straight body without the fin [m]."""
        return math.fsum(module.length for module in self.modules)

    @property
    def reach(self) -> float:
        """Length of the straight robot with its fin [m]."""
        if self.caudal_fin is None:
            return self.length
        return self.length + self.caudal_fin.length

    @property
    def mass(self) -> float:
        """Mass with the fin [kg]."""
        fin = self.caudal_fin.mass if self.caudal_fin else 0.0
        return math.fsum(module.mass for module in self.modules) + fin

    @property
    def volume(self) -> float:
        """Displaced volume with the fin [m^3]."""
        fin = self.caudal_fin.volume if self.caudal_fin else 0.0
        return math.fsum(module.volume for module in self.modules) + fin

    @property
    def driven_joints(self) -> tuple[body.Joint, ...]:
        """All joints with an actuator: those of the body, tail first, then the joint of a driven fin."""
        if self.caudal_fin is None or self.caudal_fin.joint is None:
            return self.joints
        return (*self.joints, self.caudal_fin.joint)

    @property
    def fin_joints(self) -> range:
        """Joints about which the fin moves, from the root: 0 is a driven root, 1 and above are passive hinges."""
        fin = self.caudal_fin
        if fin is None:
            return range(0)
        first = 0 if fin.joint else 1
        return range(first, fin.n_hinges + 1)

    @property
    def idle_power(self) -> float:
        """Power drawn at rest by electronics and idle actuators [W]."""
        return self.electronics_power + add_up(
            joint.actuator.idle_power for joint in self.driven_joints
        )

    def planar(self) -> "Robot":
        """Return the robot of the planar model: pitch joints are held at 0, and the modules they join are merged.

        Lengths and masses add, moments of inertia add by the parallel-axis theorem, effectors keep
        their positions on the body, and the idle power is unchanged. A robot without pitch joints
        is returned unchanged.

        Raises:
            ValueError: If modules that would merge differ in section or fluid coefficients.
        """
        pitch_joints = [joint for joint in self.joints if joint.axis == "pitch"]
        if not pitch_joints:
            return self
        reduction = body.reduce_to_plane(self.modules, self.joints)
        idle_power = add_up(joint.actuator.idle_power for joint in pitch_joints)
        return replace(
            self,
            modules=reduction.modules,
            joints=tuple(joint for joint in self.joints if joint.axis == "yaw"),
            thrusters=tuple(_move(thruster, reduction) for thruster in self.thrusters),
            pectoral_fins=tuple(_move(fin, reduction) for fin in self.pectoral_fins),
            drag_areas=tuple(_move(area, reduction) for area in self.drag_areas),
            electronics_power=self.electronics_power + idle_power,
        )

    def yaw_joints(self, name: str, values: Numbers) -> Numbers:
        """Select the values of the yaw joints.

        Args:
            name: Name of `values` in the error message.
            values: One value per joint or per yaw joint; after one per joint, the value of a driven
                fin may follow.

        Raises:
            ValueError: If the number of values does not match.
        """
        is_yaw = [joint.axis == "yaw" for joint in self.joints]
        if values.size in (len(is_yaw), len(self.driven_joints)):
            return values[: len(is_yaw)][is_yaw]
        if values.size == sum(is_yaw):
            return values
        raise BadArgument(
            name, f"must hold {len(is_yaw)} numbers, one per joint of the robot, got {values.size}"
        )

    def with_links(self, n_links: int) -> "Robot":
        """Return the same robot with a different number of links.

        Args:
            n_links: New number of links; effectors stay on their links.

        Raises:
            ValueError: If the modules or joints are not all identical, or `n_links` is not from 1
                to 10 000.
        """
        n = check_whole_number("n_links", n_links, 1, MOST_LINKS)
        if n == self.n_links:
            return self
        if len(set(self.modules)) > 1 or len(set(self.joints)) != 1:
            raise BadArgument(
                "n_links",
                f"must stay {self.n_links} for robot `{self.name}`, "
                f"whose modules or joints are not all alike, got {n}",
            )
        return replace(self, modules=self.modules[:1] * n, joints=self.joints[:1] * (n - 1))


def has_power_model(robot: Robot, joints: JointLaw) -> bool:
    """Return whether a run has an electrical power, which is then `mean_power`: with servos or an `active_power`.

    Args:
        robot: Robot that swims; with an `active_power`, it has an electrical power under any joint
            law.
        joints: Law by which its joints follow their references.
    """
    return joints.powered or robot.active_power is not None


def _move(effector: Effector, reduction: body.Reduction) -> Effector:
    """Return the same effector on the link that its module became part of."""
    module = effector.link
    return replace(effector, link=reduction.link[module], x=effector.x + reduction.shift[module])
