"""Whether lengths in the film are those of the body: a wrong scale or another body shows here first."""

from itertools import pairwise

import numpy as np

from laticauda.film.chain import ChainFit

LONGEST_CHORD = 0.25
"""Distance of neighbors along the body, by its length, up to which a chord tells the length between them."""
STRAIGHTEST = 0.2
"""Share of the frames, those in which the body is straightest between two points, that are compared."""


def measure_stretch(fit: ChainFit) -> float:
    """Return how far apart neighboring points are in the film, by their distance on the body; 1 if it is not known.

    Frames are chosen by the fitted chain and not by what was seen, so that noise does not lengthen distances.

    Args:
        fit: The fitted film.
    """
    model = fit.model
    along = np.asarray(model.places.along)
    fitted = model.observed - fit.residuals
    order = np.argsort(along)
    observed_total = 0.0
    true_total = 0.0
    for i, j in pairwise(order):
        distance = float(along[j] - along[i])
        are_seen = model.is_seen[:, i] & model.is_seen[:, j]
        is_short = 0.0 < distance <= LONGEST_CHORD * fit.robot.length
        if not is_short or not are_seen.any():
            continue
        chords = np.abs(fitted[are_seen, j] - fitted[are_seen, i])
        observed_chords = np.abs(model.observed[are_seen, j] - model.observed[are_seen, i])
        is_straight = chords >= np.quantile(chords, 1.0 - STRAIGHTEST)
        observed_total += float(np.median(observed_chords[is_straight]))
        true_total += distance
    if true_total == 0.0:
        return 1.0
    return observed_total / true_total
