"""ROS 2 messages as bytes and back: CDR, the encoding that every ROS 2 tool reads.

What logs are made of is written here, from the definitions below: strictly, because the library `mcap-ros2-support`
fills what is missing with zeros and cuts what is too long, and more slowly, while a robot waits.
Messages of any writer are read by that library. Little-endian, each number aligned to its own size, as in version 1 of
the encoding (OMG DDS-XTypes 1.3, "plain CDR"), which ROS 2 uses.
"""

# The library's messages have the fields of their definitions, which no type checker knows.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import functools
import struct
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from laticauda.errors import BadArgument, optional_import

if TYPE_CHECKING:
    from mcap.records import Schema

Message: TypeAlias = dict[str, Any]
Content: TypeAlias = Mapping[str, Any] | Sequence[Any]
"""The fields of a message, by name or in the order of its definition."""

_FILE = (Path(__file__).parent / "ros2.msg").read_text(encoding="utf-8")
DEFINITIONS = dict(one.split("\n", 1) for one in _FILE.split("MSG: ")[1:])
"""The types that logs are made of, as ROS states them: a field a line, types of the same package without it.

A file carries the whole definition of every type that it uses, so that it can be read where ROS is not installed.
"""

HEADER = b"\x00\x01\x00\x00"  # plain CDR, little-endian
FORMATS = {"bool": "?", "byte": "B", "uint8": "B", "int32": "i", "uint32": "I", "float64": "d"}
NUMBERS = {kind: struct.Struct("<" + form) for kind, form in FORMATS.items()}
RULE = "=" * 80  # between the definitions in a schema


class _Field(NamedTuple):
    name: str
    kind: str  # with its package, if it is no plain one
    size: int | None  # None: a single value; 0: any number of them; else so many


@functools.cache
def _fields(name: str) -> tuple[_Field, ...]:
    """The fields of one definition; constants are none."""
    found: list[_Field] = []
    for line in DEFINITIONS[name].splitlines():
        kind, field = line.split()[:2]
        kind, bracket, size = kind.rstrip("]").partition("[")
        if kind not in FORMATS and kind != "string" and "/" not in kind:
            kind = f"{name.split('/')[0]}/{kind}"
        if "=" not in field:
            found.append(_Field(field, kind, int(size or 0) if bracket else None))
    return tuple(found)


def schema_name(name: str) -> str:
    """How files call a type: `sensor_msgs/msg/JointState` for `sensor_msgs/JointState`."""
    package, kind = name.split("/")
    return f"{package}/msg/{kind}"


def schema_text(name: str) -> str:
    """The definition of a type, followed by those of all types in it.

    Args:
        name: Of the type, one of `DEFINITIONS`.
    """
    found = [name]
    for one in found:  # which grows
        found += [field.kind for field in _fields(one) if field.kind in DEFINITIONS and field.kind not in found]
    return DEFINITIONS[name] + "".join(f"{RULE}\nMSG: {one}\n{DEFINITIONS[one]}" for one in found[1:])


def stamp(nanoseconds: int) -> tuple[int, int]:
    """A moment as `builtin_interfaces/Time`: seconds and nanoseconds."""
    return divmod(nanoseconds, 10**9)


def encode(name: str, message: Content) -> bytes:
    """The bytes of a message.

    Args:
        name: Of its type, one of `DEFINITIONS`.
        message: Its fields; those of messages in it likewise.

    Raises:
        ValueError: If a field is missing or does not fit.
    """
    body = bytearray()
    _write(body, name, message)
    return HEADER + bytes(body)


def decoder(schema: "Schema") -> Callable[[bytes], Message]:
    """What makes messages of any writer of bytes; it raises ValueError where they make no sense.

    A message is a dict of its fields; a list of numbers is an array, `uint8` ones are bytes.

    Args:
        schema: The definition in the file, with those of the types in it.

    Raises:
        MissingExtra: If the package `mcap-ros2-support` is not installed.
        ValueError: If the definition makes no sense.
    """
    package = optional_import("Reading messages of ROS 2", "mcap-ros2-support", "logs", "mcap_ros2.decoder")
    name = schema.name.replace("/msg/", "/")
    try:
        read = package.DecoderFactory().decoder_for("cdr", schema)
    except Exception as error:  # its parser of definitions raises anything
        raise ValueError(f"The definition of {name} makes no sense: {error}.") from error

    def decode(data: bytes) -> Message:
        try:
            return _plain(read(data))
        except Exception as error:  # struct's at the end of the bytes, UnicodeDecodeError, a type it does not define
            raise ValueError(f"A message of {name} is damaged: {error}.") from error

    return decode


def _plain(value: Any) -> Any:
    """What the library read, as dicts, lists, arrays and plain values."""
    if isinstance(value, list):
        if value and isinstance(value[0], int | float):
            return np.array(value)
        return [_plain(one) for one in value]
    if hasattr(value, "_full_text"):
        return {name: _plain(getattr(value, name)) for name in value.__slots__}
    return value


# ---- CDR -----------------------------------------------------------------------------------------------------------


def _write(body: bytearray, kind: str, value: Any) -> None:
    """Write a number, a text, or all fields of a message."""
    if kind in NUMBERS:
        packer = NUMBERS[kind]
        body += b"\x00" * (-len(body) % packer.size) + packer.pack(value)
    elif kind == "string":
        if not isinstance(value, str):
            raise TypeError(f"a text is needed, got {type(value).__name__}")
        text = value.encode()
        _write(body, "uint32", len(text) + 1)
        body += text + b"\x00"
    else:
        if not isinstance(value, Mapping):
            value = dict(zip((field.name for field in _fields(kind)), value, strict=True))
        for field in _fields(kind):
            try:
                if field.size is None:
                    _write(body, field.kind, value[field.name])
                else:
                    _write_array(body, field, value[field.name])
            except (KeyError, TypeError, struct.error) as error:
                raise BadArgument(kind, f"must have a fitting `{field.name}`: {error}") from error


def _write_array(body: bytearray, field: _Field, value: Any) -> None:
    """Write an array, of numbers in one piece."""
    form = FORMATS.get(field.kind)
    if form is not None:
        value = np.frombuffer(value, "<" + form) if isinstance(value, bytes) else np.asarray(value, "<" + form)
    if field.size and len(value) != field.size:
        raise TypeError(f"{field.size} values are needed, got {len(value)}")
    if not field.size:
        _write(body, "uint32", len(value))
    if form is None:
        for item in value:
            _write(body, field.kind, item)
    elif len(value):  # without items there is nothing to align
        body += b"\x00" * (-len(body) % value.itemsize) + value.tobytes()
