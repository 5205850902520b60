"""The best points of a sweep, found region by region: memory does not grow with the sweep."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.errors import one_of, whole
from laticauda.studies.ownership import regions_of
from laticauda.studies.store import open_dataset
from laticauda.studies.trials import QUANTITIES

# Of these the least is the best, of the others the greatest.
COSTS = ("mechanical_power", "net_power", "mean_power", "cost_of_transport")
FIGURES = tuple(name for name in QUANTITIES if name != "succeeded")


def best(folder: str | Path, quantity: str = "forward_velocity", count: int = 5) -> list[dict[str, float]]:
    """The points of a sweep with the greatest speed, or the least power or cost of transport, best first.

    Args:
        folder: That of a sweep, finished or not.
        quantity: What counts.
        count: How many points at most; runs that blew up, and points that are still to come, are none.

    Returns:
        The parameters and all quantities of each point by name.

    Raises:
        ValueError: If there is no such quantity, or no sweep in the folder.
    """
    one_of("quantity", quantity, FIGURES)
    whole("count", count, 1)
    sign = 1.0 if quantity in COSTS else -1.0
    dataset, regions = open_dataset(folder), regions_of(folder)
    values = dataset[quantity].variable
    ranked: list[tuple[float, tuple[int, ...]]] = []
    for block in regions.blocks(range(regions.count)):
        region: np.ndarray = sign * values[block].to_numpy()
        order = np.argsort(region, axis=None, kind="stable")[:count]  # nan comes last
        for flat in map(int, order):
            within = np.unravel_index(flat, region.shape)
            place = tuple(part.start + int(i) for part, i in zip(block, within, strict=True))
            ranked.append((float(region.flat[flat]), place))
        # Of equal ones the first in the sweep.
        ranked = sorted(found for found in ranked if not math.isnan(found[0]))[:count]
    return [_point(dataset, place) for _, place in ranked]


def count_failed(folder: str | Path) -> int:
    """Number of trials that blew up.

    Args:
        folder: That of a sweep, finished or not.
    """
    dataset, regions = open_dataset(folder), regions_of(folder)
    succeeded = dataset["succeeded"].variable
    n_good = sum(int(succeeded[block].to_numpy().sum()) for block in regions.blocks(range(regions.count)))
    return int(dataset.attrs["n_finished"]) - n_good


def _point(dataset: Any, place: tuple[int, ...]) -> dict[str, float]:
    point = dataset.isel(dict(zip(dataset[FIGURES[0]].dims, place, strict=True)))
    return {str(name): float(point[name]) for name in (*point.coords, *FIGURES)}
