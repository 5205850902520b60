"""Kinds of options. All may be left out, and are None then: so a command knows what its user typed."""

import dataclasses
import types
import typing
from collections.abc import Callable, Sequence
from typing import Annotated, Any, Literal

import tyro
from tyro.constructors import PrimitiveConstructorSpec

from laticauda.cli.messages import flag
from laticauda.quantities import hints_of, quantities_of, texts_of


def _option(
    nargs: int | Literal["*"], metavar: str, read: Callable[[list[str]], Any], choices: Sequence[str] | None = None
) -> PrimitiveConstructorSpec[Any]:
    return PrimitiveConstructorSpec(
        nargs=nargs,
        metavar=metavar,
        instance_from_str=read,
        is_instance=lambda value: True,
        str_from_instance=lambda value: [str(value)],
        choices=None if choices is None else tuple(choices),
    )


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise ValueError(f"must be a number, got {word!r}.") from None


def _whole(word: str) -> int:
    try:
        return int(word)
    except ValueError:
        raise ValueError(f"must be a whole number, got {word!r}.") from None


def choice(*names: str) -> Any:
    """Marks an option, a text, that takes one of these names."""
    return _option(1, f"{{{','.join(names)}}}", lambda words: words[0], names)


def default(text: object) -> Any:
    """What the help says about an option that is left out."""
    return tyro.conf.arg(help_behavior_hint=f"(default: {text})")


Text = Annotated[str | None, _option(1, "TEXT", lambda words: words[0])]
Preset = Annotated[str | None, _option(1, "NAME|PATH", lambda words: words[0])]
File = Annotated[str | None, _option(1, "FILE", lambda words: words[0]), default("none")]
Number = Annotated[float | None, _option(1, "NUMBER", lambda words: _number(words[0]))]
Numbers = Annotated[
    tuple[float, ...] | None, _option("*", "NUMBER ...", lambda words: tuple(_number(word) for word in words))
]
Files = Annotated[tuple[str, ...] | None, _option("*", "FILE ...", lambda words: tuple(words))]
Two = Annotated[tuple[float, ...] | None, _option(2, "X Y", lambda words: tuple(_number(word) for word in words))]
Ends = Annotated[
    tuple[float, ...] | None, _option(2, "LEAST GREATEST", lambda words: tuple(_number(word) for word in words))
]
Whole = Annotated[int | None, _option(1, "N", lambda words: _whole(words[0]))]
Words = Annotated[tuple[str, ...], _option("*", "NAME=VALUES ...", tuple)]
Switch = Annotated[bool, tyro.conf.FlagCreatePairsOff, default("off")]


def changes(kind: type, omit: Sequence[str], otherwise: str) -> type[Any]:
    """Options that replace fields of a dataclass: a dataclass with the same fields, all None.

    A field that is true or false becomes two options, ``--name`` and ``--no-name``.

    Args:
        kind: The dataclass; the texts of its fields are the options' help.
        omit: Names of fields that are no options.
        otherwise: What the help says about an option that is left out.
    """
    hints, numbers = hints_of(kind), quantities_of(kind)
    documented = {
        name: f"{text} [{numbers[name].unit or '-'}]." if name in numbers else f"{text}."
        for name, text in texts_of(kind).items()
    }
    fields: list[tuple[str, Any, Any]] = []
    for field in dataclasses.fields(kind):
        if field.name in omit:
            continue
        help = documented[field.name]
        if hints[field.name] is bool:
            fields.append((field.name, _described(Switch, help, otherwise), False))
            fields.append(
                (f"no_{field.name}", _described(Switch, f"The opposite of {flag(field.name)}.", otherwise), False)
            )
        else:
            fields.append((field.name, _described(_type_of(hints[field.name]), help, otherwise), None))
    return dataclasses.make_dataclass(f"{kind.__name__}Changes", fields, frozen=True, kw_only=True)


def changed(thing: Any, wanted: Any) -> Any:
    """`thing`, a dataclass, with the fields that `changes` were asked for; its name says which.

    Raises:
        ValueError: If a field is asked to be true and false, or out of its range.
    """
    values: dict[str, Any] = {}
    for field in dataclasses.fields(thing):
        value: Any = getattr(wanted, field.name, None)
        if isinstance(value, bool):
            opposite: bool = getattr(wanted, f"no_{field.name}")
            if value and opposite:
                raise ValueError(f"`{field.name}` and `no_{field.name}` must not be given together.")
            value = value if value or opposite else None
        if value is not None:
            values[field.name] = value
    if not values:
        return thing
    listed = ", ".join(f"{name} {_plain(value)}" for name, value in values.items())
    return dataclasses.replace(thing, **values, name=f"{thing.name} with {listed}")


def _type_of(hint: Any) -> Any:
    """The kind of option for a field of this type."""
    if typing.get_origin(hint) is types.UnionType:
        hint = next(part for part in typing.get_args(hint) if part is not types.NoneType)
    if typing.get_origin(hint) is Literal:
        return Annotated[str | None, choice(*typing.get_args(hint))]
    if typing.get_origin(hint) is tuple:
        return Two
    return {float: Number, int: Whole, str: Text}[hint]


def _described(option: Any, help: str, otherwise: str) -> Any:
    return Annotated[option, tyro.conf.arg(help=help, help_behavior_hint=f"(default: {otherwise})")]


def _plain(value: object) -> str:
    """A field's value as a name shows it."""
    if isinstance(value, tuple):
        return "({})".format(", ".join(map(_plain, value)))  # pyright: ignore[reportUnknownArgumentType]
    if isinstance(value, bool):
        return "on" if value else "off"
    return f"{value:g}" if isinstance(value, float) else str(value)
