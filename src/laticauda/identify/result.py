"""`Fit`: what an identification found, with its uncertainty, and how well it describes the measurements."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, cast

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument, one_of, optional_import
from laticauda.identify import measurements, model
from laticauda.identify.exporting import applied, as_parameters
from laticauda.identify.identifiability import LIMIT, Identifiability, identifiability
from laticauda.identify.noise import widening
from laticauda.identify.problem import Problem, warnings_of
from laticauda.quantities import one_among, option, quantity, value
from laticauda.robot import Parameters, Robot, Water
from laticauda.simulate.numbers import UNITS

_AT_END = 1e-6  # closer to the end of its range, in sizes, an unknown is there


LOSS = one_among("linear", "soft_l1", "huber", "cauchy", "arctan")
NOISE = one_among("known", "estimated")


@value
class Method:
    """How a fit is made."""

    noise: str = option("known, or estimated: that times a factor of all", default="known", check=NOISE)
    loss: str = option("How residuals count: all but linear let outliers count less", default="linear", check=LOSS)
    n_starts: int = quantity("", "How many starts", default=4, ge=1)
    seed: int = quantity("", "Seed of the random starts", default=0, ge=0)
    confidence: float = quantity("", "Confidence of the intervals", default=0.95, ge=0.5, le=0.9999)
    limit: float = quantity("", "Relative deviation from which on an unknown is not identified", default=LIMIT, gt=0.0)

    def quantile(self, degrees: float) -> float:
        """How many standard deviations an interval reaches to either side: Student's t, normal if the noise is known.

        Args:
            degrees: Of freedom.

        Raises:
            MissingExtra: If scipy is not installed.
        """
        special = optional_import("Identification", "scipy", "identify", "scipy.special")
        share = 0.5 * (1.0 + self.confidence)
        is_normal = self.noise == "known" or np.isinf(degrees)
        return float(special.ndtri(share) if is_normal else special.stdtrit(degrees, share))


@dataclass(frozen=True, kw_only=True)
class ParameterEstimate:
    """What is known of one unknown."""

    name: str
    """Its name."""
    unit: str
    """Its unit; "" for a pure number."""
    title: str
    """What it is, in a few words."""
    value: float
    """The best value; of one that is not identified, one of many that are as good."""
    sigma: float | None
    """Standard deviation; None if it is not identified."""
    interval: tuple[float, float] | None
    """Confidence interval, from errors of the logarithm on a log scale; None if it is not identified."""
    note: str
    """What is to be known about it; "" if nothing."""

    @property
    def is_identified(self) -> bool:
        """Whether measurements and prior say what it is."""
        return self.interval is not None


@dataclass(frozen=True, kw_only=True, eq=False)
class LocalSearch:
    """One start of the search."""

    start: Float[np.ndarray, " n_unknowns"]
    """Coordinates where it began."""
    end: Float[np.ndarray, " n_unknowns"]
    """Coordinates where it ended."""
    cost: float
    """Sum of squares there."""
    jacobian: Float[np.ndarray, "n_residuals n_free"]
    """Of the residuals there, those of the priors last, to the coordinates that were free."""
    converged: bool
    """Whether it ended by itself."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit:
    """Parameters identified from measurements."""

    problem: Problem
    """Measurements and unknowns."""
    method: Method
    """How it was made."""
    estimates: tuple[ParameterEstimate, ...]
    """What is known of every unknown."""
    covariance: Float[np.ndarray, "n_unknowns n_unknowns"]
    """Of the errors of the coordinates, logarithms on a log scale; inf where nothing is known."""
    correlations: Float[np.ndarray, "n_unknowns n_unknowns"]
    """Of the same; nan for what is not identified [-]."""
    identifiability: Identifiability
    """What the data see, without priors."""
    predictions: Float[np.ndarray, " n_data"]
    """What the model says, in the order of `problem.observed`."""
    chi2: float
    """Sum of squared residuals of the data, in the noise as stated [-]."""
    noise_factor: float
    """How many times the stated noise the residuals are, by the degrees of freedom; nan without any [-]."""
    degrees_of_freedom: float
    """Numbers measured less what is fitted to them [-]."""
    widening: Float[np.ndarray, " n_unknowns"]
    """How many times as wide intervals are because residuals are correlated in time [-]."""
    searches: tuple[LocalSearch, ...]
    """What each start led to, the best first."""
    warnings: tuple[str, ...]
    """What is to be known about the data."""

    def __getitem__(self, name: str) -> ParameterEstimate:
        """The estimate of an unknown by name."""
        names = [estimate.name for estimate in self.estimates]
        return self.estimates[names.index(one_of("name", name, names))]

    @property
    def values(self) -> dict[str, float]:
        """The best value of every unknown by name; what is not identified has one of many."""
        return {estimate.name: estimate.value for estimate in self.estimates}

    @property
    def best(self) -> Float[np.ndarray, " n_unknowns"]:
        """The same as an array."""
        return np.array([estimate.value for estimate in self.estimates])

    @property
    def used_noise_factor(self) -> float:
        """How many times the stated noise the uncertainties take the noise for [-]."""
        return self.noise_factor if self.method.noise == "estimated" else 1.0

    @property
    def x(self) -> Float[np.ndarray, " n_unknowns"]:
        """The coordinates of the values."""
        return self.problem.x_of(self.best)

    @property
    def n_agreeing(self) -> int:
        """How many starts ended as well as the best one."""
        return sum(agree(search.cost, self.searches[0].cost) for search in self.searches)

    @property
    def status(self) -> str:
        """A sentence about the result."""
        sought = [self.estimates[k] for k in self.problem.of_interest] or self.estimates
        good = sum(estimate.is_identified for estimate in sought)
        noise = f"residuals are {self.noise_factor:.2g} times the stated noise"
        noise = noise if np.isfinite(self.noise_factor) else "as many numbers as unknowns"
        searches = f"{self.n_agreeing} of {len(self.searches)} starts agree"
        return (
            f"{good} of {len(sought)} parameters identified from {len(self.problem.measurements)} "
            f"measurements ({self.problem.observed.size} numbers); {noise}; {searches}."
        )

    def table(self) -> list[dict[str, Any]]:
        """A row per unknown, for tables and JSON: name, value, sigma, low, high, unit, note."""
        return [
            {"name": one.name, "value": one.value if one.is_identified else None, "sigma": one.sigma}
            | dict(zip(("low", "high"), one.interval or (None, None), strict=True))
            | {"unit": one.unit, "note": one.note}
            for one in self.estimates
        ]

    @cached_property
    def residuals(self) -> list[dict[str, Any]]:
        """A row per measured figure, or per series, as tables show them, in the order of `problem.places`.

        What is measured is without the bias of selection; it and the prediction are None for a series. Off is predicted
        less measured, root mean square for a series; standard deviations are of the noise as stated.
        """
        found: list[dict[str, Any]] = []
        p, units = self.problem, UNITS | measurements.LOADS | measurements.SERIES
        for place in p.places:
            off = (self.predictions - p.observed)[place.at]
            deviation = float(np.sqrt(np.mean(off**2)) if place.is_series else off[0])
            both = [float(every[place.at.start]) for every in (p.observed, self.predictions)]
            measured, predicted = (None, None) if place.is_series else both
            found.append(
                {
                    "group": p.groups[place.owner],
                    "measurement": p.measurements[place.owner].name,
                    "what": place.what.replace("_", " "),
                    "unit": units[place.what] or "-",
                    "measured": measured,
                    "predicted": predicted,
                    "off": deviation,
                    "off [%]": 100.0 * deviation / measured if measured else None,
                    "in standard deviations [-]": deviation / place.sigma,
                }
            )
        return found

    def places_of(self, figure: str) -> list[int]:
        """Where a figure of every measurement that has it stands among the data.

        Args:
            figure: Its name.

        Raises:
            ValueError: If no measurement has it.
        """
        places = [one.at.start for one in self.problem.places if one.what == figure and not one.is_series]
        if not places:
            measured = sorted({one.what for one in self.problem.places})
            raise BadArgument("figure", f"must be one that was measured, of {', '.join(measured)}, got {figure!r}")
        return places

    def percentage_error(
        self, figure: str = "forward_velocity", predictions: Float[np.ndarray, " n_data"] | None = None
    ) -> float:
        """Mean of |predicted - measured| / measured over all measurements of a figure that are not 0 [%].

        Args:
            figure: Its name.
            predictions: As its own, which None takes; where one is nan, so is the error; also if all are 0.

        Raises:
            ValueError: If it was not measured.
        """
        at = self.places_of(figure)
        measured = self.problem.observed[at]
        off = (self.predictions if predictions is None else predictions)[at] - measured
        shares = np.abs(off[measured != 0.0] / measured[measured != 0.0])
        return 100.0 * float(np.mean(shares)) if shares.size else math.nan

    def robot(self, robot: Robot, gait_kind: str) -> Robot:
        """A robot with what was identified of it.

        Args:
            robot: What to change; a fin's numbers are left out if it has none.
            gait_kind: For which gait.
        """
        return applied(self.problem, self.values, replace(self.problem.scenarios[0], robot=robot), gait_kind).robot

    def water(self, water: Water, gait_kind: str) -> Water:
        """A water with what was identified of it.

        Args:
            water: What to change.
            gait_kind: For which gait.
        """
        changed = replace(self.problem.scenarios[0], environment=water)
        return cast(Water, applied(self.problem, self.values, changed, gait_kind).environment)

    def parameters(self, name: str, title: str) -> Parameters:
        """What was identified, as a parameter file has it: `.save(path)` writes it, `--parameters` takes it.

        A gait gets numbers of its own where they differ; what was not identified stays what it was in the measurements.

        Args:
            name: What files and stored trials call them.
            title: What a legend says.

        Raises:
            ValueError: If the measurements were not made in water, or a parameter file cannot say what was identified.
        """
        return as_parameters(self.problem, self.values, name, title)


