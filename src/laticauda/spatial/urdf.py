"""A Robot as URDF, for the tools of ROS and for every other reader of it.

Links and joints have the names, the frames and the numbers of `mjcf`; URDF has no ellipses, so links look like round
cylinders of the same volume. The water is not in it: URDF has no words for that.
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence

from laticauda.errors import instance
from laticauda.robot import CaudalFin, Joint, Module, Piece, Robot
from laticauda.spatial import mjcf
from laticauda.spatial.appearance import MATERIALS, seen_opening
from laticauda.spatial.fin import fin_bodies

# MuJoCo would otherwise merge links that cannot move against each other, and forget what is only to be seen.
MUJOCO = {"fusestatic": "false", "discardvisual": "false", "strippath": "false"}
SHOWN = ("housing", "head", "fin")


def urdf(robot: Robot, meshes: Sequence[str] = ()) -> str:
    """The text of a URDF file.

    Args:
        robot: What swims.
        meshes: What the file calls the mesh (STL or OBJ) of each module, tail first; none takes cylinders.

    Raises:
        ValueError: If there are meshes, but not one per module.
    """
    instance("robot", robot, Robot)
    if meshes and len(meshes) != robot.n_links:
        raise ValueError(f"`meshes` must be one file per module, {robot.n_links}, or none, got {len(meshes)}.")
    root = ET.Element("robot", name=robot.name)
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", MUJOCO)
    for name in SHOWN:
        material = ET.SubElement(root, "material", name=name)
        ET.SubElement(material, "color", rgba=_numbers(*MATERIALS[name][0]))
    for i, module in enumerate(robot.modules):
        link = ET.SubElement(root, "link", name=f"module_{i}")
        center, inertia = mjcf.inertia_of(module)
        _add_inertial(link, module.mass, center, inertia)
        _add_shapes(link, module, meshes[i] if meshes else None, "head" if i == robot.n_links - 1 else "housing")
    for i, joint in enumerate(robot.joints):
        _add_joint(root, i, joint, robot.modules[i].length)
    _add_fin(root, robot)
    for kind, effectors in (("thruster", robot.thrusters), ("pectoral_fin", robot.pectoral_fins)):
        for k, effector in enumerate(effectors):
            x = robot.modules[effector.link].half_length + effector.x
            _fix(root, f"{kind}_{k}", f"module_{effector.link}", (x, effector.y, 0.0), effector.angle)
    ET.indent(root)
    return f'<?xml version="1.0"?>\n{ET.tostring(root, encoding="unicode")}\n'


def _add_inertial(link: ET.Element, mass: float, center: float, inertia: tuple[float, float, float]) -> None:
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "origin", xyz=_numbers(center, 0.0, 0.0))
    ET.SubElement(inertial, "mass", value=_numbers(mass))
    values = {name: _numbers(value) for name, value in zip(("ixx", "iyy", "izz"), inertia, strict=True)}
    ET.SubElement(inertial, "inertia", {**values, "ixy": "0", "ixz": "0", "iyz": "0"})


def _add_shapes(link: ET.Element, module: Module, mesh: str | None, material: str) -> None:
    for use in ("visual", "collision"):
        shape = ET.SubElement(link, use)
        if mesh is None:
            along = _numbers(0.0, 0.5 * math.pi, 0.0)  # URDF's cylinders stand on z
            ET.SubElement(shape, "origin", xyz=_numbers(module.half_length, 0.0, 0.0), rpy=along)
            radius = math.sqrt(module.section.half_height * module.section.half_width)
            size = {"radius": _numbers(radius), "length": _numbers(module.length)}
            ET.SubElement(ET.SubElement(shape, "geometry"), "cylinder", size)
        else:
            ET.SubElement(ET.SubElement(shape, "geometry"), "mesh", filename=mesh)
        if use == "visual":
            ET.SubElement(shape, "material", name=material)


def _add_joint(root: ET.Element, index: int, joint: Joint, ahead: float) -> None:
    element = _connect(root, f"joint_{index}", "revolute", f"module_{index}", f"module_{index + 1}")
    _drive(element, joint, (ahead, 0.0, 0.0), mjcf.AXES[joint.axis])


def _drive(element: ET.Element, joint: Joint, at: tuple[float, ...], axis: tuple[float, ...]) -> None:
    """Where a driven joint is, and what its actuator can do."""
    motor = joint.actuator
    _place(element, at, axis)
    bounds = {
        "lower": -joint.limit,
        "upper": joint.limit,
        "effort": motor.stall_torque,
        "velocity": motor.no_load_speed,
    }
    ET.SubElement(element, "limit", {name: _numbers(value) for name, value in bounds.items()})
    damping = joint.damping + motor.viscous_friction
    ET.SubElement(element, "dynamics", damping=_numbers(damping), friction=_numbers(motor.friction_torque))


def _place(element: ET.Element, at: tuple[float, ...], axis: tuple[float, ...]) -> None:
    ET.SubElement(element, "origin", xyz=_numbers(*at))
    ET.SubElement(element, "axis", xyz=_numbers(*axis))


def _add_fin(root: ET.Element, robot: Robot) -> None:
    """The fin's pieces; URDF has no springs, so hinges that stand for its bending have their damping only."""
    fin = robot.caudal_fin
    if fin is None:
        return
    parent, ahead = "module_0", 0.0
    for k, (name, piece) in enumerate(fin_bodies(fin)):
        at = (-ahead, 0.0, 0.0)
        if piece.hinge is not None:
            link = ET.SubElement(root, "link", name=name)
            hinge = _connect(root, f"fin_hinge_{k}", "continuous", parent, name)
            _place(hinge, at, mjcf.FIN_AXIS)
            ET.SubElement(hinge, "dynamics", damping=_numbers(piece.hinge.damping))
        elif fin.joint is not None:
            link = ET.SubElement(root, "link", name=name)
            _drive(_connect(root, "fin_joint", "revolute", parent, name), fin.joint, at, mjcf.FIN_AXIS)
        else:
            link = _fix(root, name, parent, at, 0.0)
        center, inertia = mjcf.fin_inertia(fin, piece)
        _add_inertial(link, piece.mass, center, inertia)
        _add_plate(link, fin, piece)
        parent, ahead = name, piece.length


