"""Error messages that name an argument of the wrong type, where Python itself would fail somewhere inside a call.

Values validate themselves, and functions check ranges. What is not a robot at all, or not a list of
robots, is recognized by its type: `explained` looks for it after a call has failed, so that
successful calls cost nothing.
"""

import functools
import inspect
import re
import types
import typing
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import islice
from numbers import Integral, Real
from typing import Any, cast, get_args, get_origin

from laticauda.values.errors import BadArgument

MOST_SEEN = 100
"""Number of items of a list that are checked."""
_MARK = "explained"
_NUMBERS: dict[Any, type] = {
    float: Real,
    int: Integral,
}  # Python accepts one for the other, and NumPy's for both


def explained(thing: Any, package: str) -> Any:
    """Wrap a function or class so that a failure due to an argument of the wrong type names that argument.

    Args:
        thing: Function or class; anything else, and a class that validates its fields itself, is
            returned unchanged.
        package: Package from which users import it.
    """
    if isinstance(thing, types.FunctionType | types.MethodType) or hasattr(thing, "cache_info"):
        return _explained(thing, package)
    if (
        isinstance(thing, type)
        and "__init__" in vars(thing)
        and not hasattr(thing, "__post_init__")
    ):
        thing.__init__ = _explained(thing.__init__, package)  # type: ignore[misc]
    return thing


def explain(module: dict[str, Any]) -> None:
    """Wrap every public function and class of a module that users import directly.

    Args:
        module: The module's `globals()`, when complete.
    """
    name = module["__name__"]
    for word, thing in list(module.items()):
        if not word.startswith("_") and getattr(thing, "__module__", "").startswith(name):
            module[word] = explained(thing, name)


@functools.cache
def _explained(function: Callable[..., Any], package: str) -> Callable[..., Any]:
    if hasattr(function, _MARK):  # re-exported by another of our packages
        return function

    @functools.wraps(function)
    def call(*args: Any, **given: Any) -> Any:
        __tracebackhide__ = True
        try:
            return function(*args, **given)
        except (TypeError, AttributeError, LookupError, ArithmeticError, AssertionError) as error:
            wrong = _wrong(function, args, given)
            if wrong is None:
                raise
            raise wrong from error

    vars(call)[_MARK] = True
    call.__module__ = package  # where pickle finds it
    return call


def _wrong(
    function: Callable[..., Any], args: tuple[Any, ...], given: Mapping[str, Any]
) -> BadArgument | None:
    """Return an error for the first argument of the wrong type; None: all are right, or Python's error suffices."""
    plain: Any = inspect.unwrap(function)
    signature = inspect.signature(plain)
    try:
        values = signature.bind(*args, **given).arguments
    except TypeError:  # too few arguments, for instance
        return None
    for name, value in values.items():
        said = types.SimpleNamespace(__annotations__={name: plain.__annotations__.get(name, Any)})
        try:
            hint = typing.get_type_hints(said, plain.__globals__)[name]
        except NameError:  # a type that exists only for type checkers
            continue
        is_one = "VAR_" not in signature.parameters[name].kind.name  # not *args or **kwargs
        if is_one and (wrong := misfit(name, value, hint)) is not None:
            return wrong
    return None


def misfit(name: str, value: object, hint: Any) -> BadArgument | None:
    """Return an error for a value of the wrong type, as far as this can be seen without iterating over it.

    Args:
        name: Name of the argument.
        value: The value given.
        hint: Annotation of the argument.
    """
    # Resolve a TypeVar to its constraints or bound.
    any_of: Any = functools.reduce(
        lambda one, other: one | other, getattr(hint, "__constraints__", ()) or (hint,)
    )
    hint = getattr(hint, "__bound__", None) or any_of
    kind, inner = get_origin(hint) or hint, get_args(hint)
    if kind in (typing.Union, types.UnionType):
        is_right = any(misfit(name, value, one) is None for one in inner)
    elif kind is typing.Literal:
        is_right = isinstance(value, str) and value in inner
    elif kind in _NUMBERS:
        is_right = isinstance(value, _NUMBERS[kind]) and not isinstance(value, bool)
    elif kind is Any or not isinstance(kind, type) or typing.is_typeddict(kind):
        is_right = True
    elif getattr(kind, "_is_protocol", False):
        is_right = all(hasattr(value, word) for word in dir(kind) if not word.startswith("_"))
    else:
        is_right = isinstance(value, kind) and not (
            inner and isinstance(value, str)
        )  # a text is not a list of texts
    if not is_right:
        wanted = re.sub(r"\b(?:\w+\.)+(?=\w)", "", inspect.formatannotation(hint)).replace(
            " | ", " or "
        )
        return BadArgument(name, f"must be of class {wanted}, got {type(value).__name__}")
    if (
        kind not in (list, tuple, Sequence, Iterable)
        or not inner
        or not isinstance(value, Sequence)
    ):
        return None
    items = enumerate(islice(cast("Sequence[object]", value), MOST_SEEN))
    return next(
        (wrong for i, one in items if (wrong := misfit(f"{name}[{i}]", one, inner[0]))), None
    )