def agree(cost: float, other: float) -> bool:
    """Whether two searches have come to one minimum, by their sums of squares.

    Args:
        cost: Of one.
        other: Of the other.
    """
    return abs(cost - other) <= 1e-3 * max(1.0, other * 1e-3)


def fit_of(problem: Problem, method: Method, best: LocalSearch, searches: Sequence[LocalSearch]) -> Fit:
    """Everything that is known at the end of a search.

    Args:
        problem: Measurements and unknowns.
        method: How it was searched.
        best: Where it ended, its Jacobian in the noise that counts.
        searches: All of them, the best first.
    """
    values, jacobian = problem.values_of(best.end), best.jacobian
    predicted = model.predict(problem, values).values
    off = (predicted - problem.observed) / problem.sigma
    chi2 = float(np.sum(off**2))
    by_data = identifiability(problem.information(jacobian), problem.unknowns, limit=method.limit)
    by_all = identifiability(jacobian.T @ jacobian, problem.unknowns, limit=method.limit)
    n_priors = sum(unknown.prior is not None for unknown in problem.unknowns)
    degrees = float(problem.observed.size - max(len(problem.unknowns) - n_priors, 0))
    is_known = method.noise == "known"
    wider, lags = widening(problem, jacobian, off, None if is_known else degrees)
    covariance, correlations = _covariance(problem, jacobian, by_all)
    total = chi2 + float(np.sum(problem.prior_residuals(values) ** 2))
    quantile = method.quantile(degrees)
    warnings = warnings_of(problem, total if is_known else math.nan, degrees, lags, float(np.max(wider)))
    return Fit(
        problem=problem,
        method=method,
        estimates=tuple(
            _estimate(problem, k, values, by_data, by_all, float(wider[k]), quantile) for k in range(values.size)
        ),
        covariance=covariance * np.outer(wider, wider),
        correlations=correlations,
        identifiability=by_data,
        predictions=predicted,
        chi2=chi2,
        noise_factor=math.sqrt(chi2 / degrees) if degrees > 0.0 else math.nan,
        degrees_of_freedom=degrees,
        widening=wider,
        searches=tuple(searches),
        warnings=(*warnings, *by_data.words),
    )


