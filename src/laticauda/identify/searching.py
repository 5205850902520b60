"""One search for the least sum of squares, and how it is made."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from laticauda.errors import one_of, positive, whole, within
from laticauda.identify import door
from laticauda.identify.identifiability import LIMIT
from laticauda.identify.model import predict
from laticauda.identify.problem import Problem

NOISES = ("known", "estimated")
_MOST_STEPS = 100

Vector = Float[np.ndarray, " n"]


@dataclass(frozen=True, kw_only=True)
class Method:
    """How a fit is made."""

    noise: str = "known"
    """known: as the measurements state it; estimated: that times a common factor, which the residuals say."""
    loss: str = "linear"
    """One of `door.LOSSES`."""
    n_starts: int = 4
    """How many starts."""
    seed: int = 0
    """Of the further starts."""
    confidence: float = 0.95
    """Of the intervals."""
    limit: float = LIMIT
    """From which relative standard deviation on an unknown counts as not identified."""

    def __post_init__(self) -> None:
        """Check every field once."""
        one_of("noise", self.noise, NOISES)
        one_of("loss", self.loss, door.LOSSES)
        whole("n_starts", self.n_starts, 1)
        whole("seed", self.seed, 0)
        within("confidence", self.confidence, 0.5, 0.9999)
        positive("limit", self.limit)


def search(
    put: Problem, method: Method, x: Vector, factor: float, free: Int[np.ndarray, " n_free"] | None = None
) -> door.Found:
    """One search.

    Args:
        put: Measurements and unknowns.
        method: How.
        x: Coordinates to begin with.
        factor: How many times the stated noise counts.
        free: Numbers of the unknowns that may change; None: all.

    Returns:
        Where it ended, with all coordinates, and the Jacobian of those that are free.
    """
    sigma = factor * put.sigma
    mine = np.arange(x.size) if free is None else free

    def whole(at: np.ndarray) -> np.ndarray:
        every = x.copy()
        every[mine] = at
        return put.values_of(every)

    def residuals(at: np.ndarray) -> np.ndarray:
        values = whole(at)
        return np.concatenate([(predict(put, values).values - put.observed) / sigma, prior_rows(put, values)])

    def jacobian(at: np.ndarray) -> np.ndarray:
        values = whole(at)
        found = predict(put, values, jacobian=True).jacobian
        assert found is not None
        rows = [found / sigma[:, np.newaxis] * slopes_of(put, values), _prior_slopes(put, values)]
        return np.concatenate(rows)[:, mine]

    bounds = np.array([[u.x(end) if math.isfinite(end) else end for end in (u.lower, u.upper)] for u in put.unknowns])
    sizes = np.array([unknown.size for unknown in put.unknowns])
    ends = bounds[mine, 0], bounds[mine, 1]
    begin = np.clip(x[mine], *ends)
    found = door.least_squares(residuals, jacobian, begin, ends, sizes[mine], loss=method.loss, most=_MOST_STEPS)
    every = x.copy()
    every[mine] = found.x
    return found._replace(x=every)


def slopes_of(put: Problem, values: Vector) -> Vector:
    """dq/dx of every unknown."""
    return np.array([unknown.slope(float(value)) for unknown, value in zip(put.unknowns, values, strict=True)])


def prior_rows(put: Problem, values: Vector) -> Float[np.ndarray, " n_priors"]:
    """What the priors add to the residuals."""
    pairs = [(value, unknown.prior) for value, unknown in zip(values, put.unknowns, strict=True)]
    return np.array([(value - prior[0]) / prior[1] for value, prior in pairs if prior is not None])


def _prior_slopes(put: Problem, values: np.ndarray) -> np.ndarray:
    rows = [
        np.eye(len(put.unknowns))[k] * unknown.slope(float(values[k])) / unknown.prior[1]
        for k, unknown in enumerate(put.unknowns)
        if unknown.prior is not None
    ]
    return np.reshape(rows, (len(rows), len(put.unknowns)))
