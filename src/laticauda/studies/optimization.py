"""Definition of an optimization: which numbers may change within which bounds, for which objectives and limits.

Also the evaluation of its points: their figures, and how far each is from being feasible.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

import laticauda as lc
from laticauda.models.simulate import (
    Run,
    change_parameters,
    compute_sensitivities,
    gradients,
    make_run_table,
    runs_of,
)
from laticauda.models.simulate.numbers import list_parameters
from laticauda.scenarios import Controller, OpenLoop
from laticauda.studies import sampling
from laticauda.studies.point_trials import (
    COSTS,
    QUANTITIES,
    Column,
    check_ranges,
    check_scenario,
    definition_of,
    swim_points,
    swum_figure,
)
from laticauda.studies.sampling import Table
from laticauda.trials.feasibility import ROUNDING
from laticauda.values import BadArgument, check_choice, option, quantity, value_class

OBJECTIVES = (
    "forward_velocity",
    "steady_velocity",
    "speed_through_water",
    "steady_speed_through_water",
    "mechanical_power",
    "mean_power",
    "cost_of_transport",
)
"""What can be optimized: speeds are maximized, powers and the cost of transport minimized."""
SPEED_POWER = ("forward_velocity", "mechanical_power")
"""The objectives, unless others are stated."""
VIOLATION = "violation"
"""Name of the column that says how far a point is from being feasible."""
FAILED = 1e3
"""Violation of a run that diverged: larger than that of any gait whose swing is too wide."""


def _check_objectives(name: str, objectives: str | Sequence[str]) -> tuple[str, ...]:
    """Return one or two different objectives."""
    names = (objectives,) if isinstance(objectives, str) else tuple(objectives)
    for objective in names:
        check_choice(name, objective, OBJECTIVES)
    if len(set(names)) != len(names) or len(names) not in (1, 2):
        raise BadArgument(
            name, f"must be one, or two different ones, got {', '.join(names) or 'none'}"
        )
    return names


@value_class
class Limits:
    """Limits that a point must respect, besides those of the joints, to be feasible."""

    joint_rate_limit: float | None = quantity(
        "rad/s", "Largest joint rate a gait may demand", gt=0.0, default=None
    )
    least_velocity: float | None = quantity(
        "m/s",
        "Smallest acceptable velocity, through the water if it moves; without it, the cheapest gait hardly moves",
        gt=0.0,
        default=None,
    )
    beyond_actuators: bool = option(
        "Allow gaits that overload actuators, or whose links overlap", default=False
    )


@value_class
class Optimization(Limits):
    """A scenario, those of its numbers that may change, and which figures are maximized or minimized.

    A point is feasible if the gait keeps every joint within its `limit` (and below
    `joint_rate_limit`), the run demands no more than joints and actuators provide and no links
    overlap (its `utilization` is at most 1), it reaches its end, it is fast enough for
    `least_velocity`, and every objective has a value.

    Where the water moves, `forward_velocity` and `steady_velocity` among the objectives become
    `speed_through_water` and `steady_speed_through_water`, and `least_velocity` is one through the
    water, too: the fastest gait over ground would be the one that drifts best.

    Raises:
        ValueError: If a field is out of its range, or a parameter does not exist (the message has
            the nearest names).

    Example:
        >>> import laticauda as lc
        >>> gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> optimization = Optimization(
        ...     scenario=lc.build_scenario("mamba", gait),
        ...     bounds={"gait.amplitude": (0.2, 0.9), "robot.n_links": (6, 12)},
        ... )
        >>> optimization.objectives
        ('forward_velocity', 'mechanical_power')
    """

    scenario: lc.Scenario = option("Scenario shared by all trials; of the planar model")
    bounds: Mapping[str, tuple[float, float]] = option(
        "Smallest and largest value by name of parameter, as for a sweep (SI, radians)",
        check=sampling.check_ranges_of_numbers,
    )
    objectives: Sequence[str] = option(
        "One of `OBJECTIVES`, two for a front; where the water moves, speeds become those through it",
        default=SPEED_POWER,
        check=_check_objectives,
    )

    def __post_init__(self) -> None:
        """Check the fields against each other."""
        check_scenario(self.scenario)
        check_ranges(self.scenario, self.bounds, "bounds")
        objectives = [swum_figure(name, self.scenario, self.bounds) for name in self.objectives]
        object.__setattr__(self, "objectives", _check_objectives("objectives", objectives))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters that may change."""
        return tuple(self.bounds)

    def definition(self) -> dict[str, Any]:
        """Return everything that the trials depend on, for a file."""
        return {
            **definition_of(self.scenario),
            "bounds": {name: list(ends) for name, ends in self.bounds.items()},
            "objectives": list(self.objectives),
            **{name: getattr(self, name) for name in Limits.__dataclass_fields__},
        }

    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the bounds in the form for a search: each whole number has an interval of length one."""
        low, high = self._bound_arrays()
        half_interval = np.where(self._is_whole, 0.5, 0.0)
        return low - half_interval, high + half_interval

    def points(self, searched: Table) -> Table:
        """Convert the points of a search: parameters that take whole numbers only are rounded.

        Args:
            searched: Points in the `box`.
        """
        low, high = self._bound_arrays()
        rounded = np.rint(searched)
        whole = np.clip(rounded, low, high)
        return np.where(self._is_whole, whole, searched)

    def _bound_arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the smallest and the largest value of every parameter."""
        bounds = np.array([*self.bounds.values()], dtype=float)
        low, high = bounds.T
        return low, high

    @property
    def takes_whole_numbers(self) -> bool:
        """Whether some parameter takes whole numbers only."""
        return bool(np.any(self._is_whole))

    @property
    def _is_whole(self) -> np.ndarray:
        """Whether each parameter takes whole numbers only."""
        parameters = list_parameters(self.scenario)
        return np.array([parameters[name].is_whole for name in self.names])


