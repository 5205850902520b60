"""Loads of a straight link of constant section, as formulas of numbers that compiled functions share.

With rho the water's density, a and b the vertical and lateral half-axes, l the half length:

    c_t = 1/2 rho pi C_f (a+b)/2 2l      lambda_1 = rho pi C_M (a^2-b^2)^2 l^3 / 12
    c_n = 1/2 rho C_D 2a 2l              lambda_2 = rho pi C_f (a+b) l^3 / 6
    mu_n = rho pi C_A a^2 2l             lambda_3 = rho pi C_f (a+b) l^4 / 8
    mu_t = C_T rho pi a b 2l

Kelasidi, Liljeback, Pettersen and Gravdahl, Robotics and Biomimetics 2:8 (2015), Table 1; mu_t is 0
there. Its lambda_2 and lambda_3 contain the tangential friction only, and the unit of its lambda_1
is not that of an inertia (its value is negligible). Loads in strips replace all three by those of the
normal loads distributed uniformly along a link that rotates about its middle:

    lambda_1 = mu_n l^2 / 3              lambda_2 = c_n l^2 / 3              lambda_3 = c_n l^3 / 4
"""

from typing import NamedTuple

import numpy as np


class Link(NamedTuple):
    """A link's size, and the coefficients of the water on it."""

    half_length: float
    """l [m]."""
    half_height: float
    """a [m]."""
    half_width: float
    """b [m]."""
    friction: float
    """C_f [-]."""
    drag: float
    """C_D [-]."""
    added_mass: float
    """C_A [-]."""
    added_inertia: float
    """C_M [-]."""


class LinkLoads(NamedTuple):
    """Coefficients of the loads on a link, as `laticauda.robot.hydrodynamics.Coefficients` defines them."""

    c_t: float
    """Drag along the link [N s^2/m^2]."""
    c_n: float
    """Drag across the link [N s^2/m^2]."""
    mu_t: float
    """Added mass along the link [kg]."""
    mu_n: float
    """Added mass across the link [kg]."""
    lambda_1: float
    """Added inertia about the link's middle [kg m^2]."""
    lambda_2: float
    """Linear rotational drag per U_ref [N s^2]."""
    lambda_3: float
    """Quadratic rotational drag [N m s^2]."""


def link_loads(
    link: Link,
    density: float,
    tangential_added_mass: float,
    surface: float,
    is_in_strips: bool,
) -> LinkLoads:
    """Return the coefficients of the loads on a link.

    Args:
        link: Size and coefficients.
        density: rho [kg/m^3].
        tangential_added_mass: C_T [-].
        surface: Factor of the water's surface on the added mass across, `surface_factor` [-].
        is_in_strips: Whether rotational loads are those of the normal loads along the link.
    """
    half_length = link.half_length
    height = link.half_height
    width = link.half_width
    c_t = 0.5 * density * np.pi * link.friction * (height + width) / 2.0 * 2.0 * half_length
    c_n = 0.5 * density * link.drag * 2.0 * height * 2.0 * half_length
    mu_n = density * np.pi * link.added_mass * height**2 * 2.0 * half_length * surface
    mu_t = density * np.pi * tangential_added_mass * height * width * 2.0 * half_length
    if is_in_strips:
        lambda_1 = mu_n * half_length**2 / 3.0
        lambda_2 = c_n * half_length**2 / 3.0
        lambda_3 = c_n * half_length**3 / 4.0
    else:
        friction = density * np.pi * link.friction * (height + width) * half_length**3
        lambda_1 = (
            density
            * np.pi
            * link.added_inertia
            * (height**2 - width**2) ** 2
            * half_length**3
            / 12.0
        )
        lambda_2 = friction / 6.0
        lambda_3 = friction * half_length / 8.0
    return LinkLoads(c_t, c_n, mu_t, mu_n, lambda_1, lambda_2, lambda_3)


def surface_factor(half_height: float, depth: float) -> float:
    """Return the factor 1 + a^2 / (2 h^2) of the surface on the normal added mass, from an image above the surface.

    Args:
        half_height: a [m].
        depth: h, depth of the axis below the surface, infinite for far below it [m].
    """
    return 1.0 + half_height**2 / (2.0 * depth**2)
