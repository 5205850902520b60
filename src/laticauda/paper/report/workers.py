"""Run the studies one after the other, or divided among worker processes.

Workers report their progress in a queue, and a thread of this process passes it on. If this process
ends, its workers do so as well: nobody waits for the work of a program that was killed.
"""

import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import active_children, get_context, parent_process, resource_tracker
from threading import Thread
from typing import Any, TypeVar

from laticauda.values import defer_interrupts

Outcome = TypeVar("Outcome")
Progress = Callable[[str, int, int], None]
"""Function that is called with the current activity, the amount done and the total."""
_END = None
"""Message that ends the thread which passes on the progress."""


def run_studies(
    run_study: Callable[[str, Progress], Outcome],
    names: Sequence[str],
    n_workers: int,
    progress: Progress,
) -> dict[str, Outcome]:
    """Run all studies and return their outcomes by name; the first error ends them.

    Args:
        run_study: Function that runs the study of a name, which workers can import.
        names: Names of the studies.
        n_workers: Number of processes at most [-].
        progress: Called from time to time.
    """
    n_workers = min(n_workers, len(names))
    if n_workers == 1:
        return {name: run_study(name, progress) for name in names}
    return _run_in_workers(run_study, names, n_workers, progress)


def _run_in_workers(
    run_study: Callable[[str, Progress], Outcome],
    names: Sequence[str],
    n_workers: int,
    progress: Progress,
) -> dict[str, Outcome]:
    context = get_context("spawn")  # the only start method that is safe everywhere
    if os.name == "posix":
        _start_resource_tracker()
    queue = context.SimpleQueue()
    listener = Thread(target=_pass_on_progress, args=(queue, progress), daemon=True)
    listener.start()
    children_before = set(active_children())
    outcomes: dict[str, Outcome] = {}
    with ProcessPoolExecutor(
        n_workers, mp_context=context, initializer=_prepare_worker, initargs=(queue,)
    ) as pool:
        with defer_interrupts():  # this process ends them
            name_of_future = {pool.submit(run_study, name, _report): name for name in names}
        try:
            for future in as_completed(name_of_future):
                outcomes[name_of_future[future]] = future.result()
        except BaseException:
            for worker in set(active_children()) - children_before:
                worker.terminate()  # its files are complete or not in place
            raise
        queue.put(_END)
        listener.join()
    return outcomes


def _start_resource_tracker() -> None:
    """Start the process that removes what workers share if this one is killed, silently."""
    # The warning options are passed on to the process.
    sys.warnoptions.append("ignore::UserWarning:multiprocessing.resource_tracker")
    try:
        resource_tracker.ensure_running()
    finally:
        sys.warnoptions.pop()


def _pass_on_progress(queue: Any, progress: Progress) -> None:
    """Pass on the progress that workers report, until the end is signaled."""
    while True:
        message = queue.get()
        if message is _END:
            return
        progress(*message)


# ---- in a worker ---------------------------------------------------------------------------------

_queue: Any = None
"""Queue in which a worker reports its progress."""


def _prepare_worker(queue: Any) -> None:
    global _queue
    _queue = queue
    Thread(target=_end_with_parent, args=(parent_process(),), daemon=True).start()


def _end_with_parent(parent: Any) -> None:
    """Exit when the parent ends: nobody waits for the work of a program that was killed."""
    parent.join()
    os._exit(1)


def _report(activity: str, n_done: int, n_total: int) -> None:
    _queue.put((activity, n_done, n_total))
