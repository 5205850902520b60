"""Which fields of a command are options, and how each is spelled: help, messages and checks all ask here.

A command is a value, and its fields are options; if a field holds another declared value, such as
a gait, the fields of that value are options, too. The classes of such values exist apart from
commands: ``flag_names.toml`` lists those of their fields that have no flag, or one of another name.
The fields of a class that is made for the command line (`Options`) all have flags of their own
names.

`FlagNames.name_flag` is the only place where a field gets the name that people type. An angle has
the ending of its unit in degrees, see `laticauda.values.display_units`.
"""

import itertools
import re
import typing
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, cast

import tyro

from laticauda.cli.flag_types import InternalMark
from laticauda.values import Extensible, Field, fields_of, read_toml, texts_of


class Options:
    """Base of commands and of groups of options: each of their fields is a flag of its own name."""

    heading: ClassVar[str] = ""
    """Heading of the group in the help; "" for the name of the class."""


@dataclass(frozen=True)
class FlagNames:
    """What ``flag_names.toml`` says of fields; the file explains its keys."""

    hidden: frozenset[str]
    """Fields of nested values that have no flag."""
    optional_waves: frozenset[str]
    """Fields that hold a wave or None."""
    hidden_numbers_of_waves: frozenset[str]
    """Numbers of such a wave that have no flag."""
    option_of_argument: Mapping[str, str]
    """Options that give an argument of another name."""
    spelling: Mapping[str, str]
    """What the flags of some fields of nested values are called."""
    words_of_studies: frozenset[str]
    """Options of `sweep` and `optimize`: a number of that name in somebody's own law has its class in front."""

    def is_hidden(self, field: Field) -> bool:
        """Return whether a field has no flag although it could have one."""
        if issubclass(field.owner, Options):
            return False
        return field.name in self.hidden or name_with_class(field) in self.hidden

    def is_hidden_number(self, wave: Field, number: str) -> bool:
        """Return whether a number of an optional wave has no flag."""
        return f"{name_with_class(wave)}.{number}" in self.hidden_numbers_of_waves

    def is_optional_wave(self, field: Field) -> bool:
        """Return whether a field holds a wave or None."""
        return name_with_class(field) in self.optional_waves

    def name_flag(self, field: Field) -> str:
        """Return the name of a field's flag, with underscores: ``start_pitch_deg``."""
        name = field.name
        owner: type[Any] = field.owner
        if not issubclass(owner, Options):
            in_any_class = self.spelling.get(field.name, field.name)
            name = self.spelling.get(name_with_class(field), in_any_class)
        if name in self.words_of_studies and is_law_of_somebody(owner):
            name = f"{owner.__name__.lower()}_{name}"
        return name + field.display.ending


def _read_flag_names() -> FlagNames:
    table: dict[str, Any] = read_toml(Path(__file__).with_suffix(".toml"))
    return FlagNames(
        hidden=frozenset(table["hidden"]),
        optional_waves=frozenset(table["optional_waves"]),
        hidden_numbers_of_waves=frozenset(table["hidden_numbers_of_waves"]),
        option_of_argument=table["option_of_argument"],
        spelling=table["spelling"],
        words_of_studies=frozenset(table["words_of_studies"]),
    )


def is_law_of_somebody(owner: type) -> bool:
    """Return whether a class is a law, an envelope or the like that is not one of laticauda's own.

    Args:
        owner: The class.
    """
    return issubclass(owner, Extensible) and not owner.__module__.startswith("laticauda.")


def name_with_class(field: Field) -> str:
    """Return the name of a field behind that of its class, as in ``flag_names.toml``."""
    return f"{field.owner.__name__.lower()}.{field.name}"


FLAG_NAMES = _read_flag_names()


def spell_flag(name: str) -> str:
    """Return the flag of a name as it is typed: ``--sample-interval`` for ``sample_interval``."""
    return "--" + name.replace("_", "-")


def spell_option(field: Field) -> str:
    """Return how an option is typed: its flag, or the word in the help that stands for a file without a flag.

    Args:
        field: Field of a command or a part of it.
    """
    if tyro.conf.Positional in marks_of(field.owner).get(field.name, ()):
        return field.name.upper()
    return spell_flag(FLAG_NAMES.name_flag(field))


