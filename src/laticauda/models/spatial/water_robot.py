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

import numpy as np

from laticauda.models.spatial.bodies import Three, build_fin_bodies
from laticauda.models.spatial.mounts import build_mounts
from laticauda.robot import (
    CaudalFin,
    Coefficients,
    Environment,
    FinEdge,
    Module,
    Robot,
    Water,
    fin_edge,
    law_of,
    link_coefficients,
    mass_across,
    override_or_default,
    wake_mass,
)
from laticauda.values import BadArgument
from laticauda.water.mujoco import Element

NONE: Three = (0.0, 0.0, 0.0)
"""No load along any axis."""


def robot_elements(
    robot: Robot, environment: Environment, *, floats: bool = True, advances_edge: bool = False
) -> tuple[Element, ...]:
    """Return the elements of a robot, on the bodies named in `spatial.bodies`.

    Args:
        robot: The robot.
        environment: The water it swims in, or the ground it crawls on in the plane.
        floats: Whether it has weight and buoyancy. Otherwise the volumes, which accelerating water
            carries along, are distributed as in the planar model.
        advances_edge: Whether the caller writes and advances the state of an edge of finite span.

    Raises:
        ValueError: If the water requires such a state, and the caller does not advance it.
    """
    edge = None
    if isinstance(environment, Water):
        edge = fin_edge(robot, environment)
    if edge is not None and not advances_edge:
        raise BadArgument(
            "trailing_edge",
            "must be `elongated` or `none` for elements in a MuJoCo model of one's own, which does not advance "
            "the state of an edge (the plant of `spatial` does), got 'finite-span'",
        )
    coefficients = link_coefficients(robot, environment)
    elements: list[Element] = []
    for i, module in enumerate(robot.modules):
        elements.append(_build_module(i, module, coefficients, environment))
    if robot.caudal_fin is not None and coefficients.fin is not None:
        strips = _build_strips(robot.caudal_fin, coefficients.fin, environment, floats=floats)
        if edge is not None:
            strips = _gather_inertia(strips, coefficients.fin)
        elements += strips
        elements += _build_plates(robot.caudal_fin, environment, floats=floats)
    if isinstance(environment, Water):
        elements += _build_areas(robot, coefficients, environment)
        elements += _build_tether(robot)
        elements += _build_trailing_edge(robot, environment, edge)
    # Last, where the twin expects them.
    elements += mounted_elements(robot, environment)
    return tuple(elements)


def _gather_inertia(strips: list[Element], c: Coefficients) -> list[Element]:
    """Return strips without added mass, and as many masses without drag, closer to the middle of the plate.

    Together these have the added mass and the moment of inertia of strips whose own inertia would be negative.
    """
    middle = float(np.average(c.position, weights=c.mu_n))
    arm = c.position - middle
    spread = float(c.mu_n @ (arm * arm))
    share = math.sqrt((spread + float(c.lambda_1.sum())) / spread)
    masses: list[Element] = []
    for strip, distance in zip(strips, arm, strict=True):
        x, y, z = strip.position
        mass = replace(
            strip,
            position=(x + (share - 1.0) * float(distance), y, z),
            drag=NONE,
            torque_linear=NONE,
            torque_quadratic=NONE,
            added_inertia=(strip.added_inertia[0], 0.0, 0.0),
            volume=0.0,
        )
        masses.append(mass)
    bare = [replace(strip, added_mass=NONE, added_inertia=NONE) for strip in strips]
    return bare + masses


def _build_module(i: int, module: Module, c: Coefficients, environment: Environment) -> Element:
    """Return the element of module i; its symbols are those of the module's docstring."""
    l = module.half_length  # noqa: E741
    a = module.section.half_height
    b = module.section.half_width
    c_t = float(c.c_t[i])
    c_n = float(c.c_n[i])
    mu_t = float(c.mu_t[i])
    mu_n = float(c.mu_n[i])
    lambda_1 = float(c.lambda_1[i])
    lambda_2 = float(c.lambda_2[i])
    lambda_3 = float(c.lambda_3[i])
    # About y, `paper`: as about z.
    inertia_y = lambda_1
    linear_y = lambda_2
    quadratic_y = lambda_3
    c_z = c_n
    mu_z = 0.0
    roll_inertia = 0.0
    if isinstance(environment, Water):
        c_z = c_n * b / a
        mu_z = mass_across(module.added_mass, b, environment) * 2.0 * l
        if environment.rotational == "strip":
            inertia_y = mu_z * l**2 / 3.0
            linear_y = c_z * l**2 / 3.0
            quadratic_y = c_z * l**3 / 4.0
        c_m = override_or_default(module.added_inertia, environment.added_inertia)
        roll_inertia = environment.density * np.pi * c_m * (a**2 - b**2) ** 2 / 8.0 * 2.0 * l
    r = 0.5 * (a + b)
    return Element(
        body=f"module_{i}",
        position=(l, 0.0, 0.0),
        drag=(c_t, c_n, c_z),
        torque_linear=(c_t * r**2, linear_y, lambda_2),
        torque_quadratic=(c_t * r**3, quadratic_y, lambda_3),
        added_mass=(mu_t, mu_n, mu_z),
        added_inertia=(roll_inertia, inertia_y, lambda_1),
        volume=module.volume,
        shape="cylinder",
        half_size=(l, b, a),
        law=law_of(environment),
    )


