"""The net of light on the floor of a pool: rays of the sun that a wavy surface bends, collected on the floor.

The surface is a sum of waves that fit a square tile, each with the speed that deep water gives it, so that the tile
repeats without a seam; the waves return to their beginning after `PERIOD`, so that a film needs no more pictures than
that of it. A ray that enters where the slope is (s_x, s_y) reaches the floor shifted by -F (s_x, s_y).
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float

N_WAVES, SEED = 24, 4
SHORTEST, LONGEST = 7.5, 2.0  # waves per tile
FOCUS = 1.1  # F, in units that make neighboring rays just cross
PACE = 0.9  # radians per second and square root of waves per tile; a real tile of 2 m would have more
PERIOD, PER_SECOND = 10.0, 12  # [s], pictures
RAYS = 4  # per point of the floor, along either axis


def light(size: int, time: float) -> Float[np.ndarray, "size size"]:
    """How much light falls on each point of a tile of the floor, 1 on average [-].

    Args:
        size: Points along a side.
        time: [s]; the picture changes `PER_SECOND` times per second.
    """
    return _light(size, int(time * PER_SECOND) % int(PERIOD * PER_SECOND))


@lru_cache(maxsize=int(PERIOD * PER_SECOND))
def _light(size: int, picture: int) -> np.ndarray:
    rng = np.random.default_rng(SEED)
    many, direction = rng.uniform(LONGEST, SHORTEST, N_WAVES), rng.uniform(0.0, 2.0 * np.pi, N_WAVES)
    number = np.round(many * np.array([np.cos(direction), np.sin(direction)]))  # waves across the tile, along x and y
    length: Float[np.ndarray, " n"] = np.hypot(number[0], number[1])
    steepness = 1.0 / (np.maximum(length, 1.0) ** 2 * np.sqrt(N_WAVES))
    turns = np.round(PERIOD * PACE / (2.0 * np.pi) * np.sqrt(length))
    phase = rng.uniform(0.0, 2.0 * np.pi, N_WAVES) + 2.0 * np.pi * turns * picture / (PER_SECOND * PERIOD)
    place = 2.0 * np.pi * np.arange(RAYS * size) / (RAYS * size)
    along, across = np.exp(1j * (np.outer(place, number[0]) + phase)), np.exp(1j * np.outer(number[1], place))
    slope_x, slope_y = (np.imag((along * (steepness * one)) @ across) for one in number)
    column, row = (
        (x * size / (2.0 * np.pi)).astype(np.int64) % size
        for x in (place[:, np.newaxis] - FOCUS * slope_x + 2.0 * np.pi, place - FOCUS * slope_y + 2.0 * np.pi)
    )
    floor = np.bincount((row * size + column).ravel(), minlength=size * size).reshape(size, size) / RAYS**2
    for axis in (0, 1):  # the sun is no point
        floor = 0.5 * floor + 0.25 * (np.roll(floor, 1, axis) + np.roll(floor, -1, axis))
    return floor
