"""Flags derived from declared values: name, unit, range, default and text are stated once, by the value itself.

A command is a `value` whose fields are options, or values whose fields are options. An angle is
given in degrees, under its name with ``-deg`` or ``-deg-s``. Defaults are those of the command that
is passed in, so the help shows, and the flags change, the values of a preset or a file.
"""

import math
import re
import shutil
import sys
import textwrap
import types
import typing
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, is_dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar, Union, cast, get_args, get_origin

import tyro
from tyro.constructors import (
    ConstructorRegistry,
    PrimitiveConstructorSpec,
    StructConstructorSpec,
    StructFieldSpec,
)

from laticauda.display_units import ANGLE_UNITS, display_unit
from laticauda.errors import BadArgument, check_whole_number
from laticauda.files import read_toml
from laticauda.quantities import Quantity, hints_of, quantities_of, texts_of

Command = TypeVar("Command")

TOLD: dict[str, Any] = read_toml(Path(__file__).with_suffix(".toml"))
NOT_FLAGS, CALLED, SPELLED = TOLD["not_flags"], TOLD["called"], TOLD["spelled"]
PRESETS = ("robot", "water", "ground", "parameters", "base")
"""Fields that are given by the name of a preset or the path of a file."""
LAST = "scenario"
"""Field whose many numbers, meant for specialists, are listed last in the help."""
WIDTH = 110
OBJECTS: dict[type, tuple[str, Callable[[Sequence[str]], object]]] = {}
"""By type of object that may replace numbers: how the help shows its words, and the function that reads them."""


class BadFlag(Exception):
    """A flag that cannot be used; the message is the sentence that the user reads."""


@dataclass(frozen=True)
class OutputFile:
    """Mark for the name of a file that a command will write."""

    endings: tuple[str, ...] = ()
    """Allowed endings; if empty, those of the trial formats."""


def spell_flag(name: str) -> str:
    """Return an option as it is typed."""
    return "--" + name.replace("_", "-")


def was_typed(name: str, words: Sequence[str]) -> bool:
    """Return whether an option is among the words.

    Args:
        name: Name of its field.
        words: Words that were typed.
    """
    return any(word.split("=")[0] == spell_flag(name) for word in words)


def _words(
    nargs: int | Literal["*"],
    metavar: str,
    read: Callable[[list[str]], Any],
    shown: Callable[[Any], list[str]] | None = None,
    choices: tuple[str, ...] | None = None,
) -> Any:
    """Return the specification of a flag that takes one or several words, and how they are read."""
    return PrimitiveConstructorSpec[Any](
        nargs=nargs,
        metavar=metavar,
        instance_from_str=read,
        is_instance=lambda value: True,
        str_from_instance=shown or _shown,
        choices=choices,
    )


def _first(words: list[str]) -> str:
    return words[0]


def _place(metavar: str, nargs: int | Literal["*"] = 1) -> Any:
    """Return the specification of a flag that takes one or several names of files or folders."""

    def read(words: list[str]) -> Any:
        if "" in words:
            raise ValueError("must be the name of a file or a folder, got an empty text")
        return words[0] if nargs == 1 else tuple(words)

    return _words(nargs, metavar, read)


def _shown(value: Any) -> list[str]:
    if isinstance(value, tuple):
        return [str(one) for one in cast("tuple[object, ...]", value)] or ["none"]
    return ["none" if value is None else str(value)]


File = Annotated[str | None, _place("FILE")]
Stored = Annotated[File, OutputFile()]
PICTURES = OutputFile((".png", ".pdf", ".svg"))
Picture = Annotated[File, PICTURES]
Mp4 = Annotated[File, OutputFile((".mp4",))]
Toml = Annotated[File, OutputFile((".toml",))]
Made = Annotated[str, _place("FILE")]
Folder = Annotated[str, _place("DIR")]
Place = Annotated[str | None, _place("DIR")]
Words = Annotated[tuple[str, ...], _words("*", "NAME=VALUES ...", tuple)]
Files = Annotated[tuple[str, ...], _place("FILE ...", "*")]
Listed = Annotated[
    tuple[str, ...], _words("*", "NAME[,NAME...]", lambda words: tuple(",".join(words).split(",")))
]
Input = Annotated[str, tyro.conf.Positional, _place("FILE")]
Output = Annotated[str, tyro.conf.Positional, _place("OUTPUT")]
Preset = Annotated[str | None, tyro.conf.Positional, _words(1, "NAME|PATH", _first)]
ScenarioFile = Annotated[str | None, tyro.conf.Positional, _words(1, "FILE", _first)]
Inputs = Annotated[tuple[str, ...], tyro.conf.Positional, _place("FILES ...", "*")]


