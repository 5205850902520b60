"""Flags made from declared fields: `parse_command` turns a class and typed words into a command.

tyro parses the words; for every class whose fields are declared, it asks `_flags_of_declared_value`
which flags there are. The answer has one entry per field (name, type, default and help text, all
from the field's declaration) and a function that makes the value from what was typed. If a field
holds another declared value, tyro asks again, for the class of that value.

Defaults are those of the value that is passed in, such as the gait of a preset or the water of a
file, and those of the class where there is none: so the help shows, and the flags change, what the
preset or the file has.
"""

import re
import shutil
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, is_dataclass, replace
from typing import Annotated, Any, TypeVar, get_origin

import tyro
from tyro.constructors import ConstructorRegistry, StructConstructorSpec, StructFieldSpec

from laticauda.cli.flag_names import (
    FLAG_NAMES,
    Options,
    is_declared,
    is_internal,
    marked_types_of,
    options_of,
    spell_fields_in,
    spell_option,
)
from laticauda.cli.flag_types import REQUIRED, BadFlag, read_first, words_flag
from laticauda.cli.mistaken_flags import refuse_mistaken, refuse_repeated
from laticauda.cli.number_flags import numbers_flag
from laticauda.cli.wave_flags import wave_flags, with_typed_wave
from laticauda.values import BadArgument, Field, docstring_without_fields, fields_of, texts_of

Parsed = TypeVar("Parsed")

PRESETS = ("robot", "water", "ground", "parameters", "base")
"""Fields that are given by the name of a preset or the path of a file."""
LISTED_LAST = "scenario"
"""Field whose many numbers, meant for specialists, are listed last in the help."""
WIDTH = 110
"""Width of the help on a wide terminal [characters]."""


def parse_command(
    command_class: type[Parsed],
    arguments: Sequence[str],
    prog: str,
    default: Parsed | None = None,
    *,
    known_only: bool = False,
) -> Any:
    """Return a command with the flags that were typed.

    Args:
        command_class: Class of the command.
        arguments: What was typed after its name.
        prog: Name of the command in the help.
        default: Values of flags that were left out; None: those that the class declares.
        known_only: Read only the known flags; ignore unknown ones and requests for help.

    Raises:
        BadFlag: If a flag cannot be used.
        SystemExit: If the help was requested or a flag is unknown.
    """
    _reject_null_characters(arguments, prog)
    refuse_repeated(arguments)
    if default is not None:
        flags = {spell_option(field) for field in options_of(default)}
        refuse_mistaken(arguments, flags)
    parsed: Any = tyro.cli(
        command_class,
        prog=prog,
        description=wrap_text(docstring_without_fields(command_class)),
        args=arguments,
        default=default,
        registry=_registry,
        config=(tyro.conf.OmitArgPrefixes,),
        return_unknown_args=known_only,
        add_help=not known_only,
    )
    if not known_only:
        return parsed
    command, _ = parsed
    return command


def _reject_null_characters(arguments: Sequence[str], prog: str) -> None:
    """Reject what no shell passes on, and what is in the name of no file."""
    for before, argument in zip((prog, *arguments), arguments, strict=False):
        if "\0" in argument:
            raise BadFlag(f"{before} must have no null character behind it, got {argument!r}.")


def wrap_text(text: str) -> str:
    """Wrap a text to the width of the terminal; tyro would join lines that are not indented."""
    width = min(WIDTH, shutil.get_terminal_size().columns)
    paragraphs: list[str] = []
    for paragraph in text.split("\n\n"):
        wrapped = textwrap.fill(
            " ".join(paragraph.split()),
            width=width,
            break_on_hyphens=False,
            subsequent_indent="  ",
        )
        paragraphs.append(wrapped)
    return "\n\n".join(paragraphs)


_registry = ConstructorRegistry()


@_registry.struct_rule
def _flags_of_declared_value(info: Any) -> StructConstructorSpec | None:
    """Return the flags of a class whose fields are declared; None: tyro has a rule of its own.

    If there is a default, its class decides: a field declared as a joint law has the flags of a
    servo if the default is one.

    Args:
        info: What tyro knows: `type` and `default`.
    """
    kind = info.type
    if is_dataclass(info.default):
        kind = type(info.default)
    if not isinstance(kind, type) or not any(texts_of(kind).values()):
        return None
    default = None
    if is_declared(info.default):
        default = info.default
    return _flags_of(kind, default)