def _build_strips(
    fin: CaudalFin, c: Coefficients, environment: Environment, *, floats: bool
) -> list[Element]:
    """Return the elements of a fin's strips, which bear its drag and its added mass."""
    h = 0.5 * fin.height
    density = environment.density if isinstance(environment, Water) else 1.0
    bodies = build_fin_bodies(fin)
    strips: list[Element] = []
    for k in range(c.mass.size):
        position = float(c.position[k])
        k_piece = _find_piece(fin, -position)
        c_t = float(c.c_t[k])
        c_n = float(c.c_n[k])
        mu_n = float(c.mu_n[k])
        d = 2.0 * float(c.half_length[k])
        volume = 0.0 if floats else float(c.displaced[k]) / density
        strip = Element(
            body=bodies[k_piece].name,
            position=(position + fin.pieces[k_piece].begin, 0.0, 0.0),
            drag=(c_t, c_n, c_t),
            torque_linear=(c_n * h**2 / 3.0, 0.0, float(c.lambda_2[k])),
            torque_quadratic=(c_n * h**3 / 4.0, 0.0, float(c.lambda_3[k])),
            added_mass=(float(c.mu_t[k]), mu_n, 0.0),
            added_inertia=(mu_n * h**2 / 8.0, 0.0, max(float(c.lambda_1[k]), 0.0)),
            volume=volume,
            shape="box",
            half_size=(0.5 * d, 0.5 * fin.thickness, h),
            law=law_of(environment),
        )
        strips.append(strip)
    return strips


def _find_piece(fin: CaudalFin, distance: float) -> int:
    """Return the number of the piece of a fin at a distance behind the root [m]."""
    return next(k for k, piece in enumerate(fin.pieces) if distance < piece.end)


def _build_plates(fin: CaudalFin, environment: Environment, *, floats: bool) -> list[Element]:
    """Return the elements by which the pieces of a fin float.

    The whole plate floats, its opening included, because the mass is that of the whole plate.
    """
    plates: list[Element] = []
    for body, piece in zip(build_fin_bodies(fin), fin.pieces, strict=True):
        half_size: Three = (0.5 * piece.length, 0.5 * fin.thickness, 0.5 * fin.height)
        volume = fin.volume * piece.length / fin.length if floats else 0.0
        plate = Element(
            body=body.name,
            position=(-0.5 * piece.length, 0.0, 0.0),
            volume=volume,
            shape="box",
            half_size=half_size,
            law=law_of(environment),
        )
        plates.append(plate)
    return plates


def _build_areas(robot: Robot, c: Coefficients, water: Water) -> list[Element]:
    """Return the elements of drag areas, on the axes of their links."""
    elements: list[Element] = []
    for k, area in enumerate(robot.drag_areas):
        assert c.areas is not None
        c_n = float(c.areas.c_n[k])
        element = Element(
            body=f"module_{area.link}",
            position=(float(c.areas.position[k]), 0.0, 0.0),
            drag=(float(c.areas.c_t[k]), c_n, c_n),
            law=law_of(water),
        )
        elements.append(element)
    return elements


def _build_tether(robot: Robot) -> list[Element]:
    """Return the element of a tether that pulls or drags, as in the planar model."""
    tether = robot.tether
    if tether.drag <= 0.0 and not any(tether.force):
        return []
    x, y = tether.force
    return [Element(body="module_0", tether_drag=tether.drag, pull=(x, y, 0.0))]


def _build_trailing_edge(robot: Robot, water: Water, edge: FinEdge | None) -> list[Element]:
    """Return the element of the trailing edge of fin or tail, as in the planar model.

    Of an edge of finite span it is only the place: the twin writes its numbers.
    """
    if water.trailing_edge == "none":
        return []
    fin = robot.caudal_fin
    if fin is not None and edge is not None:
        return [Element(body=build_fin_bodies(fin)[-1].name, position=(-edge.distance, 0.0, 0.0))]
    body = "module_0"
    distance = 0.0
    if fin is not None:
        body = build_fin_bodies(fin)[-1].name
        distance = fin.pieces[-1].length
    position = (-distance, 0.0, 0.0)
    return [Element(body=body, position=position, wake_mass=wake_mass(robot, water))]


def mounted_elements(robot: Robot, environment: Environment) -> list[Element]:
    """Return the elements that a command changes: thrusters and, in water, pectoral fins.

    Args:
        robot: The robot, with the current settings of its effectors.
        environment: The water it swims in, or the ground.
    """
    mounts = build_mounts(robot)
    elements: list[Element] = []
    for thruster, mount in zip(robot.thrusters, mounts, strict=False):
        element = Element(
            body=mount.body,
            position=mount.position,
            orientation=mount.orientation,
            thrust=(thruster.thrust, 0.0, 0.0),
        )
        elements.append(element)
    if not isinstance(environment, Water):
        return elements
    mounts_of_fins = mounts[len(robot.thrusters) :]
    for fin, mount in zip(robot.pectoral_fins, mounts_of_fins, strict=True):
        plate = (
            0.5 * environment.density * fin.area,
            fin.lift_slope,
            fin.stall_angle,
            fin.stall_sharpness,
            fin.parasitic_drag,
        )
        element = Element(
            body=mount.body,
            position=mount.position,
            orientation=mount.orientation,
            plate=plate,
        )
        elements.append(element)
    return elements
