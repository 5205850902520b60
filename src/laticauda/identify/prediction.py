"""Speed, power and path of a gait that was not measured, with one interval, from a fit.

A figure v is predicted on the scale of its logarithm, so that errors are relative. Three errors are
independent of each other, and their variances add:

    coefficients   g C g^T, with g the derivative of ln v with respect to the fitted coordinates x,
                   and C their covariance;
    held fixed     sum of (d_j s_j)^2, with d = dz + g dx/dz the total derivative with respect to the
                   numbers z held fixed, dz their own effect, and dx/dz how the fit follows them
                   (`held_fixed`); s_j is the standard deviation of a number that lies anywhere in
                   its interval with the same probability;
    left out       the variance of what the model leaves out (`model_error`), as it was for gaits
                   that the fit did not see.

If a number held fixed was not in the middle of its interval, the middle of the prediction moves by
d_j times the difference.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from statistics import NormalDist
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.identify.dependence import find_dependence
from laticauda.identify.held_fixed import unknown_of
from laticauda.identify.measurements import Measurement
from laticauda.identify.model import Predicted, predict
from laticauda.identify.model_error import ModelError
from laticauda.identify.prediction_basis import GAIT_NUMBERS, PredictionBasis, Setting
from laticauda.identify.problem import Problem
from laticauda.identify.resolving import ScopedName, list_numbers
from laticauda.identify.unknowns import ResolvedUnknown
from laticauda.models.simulate import UNITS, Parameter, swim
from laticauda.scenarios import Scenario
from laticauda.values import BadArgument, check_whole_number

FIGURES = ("forward_velocity", "mean_power")
"""Figures that are predicted, as far as the run has them."""
_ENDS = ("x", "y", "heading")
"""Figures that say where the robot ends."""
_PATH = "center_of_mass"
_PATH_INTERVAL = 0.5
"""Time between two points of a path [s]."""
_UNITS_OF_GAIT = {"amplitude": "deg", "frequency": "deg/s", "phase_shift": "deg"}
"""Units in which people read the numbers of a gait."""
_BEYOND = 0.02
"""By which share of itself a gait's number may exceed the measured range without a remark [-]."""


@dataclass(frozen=True, kw_only=True)
class Shares:
    """What an interval is made of: standard deviations, relative or in the unit of the figure."""

    coefficients: float
    """From the errors of the fitted coefficients."""
    held_fixed: float
    """From the numbers that the fit held fixed."""
    left_out: float | None
    """From what the model leaves out; None: it is not known, and not in the interval."""

    @property
    def sigma(self) -> float:
        """Standard deviation of all of them together."""
        return math.hypot(self.coefficients, self.held_fixed, self.left_out or 0.0)


@dataclass(frozen=True, kw_only=True)
class PredictedFigure:
    """A figure of a run, with its interval."""

    unit: str
    """Unit."""
    value: float
    """Value of the model with the fitted coefficients."""
    low: float
    """Lower end of the interval."""
    high: float
    """Upper end of the interval."""
    shares: Shares
    """What the interval is made of; relative to the value for speeds and powers."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PredictedPath:
    """The path of a run, and how uncertain it is."""

    time: Float[np.ndarray, " n_samples"]
    """Times [s]."""
    center_of_mass: Float[np.ndarray, "n_samples 2"]
    """Positions [m]."""
    half_width: Float[np.ndarray, "n_samples 2"]
    """Half of the width of their intervals [m]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Prediction:
    """What a robot will do, with an interval for each figure."""

    scenario: Scenario
    """The run, with the fitted coefficients."""
    confidence: float
    """Confidence of the intervals [-]."""
    quantile: float
    """Half of an interval in standard deviations [-]."""
    figures: Mapping[str, PredictedFigure]
    """Speed and power by name of the figure, and where the robot ends: x, y, heading."""
    path: PredictedPath
    """The path."""
    notes: tuple[str, ...]
    """What should be known about the intervals, in sentences."""


class _Derivatives(NamedTuple):
    """Values of a prediction, and their derivatives."""

    value: np.ndarray
    fitted: np.ndarray
    """With respect to the coordinates of the fitted numbers, in the last axis."""
    held_numbers: np.ndarray
    """With respect to the numbers held fixed, in the last axis."""


