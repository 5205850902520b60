"""One search of the least sum of squares, from one start, by scipy's trust-region method."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from laticauda.identify.method import cost_of, loss_for_search
from laticauda.identify.model import Predicted, predict, scaled_jacobian
from laticauda.identify.problem import Problem
from laticauda.models.simulate import silent
from laticauda.values import SimulationFailed, optional_import

MOST_STEPS = 100
"""Predictions after which a search ends without having converged."""
_TOLERANCE = 1e-10
"""Relative change of cost, coordinates and gradient at which a search has converged [-]."""
_SHORTEST_START = 1e-3
"""Length of starting coordinates from which scipy's first step is not negligible, in sizes [-]."""
_NEAR = 0.01
"""A search ends at the end of an earlier one if it is closer than this, in large changes [-]."""
_SAME_COST = 1e-3
"""Largest difference of the sums of squares of two searches with the same minimum [-]."""
_SAME_RELATIVE_COST = 1e-3
"""The same relative to a sum of squares, of which `_SAME_COST` is taken: for very bad fits [-]."""
_SEEN = 1e-6
"""Directions that the residuals show less than this share of the clearest are not seen [-]."""

Vector = Float[np.ndarray, " n"]
Enough = Callable[[float, float], bool]
"""Tells whether a search need not go on.

It is called with the sum of squares, and with what one more step would leave if the model were linear.
"""


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
    """Jacobian J of the residuals at the end with respect to the free coordinates.

    The rows of the priors come last. With a robust loss, scipy scales every row by the root of the
    loss's curvature at its residual, so that J^T J is the curvature of half the cost there, as it
    is for squares (see `laticauda.identify.method`).
    """
    converged: bool
    """Whether it converged."""


class _ArrivedAtKnownEnd(Exception):
    """Raised when a search arrives where an earlier one ended, so that it need not go on."""

    def __init__(self, earlier: LocalSearch) -> None:
        """Create it with the earlier search."""
        super().__init__()
        self.earlier = earlier


class _IsEnough(Exception):
    """Raised when a search need not go on."""

    def __init__(self, search: LocalSearch) -> None:
        """Create it with the search as far as it came."""
        super().__init__()
        self.search = search


@dataclass(frozen=True, kw_only=True, eq=False)
class _Evaluation:
    """Model and cost at one point of a search."""

    coordinates: Float[np.ndarray, " n_unknowns"]
    """All coordinates."""
    values: Float[np.ndarray, " n_unknowns"]
    """Values of the unknowns."""
    predicted: Predicted
    """Predictions of the model."""
    residuals: Float[np.ndarray, " n_residuals"]
    """Residuals of data and priors, in standard deviations."""
    cost: float
    """Sum of squares."""

    @property
    def failures(self) -> str:
        """Why measurements could not be simulated."""
        failures = self.predicted.failures.items()
        return (
            "; ".join(f"`{name}`: {status}" for name, status in failures) or "a figure is missing"
        )


@dataclass(kw_only=True, eq=False)
class _Objective:
    """The two functions that scipy calls: residuals, and their Jacobian.

    Scipy asks for the Jacobian at the point whose residuals it has asked for last. The planar model
    computes a Jacobian from the runs of that prediction, so the last evaluation is kept.
    """

    problem: Problem
    start: Vector
    loss: str
    factor: float
    free: Int[np.ndarray, " n_free"]
    observe: Callable[[Vector, float], None]
    earlier_searches: Sequence[LocalSearch]
    enough: Enough | None = None
    last: _Evaluation | None = None

    def all_coordinates(self, free_coordinates: np.ndarray) -> Vector:
        """Return all coordinates: the free ones as given, all others as at the start."""
        coordinates = self.start.copy()
        coordinates[self.free] = free_coordinates
        return coordinates

    def residuals(self, free_coordinates: np.ndarray) -> np.ndarray:
        """Return the residuals of data and priors.

        Raises:
            SimulationFailed: If there are none where the search begins; elsewhere, it turns back.
        """
        is_first = self.last is None
        self.last = self._evaluate(free_coordinates)
        if is_first and not math.isfinite(self.last.cost):
            raise SimulationFailed(
                f"The measurements cannot be simulated where a search begins: {self.last.failures}."
            )
        self.observe(self.last.coordinates, self.last.cost)
        return self.last.residuals

    def jacobian(self, free_coordinates: np.ndarray) -> np.ndarray:
        """Return the Jacobian of the residuals with respect to the free coordinates."""
        evaluation = self._evaluation_at(free_coordinates)
        self._stop_at_known_end(evaluation)
        values = evaluation.values
        of_data = scaled_jacobian(self.problem, values, self.factor, evaluation.predicted)
        of_priors = self.problem.prior_slopes(values)
        jacobian = np.concatenate([of_data, of_priors])[:, self.free]
        self._stop_if_enough(evaluation, jacobian)
        return jacobian

    def _evaluation_at(self, free_coordinates: np.ndarray) -> _Evaluation:
        coordinates = self.all_coordinates(free_coordinates)
        if self.last is not None and np.array_equal(self.last.coordinates, coordinates):
            return self.last
        return self._evaluate(free_coordinates)

    def _evaluate(self, free_coordinates: np.ndarray) -> _Evaluation:
        coordinates = self.all_coordinates(free_coordinates)
        values = self.problem.values_of(coordinates)
        predicted = predict(self.problem, values)
        residuals = all_residuals(self.problem, values, self.factor, predicted)
        return _Evaluation(
            coordinates=coordinates,
            values=values,
            predicted=predicted,
            residuals=residuals,
            cost=cost_of(residuals, self.loss, n_priors=self.problem.n_priors),
        )

    def _stop_if_enough(self, evaluation: _Evaluation, jacobian: np.ndarray) -> None:
        """Raise if the search need not go on."""
        if self.enough is None or not np.all(np.isfinite(jacobian)):
            return
        in_sizes = jacobian * self.problem.sizes[self.free]
        step, *_ = np.linalg.lstsq(in_sizes, -evaluation.residuals, rcond=_SEEN)
        left = evaluation.residuals + in_sizes @ step
        if self.enough(evaluation.cost, float(np.sum(left**2))):
            search = LocalSearch(
                start=self.start,
                end=evaluation.coordinates,
                cost=evaluation.cost,
                jacobian=jacobian,
                converged=False,
            )
            raise _IsEnough(search)

    def _stop_at_known_end(self, evaluation: _Evaluation) -> None:
        """Raise if an earlier search ended close by, equally well."""
        for search in self.earlier_searches:
            distance = np.abs(evaluation.coordinates - search.end)
            is_near = np.all(distance <= _NEAR * self.problem.sizes)
            if is_near and have_same_cost(evaluation.cost, search.cost):
                raise _ArrivedAtKnownEnd(search)


