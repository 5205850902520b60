"""What people do on pages: answered one after the other, in the order in which it came."""

import functools
import logging
import threading
from collections.abc import Callable, Coroutine
from queue import SimpleQueue
from typing import Any, NamedTuple, TypeVar

from laticauda.errors import LaticaudaError

Owner = TypeVar("Owner")


class Event(NamedTuple):
    """What somebody did on a page."""

    client: Any
    """The page."""
    target: Any
    """The control."""
    value: Any
    """What it was set to then; by now somebody may have set it to something else."""


Action = Callable[[Event], None]


def refusing(action: Callable[[Owner, Any], None]) -> Callable[[Owner, Any], None]:
    """A method that answers an event: what it refuses is said on the page where the event comes from."""

    @functools.wraps(action)
    def answered(owner: Owner, event: Any) -> None:
        try:
            action(owner, event)
        except (ValueError, LaticaudaError) as error:
            event.client.add_notification("Refused", str(error), color="red", auto_close_seconds=12.0)

    return answered


class EventQueue:
    """A thread that answers what comes from pages.

    viser answers in a pool of threads: two answers to a slider that is being dragged may overtake each other, and both
    read what the slider shows by then. Here the value is taken as it comes, and one is answered after the other.
    """

    def __init__(self) -> None:
        self._waiting: SimpleQueue[tuple[Action, Callable[[], None] | None, Event] | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="cockpit-events", daemon=True)
        self._thread.start()

    def handler(
        self,
        action: Action,
        *,
        then: Callable[[], None] | None = None,
        read: Callable[[Any], Any] = lambda event: event.target.value,
    ) -> Callable[[Any], Coroutine[Any, Any, None]]:
        """What viser calls with an event.

        Args:
            action: The answer.
            then: What is to be done after it, once for all that waits: bring the pages up to date. To do so in between
                would set a control back that somebody is about to set further.
            read: The value of the event.
        """

        async def enqueue(event: Any) -> None:  # the server waits for it, so events come in their order
            if event.client is not None:  # else the program itself has set the control
                self._waiting.put((action, then, Event(event.client, event.target, read(event))))

        return enqueue

    def close(self) -> None:
        """Answer what waits, and end."""
        self._waiting.put(None)
        self._thread.join(5.0)

    def _run(self) -> None:
        owed: dict[Callable[[], None], None] = {}
        while (waiting := self._waiting.get()) is not None:
            action, then, event = waiting
            _guarded(functools.partial(action, event))
            if then is not None:
                owed[then] = None
            while owed and self._waiting.empty():
                _guarded(owed.popitem()[0])
        for then in owed:
            _guarded(then)


def _guarded(call: Callable[[], None]) -> None:
    """A fault of ours must not leave the controls dead."""
    try:
        call()
    except Exception:
        logging.getLogger(__name__).exception("A control of the cockpit failed.")
