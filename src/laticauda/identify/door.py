"""The door of scipy and emcee: least squares, two quantiles, and a sampler."""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportMissingTypeStubs=false

from collections.abc import Callable
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from laticauda.errors import MissingExtra

Vector = np.ndarray
LOSSES = ("linear", "soft_l1", "huber", "cauchy", "arctan")
_TIGHT = 1e-10


class Found(NamedTuple):
    """Where a search ended."""

    x: Vector
    cost: float
    jacobian: Vector
    converged: bool
    evaluations: int


def _library(name: str, package: str) -> Any:
    try:
        return import_module(name)
    except ImportError as error:
        raise MissingExtra("Identification", package, "identify") from error


def least_squares(
    residuals: Callable[[Vector], Vector],
    jacobian: Callable[[Vector], Vector],
    x: Vector,
    bounds: tuple[Vector, Vector],
    sizes: Vector,
    *,
    loss: str,
    most: int,
) -> Found:
    """The least sum of squares in a box, by a trust region (scipy's `trf`).

    Args:
        residuals: In standard deviations.
        jacobian: Their derivatives.
        x: Where to begin.
        bounds: Least and greatest x.
        sizes: What is a large change of each.
        loss: One of `LOSSES`; all but linear give outliers less weight.
        most: Steps.

    Raises:
        MissingExtra: If scipy is not installed.
    """
    optimize = _library("scipy.optimize", "scipy")
    result = optimize.least_squares(
        residuals,
        x,
        jac=jacobian,
        bounds=bounds,
        x_scale=sizes,
        loss=loss,
        method="trf",
        xtol=_TIGHT,
        ftol=_TIGHT,
        gtol=_TIGHT,
        max_nfev=most,
    )
    return Found(result.x, 2.0 * float(result.cost), np.asarray(result.jac), result.status > 0, int(result.nfev))


def two_sided(confidence: float, degrees: float) -> float:
    """The quantile of Student's t (normal for infinite degrees of freedom) with `confidence` between -q and q."""
    special = _library("scipy.special", "scipy")
    share = 0.5 * (1.0 + confidence)
    return float(special.ndtri(share) if np.isinf(degrees) else special.stdtrit(degrees, share))


def sum_of(residuals: Vector, loss: str) -> float:
    """What `least_squares` minimizes: the sum of rho(r^2) with the loss function rho."""
    z = residuals**2
    match loss:
        case "soft_l1":
            rho = 2.0 * (np.sqrt(1.0 + z) - 1.0)
        case "huber":
            rho = np.where(z <= 1.0, z, 2.0 * np.sqrt(z) - 1.0)
        case "cauchy":
            rho = np.log1p(z)
        case "arctan":
            rho = np.arctan(z)
        case _:
            rho = z
    return float(np.sum(rho))


def walk(
    begin: Vector,
    log_probability: Callable[[Vector], Vector],
    n_steps: int,
    seed: int,
    progress: Callable[[float], None] | None,
) -> tuple[Vector, float]:
    """Let emcee's ensemble of walkers walk.

    Args:
        begin: A row per walker.
        log_probability: Of all walkers at once.
        n_steps: How many steps.
        seed: Of the walk.
        progress: Called after each step with the share that is finished.

    Returns:
        Step by step the places of all walkers, and the share of proposals that were taken.

    Raises:
        MissingExtra: If emcee is not installed.
    """
    emcee = _library("emcee", "emcee")
    sampler = emcee.EnsembleSampler(*begin.shape, log_probability, vectorize=True)
    sampler.random_state = np.random.RandomState(seed).get_state()
    for step, _ in enumerate(sampler.sample(begin, iterations=n_steps, skip_initial_state_check=True)):
        if progress is not None:
            progress((step + 1) / n_steps)
    return np.asarray(sampler.get_chain()), float(np.mean(sampler.acceptance_fraction))
