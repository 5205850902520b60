"""The three laws of the water that a tank day compares, and their probabilities given the data."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

import laticauda as lc
from laticauda.identify.result import Fit
from laticauda.identify.unknowns import Unknown
from laticauda.robot import Robot, Water, textbook_water

FRICTION = "water.tangential_friction"
"""The number that every law has free: no table states it."""
_FROM_TABLES = ("water.normal_drag", "water.added_mass")
"""Numbers whose priors are the intervals of tables."""


@dataclass(frozen=True, kw_only=True)
class Law:
    """A law of the water, and what of it is identified."""

    water: Water
    """Water with this law."""
    unknowns: tuple[Unknown, ...]
    """Its unknowns."""


def laws_of(robot: Robot) -> Mapping[str, Law]:
    """Return the laws by name.

    Args:
        robot: Robot whose cross sections decide the numbers from tables.
    """
    textbook = textbook_water(robot)
    shared_unknowns = [Unknown(name=FRICTION)]
    for name in _FROM_TABLES:
        low, high = textbook.intervals[name]
        prior = (0.5 * (low + high), 0.5 * (high - low))
        shared_unknowns.append(Unknown(name=name, prior=prior))
    beta = Unknown(
        name="water.drag.beta", start=0.5, prior=(0.5, 0.5), lower=0.0, upper=1.0, scale="linear"
    )
    reference_speed = Unknown(
        name="water.drag.reference_speed", start=0.5, prior=(0.5, 0.5), lower=0.0, scale="linear"
    )
    without_wake = replace(
        textbook.water, added_mass_form="relative", trailing_edge="none", rotational="paper"
    )
    linear_drag = replace(without_wake, drag=lc.PolynomialDrag())
    return {
        "kirchhoff": Law(water=textbook.water, unknowns=(*shared_unknowns, beta)),
        "relative": Law(water=without_wake, unknowns=(*shared_unknowns, beta)),
        "linear": Law(water=linear_drag, unknowns=(*shared_unknowns, reference_speed)),
    }


def log_evidence(fit: Fit, noise_factor: float) -> float:
    """Return the log probability of the data, up to a constant that is the same for all laws.

    ln p = -Q/2 + ln det(C)/2 - sum ln s; see the docstring of the package. The priors keep their
    standard deviations s, whatever the noise.

    Args:
        fit: Fit of one law.
        noise_factor: Factor k on the stated noise, the same for all laws [-].
    """
    problem = fit.problem
    sum_of_squares = fit.chi2 + float(np.sum(problem.prior_residuals(fit.best) ** 2))
    prior_deviations: list[float] = []
    for unknown, value in zip(problem.unknowns, fit.best, strict=True):
        if unknown.prior is not None:
            prior_deviations.append(unknown.prior.sd / unknown.slope(value))
    covariance = _covariance_within_ranges(fit, noise_factor)
    _, log_determinant = np.linalg.slogdet(covariance)
    log_of_priors = float(np.sum(np.log(prior_deviations)))
    return -0.5 * sum_of_squares / noise_factor**2 + 0.5 * float(log_determinant) - log_of_priors


def _covariance_within_ranges(fit: Fit, noise_factor: float) -> Float[np.ndarray, "n n"]:
    """Return the covariance of the coordinates, finite also for unknowns that nothing determines.

    Such an unknown is anywhere in its range: it counts as much as a normal distribution with the
    same volume, sqrt(2 pi) times its standard deviation. It then changes no odds if no law
    determines it.
    """
    covariance = fit.covariance * noise_factor**2
    for k, unknown in enumerate(fit.problem.unknowns):
        if np.isfinite(covariance[k, k]):
            continue
        lower_end, upper_end = unknown.ends
        volume = upper_end - lower_end
        if not np.isfinite(volume):
            volume = unknown.size
        covariance[k, :] = 0.0
        covariance[:, k] = 0.0
        covariance[k, k] = volume**2 / (2.0 * np.pi)
    return covariance
