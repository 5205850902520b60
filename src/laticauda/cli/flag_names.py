"""How fields are called where people type them, and which fields of a command are options.

``flag_names.toml`` lists the fields that have no flag or are called otherwise. An angle has the
ending of its unit in degrees, see `laticauda.values.display_units`.
"""

import typing
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

import tyro

from laticauda.values import Field, fields_of, read_toml, texts_of


@dataclass(frozen=True)
class FlagNames:
    """What ``flag_names.toml`` says; keys are names of fields, alone or behind their class."""

    hidden: frozenset[str]
    """Fields of nested values that have no flag."""
    optional_waves: frozenset[str]
    """Fields that hold a wave or None."""
    option_of_argument: Mapping[str, str]
    """Options that give an argument of another name."""
    spelling: Mapping[str, str]
    """What the flags of some fields of nested values are called."""

    def is_hidden(self, field: Field) -> bool:
        """Return whether a field of a nested value has no flag."""
        return field.name in self.hidden or name_with_class(field) in self.hidden

    def is_optional_wave(self, field: Field) -> bool:
        """Return whether a field holds a wave or None."""
        return name_with_class(field) in self.optional_waves

    def spell(self, field: Field) -> str:
        """Return what the flag of a field of a nested value is called, with underscores."""
        in_any_class = self.spelling.get(field.name, field.name)
        return self.spelling.get(name_with_class(field), in_any_class)


def _read_flag_names() -> FlagNames:
    table: dict[str, Any] = read_toml(Path(__file__).with_suffix(".toml"))
    return FlagNames(
        hidden=frozenset(table["hidden"]),
        optional_waves=frozenset(table["optional_waves"]),
        option_of_argument=table["option_of_argument"],
        spelling=table["spelling"],
    )


def name_with_class(field: Field) -> str:
    """Return the name of a field behind that of its class, as in ``flag_names.toml``."""
    return f"{field.owner.__name__.lower()}.{field.name}"


FLAG_NAMES = _read_flag_names()


def spell_flag(name: str) -> str:
    """Return an option as it is typed."""
    return "--" + name.replace("_", "-")


def was_typed(name: str, arguments: Sequence[str]) -> bool:
    """Return whether an option is among the arguments.

    Args:
        name: Name of its field.
        arguments: What was typed.
    """
    return any(argument.split("=")[0] == spell_flag(name) for argument in arguments)


def is_declared(value: object) -> bool:
    """Return whether this is a value whose fields are declared."""
    return (
        is_dataclass(value) and not isinstance(value, type) and any(texts_of(type(value)).values())
    )


def parts_of(command: object) -> Iterator[Any]:
    """Yield a command, and all values in it whose fields are also options.

    Args:
        command: Any command.
    """
    yield command
    for field in fields(cast(Any, command)):
        content = getattr(command, field.name)
        if is_declared(content):
            yield from parts_of(content)


def options_of(command: object) -> dict[str, Any]:
    """Return the options of a command and its parts, by field name."""
    options: dict[str, Any] = {}
    for part in parts_of(command):
        for field in fields(part):
            content = getattr(part, field.name)
            if not is_declared(content):
                options[field.name] = content
    return options


@cache
def marked_types_of(kind: type) -> Mapping[str, Any]:
    """Return the types of the fields of a command or a part of it, with their marks."""
    return MappingProxyType(typing.get_type_hints(kind, include_extras=True))


def marks_of(kind: type) -> Mapping[str, tuple[Any, ...]]:
    """Return the marks on the fields of a command or a part of it: `OutputFile`, for example."""
    return {
        name: getattr(marked_type, "__metadata__", ())
        for name, marked_type in marked_types_of(kind).items()
    }


def spell_field(name: str, command: object) -> str:
    """Return how a field is typed if it is an option of the command, otherwise its name in backticks.

    Args:
        name: Name of an argument, with an index in brackets if it is one of several.
        command: Command that was running; None if the flags that are read first were at fault.
    """
    option = FLAG_NAMES.option_of_argument.get(name, name).split("[")[0]
    if command is None:
        return spell_flag(option)
    options = options_of(command)
    for part in parts_of(command):
        field = fields_of(part.__class__).get(option)
        if field is not None and option in options:
            return _spell_option(field)
    if option in FLAG_NAMES.spelling:
        return spell_flag(FLAG_NAMES.spelling[option])
    return f"`{name}`"


def _spell_option(field: Field) -> str:
    if tyro.conf.Positional in marks_of(field.owner)[field.name]:
        return field.name.upper()
    name = FLAG_NAMES.spelling.get(field.name, field.name)
    return spell_flag(name + field.display.ending)
