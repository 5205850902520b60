"""Encoding and decoding of ROS 2 messages in CDR, the encoding that every ROS 2 tool reads.

Log messages are encoded here, from the definitions below, and not by the library
`mcap-ros2-support`: it fills missing values with zeros, truncates what is too long, and is slower,
while a robot waits. Messages of any writer are read by that library. The encoding is little-endian
with each number aligned to its own size, as in version 1 (OMG DDS-XTypes 1.3, "plain CDR"), which
ROS 2 uses.
"""

# The library's messages have the fields of their definitions, which a type checker cannot know.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import functools
import struct
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from laticauda.values import BadArgument, optional_import

if TYPE_CHECKING:
    from mcap.records import Schema

Message: TypeAlias = dict[str, Any]
Content: TypeAlias = Mapping[str, Any] | Sequence[Any]
"""The fields of a message, by name or in the order of its definition."""

_FILE = (Path(__file__).parent / "ros2.msg").read_text(encoding="utf-8")
DEFINITIONS = dict(one.split("\n", 1) for one in _FILE.split("MSG: ")[1:])
"""The message types used in logs, in ROS syntax: one field per line, types of the same package without its name.

A file contains the complete definition of every type that it uses, so that it can be read without
ROS installed.
"""

HEADER = b"\x00\x01\x00\x00"  # plain CDR, little-endian
FORMATS = {"bool": "?", "byte": "B", "uint8": "B", "int32": "i", "uint32": "I", "float64": "d"}
NUMBERS = {kind: struct.Struct("<" + form) for kind, form in FORMATS.items()}
RULE = "=" * 80  # separates the definitions in a schema


class _Field(NamedTuple):
    name: str
    kind: str  # with its package, unless it is a primitive type
    size: int | None  # None: a single value; 0: any number of values; otherwise exactly that many


@functools.cache
def _fields(name: str) -> tuple[_Field, ...]:
    """Return the fields of one definition, without its constants."""
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
    """Return the name of a type in files: `sensor_msgs/msg/JointState` for `sensor_msgs/JointState`."""
    package, kind = name.split("/")
    return f"{package}/msg/{kind}"


def schema_text(name: str) -> str:
    """Return the definition of a type, followed by those of all types that it contains.

    Args:
        name: Name of the type, one of `DEFINITIONS`.
    """
    found = [name]
    for one in found:  # the list grows during the loop
        found += [
            field.kind
            for field in _fields(one)
            if field.kind in DEFINITIONS and field.kind not in found
        ]
    return DEFINITIONS[name] + "".join(
        f"{RULE}\nMSG: {one}\n{DEFINITIONS[one]}" for one in found[1:]
    )


def to_ros_time(nanoseconds: int) -> tuple[int, int]:
    """Convert a time to `builtin_interfaces/Time`: seconds and nanoseconds."""
    return divmod(nanoseconds, 10**9)


def encode(name: str, message: Content) -> bytes:
    """Encode a message as bytes.

    Args:
        name: Name of its type, one of `DEFINITIONS`.
        message: Its fields; those of nested messages in the same form.

    Raises:
        ValueError: If a field is missing or does not fit.
    """
    body = bytearray()
    _write(body, name, message)
    return HEADER + bytes(body)


def decoder(schema: "Schema") -> Callable[[bytes], Message]:
    """Return a function that decodes messages of any writer; it raises ValueError if the bytes are invalid.

    A message is a dict of its fields; a list of numbers is an array, `uint8` lists are bytes.

    Args:
        schema: The definition in the file, including those of the types that it contains.

    Raises:
        MissingExtra: If the package `mcap-ros2-support` is not installed.
        ValueError: If the definition is invalid.
    """
    package = optional_import(
        "Reading messages of ROS 2", "mcap-ros2-support", "logs", "mcap_ros2.decoder"
    )
    name = schema.name.replace("/msg/", "/")
    try:
        read = package.DecoderFactory().decoder_for("cdr", schema)
    except Exception as error:  # its definition parser may raise any exception
        raise ValueError(f"The definition of {name} makes no sense: {error}.") from error

    def decode(data: bytes) -> Message:
        try:
            return _plain(read(data))
        except (
            Exception
        ) as error:  # struct's at the end of the bytes, UnicodeDecodeError, or an undefined type
            raise ValueError(f"A message of {name} is damaged: {error}.") from error

    return decode


def _plain(value: Any) -> Any:
    """Convert what the library read to dicts, lists, arrays and plain values."""
    if isinstance(value, list):
        if value and isinstance(value[0], int | float):
            return np.array(value)
        return [_plain(one) for one in value]
    if hasattr(value, "_full_text"):
        return {name: _plain(getattr(value, name)) for name in value.__slots__}
    return value


# ---- CDR -----------------------------------------------------------------------------------------


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
                raise BadArgument(kind, f"must have a valid `{field.name}`: {error}") from error


def _write_array(body: bytearray, field: _Field, value: Any) -> None:
    """Write an array; numbers are written as one block."""
    form = FORMATS.get(field.kind)
    if form is not None:
        value = (
            np.frombuffer(value, "<" + form)
            if isinstance(value, bytes)
            else np.asarray(value, "<" + form)
        )
    if field.size and len(value) != field.size:
        raise TypeError(f"{field.size} values are needed, got {len(value)}")
    if not field.size:
        _write(body, "uint32", len(value))
    if form is None:
        for item in value:
            _write(body, field.kind, item)
    elif len(value):  # an empty array needs no alignment
        body += b"\x00" * (-len(body) % value.itemsize) + value.tobytes()
