"""Run a sweep on a Dask cluster; all use of dask is in this module.

Each region is one task: about a second of work, compared with a few milliseconds of scheduler
overhead per task. Only a few tasks per thread are in flight at a time, so neither the scheduler nor
this process ever holds the whole sweep. Results return to this process, which alone writes the
folder: workers need no shared disk, nothing is written twice, and a worker that dies leaves nothing
behind. Results are small, about fifty bytes per trial.

If a worker dies, the scheduler reassigns its tasks to others. If the scheduler goes away, the sweep
ends with an error; stored results are kept, and the next call continues from there.
"""

import logging
import queue
import socket
import time
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from laticauda import scenarios
from laticauda.studies.point_trials import Column, swim_points
from laticauda.studies.sampling import Table
from laticauda.values import ClusterFailed, LaticaudaError, __version__, optional_import

TASKS_PER_THREAD = 2
"""Tasks in flight per thread of the cluster, so that no thread waits for this process."""
NO_WORKER_TIMEOUT = 60.0
"""Time that the cluster may have no worker at all [s]."""
RESULT_TIMEOUT = 20.0
"""Time that a result of some hundred kilobytes may take [s]."""
HEALTH_INTERVAL = 2.0
"""Time between checks of the cluster's health [s]."""
CONNECT_TIMEOUT = 10.0
"""Time that the scheduler may take to answer [s]."""
CLOSE_TIMEOUT = 2.0
"""Time that is given to closing the client [s]."""
MOST_DEATHS = 3
"""Times that the workers of a region may die, each time after the scheduler's own attempts."""
GO_ON = "Stored results are not lost: run the same again to continue."


@dataclass(frozen=True)
class _Task:
    """A region on its way through the cluster."""

    index: int
    """Index of the region."""
    table: Table
    """Its points."""
    n_deaths: int = 0
    """How often the scheduler gave it up because its workers died."""


def connect(address: str) -> Any:
    """Return a client of the Dask scheduler at an address; the caller closes it.

    Args:
        address: Address as printed by `dask scheduler`, such as tcp://host:8786.

    Raises:
        ClusterFailed: If no scheduler answers there.
        MissingExtra: If dask is not installed.
    """
    distributed = _import_distributed()
    try:
        # A client that cannot connect is slow to give up, and slower still to close.
        full_address = distributed.comm.normalize_address(address)
        host_and_port = distributed.comm.get_address_host_port(full_address)
        socket.create_connection(host_and_port, timeout=CONNECT_TIMEOUT).close()
        return distributed.Client(address, timeout=CONNECT_TIMEOUT, set_as_default=False)
    except (OSError, ValueError, RuntimeError) as error:
        raise ClusterFailed(
            f"no Dask scheduler answers at {address}; is it running, and is it reachable?"
        ) from error


@contextmanager
def connected(address: str | None) -> Generator[Any]:
    """Provide a client of a cluster while it is needed.

    Args:
        address: Address of the scheduler as printed by `dask scheduler`, such as tcp://host:8786;
            None: there is no cluster, and None is provided instead of a client.
    """
    if address is None:
        yield None
        return
    # Its log messages about a lost scheduler are long, and our own error says the same.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    client = connect(address)
    try:
        yield client
    finally:
        client.close(timeout=CLOSE_TIMEOUT)


