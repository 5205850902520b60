"""The bodies of a robot, as used in all models and pictures: frames, joints, masses and mounted effectors.

Bodies are `module_0` (tail) to `module_{n-1}` (head). A module's frame has its origin at the tail
end, with x toward the head, y to the left and z up. `joint_i` is at the head end of module i and
turns module i + 1 about z (yaw) or y (pitch), so joint angles and all numbering are those of
`Robot`: a positive yaw angle turns the head side left, a positive pitch angle turns it down. The
fin is the body `caudal_fin`, fixed to module 0, or on `fin_joint` if it is driven. If it bends, its
piece k is the body `caudal_fin_k` on the passive hinge `fin_hinge_k`, counted from the root. The
frame of each piece is at its head end, with x toward the head. Fin angles have the same sign
convention as those of the body: positive angles turn the part behind the hinge to the right.
"""

from typing import NamedTuple

from laticauda.robot import (
    CaudalFin,
    Hinge,
    Joint,
    Module,
    PectoralFin,
    Piece,
    Robot,
    Thruster,
    levers,
    to_quaternion,
    turn,
)
from laticauda.scenarios import Model, Spatial

Three = tuple[float, float, float]
AXES: dict[str, Three] = {"yaw": (0.0, 0.0, 1.0), "pitch": (0.0, 1.0, 0.0)}
FIN_AXIS = (0.0, 0.0, -1.0)  # fin bodies lie behind their hinges, modules ahead of theirs


class Body(NamedTuple):
    """One body of a robot."""

    name: str
    """Name; see the module's docstring."""
    parent: str
    """Parent body; "" for module 0."""
    position: Three
    """Origin of its frame in the parent's frame [m]."""
    part: Module | Piece
    """Module or piece of the fin that it represents."""
    mass: float
    """Mass [kg]."""
    center: float
    """Center of mass on its x axis [m]."""
    inertia: Three
    """Moments of inertia about axes along x, y and z through the center of mass [kg m^2]."""
    joint_name: str = ""
    """Name of the joint at its origin; "" if it is fixed or the root."""
    joint: Joint | Hinge | None = None
    """That joint, driven or a passive hinge; None if there is none."""
    axis: Three = FIN_AXIS
    """Axis of rotation of the joint."""


class Mount(NamedTuple):
    """Mounting pose of a thruster or a pectoral fin."""

    name: str
    """Name: `thruster_k` or `pectoral_fin_k`."""
    body: str
    """Body on which it is mounted."""
    position: Three
    """Position in the body's frame [m]."""
    orientation: tuple[float, float, float, float]
    """Orientation of its axes in the body's frame, as a quaternion (w, x, y, z) [-]."""


def build_bodies(robot: Robot) -> list[Body]:
    """Return all bodies, parents first: the modules from the tail, then the fin from its root."""
    found: list[Body] = []
    for i, module in enumerate(robot.modules):
        joint = robot.joints[i - 1] if i else None
        found.append(
            Body(
                name=f"module_{i}",
                parent=f"module_{i - 1}" if i else "",
                position=(robot.modules[i - 1].length if i else 0.0, 0.0, 0.0),
                part=module,
                mass=module.mass,
                center=module.half_length + module.center,
                inertia=_module_inertia(module),
                joint_name=f"joint_{i - 1}" if i else "",
                joint=joint,
                axis=AXES["yaw" if joint is None else joint.axis],
            )
        )
    return found if robot.caudal_fin is None else found + fin_bodies(robot.caudal_fin)


def fin_bodies(fin: CaudalFin) -> list[Body]:
    """Return the bodies of a fin, starting at its root."""
    found: list[Body] = []
    parent, behind = "module_0", 0.0
    for k, piece in enumerate(fin.pieces):
        joint = fin.joint if piece.hinge is None else piece.hinge
        joint_name = "fin_joint" if piece.hinge is None else f"fin_hinge_{k}"
        found.append(
            Body(
                name=f"caudal_fin_{k}" if k else "caudal_fin",
                parent=parent,
                position=(-behind, 0.0, 0.0),
                part=piece,
                mass=piece.mass,
                center=-0.5 * piece.length,
                inertia=_piece_inertia(fin, piece),
                joint_name="" if joint is None else joint_name,
                joint=joint,
            )
        )
        parent, behind = found[-1].name, piece.length
    return found


def mounts(robot: Robot) -> list[Mount]:
    """Return the mounts of the robot's thrusters and pectoral fins."""
    return [
        Mount(
            f"{kind}_{k}",
            f"module_{one.link}",
            (robot.modules[one.link].half_length + one.x, one.y, one.z),
            _orientation(one),
        )
        for kind, several in (("thruster", robot.thrusters), ("pectoral_fin", robot.pectoral_fins))
        for k, one in enumerate(several)
    ]


def _orientation(one: Thruster | PectoralFin) -> tuple[float, float, float, float]:
    """Return the orientation: rotation about z, tilt, roll about x and, for a fin, deflection about its own z."""
    turned = turn("yaw", one.angle) @ turn("pitch", -one.elevation) @ turn("roll", one.roll)
    return to_quaternion(turned @ turn("yaw", getattr(one, "deflection", 0.0)))


def straight_center_of_mass(robot: Robot) -> float:
    """Return the center of mass of the straight robot on its axis, measured from the tail end [m]."""
    return -float(levers(robot).end[0].sum())


def ballast_of(robot: Robot, model: Model | None) -> float:
    """Return how far the modules' centers of mass lie below their axes in a model [m].

    Args:
        robot: The robot.
        model: Model of the robot; None and the planar model give 0.
    """
    if not isinstance(model, Spatial) or not model.gravity:
        return 0.0
    is_free = model.root == "free" or (
        model.root is None and any(joint.axis == "pitch" for joint in robot.joints)
    )
    return model.ballast_depth if is_free else 0.0


def moments_of_inertia(vertical: float, across: float, above: float) -> Three:
    """Return the moments of inertia of a body about x, y and z, of which the last is exact [kg m^2].

    With the second moments s_x, s_y, s_z of the mass, I_z = s_x + s_y and so on. Here I_z is the
    robot's own value, s_y and s_z are those of the body's section, and s_x is the remainder. A
    robot with planar parameters (thin rods) thus still has the roll and pitch inertia of its
    section, and no combination of values gives an impossible body.

    Args:
        vertical: I_z [kg m^2].
        across: s_y of the section, capped at half of I_z [kg m^2].
        above: s_z of the section [kg m^2].
    """
    across = min(across, 0.5 * vertical)
    return across + above, vertical - across + above, vertical


def _module_inertia(module: Module) -> Three:
    m, a, b = module.mass, module.section.half_height, module.section.half_width
    return moments_of_inertia(module.moment_of_inertia, 0.25 * m * b**2, 0.25 * m * a**2)


def _piece_inertia(fin: CaudalFin, piece: Piece) -> Three:
    m = piece.mass
    rod = m * piece.length**2 / 12.0  # as in the planar model
    return moments_of_inertia(rod, m * fin.thickness**2 / 12.0, m * fin.height**2 / 12.0)
