"""What a sonar told during a run, and when it told something new."""

import numpy as np
from jaxtyping import Float

from laticauda.sensing import Sonar
from laticauda.trials import Trial


def read_distances(trial: Trial, sonar: Sonar) -> Float[np.ndarray, "n_samples n_beams"]:
    """Return what a sonar told last at every sample, nan where there was no echo [m].

    Args:
        trial: The trial of a robot with that sonar.
        sonar: The sonar.
    """
    distances: list[np.ndarray] = []
    for column in sonar.columns:
        distances.append(trial.signals[f"{sonar.name}_{column}"])
    return np.stack(distances, axis=-1)


def find_new_rows(distances: Float[np.ndarray, "n_samples n_beams"]) -> list[int]:
    """Return the samples at which a sonar told something new: noise never repeats.

    Args:
        distances: What it told last, nan where there was no echo [m].
    """
    # No echo again is nothing new, and nan would differ from nan.
    distances = np.nan_to_num(distances, nan=np.inf)
    open_water = np.full((1, distances.shape[1]), np.inf)
    changes = np.concatenate((open_water, distances[:-1])) != distances
    return np.flatnonzero(changes.any(axis=1)).tolist()
