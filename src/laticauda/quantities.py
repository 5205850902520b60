"""Declarations of numbers: a field's unit, text, range and default stand together, and everything reads them here.

    @value
    class PolynomialDrag:
        reference_speed: float = quantity("m/s", "U_ref, where both parts are equal", ge=0.0, default=1.0)
        linear: bool = option("Whether there is a part that is linear in the speed", default=True)

A `value` is a frozen, keyword-only dataclass that checks each of its fields once, by type and
declared range. Files, flags, sweeps, FMUs, pages, the reference and `help` read the declarations
with `quantities_of`, `texts_of`, `hints_of`.
"""

import dataclasses
import functools
import html
import inspect
import math
import sys
import types
import typing
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, dataclass
from itertools import islice
from typing import (
    Any,
    Literal,
    TypeVar,
    Union,
    cast,
    dataclass_transform,
    get_args,
    get_origin,
    overload,
)

from laticauda.errors import (
    BadArgument,
    check_choice,
    check_finite,
    check_flag,
    check_instance,
    check_text,
    check_whole_number,
    show_value,
)

T = TypeVar("T")
Kind = TypeVar("Kind", bound=type[Any])
Check = Callable[[str, Any], Any]

_COUNTS = {2: "two", 3: "three"}
_WORDS = {str: "text"}
DEGREES = {"rad": "_deg", "rad/s": "_deg_s"}
"""Suffixes of names that give a quantity of this unit in degrees, at the interfaces: files, flags and pages."""

LIMITS = {
    "kg/m^3": 25e3,  # osmium has 22 590
    **dict.fromkeys(("A", "V", "deg C", "degC", "m/s"), 1e4),
    **dict.fromkeys(("Hz", "K/W", "m/s^2", "m^2", "ohm", "rad"), 1e6),
    "m": 1e7,  # survey coordinates, such as UTM, come near this
    **dict.fromkeys(("deg", "kg", "m^3"), 1e9),
}
"""Largest magnitude by unit, if the field declares no bound on that side; anything larger is taken as a mistake."""
LARGEST = 1e12
"""The largest for all other units: far beyond any swimmer, and far from overflow of sums and squares of numbers."""
MOST_ITEMS = 10_000_000
"""Maximum length of a list of numbers given by a user, which also guards against endless ones."""
LEAST = {"m": 1e-9, "kg": 1e-9, "kg/m^3": 1e-9}
"""Smallest value by unit, if the field declares that it is above 0; anything smaller is taken as a mistake."""
SMALLEST = 1e-12
"""The smallest for all other units: far below any swimmer, and far from overflow of quotients and squares."""


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """A finite number with a unit and a range; if no bound is declared, that of its unit applies (`LIMITS`)."""

    unit: str
    """Unit of the number; "" for a pure number."""
    text: str
    """Description, a phrase without a final period."""
    ge: float = -math.inf
    """Minimum, inclusive."""
    gt: float = -math.inf
    """Minimum, exclusive."""
    le: float = math.inf
    """Maximum, inclusive."""

    def checked(self, name: str, value: object) -> float:
        """Return `value` as a float.

        Args:
            name: Name of the argument.
            value: The value given.

        Raises:
            ValueError: If it is not a finite number, or out of range.
        """
        number = check_finite(name, value, self.unit)
        lowest, highest = self.ends
        if lowest <= number <= highest:
            return number
        if number <= self.gt:
            rule = f"> {self.gt:g}"
        elif not self.ge <= number <= self.le:
            rule = self.range
        else:
            rule = f"<= {highest:g}" if number > highest else f">= {lowest:g}"
        hint, (low, high) = "", self.in_degrees.ends
        if (
            self.unit == "rad"
            and math.isfinite(self.le)
            and abs(number) > math.pi
            and low <= number <= high
        ):
            hint = f": {number:g} rad is {math.degrees(number):.4g} deg; did you mean {name}_deg={number:g}?"
        raise BadArgument(
            name,
            f"must be {rule}{f' {self.unit}' if self.unit else ''}, got {show_value(value)}{hint}",
        )

    @property
    def in_degrees(self) -> "Quantity":
        """The same quantity of unit rad or rad/s, given in degrees."""
        bounds = {bound: math.degrees(getattr(self, bound)) for bound in ("ge", "gt", "le")}
        return dataclasses.replace(self, unit=self.unit.replace("rad", "deg"), **bounds)

    @property
    def ends(self) -> tuple[float, float]:
        """The smallest and the largest accepted number, both finite."""
        limit = LIMITS.get(self.unit, LARGEST)
        return self.least if math.isfinite(self.least) else -limit, self.le if math.isfinite(
            self.le
        ) else limit

    @property
    def least(self) -> float:
        """The smallest number accepted by declaration; minus infinity if there is none."""
        above = (
            LEAST.get(self.unit, SMALLEST) if self.gt == 0.0 else math.nextafter(self.gt, math.inf)
        )
        return max(self.ge, above if math.isfinite(self.gt) else self.gt)

    @property
    def range(self) -> str:
        """The declared range in words, "" if there is none."""
        low = self.ge if self.ge >= self.gt else self.gt
        if math.isfinite(low) and math.isfinite(self.le):
            return f"between {low:g} and {self.le:g}"
        if math.isfinite(self.le):
            return f"<= {self.le:g}"
        if math.isfinite(self.gt) and self.gt >= self.ge:
            return f"> {self.gt:g}"
        return f">= {self.ge:g}" if math.isfinite(self.ge) else ""


