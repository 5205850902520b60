"""A figure of a run, declared once: its unit, its title and its definition."""

from collections.abc import Callable
from typing import Any, Self, overload


class Figure:
    """One figure of a run: a property of `Trial`, worked out once, that tables show with its unit and title.

    Args:
        unit: Its unit; "" for a pure number.
        title: What it is, in a few words.
        of: The figure of a trial; it raises a ValueError that says why there is none.
    """

    def __init__(self, unit: str, title: str, of: Callable[[Any], float]) -> None:
        self.name = ""
        self.unit, self.title, self._of = unit, title, of
        self.__doc__ = f"{title[0].upper()}{title[1:]} [{unit or '-'}]."

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, trial: None, owner: type) -> Self: ...
    @overload
    def __get__(self, trial: object, owner: type) -> float: ...
    def __get__(self, trial: object, owner: type) -> Self | float:
        if trial is None:
            return self
        found = vars(trial)[self.name] = float(self._of(trial))  # found there from now on
        return found