def _flags_of(kind: type[Any], default: Any) -> StructConstructorSpec:
    """Return the flags of a class of values, and how a value is made from them.

    A field has one flag, but an optional wave of a gait has one for each of its numbers.
    """
    specs: list[StructFieldSpec] = []
    fields_by_flag: dict[str, Field] = {}
    waves: list[Field] = []
    for field in _in_order_of_help(kind):
        if FLAG_NAMES.is_optional_wave(field) and default is not None:
            waves.append(field)
            specs += [flag.spec for flag in wave_flags(field, default)]
            continue
        spec = _flag_of(field, default)
        if spec is not None:
            specs.append(spec)
            fields_by_flag[spec.name] = field
    maker = _ValueMaker(kind=kind, default=default, fields_by_flag=fields_by_flag, waves=waves)
    return StructConstructorSpec(instantiate=maker.make, fields=tuple(specs))


def _in_order_of_help(kind: type) -> list[Field]:
    return sorted(fields_of(kind).values(), key=lambda field: field.name == LISTED_LAST)


@dataclass(frozen=True)
class _ValueMaker:
    """Makes a value from the flags of its class."""

    kind: type[Any]
    default: Any
    """Value whose fields are changed; None: there is none."""
    fields_by_flag: Mapping[str, Field]
    """Fields that have one flag, by its name."""
    waves: Sequence[Field]
    """Fields that hold a wave of which each number is a flag."""

    def make(self, **typed: Any) -> Any:
        """Return the value.

        Args:
            typed: Values by names of the flags, those of flags that were left out included.
        """
        values: dict[str, Any] = {}
        for flag, field in self.fields_by_flag.items():
            if flag in typed:
                values[field.name] = typed[flag]
        try:
            if self.default is None:
                value = self.kind(**values)
            else:
                value = replace(self.default, **values)
            for wave in self.waves:
                value = with_typed_wave(value, wave, typed)
        except BadArgument as error:
            rule = spell_fields_in(error.rule, self.fields_by_flag.values())
            raise BadFlag(error.sentence_about(self._spell(error.name), rule)) from None
        return value

    def _spell(self, argument: str) -> str:
        """Return how an argument is typed."""
        name = argument.split("[")[0]
        for field in self.fields_by_flag.values():
            if field.name == name:
                return spell_option(field)
        return f"`{argument}`"


def _flag_of(field: Field, default: Any) -> StructFieldSpec | None:
    """Return the flag of a field; None: it has none."""
    if FLAG_NAMES.is_hidden(field):
        return None
    name = FLAG_NAMES.name_flag(field)
    value = field.make_default()
    if default is not None:
        value = getattr(default, field.name)
    flag_type = _type_of_flag(field, name, value)
    if flag_type is None:
        return None
    must_be_typed = value is MISSING or value == REQUIRED
    if must_be_typed:
        value = tyro.MISSING
    return StructFieldSpec(name=name, type=flag_type, default=value, helptext=f"{field.text}.")


def _type_of_flag(field: Field, name: str, value: Any) -> Any:
    """Return the type of a field for tyro; None: it has no flag.

    Args:
        field: The field.
        name: Name of its flag.
        value: Default of the flag.
    """
    if is_internal(field):
        return None
    marked_type = marked_types_of(field.owner)[field.name]
    if get_origin(marked_type) is Annotated:
        return marked_type
    if field.quantity is not None:
        return Annotated[Any, numbers_flag(name, field.annotation, field.quantity)]
    if field.hint is bool:
        return _switch(value)
    if is_declared(value):
        kind: type[Any] = value.__class__
        return Annotated[kind, tyro.conf.arg(name=_heading_of(kind), prefix_name=False)]
    return _type_of_words(field, name)


def _switch(value: object) -> Any:
    """Return the type of a truth value: ``--json``, or a pair such as ``--free-start`` and ``--no-free-start``.

    One that is false unless typed needs no second flag.
    """
    if value is False:
        return Annotated[bool, tyro.conf.FlagCreatePairsOff]
    return bool


def _heading_of(kind: type) -> str:
    """Return the heading of a group of options in the help."""
    if issubclass(kind, Options) and kind.heading:
        return kind.heading
    return re.sub("(?<=[a-z])(?=[A-Z])", "-", kind.__name__).lower()


def _type_of_words(field: Field, name: str) -> Any:
    """Return the type of a field that is a text or one of several; None: it has no flag."""
    choices = field.annotation.choices
    if choices:
        listed = f"{{{','.join(choices)}}}"
        spec = words_flag(n_words=1, metavar=listed, read=read_first, choices=choices)
        return Annotated[Any, spec]
    if field.annotation.only_member is not str:
        return None
    metavar = "NAME|PATH" if name in PRESETS else "TEXT"
    return Annotated[Any, words_flag(n_words=1, metavar=metavar, read=read_first)]
