"""From a body's section and the water's dimensionless coefficients to loads per link.

With rho the water's density, a and b the vertical and lateral half-axes, l the half length:

    c_t = 1/2 rho pi C_f (a+b)/2 2l      lambda_1 = rho pi C_M (a^2-b^2)^2 l^3 / 12
    c_n = 1/2 rho C_D 2a 2l              lambda_2 = rho pi C_f (a+b) l^3 / 6
    mu_n = rho pi C_A a^2 2l             lambda_3 = rho pi C_f (a+b) l^4 / 8
    mu_t = C_T rho pi a b 2l

Kelasidi, Liljeback, Pettersen and Gravdahl, Robotics and Biomimetics 2:8 (2015), Table 1. There lambda_2 and lambda_3
hold the tangential friction alone; ``rotational="strip"`` replaces all three lambdas by those of normal drag and added
mass spread along the link: 1/3 mu_n l^2, 1/3 c_n l^2 and 1/4 c_n l^3.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.robot import CaudalFin, Environment, Ground, Module, Robot, Water


@dataclass(frozen=True, kw_only=True)
class Coefficients:
    """Loads per element, tail first; every field has shape (n,)."""

    half_length: Float[np.ndarray, " n"]
    """l [m]."""
    position: Float[np.ndarray, " n"]
    """Middle of the element from the tail end of its body, headward positive [m]."""
    mass: Float[np.ndarray, " n"]
    """m [kg]."""
    c_t: Float[np.ndarray, " n"]
    """Drag along the element [N s^2/m^2] (on dry ground mu_t m g [N])."""
    c_n: Float[np.ndarray, " n"]
    """Drag across the element [N s^2/m^2] (on dry ground mu_n m g [N])."""
    mu_t: Float[np.ndarray, " n"]
    """Added mass along the element [kg]."""
    mu_n: Float[np.ndarray, " n"]
    """Added mass across the element [kg]."""
    lambda_1: Float[np.ndarray, " n"]
    """Added inertia about the element's middle [kg m^2]."""
    lambda_2: Float[np.ndarray, " n"]
    """Linear rotational drag, times U_ref [N s^2]."""
    lambda_3: Float[np.ndarray, " n"]
    """Quadratic rotational drag [N m s^2]."""
    fin: "Coefficients | None" = None
    """Strips of the caudal fin from its root to the trailing edge, on body 0; None without a fin."""


def link_coefficients(robot: Robot, environment: Environment) -> Coefficients:
    """Drag and added mass of every link of a planar robot and of its fin.

    Args:
        robot: All joints turn about the vertical axis (see `Robot.planar`).
        environment: The water it swims in or the ground it crawls on.

    Returns:
        Arrays per link, tail first.
    """
    modules = robot.modules
    if isinstance(environment, Ground):
        rows = [_ground_row(module, environment) for module in modules]
        fin = None
    else:
        rows = [_water_row(module, environment) for module in modules]
        fin = _fin_strips(robot.caudal_fin, environment) if robot.caudal_fin else None
    columns = list(np.array(rows).T)
    half_length = np.array([module.length / 2.0 for module in modules])
    return _coefficients(half_length, half_length, columns, fin)


def immersion_factor(half_height: float, depth: float | None) -> float:
    """1 + a^2 / (2 h^2): what an image at the surface adds to the normal added mass at axis depth h."""
    return 1.0 if depth is None else 1.0 + half_height**2 / (2.0 * depth**2)


def _coefficients(
    half_length: np.ndarray, position: np.ndarray, columns: Sequence[np.ndarray], fin: Coefficients | None = None
) -> Coefficients:
    mass, c_t, c_n, mu_t, mu_n, lambda_1, lambda_2, lambda_3 = columns
    return Coefficients(
        half_length=half_length,
        position=position,
        mass=mass,
        c_t=c_t,
        c_n=c_n,
        mu_t=mu_t,
        mu_n=mu_n,
        lambda_1=lambda_1,
        lambda_2=lambda_2,
        lambda_3=lambda_3,
        fin=fin,
    )


def _water_row(module: Module, water: Water) -> tuple[float, ...]:
    rho, l = water.density, module.length / 2.0  # noqa: E741
    a, b = module.section.half_height, module.section.half_width
    C_f = _own(module.tangential_friction, water.tangential_friction)
    C_D = _own(module.normal_drag, water.normal_drag)
    C_A = _own(module.added_mass, water.added_mass)
    C_M = _own(module.added_inertia, water.added_inertia)
    c_t = 0.5 * rho * np.pi * C_f * (a + b) / 2.0 * 2.0 * l
    c_n = 0.5 * rho * C_D * 2.0 * a * 2.0 * l
    mu_n = rho * np.pi * C_A * a**2 * 2.0 * l * immersion_factor(a, water.depth)
    mu_t = rho * np.pi * water.tangential_added_mass * a * b * 2.0 * l
    if water.rotational == "strip":
        lambdas = (mu_n * l**2 / 3.0, c_n * l**2 / 3.0, c_n * l**3 / 4.0)
    else:
        friction = rho * np.pi * C_f * (a + b) * l**3
        lambdas = (rho * np.pi * C_M * (a**2 - b**2) ** 2 * l**3 / 12.0, friction / 6.0, friction * l / 8.0)
    return (module.mass, c_t, c_n, mu_t, mu_n, *lambdas)


def _ground_row(module: Module, ground: Ground) -> tuple[float, ...]:
    weight = module.mass * ground.gravity if ground.friction == "coulomb" else 1.0
    return (module.mass, ground.tangential * weight, ground.normal * weight, 0.0, 0.0, 0.0, 0.0, 0.0)


def _fin_strips(fin: CaudalFin, water: Water) -> Coefficients:
    """Strips of the fin; an open opening has mass (see `CaudalFin`) but no area and so no strip."""
    edges = np.linspace(fin.opening_length, fin.length, fin.n_strips + 1)
    if fin.opening == "closed" and fin.opening_length > 0.0:
        pieces = int(np.ceil(fin.opening_length / (edges[1] - edges[0])))
        edges = np.concatenate((np.linspace(0.0, fin.opening_length, pieces + 1)[:-1], edges))
    d = np.diff(edges)
    C_f = _own(fin.tangential_friction, water.tangential_friction)
    C_D = _own(fin.normal_drag, water.normal_drag)
    C_A = _own(fin.added_mass, water.added_mass)
    mu_n = water.density * np.pi * C_A * (fin.height / 2.0) ** 2 * d * immersion_factor(fin.height / 2.0, water.depth)
    c_n = 0.5 * water.density * C_D * fin.height * d
    c_t = 0.5 * water.density * C_f * 2.0 * fin.height * d
    mass = fin.mass * d / fin.length
    zero = np.zeros_like(d)
    lambdas = [mu_n * d**2 / 12.0, c_n * d**2 / 12.0, c_n * d**3 / 32.0] if water.rotational == "strip" else [zero] * 3
    columns = (mass, c_t, c_n, zero, mu_n, *lambdas)
    return _coefficients(d / 2.0, -(edges[:-1] + edges[1:]) / 2.0, columns)


def _own(override: float | None, water: float) -> float:
    return water if override is None else override