def _add_plate(link: ET.Element, fin: CaudalFin, piece: Piece) -> None:
    """What is seen of a piece: none of the opening."""
    begin = max(seen_opening(fin), piece.begin)
    if begin >= piece.end:
        return
    for use in ("visual", "collision"):
        shape = ET.SubElement(link, use)
        ET.SubElement(shape, "origin", xyz=_numbers(piece.begin - 0.5 * (begin + piece.end), 0.0, 0.0))
        size = _numbers(piece.end - begin, fin.thickness, fin.height)
        ET.SubElement(ET.SubElement(shape, "geometry"), "box", size=size)
        if use == "visual":
            ET.SubElement(shape, "material", name="fin")


def _fix(root: ET.Element, name: str, parent: str, at: tuple[float, float, float], yaw: float) -> ET.Element:
    """A link that cannot move against its parent."""
    link = ET.SubElement(root, "link", name=name)
    element = _connect(root, f"{name}_mount", "fixed", parent, name)
    ET.SubElement(element, "origin", xyz=_numbers(*at), rpy=_numbers(0.0, 0.0, yaw))
    return link


def _connect(root: ET.Element, name: str, kind: str, parent: str, child: str) -> ET.Element:
    element = ET.SubElement(root, "joint", name=name, type=kind)
    ET.SubElement(element, "parent", link=parent)
    ET.SubElement(element, "child", link=child)
    return element


def _numbers(*values: float) -> str:
    return " ".join(f"{value:.12g}" for value in values)
