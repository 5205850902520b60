"""Definition of an optimization: which numbers may change within which bounds, for which objectives and limits.

Also its result: the nondominated points.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Bool, Float

import laticauda as lc
from laticauda.errors import BadArgument, check_choice
from laticauda.files import write
from laticauda.logs.tabular import csv_text
from laticauda.quantities import option, quantity, value_class
from laticauda.simulate.numbers import list_parameters
from laticauda.studies import sampling, sweep
from laticauda.studies.sweep import (
    COSTS,
    FIGURES,
    QUANTITIES,
    Column,
    Table,
    attributes_of,
    labels_of,
    scenarios_at,
)
from laticauda.trial.feasibility import ROUNDING

if TYPE_CHECKING:
    import xarray

OBJECTIVES = (
    "forward_velocity",
    "steady_velocity",
    "mechanical_power",
    "mean_power",
    "cost_of_transport",
)
"""What can be optimized: speeds are maximized, powers and the cost of transport minimized."""
SPEED_POWER = ("forward_velocity", "mechanical_power")
VIOLATION = "violation"
AT_BOUND = 0.005
"""Distance from an end of its range within which a number counts as at that end, as a fraction of the range."""
FAILED = (
    1e3  # violation of a run that diverged: larger than that of any gait whose swing is too wide
)


def _objectives(name: str, given: str | Sequence[str]) -> tuple[str, ...]:
    wanted = (given,) if isinstance(given, str) else tuple(given)
    for one in wanted:
        check_choice(name, one, OBJECTIVES)
    if len(set(wanted)) != len(wanted) or len(wanted) not in (1, 2):
        raise BadArgument(
            name, f"must be one, or two different ones, got {', '.join(wanted) or 'none'}"
        )
    return wanted


@value_class
class Limits:
    """Limits that a point must respect, besides those of the joints, to be feasible."""

    joint_rate_limit: float | None = quantity(
        "rad/s", "Largest joint rate a gait may demand", gt=0.0, default=None
    )
    least_velocity: float | None = quantity(
        "m/s",
        "Smallest acceptable velocity; without it, the cheapest gait hardly moves",
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

    Raises:
        ValueError: If a field is out of its range, or a parameter does not exist (the message has
            the nearest names).

    Example:
        >>> import laticauda as lc
        >>> gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> sought = Optimization(
        ...     scenario=lc.build_scenario("mamba", gait),
        ...     bounds={"gait.amplitude": (0.2, 0.9), "robot.n_links": (6, 12)},
        ... )
        >>> sought.objectives
        ('forward_velocity', 'mechanical_power')
    """

    scenario: lc.Scenario = option("Scenario shared by all trials; of the planar model")
    bounds: Mapping[str, tuple[float, float]] = option(
        "Smallest and largest value by name of parameter, as for a sweep (SI, radians)",
        check=sampling.checked_ranges,
    )
    objectives: Sequence[str] = option(
        "One of `OBJECTIVES`, two for a front", default=SPEED_POWER, check=_objectives
    )

    def __post_init__(self) -> None:
        """Check the fields against each other."""
        sweep.check_scenario(self.scenario)
        sweep.check_ranges(self.scenario, self.bounds, "bounds")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters that may change."""
        return tuple(self.bounds)

    def definition(self) -> dict[str, Any]:
        """Return everything that the trials depend on, for a file."""
        return {
            **sweep.definition_of(self.scenario),
            "bounds": {name: list(ends) for name, ends in self.bounds.items()},
            "objectives": list(self.objectives),
            **{name: getattr(self, name) for name in Limits.__dataclass_fields__},
        }

    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the bounds in the form for a search: each whole number has an interval of length one."""
        low, high = np.array(list(self.bounds.values()), dtype=float).T
        half = np.where(self._is_whole, 0.5, 0.0)
        return low - half, high + half

    def points(self, sought: Table) -> Table:
        """Convert the points of a search: parameters that take whole numbers only are rounded.

        Args:
            sought: Points in the `box`.
        """
        low, high = np.array(list(self.bounds.values()), dtype=float).T
        return np.where(self._is_whole, np.clip(np.rint(sought), low, high), sought)

    @property
    def _is_whole(self) -> np.ndarray:
        known = list_parameters(self.scenario)
        return np.array([known[name].is_whole for name in self.names])


