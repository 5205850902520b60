"""Running a sweep in a folder: in this process, or on a cluster."""

from collections.abc import Generator
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.models.simulate import silent
from laticauda.studies.point_trials import Column, Progress, swim_points
from laticauda.studies.regions import Regions
from laticauda.studies.sampling import Table
from laticauda.studies.sharing import Share, region_size_for
from laticauda.studies.store import open_store
from laticauda.studies.stored_sweep import open_unread
from laticauda.studies.sweep import Sweep
from laticauda.values import check_whole_number

if TYPE_CHECKING:
    import xarray


def run_sweep(
    sweep: Sweep,
    folder: str | Path,
    *,
    progress: Progress = silent,
    client: Any = None,
    threads: int | None = None,
    region_size: int | None = None,
    resume: bool = True,
    share: Share | None = None,
) -> "xarray.Dataset":
    """Run a sweep, or the rest of it, and store the results in a folder.

    Work and storage proceed region by region: a region is marked as done once all of it is stored.
    The run may be killed at any moment, even by SIGKILL, and called again: it continues, and the
    results are bit-for-bit the same as if it had never stopped (on processors of one kind). Memory
    does not grow with the number of trials.

    Args:
        sweep: Sweep to run.
        folder: Folder for the results; created if needed. It must be empty or hold this same sweep.
        progress: Called at the start and after every region with the number of trials done and the
            total.
        client: A `dask.distributed.Client`: the trials run on its cluster. None runs them in this
            process.
        threads: Number of threads in this process; None uses one per core. A cluster uses every
            thread of a worker.
        region_size: Maximum number of trials in a region of a new folder; None takes about a second
            of work, less where every share is to have some. The results depend on it only through rounding.
        resume: False rejects a folder that already has results.
        share: Only this share of the sweep, in a folder of its own, see `Share.folder`; all shares
            are put together by `merge_shares`. None runs all of it.

    Returns:
        The whole sweep, or its share with nan for all other points, read from the folder when it is
        used; see `open_sweep`.

    Raises:
        ValueError: If an argument is out of its range, or the folder holds something else or
            another sweep; the message names the differences.
        StorageFailed: If the results cannot be written. Nothing that was stored is lost.
        ClusterFailed: If the cluster's scheduler goes away, or workers die repeatedly. Nothing that
            was stored is lost.
        MissingExtra: If zarr is not installed, or scipy for samples.
    """
    if threads is not None:
        check_whole_number("threads", threads, 1)
    path = Path(folder)
    if share is not None:
        path = share.folder(path)
        if region_size is None:
            region_size = region_size_for(sweep, share.count)
    with open_store(path, sweep, region_size=region_size, resume=resume) as store:
        pending = np.flatnonzero(~store.done).tolist()
        n_wanted = sweep.n_trials
        if share is not None:
            pending = [index for index in pending if share.has_region(index)]
            n_wanted = store.n_done + sum(map(store.regions.n_points, pending))
        progress(store.n_done, n_wanted)
        with closing(_swim_regions(sweep, store.regions, pending, client, threads)) as regions:
            for index, table, results in regions:
                store.write(index, table, results)
                progress(store.n_done, n_wanted)
    return open_unread(path)


def _swim_regions(
    sweep: Sweep, regions: Regions, pending: list[int], client: Any, threads: int | None
) -> Generator[tuple[int, Table, dict[str, Column]]]:
    """Yield index, points and results of the pending regions in order of completion."""
    names = sweep.points.names
    blocks = map(regions.at, pending)
    tables = zip(pending, sweep.tables(blocks), strict=True)
    if client is not None:
        from laticauda.studies.remote_points import swim_on

        yield from swim_on(client, sweep.scenario, names, tables, loads=sweep.loads)
        return
    for index, table in tables:
        results = swim_points(sweep.scenario, names, table, threads, loads=sweep.loads)
        yield index, table, results
