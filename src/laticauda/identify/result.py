"""`Fit`: the result of an identification, its uncertainty, and how well it describes the measurements."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, cast

import numpy as np
from jaxtyping import Float

from laticauda.identify import measurements, model
from laticauda.identify.exporting import applied, as_parameters
from laticauda.identify.identifiability import LIMIT, Identifiability, analyze_identifiability
from laticauda.identify.noise import noise_widening
from laticauda.identify.problem import Problem, warnings_of
from laticauda.models.simulate.numbers import UNITS
from laticauda.robot import Parameters, Robot, Water
from laticauda.values.checks import check_choice
from laticauda.values.errors import BadArgument
from laticauda.values.optional import optional_import
from laticauda.values.quantities import check_one_among, option, quantity, value_class

_AT_END = 1e-6  # an unknown closer than this to the end of its range, in sizes, is at that end


LOSS = check_one_among("linear", "soft_l1", "huber", "cauchy", "arctan")
NOISE = check_one_among("known", "estimated")


@value_class
class Method:
    """Settings of a fit."""

    noise: str = option(
        "known, or estimated: the same times a common factor", default="known", check=NOISE
    )
    loss: str = option(
        "Loss of the residuals; all but linear weigh outliers less", default="linear", check=LOSS
    )
    n_starts: int = quantity("", "Number of starts", default=4, ge=1)
    seed: int = quantity("", "Seed of the random starts", default=0, ge=0)
    confidence: float = quantity("", "Confidence of the intervals", default=0.95, ge=0.5, le=0.9999)
    limit: float = quantity(
        "", "Relative deviation above which an unknown is not identified", default=LIMIT, gt=0.0
    )

    def quantile(self, degrees: float) -> float:
        """Return the half-width of an interval in standard deviations: Student's t, or normal if the noise is known.

        Args:
            degrees: Degrees of freedom.

        Raises:
            MissingExtra: If scipy is not installed.
        """
        special = optional_import("Identification", "scipy", "identify", "scipy.special")
        share = 0.5 * (1.0 + self.confidence)
        is_normal = self.noise == "known" or np.isinf(degrees)
        return float(special.ndtri(share) if is_normal else special.stdtrit(degrees, share))


@dataclass(frozen=True, kw_only=True)
class ParameterEstimate:
    """Estimate of one unknown."""

    name: str
    """Name of the unknown."""
    unit: str
    """Unit; "" for a pure number."""
    title: str
    """Short description of the unknown."""
    value: float
    """Best value; if it is not identified, one of many that are equally good."""
    sigma: float | None
    """Standard deviation; None if it is not identified."""
    interval: tuple[float, float] | None
    """Confidence interval, computed in the logarithm on a log scale; None if it is not identified."""
    note: str
    """Remarks on the estimate; "" if there are none."""

    @property
    def is_identified(self) -> bool:
        """Whether measurements and prior determine it."""
        return self.interval is not None


@dataclass(frozen=True, kw_only=True, eq=False)
class LocalSearch:
    """Search from one start."""

    start: Float[np.ndarray, " n_unknowns"]
    """Coordinates where it began."""
    end: Float[np.ndarray, " n_unknowns"]
    """Coordinates where it ended."""
    cost: float
    """Sum of squares at the end."""
    jacobian: Float[np.ndarray, "n_residuals n_free"]
    """Jacobian of the residuals at the end, those of the priors last, with respect to the free coordinates."""
    converged: bool
    """Whether it converged."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit:
    """Parameters identified from measurements."""

    problem: Problem
    """Measurements and unknowns."""
    method: Method
    """Settings of the fit."""
    estimates: tuple[ParameterEstimate, ...]
    """Estimate of every unknown."""
    covariance: Float[np.ndarray, "n_unknowns n_unknowns"]
    """Covariance of the errors of the coordinates (logarithms on a log scale); inf where nothing is known."""
    correlations: Float[np.ndarray, "n_unknowns n_unknowns"]
    """Correlations of the errors of the coordinates; nan for unknowns that are not identified [-]."""
    identifiability: Identifiability
    """What the data see, without priors."""
    predictions: Float[np.ndarray, " n_data"]
    """Model predictions, in the order of `problem.observed`."""
    chi2: float
    """Sum of squared residuals of the data, in units of the stated noise [-]."""
    noise_factor: float
    """Ratio of the residuals to the stated noise, given the degrees of freedom; nan if there are none [-]."""
    degrees_of_freedom: float
    """Number of measured numbers minus the number of unknowns fitted to them [-]."""
    widening: Float[np.ndarray, " n_unknowns"]
    """Factors by which the correlation of residuals in time widens the intervals [-]."""
    searches: tuple[LocalSearch, ...]
    """Search from each start, best first."""
    warnings: tuple[str, ...]
    """Warnings about the data."""

    def __getitem__(self, name: str) -> ParameterEstimate:
        """Return the estimate of an unknown by name."""
        names = [estimate.name for estimate in self.estimates]
        return self.estimates[names.index(check_choice("name", name, names))]

    @property
    def values(self) -> dict[str, float]:
        """Best value of every unknown by name; if one is not identified, one of many equally good values."""
        return {estimate.name: estimate.value for estimate in self.estimates}

    @property
    def best(self) -> Float[np.ndarray, " n_unknowns"]:
        """Best values as an array."""
        return np.array([estimate.value for estimate in self.estimates])

    @property
    def used_noise_factor(self) -> float:
        """Factor applied to the stated noise in the uncertainties [-]."""
        return self.noise_factor if self.method.noise == "estimated" else 1.0

    @property
    def x(self) -> Float[np.ndarray, " n_unknowns"]:
        """Coordinates of the best values."""
        return self.problem.x_of(self.best)

    @property
    def n_agreeing(self) -> int:
        """Number of starts that ended as well as the best one."""
        return sum(agree(search.cost, self.searches[0].cost) for search in self.searches)

    @property
    def status(self) -> str:
        """One-sentence summary of the result."""
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
        """Return one row per unknown, for tables and JSON: name, value, sigma, low, high, unit, note."""
        return [
            {
                "name": one.name,
                "value": one.value if one.is_identified else None,
                "sigma": one.sigma,
            }
            | dict(zip(("low", "high"), one.interval or (None, None), strict=True))
            | {"unit": one.unit, "note": one.note}
            for one in self.estimates
        ]

    @cached_property
    def residuals(self) -> list[dict[str, Any]]:
        """One row per measured figure or series, as shown in tables, in the order of `problem.places`.

        Measured values are without the selection bias; they and the predictions are None for a
        series. Off is predicted minus measured, root mean square for a series; standard deviations
        are those of the stated noise.
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
        """Return the positions of a figure in the data, one for each measurement that has it.

        Args:
            figure: Name of the figure.

        Raises:
            ValueError: If no measurement has it.
        """
        places = [
            one.at.start for one in self.problem.places if one.what == figure and not one.is_series
        ]
        if not places:
            measured = sorted({one.what for one in self.problem.places})
            raise BadArgument(
                "figure", f"must be one that was measured ({', '.join(measured)}), got {figure!r}"
            )
        return places

    def percentage_error(
        self,
        figure: str = "forward_velocity",
        predictions: Float[np.ndarray, " n_data"] | None = None,
    ) -> float:
        """Return the mean of |predicted - measured| / measured over all nonzero measurements of a figure [%].

        Args:
            figure: Name of the figure.
            predictions: Predictions; None: its own. The error is nan if one of them is nan, or if
                all measured are 0.

        Raises:
            ValueError: If the figure was not measured.
        """
        at = self.places_of(figure)
        measured = self.problem.observed[at]
        off = (self.predictions if predictions is None else predictions)[at] - measured
        shares = np.abs(off[measured != 0.0] / measured[measured != 0.0])
        return 100.0 * float(np.mean(shares)) if shares.size else math.nan

    def robot(self, robot: Robot, gait_kind: str) -> Robot:
        """Return a robot with the identified values applied.

        Args:
            robot: Robot to change; a fin's numbers are skipped if it has none.
            gait_kind: Kind of gait for which they apply.
        """
        return applied(
            self.problem, self.values, replace(self.problem.scenarios[0], robot=robot), gait_kind
        ).robot

    def water(self, water: Water, gait_kind: str) -> Water:
        """Return a water with the identified values applied.

        Args:
            water: Water to change.
            gait_kind: Kind of gait for which they apply.
        """
        changed = replace(self.problem.scenarios[0], environment=water)
        return cast(Water, applied(self.problem, self.values, changed, gait_kind).environment)

    def parameters(self, name: str, title: str) -> Parameters:
        """Return the identified values as a parameter file: `.save(path)` writes it, `--parameters` takes it.

        A gait gets its own numbers where they differ; numbers not identified keep their values in
        the measurements.

        Args:
            name: Name of the parameters in files and stored trials.
            title: Text for legends.

        Raises:
            ValueError: If the measurements were not made in water, or a parameter file cannot hold
                an identified value.
        """
        return as_parameters(self.problem, self.values, name, title)


def agree(cost: float, other: float) -> bool:
    """Check whether two searches have reached the same minimum, by their sums of squares.

    Args:
        cost: Sum of squares of one search.
        other: Sum of squares of the other.
    """
    return abs(cost - other) <= 1e-3 * max(1.0, other * 1e-3)


def fit_of(
    problem: Problem, method: Method, best: LocalSearch, searches: Sequence[LocalSearch]
) -> Fit:
    """Assemble the result of a fit at the end of a search.

    Args:
        problem: Measurements and unknowns.
        method: Settings of the fit.
        best: Best search, with its Jacobian in units of the noise that applies.
        searches: All searches, best first.
    """
    values, jacobian = problem.values_of(best.end), best.jacobian
    predicted = model.predict(problem, values).values
    off = (predicted - problem.observed) / problem.sigma
    chi2 = float(np.sum(off**2))
    by_data = analyze_identifiability(
        problem.information(jacobian), problem.unknowns, limit=method.limit
    )
    by_all = analyze_identifiability(jacobian.T @ jacobian, problem.unknowns, limit=method.limit)
    n_priors = sum(unknown.prior is not None for unknown in problem.unknowns)
    degrees = float(problem.observed.size - max(len(problem.unknowns) - n_priors, 0))
    is_known = method.noise == "known"
    wider, lags = noise_widening(problem, jacobian, off, None if is_known else degrees)
    covariance, correlations = _covariance(problem, jacobian, by_all)
    total = chi2 + float(np.sum(problem.prior_residuals(values) ** 2))
    quantile = method.quantile(degrees)
    warnings = warnings_of(
        problem, total if is_known else math.nan, degrees, lags, float(np.max(wider))
    )
    return Fit(
        problem=problem,
        method=method,
        estimates=tuple(
            _estimate(problem, k, values, by_data, by_all, float(wider[k]), quantile)
            for k in range(values.size)
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


def _covariance(
    problem: Problem, jacobian: np.ndarray, seen: Identifiability
) -> tuple[np.ndarray, np.ndarray]:
    """Compute covariance and correlations of the coordinates; inf and nan for unknowns that are not seen."""
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
    """Return the estimate of one unknown."""
    unknown, value = problem.unknowns[k], float(values[k])
    share, alone = (wider * float(seen.sigma[k]) for seen in (by_all, by_data))
    x, deviation = unknown.x(value), share * unknown.size
    identified = share < by_all.limit
    parameter, notes = unknown.parameter, list[str]()
    if unknown.name in by_data.without_effect:
        notes.append("has no effect on what was measured")
    elif alone >= by_data.limit:
        its_own = [direction for direction in by_data.directions if abs(direction.weights[k]) > 0.1]
        worst = max(
            its_own, key=lambda direction: abs(direction.weights[k]) * min(direction.sigma, 1e9)
        )
        notes.append(
            f"{'' if identified else 'not identifiable: '}the data do not see {worst.name}"
        )
    if (
        unknown.prior is not None
        and share**2 > 0.5 * (unknown.prior[1] / unknown.slope(value) / unknown.size) ** 2
    ):
        notes.append("known from the prior rather than from the data")
    reach = _AT_END * (1.0 if unknown.is_log else unknown.size)
    for end, word in ((unknown.lower, "lower"), (unknown.upper, "upper")):
        if math.isfinite(end) and abs(unknown.x(end) - x) <= reach:
            notes.append(f"at the {word} end of its range")
    low, high = (
        unknown.value(x + sign * quantile * deviation) if identified else 0.0
        for sign in (-1.0, 1.0)
    )
    return ParameterEstimate(
        name=unknown.name,
        unit=parameter.unit,
        title=parameter.title,
        value=value,
        sigma=deviation * unknown.slope(value) if identified else None,
        interval=(low, high) if identified else None,
        note="; ".join(notes),
    )
