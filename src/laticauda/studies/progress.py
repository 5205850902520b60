"""How studies tell how far they are."""

from collections.abc import Callable

Progress = Callable[[int, int], None]
"""Called now and then with the number of runs done, and of all."""


def silent(done: int, total: int) -> None:
    """Progress that nobody wants to know."""
