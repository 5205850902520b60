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
from typing import Any

from laticauda import scenarios
from laticauda.errors import ClusterFailed, LaticaudaError, optional_import
from laticauda.packaging import __version__
from laticauda.studies.sweep import Column, Table, swim_points

Found = tuple[int, Table, dict[str, Column]]

AHEAD = 2  # tasks in flight per thread of the cluster, so that no thread waits for this process
PATIENCE = 60.0  # timeout with no worker at all [s]
FETCHING = 20.0  # timeout for a result of some hundred kilobytes [s]
GLANCE = 2.0  # interval between checks of the cluster's health [s]
CONNECTING = 10.0  # timeout [s]
MOST_DEATHS = 3  # of a region's workers, in rounds of the scheduler's own attempts
GO_ON = "Stored results are not lost: run the same again to continue."


def connect(address: str) -> Any:
    """Return a client of the Dask scheduler at an address; the caller closes it.

    Args:
        address: Address as printed by `dask scheduler`, such as tcp://host:8786.

    Raises:
        ClusterFailed: If no scheduler answers there.
        MissingExtra: If dask is not installed.
    """
    distributed = _distributed()
    try:
        # A client that cannot connect is slow to give up, and slower still to close.
        host = distributed.comm.get_address_host_port(distributed.comm.normalize_address(address))
        socket.create_connection(host, timeout=CONNECTING).close()
        return distributed.Client(address, timeout=CONNECTING, set_as_default=False)
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
        client.close(timeout=2)


def swim_on(
    client: Any,
    scenario: scenarios.Scenario,
    names: tuple[str, ...],
    tables: Iterator[tuple[int, Table]],
) -> Iterator[Found]:
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
    distributed = _distributed()
    under_way: dict[Any, tuple[int, Table, int]] = {}
    finished: queue.SimpleQueue[Any] = queue.SimpleQueue()
    n_threads = _counted(client)

    def submit(index: int, table: Table, deaths: int = 0) -> None:
        key = f"sweep-{index}-{time.time_ns()}"  # never the key of another call
        future = client.submit(_swim, __version__, scenario, names, table, pure=False, key=key)
        under_way[future] = (index, table, deaths)
        future.add_done_callback(finished.put)

    try:
        while True:
            most = max(1, AHEAD * next(n_threads))
            while len(under_way) < most:
                try:
                    submit(*next(tables))
                except StopIteration:
                    break
            if not under_way:
                return
            try:
                future = finished.get(timeout=GLANCE)
            except queue.Empty:
                continue
            try:
                found = future.result(timeout=FETCHING)
            except TimeoutError:  # its worker died with the result, which is computed again
                finished.put(future)
                continue
            except distributed.KilledWorker as error:
                index, table, deaths = under_way.pop(future)
                if deaths + 1 >= MOST_DEATHS:
                    raise ClusterFailed(
                        f"workers keep dying on the same trials; do they have enough memory? {GO_ON}"
                    ) from error
                submit(index, table, deaths + 1)
            else:
                index, table, _ = under_way.pop(future)
                yield index, table, found
    except LaticaudaError:
        raise
    except (OSError, distributed.CancelledError, RuntimeError) as error:
        raise ClusterFailed(f"the Dask scheduler went away. {GO_ON}") from error
    except ImportError as error:
        raise ClusterFailed(
            f"the workers need laticauda {__version__}: {error}. {GO_ON}"
        ) from error
    finally:
        if under_way and client.status == "running":
            client.cancel(list(under_way), force=True)


def _counted(client: Any) -> Iterator[int]:
    """Yield the current number of threads of the cluster as long as there are a scheduler and workers."""
    seen = time.monotonic()
    while client.status == "running":
        n_threads, now = sum(client.nthreads().values()), time.monotonic()
        seen = now if n_threads else seen
        if now - seen > PATIENCE:
            raise ClusterFailed(
                f"the cluster had no worker for {PATIENCE:g} s; start some with `dask worker`. {GO_ON}"
            )
        yield n_threads
    raise ClusterFailed(f"the Dask scheduler went away. {GO_ON}")


def _swim(
    version: str, scenario: scenarios.Scenario, names: tuple[str, ...], table: Table
) -> dict[str, Column]:
    """Simulate points on a worker, with one thread per task: a worker runs as many tasks as it has threads."""
    if version != __version__:
        raise ClusterFailed(
            f"the workers must have laticauda {version}, as this process does, got {__version__}."
        )
    return swim_points(scenario, names, table, threads=1)


def _distributed() -> Any:
    return optional_import("A sweep on a cluster", "dask", "scale", "distributed")