def spell_typed_flag(argument: str) -> str:
    """Return the flag in an argument as `spell_option` spells it.

    Args:
        argument: Such as ``--sample_interval=0.1``: a value may follow, and underscores are
            accepted like hyphens.
    """
    flag, _, _ = argument.partition("=")
    return flag.replace("_", "-")


def was_typed(field: Field, arguments: Sequence[str]) -> bool:
    """Return whether an option is among the arguments.

    Args:
        field: Field of a command or a part of it.
        arguments: What was typed.
    """
    flag = spell_option(field)
    accepted_flags = [flag]
    if field.hint is bool:
        accepted_flags.append(flag.replace("--", "--no-", 1))
    return any(spell_typed_flag(argument) in accepted_flags for argument in arguments)


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


def options_of(command: object) -> tuple[Field, ...]:
    """Return the fields of a command and its parts that can be typed.

    Args:
        command: Any command, or a part of one.
    """
    options: list[Field] = []
    for part in parts_of(command):
        for field in fields_of(part.__class__).values():
            is_part = is_declared(getattr(part, field.name))
            if not (is_internal(field) or is_part or FLAG_NAMES.is_hidden(field)):
                options.append(field)
    return tuple(options)


@cache
def marked_types_of(kind: type) -> Mapping[str, Any]:
    """Return the types of the fields of a command or a part of it, with their marks."""
    return MappingProxyType(typing.get_type_hints(kind, include_extras=True))


@cache
def marks_of(kind: type) -> Mapping[str, tuple[Any, ...]]:
    """Return the marks on the fields of a command or a part of it: `OutputFile`, for example."""
    marks = {
        name: getattr(marked_type, "__metadata__", ())
        for name, marked_type in marked_types_of(kind).items()
    }
    return MappingProxyType(marks)


def is_internal(field: Field) -> bool:
    """Return whether a field is of the type `Internal`, and no option."""
    marks = marks_of(field.owner).get(field.name, ())
    return any(isinstance(mark, InternalMark) for mark in marks)


def spell_field(name: str, command: object) -> str:
    """Return how a field is typed if it is an option of the command, otherwise its name in backticks.

    Args:
        name: Name of an argument, with an index in brackets if it is one of several.
        command: Command that was running; None if there was none yet, since its names were being read.
    """
    argument, _, _ = name.partition("[")
    option_name = FLAG_NAMES.option_of_argument.get(argument, argument)
    is_part_of_item = "]." in name
    if is_part_of_item and argument not in FLAG_NAMES.option_of_argument:
        return f"`{name}`"
    if command is None:
        return spell_flag(option_name)
    for field in options_of(command):
        if field.name == option_name:
            return spell_option(field)
    if option_name in FLAG_NAMES.spelling:
        return spell_flag(FLAG_NAMES.spelling[option_name])
    return f"`{name}`"


def spell_fields_in(rule: str, options: Iterable[Field]) -> str:
    """Return a rule with the flags of the options that it names in backticks.

    Args:
        rule: The rule that an argument breaks.
        options: The options; other names keep their backticks.
    """
    flags = {field.name: spell_option(field) for field in options}

    def spell(name: re.Match[str]) -> str:
        return flags.get(name.group(1), name.group())

    return re.sub(r"`(\w+)`", spell, rule)


def spell_part_of_file(name: str, typed: Sequence[str]) -> str:
    """Return the file and the key, if a part of the robot is named and the robot was typed as a file; else "".

    Args:
        name: Name of an argument, such as `caudal_fin.thickness` or `modules[2].mass`.
        typed: Words of the command line.
    """
    from laticauda.robot import Robot  # when something is wrong, not whenever a command begins

    root = re.split(r"[.\[]", name, maxsplit=1)[0]
    if root == name or root not in Robot.__dataclass_fields__:
        return ""
    words = [part for word in typed for part in word.split("=", maxsplit=1)]
    for word, next_word in itertools.pairwise(words):
        if word == "--robot" and next_word.endswith(".toml"):
            return f"{next_word}: `{name}`"
    return ""
