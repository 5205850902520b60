"""What a design depends on near a point: slopes of its objective and of all its limits.

The objective and the battery have slopes backward in time (`laticauda.models.simulate.gradients`). Peaks
of joints have none, and are differentiated by one further trial for each number. Limits of the body are
differentiated without any trial.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.models.simulate import (
    change_parameters,
    compute_sensitivities,
    run_joint_shares,
)
from laticauda.studies.design_limits import BodyNumbers, battery_share, limits_of_body
from laticauda.studies.optimization import (
    Optimization,
    Swum,
    find_bodies,
    sign_of_loss,
    speed_of_range,
)
from laticauda.studies.point_trials import swum_figure
from laticauda.studies.sampling import Table

STEP_OF_PEAKS = 1e-6
"""Step of differences of peaks, as a share of a number's range [-]."""
STEP_OF_BODIES = 1e-5
"""Step of differences of limits of the body, which are products of numbers, likewise [-]."""
N_WINDOWS = 16
"""Windows of time whose peaks are limited each by itself: which peak is the largest of all may change suddenly."""
LEAST_SHARE = 0.5
"""Share of what a joint may use below which it does not limit the next steps [-]."""
COST_OF_FIGURE = 9
"""Slopes of one figure to all numbers, in trials: 6.2 to 8.3 were measured side by side, 14 in small batches [-]."""
MEAN_POWER = "mean_power"

Point = Float[np.ndarray, " n_names"]


@dataclass(frozen=True, kw_only=True, eq=False)
class LocalModel:
    """Loss and limits near a point, to first order."""

    slope: Point
    """Derivatives of the loss."""
    excess: Float[np.ndarray, " n_limits"]
    """By how much every limit is exceeded, as a share of it; negative if it is not [-]."""
    excess_slopes: Float[np.ndarray, "n_limits n_names"]
    """Derivatives of the excess."""
    n_exact: int
    """How many of the limits, the last ones, are about the body alone and can be found without a trial."""


def count_trials(optimization: Optimization) -> int:
    """Return how many trials a local model costs.

    Args:
        optimization: The optimization.
    """
    n_trials = COST_OF_FIGURE * len(_figures_with_slopes(optimization))
    if not optimization.beyond_actuators:
        n_trials += 1 + len(optimization.names)
    return n_trials


def compute_local_model(
    optimization: Optimization, point: Point, threads: int | None = None
) -> LocalModel | None:
    """Return what a design depends on near a point; None if the run there has no figures.

    Args:
        optimization: The optimization; `has_slopes` holds for it.
        point: Values of its parameters.
        threads: Number of threads; None uses all cores available to this process.
    """
    figures = _figures_with_slopes(optimization)
    swim = _differentiate_swim(optimization, point, figures, threads)
    if swim is None:
        return None
    (objective,) = optimization.objectives
    body_limits = _limit_body(optimization, point)
    limits = (
        _limit_speed(optimization, swim),
        _limit_battery(optimization, point, swim),
        _limit_joints(optimization, point, threads),
        body_limits,
    )
    return LocalModel(
        slope=sign_of_loss(objective) * swim.find(objective).slope,
        excess=np.concatenate([limit.values for limit in limits]),
        excess_slopes=np.concatenate([limit.jacobian for limit in limits]),
        n_exact=body_limits.values.size,
    )


class _Differentiated(NamedTuple):
    """Some values and their derivatives with respect to all numbers."""

    values: Float[np.ndarray, " n_values"]
    jacobian: Float[np.ndarray, "n_values n_names"]


class _Figure(NamedTuple):
    """A figure of the swim, with its derivatives."""

    value: float
    slope: Point


class _Swim(NamedTuple):
    """Figures of the swim at a point, with their derivatives."""

    figures: list[str]
    values: Float[np.ndarray, " n_figures"]
    jacobian: Float[np.ndarray, "n_figures n_names"]

    def find(self, figure: str) -> _Figure:
        """Return a figure by its name."""
        i = self.figures.index(figure)
        return _Figure(float(self.values[i]), self.jacobian[i])


def _figures_with_slopes(optimization: Optimization) -> list[str]:
    """Return the figures on which the objective and the limits of the swim depend, each once."""
    figures = list(optimization.objectives)
    if optimization.battery is not None:
        figures.append(MEAN_POWER)
        if optimization.battery_range is not None:
            figures.append(speed_of_range(optimization.scenario))
    if optimization.least_velocity is not None:
        figures.append(_least_speed(optimization))
    return list(dict.fromkeys(figures))


def _least_speed(optimization: Optimization) -> str:
    """Return the figure of which `least_velocity` is the least."""
    return swum_figure("forward_velocity", optimization.scenario, optimization.names)


def _differentiate_swim(
    optimization: Optimization, point: Point, figures: list[str], threads: int | None
) -> _Swim | None:
    """Return figures at a point with their slopes; None if one is missing."""
    swum = optimization.to_swim(point[np.newaxis])
    numbers = dict(zip(swum.names, swum.table[0].tolist(), strict=True))
    sensitivities = compute_sensitivities(
        [change_parameters(optimization.scenario, numbers)],
        names=swum.names,
        figures=figures,
        threads=threads,
    )
    values = sensitivities.values[0]
    jacobian = sensitivities.jacobian[0]
    if not (np.all(np.isfinite(values)) and np.all(np.isfinite(jacobian))):
        return None
    if swum.names != optimization.names:
        jacobian = jacobian @ _differentiate_swum(optimization, point, swum)
    return _Swim(figures, values, jacobian)


