"""The frequency of the gait, from the joint angles of a first guess."""

import math

import numpy as np
from jaxtyping import Float

from laticauda.film.chain.geometry import N_ROOT

N_CANDIDATES = 20
"""Frequencies tried per cycle that the film holds: neighbors differ by a twentieth of a cycle at its end."""
LEAST_SHARE = 0.3
"""Share of the joints' motion that the best frequency must explain to be one [-]."""
FASTEST = 0.35
"""Highest frequency, by that of the frames: beyond half of it nothing can be told [-]."""


def find_frequency(
    time: Float[np.ndarray, " n_frames"], coordinates: Float[np.ndarray, "n_frames n_coordinates"]
) -> float:
    """Return the angular frequency that explains most of the joints' motion; 0 if none explains much [rad/s].

    At every candidate, cosine, sine and a parabola are fitted to all joints together.

    Args:
        time: Times of the frames [s].
        coordinates: Coordinates of the chain.
    """
    angles = coordinates[:, N_ROOT:]
    if angles.shape[1] == 0:
        angles = coordinates[:, N_ROOT - 1 :]
    duration = float(time[-1] - time[0])
    middle = time - 0.5 * (time[0] + time[-1])
    share = 2.0 * middle / duration
    slow = np.column_stack((np.ones_like(share), share, share**2))
    rest = angles - slow @ np.linalg.pinv(slow) @ angles
    size = float(np.sum(rest**2))
    if size == 0.0:
        return 0.0
    highest = FASTEST * (time.size - 1)
    cycles = np.arange(1.0, highest, 1.0 / N_CANDIDATES)
    explained = np.array([_explained(middle, rest, slow, n / duration) for n in cycles])
    if explained.size == 0 or np.max(explained) < LEAST_SHARE * size:
        return 0.0
    return 2.0 * math.pi * float(cycles[np.argmax(explained)]) / duration


def _explained(
    time: Float[np.ndarray, " n_frames"],
    rest: Float[np.ndarray, "n_frames n_joints"],
    slow: Float[np.ndarray, "n_frames 3"],
    frequency: float,
) -> float:
    """Return the sum of squares that a frequency [Hz] explains."""
    phase = 2.0 * math.pi * frequency * time
    waves = np.column_stack((np.cos(phase), np.sin(phase)))
    waves -= slow @ np.linalg.pinv(slow) @ waves
    directions, _ = np.linalg.qr(waves)
    return float(np.sum((directions.T @ rest) ** 2))