@overload
def quantity(
    unit: str, text: str, *, default: T, ge: float = ..., gt: float = ..., le: float = ...
) -> T: ...
@overload
def quantity(unit: str, text: str, *, ge: float = ..., gt: float = ..., le: float = ...) -> Any: ...
def quantity(
    unit: str,
    text: str,
    *,
    default: Any = MISSING,
    ge: float = -math.inf,
    gt: float = -math.inf,
    le: float = math.inf,
) -> Any:
    """Declare a field that holds a number, several numbers, or None if its type allows it.

    Args:
        unit: Unit; "" for a pure number.
        text: Description, a phrase without a final period.
        default: Default; if omitted, the field is required.
        ge: Minimum, inclusive.
        gt: Minimum, exclusive.
        le: Maximum, inclusive.
    """
    declared = Quantity(unit=unit, text=text, ge=ge, gt=gt, le=le)
    return dataclasses.field(default=default, metadata={"quantity": declared, "text": text})


@overload
def option(text: str, *, default: T, check: Check | None = ...) -> T: ...
@overload
def option(text: str, *, default_factory: Callable[[], T], check: Check | None = ...) -> T: ...
@overload
def option(text: str, *, check: Check | None = ...) -> Any: ...
def option(
    text: str, *, default: Any = MISSING, default_factory: Any = MISSING, check: Check | None = None
) -> Any:
    """Declare a field that is not a number: a text, a truth value, a choice or another value.

    Args:
        text: Description, a phrase without a final period.
        default: Default; if omitted, the field is required.
        default_factory: Function that makes the default.
        check: Replaces the check implied by the type: `check(name, value)` returns the cleaned
            value.
    """
    made: Any = (
        {"default_factory": default_factory}
        if default_factory is not MISSING
        else {"default": default}
    )
    return dataclasses.field(**made, metadata={"text": text, "check": check})


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(quantity, option))
def value_class(kind: Kind) -> Kind:
    """Make a frozen, keyword-only dataclass whose fields are checked before its own ``__post_init__`` (decorator).

    Numbers become floats within their range, whole numbers ints; texts of a `Literal` must be among
    its choices, with hyphens equivalent to underscores; truth values are true or false; a field of
    a class holds an instance of it; lists become tuples. A default is always valid, even infinity.
    Further checks are left to the class. An angle or its rate may be given in degrees, under its
    name with `DEGREES`: `amplitude_deg=30`.

    Args:
        kind: The class; its docstring gets a list of the fields.
    """
    own: Callable[[Any], None] | None = getattr(kind, "__post_init__", None)

    def check(self: Any) -> None:
        for name, low, high, rule in _checks(self.__class__):
            given = getattr(self, name)
            if type(given) is float and low <= given <= high:
                continue
            if rule is not None:
                cleaned = rule(name, given)
                if cleaned is not given:
                    object.__setattr__(self, name, cleaned)
        if own is not None:
            own(self)

    kind.__post_init__ = check  # type: ignore[attr-defined]
    made: Any = dataclass(frozen=True, kw_only=True)(kind)
    if degrees_of(made):
        made.__init__ = _in_degrees_too(made.__init__)
    made.__doc__ = _with_fields(made)
    made._repr_html_ = _as_table
    return made


def _as_table(self: Any) -> str:
    return html_table(getattr(self, "words", self.__class__.__name__), describe_fields(self))


def html_table(title: str, rows: Mapping[str, str]) -> str:
    """Return a table with a `title`, and `rows` of names and texts, as shown by notebooks."""
    cell = '<tr><th style="text-align:left">{}</th><td style="text-align:left">{}</td></tr>'.format
    lines = (cell(html.escape(name), html.escape(text)) for name, text in rows.items())
    return f"<table><caption>{html.escape(title)}</caption>{''.join(lines)}</table>"


