"""ROS 2 messages as bytes and back: CDR, the encoding that every ROS 2 tool reads, straight from a type's definition.

A message is a dict of its fields; a list of numbers is an array, `uint8` ones are bytes. Little-endian, each number
aligned to its own size, as in version 1 of the encoding (OMG DDS-XTypes 1.3, "plain CDR"), which ROS 2 uses.
"""

from __future__ import annotations

import functools
import re
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from laticauda.logs.ros2_types import DEFINITIONS

Message: TypeAlias = dict[str, Any]
Write: TypeAlias = Callable[[bytearray, Any], None]
Read: TypeAlias = Callable[[bytes, int], tuple[Any, int]]  # bytes and where -> value and where it ends

HEADER = b"\x00\x01\x00\x00"  # plain CDR, little-endian
FORMATS = {
    "bool": "?",
    "byte": "B",
    "char": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
RULE = "=" * 80  # between the definitions in a schema
FIELD = re.compile(r"(?P<type>[\w/]+?)(?P<array>\[(?:<=)?(?P<size>\d*)\])?\s+(?P<name>\w+)(?:\s+[^=].*)?$")


@dataclass(frozen=True)
class Codec:
    """Writes and reads the messages of one type."""

    encode: Callable[[Mapping[str, Any]], bytes]
    """The bytes of a message; raises ValueError at a field that is missing or does not fit."""
    decode: Callable[[bytes], Message]
    """The message of some bytes; raises ValueError where they are cut short or no such message."""


def schema_name(name: str) -> str:
    """How files call a type: `sensor_msgs/msg/JointState` for `sensor_msgs/JointState`."""
    package, kind = name.split("/")
    return f"{package}/msg/{kind}"


def schema_text(name: str) -> str:
    """The definition of one of our types, followed by those of all types in it.

    Args:
        name: Of the type, one of `DEFINITIONS`.
    """
    found: dict[str, str] = {}

    def collect(one: str) -> None:
        if one not in found:
            found[one] = DEFINITIONS[one]
            for field in _fields(DEFINITIONS[one], one):
                if field.kind not in FORMATS and field.kind != "string":
                    collect(field.kind)

    collect(name)
    first, *others = found.items()
    return first[1] + "".join(f"{RULE}\nMSG: {one}\n{text}" for one, text in others)


@functools.cache
def codec(name: str, text: str | None = None) -> Codec:
    """The codec of a type.

    Args:
        name: Of the type, as `sensor_msgs/JointState`.
        text: Its definition and those of the types in it, as a file's schema has them; None for one of our own types.

    Raises:
        ValueError: If a definition is missing or makes no sense.
    """
    definitions = DEFINITIONS if text is None else _split(name, text)
    write, read = _struct(name, definitions, ())

    def encode(message: Mapping[str, Any]) -> bytes:
        body = bytearray()
        write(body, message)
        return HEADER + bytes(body)

    def decode(data: bytes) -> Message:
        if data[:2] != HEADER[:2]:
            raise ValueError(f"A message of {name} must begin as little-endian CDR, got {data[:4]!r}.")
        try:
            return read(data[4:], 0)[0]
        except (struct.error, ValueError) as error:  # struct's at the end of the bytes, UnicodeDecodeError
            raise ValueError(f"A message of {name} is damaged: {error}.") from error

    return Codec(encode, decode)


def stamp(nanoseconds: int) -> Message:
    """A moment as `builtin_interfaces/Time`."""
    return {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}


# ---- definitions ---------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Field:
    name: str
    kind: str  # with its package, if it is no plain one
    size: int | None  # None: a single value; 0: any number of them; else so many


def _fields(text: str, owner: str) -> list[_Field]:
    """The fields of one definition; constants and comments are none."""
    found: list[_Field] = []
    for line in text.splitlines():
        plain = line.split("#")[0].strip()
        if not plain or re.match(r"[\w/]+\s+\w+\s*=", plain):
            continue
        match = FIELD.match(plain)
        if match is None:
            raise ValueError(f"The definition of {owner} must have lines like `float64 x`, got {plain!r}.")
        kind = match["type"]
        if kind not in FORMATS and kind != "string":
            kind = f"{owner.split('/')[0]}/{kind}" if "/" not in kind else kind.replace("/msg/", "/")
        is_bounded = match["array"] is not None and "<=" in match["array"]
        size = None if match["array"] is None else 0 if is_bounded else int(match["size"] or 0)
        found.append(_Field(match["name"], kind, size))
    return found


def _split(name: str, text: str) -> dict[str, str]:
    """The definitions in a schema by name."""
    first, *others = re.split(r"^=+\r?\n", text, flags=re.MULTILINE)
    found = {name: first}
    for other in others:
        title, _, body = other.partition("\n")
        found[title.removeprefix("MSG:").strip().replace("/msg/", "/")] = body
    return found


# ---- CDR -----------------------------------------------------------------------------------------------------------


def _struct(name: str, definitions: Mapping[str, str], inside: tuple[str, ...]) -> tuple[Write, Read]:
    """What writes and what reads a type of several fields."""
    if name not in definitions or name in inside:
        raise ValueError(f"The schema must define {name}, and not by itself.")
    members: list[tuple[str, Write, Read]] = []
    for field in _fields(definitions[name], name):
        write, read = _value(field.kind, definitions, (*inside, name))
        if field.size is not None:
            write, read = _array(field, write, read)
        members.append((field.name, write, read))

    def write_struct(body: bytearray, value: Any) -> None:
        for member, write, _ in members:
            try:
                write(body, value[member])
            except (KeyError, TypeError) as error:
                raise ValueError(f"`{name}` must have a fitting `{member}`: {error}.") from error
            except struct.error as error:
                raise ValueError(f"`{name}.{member}` must fit its type: {error}.") from error

    def read_struct(data: bytes, at: int) -> tuple[Message, int]:
        found: Message = {}
        for member, _, read in members:
            found[member], at = read(data, at)
        return found, at

    return write_struct, read_struct


def _value(kind: str, definitions: Mapping[str, str], inside: tuple[str, ...]) -> tuple[Write, Read]:
    if kind == "string":
        return _write_string, _read_string
    if kind in FORMATS:
        return _number(FORMATS[kind])
    return _struct(kind, definitions, inside)


def _number(form: str) -> tuple[Write, Read]:
    packer = struct.Struct("<" + form)
    size = packer.size

    def write(body: bytearray, value: Any) -> None:
        body += b"\x00" * (-len(body) % size) + packer.pack(value)

    def read(data: bytes, at: int) -> tuple[Any, int]:
        at += -at % size
        return packer.unpack_from(data, at)[0], at + size

    return write, read


_write_count, _read_count = _number("I")


def _write_string(body: bytearray, value: str) -> None:
    if not isinstance(value, str):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"a text is needed, got {type(value).__name__}")
    text = value.encode()
    _write_count(body, len(text) + 1)
    body += text + b"\x00"


