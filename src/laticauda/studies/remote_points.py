"""Trials of studies on the workers of a Dask cluster: region by region, or one generation at once.

Each region is one task. A region's results are small, about fifty bytes per trial.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from laticauda import scenarios
from laticauda.models.simulate import cluster
from laticauda.studies.point_trials import Column, swim_points
from laticauda.studies.sampling import Table

GO_ON = "Stored results are not lost: run the same again to continue."
"""What is left of a study when its cluster fails."""


def swim_on(
    client: Any,
    scenario: scenarios.Scenario,
    names: tuple[str, ...],
    tables: Iterator[tuple[int, Table]],
    *,
    loads: bool = False,
) -> Iterator[tuple[int, Table, dict[str, Column]]]:
    """Simulate the points of some regions on the workers of a cluster.

    Args:
        client: A `dask.distributed.Client`.
        scenario: What all trials share.
        names: Names of the parameters.
        tables: Index and points of every region, consumed as the work proceeds.
        loads: Whether to compute the figures of what joints carry, too.

    Yields:
        Index, points and results of a region, in order of completion.

    Raises:
        ClusterFailed: If the scheduler goes away, there is no worker for a minute, a region kills
            one worker after another, or workers have a different version of laticauda.
    """
    table_in_flight: dict[int, Table] = {}

    def calls() -> Iterator[tuple[int, tuple[Any, ...]]]:
        for index, table in tables:
            table_in_flight[index] = table
            yield index, (scenario, names, table, loads)

    for index, results in cluster.call_on(client, swim_points_singly, calls(), GO_ON):
        yield index, table_in_flight.pop(index), results


def swim_points_on(
    client: Any,
    scenario: scenarios.Scenario,
    names: tuple[str, ...],
    table: Table,
    *,
    loads: bool = False,
) -> dict[str, Column]:
    """Simulate the trials of some points on the workers of a cluster, in pieces for all of its threads.

    Args:
        client: A `dask.distributed.Client`.
        scenario: What all trials share.
        names: Names of the parameters, one per column of the table.
        table: The points, one per row.
        loads: Whether to compute the figures of what joints carry, too.

    Returns:
        As `swim_points` does in this process, to the same bits (on processors of one kind).

    Raises:
        ClusterFailed: If the scheduler goes away, there is no worker for a minute, a region kills
            one worker after another, or workers have a different version of laticauda.
    """
    pieces = _split_table(table, cluster.count_threads(client, GO_ON))
    calls = [(scenario, names, piece, loads) for piece in pieces]
    results_of_pieces = cluster.map_on(client, swim_points_singly, calls, GO_ON)
    joined: dict[str, Column] = {}
    for name in results_of_pieces[0]:
        columns = [results[name] for results in results_of_pieces]
        joined[name] = np.concatenate(columns)
    return joined


def _split_table(table: Table, n_threads: int) -> list[Table]:
    """Return the points of each task, so many that no thread of the cluster waits for others."""
    most_pieces = cluster.TASKS_PER_THREAD * n_threads
    n_pieces = min(len(table), most_pieces)
    return np.array_split(table, max(n_pieces, 1))


def swim_points_singly(
    scenario: scenarios.Scenario,
    names: tuple[str, ...],
    table: Table,
    loads: bool,
) -> dict[str, Column]:
    """Simulate points with one thread: a worker runs as many tasks as it has threads.

    Args:
        scenario: What all trials share.
        names: Names of the parameters, one per column of the table.
        table: The points, one per row.
        loads: Whether to compute the figures of what joints carry, too.
    """
    return swim_points(scenario, names, table, threads=1, loads=loads)