def _in_degrees_too(init: Callable[..., None]) -> Callable[..., None]:
    @functools.wraps(init)
    def from_degrees(self: Any, **given: Any) -> None:
        kind: type = self.__class__
        for key in degrees_of(kind).keys() & given.keys():
            name, number = degrees_of(kind)[key], given.pop(key)
            declared = quantities_of(kind)[name]
            if name in given:
                raise BadArgument(
                    key, f"must not be given together with `{name}`, the same in {declared.unit}"
                )
            given[name] = (
                None if number is None else math.radians(declared.in_degrees.checked(key, number))
            )
        init(self, **given)

    return from_degrees


def check_one_among(*choices: str) -> Check:
    """Return a check for a text that is one of `choices`, with hyphens equivalent to underscores."""

    def check(name: str, given: Any) -> str:
        plain = given.replace("-", "_") if isinstance(given, str) else given
        return (
            plain
            if isinstance(plain, str) and plain in choices
            else check_choice(name, given, choices)
        )

    return check


@functools.cache
def quantities_of(kind: type) -> Mapping[str, Quantity]:
    """Return the declared numbers of a class by field."""
    found = {field.name: field.metadata.get("quantity") for field in dataclasses.fields(kind)}
    return types.MappingProxyType({name: one for name, one in found.items() if one is not None})


@functools.cache
def degrees_of(kind: type) -> Mapping[str, str]:
    """Return the names that give a class's angles and their rates in degrees, with the fields that they stand for."""
    found = {
        name + DEGREES[one.unit]: name
        for name, one in quantities_of(kind).items()
        if one.unit in DEGREES
    }
    return types.MappingProxyType(found)


@functools.cache
def texts_of(kind: type) -> Mapping[str, str]:
    """Return the description of every field of a class, "" if undeclared. A stand-in for an unknown class has none."""
    fields = dataclasses.fields(kind) if dataclasses.is_dataclass(kind) else ()
    return types.MappingProxyType({f.name: f.metadata.get("text", "") for f in fields})


@functools.cache
def hints_of(kind: type) -> Mapping[str, Any]:
    """Return the types of a class's fields."""
    hints = typing.get_type_hints(kind)
    return types.MappingProxyType(
        {field.name: hints[field.name] for field in dataclasses.fields(kind)}
    )


def describe_fields(thing: object, *left_out: str) -> dict[str, str]:
    """Describe the content of a value in words, by field; fields that are None, empty or 0 are omitted.

    Numbers have their units, angles are in degrees; nested values give their `words`, or are put in
    parentheses.

    Args:
        thing: The value.
        left_out: Fields that are described elsewhere.
    """
    held = {name: getattr(thing, name) for name in texts_of(type(thing)) if name not in left_out}
    words = {
        name: describe_field(one, quantities_of(type(thing)).get(name))
        for name, one in held.items()
    }
    return {name: one for name, one in words.items() if one}


def describe_field(given: Any, declared: Quantity | None) -> str:
    """Return a field's content `given` in words, with the unit of `declared`; angles in degrees, "" for 0."""
    if hasattr(given, "words"):
        return given.words
    if dataclasses.is_dataclass(given):
        held = ", ".join(f"{name} {one}" for name, one in describe_fields(given).items())
        return f"({held})" if held else ""
    if declared is None:
        return given if isinstance(given, str) else "yes" if given is True else ""
    numbers = cast("tuple[Any, ...]", given if isinstance(given, tuple) else (given,))
    if not any(numbers) or not all(
        isinstance(one, int | float) and math.isfinite(one) for one in numbers
    ):
        return ""
    in_degrees = declared.unit in DEGREES
    listed = ", ".join(f"{math.degrees(one) if in_degrees else one:g}" for one in numbers)
    unit = (declared.in_degrees if in_degrees else declared).unit
    return f"{f'({listed})' if len(numbers) > 1 else listed} {unit}".rstrip()


@functools.cache
def _checks(kind: type) -> tuple[tuple[str, float, float, Check | None], ...]:
    """Return for each field the range in which a float needs no further check, and the check for everything else."""
    hints, numbers = hints_of(kind), quantities_of(kind)
    found: list[tuple[str, float, float, Check | None]] = []
    for field in dataclasses.fields(kind):
        declared = numbers.get(field.name)
        low, high = math.inf, -math.inf  # an empty range
        hint = hints[field.name]
        among = get_args(hint) if get_origin(hint) is types.UnionType else (hint,)
        if declared is not None and float in among:
            low, high = declared.ends
            high = math.inf if field.default == math.inf else high
        found.append(
            (field.name, low, high, field.metadata.get("check") or _check_of(hint, declared))
        )
    return tuple(found)


