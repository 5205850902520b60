"""A robot as URDF, for ROS and any other tool that reads it.

Links and joints have the names, frames and parameters of `spatial.bodies`; URDF has no ellipses, so
links are shown as round cylinders of the same volume. The water is not included: URDF cannot
describe it. The modules' centers of mass lie as far below their axes as in a simulation
(`Spatial.ballast_depth`).
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from laticauda import scenarios
from laticauda.models.spatial.appearance import MATERIALS, choose_material
from laticauda.models.spatial.bodies import Body, Three, build_bodies
from laticauda.models.spatial.fin_shapes import build_fin_plate
from laticauda.models.spatial.mesh_files import check_count, check_meshes, copy_meshes
from laticauda.models.spatial.mounts import Mount, Quaternion, build_mounts
from laticauda.robot import CaudalFin, Joint, Module, Piece, Robot
from laticauda.values import angles, files

MUJOCO = {"fusestatic": "false", "discardvisual": "false", "strippath": "false"}
"""Options without which MuJoCo would merge links that are fixed to each other, and discard visual shapes."""
SHOWN = ("housing", "head", "fin")
"""Materials of the links."""
NO_ROTATION = (0.0, 0.0, 0.0)
"""Roll, pitch and yaw of a frame that is parallel to its parent's [rad]."""
ALONG_X = (0.0, 0.5 * math.pi, 0.0)
"""Roll, pitch and yaw of a cylinder along x; the axis of URDF's cylinders is z [rad]."""
STATES = ("position", "velocity", "effort")
"""What a driven joint reports."""

Attribute = str | float | tuple[float, ...]


def build_urdf(robot: Robot, meshes: Sequence[str] = ()) -> str:
    """Return the text of a URDF file.

    Args:
        robot: The robot.
        meshes: File name of each module's mesh (STL or OBJ) in the URDF, tail first; if empty,
            cylinders are used.

    Raises:
        ValueError: If there are meshes, but not one per module.
    """
    if meshes:
        check_count(len(meshes), robot.n_links)
    root = ET.Element("robot", name=robot.name)
    _add_materials(root)
    for body in build_bodies(robot):
        link = _add(root, "link", name=body.name)
        _add_inertia(link, body)
        if isinstance(body.part, Module):
            i = int(body.name.removeprefix("module_"))
            is_head = i == robot.n_links - 1
            if meshes:
                _add_mesh(link, meshes[i], is_head=is_head)
            else:
                _add_cylinder(link, body.part, is_head=is_head)
        elif robot.caudal_fin is not None:
            _add_fin_plate(link, robot.caudal_fin, body.part)
        if body.parent:
            _add_joint(root, body)
    for mount in build_mounts(robot):
        _add_mount(root, mount)
    _add_control(root, robot)
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    return f'<?xml version="1.0"?>\n{text}\n'


def write_urdf(path: str | Path, robot: Robot, *, meshes: Iterable[str | Path] = ()) -> None:
    """Write a robot to a URDF file, with copies of mesh files next to it.

    Args:
        path: The file (.urdf); an existing file is replaced.
        robot: The robot.
        meshes: One file (STL or OBJ) per module, tail first, in the module's frame and in meters;
            if empty, modules are drawn as cylinders.

    Raises:
        ValueError: If an argument is out of range.
        StorageFailed: If the file cannot be written.
    """
    path = Path(path)
    mesh_files = check_meshes(meshes, robot.n_links)
    copies = copy_meshes(mesh_files, path)
    files.write(path, build_urdf(robot, copies))


def _add_materials(root: ET.Element) -> None:
    options = _add(root, "mujoco")
    _add(options, "compiler", **MUJOCO)
    for name in SHOWN:
        material = _add(root, "material", name=name)
        _add(material, "color", rgba=MATERIALS[name].color)


def _add_inertia(link: ET.Element, body: Body) -> None:
    """Add center of mass, mass and moments of inertia of a link."""
    inertial = _add(link, "inertial")
    depth = 0.0
    if isinstance(body.part, Module):
        depth = scenarios.Spatial().ballast_depth
    ixx, iyy, izz = body.inertia
    _add(inertial, "origin", xyz=(body.center, 0.0, -depth))
    _add(inertial, "mass", value=body.mass)
    _add(inertial, "inertia", ixx=ixx, iyy=iyy, izz=izz, ixy=0.0, ixz=0.0, iyz=0.0)


def _add_mesh(link: ET.Element, mesh: str, *, is_head: bool) -> None:
    """Show a module by its mesh."""
    _add_shape(link, choose_material(is_head=is_head), {}, "mesh", filename=mesh)


