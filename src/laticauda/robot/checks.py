"""Checks that the dataclasses of this package share, on top of those of `laticauda.errors`."""

from collections.abc import Callable, Sequence
from typing import Any, cast

from laticauda.errors import finite, instance


def settle(owner: object, check: Callable[[str, object, str], float], unit: str, *names: str) -> None:
    """Replace fields of a frozen dataclass by what `check` returns for them.

    Only for `__post_init__`. A field that is None stays None: whether it may be is for its annotation to say.
    """
    for name in names:
        value: Any = getattr(owner, name)
        if value is not None:
            put(owner, name, check(name, value, unit))


def settle_required(owner: object, check: Callable[[str, object, str], float], unit: str, *names: str) -> None:
    """As `settle`, for fields that must be there: None is refused like any other wrong value."""
    for name in names:
        put(owner, name, check(name, getattr(owner, name), unit))


def put(owner: object, name: str, value: object) -> None:
    """Set a field of a frozen dataclass while it is being made."""
    object.__setattr__(owner, name, value)


def items(name: str, value: object, kind: type) -> tuple[Any, ...]:
    """`value` as a tuple of objects of class `kind`.

    Raises:
        ValueError: If `value` is no list or tuple, or holds anything else.
    """
    if not isinstance(value, list | tuple):
        raise ValueError(f"`{name}` must be a tuple of {kind.__name__}, got {type(value).__name__}.")
    found = cast("Sequence[object]", value)
    for i, item in enumerate(found):
        instance(f"{name}[{i}]", item, kind)
    return tuple(found)


def pair(name: str, value: object, unit: str) -> tuple[float, float]:
    """`value` as two finite floats.

    Raises:
        ValueError: If `value` is no sequence of two finite numbers.
    """
    if isinstance(value, str) or not hasattr(value, "__len__") or not hasattr(value, "__getitem__"):
        raise ValueError(f"`{name}` must be two numbers (x, y) in {unit}, got {value!r}.")
    sequence: Any = value
    if len(sequence) != 2:
        raise ValueError(f"`{name}` must be two numbers (x, y) in {unit}, got {len(sequence)} of them.")
    return finite(f"{name}[0]", sequence[0], unit), finite(f"{name}[1]", sequence[1], unit)


def flag(name: str, value: object) -> bool:
    """`value` if it is true or false, and nothing that merely looks like it."""
    if not isinstance(value, bool):
        raise ValueError(f"`{name}` must be true or false, got {value!r}.")
    return value


def text(name: str, value: object) -> str:
    """`value` if it is a text."""
    if not isinstance(value, str):
        raise ValueError(f"`{name}` must be a text, got {value!r}.")
    return value


def label(name: str, value: object) -> str:
    """`value` if it can serve as a name: a text that is not blank and stays on one line."""
    word = text(name, value)
    if not word.strip() or not word.isprintable():
        raise ValueError(f"`{name}` must be a text on one line that is not blank, got {word!r}.")
    return word
