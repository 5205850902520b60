"""How the rows of links follow from parameters of their modules: part of the compiled function.

The template holds the rows of the modules as they were when it was written. Where a parameter of a
module has another value, what the module had contributed to the rows of its link is taken off, and
what it contributes now is added. Fins, drag areas and everything else stay as they are, so that
nothing but a module itself has to be laid out here.

In the array of integers stand the places below, then a record for each link, then the rows of what
lies on a link at a distance from its middle. The formulas of the loads are those of
`laticauda.water.fluid.sections`.
"""

# pyright: basic

import functools
from typing import NamedTuple

import numpy as np

from laticauda.compiling import inlined
from laticauda.models.planar.rows import (
    BODY_ROWS,
    C_N_OF,
    C_T_OF,
    CENTER,
    CENTRIPETAL,
    COUPLING,
    DISPLACED_OF,
    FIRST_MOMENT_SHARE,
    HEADER_ROWS,
    INERTIA,
    LAMBDA_2_OF,
    LAMBDA_3_OF,
    LENGTH,
    MASS_N,
    MASS_SHARE,
    MASS_T,
    MOMENT_N,
    MOMENT_T,
    MU_N,
    MU_N_OF,
    MU_T,
    MU_T_OF,
    POSITION_OF,
    THRUST_MOMENT,
    THRUST_N,
    WAKE_MASS,
)
from laticauda.water.fluid.sections import Link, link_loads, surface_factor

NONE = -1
"""In place of the number of a variable: there is none."""

N_LINKS = 0
"""Position of the number of links whose modules have parameters."""
FIRST_ROW = 1
"""Position of the first row of the first of them."""
N_BODIES = 2
"""Position of the number of bodies, which all have shares of the robot's mass."""
DENSITY = 3
"""Position of the number of the variable that is the water's density."""
TANGENTIAL = 4
"""Position of the number of the variable that is the water's C_T."""
IS_IN_STRIPS = 5
"""Position of whether rotational loads are those of the normal loads along the link."""
IS_CLASSIC = 6
"""Position of whether the added mass has its classic form."""
HAS_WAKE = 7
"""Position of whether the section of the first of the links leaves a wake behind the tail."""
NUMBERS = 8
"""Position of where the robot's mass and the depth of its axis stand in the array of reals."""
N_ATTACHED = 9
"""Position of the number of rows that are positions on a link from its tail end."""
RECORDS = 10
"""Position of the first record."""

# Numbers of a module, in this order in each record.
LENGTH_AT = 0
MASS_AT = 1
CENTER_AT = 2
INERTIA_AT = 3
HALF_HEIGHT_AT = 4
HALF_WIDTH_AT = 5
FRICTION_AT = 6
DRAG_AT = 7
ADDED_MASS_AT = 8
ADDED_INERTIA_AT = 9
N_NUMBERS = 10
FIRST_COEFFICIENT = FRICTION_AT
"""From here on, numbers that may be the water's."""

# A record: for each number, the variable that is the module's own; then, for each coefficient, the
# variable of the water that it is a multiple of; then the two below.
IS_ROD = N_NUMBERS + N_NUMBERS - FIRST_COEFFICIENT
"""Place in a record of whether the module's inertia is that of a rod."""
REALS = IS_ROD + 1
"""Place of where the record's numbers stand in the array of reals: all numbers of the module as they were; the
multiples of the water's coefficients; the area of its section over the product of its half-axes."""
RECORD_SIZE = REALS + 1

OWN = {"_nrt": False}
"""Numba options: nothing may need Numba's runtime."""


class Module(NamedTuple):
    """Numbers of a module."""

    length: float
    """2 l [m]."""
    mass: float
    """m [kg]."""
    center: float
    """Center of mass from mid-length towards the head [m]."""
    inertia: float
    """J about the center of mass [kg m^2]."""
    volume: float
    """Displaced volume [m^3]."""
    link: Link
    """Its size and the coefficients of the water on it."""


class Water(NamedTuple):
    """What all links have in common."""

    density: float
    """rho [kg/m^3]."""
    tangential_added_mass: float
    """C_T [-]."""
    depth: float
    """Depth of the robot's axis, infinite far below the surface [m]."""
    is_in_strips: bool
    """Whether rotational loads are those of the normal loads along the link."""
    is_classic: bool
    """Whether the added mass has its classic form."""


_inner = functools.partial(inlined, **OWN)
_link_loads = _inner(link_loads)
_surface_factor = _inner(surface_factor)


@_inner
def _number_before(whole, real, record, number, v):
    """Return a number of a module as it was, in the water as it is."""
    reals = whole[record + REALS]
    if number >= FIRST_COEFFICIENT:
        coefficient = number - FIRST_COEFFICIENT
        variable = whole[record + N_NUMBERS + coefficient]
        if variable != NONE:
            return real[reals + N_NUMBERS + coefficient] * v[variable]
    return real[reals + number]


@_inner
def _is_changed(whole, real, record, v):
    """Return whether a parameter of a module has another value than it had."""
    for number in range(N_NUMBERS):
        variable = whole[record + number]
        if variable != NONE and v[variable] != real[whole[record + REALS] + number]:
            return True
    return False


@_inner
def _number(whole, real, record, number, v, is_new):
    """Return a number of a module as it is, or was."""
    variable = whole[record + number]
    if is_new and variable != NONE:
        return v[variable]
    return _number_before(whole, real, record, number, v)


