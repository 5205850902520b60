"""What pages ask for, done one after the other, in the order in which it came."""

import logging
import threading
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from queue import SimpleQueue
from typing import Any


@dataclass(frozen=True, kw_only=True, eq=False)
class Asked:
    """What somebody did on a page."""

    client: Any
    """The page."""
    target: Any
    """The control."""
    value: Any
    """What it was set to then; by now somebody may have set it to something else."""


Act = Callable[[Asked], None]
Turn = tuple[Act, Callable[[], None] | None, Asked]


class Turns:
    """A thread that does what pages ask for.

    viser answers what comes from a page in a pool of threads: two answers to a slider that is being dragged may
    overtake each other, and both read what the slider shows by then. Here the value is taken as it comes, and one is
    done after the other.
    """

    def __init__(self) -> None:
        self._waiting: SimpleQueue[Turn | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="cockpit-turns", daemon=True)
        self._thread.start()

    def hear(
        self,
        act: Act,
        *,
        then: Callable[[], None] | None = None,
        read: Callable[[Any], Any] = lambda event: event.target.value,
    ) -> Callable[[Any], Coroutine[Any, Any, None]]:
        """What an event of the page is answered with.

        Args:
            act: What is to be done.
            then: What is to be done after it, once for all that waits: bring the pages up to date. To do so in between
                would set a control back that somebody is about to set further.
            read: The value of the event.
        """

        async def come(event: Any) -> None:  # the server waits for it, so events come in their order
            if event.client is not None:  # else the program itself has set the control
                self._waiting.put((act, then, Asked(client=event.client, target=event.target, value=read(event))))

        return come

    def close(self) -> None:
        """Do what waits, and end."""
        self._waiting.put(None)
        self._thread.join(5.0)

    def _run(self) -> None:
        owed: dict[Callable[[], None], None] = {}
        while (turn := self._waiting.get()) is not None:
            act, then, asked = turn
            _guarded(lambda act=act, asked=asked: act(asked))
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
