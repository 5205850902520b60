"""A law that owns its numbers: a value whose fields are the numbers and whose `__call__` is the formula.

Python calls the law itself. Kernels compile the formula once per class (`laticauda.compiling.formulas`), with a record
of rows in the place of `self`: the fields have the same names there, and every trial that runs beside others, every
derivative has its own values of them. So a formula sees its own fields, which are numbers or truth values, but no
methods or properties; what it calls are plain functions beside the class.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from laticauda.errors import BadArgument
from laticauda.extensions import name_of
from laticauda.quantities import hints_of, quantities_of

MOST_NUMBERS = 16
"""That a law may have."""


@dataclass(frozen=True, kw_only=True)
class Formula:
    """What kernels compile of a law."""

    name: str
    """Of the law."""
    function: Callable[..., Any]
    """`__call__` of its class, with whatever has the fields in the place of `self`."""
    fields: tuple[str, ...]
    """Names of its numbers, in the order of their rows."""


class Law:
    """Mixin of laws: values whose numbers are rows of the kernels, and whose `__call__` they compile."""

    @property
    def formula(self) -> Formula:
        """What kernels compile of it.

        Raises:
            ValueError: If its class cannot be compiled.
        """
        return _formula(type(self))

    @property
    def numbers(self) -> tuple[float, ...]:
        """The values of its numbers; a truth value is 1 or 0."""
        return tuple(float(getattr(self, name)) for name in self.formula.fields)

    @property
    def words(self) -> str:
        """What it is, for people: its name and its numbers with their units."""
        units = {name: one.unit for name, one in quantities_of(type(self)).items()}  # pyright: ignore[reportArgumentType]
        told = [f"{name} {float(getattr(self, name)):g} {units.get(name, '')}".rstrip() for name in self.formula.fields]
        return ", ".join([name_of(type(self)).replace("-", " "), *told])


class OfFunction(Law):
    """Mixin of laws that are a plain `function`; what it closes over is compiled into it.

    They have no numbers that could be swept or identified, and no file can say what they are: write a class for that.
    """

    function: Callable[..., Any]
    """It takes what the law takes."""

    @property
    def formula(self) -> Formula:
        """The function, which has no numbers."""
        function: Any = getattr(self.function, "py_func", self.function)
        if not hasattr(function, "__code__"):
            raise BadArgument("function", f"must be a plain Python function, got {function!r}")

        def call(law: Any, *given: Any) -> Any:
            return function(*given)

        call.__module__ = function.__module__
        return Formula(name=function.__name__, function=call, fields=())

    @property
    def words(self) -> str:
        """The function's name."""
        return self.function.__name__


@cache
def _formula(kind: type[Any]) -> Formula:
    hints = hints_of(kind)
    for name, hint in hints.items():
        if hint not in (float, bool, int):
            raise BadArgument(name, f"of {kind.__name__} must be a number: another formula is another class")
    if len(hints) > MOST_NUMBERS:
        raise ValueError(f"`{kind.__name__}` must have at most {MOST_NUMBERS} numbers, got {len(hints)}.")
    return Formula(name=kind.__name__, function=kind.__call__, fields=tuple(hints))
