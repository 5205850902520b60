"""Laws with parameters: values whose fields are the numbers and whose `__call__` is the formula.

Python calls the law itself. Kernels compile the formula once per class
(`laticauda.compiling.formulas`), with a record of rows in place of `self`: its fields have the same
names, and each of several trials in parallel, and each derivative, has its own values of them. A
formula therefore has access to its own fields, which are numbers or truth values, but not to
methods or properties; it may call plain functions defined outside the class.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from laticauda.values.errors import BadArgument
from laticauda.values.extensions import name_of
from laticauda.values.quantities import hints_of, quantities_of

MOST_NUMBERS = 16
"""Maximum number of parameters of a law."""


@dataclass(frozen=True, kw_only=True)
class Formula:
    """The part of a law that kernels compile."""

    name: str
    """Name of the law."""
    function: Callable[..., Any]
    """`__call__` of its class, called with any object that has the fields in place of `self`."""
    fields: tuple[str, ...]
    """Names of its numbers, in the order of their rows."""

    @property
    def is_own(self) -> bool:
        """Whether it is laticauda's own, which is known to compile and does not change while a program runs."""
        return self.function.__module__.startswith("laticauda.")


class Law:
    """Mixin of laws: values whose numbers are rows of the kernels, and whose `__call__` the kernels compile."""

    @property
    def formula(self) -> Formula:
        """The part of the law that kernels compile.

        Raises:
            ValueError: If its class cannot be compiled.
        """
        return _formula(type(self))

    @property
    def numbers(self) -> tuple[float, ...]:
        """Values of its fields; a truth value is 1 or 0."""
        return tuple(float(getattr(self, name)) for name in self.formula.fields)

    @property
    def words(self) -> str:
        """Description for people: its name and its numbers with their units."""
        quantities = quantities_of(type(self))  # pyright: ignore[reportArgumentType]
        parts = [name_of(type(self)).replace("-", " ")]
        for name in self.formula.fields:
            unit = quantities[name].unit if name in quantities else ""
            parts.append(f"{name} {float(getattr(self, name)):g} {unit}".rstrip())
        return ", ".join(parts)


class OfFunction(Law):
    """Mixin of laws that are a plain `function`; the variables that it closes over are compiled into it.

    Such laws have no numbers to be swept or identified, and cannot be stored in files: write a
    class for that.
    """

    function: Callable[..., Any]
    """Function with the same arguments as the law."""

    @property
    def formula(self) -> Formula:
        """The function, which has no numbers."""
        function: Any = getattr(self.function, "py_func", self.function)
        if not hasattr(function, "__code__"):
            raise BadArgument("function", f"must be a plain Python function, got {function!r}")

        def call(law: Any, *numbers: Any) -> Any:
            return function(*numbers)

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
            raise BadArgument(
                name,
                f"of {kind.__name__} must be a number; write another class for another formula",
            )
    if len(hints) > MOST_NUMBERS:
        raise ValueError(
            f"`{kind.__name__}` must have at most {MOST_NUMBERS} numbers, got {len(hints)}."
        )
    return Formula(name=kind.__name__, function=kind.__call__, fields=tuple(hints))