def predict_scenario(
    basis: PredictionBasis, scenario: Scenario, *, threads: int | None = None
) -> Prediction:
    """Predict a run with intervals.

    Args:
        basis: What a fit left behind.
        scenario: The run, of a robot in water with the fitted values (see `Fit.robot` and
            `Fit.water`).
        threads: Number of threads.

    Raises:
        ValueError: If the fit does not determine what the run depends on.
        SimulationFailed: If the run blows up.

    Example:
        >>> from laticauda.identify import basis_of, fit, from_table1
        >>> rows = from_table1()[::4]
        >>> found = fit(rows, parameters=["water.tangential_friction"], n_starts=1)
        >>> basis = basis_of(found)
        >>> run = found.problem.scenarios_at(found.best)[0]
        >>> speed = predict_scenario(basis, run).figures["forward_velocity"]
        >>> speed.low < speed.value < speed.high
        True
    """
    if threads is not None:
        check_whole_number("threads", threads, 1)
    swim(scenario, throw=True)
    problem = _problem_of(basis, scenario, threads)
    values = np.array([unknown.start for unknown in problem.unknowns])
    predicted = predict(problem, values)
    derivatives = _take_derivatives(basis, problem, predicted)
    _check_is_determined(basis, derivatives.fitted)
    quantile = NormalDist().inv_cdf(0.5 * (1.0 + basis.confidence))
    numbers = {block.name: block.numbers for block in problem.data_blocks}
    figures: dict[str, PredictedFigure] = {}
    for name in FIGURES:
        part = _part(derivatives, numbers[name].start)
        if math.isfinite(part.value) and part.value > 0.0:
            figures[name] = _relative_figure(basis, scenario, name, part, quantile)
    speed = figures.get(FIGURES[0])
    left_out = None
    if speed is not None:
        left_out = speed.shares.left_out
    for name in _ENDS:
        part = _part(derivatives, numbers[name].start)
        figures[name] = _absolute_figure(basis, name, part, left_out, quantile)
    return Prediction(
        scenario=scenario,
        confidence=basis.confidence,
        quantile=quantile,
        figures=figures,
        path=_path_of(basis, problem, derivatives, left_out, quantile),
        notes=_list_notes(basis, scenario),
    )


def _problem_of(basis: PredictionBasis, scenario: Scenario, threads: int | None) -> Problem:
    """Return the run as a measurement of everything that is predicted, with all numbers as unknowns."""
    n_samples = max(2, round(scenario.duration / _PATH_INTERVAL) + 1)
    time = np.linspace(0.0, scenario.duration, n_samples)
    measurement = Measurement(
        name="prediction",
        scenario=scenario,
        figures={name: (1.0, 1.0) for name in (*FIGURES, *_ENDS)},
        time=time,
        series={_PATH: (np.zeros((n_samples, 2)), 1.0)},
    )
    (numbers,) = list_numbers([scenario])
    scoped_names = [ScopedName(number.scope, number.name) for number in basis.fitted]
    scoped_names += [ScopedName("", number.name) for number in basis.held_numbers]
    depends_on = find_dependence(scoped_names, [{scenario.gait.kind}], [numbers])
    unknowns: list[ResolvedUnknown] = []
    for number in (*basis.fitted, *basis.held_numbers):
        absent = Parameter(name=number.name, unit="", title="")
        unknowns.append(unknown_of(numbers.get(number.name, absent), number.value))
    for k, number in enumerate(basis.fitted):
        unknowns[k] = replace(unknowns[k], tied=number.tied)
    return Problem(
        measurements=(measurement,),
        unknowns=tuple(unknowns),
        depends_on=depends_on,
        threads=threads,
    )


def _take_derivatives(
    basis: PredictionBasis, problem: Problem, predicted: Predicted
) -> _Derivatives:
    slopes: list[float] = []
    for number in basis.fitted:
        slope = 1.0
        if number.is_log:
            slope = number.value
        slopes.append(slope)
    n_fitted = len(basis.fitted)
    jacobian = predicted.jacobian
    return _Derivatives(
        value=predicted.values,
        fitted=jacobian[:, :n_fitted] * np.array(slopes),
        held_numbers=jacobian[:, n_fitted:],
    )


def _part(derivatives: _Derivatives, index: int | slice) -> _Derivatives:
    return _Derivatives(*(array[index] for array in derivatives))


def _check_is_determined(
    basis: PredictionBasis, derivatives: Float[np.ndarray, "n_data n_fitted"]
) -> None:
    """Reject a run that depends on a number of which the measurements say nothing."""
    matters = np.any(derivatives != 0.0, axis=0)
    is_open = ~np.isfinite(np.diag(basis.covariance))
    for k in np.flatnonzero(matters & is_open):
        rule = "must determine all that the run depends on"
        hint = "give it a prior in the identification"
        raise BadArgument("fit", f"{rule}; it says nothing of `{basis.fitted[k].name}`; {hint}")


def _covariance(basis: PredictionBasis) -> np.ndarray:
    """Return the covariance; what is open has no effect here, see `_check_is_determined`."""
    return np.where(np.isfinite(basis.covariance), basis.covariance, 0.0)


class _Spread(NamedTuple):
    """Standard deviations of the first two shares, and how far the middle moves."""

    coefficients: np.ndarray
    held_fixed: np.ndarray
    shift: np.ndarray


