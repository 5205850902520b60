"""What an optimization found: the points that no other one beats, and the measure of how good they are together."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float

from laticauda.gaits import Gait
from laticauda.robot import Environment, Robot
from laticauda.studies.problem import Problem
from laticauda.studies.trials import QUANTITIES, Column, Table, things

if TYPE_CHECKING:
    import xarray

Losses = Float[np.ndarray, "n_points n_objectives"]
POINT = "point"


@dataclass(frozen=True, kw_only=True, eq=False)
class Front:
    """The points that no other one beats in every objective, of all that were tried; one point for one objective.

    They are in rising order of the last objective. There is none if no point was feasible.
    """

    problem: Problem
    """What was optimized."""
    values: Table
    """Of the parameters, a row per point, a column per name of `problem.names` (SI, radians)."""
    figures: Mapping[str, Column]
    """By name, a value per point of every quantity of a sweep."""
    n_trials: int
    """How many points were tried."""
    n_infeasible: int
    """How many of them were not feasible; see `Problem`."""
    seed: int
    """Of the search."""

    def __len__(self) -> int:
        """Number of points."""
        return len(self.values)

    def things(self, point: int) -> tuple[Robot, Gait, Environment]:
        """Robot, gait and environment of a point.

        Args:
            point: Its number.
        """
        robots, gaits, environments = things(self.problem, self.problem.names, self.values[point : point + 1])
        return robots[0], gaits[0], environments[0]

    def gait(self, point: int) -> Gait:
        """The gait of a point.

        Args:
            point: Its number.
        """
        return self.things(point)[1]

    def spread(self, count: int) -> list[int]:
        """Numbers of points that lie evenly along the front, its ends included.

        Args:
            count: How many at most.
        """
        if len(self) <= count:
            return list(range(len(self)))
        scaled = np.stack([self.figures[name] / np.ptp(self.figures[name]) for name in self.problem.objectives], axis=1)
        way = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(scaled, axis=0), axis=1))))
        wanted = np.linspace(0.0, float(way[-1]), count)
        return sorted({int(np.argmin(np.abs(way - at))) for at in wanted})

    def to_dataset(self) -> xarray.Dataset:
        """The front as an xarray Dataset with the dimension `point`; SI units, angles in radians."""
        import xarray

        known = self.problem.known()
        coordinates = {
            name: (POINT, column, {"long_name": known[name].title, "units": known[name].unit or "1"})
            for name, column in zip(self.problem.names, self.values.T, strict=True)
        }
        variables = {
            name: (POINT, self.figures[name], {"long_name": title} | ({"units": unit} if unit else {}))
            for name, (unit, title) in QUANTITIES.items()
            if name != "succeeded"
        }
        attributes = {
            "title": f"Best in {' and '.join(self.problem.objectives)}",
            "robot": self.problem.robot.name,
            "gait": self.problem.gait.kind,
            "environment": self.problem.where.name,
            "duration": self.problem.duration,
            "joints": self.problem.joints,
            "n_trials": self.n_trials,
            "n_infeasible": self.n_infeasible,
            "seed": self.seed,
            "laticauda": self.problem.definition()["laticauda"],
        }
        return xarray.Dataset(variables, coords=coordinates, attrs=attributes)

    def write_netcdf(self, path: str | Path) -> None:
        """Write the front to a netCDF file.

        Args:
            path: The file; an older one of that name is replaced.
        """
        new = Path(f"{path}.new")
        self.to_dataset().to_netcdf(new, engine="netcdf4")  # pyright: ignore[reportUnknownMemberType]
        os.replace(new, path)

    def write_csv(self, path: str | Path) -> None:
        """Write the front to a CSV file: a row per point, SI units, angles in radians.

        Args:
            path: The file; an older one of that name is replaced.
        """
        import csv

        known = self.problem.known()
        head = [f"{name} [{known[name].unit or '-'}]" for name in self.problem.names]
        kept = [(name, unit) for name, (unit, _) in QUANTITIES.items() if name != "succeeded"]
        head += [f"{name} [{'-' if unit == '1' else unit}]" for name, unit in kept]
        columns = [*self.values.T, *(self.figures[name] for name, _ in kept)]
        new = Path(f"{path}.new")
        with new.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(head)
            writer.writerows(np.stack(columns, axis=1).tolist())
        os.replace(new, path)


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


def hypervolume(losses: Losses, reference: tuple[float, float]) -> float:
    """The area of what two objectives' points beat, up to a reference point; the greater the better the front.

    Args:
        losses: Two objectives, smaller is better.
        reference: The worst values that count.
    """
    inside = losses[np.all(losses < reference, axis=1)]
    front = inside[unbeaten(inside)]
    front = front[np.argsort(front[:, 0])]
    edges = np.append(front[1:, 0], reference[0])
    return float(np.sum((edges - front[:, 0]) * (reference[1] - front[:, 1])))