def _check_of(hint: Any, declared: Quantity | None) -> Check | None:
    """Return the check for a field of this type; None: no check."""
    inner = [one for one in get_args(hint) if one is not type(None)]
    if get_origin(hint) in (types.UnionType, Union):
        return _check_of_union(hint, inner, declared)
    if get_origin(hint) is tuple:
        counts = () if inner[-1] is Ellipsis else (len(inner),)
        return functools.partial(
            check_items, _check_of(inner[0], declared), _things(inner[0], counts, declared), counts
        )
    if get_origin(hint) is Literal:
        return check_one_among(*get_args(hint))
    if declared is not None:
        return functools.partial(_whole, declared) if hint is int else declared.checked
    if hint in (bool, str):
        return check_flag if hint is bool else check_text
    if isinstance(hint, type) and hint is not Any and not getattr(hint, "_is_protocol", False):
        return lambda name, given: check_instance(name, given, hint)
    return None


def _check_of_union(hint: Any, inner: list[Any], declared: Quantity | None) -> Check | None:
    if len(inner) == 1 and len(get_args(hint)) == 2:  # a type or None
        check = _check_of(inner[0], declared)
        return (
            None
            if check is None
            else lambda name, given: None if given is None else check(name, given)
        )
    kinds = get_args(hint)
    tuples, others = (
        [one for one in kinds if get_origin(one) is tuple],
        [one for one in kinds if isinstance(one, type)],
    )
    if tuples and len(tuples) + len(others) == len(
        kinds
    ):  # for instance two or three numbers, or an object instead
        item, counts = (
            get_args(tuples[0])[0],
            tuple(len(get_args(one)) for one in tuples if ... not in get_args(one)),
        )
        words = (_WORDS.get(one, one.__name__) for one in others if one is not type(None))
        things = " or a ".join([_things(item, counts, declared), *words])
        check = functools.partial(check_items, _check_of(item, declared), things, counts)
        return lambda name, given: given if isinstance(given, (*others,)) else check(name, given)
    is_class = all(isinstance(one, type) for one in kinds) and declared is None
    return (lambda name, given: check_instance(name, given, *kinds)) if is_class else None


def _whole(declared: Quantity, name: str, given: Any) -> int:
    number = check_whole_number(name, given, math.ceil(max(declared.least, -sys.maxsize)))
    declared.checked(name, number)
    return number


def check_items(
    item: Check | None, things: str, counts: tuple[int, ...], name: str, given: Any
) -> tuple[Any, ...]:
    """Return an iterable as a tuple of checked items.

    Args:
        item: Check of each item.
        things: Description of the required items, in words.
        counts: Accepted numbers of items; none: any number up to `MOST_ITEMS`.
        name: Name of the argument.
        given: The value given.

    Raises:
        ValueError: If it is not iterable, has another length, or an item is rejected.
    """
    is_scalar = getattr(given, "shape", None) == ()  # an array without axes is not iterable
    if is_scalar or isinstance(given, str | Mapping) or not isinstance(given, Iterable):
        raise BadArgument(name, f"must be {things}, got {show_value(cast(object, given))}")
    values: tuple[Any, ...] = tuple(islice(cast("Iterable[Any]", given), MOST_ITEMS + 1))
    if len(values) > MOST_ITEMS:
        raise BadArgument(name, f"must be {things}, got more than {MOST_ITEMS} of them")
    if counts and len(values) not in counts:
        raise BadArgument(name, f"must be {things}, got {len(values)} of them")
    return (
        values if item is None else tuple(item(f"{name}[{i}]", one) for i, one in enumerate(values))
    )


def _things(kind: Any, counts: tuple[int, ...], declared: Quantity | None) -> str:
    """Return the content of a tuple, in words."""
    if declared is not None and get_origin(kind) is None:
        amount = " or ".join(str(_COUNTS.get(count, count)) for count in counts) or "a list of"
        return f"{amount} numbers{f' in {declared.unit}' if declared.unit else ''}"
    if declared is not None:
        return f"a list of {_things(get_args(kind)[0], (len(get_args(kind)),), declared)}"
    amount = f"{' or '.join(map(str, counts))} " if counts else ""
    return (
        f"a list of {amount}texts"
        if kind is str
        else f"a tuple of {getattr(kind, '__name__', 'tuples')}"
    )


def _with_fields(kind: type) -> str:
    """Return the docstring of a class with its fields appended."""
    lines = [inspect.cleandoc(kind.__doc__ or kind.__name__), "", "Fields:"]
    for field in dataclasses.fields(kind):
        text, declared = field.metadata.get("text", ""), field.metadata.get("quantity")
        if declared is not None:
            unit = f" [{declared.unit or '-'}]"
            text += f"{unit}, {declared.range}" if declared.range else unit
        if field.default is not MISSING:
            text += f"; default {field.default!r}"
        lines.append(f"    {field.name}: {text}.")
    return "\n".join(lines) + "\n"