def parse_command(
    command: type[Command],
    words: Sequence[str],
    prog: str,
    default: Command | None = None,
    *,
    first: bool = False,
) -> Any:
    """Return a command with the flags that were typed.

    Args:
        command: Class of the command.
        words: Words typed after its name.
        prog: Name of the command in the help.
        default: Values of flags that were left out; None: those that the class declares.
        first: Read only the known flags; ignore unknown words and requests for help.

    Raises:
        BadFlag: If a flag cannot be used.
        SystemExit: If the help was requested or a flag is unknown.
    """
    for before, word in zip((prog, *words), words, strict=False):
        if "\0" in word:  # no file has such a name, and no shell passes one on
            raise BadFlag(f"{before} must have no null character behind it, got {word!r}.")
    found: Any = tyro.cli(
        command,
        prog=prog,
        description=wrap_text((command.__doc__ or "").split("\n\nFields:")[0]),
        args=words,
        default=default,
        registry=_registry,
        config=(tyro.conf.OmitArgPrefixes,),
        return_unknown_args=first,
        add_help=not first,
    )
    return found[0] if first else found


def wrap_text(text: str) -> str:
    """Wrap a text to the width of the terminal; tyro would join lines that are not indented."""
    width = min(WIDTH, shutil.get_terminal_size().columns)
    how: Any = {"width": width, "break_on_hyphens": False, "subsequent_indent": "  "}
    return "\n\n".join(textwrap.fill(" ".join(part.split()), **how) for part in text.split("\n\n"))


def parts_of(command: object) -> Iterator[Any]:
    """Yield a command, and all values in it whose fields are also options.

    Args:
        command: Any command.
    """
    yield command
    for field in fields(cast(Any, command)):
        one = getattr(command, field.name)
        if is_declared(one):
            yield from parts_of(one)


def options_of(command: object) -> dict[str, Any]:
    """Return the options of a command and its parts, by field name."""
    held = (
        (field.name, getattr(part, field.name))
        for part in parts_of(command)
        for field in fields(part)
    )
    return {name: one for name, one in held if not is_declared(one)}


@cache
def marks_of(kind: type) -> Mapping[str, tuple[Any, ...]]:
    """Return the marks on the fields of a command or a part of it: `Written`, for example, or that it has no flag."""
    hints = typing.get_type_hints(kind, include_extras=True)
    return {name: getattr(hint, "__metadata__", ()) for name, hint in hints.items()}


def spell_field(name: str, command: object) -> str:
    """Return how a field is typed if it is an option of the command, otherwise its name in backticks.

    Args:
        name: Name of an argument.
        command: Command that was running.
    """
    bare = CALLED.get(name, name).split("[")[0]
    if command is None:  # a name among the flags that are read first
        return spell_flag(bare)
    for kind in map(type, parts_of(command)):
        if bare in hints_of(kind) and bare in options_of(command):
            if tyro.conf.Positional in marks_of(kind)[bare]:
                return bare.upper()
            declared = quantities_of(kind).get(bare)
            return spell_flag(
                SPELLED.get(bare, bare)
                + ("" if declared is None else display_unit(declared.unit).ending)
            )
    return spell_flag(SPELLED[bare]) if bare in SPELLED else f"`{name}`"


def is_declared(thing: object) -> bool:
    """Return whether `thing` is a value whose fields are declared."""
    return (
        is_dataclass(thing) and not isinstance(thing, type) and any(texts_of(type(thing)).values())
    )


_registry = ConstructorRegistry()


@_registry.struct_rule
def _declared_values(info: Any) -> StructConstructorSpec | None:
    kind = type(info.default) if is_dataclass(info.default) else info.type
    if not (isinstance(kind, type) and is_dataclass(kind) and any(texts_of(kind).values())):
        return None
    default = info.default if is_declared(info.default) else None
    is_of_cli = kind.__module__.startswith(__name__.rpartition(".")[0]) or hasattr(
        kind, "read"
    )  # like commands
    return _options(kind, default, nested=not is_of_cli)


