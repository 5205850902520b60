"""The checker behind the shapes: beartype, which takes an int where a float is asked for, as Python does.

jaxtyping's import hook puts its decorator `jaxtyped` on all functions of a module. That one binds
the arguments by `inspect` at every call, and checks them twice, 40 microseconds in all, half of the
time of tests that step a controller.
`shaped` stands in its place: the same checks, once, and a scope for the names of axes only where
there are any.

Of what one test calls over and over, the first `FIRST` calls of each function are checked, and then
those whose number is a power of two: a wrong shape is seldom right for long. LATICAUDA_CHECKS=all
checks every call.
"""

import dataclasses
import functools
import inspect
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import jaxtyping
from beartype import BeartypeConf, beartype
from beartype.roar import BeartypeCallHintViolation

check = beartype(conf=BeartypeConf(is_pep484_tower=True))
_scope = jaxtyping.jaxtyped
FIRST = 8
"""Calls of a function that are all checked in each test."""
_all = os.environ.get("LATICAUDA_CHECKS") == "all"
_calls: dict[int, int] = {}


def next_test() -> None:
    """Count the calls anew."""
    _calls.clear()


def _is_checked(key: int) -> bool:
    number = _calls[key] = _calls.get(key, 0) + 1
    return number <= FIRST or not number & (number - 1) or _all


def check_shapes(sources: Path, *others: str) -> None:
    """Have shapes checked in modules that are imported from now on: those in a folder of packages that state any.

    Modules that Numba compiles are left alone: the hook wraps functions, and Numba cannot compile
    the wrapper.

    Args:
        sources: The folder.
        others: Further modules.
    """
    texts = {path: path.read_text(encoding="utf-8") for path in sorted(sources.rglob("*.py"))}
    names = [
        ".".join(path.relative_to(sources).with_suffix("").parts).removesuffix(".__init__")
        for path, text in texts.items()
        if "from jaxtyping import" in text and "njit" not in text
    ]
    jaxtyping.jaxtyped = shaped  # what the hook's decorator is called by
    jaxtyping.install_import_hook([*names, *others], "typechecker.check")


def shaped(*, typechecker: Callable[..., Any]) -> Callable[[Any], Any]:
    """Decorator of a function, or of a class, whose `__init__` is meant if it is a dataclass's own.

    Args:
        typechecker: Decorator that makes a function check what it gets and gives.

    Values (`laticauda.values.quantities.value_class`) check their fields themselves, and make tuples of lists:
    only shapes are left.
    """

    def decorate(thing: Any) -> Any:
        if not inspect.isclass(thing):
            return _checked(thing, typechecker)
        if dataclasses.is_dataclass(thing) and "__init__" in vars(thing):
            is_value = (
                getattr(getattr(thing, "__post_init__", None), "__module__", "")
                == "laticauda.values.quantities"
            )
            if not is_value or _has_shapes(tuple(thing.__init__.__annotations__.values())):
                thing.__init__ = _checked(thing.__init__, typechecker)
        return thing

    return decorate


def _checked(function: Callable[..., Any], typechecker: Callable[..., Any]) -> Callable[..., Any]:
    key = id(function)

    @functools.cache
    def checking() -> Callable[..., Any]:
        """Return the function with its checks, made when it is first called: many never are."""
        return typechecker(function)

    if not _has_shapes(tuple(function.__annotations__.values())):

        @functools.wraps(function)
        def sometimes(*args: Any, **kwargs: Any) -> Any:
            __tracebackhide__ = True
            return (checking() if _is_checked(key) else function)(*args, **kwargs)

        return sometimes

    @functools.wraps(function)
    def scoped(*args: Any, **kwargs: Any) -> Any:
        __tracebackhide__ = True
        if not _is_checked(key) or jaxtyping.config.jaxtyping_disable:
            return function(*args, **kwargs)
        try:
            with _scope("context"):
                return checking()(*args, **kwargs)
        except BeartypeCallHintViolation as violation:
            raise jaxtyping.TypeCheckError(str(violation)) from violation

    return scoped


def _has_shapes(hint: Any) -> bool:
    """Whether an annotation, or one inside it, states a shape; a text may."""
    if isinstance(hint, str) or (
        inspect.isclass(hint) and issubclass(hint, jaxtyping.AbstractArray)
    ):
        return True
    return any(map(_has_shapes, hint if isinstance(hint, tuple | list) else get_args(hint)))
