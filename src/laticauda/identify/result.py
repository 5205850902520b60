"""`Fit`: what an identification found, with its uncertainty, and how well it describes the measurements."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, cast

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument, one_of
from laticauda.identify.exporting import applied, as_parameters
from laticauda.identify.identifiability import Identifiability
from laticauda.identify.least_squares import Method
from laticauda.identify.measurements import SERIES
from laticauda.identify.problem import Problem
from laticauda.robot import Parameters, Robot, Water
from laticauda.simulate.numbers import UNITS


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


@dataclass(frozen=True, kw_only=True)
class LocalSearch:
    """One start of the search."""

    start: Mapping[str, float]
    """Where it began."""
    end: Mapping[str, float]
    """Where it ended."""
    cost: float
    """Sum of squares there; nan if it could not begin."""
    converged: bool
    """Whether it ended by itself."""


@dataclass(frozen=True, kw_only=True)
class Residual:
    """One measured figure, or all samples of one series, beside the prediction."""

    measurement: str
    """Its name."""
    group: str
    """That of its group."""
    what: str
    """Name of the figure or series."""
    unit: str
    """Its unit."""
    measured: float | None
    """The figure, without the bias of selection; None for a series."""
    predicted: float | None
    """The same from the model; None for a series."""
    deviation: float
    """Predicted less measured; root mean square for a series."""
    in_sigmas: float
    """The same in standard deviations of the noise as stated [-]."""


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
        best = self.searches[0].cost
        return sum(search.cost <= best + 1e-3 * max(1.0, best * 1e-3) for search in self.searches)

    @property
    def status(self) -> str:
        """A sentence about the result."""
        good = sum(estimate.is_identified for estimate in self.estimates)
        noise = (
            f"residuals are {self.noise_factor:.2g} times the stated noise"
            if np.isfinite(self.noise_factor)
            else ("as many numbers as unknowns")
        )
        searches = f"{self.n_agreeing} of {len(self.searches)} starts agree"
        return (
            f"{good} of {len(self.estimates)} parameters identified from {len(self.problem.measurements)} "
            f"measurements ({self.problem.observed.size} numbers); {noise}; {searches}."
        )

    def table(self) -> list[dict[str, Any]]:
        """A row per unknown, for tables and JSON: name, value, sigma, low, high, unit, note."""
        rows: list[dict[str, Any]] = []
        for estimate in self.estimates:
            low, high = estimate.interval or (None, None)
            value = estimate.value if estimate.is_identified else None
            row = {"name": estimate.name, "value": value, "sigma": estimate.sigma, "low": low, "high": high}
            rows.append(row | {"unit": estimate.unit, "note": estimate.note})
        return rows

    @cached_property
    def residuals(self) -> tuple[Residual, ...]:
        """Every measured figure and series beside its prediction."""
        found: list[Residual] = []
        p = self.problem
        for place in p.places:
            off, group = (self.predictions - p.observed)[place.at], p.groups[place.owner]
            deviation = float(np.sqrt(np.mean(off**2)) if place.is_series else off[0])
            found.append(
                Residual(
                    measurement=p.measurements[place.owner].name,
                    group=group,
                    what=place.what,
                    unit=(SERIES if place.is_series else UNITS)[place.what],
                    measured=None if place.is_series else float(p.observed[place.at.start]),
                    predicted=None if place.is_series else float(self.predictions[place.at.start]),
                    deviation=deviation,
                    in_sigmas=deviation / place.sigma,
                )
            )
        return tuple(found)

    def percentage_error(self, figure: str = "forward_velocity") -> float:
        """Mean of |predicted - measured| / measured over all measurements of a figure [%].

        Args:
            figure: Its name.

        Raises:
            ValueError: If it was not measured.
        """
        mine = [residual for residual in self.residuals if residual.what == figure]
        if not mine:
            measured = sorted({residual.what for residual in self.residuals})
            raise BadArgument("figure", f"must be one that was measured, of {', '.join(measured)}, got {figure!r}")
        return 100.0 * float(np.mean([abs(r.deviation / r.measured) for r in mine if r.measured]))

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
