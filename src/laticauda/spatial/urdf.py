"""A Robot as URDF, for the tools of ROS and for every other reader of it.

Links and joints have the names, the frames and the numbers of `spatial.bodies`; URDF has no ellipses, so links look
like round cylinders of the same volume. The water is not in it: URDF has no words for that.
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from pathlib import Path

from laticauda.errors import BadArgument, instance
from laticauda.files import write
from laticauda.robot import Joint, Module, Robot
from laticauda.spatial.appearance import MATERIALS, Box, checked, copied, plate
from laticauda.spatial.bodies import Body, bodies, mounts

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
        raise BadArgument("meshes", f"must be one file per module, {robot.n_links}, or none, got {len(meshes)}")
    root = ET.Element("robot", name=robot.name)
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", MUJOCO)
    for name in SHOWN:
        material = ET.SubElement(root, "material", name=name)
        ET.SubElement(material, "color", rgba=_numbers(*MATERIALS[name][0]))
    for body in bodies(robot):
        link = ET.SubElement(root, "link", name=body.name)
        _add_inertial(link, body)
        if isinstance(body.part, Module):
            i = int(body.name.removeprefix("module_"))
            _add_module(link, body.part, meshes[i] if meshes else None, "head" if i == robot.n_links - 1 else "housing")
        elif robot.caudal_fin is not None and (box := plate(robot.caudal_fin, body.part)) is not None:
            _add_plate(link, box)
        if body.parent:
            _add_joint(root, body)
    for mount in mounts(robot):
        ET.SubElement(root, "link", name=mount.name)
        element = _connect(root, f"{mount.name}_mount", "fixed", mount.body, mount.name)
        ET.SubElement(element, "origin", xyz=_numbers(*mount.position), rpy=_numbers(0.0, 0.0, mount.angle))
    ET.indent(root)
    return f'<?xml version="1.0"?>\n{ET.tostring(root, encoding="unicode")}\n'


def write_urdf(path: str | Path, robot: Robot, *, meshes: Iterable[str | Path] = ()) -> None:
    """Write a robot to a URDF file; mesh files are copied beside it.

    Args:
        path: The file (.urdf); an older one is replaced.
        robot: What swims.
        meshes: As for `mjcf.spec`.

    Raises:
        ValueError: If an argument is out of its range.
        StorageFailed: If the file cannot be written.
    """
    path = Path(path)
    write(path, urdf(robot, copied(checked(meshes, robot.n_links), path)))


def _add_inertial(link: ET.Element, body: Body) -> None:
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "origin", xyz=_numbers(body.center, 0.0, 0.0))
    ET.SubElement(inertial, "mass", value=_numbers(body.mass))
    values = {name: _numbers(value) for name, value in zip(("ixx", "iyy", "izz"), body.inertia, strict=True)}
    ET.SubElement(inertial, "inertia", {**values, "ixy": "0", "ixz": "0", "iyz": "0"})


def _add_module(link: ET.Element, module: Module, mesh: str | None, material: str) -> None:
    if mesh is not None:
        _add_shape(link, material, {}, "mesh", {"filename": mesh})
        return
    origin = {"xyz": _numbers(module.half_length, 0.0, 0.0), "rpy": _numbers(0.0, 0.5 * math.pi, 0.0)}
    radius = math.sqrt(module.section.half_height * module.section.half_width)  # URDF's cylinders stand on z
    _add_shape(link, material, origin, "cylinder", {"radius": _numbers(radius), "length": _numbers(module.length)})


def _add_plate(link: ET.Element, box: Box) -> None:
    size = _numbers(*(2.0 * half for half in box.half_size))
    _add_shape(link, "fin", {"xyz": _numbers(*box.position)}, "box", {"size": size})


def _add_shape(link: ET.Element, material: str, origin: dict[str, str], kind: str, size: dict[str, str]) -> None:
    """The same to see and to collide with."""
    for use in ("visual", "collision"):
        shape = ET.SubElement(link, use)
        if origin:
            ET.SubElement(shape, "origin", origin)
        ET.SubElement(ET.SubElement(shape, "geometry"), kind, size)
        if use == "visual":
            ET.SubElement(shape, "material", name=material)


def _add_joint(root: ET.Element, body: Body) -> None:
    """A joint with what its actuator can do; hinges that stand for bending have no springs here, as URDF has none."""
    joint = body.joint
    if joint is None:
        element = _connect(root, f"{body.name}_mount", "fixed", body.parent, body.name)
        ET.SubElement(element, "origin", xyz=_numbers(*body.position), rpy=_numbers(0.0, 0.0, 0.0))
        return
    is_driven = isinstance(joint, Joint)
    element = _connect(root, body.joint_name, "revolute" if is_driven else "continuous", body.parent, body.name)
    ET.SubElement(element, "origin", xyz=_numbers(*body.position))
    ET.SubElement(element, "axis", xyz=_numbers(*body.axis))
    if not is_driven:
        ET.SubElement(element, "dynamics", damping=_numbers(joint.damping))
        return
    motor = joint.actuator
    bounds = (-joint.limit, joint.limit, motor.stall_torque, motor.no_load_speed)
    names = ("lower", "upper", "effort", "velocity")
    ET.SubElement(element, "limit", dict(zip(names, map(_numbers, bounds), strict=True)))
    damping = joint.damping + motor.viscous_friction
    ET.SubElement(element, "dynamics", damping=_numbers(damping), friction=_numbers(motor.friction_torque))


def _connect(root: ET.Element, name: str, kind: str, parent: str, child: str) -> ET.Element:
    element = ET.SubElement(root, "joint", name=name, type=kind)
    ET.SubElement(element, "parent", link=parent)
    ET.SubElement(element, "child", link=child)
    return element


def _numbers(*values: float) -> str:
    return " ".join(f"{value:.12g}" for value in values)
