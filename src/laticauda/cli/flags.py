"""Kinds of options. All may be left out, and are None then: so a command knows what its user typed."""

import dataclasses
import types
import typing
from collections.abc import Callable, Iterator, Sequence
from typing import Annotated, Any, Literal

import tyro
from tyro.constructors import PrimitiveConstructorSpec

from laticauda.cli.messages import flag
from laticauda.extensions import name_of
from laticauda.formulas import Law
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
    fields: list[tuple[str, Any, Any]] = []
    for name, _, hint, help in _options(kind):
        if name in omit:
            continue
        if hint is bool:
            fields.append((name, _described(Switch, help, otherwise), False))
            fields.append((f"no_{name}", _described(Switch, f"The opposite of {flag(name)}.", otherwise), False))
        else:
            fields.append((name, _described(_type_of(hint), help, otherwise), None))
    return dataclasses.make_dataclass(f"{kind.__name__}Changes", fields, frozen=True, kw_only=True)


def _options(kind: type) -> Iterator[tuple[str, tuple[str, ...], Any, str]]:
    """By option: the way to its field, the field's type and what it is; those of a law are of its default's class.

    A law's truth value is called after both, `linear` of the `drag` is `linear_drag`.
    """
    hints = hints_of(kind)
    for field in dataclasses.fields(kind):
        hint = hints[field.name]
        if not (isinstance(hint, type) and issubclass(hint, Law)):
            yield field.name, (field.name,), hint, _help(kind, field.name)
        elif dataclasses.is_dataclass(field.default):
            law: Any = type(field.default)
            for own, inner in hints_of(law).items():
                name = f"{own}_{field.name}" if inner is bool else own
                yield name, (field.name, own), inner, _help(law, own)


def _help(kind: type, name: str) -> str:
    """What a field is, with its unit."""
    numbers = quantities_of(kind)
    return f"{texts_of(kind)[name]} [{numbers[name].unit or '-'}]." if name in numbers else f"{texts_of(kind)[name]}."


def changed(thing: Any, wanted: Any) -> Any:
    """`thing`, a dataclass, with the fields that `changes` were asked for; its name says which.

    Raises:
        ValueError: If a field is asked to be true and false, or out of its range, or its law has no such number.
    """
    values: dict[str, Any] = {}
    listed: list[str] = []
    kind: type[Any] = thing.__class__
    for name, (field, *inner), _, _ in _options(kind):
        value: Any = getattr(wanted, name, None)
        if isinstance(value, bool):
            opposite: bool = getattr(wanted, f"no_{name}")
            if value and opposite:
                raise ValueError(f"`{name}` and `no_{name}` must not be given together.")
            value = value if value or opposite else None
        if value is None:
            continue
        listed.append(f"{name} {_plain(value)}")
        for own in inner:
            law: Any = values.get(field, getattr(thing, field))
            if own not in hints_of(law.__class__):
                raise ValueError(
                    f"`{name}` must not be given with the law {name_of(law.__class__)}, which has no such number."
                )
            value = dataclasses.replace(law, **{own: value})
        values[field] = value
    return dataclasses.replace(thing, **values, name=f"{thing.name} with {', '.join(listed)}") if values else thing


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