@_inner
def _module(whole, real, record, v, is_new):
    """Return the numbers of a module as they are, or were."""
    reals = whole[record + REALS]
    length = _number(whole, real, record, LENGTH_AT, v, is_new)
    mass = _number(whole, real, record, MASS_AT, v, is_new)
    inertia = _number(whole, real, record, INERTIA_AT, v, is_new)
    if whole[record + IS_ROD] != 0:
        inertia = mass * (0.5 * length) ** 2 / 3.0
    half_height = _number(whole, real, record, HALF_HEIGHT_AT, v, is_new)
    half_width = _number(whole, real, record, HALF_WIDTH_AT, v, is_new)
    area = real[reals + 2 * N_NUMBERS - FIRST_COEFFICIENT] * half_height * half_width
    link = Link(
        0.5 * length,
        half_height,
        half_width,
        _number(whole, real, record, FRICTION_AT, v, is_new),
        _number(whole, real, record, DRAG_AT, v, is_new),
        _number(whole, real, record, ADDED_MASS_AT, v, is_new),
        _number(whole, real, record, ADDED_INERTIA_AT, v, is_new),
    )
    center = _number(whole, real, record, CENTER_AT, v, is_new)
    return Module(length, mass, center, inertia, area * length, link)


@_inner
def _add_module(rows, first_row, module, water, sign):
    """Add what a module contributes to the rows of its link, or take it off; shares of mass are masses here."""
    half_length = module.link.half_length
    loads = _link_loads(
        module.link,
        water.density,
        water.tangential_added_mass,
        _surface_factor(module.link.half_height, water.depth),
        water.is_in_strips,
    )
    arm = half_length + module.center
    moment = module.mass * arm
    moment_t = loads.mu_t * half_length
    moment_n = loads.mu_n * half_length
    centripetal = moment
    if water.is_classic:
        centripetal = moment + moment_t
    rigid_inertia = module.inertia + moment * arm
    water_inertia = loads.lambda_1 + moment_n * half_length
    rows[first_row + LENGTH] += sign * module.length
    rows[first_row + INERTIA] += sign * (rigid_inertia + water_inertia)
    rows[first_row + COUPLING] += sign * (moment + moment_n)
    rows[first_row + CENTRIPETAL] += sign * centripetal
    rows[first_row + MASS_T] += sign * (module.mass + loads.mu_t)
    rows[first_row + MASS_N] += sign * (module.mass + loads.mu_n)
    rows[first_row + MU_T] += sign * loads.mu_t
    rows[first_row + MU_N] += sign * loads.mu_n
    rows[first_row + MOMENT_T] += sign * moment_t
    rows[first_row + MOMENT_N] += sign * moment_n
    rows[first_row + MASS_SHARE] += sign * module.mass
    rows[first_row + FIRST_MOMENT_SHARE] += sign * moment
    element = first_row + CENTER
    rows[element + POSITION_OF] += sign * half_length
    rows[element + C_T_OF] += sign * loads.c_t
    rows[element + C_N_OF] += sign * loads.c_n
    rows[element + LAMBDA_2_OF] += sign * loads.lambda_2
    rows[element + LAMBDA_3_OF] += sign * loads.lambda_3
    rows[element + MU_T_OF] += sign * loads.mu_t
    rows[element + MU_N_OF] += sign * loads.mu_n
    rows[element + DISPLACED_OF] += sign * water.density * module.volume


@_inner
def _wake_mass(module, water):
    """Return the added mass per length that a tail leaves behind."""
    half_height = module.link.half_height
    slender = water.density * np.pi * module.link.added_mass * half_height**2
    return slender * _surface_factor(half_height, water.depth)


@_inner
def _scale_shares(whole, places, rows, factor):
    """Multiply the shares that bodies have in the robot's mass, fins included."""
    first_row = HEADER_ROWS
    for _ in range(whole[places + N_BODIES]):
        rows[first_row + MASS_SHARE] *= factor
        rows[first_row + FIRST_MOMENT_SHARE] *= factor
        first_row += BODY_ROWS


@_inner
def _is_any_changed(whole, real, places, v):
    """Return whether a parameter of any module has another value than it had."""
    for link in range(whole[places + N_LINKS]):
        if _is_changed(whole, real, places + RECORDS + link * RECORD_SIZE, v):
            return True
    return False


@_inner
def change_links(whole, real, places, v, rows):
    """Change the rows of links whose modules have other parameters than they had.

    Args:
        whole: Integers.
        real: Reals.
        places: Where the places above begin among the integers.
        v: The variables.
        rows: The rows, in the water as it is.
    """
    if not _is_any_changed(whole, real, places, v):
        return
    numbers = whole[places + NUMBERS]
    mass = real[numbers]
    water = Water(
        v[whole[places + DENSITY]],
        v[whole[places + TANGENTIAL]],
        real[numbers + 1],
        whole[places + IS_IN_STRIPS] != 0,
        whole[places + IS_CLASSIC] != 0,
    )
    n_links = whole[places + N_LINKS]
    attached = places + RECORDS + n_links * RECORD_SIZE
    _scale_shares(whole, places, rows, mass)
    for link in range(n_links):
        record = places + RECORDS + link * RECORD_SIZE
        if not _is_changed(whole, real, record, v):
            continue
        first_row = whole[places + FIRST_ROW] + link * BODY_ROWS
        before = _module(whole, real, record, v, False)
        after = _module(whole, real, record, v, True)
        _add_module(rows, first_row, before, water, -1.0)
        _add_module(rows, first_row, after, water, 1.0)
        mass += after.mass - before.mass
        shift = 0.5 * (after.length - before.length)
        rows[first_row + THRUST_MOMENT] += shift * rows[first_row + THRUST_N]
        for k in range(whole[places + N_ATTACHED]):
            if whole[attached + 2 * k] == link:
                rows[whole[attached + 2 * k + 1]] += shift
        if link == 0 and whole[places + HAS_WAKE] != 0:
            rows[WAKE_MASS] += _wake_mass(after, water) - _wake_mass(before, water)
    _scale_shares(whole, places, rows, 1.0 / mass)
