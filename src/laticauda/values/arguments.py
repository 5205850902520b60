"""Error messages that name an argument of the wrong type, where Python itself would fail somewhere inside a call.

Values validate themselves, and functions check ranges. What is not a robot at all, or not a list of
robots, is recognized by its type: `explained` looks for it after a call has failed, so that
successful calls cost nothing.
"""

import functools
import inspect
import re
import sys
import types
import typing
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib import import_module
from itertools import islice
from numbers import Integral, Real
from typing import Any, cast, get_args, get_origin

from laticauda.values.errors import BadArgument

MOST_ITEMS = 100
"""Number of items of a list that are checked."""
_MARK = "explained"
_NUMBERS: dict[Any, type] = {float: Real, int: Integral}
"""What counts as a number of a class: Python accepts one for the other, and NumPy's for both."""


def explained(content: Any, package: str) -> Any:
    """Wrap a function or class so that a failure due to an argument of the wrong type names that argument.

    Args:
        content: Function or class; anything else, and a class that validates its fields itself, is
            returned unchanged.
        package: Package from which users import it.
    """
    if isinstance(content, type):
        if "__init__" in vars(content) and not hasattr(content, "__post_init__"):
            content.__init__ = _explained(content.__init__, package)  # type: ignore[misc]
        return content
    is_function = isinstance(content, types.FunctionType | types.MethodType)
    if is_function or hasattr(content, "cache_info"):
        return _explained(content, package)
    return content


def explain(module: dict[str, Any]) -> None:
    """Wrap every public function and class of a module that users import directly.

    Args:
        module: The module's `globals()`, when complete.
    """
    module_name = module["__name__"]
    for name, content in list(module.items()):
        is_defined_here = getattr(content, "__module__", "").startswith(module_name)
        if is_defined_here and not name.startswith("_"):
            module[name] = explained(content, module_name)


@functools.cache
def _explained(function: Callable[..., Any], package: str) -> Callable[..., Any]:
    is_cached = hasattr(function, "cache_info")  # has the mark of the function that it caches
    if hasattr(function, _MARK) and not is_cached:  # re-exported by another of our packages
        return function

    @functools.wraps(function)
    def call(*args: Any, **keywords: Any) -> Any:
        __tracebackhide__ = True
        try:
            return function(*args, **keywords)
        except (TypeError, AttributeError, LookupError, ArithmeticError, AssertionError) as error:
            bad_argument = _find_bad_argument(function, args, keywords)
            if bad_argument is None:
                raise
            raise bad_argument from error

    vars(call)[_MARK] = True
    call.__module__ = package  # where pickle finds it
    signature = _signature_with_keywords(function)
    if signature is not None:
        vars(call)["__signature__"] = signature
    return call


class _Unstated:
    """Stands in a signature for a default that depends on other arguments."""

    def __repr__(self) -> str:
        """Return what help shows."""
        return "..."


def _signature_with_keywords(function: Callable[..., Any]) -> inspect.Signature | None:
    """Return a signature with the keywords that `**changes: Unpack[Changes]` stands for; None: there are none.

    So help lists them, and notebooks complete them.
    """
    code = getattr(function, "__code__", None)
    if code is None or not code.co_flags & inspect.CO_VARKEYWORDS:
        return None
    signature = inspect.signature(function)
    *parameters, collected = signature.parameters.values()
    keywords = _find_keywords(collected.annotation, function)
    if keywords is None:
        return None
    required: frozenset[str] = keywords.__required_keys__
    for name, hint in keywords.__annotations__.items():
        default = inspect.Parameter.empty if name in required else _Unstated()
        keyword = inspect.Parameter(
            name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=hint
        )
        parameters.append(keyword)
    return signature.replace(parameters=parameters)


def _find_keywords(annotation: Any, function: Callable[..., Any]) -> Any:
    """Return the class of the keywords in the annotation of `**changes`; None: it names none."""
    if get_origin(annotation) is not typing.Unpack:
        return None
    keywords = get_args(annotation)[0]
    if isinstance(keywords, typing.ForwardRef):
        return vars(sys.modules[function.__module__]).get(keywords.__forward_arg__)
    return keywords