def _covariance(problem: Problem, jacobian: np.ndarray, seen: Identifiability) -> tuple[np.ndarray, np.ndarray]:
    """Covariance and correlations of the coordinates; inf and nan for what is not seen at all."""
    sizes = problem.sizes
    scaled = jacobian * sizes
    covariance = np.linalg.pinv(scaled.T @ scaled, rcond=1e-13, hermitian=True)
    blind = ~np.isfinite(seen.sigma)
    with np.errstate(divide="ignore", invalid="ignore"):
        deviation = np.sqrt(np.diag(covariance))
        correlations = np.clip(covariance / np.outer(deviation, deviation), -1.0, 1.0)
    covariance = covariance * np.outer(sizes, sizes)
    covariance[blind, :], covariance[:, blind] = np.inf, np.inf
    hidden = seen.sigma >= seen.limit
    correlations[hidden, :], correlations[:, hidden] = np.nan, np.nan
    return covariance, correlations


def _estimate(
    problem: Problem,
    k: int,
    values: np.ndarray,
    by_data: Identifiability,
    by_all: Identifiability,
    wider: float,
    quantile: float,
) -> ParameterEstimate:
    """What is known of one unknown."""
    unknown, value = problem.unknowns[k], float(values[k])
    share, alone = (wider * float(seen.sigma[k]) for seen in (by_all, by_data))
    x, deviation = unknown.x(value), share * unknown.size
    identified = share < by_all.limit
    parameter, notes = unknown.parameter, list[str]()
    if unknown.name in by_data.without_effect:
        notes.append("has no effect on what was measured")
    elif alone >= by_data.limit:
        its_own = [direction for direction in by_data.directions if abs(direction.weights[k]) > 0.1]
        worst = max(its_own, key=lambda direction: abs(direction.weights[k]) * min(direction.sigma, 1e9))
        notes.append(f"{'' if identified else 'not identifiable: '}the data do not see {worst.name}")
    if unknown.prior is not None and share**2 > 0.5 * (unknown.prior[1] / unknown.slope(value) / unknown.size) ** 2:
        notes.append("known from the prior rather than from the data")
    reach = _AT_END * (1.0 if unknown.is_log else unknown.size)
    for end, word in ((unknown.lower, "lower"), (unknown.upper, "upper")):
        if math.isfinite(end) and abs(unknown.x(end) - x) <= reach:
            notes.append(f"at the {word} end of its range")
    low, high = (unknown.value(x + sign * quantile * deviation) if identified else 0.0 for sign in (-1.0, 1.0))
    return ParameterEstimate(
        name=unknown.name,
        unit=parameter.unit,
        title=parameter.title,
        value=value,
        sigma=deviation * unknown.slope(value) if identified else None,
        interval=(low, high) if identified else None,
        note="; ".join(notes),
    )