def evaluate(
    optimization: Optimization,
    table: Table,
    threads: int | None = None,
    client: Any = None,
) -> dict[str, Column]:
    """Evaluate points; those beyond the limits are not simulated.

    Args:
        optimization: The optimization.
        table: The points, one per row.
        threads: Number of threads; None uses all cores available to this process.
        client: A `dask.distributed.Client` whose cluster simulates; None does so in this process.

    Returns:
        By name, one value per point: every quantity of a sweep, nan where there is none, and
        `violation`: 0 for feasible points, otherwise how far they are from being feasible,
        relative to the limit.
    """
    scenario = optimization.scenario
    names = optimization.names
    violation = _excess_of_gaits(scenario, names, table, optimization.joint_rate_limit)
    swims = violation == 0.0
    results: dict[str, Column] = {}
    for name in QUANTITIES:
        results[name] = np.full(len(table), np.nan)
    results["succeeded"] = np.zeros(len(table), dtype=bool)
    if swims.any():
        figures = _swim(optimization, table[swims], threads, client)
        for name, values in figures.items():
            results[name][swims] = values
    if not optimization.beyond_actuators:
        excess = results["utilization"] - 1.0
        violation = np.where(swims & (excess > ROUNDING), excess, violation)
    if optimization.least_velocity is not None:
        speed = swum_figure("forward_velocity", scenario, names)
        shortfall = 1.0 - results[speed] / optimization.least_velocity
        is_slow = swims & (shortfall > 0.0)
        violation = np.where(is_slow, np.maximum(shortfall, violation), violation)
    has_values = np.full(len(table), True)
    for name in optimization.objectives:
        has_values &= np.isfinite(results[name])
    results[VIOLATION] = np.where(swims & ~has_values, FAILED, violation)
    return results


