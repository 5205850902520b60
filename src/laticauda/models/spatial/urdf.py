"""A Robot as URDF, for ROS and any other tool that reads it.

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
from laticauda.models.spatial.appearance import MATERIALS, build_fin_plate, check_meshes, copied
from laticauda.models.spatial.bodies import Body, build_bodies, mounts
from laticauda.robot import Joint, Module, Robot
from laticauda.values import BadArgument, angles, files

# Otherwise MuJoCo would merge links that are fixed to each other, and discard visual shapes.
MUJOCO = {"fusestatic": "false", "discardvisual": "false", "strippath": "false"}
Given = str | float | tuple[float, ...]
SHOWN = ("housing", "head", "fin")


def urdf(robot: Robot, meshes: Sequence[str] = ()) -> str:
    """Return the text of a URDF file.

    Args:
        robot: The robot.
        meshes: File name of each module's mesh (STL or OBJ) in the URDF, tail first; if empty,
            cylinders are used.

    Raises:
        ValueError: If there are meshes, but not one per module.
    """
    if meshes and len(meshes) != robot.n_links:
        raise BadArgument(
            "meshes", f"must be one file per module ({robot.n_links}) or none, got {len(meshes)}"
        )
    root = ET.Element("robot", name=robot.name)
    _add(_add(root, "mujoco"), "compiler", **MUJOCO)
    for name in SHOWN:
        _add(_add(root, "material", name=name), "color", rgba=MATERIALS[name][0])
    for body in build_bodies(robot):
        link = _add(root, "link", name=body.name)
        inertial, (ixx, iyy, izz) = _add(link, "inertial"), body.inertia
        below = scenarios.Spatial().ballast_depth if isinstance(body.part, Module) else 0.0
        _add(inertial, "origin", xyz=(body.center, 0.0, -below))
        _add(inertial, "mass", value=body.mass)
        _add(inertial, "inertia", ixx=ixx, iyy=iyy, izz=izz, ixy=0.0, ixz=0.0, iyz=0.0)
        if isinstance(body.part, Module):
            i = int(body.name.removeprefix("module_"))
            _add_module(
                link,
                body.part,
                meshes[i] if meshes else None,
                "head" if i == robot.n_links - 1 else "housing",
            )
        elif (
            robot.caudal_fin is not None
            and (box := build_fin_plate(robot.caudal_fin, body.part)) is not None
        ):
            size = tuple(2.0 * half for half in box.half_size)
            _add_shape(link, "fin", {"xyz": box.position}, "box", size=size)
        if body.parent:
            _add_joint(root, body)
    for mount in mounts(robot):
        _add(root, "link", name=mount.name)
        element = _connect(root, f"{mount.name}_mount", "fixed", mount.body, mount.name)
        (ahead, _, _), (left, _, _), (up, y, z) = angles.from_quaternion(
            *mount.orientation
        ).tolist()
        rpy = math.atan2(y, z), math.atan2(-up, math.hypot(ahead, left)), math.atan2(left, ahead)
        _add(element, "origin", xyz=mount.position, rpy=rpy)
    _add_control(root, robot)
    ET.indent(root)
    return f'<?xml version="1.0"?>\n{ET.tostring(root, encoding="unicode")}\n'


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
    files.write(path, urdf(robot, copied(check_meshes(meshes, robot.n_links), path)))


def _add_module(link: ET.Element, module: Module, mesh: str | None, material: str) -> None:
    if mesh is not None:
        _add_shape(link, material, {}, "mesh", filename=mesh)
        return
    origin = {"xyz": (module.half_length, 0.0, 0.0), "rpy": (0.0, 0.5 * math.pi, 0.0)}
    radius = math.sqrt(
        module.section.half_height * module.section.half_width
    )  # the axis of URDF's cylinders is z
    _add_shape(link, material, origin, "cylinder", radius=radius, length=module.length)


def _add_shape(
    link: ET.Element, material: str, origin: Mapping[str, Given], kind: str, **size: Given
) -> None:
    """Add the same shape for display and for collision."""
    for use in ("visual", "collision"):
        shape = _add(link, use)
        if origin:
            _add(shape, "origin", **origin)
        _add(_add(shape, "geometry"), kind, **size)
        if use == "visual":
            _add(shape, "material", name=material)


def _add_joint(root: ET.Element, body: Body) -> None:
    """Add a joint with its actuator's limits; hinges that represent bending have no springs, as URDF has none."""
    joint = body.joint
    if joint is None:
        element = _connect(root, f"{body.name}_mount", "fixed", body.parent, body.name)
        _add(element, "origin", xyz=body.position, rpy=(0.0, 0.0, 0.0))
        return
    is_driven = isinstance(joint, Joint)
    element = _connect(
        root, body.joint_name, "revolute" if is_driven else "continuous", body.parent, body.name
    )
    _add(element, "origin", xyz=body.position)
    _add(element, "axis", xyz=body.axis)
    if not is_driven:
        _add(element, "dynamics", damping=joint.damping)
        return
    motor, most = joint.actuator, joint.limit
    _add(
        element,
        "limit",
        lower=-most,
        upper=most,
        effort=motor.stall_torque,
        velocity=motor.no_load_speed,
    )
    _add(
        element,
        "dynamics",
        damping=joint.damping + motor.viscous_friction,
        friction=motor.friction_torque,
    )


def _add_control(root: ET.Element, robot: Robot) -> None:
    """Add the ros2_control section: every driven joint takes an angle within its limit and reports its state.

    Its plugin represents a robot that is exactly where it is commanded to be; replace it to use
    another one.
    """
    control = _add(root, "ros2_control", name=robot.name, type="system")
    _add(_add(control, "hardware"), "plugin").text = "mock_components/GenericSystem"
    for body in build_bodies(robot):
        if not isinstance(body.joint, Joint):
            continue
        joint, most = _add(control, "joint", name=body.joint_name), _text(body.joint.limit)
        told = _add(joint, "command_interface", name="position")
        for end, angle in (("min", f"-{most}"), ("max", most)):
            _add(told, "param", name=end).text = angle
        for name in ("position", "velocity", "effort"):
            _add(joint, "state_interface", name=name)


def _connect(root: ET.Element, name: str, kind: str, parent: str, child: str) -> ET.Element:
    element = _add(root, "joint", name=name, type=kind)
    _add(element, "parent", link=parent)
    _add(element, "child", link=child)
    return element


def _add(parent: ET.Element, tag: str, /, **given: Given) -> ET.Element:
    """Add a child element with strings, numbers and tuples of numbers as its attributes."""
    return ET.SubElement(parent, tag, {name: _text(one) for name, one in given.items()})


def _text(given: Given) -> str:
    if isinstance(given, tuple):
        return " ".join(map(_text, given))
    return given if isinstance(given, str) else f"{given:.12g}"
