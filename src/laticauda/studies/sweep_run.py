"""Running a sweep in a folder that survives anything, and reading what is there."""

from __future__ import annotations

import math
from collections.abc import Generator
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.errors import one_of, whole
from laticauda.studies.store import open_sweep, opened, regions_of
from laticauda.studies.sweep import Regions, Sweep
from laticauda.studies.trials import COSTS, FIGURES, Column, Progress, Table, silent, swim_points

if TYPE_CHECKING:
    import xarray


def run_sweep(
    sweep: Sweep,
    folder: str | Path,
    *,
    progress: Progress | None = None,
    client: Any = None,
    threads: int | None = None,
    region_size: int | None = None,
    resume: bool = True,
) -> xarray.Dataset:
    """Run a sweep, or the rest of it, and keep the results in a folder.

    Work and storage go region by region: a region is marked as done once all of it is stored. So the run may be killed
    at any moment, even by SIGKILL, and called again: it goes on, and what comes out has the same bits as if it had
    never stopped (on processors of one kind). Memory does not grow with the number of trials.

    Args:
        sweep: What to run.
        folder: Where the results go; made if need be. It must be empty, or hold this very sweep.
        progress: Called at the start and after every region with the number of trials done, and of all.
        client: A `dask.distributed.Client`: the trials run on its cluster. None runs them here.
        threads: How many run here at once; None is one per core. On a cluster every thread of a worker is one.
        region_size: Greatest number of trials in a region of a new folder; None takes about a second of work. The
            results depend on it by rounding only.
        resume: False refuses a folder that has results already.

    Returns:
        The whole sweep, read from the folder when it is used; see `open_sweep`.

    Raises:
        ValueError: If an argument is out of its range, or the folder holds something else, or another sweep: the
            message names what differs.
        StorageFailed: If the results cannot be written. Nothing that was stored is lost.
        ClusterFailed: If the cluster's scheduler goes away, or workers die again and again. The same holds.
        MissingExtra: If zarr is not installed, or scipy for samples.
    """
    if threads is not None:
        whole("threads", threads, 1)
    with opened(folder, sweep, region_size=region_size, resume=resume) as store:
        tell = progress or silent
        tell(store.n_done, sweep.n_trials)
        pending = store.pending()
        with closing(_results(sweep, store.regions, pending, client, threads)) as results:
            for index, table, found in results:
                store.write(index, table, found)
                tell(store.n_done, sweep.n_trials)
    return open_sweep(folder)


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
    dataset, regions = open_sweep(folder), regions_of(folder)
    values = dataset[quantity].variable
    ranked: list[tuple[float, tuple[int, ...]]] = []
    for block in map(regions.at, range(regions.count)):
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
    dataset, regions = open_sweep(folder), regions_of(folder)
    succeeded = dataset["succeeded"].variable
    n_good = sum(int(succeeded[block].to_numpy().sum()) for block in map(regions.at, range(regions.count)))
    return int(dataset.attrs["n_finished"]) - n_good


def _results(
    sweep: Sweep, regions: Regions, pending: list[int], client: Any, threads: int | None
) -> Generator[tuple[int, Table, dict[str, Column]]]:
    """What the pending regions come to, in the order in which they are done."""
    tables = zip(pending, sweep.tables(map(regions.at, pending)), strict=True)
    if client is None:
        for index, table in tables:
            yield index, table, swim_points(sweep.scenario, sweep.points.names, table, threads)
    else:
        from laticauda.studies.cluster import swim_on

        yield from swim_on(client, sweep.scenario, sweep.points.names, tables)


def _point(dataset: Any, place: tuple[int, ...]) -> dict[str, float]:
    point = dataset.isel(dict(zip(dataset[FIGURES[0]].dims, place, strict=True)))
    return {str(name): float(point[name]) for name in (*point.coords, *FIGURES) if name in point}
