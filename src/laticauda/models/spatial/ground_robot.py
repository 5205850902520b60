"""A robot that lies on the ground with its weight: its elements get contacts, with the ground's friction."""

import math
from dataclasses import replace

from laticauda.robot import CaudalFin, Ground, Robot
from laticauda.values import BadArgument
from laticauda.water.fluid import CoulombFriction, ViscousFriction
from laticauda.water.mujoco import SINK, Contact, Element

NO_TORQUE = (0.0, 0.0, 0.0)
"""Coefficients of an element whose rotation the water does not resist."""


def lay_on_ground(
    elements: tuple[Element, ...], robot: Robot, ground: Ground, *, wet: bool
) -> tuple[Element, ...]:
    """Return the elements of a robot that lies on the ground with its weight.

    Args:
        elements: Elements from `robot_elements`.
        robot: The robot.
        ground: The ground with its friction.
        wet: Whether there may be water above the ground; if not, drag and volume are set to zero.
    """
    lying: list[Element] = []
    for element in elements:
        mass = _supported_mass(element, robot)
        if not wet:
            element = _remove_water(element)
        if mass is not None:
            element = replace(element, contact=ground_contact(mass, ground))
        lying.append(element)
    return tuple(lying)


def _supported_mass(element: Element, robot: Robot) -> float | None:
    """Return the mass that rests on the ground at an element [kg], or None if the element bears none.

    Modules and the plates of the fin bear the robot; the fin's strips, which have no volume, do not.
    """
    if element.shape == "cylinder" and element.body.startswith("module_"):
        module = robot.modules[int(element.body.removeprefix("module_"))]
        return module.mass
    if element.shape == "box" and element.volume > 0.0 and robot.caudal_fin is not None:
        return _mass_of_plate(robot.caudal_fin, element)
    return None


def _mass_of_plate(fin: CaudalFin, plate: Element) -> float:
    """Return the mass of the piece of a fin that a plate represents [kg]."""
    half_length, _, _ = plate.half_size
    return fin.mass * 2.0 * half_length / fin.length


def _remove_water(element: Element) -> Element:
    """Return an element on dry ground."""
    return replace(
        element,
        drag=(0.0, 0.0, 0.0),
        torque_linear=NO_TORQUE,
        torque_quadratic=NO_TORQUE,
        volume=0.0,
    )


def ground_contact(mass: float, ground: Ground) -> Contact:
    """Return the ground contact of a piece of a robot.

    Args:
        mass: Mass of the piece [kg].
        ground: The ground with its friction; viscous coefficients hold for a piece that lies flat
            under its own weight.
    """
    law = ground.friction
    if not isinstance(law, CoulombFriction | ViscousFriction):
        rule = f"must be coulomb or viscous if the robot's weight rests on it, got {law.words}"
        raise BadArgument("friction", rule)
    weight = mass * ground.gravity
    along = ground.tangential
    across = ground.normal
    if not law.of_weight:
        along = along / weight
        across = across / weight
    regularization_speed = 0.0
    if isinstance(law, CoulombFriction):
        regularization_speed = law.regularization_speed
    return Contact(
        stiffness=0.5 * weight / SINK,
        damping=2.0 / math.sqrt(ground.gravity * SINK),
        along=along,
        across=across,
        regularization_speed=regularization_speed,
    )