def _swim(
    optimization: Optimization,
    table: Table,
    threads: int | None,
    client: Any,
) -> dict[str, Column]:
    """Simulate points, here or on a cluster."""
    scenario = optimization.scenario
    names = optimization.names
    if client is None:
        return swim_points(scenario, names, table, threads)
    from laticauda.studies.remote_points import swim_points_on

    return swim_points_on(client, scenario, names, table)


def has_slopes(optimization: Optimization) -> bool:
    """Return whether the search is to use the slopes of its objective: of one, to more than ten numbers.

    They are computed backward in time then, see `laticauda.models.simulate.gradients`.

    Args:
        optimization: The optimization.
    """
    scenario = optimization.scenario
    if len(optimization.objectives) > 1 or optimization.takes_whole_numbers:
        return False
    motion = scenario.motion
    is_steered = isinstance(motion, Controller) and not isinstance(motion, OpenLoop)
    if is_steered:
        return False
    (run,) = runs_of([scenario])
    n_numbers = len(optimization.names)
    return gradients.is_cheaper([run.plant], n_figures=1, n_numbers=n_numbers)


def compute_slope(
    optimization: Optimization, point: np.ndarray, threads: int | None = None
) -> np.ndarray | None:
    """Return the derivatives of the only objective, as a loss, at a point; None if it has none there.

    Args:
        optimization: The optimization.
        point: Values of its parameters.
        threads: Number of threads; None uses all cores available to this process.
    """
    numbers = dict(zip(optimization.names, point.tolist(), strict=True))
    (objective,) = optimization.objectives
    scenario = change_parameters(optimization.scenario, numbers)
    sensitivities = compute_sensitivities(
        [scenario],
        names=optimization.names,
        figures=[objective],
        threads=threads,
    )
    slope = sensitivities.jacobian[0, 0]
    is_known = np.isfinite(slope)
    if not np.all(is_known):
        return None
    return _sign_of_loss(objective) * slope


def _sign_of_loss(objective: str) -> float:
    """Return 1 for a figure that is to be small, -1 for one that is to be large."""
    return 1.0 if objective in COSTS else -1.0


def compute_losses(names: Sequence[str], results: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the objectives as losses, of which the smallest is best, one per column; 0 where there is none.

    Args:
        names: Names of the objectives.
        results: Values by name.
    """
    columns = [_sign_of_loss(name) * results[name] for name in names]
    return np.nan_to_num(np.stack(columns, axis=1), nan=0.0)


def _excess_of_gaits(
    scenario: lc.Scenario,
    names: tuple[str, ...],
    table: Table,
    joint_rate_limit: float | None,
) -> Column:
    """Return how far the gait of every point exceeds the limits of the joints, relative to them."""
    columns = dict(zip(names, table.T, strict=True))
    runs = make_run_table(scenario, columns)
    excess = np.zeros(len(table))
    for index, base in enumerate(runs.bases):
        of_base = runs.base_of == index
        waves = runs.waves[:, of_base]
        excess[of_base] = _excess_of_waves(
            base,
            amplitude=waves[0],
            frequency=waves[1],
            offset=waves[3],
            joint_rate_limit=joint_rate_limit,
        )
    return excess


def _excess_of_waves(
    base: Run,
    *,
    amplitude: Column,
    frequency: Column,
    offset: Column,
    joint_rate_limit: float | None,
) -> Column:
    """Return how far gaits exceed the limits of the joints of one robot, relative to them."""
    robot = base.plant.robot
    gait = base.command.gait
    envelope = gait.joint_envelope(robot.n_links)
    limits = [joint.limit for joint in robot.joints]
    swing = np.outer(amplitude, np.abs(envelope))
    largest_offset = np.abs(offset)
    largest_angle = swing + largest_offset[:, np.newaxis]
    shares = largest_angle / np.array(limits)
    if joint_rate_limit is not None:
        rates = swing * frequency[:, np.newaxis]
        share_of_rate = rates / joint_rate_limit
        shares = np.maximum(shares, share_of_rate)
    largest_share = np.max(shares, axis=1, initial=0.0)
    return np.maximum(largest_share - 1.0, 0.0)
