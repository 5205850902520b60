"""What an optimization found: the points that no other one beats, and the measure of how good they are together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Bool, Float

import laticauda as lc
from laticauda.files import write
from laticauda.logs.tabular import csv_text
from laticauda.simulate.numbers import parameters
from laticauda.studies.optimization import Optimization
from laticauda.studies.trials import FIGURES, QUANTITIES, Column, Table, attributes_of, scenarios_at

if TYPE_CHECKING:
    import xarray

Losses = Float[np.ndarray, "n_points n_objectives"]
POINT = "point"


@dataclass(frozen=True, kw_only=True, eq=False)
class Front:
    """The points that no other one beats in every objective, of all that were tried; one point for one objective.

    They are in rising order of the last objective. There is none if no point was feasible.
    """

    optimization: Optimization
    """What was optimized."""
    values: Table
    """Of the parameters, a row per point, a column per name of `optimization.names` (SI, radians)."""
    figures: Mapping[str, Column]
    """By name, a value per point of every quantity of a sweep."""
    n_trials: int
    """How many points were tried."""
    n_infeasible: int
    """How many of them were not feasible; see `Optimization`."""
    seed: int
    """Of the search."""

    def __len__(self) -> int:
        """Number of points."""
        return len(self.values)

    def scenario(self, point: int) -> lc.Scenario:
        """The scenario of a point.

        Args:
            point: Its number.
        """
        sought = self.optimization
        return scenarios_at(sought.scenario, sought.names, self.values[[point]])[0]

    def gait(self, point: int) -> lc.Gait:
        """The gait of a point.

        Args:
            point: Its number.
        """
        return self.scenario(point).gait

    def point(self, point: int) -> dict[str, float]:
        """The parameters and all figures of a point by name.

        Args:
            point: Its number.
        """
        figures = {name: float(self.figures[name][point]) for name in FIGURES}
        return dict(zip(self.optimization.names, self.values[point].tolist(), strict=True)) | figures

    def spread(self, count: int) -> list[int]:
        """Numbers of points that lie evenly along the front, its ends included.

        Args:
            count: How many at most.
        """
        if len(self) <= count:
            return list(range(len(self)))
        columns = [self.figures[name] for name in self.optimization.objectives]
        scaled = np.stack([column / np.ptp(column) for column in columns], axis=1)
        way = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(scaled, axis=0), axis=1))))
        wanted = np.linspace(0.0, float(way[-1]), count)
        return sorted({int(np.argmin(np.abs(way - at))) for at in wanted})

    def to_dataset(self) -> xarray.Dataset:
        """The front as an xarray Dataset with the dimension `point`; SI units, angles in radians."""
        import xarray

        known = parameters(self.optimization.scenario)
        coordinates = {
            name: (POINT, column, {"long_name": known[name].title, "units": known[name].unit or "1"})
            for name, column in zip(self.optimization.names, self.values.T, strict=True)
        }
        variables = {
            name: (POINT, self.figures[name], {"long_name": QUANTITIES[name][1], "units": QUANTITIES[name][0]})
            for name in FIGURES
        }
        attributes = {
            "title": f"Best in {' and '.join(self.optimization.objectives)}",
            **attributes_of(self.optimization.scenario),
            "n_trials": self.n_trials,
            "n_infeasible": self.n_infeasible,
            "seed": self.seed,
        }
        return xarray.Dataset(variables, coords=coordinates, attrs=attributes)

    def write_netcdf(self, path: str | Path) -> None:
        """Write the front to a netCDF file.

        Args:
            path: The file; an older one of that name is replaced.
        """
        found: Any = self.to_dataset()
        write(path, lambda new: found.to_netcdf(new, engine="netcdf4"))

    def write_csv(self, path: str | Path) -> None:
        """Write the front to a CSV file: a row per point, SI units, angles in radians.

        Args:
            path: The file; an older one of that name is replaced.
        """
        found: Any = self.to_dataset()
        columns: dict[str, Any] = {**found.coords, **found.data_vars}
        units = {name: "-" if column.units == "1" else column.units for name, column in columns.items()}
        write(path, csv_text([(name, units[name], column.to_numpy()) for name, column in columns.items()]))


def unbeaten(losses: Losses) -> Bool[np.ndarray, " n_points"]:
    """Which points no other one beats: none is better in one objective and as good in the others.

    Of equal points the first counts.

    Args:
        losses: One or two objectives, smaller is better.
    """
    kept = np.zeros(len(losses), dtype=bool)
    least = np.inf
    # In rising order of the first objective, a point is beaten unless it is the best so far in the last one.
    for i in np.lexsort((np.arange(len(losses)), losses[:, -1], losses[:, 0])):
        if losses[i, -1] < least:
            kept[i], least = True, losses[i, -1]
    return kept
