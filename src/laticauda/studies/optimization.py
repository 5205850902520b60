"""Definition of an optimization: which numbers may change within which bounds, for which objectives and limits.

Also the evaluation of its points: their figures, and how far each is from being feasible.
"""

import math
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from typing import Any, NamedTuple

import numpy as np

import laticauda as lc
from laticauda.models.simulate import (
    Run,
    change_parameters,
    compute_sensitivities,
    gradients,
    make_run_table,
    runs_of,
    silent,
)
from laticauda.models.simulate.numbers import list_parameters
from laticauda.models.simulate.parameter_paths import strip_items
from laticauda.robot import Water
from laticauda.scenarios import Controller, OpenLoop, telling
from laticauda.studies import sampling
from laticauda.studies.design_limits import (
    END_OF_LIMIT,
    BodyNumbers,
    DesignLimits,
    ballasted_masses,
    battery_share,
    check_design_limits,
    largest_share,
    limits_of_body,
)
from laticauda.studies.point_trials import (
    COSTS,
    Column,
    check_ranges,
    check_scenario,
    definition_of,
    quantities_of,
    scenarios_at,
    swim_points,
    swum_figure,
)
from laticauda.studies.sampling import Table
from laticauda.trials import LOAD_FIGURES
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
    *LOAD_FIGURES,
)
"""What can be optimized: speeds are maximized, powers, the cost of transport and loads minimized."""
SPEED_POWER = ("forward_velocity", "mechanical_power")
"""The objectives, unless others are stated."""
LENGTH_OF_MODULES = "robot.module.length"
TAPER_OF_LENGTHS = "robot.taper.length."
MASS_OF_MODULES = "robot.module.mass"
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
class Limits(DesignLimits):
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
        # Before ballast, a large body may well be too light for its water.
        with telling(silent) if self.ballast else nullcontext():
            check_ranges(self.scenario, self.bounds, "bounds")
        check_design_limits(self, self.scenario)
        self._check_length_step()
        objectives = [swum_figure(name, self.scenario, self.bounds) for name in self.objectives]
        object.__setattr__(self, "objectives", _check_objectives("objectives", objectives))

    def _check_length_step(self) -> None:
        """Reject a step of lengths of which no multiple lies within the bounds of a length."""
        if self.length_step is None:
            return
        for name in self.names:
            if name.startswith(TAPER_OF_LENGTHS):
                rule = f"must be left out if lengths are tapered (`{name}`): they are no multiples then"
                raise BadArgument("length_step", f"{rule}, got {self.length_step:g} m")
        if not np.any(self.is_length):
            rule = "must be left out if no length of a module varies"
            raise BadArgument("length_step", f"{rule}, got {self.length_step:g} m")
        for name, is_length, low, high in zip(
            self.names, self.is_length, *self._bound_arrays(), strict=True
        ):
            least = max(1, math.ceil(low / self.length_step - ROUNDING))
            most = math.floor(high / self.length_step + ROUNDING)
            if is_length and least > most:
                rule = f"must have a multiple within the bounds of `{name}`, {low:g} to {high:g} m"
                raise BadArgument("length_step", f"{rule}, got {self.length_step:g} m")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters that may change."""
        return tuple(self.bounds)

    @property
    def needs_loads(self) -> bool:
        """Whether figures of what joints carry are needed."""
        return bool(self.load_limits) or any(name in LOAD_FIGURES for name in self.objectives)

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of all that is known of every trial."""
        return quantities_of(loads=self.needs_loads)

    def definition(self) -> dict[str, Any]:
        """Return everything that the trials depend on, for a file."""
        limits = {name: getattr(self, name) for name in Limits.__dataclass_fields__}
        for name in LOAD_FIGURES:  # folders of older releases have no limits of loads
            if name not in self.load_limits:
                del limits[f"{name}{END_OF_LIMIT}"]
        return {
            **definition_of(self.scenario),
            "bounds": {name: list(ends) for name, ends in self.bounds.items()},
            "objectives": list(self.objectives),
            **limits,
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
        points = np.where(self._is_whole, whole, searched)
        return self.in_length_steps(points)

    def in_length_steps(self, points: Table) -> Table:
        """Return points whose lengths of modules are multiples of `length_step`, within the bounds.

        Args:
            points: The points, one per row.
        """
        step = self.length_step
        if step is None:
            return points
        low, high = self._bound_arrays()
        least = np.ceil(low / step - ROUNDING)
        most = np.floor(high / step + ROUNDING)
        steps = np.clip(np.rint(points / step), least, most)
        return np.where(self.is_length, step * steps, points)

    def _bound_arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the smallest and the largest value of every parameter."""
        bounds = np.array([*self.bounds.values()], dtype=float)
        low, high = bounds.T
        return low, high

    @property
    def is_length(self) -> np.ndarray:
        """Whether each parameter is the length of modules."""
        return np.array([strip_items(name) == LENGTH_OF_MODULES for name in self.names])

    def to_swim(self, points: Table) -> "Swum":
        """Return names and values of the numbers with which points swim: with ballast, modules are heavier.

        Args:
            points: The points, one per row.
        """
        if not self.ballast:
            return Swum(self.names, points)
        unchanged = [i for i, name in enumerate(self.names) if strip_items(name) != MASS_OF_MODULES]
        masses: list[list[float]] = []
        for scenario in self.bodies_at(points):
            masses.append(ballasted_masses(scenario.robot, scenario.environment.density))
        n_modules = self.scenario.robot.n_links
        names = [self.names[i] for i in unchanged]
        names += [f"robot.module[{module}].mass" for module in range(n_modules)]
        return Swum(tuple(names), np.column_stack((points[:, unchanged], masses)))

    def bodies_at(self, points: Table) -> list[Any]:
        """Return scenarios with the robots of some points, without ballast and with the gait as it is.

        Args:
            points: The points, one per row.
        """
        of_body = [i for i, name in enumerate(self.names) if not name.startswith("gait.")]
        if not of_body:
            return [self.scenario] * len(points)
        names = tuple(self.names[i] for i in of_body)
        return scenarios_at(self.scenario, names, points[:, of_body])

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
    swum = optimization.to_swim(table)
    violation = _excess_of_gaits(scenario, swum.names, swum.table, optimization.joint_rate_limit)
    bodies = find_bodies(optimization, table)
    violation = np.maximum(violation, excess_of_bodies(optimization, bodies))
    swims = violation == 0.0
    results: dict[str, Column] = {}
    for name in optimization.quantities:
        results[name] = np.full(len(table), np.nan)
    results["succeeded"] = np.zeros(len(table), dtype=bool)
    if swims.any():
        figures = _swim(optimization, swum.names, swum.table[swims], threads, client)
        for name, values in figures.items():
            results[name][swims] = values
    if not optimization.beyond_actuators:
        excess = results["utilization"] / optimization.servo_share - 1.0
        violation = np.where(swims & (excess > ROUNDING), excess, violation)
    if optimization.least_velocity is not None:
        speed = swum_figure("forward_velocity", scenario, names)
        shortfall = 1.0 - results[speed] / optimization.least_velocity
        is_slow = swims & (shortfall > 0.0)
        violation = np.where(is_slow, np.maximum(shortfall, violation), violation)
    if optimization.battery is not None:
        excess = _excess_of_battery(optimization, bodies, results)
        violation = np.where(swims & (excess > ROUNDING), np.maximum(excess, violation), violation)
    for name, limit in optimization.load_limits.items():
        excess = results[name] / limit - 1.0
        violation = np.where(swims & (excess > ROUNDING), np.maximum(excess, violation), violation)
    has_values = np.full(len(table), True)
    for name in optimization.objectives:
        has_values &= np.isfinite(results[name])
    violation = np.minimum(violation, FAILED)
    results[VIOLATION] = np.where(swims & ~has_values, FAILED, violation)
    return results


def _excess_of_battery(
    optimization: Optimization, bodies: Sequence[BodyNumbers], results: Mapping[str, Column]
) -> Column:
    """Return by how much of the battery points take more than there is."""
    idle_power = np.array([body.idle_power for body in bodies])
    speed = results[speed_of_range(optimization.scenario)]
    share = battery_share(optimization, results["mean_power"], speed, idle_power)
    assert share is not None
    return share - 1.0


class Swum(NamedTuple):
    """Names and values of the numbers with which points swim."""

    names: tuple[str, ...]
    """Names, one per column."""
    table: Table
    """Values, one row per point."""


def speed_of_range(scenario: lc.Scenario) -> str:
    """Return the figure of the speed at which a robot covers the range of its battery.

    Args:
        scenario: The scenario.
    """
    if isinstance(scenario.environment, Water):
        return "speed_through_water"
    return "forward_velocity"


def find_bodies(optimization: Optimization, table: Table) -> list[BodyNumbers]:
    """Return the numbers of the bodies of points, with ballast; none if no limit is about them.

    Args:
        optimization: The optimization.
        table: The points, one per row.
    """
    if not (optimization.limits_body or optimization.battery is not None):
        return []
    return [
        BodyNumbers.of(scenario, with_ballast=optimization.ballast)
        for scenario in optimization.bodies_at(table)
    ]


def excess_of_bodies(optimization: Optimization, bodies: Sequence[BodyNumbers]) -> Column | float:
    """Return how far bodies are beyond what their limits allow, relative to these; 0 without limits.

    Args:
        optimization: The optimization.
        bodies: Numbers of the bodies.
    """
    if not bodies:
        return 0.0
    shares = [largest_share(limits_of_body(optimization, body)).share for body in bodies]
    excess = np.array(shares) - 1.0
    return np.where(excess > ROUNDING, excess, 0.0)


def _swim(
    optimization: Optimization,
    names: tuple[str, ...],
    table: Table,
    threads: int | None,
    client: Any,
) -> dict[str, Column]:
    """Simulate points, here or on a cluster."""
    scenario = optimization.scenario
    if client is None:
        return swim_points(scenario, names, table, threads, loads=optimization.needs_loads)
    from laticauda.studies.remote_points import swim_points_on

    return swim_points_on(client, scenario, names, table, loads=optimization.needs_loads)


def has_slopes(optimization: Optimization) -> bool:
    """Return whether the search is to use the slopes of its objective: of one, to more than ten numbers.

    They are computed backward in time then, see `laticauda.models.simulate.gradients`.

    Args:
        optimization: The optimization.
    """
    if not _is_smooth(optimization):
        return False
    (run,) = runs_of([optimization.scenario])
    n_numbers = len(optimization.names)
    return gradients.is_cheaper([run.plant], n_figures=1, n_numbers=n_numbers)


def can_have_slopes(optimization: Optimization) -> bool:
    """Return whether one objective and all limits can be differentiated: with prescribed joints.

    Args:
        optimization: The optimization.
    """
    if not _is_smooth(optimization):
        return False
    (run,) = runs_of([optimization.scenario])
    return gradients.can_go_backward([run.plant])


def _is_smooth(optimization: Optimization) -> bool:
    """Return whether there is one objective of a robot that no controller steers, and no number is a count.

    Nor may loads be needed, which have no derivatives.
    """
    if len(optimization.objectives) > 1 or optimization.takes_whole_numbers:
        return False
    if optimization.needs_loads:
        return False
    return not _is_steered(optimization.scenario)


def _is_steered(scenario: lc.Scenario) -> bool:
    """Return whether a controller steers the robot."""
    return isinstance(scenario.motion, Controller) and not isinstance(scenario.motion, OpenLoop)


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
    return sign_of_loss(objective) * slope


def sign_of_loss(objective: str) -> float:
    """Return 1 for a figure that is to be small, -1 for one that is to be large.

    Args:
        objective: Name of the figure.
    """
    return 1.0 if objective in COSTS else -1.0


def compute_losses(names: Sequence[str], results: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the objectives as losses, of which the smallest is best, one per column; 0 where there is none.

    Args:
        names: Names of the objectives.
        results: Values by name.
    """
    columns = [sign_of_loss(name) * results[name] for name in names]
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
