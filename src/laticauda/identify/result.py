"""`Fit`: the result of an identification, its uncertainty, and how well it describes the data."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, cast

import numpy as np
from jaxtyping import Float

from laticauda.identify.doubt import Doubt
from laticauda.identify.exporting import (
    applied,
    as_parameters,
    check_parameter_file_holds,
    list_beyond_parameter_file,
)
from laticauda.identify.identifiability import Identifiability
from laticauda.identify.local_search import LocalSearch
from laticauda.identify.method import Method
from laticauda.identify.problem import DataBlock, Problem
from laticauda.identify.series import SERIES
from laticauda.identify.starts import ENOUGH, count_reaching
from laticauda.identify.towing import LOADS
from laticauda.models.simulate import UNITS
from laticauda.robot import Parameters, Robot, Water
from laticauda.values import BadArgument, check_choice

_UNITS = UNITS | LOADS | SERIES
"""Units of all that can be measured, by name."""
MOST_SHOWN = 4
"""Estimates that one line shows."""


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
    """Confidence interval, that of the logarithm on a log scale; None if it is not identified."""
    note: str
    """Remarks on the estimate; "" if there are none."""

    @property
    def is_identified(self) -> bool:
        """Whether measurements and prior determine it."""
        return self.interval is not None


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
    """Covariance of the errors of the coordinates; inf where nothing is known."""
    correlations: Float[np.ndarray, "n_unknowns n_unknowns"]
    """Correlations of the errors of the coordinates; nan for those not identified [-]."""
    identifiability: Identifiability
    """What the data see, without priors."""
    predictions: Float[np.ndarray, " n_data"]
    """Model predictions, in the order of `problem.observed`."""
    chi2: float
    """Sum of squared residuals of the data, in units of the stated noise [-]."""
    noise_factor: float
    """Ratio of the residuals to the stated noise; nan without degrees of freedom [-].

    See `laticauda.identify.noise_factor` on how it is counted.
    """
    used_noise_factor: float
    """Factor on the stated noise that covariance, intervals, profiles and posterior apply [-].

    It is 1 if the noise is known, and `noise_factor` if it is estimated; if the model describes the
    data exactly, nothing can be estimated, and it is 1.
    """
    degrees_of_freedom: float
    """Number of measured numbers minus the number of unknowns fitted to them [-].

    If the noise is estimated, an unknown with a prior counts by the share that the data determine.
    """
    widening: Float[np.ndarray, " n_unknowns"]
    """Factors by which the correlation of residuals in time widens the intervals [-]."""
    searches: tuple[LocalSearch, ...]
    """Search from each start, best first."""
    warnings: tuple[str, ...]
    """Warnings about the data."""
    doubt: Doubt | None = None
    """What the residuals say against model or noise; None if the stated noise can leave them."""

    def __repr__(self) -> str:
        """Return one line: what was identified, and from how many measurements."""
        n_measurements = len(self.problem.measurements)
        numbers = [f"{estimate.name} = {estimate.value:.4g}" for estimate in self.estimates]
        if len(numbers) > MOST_SHOWN:
            numbers[MOST_SHOWN:] = [f"{len(numbers) - MOST_SHOWN} more"]
        return f"<Fit to {n_measurements} measurements: {', '.join(numbers)}>"

    def __getitem__(self, name: str) -> ParameterEstimate:
        """Return the estimate of an unknown by name."""
        names = [estimate.name for estimate in self.estimates]
        return self.estimates[names.index(check_choice("name", name, names))]

    def simulated_on(self, client: Any) -> "Fit":
        """Return the same fit, whose trials a cluster simulates from now on.

        Args:
            client: A `dask.distributed.Client`; None: this process does.
        """
        return replace(self, problem=replace(self.problem, client=client))

    @property
    def values(self) -> dict[str, float]:
        """Best value of every unknown by name; if not identified, one of many as good."""
        return {estimate.name: estimate.value for estimate in self.estimates}

    @property
    def best(self) -> Float[np.ndarray, " n_unknowns"]:
        """Best values q as an array, in the order of the unknowns."""
        return np.array([estimate.value for estimate in self.estimates])

    @property
    def x(self) -> Float[np.ndarray, " n_unknowns"]:
        """Coordinates of the best values: ln q, or q (see `laticauda.identify.unknowns`)."""
        return self.problem.coordinates_of(self.best)

    @property
    def n_agreeing(self) -> int:
        """Number of starts that ended as well as the best one."""
        return count_reaching(self.problem, self.searches)

    @property
    def is_model_doubted(self) -> bool:
        """Whether residuals say that the model is wrong, so that intervals do not hold."""
        return self.doubt is not None and self.doubt.is_of_model

    @property
    def status(self) -> str:
        """One-sentence summary of the result."""
        shown = [self.estimates[k] for k in self.problem.of_interest] or self.estimates
        n_identified = sum(estimate.is_identified for estimate in shown)
        noise = "as many numbers as unknowns"
        if np.isfinite(self.noise_factor):
            noise = f"residuals are {self.noise_factor:.2g} times the stated noise"
        n_numbers = self.problem.observed.size
        return (
            f"{n_identified} of {len(shown)} parameters identified from "
            f"{len(self.problem.measurements)} measurements ({n_numbers} numbers); {noise}; "
            f"{self._words_of_starts}."
        )

    @property
    def _words_of_starts(self) -> str:
        """How many starts there were, and how many of them came to this minimum."""
        n_starts = len(self.searches)
        if n_starts == 1:
            return "1 start, compared with no other"
        text = f"{self.n_agreeing} of {n_starts} starts reached this minimum"
        if n_starts < self.method.n_starts:
            return text
        if self.n_agreeing < ENOUGH:
            return f"only {text}, and no more were allowed"
        return text

    def table(self) -> list[dict[str, Any]]:
        """Return one row per unknown: name, value, sigma, low, high, unit, note."""
        return [_row_of_estimate(estimate) for estimate in self.estimates]

    @cached_property
    def residuals(self) -> list[dict[str, Any]]:
        """One row per measured figure or series, in the order of `problem.data_blocks`.

        Measured values are without the selection bias; they and the predictions are None for a
        series. Off is predicted minus measured, root mean square for a series; standard deviations
        are those of the stated noise.
        """
        return [self._row_of_residuals(block) for block in self.problem.data_blocks]

    def _row_of_residuals(self, block: DataBlock) -> dict[str, Any]:
        problem = self.problem
        predicted_numbers = self.predictions[block.numbers]
        measured_numbers = problem.observed[block.numbers]
        differences = predicted_numbers - measured_numbers
        measured: float | None = None
        predicted: float | None = None
        percent: float | None = None
        if block.is_series:
            off = float(np.sqrt(np.mean(differences**2)))
        else:
            off = float(differences[0])
            measured = float(measured_numbers[0])
            predicted = float(predicted_numbers[0])
        if measured:
            percent = 100.0 * off / measured
        return {
            "group": problem.groups[block.owner],
            "measurement": problem.measurements[block.owner].name,
            "what": block.name.replace("_", " "),
            "unit": _UNITS[block.name] or "-",
            "measured": measured,
            "predicted": predicted,
            "off": off,
            "off [%]": percent,
            "in standard deviations [-]": off / block.usual_sigma,
        }

    def places_of(self, figure: str) -> list[int]:
        """Return the positions of a figure in the data, one for each measurement that has it.

        Args:
            figure: Name of the figure.

        Raises:
            ValueError: If no measurement has it.
        """
        blocks = self.problem.data_blocks
        positions = [
            block.numbers.start for block in blocks if block.name == figure and not block.is_series
        ]
        if not positions:
            measured = ", ".join(sorted({block.name for block in blocks}))
            rule = f"must be one that was measured ({measured}), got {figure!r}"
            raise BadArgument("figure", rule)
        return positions

    def percentage_error(
        self,
        figure: str = "forward_velocity",
        predictions: Float[np.ndarray, " n_data"] | None = None,
    ) -> float:
        """Return the mean of |predicted - measured| / measured over all that are not zero [%].

        Args:
            figure: Name of the figure.
            predictions: Predictions; None: its own. The error is nan if one of them is nan, or if
                all measured are 0.

        Raises:
            ValueError: If the figure was not measured.
        """
        if predictions is None:
            predictions = self.predictions
        positions = self.places_of(figure)
        measured = self.problem.observed[positions]
        off = predictions[positions] - measured
        is_nonzero = measured != 0.0
        relative_errors = np.abs(off[is_nonzero] / measured[is_nonzero])
        if relative_errors.size == 0:
            return math.nan
        return 100.0 * float(np.mean(relative_errors))

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

    @property
    def beyond_parameter_file(self) -> tuple[str, ...]:
        """Identified numbers of single parts of robot and gait, which a parameter file cannot hold."""
        return list_beyond_parameter_file(self.problem)

    def parameters(self, name: str, title: str) -> Parameters:
        """Return the identified values as a parameter file.

        `.save(path)` writes it, `--parameters` takes it. A gait gets its own numbers where they
        differ; numbers not identified keep their values in the measurements.

        Args:
            name: Name of the parameters in files and stored trials.
            title: Text for legends.

        Raises:
            ValueError: If the measurements were not made in water, or a parameter file cannot hold
                an identified value.
        """
        check_parameter_file_holds(self.problem)
        return as_parameters(self.problem, self.values, name, title)


def _row_of_estimate(estimate: ParameterEstimate) -> dict[str, Any]:
    low, high = estimate.interval or (None, None)
    return {
        "name": estimate.name,
        "value": estimate.value if estimate.is_identified else None,
        "sigma": estimate.sigma,
        "low": low,
        "high": high,
        "unit": estimate.unit,
        "note": estimate.note,
    }