def _spread_of(basis: PredictionBasis, derivatives: _Derivatives) -> _Spread:
    """Return what the fit and the numbers held fixed do to a prediction, in its unit."""
    fitted = derivatives.fitted
    variance = np.sum((fitted @ _covariance(basis)) * fitted, axis=-1)
    total = derivatives.held_numbers + fitted @ basis.following
    sigmas = np.array([number.sigma for number in basis.held_numbers])
    offsets = np.array([number.offset for number in basis.held_numbers])
    return _Spread(
        coefficients=np.sqrt(np.maximum(variance, 0.0)),
        held_fixed=np.sqrt(np.sum((total * sigmas) ** 2, axis=-1)),
        shift=np.sum(total * offsets, axis=-1),
    )


def _relative_figure(
    basis: PredictionBasis,
    scenario: Scenario,
    name: str,
    derivatives: _Derivatives,
    quantile: float,
) -> PredictedFigure:
    """Return a figure that is above 0, with the interval of its logarithm."""
    value = float(derivatives.value)
    relative = _Derivatives(
        derivatives.value, derivatives.fitted / value, derivatives.held_numbers / value
    )
    spread = _spread_of(basis, relative)
    shares = Shares(
        coefficients=float(spread.coefficients),
        held_fixed=float(spread.held_fixed),
        left_out=_model_error_for(basis, scenario, name),
    )
    middle = value * math.exp(float(spread.shift))
    factor = math.exp(quantile * shares.sigma)
    return PredictedFigure(
        unit=UNITS[name], value=value, low=middle / factor, high=middle * factor, shares=shares
    )


def _absolute_figure(
    basis: PredictionBasis,
    name: str,
    derivatives: _Derivatives,
    left_out: float | None,
    quantile: float,
) -> PredictedFigure:
    """Return where the robot ends, with an interval on both sides; the model's error is that of its speed."""
    value = float(derivatives.value)
    spread = _spread_of(basis, derivatives)
    own_left_out = None
    if left_out is not None and name != "heading":
        own_left_out = left_out * abs(value)
    shares = Shares(
        coefficients=float(spread.coefficients),
        held_fixed=float(spread.held_fixed),
        left_out=own_left_out,
    )
    middle = value + float(spread.shift)
    half_width = quantile * shares.sigma
    return PredictedFigure(
        unit=UNITS[name],
        value=value,
        low=middle - half_width,
        high=middle + half_width,
        shares=shares,
    )


def _path_of(
    basis: PredictionBasis,
    problem: Problem,
    derivatives: _Derivatives,
    left_out: float | None,
    quantile: float,
) -> PredictedPath:
    (measurement,) = problem.measurements
    assert measurement.time is not None
    block = problem.data_blocks[-1]
    part = _part(derivatives, block.numbers)
    spread = _spread_of(basis, part)
    of_model = (left_out or 0.0) * np.abs(part.value)
    sigma = np.sqrt(spread.coefficients**2 + spread.held_fixed**2 + of_model**2)
    return PredictedPath(
        time=measurement.time,
        center_of_mass=part.value.reshape(-1, 2),
        half_width=(quantile * sigma + np.abs(spread.shift)).reshape(-1, 2),
    )


# ---- what the model leaves out -------------------------------------------------------------------


def _model_error_for(basis: PredictionBasis, scenario: Scenario, figure: str) -> float | None:
    """Return the standard deviation of what the model leaves out of a figure; None: not known.

    A kind of gait that was measured is off like single measurements; another one like whole groups,
    as far as these were left out.
    """
    errors = basis.left_out.get(figure)
    if errors is None:
        return None
    sizes = [errors.by_measurement.size]
    if Setting.of(scenario.robot, scenario.gait) not in basis.settings:
        sizes.append(_size_of(errors.by_group))
    known_sizes = [size for size in sizes if size is not None]
    return max(known_sizes, default=None)


def _size_of(error: ModelError | None) -> float | None:
    if error is None:
        return None
    return error.size


def _list_notes(basis: PredictionBasis, scenario: Scenario) -> tuple[str, ...]:
    """Return what should be known about the intervals."""
    notes: list[str] = []
    gait = scenario.gait
    if Setting.of(scenario.robot, gait) not in basis.settings:
        with_or_without = "without"
        if scenario.robot.caudal_fin is not None:
            with_or_without = "with"
        notes.append(
            f"No trial was of {gait.words} {with_or_without} fin: the model may leave out more than is said."
        )
    for name in GAIT_NUMBERS:
        low, high = basis.ranges[name]
        value = float(getattr(gait, name))
        if not low - _BEYOND * abs(low) <= value <= high + _BEYOND * abs(high):
            phrase = name.replace("_", " ")
            measured = f"{math.degrees(low):.4g} to {math.degrees(high):.4g}"
            notes.append(
                f"The {phrase} of {math.degrees(value):.4g} {_UNITS_OF_GAIT[name]} is beyond the measured {measured}: "
                "the model may leave out more than is said."
            )
    return (*notes, *basis.assumed)
