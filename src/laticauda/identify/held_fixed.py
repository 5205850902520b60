"""Numbers that a fit held fixed although they are not known, and how the fitted ones would follow them.

A coefficient that was neither fitted nor stated by the user has the textbook's value, with an
interval. Had it another value in the fit, the fitted numbers would be others, too. One Gauss-Newton
step from the end of the fit tells them: with J the Jacobian of all residuals with respect to the
fitted coordinates x, and J_z that with respect to the numbers z held fixed,

    dx/dz = -(J^T J)^-1 J^T J_z.

Whoever varies z in a prediction must let x follow: what z does to the measured trials, x makes up
for.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from laticauda.identify.information import invert_information
from laticauda.identify.problem import Problem
from laticauda.identify.resolving import list_numbers
from laticauda.identify.unknowns import ResolvedUnknown
from laticauda.models.simulate import Parameter, intervals_of, value_of
from laticauda.values import BadArgument


@dataclass(frozen=True, kw_only=True)
class HeldNumber:
    """A number that was held fixed, and where it may lie."""

    name: str
    """Dotted name."""
    value: float
    """Value in the fit."""
    low: float
    """Smallest value that it may have."""
    high: float
    """Largest value that it may have."""

    @property
    def sigma(self) -> float:
        """Standard deviation of a number that lies anywhere in the interval with the same probability."""
        return (self.high - self.low) / math.sqrt(12.0)

    @property
    def offset(self) -> float:
        """How far the middle of the interval is from the value in the fit."""
        return 0.5 * (self.low + self.high) - self.value


def list_held_numbers(problem: Problem) -> tuple[HeldNumber, ...]:
    """Return the numbers that have the textbook's value in all measurements, and were not fitted.

    Args:
        problem: Measurements and unknowns.
    """
    fitted = {unknown.parameter.name for unknown in problem.unknowns}
    for unknown in problem.unknowns:
        fitted |= unknown.tied.keys()
    intervals_of_each: list[dict[str, tuple[float, float]]] = []
    for scenario in problem.scenarios:
        try:
            intervals_of_each.append(dict(intervals_of(scenario)))
        except BadArgument:  # the water is not the textbook's: its numbers were stated
            return ()
    first = intervals_of_each[0]
    numbers = list_values(problem, first.keys() - fitted)
    held_numbers: list[HeldNumber] = []
    for name, (low, high) in first.items():
        if name in fitted or any(own.get(name) != first[name] for own in intervals_of_each):
            continue
        held_numbers.append(HeldNumber(name=name, value=numbers[name], low=low, high=high))
    return tuple(held_numbers)


def list_values(problem: Problem, names: Iterable[str]) -> dict[str, float]:
    """Return the values of numbers in the first measurement, by name.

    Args:
        problem: Measurements and unknowns.
        names: Dotted names.
    """
    return {name: value_of(name, problem.scenarios[0]) for name in names}


def with_numbers(problem: Problem, held_numbers: Sequence[HeldNumber]) -> Problem:
    """Return a problem in which numbers that were held fixed are the last unknowns, on a linear scale.

    Args:
        problem: Measurements and unknowns.
        held_numbers: Numbers that were held fixed.
    """
    numbers = list_numbers(problem.scenarios)
    added = [unknown_of(numbers[0][number.name], number.value) for number in held_numbers]
    depends_on = np.zeros((len(numbers), len(held_numbers)), dtype=bool)
    for j, number in enumerate(held_numbers):
        depends_on[:, j] = [number.name in own for own in numbers]
    return replace(
        problem,
        unknowns=(*problem.unknowns, *added),
        depends_on=np.hstack([problem.depends_on, depends_on]),
    )


def unknown_of(parameter: Parameter, value: float) -> ResolvedUnknown:
    """Return an unknown on a linear scale, for derivatives.

    Args:
        parameter: Its parameter.
        value: Its value.
    """
    return ResolvedUnknown(
        name=parameter.name, parameter=parameter, start=value, is_log=False, size=1.0
    )


def follow_held_numbers(
    jacobian: Float[np.ndarray, "n_residuals n_unknowns"],
    jacobian_of_held: Float[np.ndarray, "n_residuals n_held"],
    sizes: Float[np.ndarray, " n_unknowns"],
) -> Float[np.ndarray, "n_unknowns n_held"]:
    """Return by how much the fitted coordinates follow numbers that are held fixed.

    Args:
        jacobian: Derivatives of all residuals, those of the priors included, with respect to the
            coordinates of the unknowns.
        jacobian_of_held: Those with respect to the numbers held fixed; 0 for priors.
        sizes: Large changes of the coordinates, in whose units the step is computed.
    """
    scaled = jacobian * sizes
    covariance = invert_information(scaled.T @ scaled)
    return -sizes[:, np.newaxis] * (covariance @ (scaled.T @ jacobian_of_held))
