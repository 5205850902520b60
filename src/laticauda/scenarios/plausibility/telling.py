"""Who hears of a doubt: whoever listens, such as the client of a server, or else Python's warnings."""

from collections.abc import Callable, Generator
from contextlib import contextmanager
from contextvars import ContextVar

from laticauda.values import ImplausibleWarning, warn_caller

_LISTENER: ContextVar[Callable[[str], object] | None] = ContextVar("listener", default=None)


@contextmanager
def telling(listener: Callable[[str], object]) -> Generator[None]:
    """Tell a function of what hardly is, in this block and this thread, instead of warning.

    Args:
        listener: Called with each sentence.
    """
    token = _LISTENER.set(listener)
    try:
        yield
    finally:
        _LISTENER.reset(token)


def warn_of_doubt(sentence: str) -> None:
    """Warn of something that hardly is, or tell whoever listens.

    Args:
        sentence: What is odd, and what was probably meant.
    """
    listener = _LISTENER.get()
    if listener is None:
        warn_caller(sentence, ImplausibleWarning)
    else:
        listener(sentence)