def _differentiate_swum(
    optimization: Optimization, point: Point, swum: Swum
) -> Float[np.ndarray, "n_swum n_names"]:
    """Return the derivatives of the numbers with which a point swims: ballast follows the volume."""
    neighbors = _Neighbors.of(optimization, point)
    return neighbors.differentiate(optimization.to_swim(neighbors.points).table)


class _Neighbors(NamedTuple):
    """Points around one, for central differences."""

    points: Table
    """That point with every number in turn a step larger, then with every number a step smaller."""
    steps: Point
    """The steps of the numbers."""

    @classmethod
    def of(cls, optimization: Optimization, point: Point) -> "_Neighbors":
        """Return the neighbors of a point."""
        low, high = optimization.box()
        steps = STEP_OF_BODIES * (high - low)
        changes = np.diag(steps)
        return cls(np.concatenate((point + changes, point - changes)), steps)

    def differentiate(
        self, table: Float[np.ndarray, "n_points n_values"]
    ) -> Float[np.ndarray, "n_values n_names"]:
        """Return the derivatives of what a table holds for every neighbor."""
        after, before = np.split(table, 2)
        return ((after - before) / (2.0 * self.steps[:, np.newaxis])).T


def _limit_speed(optimization: Optimization, swim: _Swim) -> _Differentiated:
    """Return by how much the speed is below the least one."""
    least = optimization.least_velocity
    if least is None:
        return _no_limit(optimization)
    speed = swim.find(_least_speed(optimization))
    excess = np.array([1.0 - speed.value / least])
    return _Differentiated(excess, -speed.slope[np.newaxis] / least)


def _limit_battery(optimization: Optimization, point: Point, swim: _Swim) -> _Differentiated:
    """Return by how much the battery is too small."""
    if optimization.battery is None:
        return _no_limit(optimization)
    (body,) = find_bodies(optimization, point[np.newaxis])
    power = swim.find(MEAN_POWER)
    relative_slope = power.slope / (power.value + body.idle_power)
    speed_value = math.inf
    if optimization.battery_range is not None:
        speed = swim.find(speed_of_range(optimization.scenario))
        relative_slope = relative_slope - speed.slope / speed.value
        speed_value = speed.value
    share = battery_share(
        optimization, np.array([power.value]), np.array([speed_value]), np.array([body.idle_power])
    )
    assert share is not None
    return _Differentiated(share - 1.0, share[:, np.newaxis] * relative_slope)


def _limit_joints(optimization: Optimization, point: Point, threads: int | None) -> _Differentiated:
    """Return by how much every joint is beyond what it may use."""
    if optimization.beyond_actuators:
        return _no_limit(optimization)
    low, high = optimization.box()
    steps = STEP_OF_PEAKS * (high - low)
    neighbors = point + np.diag(steps)
    swum = optimization.to_swim(np.vstack((point, neighbors)))
    columns = dict(zip(swum.names, swum.table.T, strict=True))
    peaks = run_joint_shares(optimization.scenario, columns, n_windows=N_WINDOWS, threads=threads)
    shares = peaks.reshape(-1, peaks.shape[-1]) / optimization.servo_share
    is_near = shares[:, 0] > LEAST_SHARE
    at_point = shares[is_near, :1]
    at_neighbors = shares[is_near, 1:]
    slopes = (at_neighbors - at_point) / steps
    return _Differentiated(at_point[:, 0] - 1.0, slopes)


def _limit_body(optimization: Optimization, point: Point) -> _Differentiated:
    """Return by how much the limits of the body are exceeded."""
    if not optimization.limits_body:
        return _no_limit(optimization)
    neighbors = _Neighbors.of(optimization, point)
    bodies = find_bodies(optimization, np.vstack((point, neighbors.points)))
    shares = np.array([_all_shares(optimization, body) for body in bodies])
    return _Differentiated(shares[0] - 1.0, neighbors.differentiate(shares[1:]))


def _all_shares(optimization: Optimization, body: BodyNumbers) -> np.ndarray:
    """Return the shares of all limits of the body one after the other."""
    return np.concatenate(list(limits_of_body(optimization, body).values()))


class DesignProblem:
    """An optimization, as `LimitedSearch` asks about it.

    Args:
        optimization: The optimization; `can_have_slopes` holds for it.
        threads: Number of threads; None uses all cores available to this process.
    """

    def __init__(self, optimization: Optimization, threads: int | None) -> None:
        self._optimization = optimization
        self._threads = threads
        self.model_cost = count_trials(optimization)
        """Trials that one local model costs."""
        has_steps = optimization.length_step is not None
        self.is_stepped = optimization.is_length & has_steps
        """Whether each number is counted in steps."""

    def model_at(self, point: Point) -> LocalModel | None:
        """Return `compute_local_model` at a point.

        Args:
            point: The point.
        """
        return compute_local_model(self._optimization, point, self._threads)

    def exceed_exactly(self, point: Point) -> Float[np.ndarray, " n_exact"]:
        """Return by how much a point exceeds the limits of its body.

        Args:
            point: The point.
        """
        (body,) = find_bodies(self._optimization, point[np.newaxis])
        return _all_shares(self._optimization, body) - 1.0

    def round_steps(self, points: Table) -> Table:
        """Return points with lengths of modules in steps.

        Args:
            points: The points, one per row.
        """
        return self._optimization.in_length_steps(points)


def _no_limit(optimization: Optimization) -> _Differentiated:
    """Return what stands for a limit that does not count."""
    return _Differentiated(np.empty(0), np.empty((0, len(optimization.names))))
