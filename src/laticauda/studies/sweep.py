"""Sweeps: one robot, gait and water over thousands to millions of points, in a folder that survives anything."""

from __future__ import annotations

import dataclasses
from collections.abc import Generator, Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda import __version__
from laticauda.errors import instance, whole
from laticauda.simulate.parameters import check_whole
from laticauda.studies.progress import Progress
from laticauda.studies.regions import Regions, cut
from laticauda.studies.sampling import Grid, Points, Rows, Samples
from laticauda.studies.store import Store, open_dataset
from laticauda.studies.trials import Setup, check_ranges, swim_points

if TYPE_CHECKING:
    import xarray

    from laticauda.studies.trials import Column, Table


# What a region should take on one core, and what a trial of ten links and 30 s takes there, roughly [s].
REGION_TIME = 1.5
TRIAL_TIME = {"prescribed": 0.35e-3, "pd": 5e-3, "servo": 5e-3}
LEAST_SIZE, MOST_SIZE = 64, 16384


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep(Setup):
    """What to sweep: a setup, and the points that change numbers of it.

    Raises:
        ValueError: If a field is out of its range, a parameter does not exist (the message has the nearest names), or
            a value is out of the parameter's range.

    Example:
        >>> import laticauda as lc
        >>> sweep = Sweep(
        ...     robot=lc.load_robot("mamba"),
        ...     gait=lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7),
        ...     points=Grid(values={"gait.amplitude": [0.3, 0.5], "water.normal_drag": [1.0, 1.5, 2.0]}),
        ... )
        >>> sweep.n_trials
        6
    """

    points: Points
    """Which points: `Grid`, `Rows` or `Samples`."""

    def __post_init__(self) -> None:
        """Check every field once."""
        super().__post_init__()
        instance("points", self.points, Grid, Rows, Samples)
        check_ranges(self, self.points.ranges)
        if not isinstance(self.points, Samples):
            known = self.known()
            for name in self.points.names:
                check_whole(known[name], self.points.values[name])

    @property
    def n_trials(self) -> int:
        """Number of trials."""
        return int(np.prod(self.points.shape, dtype=np.int64))

    def regions(self, size: int | None = None) -> Regions:
        """The sweep in pieces of about a second of work: the order of the work and of the files.

        Args:
            size: Greatest number of points in a region; None takes one by what a trial costs.
        """
        if size is None:
            trial = TRIAL_TIME[self.joints] * self.duration / 30.0 * self.robot.n_links / 10.0
            size = int(np.clip(REGION_TIME / trial, LEAST_SIZE, MOST_SIZE))
        return cut(self.points.shape, whole("region_size", size, 1))

    def tables(self, blocks: Iterable[tuple[slice, ...]]) -> Iterator[Table]:
        """The points of some regions, one after the other.

        Args:
            blocks: In rising order.
        """
        known = self.known()
        return self.points.tables(blocks, [name for name in self.points.names if known[name].is_whole])

    def definition(self) -> dict[str, Any]:
        """All that its results depend on, for a file."""
        plain = dataclasses.asdict(self.setup)
        del plain["robot"]["description"]
        return {"laticauda": __version__, **plain, "points": self.points.definition()}


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
    with Store.open(folder, sweep, region_size=region_size, resume=resume) as store:
        tell = progress or _say_nothing
        tell(store.n_done, sweep.n_trials)
        pending = store.pending()
        with closing(_results(sweep, store.regions, pending, client, threads)) as results:
            for index, table, found in results:
                store.write(index, table, found)
                tell(store.n_done, sweep.n_trials)
    return open_sweep(folder)


def open_sweep(folder: str | Path) -> xarray.Dataset:
    """The results of a sweep, finished or not, read when they are used.

    A grid has a dimension per parameter, with the parameter's values; lists and samples have the dimension `trial`,
    and the parameters as coordinates along it. Points that are still to come are nan, and have not `succeeded`; the
    attributes `n_trials` and `n_finished` count them.

    Args:
        folder: As for `run_sweep`.

    Raises:
        ValueError: If the folder holds no sweep.
        MissingExtra: If zarr is not installed.
    """
    return open_dataset(folder)


def _say_nothing(done: int, total: int) -> None:
    """Stands for progress that nobody wants to know."""


def _results(
    sweep: Sweep, regions: Regions, pending: list[int], client: Any, threads: int | None
) -> Generator[tuple[int, Table, dict[str, Column]]]:
    """What the pending regions come to, in the order in which they are done."""
    tables = zip(pending, sweep.tables(regions.blocks(pending)), strict=True)
    if client is None:
        for index, table in tables:
            yield index, table, swim_points(sweep.setup, sweep.points.names, table, threads)
    else:
        from laticauda.studies.cluster import swim_on

        yield from swim_on(client, sweep.setup, sweep.points.names, tables)
