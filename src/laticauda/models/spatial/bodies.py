"""The bodies of a robot, as used in all models and pictures: frames, joints and masses.

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

from laticauda.robot import CaudalFin, Hinge, Joint, Module, Piece, Robot, levers
from laticauda.scenarios import Model, Spatial

Three = tuple[float, float, float]

AXES: dict[str, Three] = {"yaw": (0.0, 0.0, 1.0), "pitch": (0.0, 1.0, 0.0)}
"""Axis of rotation of a joint of the body, by its kind."""
FIN_AXIS = (0.0, 0.0, -1.0)
"""Axis of rotation of a joint of the fin: fin bodies lie behind their hinges, modules ahead of theirs."""


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


def build_bodies(robot: Robot) -> list[Body]:
    """Return all bodies, parents first: the modules from the tail, then the fin from its root."""
    bodies = [_build_module(robot, i) for i in range(robot.n_links)]
    if robot.caudal_fin is not None:
        bodies += build_fin_bodies(robot.caudal_fin)
    return bodies


def _build_module(robot: Robot, i: int) -> Body:
    """Return the body of module i."""
    module = robot.modules[i]
    body = Body(
        name=f"module_{i}",
        parent="",
        position=(0.0, 0.0, 0.0),
        part=module,
        mass=module.mass,
        center=module.half_length + module.center,
        inertia=_module_inertia(module),
        axis=AXES["yaw"],
    )
    if i == 0:
        return body
    joint = robot.joints[i - 1]
    return body._replace(
        parent=f"module_{i - 1}",
        position=(robot.modules[i - 1].length, 0.0, 0.0),
        joint_name=f"joint_{i - 1}",
        joint=joint,
        axis=AXES[joint.axis],
    )


def build_fin_bodies(fin: CaudalFin) -> list[Body]:
    """Return the bodies of a fin, starting at its root."""
    bodies: list[Body] = []
    parent = "module_0"
    length_of_parent = 0.0
    for k, piece in enumerate(fin.pieces):
        body = Body(
            name=_fin_body_name(k),
            parent=parent,
            position=(-length_of_parent, 0.0, 0.0),
            part=piece,
            mass=piece.mass,
            center=-0.5 * piece.length,
            inertia=_piece_inertia(fin, piece),
        )
        if piece.hinge is not None:
            body = body._replace(joint_name=f"fin_hinge_{k}", joint=piece.hinge)
        elif fin.joint is not None:
            body = body._replace(joint_name="fin_joint", joint=fin.joint)
        bodies.append(body)
        parent = body.name
        length_of_parent = piece.length
    return bodies


def _fin_body_name(k: int) -> str:
    """Return the name of the body of piece k of the fin."""
    if k == 0:
        return "caudal_fin"
    return f"caudal_fin_{k}"


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
    has_pitch_joints = any(joint.axis == "pitch" for joint in robot.joints)
    is_free = model.root == "free" or (model.root is None and has_pitch_joints)
    if not is_free:
        return 0.0
    return model.ballast_depth


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
    """Return the moments of inertia of a module, an elliptic cylinder."""
    mass = module.mass
    a = module.section.half_height
    b = module.section.half_width
    return moments_of_inertia(
        vertical=module.moment_of_inertia, across=0.25 * mass * b**2, above=0.25 * mass * a**2
    )


def _piece_inertia(fin: CaudalFin, piece: Piece) -> Three:
    """Return the moments of inertia of a piece of the fin: a thin rod about z, as in the planar model."""
    mass = piece.mass
    return moments_of_inertia(
        vertical=mass * piece.length**2 / 12.0,
        across=mass * fin.thickness**2 / 12.0,
        above=mass * fin.height**2 / 12.0,
    )