def _options(kind: type[Any], default: Any, *, nested: bool) -> StructConstructorSpec:
    """Return the flags of a class of values, and how a value is made from them."""
    hints = typing.get_type_hints(kind, include_extras=True)
    specs: list[StructFieldSpec] = []
    of_flag: dict[str, str] = {}
    waves = _waves_of(kind)
    for field in sorted(fields(kind), key=lambda field: field.name == LAST):
        if field.name in waves and default is not None:
            specs += [spec for _, spec in _wave_flags(field.name, default)]
            continue
        usual: Any = getattr(default, field.name) if default is not None else _default_of(field)
        declared = quantities_of(kind).get(field.name)
        name = SPELLED.get(
            f"{kind.__name__.lower()}.{field.name}", SPELLED.get(field.name, field.name)
        )
        name = name if nested else field.name
        option = _type_of(hints[field.name], hints_of(kind)[field.name], declared, name, usual)
        if option is None or (
            nested and {field.name, f"{kind.__name__.lower()}.{field.name}"} & {*NOT_FLAGS}
        ):
            continue
        name += "" if declared is None else display_unit(declared.unit).ending
        of_flag[name] = field.name
        usual = (
            tyro.MISSING if usual is MISSING or usual == "" else usual
        )  # empty text: must be typed
        specs.append(
            StructFieldSpec(
                name=name, type=option, default=usual, helptext=f"{texts_of(kind)[field.name]}."
            )
        )

    def make(**given: Any) -> Any:
        values = {of_flag[name]: one for name, one in given.items() if name in of_flag}
        try:
            made = kind(**values) if default is None else replace(default, **values)
            for wave in waves:
                made = _with_wave(made, wave, given)
            return made
        except BadArgument as error:
            typed = (
                spell_flag(option)
                for option, field in of_flag.items()
                if field == error.name.split("[")[0]
            )
            raise BadFlag(f"{next(typed, f'`{error.name}`')} {error.rule}.") from None

    return StructConstructorSpec(instantiate=make, fields=tuple(specs))


def _waves_of(kind: type[Any]) -> list[str]:
    """Return the names of the optional second waves of a value: for a gait, those of its pitch joints and its fin."""
    gaits = sys.modules.get(
        "laticauda.gaits.gait"
    )  # not imported here: the list of commands does not need it
    return (
        []
        if gaits is None
        else [name for name, hint in hints_of(kind).items() if hint == gaits.Wave | None]
    )


def _wave_flags(wave: str, gait: Any) -> list[tuple[str, StructFieldSpec]]:
    """Return the flags of a second wave, each with its field; the gait has the wave if one of them is typed."""
    from laticauda.gaits import Wave

    usual, text = getattr(gait, wave), texts_of(gait.__class__)[wave].partition(";")[0]
    found: list[tuple[str, StructFieldSpec]] = []
    for name, declared in quantities_of(Wave).items():
        option: Any = Annotated[Any, _numbers(declared, float | None, f"{wave}_{name}")]
        spelled, help = (
            f"{wave}_{name}{display_unit(declared.unit).ending}",
            f"{text}: {declared.text}.",
        )
        if f"{wave}_{name}" not in NOT_FLAGS:
            spec = StructFieldSpec(
                name=spelled, type=option, default=getattr(usual, name, None), helptext=help
            )
            found.append((name, spec))
    return found


def _with_wave(gait: Any, wave: str, given: dict[str, Any]) -> Any:
    """Return a gait with a second wave if one was typed; omitted numbers are those of the wave or the gait, or zero."""
    from laticauda.gaits import Wave

    names = {name: spec.name for name, spec in _wave_flags(wave, gait)}
    typed = {
        name: given[spelled] for name, spelled in names.items() if given.get(spelled) is not None
    }
    own: dict[str, Any] = {
        name: getattr(gait, name) for name in ("frequency", "phase_shift") if name in names
    }
    usual = getattr(gait, wave) or Wave(amplitude=0.0, **{"frequency": gait.frequency, **own})
    return replace(gait, **{wave: replace(usual, **typed)}) if typed else gait


def _default_of(field: Any) -> Any:
    return field.default if field.default_factory is MISSING else field.default_factory()


