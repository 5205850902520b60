"""Pressure on the sides of links: what the water's force across them is over the area of a side."""

from typing import TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda.robot import Robot, Water
from laticauda.trials.contents import Contents
from laticauda.values import DIRECTIONS, BadArgument

OfLinks: TypeAlias = Float[np.ndarray, "n_samples n_links"]
LEFT = DIRECTIONS.index("left")


def side_areas(robot: Robot) -> Float[np.ndarray, " n_links"]:
    """Return the area of a side of every link, that of the tail link with the fin's [m^2].

    Args:
        robot: The robot; its links are those of the planar model if it is reduced to the plane.
    """
    areas = [2.0 * module.section.half_height * module.length for module in robot.modules]
    fin = robot.caudal_fin
    if fin is not None:
        areas[0] += fin.area
        if fin.opening == "open":
            areas[0] -= fin.opening_length * fin.height
    return np.array(areas)


def pressure_difference(trial: Contents) -> OfLinks:
    """Return how much higher the mean pressure on the right side of every link is than that on its left [Pa].

    Args:
        trial: A trial that was run with `link_forces`.

    Raises:
        ValueError: If it was run without, or on ground.
    """
    if not isinstance(trial.environment, Water):
        raise BadArgument("environment", "must be a Water for a pressure, got a Ground")
    if trial.water_force is None:
        raise ValueError("The trial has no `water_force`: swim it again with `link_forces=True`.")
    return trial.water_force[:, :, LEFT] / side_areas(trial.chain)
