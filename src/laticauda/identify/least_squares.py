"""How a fit is made, and one search for the least sum of squares: a trust region within the ranges (scipy's `trf`)."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from laticauda.errors import one_of
from laticauda.extras import optional_import
from laticauda.identify.identifiability import LIMIT
from laticauda.identify.model import predict, scaled_jacobian
from laticauda.identify.problem import Problem
from laticauda.quantities import option, quantity, value

Vector = Float[np.ndarray, " n"]

_LOSSES: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "linear": lambda z: z,
    "soft_l1": lambda z: 2.0 * (np.sqrt(1.0 + z) - 1.0),
    "huber": lambda z: np.where(z <= 1.0, z, 2.0 * np.sqrt(z) - 1.0),
    "cauchy": np.log1p,
    "arctan": np.arctan,
}
LOSSES = tuple(_LOSSES)
"""All but linear give outliers less weight."""
NOISES = ("known", "estimated")
_TIGHT = 1e-10
_MOST_STEPS = 100


@value
class Method:
    """How a fit is made.

    Raises:
        ValueError: If a field is out of its range.
    """

    noise: str = option(
        "known: as the measurements state it; estimated: that times a common factor, which the residuals say",
        default="known",
        check=lambda name, given: one_of(name, given, NOISES),
    )
    loss: str = option(
        "How residuals count: all but linear give outliers less weight",
        default="linear",
        check=lambda name, given: one_of(name, given, LOSSES),
    )
    n_starts: int = quantity("", "How many starts", default=4, ge=1)
    seed: int = quantity("", "Of the further starts", default=0, ge=0)
    confidence: float = quantity("", "Of the intervals", default=0.95, ge=0.5, le=0.9999)
    limit: float = quantity(
        "", "From which relative standard deviation on an unknown counts as not identified", default=LIMIT, gt=0.0
    )


class Minimum(NamedTuple):
    """Where a search ended."""

    x: Vector
    cost: float
    jacobian: np.ndarray
    converged: bool


def minimize(
    problem: Problem, x: Vector, *, loss: str, factor: float = 1.0, free: Int[np.ndarray, " n_free"] | None = None
) -> Minimum:
    """One search.

    Args:
        problem: Measurements and unknowns.
        x: Coordinates to begin with.
        loss: One of `LOSSES`.
        factor: How many times the stated noise counts.
        free: Numbers of the unknowns that may change; None: all.

    Returns:
        Where it ended, with all coordinates, and the Jacobian of those that are free.

    Raises:
        MissingExtra: If scipy is not installed.
    """
    optimize = optional_import("Identification", "scipy", "identify", "scipy.optimize")
    mine = np.arange(x.size) if free is None else free

    def values_at(at: np.ndarray) -> np.ndarray:
        every = x.copy()
        every[mine] = at
        return problem.values_of(every)

    def residuals(at: np.ndarray) -> np.ndarray:
        return all_residuals(problem, values_at(at), factor)

    def jacobian(at: np.ndarray) -> np.ndarray:
        values = values_at(at)
        rows = [scaled_jacobian(problem, values, factor), problem.prior_slopes(values)]
        return np.concatenate(rows)[:, mine]

    ends = (u.x(end) if math.isfinite(end) else end for u in problem.unknowns for end in (u.lower, u.upper))
    bounds = np.reshape(list(ends), (-1, 2))[mine]
    found = optimize.least_squares(
        residuals,
        np.clip(x[mine], *bounds.T),
        jac=jacobian,
        bounds=tuple(bounds.T),
        x_scale=problem.sizes[mine],
        loss=loss,
        method="trf",
        xtol=_TIGHT,
        ftol=_TIGHT,
        gtol=_TIGHT,
        max_nfev=_MOST_STEPS,
    )
    every = x.copy()
    every[mine] = found.x
    return Minimum(every, 2.0 * float(found.cost), np.asarray(found.jac), found.status > 0)


def all_residuals(
    problem: Problem, values: Float[np.ndarray, " n_unknowns"], factor: float = 1.0
) -> Float[np.ndarray, " n_residuals"]:
    """Those of the data and of the priors, in standard deviations.

    Args:
        problem: Measurements and unknowns.
        values: Of the unknowns.
        factor: How many times the stated noise counts.
    """
    data = (predict(problem, values).values - problem.observed) / (factor * problem.sigma)
    return np.concatenate([data, problem.prior_residuals(values)])


def cost_of(residuals: Float[np.ndarray, " n_residuals"], loss: str) -> float:
    """What a search minimizes: the sum of rho(r^2) with the loss function rho."""
    return float(np.sum(_LOSSES[loss](residuals**2)))