def _type_of(annotated: Any, hint: Any, declared: Quantity | None, name: str, usual: Any) -> Any:
    """Return the type of a field for tyro; None if it is not a flag."""
    if get_origin(annotated) is Annotated:
        return annotated
    if hint is Any:  # internal to a command
        return None
    if declared is not None:
        return Annotated[Any, _numbers(declared, hint, name)]
    if hint is bool:
        return Annotated[bool, tyro.conf.FlagCreatePairsOff] if usual is False else bool
    if is_declared(usual):
        title = re.sub("(?<=[a-z])(?=[A-Z])", "-", type(usual).__name__).lower()
        return Annotated[type(usual), tyro.conf.arg(name=title, prefix_name=False)]
    inner = [one for one in get_args(hint) if one is not type(None)] if _is_union(hint) else [hint]
    if len(inner) == 1 and get_origin(inner[0]) is Literal:
        choices = get_args(inner[0])
        return Annotated[Any, _words(1, f"{{{','.join(choices)}}}", _first, choices=choices)]
    return (
        Annotated[Any, _words(1, "NAME|PATH" if name in PRESETS else "TEXT", _first)]
        if inner == [str]
        else None
    )


def _is_union(hint: Any) -> bool:
    return get_origin(hint) in (types.UnionType, Union)


def _numbers(declared: Quantity, hint: Any, name: str) -> Any:
    """Return the specification of a flag that takes one or several numbers, in the unit that users type."""
    inner = [one for one in get_args(hint) if one is not type(None)] if _is_union(hint) else [hint]
    several = get_origin(inner[0]) is tuple
    count = (
        len(get_args(inner[0]))
        if several and len(inner) == 1 and get_args(inner[0])[-1] is not Ellipsis
        else None
    )
    metavar = _metavar(display_unit(declared.unit).name, several, count)
    typed = spell_flag(name + display_unit(declared.unit).ending)
    read = _reader(declared, int in (inner[0], *get_args(inner[0])), several, typed)
    for kind in OBJECTS.keys() & {*inner}:
        metavar, read = (
            f"{metavar} | {OBJECTS[kind][0]}",
            partial(_numbers_or_object, read, OBJECTS[kind][1]),
        )
    return _words(
        1 if not several else count or "*", metavar, read, partial(_numbers_shown, declared)
    )


def _numbers_or_object(
    numbers: Callable[[list[str]], Any], made: Callable[[Sequence[str]], Any], words: list[str]
) -> Any:
    """Read words as numbers if the first one is a number, otherwise as an object."""
    try:
        float(words[0] if words else "0")
    except ValueError:
        return made(words)
    return numbers(words)


def _metavar(unit: str, several: bool, count: int | None) -> str:
    word = unit or "NUMBER"
    return (
        word if not several else " ".join("XYZ"[:count]) if count and count < 4 else f"{word} ..."
    )


def _numbers_shown(declared: Quantity, value: Any) -> list[str]:
    if value is None or is_declared(value):
        return ["none" if value is None else value.words]
    factor = math.degrees(1.0) if declared.unit in ANGLE_UNITS else 1.0
    values = cast("tuple[float, ...]", value if isinstance(value, tuple) else (value,))
    return [f"{factor * one:.12g}" for one in values] or ["none"]


def _reader(
    declared: Quantity, is_whole: bool, several: bool, option: str
) -> Callable[[list[str]], Any]:
    """Return a function from words to numbers; it rejects values out of range in the unit that was typed."""
    in_degrees = declared.unit in ANGLE_UNITS
    rule = declared.in_degrees if in_degrees else declared

    def number(word: str) -> float:
        try:
            found = int(word) if is_whole or word.lstrip("+-").isdigit() else float(word)
        except ValueError:
            kind = "a whole number" if is_whole else "a number"
            raise BadFlag(f"{option} must be {kind}, got {word!r}.") from None
        least = math.ceil(max(rule.least, -(2**53))) if is_whole else 0
        try:
            checked = (
                check_whole_number(option, found, least)
                if is_whole
                else rule.checked(option, found)
            )
        except BadArgument as error:
            raise BadFlag(f"{option} {error.rule}.") from None
        return math.radians(checked) if in_degrees else checked

    return lambda words: tuple(map(number, words)) if several else number(words[0])