def evaluate(
    optimization: Optimization, table: Table, threads: int | None = None
) -> dict[str, Column]:
    """Evaluate points; those beyond the limits are not simulated.

    Args:
        optimization: The optimization.
        table: The points, one per row.
        threads: Number of threads; None uses all cores available to this process.

    Returns:
        By name, one value per point: every quantity of a sweep, nan where there is none, and
            `violation`: 0 for
        feasible points, otherwise how far they are from being feasible, relative to the limit.
    """
    scenario, names = optimization.scenario, optimization.names
    limit = optimization.joint_rate_limit
    violation = np.array([_beyond(one, limit) for one in scenarios_at(scenario, names, table)])
    swims = violation == 0.0
    found: dict[str, Column] = {name: np.full(len(table), np.nan) for name in QUANTITIES}
    found["succeeded"] = np.zeros(len(table), dtype=bool)
    if swims.any():
        for name, values in sweep.swim_points(scenario, names, table[swims], threads).items():
            found[name][swims] = values
    if not optimization.beyond_actuators:
        excess = found["utilization"] - 1.0
        violation = np.where(swims & (excess > ROUNDING), excess, violation)
    if optimization.least_velocity is not None:
        missing = 1.0 - found["forward_velocity"] / optimization.least_velocity
        violation = np.where(swims & (missing > 0.0), np.maximum(missing, violation), violation)
    has_values = np.all([np.isfinite(found[name]) for name in optimization.objectives], axis=0)
    found[VIOLATION] = np.where(swims & ~has_values, FAILED, violation)
    return found


