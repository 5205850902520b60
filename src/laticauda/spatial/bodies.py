"""The bodies of a robot, as all models and pictures have them: frames, joints, masses, and what is mounted on them.

Bodies are `module_0` (tail) to `module_{n-1}` (head). A module's frame has its origin at its tail end, x toward the
head, y to the left and z up. `joint_i` is at the head end of module i and turns module i + 1 about z (yaw) or y
(pitch), so joint angles and all numbering are those of `Robot`: a positive yaw angle turns the head side left, a
positive pitch angle turns it down. The fin is the body `caudal_fin`, fixed to module 0, or on `fin_joint` if it is
driven. If it bends, piece k of it is the body `caudal_fin_k` on the passive hinge `fin_hinge_k`, counted from the root.
The frame of each piece is at its head end, x toward the head. The fin's angles count as those of the body do: positive
ones turn what is behind the hinge to the right.
"""

from typing import NamedTuple

from laticauda.kinematics import levers, to_quaternion, turn
from laticauda.robot import CaudalFin, Hinge, Joint, Module, PectoralFin, Piece, Robot, Thruster
from laticauda.scenarios import Model, Spatial

Three = tuple[float, float, float]
AXES: dict[str, Three] = {"yaw": (0.0, 0.0, 1.0), "pitch": (0.0, 1.0, 0.0)}
FIN_AXIS = (0.0, 0.0, -1.0)  # its bodies hang behind their hinges, those of the body ahead


class Body(NamedTuple):
    """One body."""

    name: str
    """See above."""
    parent: str
    """The body that it hangs on; "" for module 0."""
    position: Three
    """Of its frame in the parent's [m]."""
    part: Module | Piece
    """What it is."""
    mass: float
    """[kg]."""
    center: float
    """Of mass, on its x axis [m]."""
    inertia: Three
    """Moments about axes through it [kg m^2]."""
    joint_name: str = ""
    """Of the joint at its origin; "": it is fixed, or the root."""
    joint: Joint | Hinge | None = None
    """That joint: one that is driven, or a passive hinge."""
    axis: Three = FIN_AXIS
    """About which it turns."""


class Mount(NamedTuple):
    """Where a thruster or a pectoral fin sits."""

    name: str
    """`thruster_k` or `pectoral_fin_k`."""
    body: str
    """On which."""
    position: Three
    """In the body's frame [m]."""
    orientation: tuple[float, float, float, float]
    """Its axes in the body's frame, as a quaternion (w, x, y, z) [-]."""


def bodies(robot: Robot) -> list[Body]:
    """All bodies, parents first: the modules from the tail on, then the fin from its root on."""
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
    """Those of a fin, from its root on."""
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
    """Where its thrusters and pectoral fins are."""
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
    """Turned about z, tilted, rolled about x, and a fin deflected about its own z at last."""
    turned = turn("yaw", one.angle) @ turn("pitch", -one.elevation) @ turn("roll", one.roll)
    return to_quaternion(turned @ turn("yaw", getattr(one, "deflection", 0.0)))


def center_of_mass(robot: Robot) -> float:
    """Center of mass of the straight robot from its tail end, on its axis [m]."""
    return -float(levers(robot).end[0].sum())


def ballast_of(robot: Robot, model: Model | None) -> float:
    """How far the modules' centers of mass lie below their axes in a model [m].

    Args:
        robot: What swims.
        model: By which it swims; None, and the planar one: nothing is said of it.
    """
    if not isinstance(model, Spatial) or not model.gravity:
        return 0.0
    is_free = model.root == "free" or (model.root is None and any(joint.axis == "pitch" for joint in robot.joints))
    return model.ballast_depth if is_free else 0.0


def moments(vertical: float, across: float, above: float) -> Three:
    """Moments of inertia of a body about its x, y and z axis, of which z has to be exact [kg m^2].

    With the second moments s_x, s_y, s_z of the mass, I_z = s_x + s_y and so on. Here I_z is the robot's own, s_y and
    s_z are those of the body's section, and s_x is what is left for it. So a robot that is planar in its numbers (thin
    rods) still has the roll and the pitch of its section, and no combination of numbers is an impossible body.

    Args:
        vertical: I_z [kg m^2].
        across: s_y of the section; at most half of I_z counts [kg m^2].
        above: s_z of the section [kg m^2].
    """
    across = min(across, 0.5 * vertical)
    return across + above, vertical - across + above, vertical


def _module_inertia(module: Module) -> Three:
    m, a, b = module.mass, module.section.half_height, module.section.half_width
    return moments(module.moment_of_inertia, 0.25 * m * b**2, 0.25 * m * a**2)


def _piece_inertia(fin: CaudalFin, piece: Piece) -> Three:
    m = piece.mass
    rod = m * piece.length**2 / 12.0  # as the planar model has it
    return moments(rod, m * fin.thickness**2 / 12.0, m * fin.height**2 / 12.0)