def _read_string(data: bytes, at: int) -> tuple[str, int]:
    count, at = _read_count(data, at)
    if at + count > len(data):
        raise ValueError("a text is cut short")
    return data[at : at + max(count - 1, 0)].decode(), at + count


def _array(field: _Field, write: Write, read: Read) -> tuple[Write, Read]:
    if field.kind in FORMATS and field.kind != "bool":
        return _numbers(field)
    size = field.size or 0

    def write_items(body: bytearray, value: Any) -> None:
        if size and len(value) != size:
            raise TypeError(f"{size} values are needed, got {len(value)}")
        if not size:
            _write_count(body, len(value))
        for item in value:
            write(body, item)

    def read_items(data: bytes, at: int) -> tuple[list[Any], int]:
        count = size
        if not size:
            count, at = _read_count(data, at)
        if count > len(data) - at:  # every item takes a byte at least: a wrong count must not fill the memory
            raise ValueError("a list is cut short")
        found: list[Any] = []
        for _ in range(count):
            item, at = read(data, at)
            found.append(item)
        return found, at

    return write_items, read_items


def _numbers(field: _Field) -> tuple[Write, Read]:
    """An array of numbers, in one piece; of bytes, as bytes."""
    dtype = np.dtype("<" + FORMATS[field.kind])
    size, fixed = dtype.itemsize, field.size or 0
    as_bytes = dtype == np.uint8

    def write(body: bytearray, value: Any) -> None:
        if isinstance(value, bytes | bytearray) and as_bytes:
            count, content = len(value), bytes(value)
        else:
            array = np.asarray(value, dtype=dtype)
            count, content = array.size, array.tobytes()
        if fixed and count != fixed:
            raise TypeError(f"{fixed} values are needed, got {count}")
        if not fixed:
            _write_count(body, count)
        if count:  # without items there is nothing to align
            body += b"\x00" * (-len(body) % size) + content

    def read(data: bytes, at: int) -> tuple[Any, int]:
        count = fixed
        if not fixed:
            count, at = _read_count(data, at)
        if count:
            at += -at % size
        end = at + count * size
        if end > len(data):
            raise ValueError("an array is cut short")
        return (data[at:end] if as_bytes else np.frombuffer(data, dtype, count, at)), end

    return write, read