def compute_losses(names: Sequence[str], found: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the objectives as losses, of which the smallest is best, one per column; 0 where there is none.

    Args:
        names: Names of the objectives.
        found: Values by name.
    """
    columns = [found[name] if name in COSTS else -found[name] for name in names]
    return np.nan_to_num(np.stack(columns, axis=1), nan=0.0)


def _beyond(scenario: lc.Scenario, joint_rate_limit: float | None) -> float:
    """Return how far a gait exceeds the limits of the joints, relative to them."""
    body, gait = scenario.robot.planar(), scenario.gait
    widest = 0.0
    for joint, envelope in zip(body.joints, gait.joint_envelope(body.n_links), strict=True):
        swing = abs(envelope) * gait.amplitude
        widest = max(widest, (swing + abs(gait.offset)) / joint.limit)
        if joint_rate_limit is not None:
            widest = max(widest, swing * gait.frequency / joint_rate_limit)
    return max(0.0, widest - 1.0)


# ---- results -------------------------------------------------------------------------------------

Losses = Float[np.ndarray, "n_points n_objectives"]
POINT = "point"


@dataclass(frozen=True, kw_only=True, eq=False)
class Front:
    """Nondominated points of all that were tried; a single point for one objective.

    They are in ascending order of the last objective. There are none if no point was feasible.
    """

    optimization: Optimization
    """The optimization."""
    values: Table
    """Values of the parameters, one row per point and one column per name in `optimization.names` (SI, radians)."""
    figures: Mapping[str, Column]
    """Every quantity of a sweep by name, with one value per point."""
    n_trials: int
    """Number of points tried."""
    n_infeasible: int
    """Number of infeasible points among them; see `Optimization`."""
    seed: int
    """Seed of the search."""

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.values)

    def scenario(self, point: int) -> lc.Scenario:
        """Return the scenario of a point.

        Args:
            point: Index of the point.
        """
        sought = self.optimization
        return scenarios_at(sought.scenario, sought.names, self.values[[point]])[0]

    def gait(self, point: int) -> lc.Gait:
        """Return the gait of a point.

        Args:
            point: Index of the point.
        """
        return self.scenario(point).gait

    def point(self, point: int) -> dict[str, float]:
        """Return the parameters and all figures of a point by name.

        Args:
            point: Index of the point.
        """
        figures = {name: float(self.figures[name][point]) for name in FIGURES}
        return (
            dict(zip(self.optimization.names, self.values[point].tolist(), strict=True)) | figures
        )

    def at_bounds(self) -> list[dict[str, Any]]:
        """Return where points lie at an end of a range: the range, rather than the robot, may make them the best.

        Returns:
            One row for every end with points within `AT_BOUND` of it: `name` of the parameter,
                `end` ("least" or
            "greatest"), its `value` (SI, radians), and the number of points, `n_points`.
        """
        rows: list[dict[str, Any]] = []
        for (name, ends), column in zip(
            self.optimization.bounds.items(), self.values.T, strict=True
        ):
            near = AT_BOUND * (ends[1] - ends[0])
            for end, bound in zip(("least", "greatest"), ends, strict=True):
                count = int(np.count_nonzero(np.abs(column - bound) <= near))
                if count:
                    rows.append(
                        {"name": name, "end": end, "value": float(bound), "n_points": count}
                    )
        return rows

    def spread(self, count: int) -> list[int]:
        """Return the indices of points spaced evenly along the front, including its ends.

        Args:
            count: Maximum number of points.
        """
        if len(self) <= count:
            return list(range(len(self)))
        columns = [self.figures[name] for name in self.optimization.objectives]
        scaled = np.stack([column / np.ptp(column) for column in columns], axis=1)
        way = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(scaled, axis=0), axis=1))))
        wanted = np.linspace(0.0, float(way[-1]), count)
        return sorted({int(np.argmin(np.abs(way - at))) for at in wanted})

    def to_dataset(self) -> "xarray.Dataset":
        """Return the front as an xarray Dataset with the dimension `point`; SI units, angles in radians."""
        import xarray

        sought, labels = self.optimization, labels_of(self.optimization.scenario)
        columns = zip(sought.names, self.values.T, strict=True)
        coordinates = {name: (POINT, column, labels[name]) for name, column in columns}
        variables = {name: (POINT, self.figures[name], labels[name]) for name in FIGURES}
        attributes = {
            "title": f"Best in {' and '.join(sought.objectives)}",
            **attributes_of(sought.scenario),
            "n_trials": self.n_trials,
            "n_infeasible": self.n_infeasible,
            "seed": self.seed,
        }
        return xarray.Dataset(variables, coords=coordinates, attrs=attributes)

    def write_netcdf(self, path: str | Path) -> None:
        """Write the front to a netCDF file.

        Args:
            path: Path of the file; an existing file is replaced.
        """
        found: Any = self.to_dataset()
        write(path, lambda new: found.to_netcdf(new, engine="netcdf4"))

    def write_csv(self, path: str | Path) -> None:
        """Write the front to a CSV file: one row per point, SI units, angles in radians.

        Args:
            path: Path of the file; an existing file is replaced.
        """
        found: Any = self.to_dataset()
        columns: dict[str, Any] = {**found.coords, **found.data_vars}
        units = {
            name: "-" if column.units == "1" else column.units for name, column in columns.items()
        }
        write(
            path,
            csv_text([(name, units[name], column.to_numpy()) for name, column in columns.items()]),
        )


def pareto_front(losses: Losses) -> Bool[np.ndarray, " n_points"]:
    """Find the nondominated points: no other point is better in one objective and at least as good in the others.

    Of equal points, only the first counts.

    Args:
        losses: One or two objectives; smaller is better.
    """
    kept = np.zeros(len(losses), dtype=bool)
    least = np.inf
    # In ascending order of the first objective, a point is dominated unless it is the best so far
    # in the last one.
    for i in np.lexsort((np.arange(len(losses)), losses[:, -1], losses[:, 0])):
        if losses[i, -1] < least:
            kept[i], least = True, losses[i, -1]
    return kept
