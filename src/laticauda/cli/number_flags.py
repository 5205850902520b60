"""Flags that take numbers: angles in degrees, each number checked in the unit in which it was typed."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias, cast

from laticauda.cli.flag_names import is_declared, spell_flag
from laticauda.cli.flag_types import BadFlag, Number, words_flag
from laticauda.values import (
    Annotation,
    BadArgument,
    DisplayUnit,
    Quantity,
    TupleAnnotation,
    check_whole_number,
    is_tuple,
)

LARGEST_EXACT_INTEGER = 2**53
"""Up to this, a float holds every whole number."""
AXES = "XYZ"

Reader: TypeAlias = Callable[[list[str]], Any]


@dataclass(frozen=True)
class ObjectFlag:
    """How an object is typed that may replace numbers."""

    metavar: str
    """What stands for its words in the help."""
    read: Callable[[Sequence[str]], object]
    """Function from the typed words to the object."""


_OBJECT_FLAGS: dict[type, ObjectFlag] = {}
"""How objects are typed, by their class; `accept_objects` adds to it."""


def accept_objects(kind: type, metavar: str, read: Callable[[Sequence[str]], object]) -> None:
    """Let flags of numbers take objects of a class, too, where the type of the field allows them.

    The current of the water is such a field: two or three numbers, or a flow (`laticauda.cli.laws`).

    Args:
        kind: The class.
        metavar: What stands for its words in the help.
        read: Function from the typed words to the object.
    """
    _OBJECT_FLAGS[kind] = ObjectFlag(metavar=metavar, read=read)


def numbers_flag(name: str, annotation: Annotation, quantity: Quantity) -> Any:
    """Return the specification of a flag that takes one or several numbers, in the unit that users type.

    Args:
        name: Name of the flag, with underscores.
        annotation: Type of the field.
        quantity: Unit and range of the numbers.
    """
    display = quantity.display
    is_several = is_tuple(annotation.members[0])
    count = None
    if is_several and len(annotation.members) == 1:
        count = TupleAnnotation.of(annotation.members[0]).count
    reader = _NumberReader(
        option=spell_flag(name),
        quantity=quantity.in_display_unit,
        display=display,
        is_whole=annotation.is_whole_number,
    )
    metavar = _metavar_of(display.name, is_several, count)
    n_words: Number = 1
    read: Reader = reader.read_one
    if is_several:
        n_words = count or "*"
        read = reader.read_several
    for kind in _OBJECT_FLAGS.keys() & {*annotation.members}:
        metavar = f"{metavar} | {_OBJECT_FLAGS[kind].metavar}"
        read = _reader_of_numbers_or_objects(read, _OBJECT_FLAGS[kind])
    return words_flag(
        n_words=n_words,
        metavar=metavar,
        read=read,
        show=lambda value: _show_numbers(value, display),
    )


def _metavar_of(unit: str, is_several: bool, count: int | None) -> str:
    unit = unit or "NUMBER"
    if not is_several:
        return unit
    if count and count <= len(AXES):
        return " ".join(AXES[:count])
    return f"{unit} ..."


def _show_numbers(value: Any, display: DisplayUnit) -> list[str]:
    """Return the words of a default as the help shows them."""
    if value is None:
        return ["none"]
    if is_declared(value):
        return [value.words]
    numbers = (value,)
    if isinstance(value, tuple):
        numbers = cast("tuple[float, ...]", value)
    return [f"{display.from_si(number):.12g}" for number in numbers] or ["none"]


@dataclass(frozen=True)
class _NumberReader:
    """Reads the numbers of a flag, and rejects values out of range in the unit that was typed."""

    option: str
    """The flag as it is typed."""
    quantity: Quantity
    """The range, in the unit that is typed."""
    display: DisplayUnit
    """The unit that is typed."""
    is_whole: bool
    """Whether only whole numbers are accepted."""

    def read_several(self, typed: list[str]) -> tuple[float, ...]:
        return tuple(self._read(word) for word in typed)

    def read_one(self, typed: list[str]) -> float:
        return self._read(typed[0])

    def _read(self, text: str) -> float:
        number = self._parse(text)
        try:
            return self._checked(number)
        except BadArgument as error:
            raise BadFlag(error.sentence_about(self.option)) from None

    def _parse(self, text: str) -> float:
        is_integer = text.lstrip("+-").isdigit()
        required = "a number"
        if self.is_whole:
            required = "a whole number"
        try:
            if self.is_whole or is_integer:
                return int(text)
            return float(text)
        except ValueError:
            raise BadFlag(f"{self.option} must be {required}, got {text!r}.") from None

    def _checked(self, number: float) -> float:
        if self.is_whole:
            # The largest is checked by the class of the field, when the value is made.
            least = math.ceil(max(self.quantity.least, -LARGEST_EXACT_INTEGER))
            return check_whole_number(self.option, number, least)
        return self.display.to_si(self.quantity.checked(self.option, number))


def _reader_of_numbers_or_objects(read_numbers: Reader, object_flag: ObjectFlag) -> Reader:
    """Return a function that reads words as numbers if the first one is a number, otherwise as an object."""

    def read(typed: list[str]) -> Any:
        first = typed[0] if typed else "0"
        try:
            float(first)
        except ValueError:
            return object_flag.read(typed)
        return read_numbers(typed)

    return read
