"""Events of pages: what users do with the controls, handled one at a time in the order of arrival."""

import functools
import logging
import threading
from collections.abc import Callable, Coroutine, Iterable
from queue import SimpleQueue
from typing import Any, NamedTuple, TypeVar

from laticauda.scenarios import telling
from laticauda.values import LaticaudaError

NOTE_DURATION = 12.0
"""How long a page shows why something was refused [s]."""
CLOSING_TIME = 5.0
"""How long closing waits for the events that are left [s]."""
MOST_WAITING = 1000
"""Events that wait at most; those of a page that sends more are dropped, and it is shown the values that hold."""
Owner = TypeVar("Owner")


class Event(NamedTuple):
    """Action of a user on a page."""

    client: Any
    """The page."""
    target: Any
    """The control."""
    value: Any
    """Value to which the control was set; it may have been changed since."""


Action = Callable[[Event], None]
Update = Callable[[], None]
"""Brings all pages up to date."""


def show_refusal(page: Any, reason: str) -> None:
    """Show on a page why something is refused."""
    page.add_notification("Refused", reason, color="red", auto_close_seconds=NOTE_DURATION)


def show_doubts(page: Any, doubts: Iterable[str]) -> None:
    """Show on a page what was accepted and is hardly meant."""
    for doubt in doubts:
        page.add_notification(
            "Is this meant?", doubt, color="yellow", auto_close_seconds=NOTE_DURATION
        )


def refusing(action: Callable[[Owner, Any], None]) -> Callable[[Owner, Any], None]:
    """Wrap a method that handles an event, so that its errors are shown on the page from which the event came."""

    @functools.wraps(action)
    def act_or_refuse(owner: Owner, event: Any) -> None:
        doubts: list[str] = []
        try:
            with telling(doubts.append):
                action(owner, event)
        except (ValueError, LaticaudaError) as error:
            show_refusal(event.client, str(error))
        show_doubts(event.client, doubts)

    return act_or_refuse


def read_value(event: Any) -> Any:
    """Return the value of the control of viser's event."""
    return event.target.value


class QueuedEvent(NamedTuple):
    """An event that waits for its turn."""

    action: Action
    """Handles it."""
    update: Update | None
    """Called afterwards, if anything."""
    event: Event


class EventQueue:
    """A thread that handles events from pages.

    viser handles events in a pool of threads: two events of a slider that is being dragged may
    overtake each other, and both then read the slider's latest value. Here, values are read on
    arrival, and events are handled one at a time.
    """

    def __init__(self) -> None:
        self._queue: SimpleQueue[QueuedEvent | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="cockpit-events", daemon=True)
        self._thread.start()

    def handler(
        self,
        action: Action,
        *,
        then: Update | None = None,
        read: Callable[[Any], Any] = read_value,
    ) -> Callable[[Any], Coroutine[Any, Any, None]]:
        """Return the function that viser calls with an event.

        Args:
            action: Handles the event.
            then: Called afterwards, once for all waiting events, to update the pages. Updating them
                in between would reset a control that a user is still moving.
            read: Reads the value of the event.
        """

        # The server awaits it, so that events stay in order.
        async def enqueue(viser_event: Any) -> None:
            if viser_event.client is None:
                return  # the program itself set the control
            if self._queue.qsize() >= MOST_WAITING:
                return
            event = Event(viser_event.client, viser_event.target, read(viser_event))
            self._queue.put(QueuedEvent(action, then, event))

        return enqueue

    def close(self) -> None:
        """Handle the waiting events, and end the thread."""
        self._queue.put(None)
        self._thread.join(CLOSING_TIME)

    def _run(self) -> None:
        """Handle events until there is a None; update the pages whenever no event waits."""
        due_updates: dict[Update, None] = {}
        while True:
            queued = self._queue.get()
            if queued is None:
                break
            _call_guarded(functools.partial(queued.action, queued.event))
            if queued.update is not None:
                due_updates[queued.update] = None
            while due_updates and self._queue.empty():
                update, _ = due_updates.popitem()
                _call_guarded(update)
        for update in due_updates:
            _call_guarded(update)


def _call_guarded(function: Callable[[], None]) -> None:
    """Call a function and log its errors: a bug, or a value that no page sends, must not disable the controls."""
    try:
        function()
    except Exception as error:
        message = f"A control of the cockpit failed: {error!r:.200}"
        logging.getLogger(__name__).error("%s", message)
