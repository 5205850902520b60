"""Run tasks on a Dask cluster; all use of dask is in this module.

Each task should be about a second of work, compared with a few milliseconds of scheduler overhead
per task. Only a few tasks per thread are in flight at a time, so neither the scheduler nor this
process ever holds all of them. Results return to this process, which alone writes files: workers
need no shared disk, nothing is written twice, and a worker that dies leaves nothing behind.

If a worker dies, the scheduler reassigns its tasks to others. If the scheduler goes away, the work
ends with an error.
"""

import logging
import queue
import socket
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from laticauda.values import ClusterFailed, LaticaudaError, __version__, optional_import

Result = TypeVar("Result")

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
"""Times that the workers of a task may die, each time after the scheduler's own attempts."""


@dataclass(frozen=True)
class _Task:
    """A call on its way through the cluster."""

    index: int
    """Index of the call."""
    arguments: tuple[Any, ...]
    """Its arguments."""
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


def count_threads(client: Any, hint: str = "") -> int:
    """Return the number of threads that a cluster has now.

    Args:
        client: A `dask.distributed.Client`.
        hint: What is left after a failure, and what to do, as a sentence for the error.

    Raises:
        ClusterFailed: If the scheduler went away.
    """
    return next(_watch_threads(client, hint))


def call_on(
    client: Any,
    work: Callable[..., Result],
    calls: Iterator[tuple[int, tuple[Any, ...]]],
    hint: str = "",
) -> Iterator[tuple[int, Result]]:
    """Call a function on the workers of a cluster, once for each tuple of arguments.

    Args:
        client: A `dask.distributed.Client`.
        work: The function, from a module that the workers have, too.
        calls: Index and arguments of every call, consumed as the work proceeds.
        hint: What is left after a failure, and what to do, as a sentence for the error.

    Yields:
        Index and result of a call, in order of completion.

    Raises:
        ClusterFailed: If the scheduler goes away, there is no worker for a minute, a call kills one
            worker after another, or workers have a different version of laticauda.
    """
    distributed = _import_distributed()
    tasks: dict[Any, _Task] = {}
    finished: queue.SimpleQueue[Any] = queue.SimpleQueue()
    thread_counts = _watch_threads(client, hint)

    def submit(task: _Task) -> None:
        key = f"{work.__name__}-{task.index}-{time.time_ns()}"  # never the key of another call
        arguments = (__version__, work, task.arguments)
        future = client.submit(_call_on_worker, *arguments, pure=False, key=key)
        tasks[future] = task
        future.add_done_callback(finished.put)

    def fill() -> None:
        most_tasks = max(1, TASKS_PER_THREAD * next(thread_counts))
        while len(tasks) < most_tasks:
            call = next(calls, None)
            if call is None:
                return
            index, arguments = call
            submit(_Task(index=index, arguments=arguments))

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
                result = future.result(timeout=RESULT_TIMEOUT)
            except TimeoutError:  # its worker died with the result, which is computed again
                finished.put(future)
            except distributed.KilledWorker as error:
                submit(_task_after_death(tasks.pop(future), error, hint))
            else:
                task = tasks.pop(future)
                yield task.index, result
    except LaticaudaError:
        raise
    except (OSError, distributed.CancelledError, RuntimeError) as error:
        raise ClusterFailed(_with_hint("the Dask scheduler went away.", hint)) from error
    except ImportError as error:
        message = f"the workers need laticauda {__version__}: {error}."
        raise ClusterFailed(_with_hint(message, hint)) from error
    finally:
        if tasks and client.status == "running":
            client.cancel(list(tasks), force=True)


def map_on(
    client: Any, work: Callable[..., Result], calls: Sequence[tuple[Any, ...]], hint: str = ""
) -> list[Result]:
    """Call a function on the workers of a cluster, and return all results in the order of the calls.

    Args:
        client: A `dask.distributed.Client`.
        work: The function, from a module that the workers have, too.
        calls: Arguments of every call.
        hint: What is left after a failure, and what to do, as a sentence for the error.

    Raises:
        ClusterFailed: As `call_on`.
    """
    result_of_call = dict(call_on(client, work, enumerate(calls), hint))
    return [result_of_call[index] for index in range(len(calls))]


def _task_after_death(task: _Task, error: Exception, hint: str) -> _Task:
    """Return the task to submit again after its workers died; raise if they died too often."""
    n_deaths = task.n_deaths + 1
    if n_deaths >= MOST_DEATHS:
        message = "workers keep dying on the same trials; do they have enough memory?"
        raise ClusterFailed(_with_hint(message, hint)) from error
    return replace(task, n_deaths=n_deaths)


def _watch_threads(client: Any, hint: str) -> Iterator[int]:
    """Yield the cluster's number of threads as long as there are a scheduler and workers."""
    had_worker_at = time.monotonic()
    while client.status == "running":
        n_threads = sum(client.nthreads().values())
        now = time.monotonic()
        if n_threads:
            had_worker_at = now
        if now - had_worker_at > NO_WORKER_TIMEOUT:
            message = (
                f"the cluster had no worker for {NO_WORKER_TIMEOUT:g} s; "
                "start some with `dask worker`."
            )
            raise ClusterFailed(_with_hint(message, hint))
        yield n_threads
    raise ClusterFailed(_with_hint("the Dask scheduler went away.", hint))


def _with_hint(message: str, hint: str) -> str:
    return f"{message} {hint}".rstrip()


def _call_on_worker(
    version: str, work: Callable[..., Result], arguments: tuple[Any, ...]
) -> Result:
    """Call a function with its arguments, if this worker has the version of the caller."""
    if version != __version__:
        raise ClusterFailed(
            f"the workers must have laticauda {version}, as this process does, got {__version__}."
        )
    return work(*arguments)


def _import_distributed() -> Any:
    return optional_import("A cluster", "dask", "scale", "distributed")
