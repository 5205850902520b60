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
    seen_total, true_total = 0.0, 0.0
    for i, j in pairwise(order):
        distance = float(along[j] - along[i])
        is_both = model.is_seen[:, i] & model.is_seen[:, j]
        is_short = 0.0 < distance <= LONGEST_CHORD * fit.robot.length
        if not is_short or not is_both.any():
            continue
        chords = np.abs(fitted[is_both, j] - fitted[is_both, i])
        observed = np.abs(model.observed[is_both, j] - model.observed[is_both, i])
        straight = chords >= np.quantile(chords, 1.0 - STRAIGHTEST)
        seen_total += float(np.median(observed[straight]))
        true_total += distance
    if true_total == 0.0:
        return 1.0
    return seen_total / true_total
