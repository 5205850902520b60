"""The frequency of the gait, from the joint angles of a first guess."""

import math

import numpy as np
from jaxtyping import Float

from laticauda.film.chain.geometry import N_ROOT

N_CANDIDATES = 20
"""Frequencies tried per cycle that the film holds: neighbors differ by a twentieth of a cycle at its end."""
LEAST_SHARE = 0.3
"""Share of the joints' motion that the best frequency must explain to be one [-]."""
MOST_TYPICAL = 4.0
"""Largest angle by the median of all: a sine's is 1.4 times as large [-]."""
FASTEST = 0.35
"""Highest frequency, by that of the frames: beyond half of it nothing can be told [-]."""


def find_frequency(
    time: Float[np.ndarray, " n_frames"], coordinates: Float[np.ndarray, "n_frames n_coordinates"]
) -> float:
    """Return the angular frequency that explains most of the joints' motion; 0 if none explains much [rad/s].

    It is the peak of their spectrum without a parabola, and one if cosine and sine explain enough.

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
    swing = angles - slow @ np.linalg.pinv(slow) @ angles
    # Outliers, of which a first guess has some, must not outweigh the gait.
    limits = MOST_TYPICAL * np.median(np.abs(swing), axis=0)
    swing = np.minimum(np.maximum(swing, -limits), limits)
    size = float(np.sum(swing**2))
    if size == 0.0:
        return 0.0
    n_cycles = _strongest_cycles(time, swing)
    if n_cycles == 0.0 or _explained(middle, swing, slow, n_cycles / duration) < LEAST_SHARE * size:
        return 0.0
    return 2.0 * math.pi * n_cycles / duration


def _strongest_cycles(
    time: Float[np.ndarray, " n_frames"], swing: Float[np.ndarray, "n_frames n_joints"]
) -> float:
    """Return how many cycles the film has of the strongest oscillation of all joints together, 0 if it is too short."""
    n_frames = time.size
    even_time = np.linspace(float(time[0]), float(time[-1]), n_frames)
    even = np.empty((swing.shape[1], n_frames))
    for joint, angle in enumerate(swing.T):
        even[joint] = np.interp(even_time, time, angle)
    spectrum = np.fft.rfft(even, N_CANDIDATES * (n_frames - 1))
    power = np.sum(np.abs(spectrum) ** 2, axis=0)
    highest = int(FASTEST * N_CANDIDATES * (n_frames - 1))
    candidates = power[N_CANDIDATES:highest]
    if candidates.size == 0:
        return 0.0
    return 1.0 + int(np.argmax(candidates)) / N_CANDIDATES


def _explained(
    time: Float[np.ndarray, " n_frames"],
    swing: Float[np.ndarray, "n_frames n_joints"],
    slow: Float[np.ndarray, "n_frames 3"],
    frequency: float,
) -> float:
    """Return the sum of squares that a frequency [Hz] explains."""
    phase = 2.0 * math.pi * frequency * time
    waves = np.column_stack((np.cos(phase), np.sin(phase)))
    waves -= slow @ np.linalg.pinv(slow) @ waves
    directions, _ = np.linalg.qr(waves)
    return float(np.sum((directions.T @ swing) ** 2))
