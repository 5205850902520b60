"""Drag of a FARMS animat, F = c v |v| along each axis of a link, as coefficients of modules for a water.

FARMS has neither added mass nor drag that depends on where along a link the water is; the water of
these modules has no added mass either, and is for comparing.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from laticauda.connect.farms.bodies import Body, Vector
from laticauda.connect.farms.entries import Entry
from laticauda.connect.farms.remarks import Remarks
from laticauda.connect.farms.spine import Spine
from laticauda.robot import Module, Robot, Water
from laticauda.water.fluid import PolynomialDrag

FARMS_WATER = Water(
    name="farms",
    tangential_friction=0.0,
    normal_drag=0.0,
    added_mass=0.0,
    added_inertia=0.0,
    drag=PolynomialDrag(linear=False),
)
"""Water without coefficients of its own, whose drag is quadratic."""


class Drag(NamedTuple):
    """Drag of a segment per squared speed."""

    axial: float
    """Along the body [N s^2/m^2]."""
    lateral: float
    """Across the body [N s^2/m^2]."""


def add_drag(
    robot: Robot,
    spine: Spine,
    links: Mapping[str, Entry],
    remarks: Remarks,
) -> Robot | None:
    """Return the robot with the drag of the links on its modules; None if the file states none.

    Args:
        robot: Robot of the spine.
        spine: Spine, head first.
        links: Entries of the links in the animat's file, by name.
        remarks: Remarks, to which is added what is not taken as it is.
    """
    drags = [
        _drag_of(
            segment=segment,
            spine=spine,
            links=links,
            remarks=remarks,
        )
        for segment in reversed(spine.segments)
    ]
    if not any(drag.axial or drag.lateral for drag in drags):
        return None
    modules = [_with_drag(*pair) for pair in zip(robot.modules, drags, strict=True)]
    return replace(robot, modules=tuple(modules))


def _with_drag(module: Module, drag: Drag) -> Module:
    """Return a module with coefficients that give its drag."""
    section = module.section
    mean_radius = 0.5 * (section.half_height + section.half_width)
    surface = math.pi * mean_radius * module.length
    side = 2.0 * section.half_height * module.length
    half_density = 0.5 * FARMS_WATER.density
    return replace(
        module,
        tangential_friction=drag.axial / (half_density * surface),
        normal_drag=drag.lateral / (half_density * side),
    )


def _drag_of(
    segment: Sequence[Body],
    spine: Spine,
    links: Mapping[str, Entry],
    remarks: Remarks,
) -> Drag:
    """Return the drag of a segment."""
    axial = 0.0
    lateral = 0.0
    for body in segment:
        entry = links.get(body.name)
        if entry is None or not entry.flag("fluid_interaction", entry.flag("swimming", True)):
            continue
        linear, angular = entry.lists_of_numbers("drag_coefficients", 2, 3)
        axial += _coefficient_along(body, spine.forward, linear)
        lateral += _coefficient_along(body, spine.left, linear)
        if any(angular):
            remarks.append(f"drag of link `{body.name}` against turning")
    return Drag(axial=axial, lateral=lateral)


def _coefficient_along(
    body: Body,
    direction: Vector,
    coefficients: Sequence[float],
) -> float:
    """Return the coefficient of the axis of a link that is nearest to a direction."""
    shares = np.abs(body.placement.rotation.T @ direction)
    nearest = int(np.argmax(shares))
    return abs(coefficients[nearest])
