"""The net of light on the floor of a pool: rays of the sun that a wavy surface bends, collected on the floor.

The surface is a sum of waves that fit a square tile, each with the speed that deep water gives it, so that the tile
repeats without a seam; the waves return to their beginning after `PERIOD`, so that a film needs no more pictures than
that of it. A ray that enters where the slope is (s_x, s_y) reaches the floor shifted by -F (s_x, s_y).
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Complex128, Float

N_WAVES, SEED = 24, 4
SHORTEST, LONGEST = 7.5, 2.0  # waves per tile
FOCUS = 1.1  # F, in units that make neighboring rays just cross
PACE = 0.9  # radians per second and square root of waves per tile; a real tile of 2 m would have more
PERIOD, PER_SECOND = 10.0, 12  # [s], pictures

Pairs = Complex128[np.ndarray, "n_rows n_columns"]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Waves:
    """Waves of one tile, in radians across the tile."""

    number_x: Float[np.ndarray, " n"]
    number_y: Float[np.ndarray, " n"]
    slope: Float[np.ndarray, " n"]
    phase: Float[np.ndarray, " n"]


def light(size: int, time: float) -> Float[np.ndarray, "size size"]:
    """How much light falls on each point of a tile of the floor, 1 on average [-].

    Args:
        size: Points along a side.
        time: [s]; the picture changes `PER_SECOND` times per second.
    """
    return _light(size, int(time * PER_SECOND) % int(PERIOD * PER_SECOND))


@lru_cache(maxsize=int(PERIOD * PER_SECOND))
def _light(size: int, picture: int) -> np.ndarray:
    waves, n, time = _waves(), 2 * size, picture / PER_SECOND  # four rays for each point
    place = 2.0 * np.pi * np.arange(n) / n
    turns = np.round(PERIOD * PACE / (2.0 * np.pi) * np.sqrt(np.hypot(waves.number_x, waves.number_y)))
    frequency = 2.0 * np.pi / PERIOD * turns
    along: Pairs = np.exp(1j * (np.outer(place, waves.number_x) + waves.phase + frequency * time))
    across: Pairs = np.exp(1j * np.outer(waves.number_y, place))
    slope_x: Pairs = (along * (waves.slope * waves.number_x)) @ across
    slope_y: Pairs = (along * (waves.slope * waves.number_y)) @ across
    x = place[:, np.newaxis] - FOCUS * np.imag(slope_x)
    y = place - FOCUS * np.imag(slope_y)
    return _collected(x * size / (2.0 * np.pi), y * size / (2.0 * np.pi), size)


@lru_cache(maxsize=1)
def _waves() -> _Waves:
    rng = np.random.default_rng(SEED)
    many = rng.uniform(LONGEST, SHORTEST, N_WAVES)
    direction = rng.uniform(0.0, 2.0 * np.pi, N_WAVES)
    x, y = np.round(many * np.cos(direction)), np.round(many * np.sin(direction))
    slope = 1.0 / (np.maximum(np.hypot(x, y), 1.0) ** 2 * np.sqrt(N_WAVES))
    return _Waves(number_x=x, number_y=y, slope=slope, phase=rng.uniform(0.0, 2.0 * np.pi, N_WAVES))


def _collected(x: np.ndarray, y: np.ndarray, size: int) -> np.ndarray:
    """Rays that hit the floor at (x, y), shared out among the four points around each."""
    column, row = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    right, up = x - column, y - row
    total = np.zeros(size * size)
    for step_x, share_x in ((0, 1.0 - right), (1, right)):
        for step_y, share_y in ((0, 1.0 - up), (1, up)):
            index = (row + step_y) % size * size + (column + step_x) % size
            total += np.bincount(index.ravel(), (share_x * share_y).ravel(), minlength=size * size)
    floor = total.reshape(size, size) * (size * size / x.size)
    for axis in (0, 1):  # the sun is no point
        floor = 0.5 * floor + 0.25 * (np.roll(floor, 1, axis) + np.roll(floor, -1, axis))
    return floor
