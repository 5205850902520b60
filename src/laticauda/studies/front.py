"""Result of an optimization: the nondominated points, and how they are shown and written."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Bool, Float

import laticauda as lc
from laticauda.models.simulate.numbers import list_parameters
from laticauda.studies.limits import name_limits
from laticauda.studies.optimization import Optimization
from laticauda.studies.point_trials import (
    ALL_FIGURES,
    Column,
    attributes_of,
    labels_of,
    scenarios_at,
)
from laticauda.studies.sampling import Table
from laticauda.trials.logs import TableColumn, format_csv, write_dataset
from laticauda.values import write

if TYPE_CHECKING:
    import xarray

Losses = Float[np.ndarray, "n_points n_objectives"]
POINT = "point"
"""The dimension of a front."""
AT_BOUND = 0.005
"""Distance from an end of its range within which a number counts as at that end, as a fraction of the range."""


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
    refusals: Mapping[str, int] = field(default_factory=dict[str, int])
    """With limits of a design: number of infeasible points by the limit that refused them."""
    n_slope_trials: int = 0
    """Trials that slopes of limits cost besides, see `laticauda.studies.limited_search`."""

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.values)

    def scenario(self, point: int) -> lc.Scenario:
        """Return the scenario of a point.

        Args:
            point: Index of the point.
        """
        optimization = self.optimization
        swum = optimization.to_swim(self.values[[point]])
        scenarios = scenarios_at(optimization.scenario, swum.names, swum.table)
        return scenarios[0]

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
        values = self.values[point].tolist()
        parameters = dict(zip(self.optimization.names, values, strict=True))
        figures: dict[str, float] = {}
        for name in self._figure_names():
            figures[name] = float(self.figures[name][point])
        return parameters | figures

    def _figure_names(self) -> list[str]:
        """Return the names of the figures of its points; of most, no loads are known."""
        return [name for name in ALL_FIGURES if name in self.figures]

    def at_bounds(self) -> list[dict[str, Any]]:
        """Return where points lie at an end of a range: the range, rather than the robot, may make them the best.

        Returns:
            One row for every end with points within `AT_BOUND` of it: `name` of the parameter,
            `end` ("least" or "greatest"), its `value` (SI, radians), and the number of points,
            `n_points`.
        """
        rows: list[dict[str, Any]] = []
        bounds = self.optimization.bounds
        for name, column in zip(bounds, self.values.T, strict=True):
            low, high = bounds[name]
            tolerance = AT_BOUND * (high - low)
            for end, bound in (("least", low), ("greatest", high)):
                distance = np.abs(column - bound)
                n_points = np.count_nonzero(distance <= tolerance)
                if n_points == 0:
                    continue
                row = {
                    "name": name,
                    "end": end,
                    "value": float(bound),
                    "n_points": int(n_points),
                }
                rows.append(row)
        return rows

    def limits(self, point: int) -> list[str]:
        """Return what limits a point: limits of the robot, and ends of ranges at which its parameters lie.

        Args:
            point: Index of the point.
        """
        limits = name_limits(self.scenario(point))
        parameters = list_parameters(self.optimization.scenario)
        bounds = self.optimization.bounds
        for name, value in zip(bounds, self.values[point], strict=True):
            low, high = bounds[name]
            tolerance = AT_BOUND * (high - low)
            distance = min(abs(value - low), abs(value - high))
            if distance <= tolerance:
                phrase = parameters[name].phrase
                limits.append(f"range of the {phrase}")
        return limits

    def spread(self, count: int) -> list[int]:
        """Return the indices of points spaced evenly along the front, including its ends.

        Args:
            count: Maximum number of points.
        """
        if len(self) <= count:
            return list(range(len(self)))
        distances = self._distances_along()
        nearest: set[int] = set()
        for even_distance in np.linspace(0.0, float(distances[-1]), count):
            gaps = np.abs(distances - even_distance)
            nearest.add(int(np.argmin(gaps)))
        return sorted(nearest)

    def _distances_along(self) -> np.ndarray:
        """Return how far each point lies from the first along the front, every objective scaled to its range."""
        scaled: list[np.ndarray] = []
        for name in self.optimization.objectives:
            column = self.figures[name]
            scaled.append(column / np.ptp(column))
        changes = np.diff(scaled, axis=1)
        steps = np.linalg.norm(changes, axis=0)
        return np.concatenate(([0.0], np.cumsum(steps)))

    def to_dataset(self) -> "xarray.Dataset":
        """Return the front as an xarray Dataset with the dimension `point`; SI units, angles in radians."""
        import xarray

        optimization = self.optimization
        labels = labels_of(optimization.scenario, optimization.names)
        coordinates: dict[str, Any] = {}
        for name, column in zip(optimization.names, self.values.T, strict=True):
            coordinates[name] = (POINT, column, labels[name])
        variables: dict[str, Any] = {}
        for name in self._figure_names():
            variables[name] = (POINT, self.figures[name], labels[name])
        objectives = " and ".join(optimization.objectives)
        attributes = {
            "title": f"Best in {objectives}",
            **attributes_of(optimization.scenario),
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
        dataset: Any = self.to_dataset()
        encoding = {name: {"fletcher32": True} for name in dataset.variables}  # checksums of HDF5
        write(path, lambda new_path: write_dataset(dataset, new_path, encoding))

    def write_csv(self, path: str | Path) -> None:
        """Write the front to a CSV file: one row per point, SI units, angles in radians.

        Args:
            path: Path of the file; an existing file is replaced.
        """
        dataset: Any = self.to_dataset()
        columns: list[TableColumn] = []
        for name, variable in {**dataset.coords, **dataset.data_vars}.items():
            unit = variable.units
            if unit == "1":
                unit = "-"
            columns.append(TableColumn(name=name, unit=unit, values=variable.to_numpy()))
        write(path, format_csv(columns))


def pareto_front(losses: Losses) -> Bool[np.ndarray, " n_points"]:
    """Find the nondominated points: no other point is better in one objective and at least as good in the others.

    Of equal points, only the first counts.

    Args:
        losses: One or two objectives; smaller is better.
    """
    is_nondominated = np.zeros(len(losses), dtype=bool)
    first_objective = losses[:, 0]
    last_objective = losses[:, -1]
    numbers = np.arange(len(losses))
    smallest = np.inf
    # In ascending order of the first objective, a point is dominated unless it is the best so far
    # in the last one.
    for i in np.lexsort((numbers, last_objective, first_objective)):
        if last_objective[i] < smallest:
            is_nondominated[i] = True
            smallest = last_objective[i]
    return is_nondominated