def swim_on(
    client: Any,
    scenario: scenarios.Scenario,
    names: tuple[str, ...],
    tables: Iterator[tuple[int, Table]],
) -> Iterator[tuple[int, Table, dict[str, Column]]]:
    """Simulate the points of some regions on the workers of a cluster.

    Args:
        client: A `dask.distributed.Client`.
        scenario: What all trials share.
        names: Names of the parameters.
        tables: Index and points of every region, consumed as the work proceeds.

    Yields:
        Index, points and results of a region, in order of completion.

    Raises:
        ClusterFailed: If the scheduler goes away, there is no worker for a minute, a region kills
            one worker after another, or workers have a different version of laticauda.
    """
    distributed = _import_distributed()
    tasks: dict[Any, _Task] = {}
    finished: queue.SimpleQueue[Any] = queue.SimpleQueue()
    thread_counts = _watch_threads(client)

    def submit(task: _Task) -> None:
        key = f"sweep-{task.index}-{time.time_ns()}"  # never the key of another call
        arguments = (__version__, scenario, names, task.table)
        future = client.submit(_swim_on_worker, *arguments, pure=False, key=key)
        tasks[future] = task
        future.add_done_callback(finished.put)

    def fill() -> None:
        most_tasks = max(1, TASKS_PER_THREAD * next(thread_counts))
        while len(tasks) < most_tasks:
            region = next(tables, None)
            if region is None:
                return
            index, table = region
            submit(_Task(index=index, table=table))

    try:
        while True:
            fill()
            if not tasks:
                return
            try:
                future = finished.get(timeout=HEALTH_INTERVAL)
            except queue.Empty:
                continue
            try:
                results = future.result(timeout=RESULT_TIMEOUT)
            except TimeoutError:  # its worker died with the result, which is computed again
                finished.put(future)
            except distributed.KilledWorker as error:
                submit(_task_after_death(tasks.pop(future), error))
            else:
                task = tasks.pop(future)
                yield task.index, task.table, results
    except LaticaudaError:
        raise
    except (OSError, distributed.CancelledError, RuntimeError) as error:
        raise ClusterFailed(f"the Dask scheduler went away. {GO_ON}") from error
    except ImportError as error:
        raise ClusterFailed(
            f"the workers need laticauda {__version__}: {error}. {GO_ON}"
        ) from error
    finally:
        if tasks and client.status == "running":
            client.cancel(list(tasks), force=True)


def swim_points_on(
    client: Any, scenario: scenarios.Scenario, names: tuple[str, ...], table: Table
) -> dict[str, Column]:
    """Simulate the trials of some points on the workers of a cluster, in pieces for all of its threads.

    Args:
        client: A `dask.distributed.Client`.
        scenario: What all trials share.
        names: Names of the parameters, one per column of the table.
        table: The points, one per row.

    Returns:
        As `swim_points` does in this process, to the same bits (on processors of one kind).

    Raises:
        ClusterFailed: As `swim_on`.
    """
    n_pieces = min(len(table), TASKS_PER_THREAD * next(_watch_threads(client)))
    pieces = np.array_split(table, max(n_pieces, 1))
    results_of_piece = {
        index: results for index, _, results in swim_on(client, scenario, names, enumerate(pieces))
    }
    in_order = [results_of_piece[index] for index in range(len(pieces))]
    joined: dict[str, Column] = {}
    for name in in_order[0]:
        columns = [results[name] for results in in_order]
        joined[name] = np.concatenate(columns)
    return joined


def _task_after_death(task: _Task, error: Exception) -> _Task:
    """Return the task to submit again after its workers died; raise if they died too often."""
    n_deaths = task.n_deaths + 1
    if n_deaths >= MOST_DEATHS:
        raise ClusterFailed(
            f"workers keep dying on the same trials; do they have enough memory? {GO_ON}"
        ) from error
    return _Task(index=task.index, table=task.table, n_deaths=n_deaths)


def _watch_threads(client: Any) -> Iterator[int]:
    """Yield the cluster's number of threads as long as there are a scheduler and workers."""
    had_worker_at = time.monotonic()
    while client.status == "running":
        n_threads = sum(client.nthreads().values())
        now = time.monotonic()
        if n_threads:
            had_worker_at = now
        if now - had_worker_at > NO_WORKER_TIMEOUT:
            raise ClusterFailed(
                f"the cluster had no worker for {NO_WORKER_TIMEOUT:g} s; "
                f"start some with `dask worker`. {GO_ON}"
            )
        yield n_threads
    raise ClusterFailed(f"the Dask scheduler went away. {GO_ON}")


def _swim_on_worker(
    version: str, scenario: scenarios.Scenario, names: tuple[str, ...], table: Table
) -> dict[str, Column]:
    """Simulate points with one thread: a worker runs as many tasks as it has threads."""
    if version != __version__:
        raise ClusterFailed(
            f"the workers must have laticauda {version}, as this process does, got {__version__}."
        )
    return swim_points(scenario, names, table, threads=1)


def _import_distributed() -> Any:
    return optional_import("A cluster", "dask", "scale", "distributed")
