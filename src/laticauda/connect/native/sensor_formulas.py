"""What sensors at the head measure, without noise, from the motion of the links: part of the compiled function.

In the array of integers stand the places below, then three numbers for every output: the number of
its variable, what it is, and where its numbers stand in the array of reals.
"""

# pyright: basic

import math

from laticauda.models.planar import rows as places_of

N_FORMULAS = 0
"""Position of the number of outputs."""
N_LINKS = 1
"""Position of the number of links."""
CENTER_OF_MASS = 2
"""Position of the number of the first of four variables: center of mass and its velocity."""
HEADING_RATE = 3
"""Position of the number of the variable that is the mean rate of the links."""
LINK_ANGLE = 4
"""Position of the number of the first link angle."""
JOINT_RATE = 5
"""Position of the number of the first joint rate."""
FORMULAS = 6
"""Position of the first output."""
FORMULA_SIZE = 3
"""Numbers of an output."""

CONSTANT = 0
"""A number."""
HEADING = 1
"""Direction of the head; numbers: bias."""
TURN_RATE = 2
"""Rate of the head; numbers: bias."""
FORWARD = 3
"""Velocity of the tip of the head over ground, along the head."""
LEFT = 4
"""The same, to the left."""
RANGE = 5
"""Distance of a beacon; numbers: x, y, height above the head, largest range."""
BEARING = 6
"""Its direction in the plane; the same numbers."""
ELEVATION = 7
"""Its direction upward; the same numbers."""


def write_sensors(whole, real, places, rows, v):
    """Set the outputs of sensors.

    Args:
        whole: Integers.
        real: Reals.
        places: Where the places above begin among the integers.
        rows: The rows of a robot whose bodies are its links.
        v: The variables.
    """
    n_formulas = whole[places + N_FORMULAS]
    if n_formulas == 0:
        return
    n_links = whole[places + N_LINKS]
    first_angle = whole[places + LINK_ANGLE]
    first_rate = whole[places + JOINT_RATE]
    center = whole[places + CENTER_OF_MASS]
    rate = v[whole[places + HEADING_RATE]]
    for joint in range(n_links - 1):
        rate -= (n_links - 1 - joint) / n_links * v[first_rate + joint]
    x, y, velocity_x, velocity_y = v[center], v[center + 1], v[center + 2], v[center + 3]
    mass_ahead = 1.0
    for link in range(n_links):
        if link > 0:
            rate += v[first_rate + link - 1]
        # How far the link puts the tip of the head ahead of the center of mass, along the link: all
        # of its length, less what it puts the masses ahead of it there, and its own.
        body = places_of.HEADER_ROWS + link * places_of.BODY_ROWS
        mass_ahead -= rows[body + places_of.MASS_SHARE]
        length = rows[body + places_of.LENGTH]
        share = (1.0 - mass_ahead) * length - rows[body + places_of.FIRST_MOMENT_SHARE]
        ahead = share * math.cos(v[first_angle + link])
        aside = share * math.sin(v[first_angle + link])
        x += ahead
        y += aside
        velocity_x -= rate * aside
        velocity_y += rate * ahead
    angle = v[first_angle + n_links - 1]
    cos = math.cos(angle)
    sin = math.sin(angle)
    for formula in range(n_formulas):
        position = places + FORMULAS + FORMULA_SIZE * formula
        variable = whole[position]
        kind = whole[position + 1]
        numbers = whole[position + 2]
        if kind == CONSTANT:
            v[variable] = real[numbers]
        elif kind == HEADING:
            v[variable] = math.atan2(sin, cos) + real[numbers]
        elif kind == TURN_RATE:
            v[variable] = rate + real[numbers]
        elif kind == FORWARD:
            v[variable] = cos * velocity_x + sin * velocity_y
        elif kind == LEFT:
            v[variable] = cos * velocity_y - sin * velocity_x
        else:
            to_x = real[numbers] - x
            to_y = real[numbers + 1] - y
            up = real[numbers + 2]
            across = math.hypot(to_x, to_y)
            distance = math.hypot(across, up)
            if distance > real[numbers + 3]:
                v[variable] = math.nan
            elif kind == RANGE:
                v[variable] = distance
            elif kind == BEARING:
                v[variable] = math.atan2(cos * to_y - sin * to_x, cos * to_x + sin * to_y)
            else:
                v[variable] = math.atan2(up, across)