def minimize(
    problem: Problem,
    x: Vector,
    *,
    loss: str,
    factor: float = 1.0,
    free: Int[np.ndarray, " n_free"] | None = None,
    most_steps: int = MOST_STEPS,
    observe: Callable[[Vector, float], None] = silent,
    earlier_searches: Sequence[LocalSearch] = (),
    enough: Enough | None = None,
) -> LocalSearch:
    """Run one search.

    Args:
        problem: Measurements and unknowns.
        x: Starting coordinates.
        loss: Loss function of the residuals.
        factor: Factor applied to the stated noise.
        free: Indices of the unknowns that may change; None: all.
        most_steps: Predictions after which the search ends without having converged.
        observe: Called with all coordinates and the sum of squares at every step.
        earlier_searches: A search that comes close to the end of one of them, equally good, ends
            there.
        enough: Tells whether it may end before it has converged; for squares alone.

    Returns:
        The finished search, with all coordinates and the Jacobian with respect to the free ones.

    Raises:
        SimulationFailed: If the measurements cannot be simulated at the start.
        MissingExtra: If scipy is not installed.
    """
    optimize = optional_import("Identification", "scipy", "identify", "scipy.optimize")
    if free is None:
        free = np.arange(x.size)
    objective = _Objective(
        problem=problem,
        start=x,
        loss=loss,
        factor=factor,
        free=free,
        observe=observe,
        earlier_searches=earlier_searches,
        enough=enough,
    )
    ends = np.array([unknown.ends for unknown in problem.unknowns])
    lower, upper = ends[free].T
    try:
        solution = optimize.least_squares(
            objective.residuals,
            _start_of_search(x[free], lower, upper, problem.sizes[free]),
            jac=objective.jacobian,
            bounds=(lower, upper),
            x_scale=problem.sizes[free],
            loss=loss_for_search(loss, problem.n_priors),
            method="trf",
            xtol=_TOLERANCE,
            ftol=_TOLERANCE,
            gtol=_TOLERANCE,
            max_nfev=most_steps,
        )
    except _ArrivedAtKnownEnd as arrival:
        return replace(arrival.earlier, start=x)
    except _IsEnough as enough_is_known:
        return enough_is_known.search
    return LocalSearch(
        start=x,
        end=objective.all_coordinates(solution.x),
        cost=2.0 * float(solution.cost),
        jacobian=np.asarray(solution.jac),
        converged=solution.status > 0,
    )


def _start_of_search(x: Vector, lower: Vector, upper: Vector, sizes: Vector) -> Vector:
    """Return starting coordinates inside the range from which a search can leave.

    Scipy does not ask how long the first step may be. It takes the length of the vector of starting
    coordinates, in sizes; 1 for one of length 0, which is exact only if 0 is not at an end of a
    range, from which scipy moves every start a little inside. A start that is almost 0 thus allows
    only steps so short that they change the cost by less than the tolerance, and the search would
    stop where it began. Such a start is moved: to exactly 0, or, where 0 is not well inside the
    range, to the nearest coordinate that is.
    """
    start = np.clip(x, lower, upper)
    longest_first_step = np.linalg.norm(start / sizes)
    if longest_first_step >= _SHORTEST_START:
        return start
    margin = np.minimum(_SHORTEST_START * sizes, 0.5 * (upper - lower))
    zero = np.zeros(x.size)
    return np.clip(zero, lower + margin, upper - margin)


def all_residuals(
    problem: Problem,
    values: Float[np.ndarray, " n_unknowns"],
    factor: float = 1.0,
    predicted: Predicted | None = None,
) -> Float[np.ndarray, " n_residuals"]:
    """Return the residuals of the data and of the priors, in standard deviations.

    Args:
        problem: Measurements and unknowns.
        values: Values of the unknowns.
        factor: Factor applied to the stated noise.
        predicted: Prediction at these values, if already computed.
    """
    if predicted is None:
        predicted = predict(problem, values)
    of_data = (predicted.values - problem.observed) / (factor * problem.sigma)
    return np.concatenate([of_data, problem.prior_residuals(values)])


def have_same_cost(cost: float, reference: float) -> bool:
    """Check whether two searches have reached the same minimum, by their sums of squares.

    Args:
        cost: Sum of squares of one search.
        reference: Sum of squares of the search to which it is compared.
    """
    return abs(cost - reference) <= _SAME_COST * max(1.0, reference * _SAME_RELATIVE_COST)