def _add_cylinder(link: ET.Element, module: Module, *, is_head: bool) -> None:
    """Show a module as a cylinder of the same volume."""
    material = choose_material(is_head=is_head)
    origin = {"xyz": (module.half_length, 0.0, 0.0), "rpy": ALONG_X}
    radius = math.sqrt(module.section.half_height * module.section.half_width)
    _add_shape(link, material, origin, "cylinder", radius=radius, length=module.length)


def _add_fin_plate(link: ET.Element, fin: CaudalFin, piece: Piece) -> None:
    plate = build_fin_plate(fin, piece)
    if plate is None:
        return
    size = tuple(2.0 * half for half in plate.half_size)
    _add_shape(link, "fin", {"xyz": plate.position}, "box", size=size)


def _add_shape(
    link: ET.Element, material: str, origin: Mapping[str, Attribute], kind: str, **size: Attribute
) -> None:
    """Add the same shape for display and for collision."""
    for use in ("visual", "collision"):
        shape = _add(link, use)
        if origin:
            _add(shape, "origin", **origin)
        geometry = _add(shape, "geometry")
        _add(geometry, kind, **size)
        if use == "visual":
            _add(shape, "material", name=material)


def _add_joint(root: ET.Element, body: Body) -> None:
    """Add a joint with its actuator's limits; hinges that represent bending have no springs, as URDF has none."""
    joint = body.joint
    if joint is None:
        fixed = _connect(root, f"{body.name}_mount", "fixed", parent=body.parent, child=body.name)
        _add(fixed, "origin", xyz=body.position, rpy=NO_ROTATION)
        return
    kind = "continuous"
    if isinstance(joint, Joint):
        kind = "revolute"
    element = _connect(root, body.joint_name, kind, parent=body.parent, child=body.name)
    _add(element, "origin", xyz=body.position)
    _add(element, "axis", xyz=body.axis)
    if isinstance(joint, Joint):
        _add_limits(element, joint)
    else:
        _add(element, "dynamics", damping=joint.damping)


def _add_limits(element: ET.Element, joint: Joint) -> None:
    """Add the limits and the friction of a driven joint and its actuator."""
    motor = joint.actuator
    damping = joint.damping + motor.viscous_friction
    _add(
        element,
        "limit",
        lower=-joint.limit,
        upper=joint.limit,
        effort=motor.stall_torque,
        velocity=motor.no_load_speed,
    )
    _add(element, "dynamics", damping=damping, friction=motor.friction_torque)


def _add_mount(root: ET.Element, mount: Mount) -> None:
    """Add a link for a thruster or a pectoral fin, fixed to its module."""
    _add(root, "link", name=mount.name)
    fixed = _connect(root, f"{mount.name}_mount", "fixed", parent=mount.body, child=mount.name)
    _add(fixed, "origin", xyz=mount.position, rpy=_roll_pitch_yaw(mount.orientation))


def _roll_pitch_yaw(orientation: Quaternion) -> Three:
    """Return an orientation as URDF has it, from its rotation matrix [rad]."""
    x_row, y_row, z_row = angles.from_quaternion(*orientation).tolist()
    roll = math.atan2(z_row[1], z_row[2])
    pitch = math.atan2(-z_row[0], math.hypot(x_row[0], y_row[0]))
    yaw = math.atan2(y_row[0], x_row[0])
    return roll, pitch, yaw


def _add_control(root: ET.Element, robot: Robot) -> None:
    """Add the ros2_control section: every driven joint takes an angle within its limit and reports its state.

    Its plugin represents a robot that is exactly where it is commanded to be; replace it to use
    another one.
    """
    control = _add(root, "ros2_control", name=robot.name, type="system")
    hardware = _add(control, "hardware")
    _add(hardware, "plugin").text = "mock_components/GenericSystem"
    for body in build_bodies(robot):
        if not isinstance(body.joint, Joint):
            continue
        joint = _add(control, "joint", name=body.joint_name)
        command = _add(joint, "command_interface", name="position")
        limit = _format_attribute(body.joint.limit)
        _add(command, "param", name="min").text = f"-{limit}"
        _add(command, "param", name="max").text = limit
        for name in STATES:
            _add(joint, "state_interface", name=name)


def _connect(root: ET.Element, name: str, kind: str, *, parent: str, child: str) -> ET.Element:
    """Add a joint between two links, and return it."""
    element = _add(root, "joint", name=name, type=kind)
    _add(element, "parent", link=parent)
    _add(element, "child", link=child)
    return element


def _add(parent: ET.Element, tag: str, /, **attributes: Attribute) -> ET.Element:
    """Add a child element with strings, numbers and tuples of numbers as its attributes, and return it."""
    texts = {name: _format_attribute(value) for name, value in attributes.items()}
    return ET.SubElement(parent, tag, texts)


def _format_attribute(value: Attribute) -> str:
    if isinstance(value, tuple):
        return " ".join(map(_format_attribute, value))
    if isinstance(value, str):
        return value
    return f"{value:.12g}"