def _find_bad_argument(
    function: Callable[..., Any], args: tuple[Any, ...], keywords: Mapping[str, Any]
) -> BadArgument | None:
    """Return an error for the first argument of the wrong type; None: all are right, or Python's error suffices."""
    plain_function: Any = inspect.unwrap(function)
    signature = inspect.signature(plain_function)
    try:
        values = signature.bind(*args, **keywords).arguments
    except TypeError:  # too few arguments, for instance
        return None
    for name, value in values.items():
        parameter = signature.parameters[name]
        if parameter.kind is inspect.Parameter.VAR_POSITIONAL:
            continue
        annotation = plain_function.__annotations__.get(name, Any)
        if parameter.kind is inspect.Parameter.VAR_KEYWORD:
            bad_argument = _find_bad_keyword(annotation, plain_function, value)
        else:
            bad_argument = _misfit_of_annotation(name, value, annotation, plain_function)
        if bad_argument is not None:
            return bad_argument
    return None


def _resolve_annotation(annotation: Any, module_names: Mapping[str, Any]) -> Any:
    """Return the type that an annotation stands for, also if its module is imported by type checkers only.

    Raises:
        NameError: If it is not to be found.
    """
    annotated = types.SimpleNamespace(__annotations__={"argument": annotation})
    names = dict(module_names)
    try:
        return typing.get_type_hints(annotated, names)["argument"]
    except NameError as error:
        package = getattr(annotation, "__forward_arg__", str(annotation)).partition(".")[0]
        if package != error.name:
            raise
        try:
            names[package] = import_module(package)
        except ImportError:
            raise error from None
    return typing.get_type_hints(annotated, names)["argument"]


def _find_bad_keyword(
    annotation: Any, function: Callable[..., Any], given_keywords: Mapping[str, Any]
) -> BadArgument | None:
    """Return an error for the first wrong keyword of `**changes: Unpack[Changes]`."""
    keywords = _find_keywords(annotation, function)
    if keywords is None:
        return None
    hints = typing.get_type_hints(keywords)
    for name, value in given_keywords.items():
        bad_argument = misfit(name, value, hints.get(name, Any))
        if bad_argument is not None:
            return bad_argument
    return None


def _misfit_of_annotation(
    name: str, value: object, annotation: Any, function: Callable[..., Any]
) -> BadArgument | None:
    """Return an error for a value that does not fit an annotation of a function, which may be a text."""
    try:
        hint = _resolve_annotation(annotation, function.__globals__)
    except NameError:  # a type that exists only for type checkers
        return None
    return misfit(name, value, hint)


def misfit(name: str, value: object, hint: Any) -> BadArgument | None:
    """Return an error for a value of the wrong type, as far as this can be seen without iterating over it.

    Args:
        name: Name of the argument.
        value: The value given.
        hint: Annotation of the argument.
    """
    hint = _resolve_type_variable(hint)
    kind = get_origin(hint) or hint
    inner_hints = get_args(hint)
    if not _is_of_kind(name, value, kind, inner_hints):
        text = re.sub(r"\b(?:\w+\.)+(?=\w)", "", inspect.formatannotation(hint))
        expected = text.replace(" | ", " or ")
        return BadArgument(name, f"must be of class {expected}, got {type(value).__name__}")
    is_list = kind in (list, tuple, Sequence, Iterable) and isinstance(value, Sequence)
    if not is_list or not inner_hints:
        return None
    items = islice(cast("Sequence[object]", value), MOST_ITEMS)
    for i, item in enumerate(items):
        bad_item = misfit(f"{name}[{i}]", item, inner_hints[0])
        if bad_item is not None:
            return bad_item
    return None


def _resolve_type_variable(hint: Any) -> Any:
    """Return the bound of a TypeVar, or the union of its constraints; any other hint unchanged."""
    bound: Any = getattr(hint, "__bound__", None)
    if bound:
        return bound
    union: Any = None
    for constraint in getattr(hint, "__constraints__", ()):
        union = constraint if union is None else union | constraint
    return union or hint


def _is_of_kind(name: str, value: object, kind: Any, inner_hints: tuple[Any, ...]) -> bool:
    """Return whether a value may be of a kind, as far as this can be seen without iterating over it."""
    if kind in (typing.Union, types.UnionType):
        return any(misfit(name, value, hint) is None for hint in inner_hints)
    if kind is typing.Literal:
        return isinstance(value, str) and value in inner_hints
    if kind in _NUMBERS:
        return isinstance(value, _NUMBERS[kind]) and not isinstance(value, bool)
    if kind is Any or not isinstance(kind, type) or typing.is_typeddict(kind):
        return True
    if getattr(kind, "_is_protocol", False):
        public_names = [member for member in dir(kind) if not member.startswith("_")]
        return all(hasattr(value, member) for member in public_names)
    if inner_hints and isinstance(value, str):  # a text is not a list of texts
        return False
    return isinstance(value, kind)
