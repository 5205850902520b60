"""The checker behind the shapes: beartype, which takes an int where a float is asked for, as Python does.

jaxtyping's import hook puts its decorator `jaxtyped` on all functions of a module. That one binds the arguments by
`inspect` at every call, and checks them twice, 40 microseconds in all, half of the time of tests that step a
controller.
`shaped` stands in its place: the same checks, once, and a scope for the names of axes only where there are any.
"""

import dataclasses
import functools
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import jaxtyping
from beartype import BeartypeConf, beartype
from beartype.roar import BeartypeCallHintViolation

check = beartype(conf=BeartypeConf(is_pep484_tower=True))
_scope = jaxtyping.jaxtyped


def check_shapes(sources: Path, *others: str) -> None:
    """Have shapes checked in modules that are imported from now on: those in a folder of packages that state any.

    Modules that Numba compiles are left alone: the hook wraps functions, and Numba cannot compile the wrapper.

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

    Values (`laticauda.quantities.value`) check their fields themselves, and make tuples of lists: only shapes are left.
    """

    def decorate(thing: Any) -> Any:
        if not inspect.isclass(thing):
            return _checked(thing, typechecker)
        if dataclasses.is_dataclass(thing) and "__init__" in vars(thing):
            is_value = getattr(getattr(thing, "__post_init__", None), "__module__", "") == "laticauda.quantities"
            if not is_value or _has_shapes(tuple(thing.__init__.__annotations__.values())):
                thing.__init__ = _checked(thing.__init__, typechecker)
        return thing

    return decorate


def _checked(function: Callable[..., Any], typechecker: Callable[..., Any]) -> Callable[..., Any]:
    checked = typechecker(function)
    if not _has_shapes(tuple(function.__annotations__.values())):
        return checked

    @functools.wraps(function)
    def scoped(*args: Any, **kwargs: Any) -> Any:
        __tracebackhide__ = True
        if jaxtyping.config.jaxtyping_disable:
            return function(*args, **kwargs)
        try:
            with _scope("context"):
                return checked(*args, **kwargs)
        except BeartypeCallHintViolation as violation:
            raise jaxtyping.TypeCheckError(str(violation)) from violation

    return scoped


def _has_shapes(hint: Any) -> bool:
    """Whether an annotation, or one inside it, states a shape; a text may."""
    if isinstance(hint, str) or (inspect.isclass(hint) and issubclass(hint, jaxtyping.AbstractArray)):
        return True
    return any(map(_has_shapes, hint if isinstance(hint, tuple | list) else get_args(hint)))
