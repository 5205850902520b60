"""Hydrodynamic elements of a robot: one per module and per fin strip, with the planar model's coefficients.

In the swimming plane the coefficients are those of `laticauda.robot.hydrodynamics.link_coefficients`.
Normal to it they follow by turning the ellipse by 90 degrees, with a and b its vertical and lateral
half-axes, l half the module's length:

    c_z = 1/2 rho C_D 2b 2l          mu_z = rho pi C_A b^2 2l
    about y, `paper`: as about z;    `strip`: c_z l^2 / 3, c_z l^3 / 4, mu_z l^2 / 3
    about x: added inertia rho pi C_M (a^2 - b^2)^2 / 8 2l of the ellipse (Newman, Marine Hydrodynamics, 1977, table
    4.3), and the friction c_t at the lever arm r = (a + b) / 2: c_t r^2 (linear) and c_t r^3 (quadratic)

A fin strip of length d and height h is a thin plate: no normal load across its edge, c_z = c_t;
about x the normal drag is spread over its height, c_n (h/2)^2 / 3 and c_n (h/2)^3 / 4, with the
added inertia rho pi C_A (h/2)^4 / 8 d.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from laticauda.models.spatial.bodies import fin_bodies, mounts
from laticauda.robot import (
    CaudalFin,
    Coefficients,
    Environment,
    Ground,
    Module,
    Robot,
    Water,
    law_of,
    link_coefficients,
    mass_across,
    override_or_default,
    wake_mass,
)
from laticauda.values import BadArgument
from laticauda.water.fluid import CoulombFriction, ViscousFriction
from laticauda.water.mujoco import SINK, Contact, Element


def robot_elements(
    robot: Robot, environment: Environment, *, floats: bool = True
) -> tuple[Element, ...]:
    """Return the elements of a robot, on the bodies named in `spatial.bodies`.

    Args:
        robot: The robot.
        environment: The water it swims in, or the ground it crawls on in the plane.
        floats: Whether it has weight and buoyancy. Otherwise the volumes, which accelerating water
            carries along, are distributed as in the planar model.
    """
    c = link_coefficients(robot, environment)
    found = [_module(i, module, c, environment) for i, module in enumerate(robot.modules)]
    if robot.caudal_fin is not None and c.fin is not None:
        found += _fin(robot.caudal_fin, c.fin, environment, floats)
    found += _ends(robot, environment) if isinstance(environment, Water) else []
    found += mounted_elements(robot, environment)  # last, where the twin expects them
    return tuple(found)


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
    found: list[Element] = []
    plates = [
        k for k, e in enumerate(elements) if e.shape == "box" and e.volume > 0.0
    ]  # a strip has no volume
    for k, e in enumerate(elements):
        if not wet:
            e = replace(
                e,
                drag=(0.0, 0.0, 0.0),
                torque_linear=(0.0,) * 3,
                torque_quadratic=(0.0,) * 3,
                volume=0.0,
            )
        if e.body.startswith("module_") and e.shape == "cylinder":
            e = replace(
                e,
                contact=ground_contact(
                    robot.modules[int(e.body.removeprefix("module_"))].mass, ground
                ),
            )
        elif k in plates and robot.caudal_fin is not None:
            fin = robot.caudal_fin
            e = replace(
                e, contact=ground_contact(fin.mass * 2.0 * e.half_size[0] / fin.length, ground)
            )
        found.append(e)
    return tuple(found)


def ground_contact(mass: float, ground: Ground) -> Contact:
    """Return the ground contact of a piece of a robot.

    Args:
        mass: Mass of the piece [kg].
        ground: The ground with its friction; viscous coefficients hold for a piece that lies flat
            under its own weight.
    """
    weight = mass * ground.gravity
    law = ground.friction
    if not isinstance(law, CoulombFriction | ViscousFriction):
        raise BadArgument(
            "friction",
            f"must be coulomb or viscous if the robot's weight rests on it, got {law.words}",
        )
    dry = law.of_weight
    return Contact(
        stiffness=0.5 * weight / SINK,
        damping=2.0 / math.sqrt(ground.gravity * SINK),
        along=ground.tangential if dry else ground.tangential / weight,
        across=ground.normal if dry else ground.normal / weight,
        regularization_speed=law.regularization_speed if isinstance(law, CoulombFriction) else 0.0,
    )


def _module(i: int, module: Module, c: Coefficients, environment: Environment) -> Element:
    l, a, b = module.half_length, module.section.half_height, module.section.half_width  # noqa: E741
    c_t, c_n, mu_t, mu_n = (float(x[i]) for x in (c.c_t, c.c_n, c.mu_t, c.mu_n))
    lambda_1, lambda_2, lambda_3 = (float(x[i]) for x in (c.lambda_1, c.lambda_2, c.lambda_3))
    c_z, mu_z, about_y, roll = c_n, 0.0, (lambda_1, lambda_2, lambda_3), 0.0
    if isinstance(environment, Water):
        c_z = c_n * b / a
        mu_z = mass_across(module.added_mass, b, environment) * 2.0 * l
        if environment.rotational == "strip":
            about_y = (mu_z * l**2 / 3.0, c_z * l**2 / 3.0, c_z * l**3 / 4.0)
        share = override_or_default(module.added_inertia, environment.added_inertia)
        roll = environment.density * np.pi * share * (a**2 - b**2) ** 2 / 8.0 * 2.0 * l
    r = 0.5 * (a + b)
    return Element(
        body=f"module_{i}",
        position=(l, 0.0, 0.0),
        drag=(c_t, c_n, c_z),
        torque_linear=(c_t * r**2, about_y[1], lambda_2),
        torque_quadratic=(c_t * r**3, about_y[2], lambda_3),
        added_mass=(mu_t, mu_n, mu_z),
        added_inertia=(roll, about_y[0], lambda_1),
        volume=module.volume,
        shape="cylinder",
        half_size=(l, b, a),
        law=law_of(environment),
    )


def _fin(fin: CaudalFin, c: Coefficients, environment: Environment, floats: bool) -> list[Element]:
    h, density = 0.5 * fin.height, environment.density if isinstance(environment, Water) else 1.0
    found: list[Element] = []
    bodies = [(body.name, piece) for body, piece in zip(fin_bodies(fin), fin.pieces, strict=True)]
    for k in range(c.mass.size):
        body, piece = next(
            (body, piece) for body, piece in bodies if -float(c.position[k]) < piece.end
        )
        c_t, c_n, mu_n, d = (
            float(c.c_t[k]),
            float(c.c_n[k]),
            float(c.mu_n[k]),
            2.0 * float(c.half_length[k]),
        )
        found.append(
            Element(
                body=body,
                position=(float(c.position[k]) + piece.begin, 0.0, 0.0),
                drag=(c_t, c_n, c_t),
                torque_linear=(c_n * h**2 / 3.0, 0.0, float(c.lambda_2[k])),
                torque_quadratic=(c_n * h**3 / 4.0, 0.0, float(c.lambda_3[k])),
                added_mass=(float(c.mu_t[k]), mu_n, 0.0),
                added_inertia=(mu_n * h**2 / 8.0, 0.0, float(c.lambda_1[k])),
                volume=0.0 if floats else float(c.displaced[k]) / density,
                shape="box",
                half_size=(0.5 * d, 0.5 * fin.thickness, h),
                law=law_of(environment),
            )
        )
    # The whole plate floats, its opening included, because the mass is that of the whole plate.
    for body, piece in bodies:
        half = (0.5 * piece.length, 0.5 * fin.thickness, h)
        volume = fin.volume * piece.length / fin.length if floats else 0.0
        place: dict[str, Any] = {
            "body": body,
            "position": (-half[0], 0.0, 0.0),
            "shape": "box",
            "half_size": half,
        }
        found.append(Element(**place, volume=volume, law=law_of(environment)))
    return found


def _ends(robot: Robot, environment: Water) -> list[Element]:
    """Return the elements of tether and trailing edge, as in the planar model."""
    found: list[Element] = []
    if robot.tether.drag > 0.0 or any(robot.tether.force):
        x, y = robot.tether.force
        found.append(Element(body="module_0", tether_drag=robot.tether.drag, pull=(x, y, 0.0)))
    if environment.trailing_edge == "elongated":
        body, behind = "module_0", 0.0
        if fin := robot.caudal_fin:
            body, behind = fin_bodies(fin)[-1].name, fin.pieces[-1].length
        found.append(
            Element(
                body=body, position=(-behind, 0.0, 0.0), wake_mass=wake_mass(robot, environment)
            )
        )
    return found


def mounted_elements(robot: Robot, environment: Environment) -> list[Element]:
    """Return the elements that a command changes: thrusters and, in water, pectoral fins.

    Args:
        robot: The robot, with the current settings of its effectors.
        environment: The water it swims in, or the ground.
    """
    loads: list[dict[str, Any]] = [{"thrust": (one.thrust, 0.0, 0.0)} for one in robot.thrusters]
    if isinstance(environment, Water):
        for fin in robot.pectoral_fins:
            law = fin.lift_slope, fin.stall_angle, fin.stall_sharpness, fin.parasitic_drag
            loads.append({"plate": (0.5 * environment.density * fin.area, *law)})
    return [
        Element(body=mount.body, position=mount.position, orientation=mount.orientation, **load)
        for mount, load in zip(mounts(robot), loads)  # noqa: B905 - fins come last
    ]
