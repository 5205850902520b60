"""A robot of a spine: modules with length, mass and section, and joints with their limits; tail first.

Between two hinges a module reaches from one to the other; at the ends of the body, from the hinge to
where its shapes end. Without shapes, it ends as far beyond its center of mass as the hinge is before it.
Sections are those of boxes, cylinders, capsules and ellipsoids; where there are meshes or nothing, those
of an elliptic cylinder with the same mass and moments of inertia.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np

from laticauda.connect.farms.bodies import (
    WEIGHTLESS,
    Body,
    Hinge,
    Lump,
    Vector,
    extent_of,
    is_parallel,
    normalize,
    solids_of,
)
from laticauda.connect.farms.remarks import Remarks
from laticauda.connect.farms.spine import Spine
from laticauda.robot import Actuator, Joint, Module, Robot, Section
from laticauda.values import BadArgument

UNKNOWN_ACTUATOR = Actuator(stated=False)
"""Actuator of a joint whose motor the files do not state."""


def build_robot(
    name: str,
    description: str,
    spine: Spine,
    actuators: Mapping[str, Actuator],
    remarks: Remarks,
) -> Robot:
    """Return the robot of a spine.

    Args:
        name: Its name.
        description: What it is, in one line.
        spine: Its spine.
        actuators: Actuators of joints, by the joints' names.
        remarks: Remarks, to which is added what is not taken as it is.

    Raises:
        ValueError: If a segment has no mass, no length or no section.
    """
    modules = [_build_module(spine, index) for index in range(len(spine.segments))]
    joints = [
        _build_joint(
            spine=spine,
            hinge=hinge,
            actuator=actuators.get(hinge.name, UNKNOWN_ACTUATOR),
            remarks=remarks,
        )
        for hinge in spine.hinges
    ]
    return Robot(
        name=name,
        description=description,
        modules=tuple(reversed(modules)),
        joints=tuple(reversed(joints)),
    )


def _build_joint(
    spine: Spine,
    hinge: Hinge,
    actuator: Actuator,
    remarks: Remarks,
) -> Joint:
    """Return the joint of a hinge."""
    name = hinge.name
    limits = f"{hinge.lower:.4g} and {hinge.upper:.4g} rad"
    limit = min(-hinge.lower, hinge.upper, math.pi)
    if limit <= 0.0:
        rule = "must bend to both sides of 0"
        raise ValueError(f"its joint `{name}` {rule}, but its limits are {limits}")
    if not math.isclose(-hinge.lower, hinge.upper, rel_tol=1e-6):
        remarks.append(f"limits of joint `{name}`, {limits}: the smaller one applies to both sides")
    axis: Literal["yaw", "pitch"] = "pitch"
    if is_parallel(hinge.axis, spine.up):
        axis = "yaw"
    elif not is_parallel(hinge.axis, spine.left):
        raise ValueError(f"its joint `{name}` must be a yaw or pitch joint, its axis is oblique")
    return Joint(
        axis=axis,
        limit=limit,
        actuator=actuator,
        stiffness=hinge.stiffness,
        damping=hinge.damping,
    )


# ---- modules -------------------------------------------------------------------------------------


def _build_module(spine: Spine, index: int) -> Module:
    """Return the module of a segment; 0 is the head."""
    bodies = spine.segments[index]
    name = bodies[0].name
    if sum(body.mass for body in bodies) <= WEIGHTLESS:
        raise ValueError(f"its link `{name}` is part of the spine and must have a mass")
    lump = Lump.of(bodies)
    ends = _find_ends(spine, index, lump)
    span = ends.front - ends.rear
    length = float(np.linalg.norm(span))
    if length <= 0.0:
        raise ValueError(f"its link `{name}` has no length: two joints are at one place")
    direction = normalize(span)
    middle = 0.5 * (ends.front + ends.rear)
    center = float((lump.center - middle) @ direction)
    yaw_inertia = float(spine.up @ lump.inertia @ spine.up)
    section = _find_section(spine, bodies, lump)
    try:
        return Module(
            length=length,
            mass=lump.mass,
            section=section,
            center=max(-0.5 * length, min(center, 0.5 * length)),
            inertia=yaw_inertia or None,
        )
    except BadArgument as refusal:
        raise ValueError(f"its link `{name}` cannot be a module: {refusal}") from None


class _Ends(NamedTuple):
    """Ends of a segment, in the common frame."""

    front: Vector
    """The one toward the head [m]."""
    rear: Vector
    """The one toward the tail [m]."""


def _find_ends(
    spine: Spine,
    index: int,
    lump: Lump,
) -> _Ends:
    """Return the ends of a segment."""
    hinges = spine.hinges
    if index == 0:
        rear = hinges[0].anchor
        front = _find_free_end(
            spine=spine,
            index=index,
            anchor=rear,
            lump=lump,
        )
        return _Ends(front=front, rear=rear)
    front = hinges[index - 1].anchor
    if index < len(hinges):
        return _Ends(front=front, rear=hinges[index].anchor)
    rear = _find_free_end(
        spine=spine,
        index=index,
        anchor=front,
        lump=lump,
    )
    return _Ends(front=front, rear=rear)


def _find_free_end(
    spine: Spine,
    index: int,
    anchor: Vector,
    lump: Lump,
) -> Vector:
    """Return the end of the head or of the tail that no joint is at."""
    bodies = spine.segments[index]
    outward = spine.forward
    if index > 0:
        outward = -outward
    extent = extent_of(bodies, outward)
    if extent is None:
        reach = 2.0 * float((lump.center - anchor) @ outward)
    else:
        reach = extent.high - float(anchor @ outward)
    if reach <= 0.0:
        name = bodies[0].name
        raise ValueError(f"its link `{name}` must reach beyond its only joint, but ends before it")
    return anchor + reach * outward


def _find_section(
    spine: Spine,
    bodies: Sequence[Body],
    lump: Lump,
) -> Section:
    """Return the section of the shapes of a segment, or that which its moments of inertia imply."""
    width = extent_of(bodies, spine.left)
    height = extent_of(bodies, spine.up)
    kinds = {solid.kind for solid in solids_of(bodies)}
    if width is None or height is None or "mesh" in kinds:
        return _section_of_inertia(spine, bodies[0].name, lump)
    shape: Literal["ellipse", "box"] = "ellipse"
    if kinds == {"box"}:
        shape = "box"
    return Section(half_height=height.half, half_width=width.half, shape=shape)


def _section_of_inertia(
    spine: Spine,
    name: str,
    lump: Lump,
) -> Section:
    """Return the section of the elliptic cylinder with a segment's mass and moments of inertia."""
    roll_inertia = float(spine.forward @ lump.inertia @ spine.forward)
    pitch_inertia = float(spine.left @ lump.inertia @ spine.left)
    yaw_inertia = float(spine.up @ lump.inertia @ spine.up)
    square_of_width = 2.0 * (roll_inertia + yaw_inertia - pitch_inertia) / lump.mass
    square_of_height = 2.0 * (roll_inertia + pitch_inertia - yaw_inertia) / lump.mass
    if min(square_of_width, square_of_height) <= 0.0:
        need = "a collision shape, or moments of inertia that a body can have"
        raise ValueError(f"its link `{name}` needs {need}")
    return Section(
        half_height=math.sqrt(square_of_height),
        half_width=math.sqrt(square_of_width),
    )
