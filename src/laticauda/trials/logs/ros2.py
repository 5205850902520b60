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


def _read_definitions() -> dict[str, str]:
    """Return the definitions in `ros2.msg` by type; each begins with a line such as `MSG: std_msgs/String`."""
    text = (Path(__file__).parent / "ros2.msg").read_text(encoding="utf-8")
    definitions: dict[str, str] = {}
    for section in text.split("MSG: ")[1:]:
        name, definition = section.split("\n", 1)
        definitions[name] = definition
    return definitions


DEFINITIONS = _read_definitions()
"""The message types used in logs, in ROS syntax: one field per line, types of the same package without its name.

A file contains the complete definition of every type that it uses, so that it can be read without
ROS installed.
"""

HEADER = b"\x00\x01\x00\x00"
"""Begin of every message: plain CDR, little-endian."""
FORMATS = {"bool": "?", "byte": "B", "uint8": "B", "int32": "i", "uint32": "I", "float64": "d"}
"""Numbers of each primitive type, in the language of `struct`."""
PACKERS = {kind: struct.Struct("<" + letter) for kind, letter in FORMATS.items()}
RULE = "=" * 80
"""Line that separates the definitions in a schema."""
NANOSECONDS_PER_SECOND = 10**9


class _Field(NamedTuple):
    """One field of a definition."""

    name: str
    kind: str
    """Its type, with the package unless it is a primitive type."""
    size: int | None
    """None: a single value; 0: any number of values; otherwise exactly that many."""


@functools.cache
def _fields(name: str) -> tuple[_Field, ...]:
    """Return the fields of one definition, without its constants."""
    package = name.split("/")[0]
    fields: list[_Field] = []
    for line in DEFINITIONS[name].splitlines():
        type_text, field_name = line.split()[:2]
        if "=" in field_name:
            continue
        kind, bracket, size_text = type_text.rstrip("]").partition("[")
        is_primitive = kind in FORMATS or kind == "string"
        if not is_primitive and "/" not in kind:
            kind = f"{package}/{kind}"
        size = None
        if bracket:
            size = int(size_text or 0)
        fields.append(_Field(name=field_name, kind=kind, size=size))
    return tuple(fields)


def schema_name(name: str) -> str:
    """Return the name of a type in files: `sensor_msgs/msg/JointState` for `sensor_msgs/JointState`."""
    package, kind = name.split("/")
    return f"{package}/msg/{kind}"


def schema_text(name: str) -> str:
    """Return the definition of a type, followed by those of all types that it contains.

    Args:
        name: Name of the type, one of `DEFINITIONS`.
    """
    kinds = [name]
    for kind in kinds:  # the list grows during the loop
        new_kinds = [
            field.kind
            for field in _fields(kind)
            if field.kind in DEFINITIONS and field.kind not in kinds
        ]
        kinds += new_kinds
    text = DEFINITIONS[name]
    for kind in kinds[1:]:
        text += f"{RULE}\nMSG: {kind}\n{DEFINITIONS[kind]}"
    return text


def to_ros_time(nanoseconds: int) -> tuple[int, int]:
    """Convert a time to `builtin_interfaces/Time`: seconds and nanoseconds."""
    return divmod(nanoseconds, NANOSECONDS_PER_SECOND)


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


def build_decoder(schema: "Schema") -> Callable[[bytes], Message]:
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
        decode_fields = package.DecoderFactory().decoder_for("cdr", schema)
    except Exception as error:  # its definition parser may raise any exception
        raise ValueError(f"The definition of {name} makes no sense: {error}.") from error

    def decode(data: bytes) -> Message:
        try:
            return _simplify(decode_fields(data))
        # struct's at the end of the bytes, UnicodeDecodeError, or an undefined type
        except Exception as error:
            raise ValueError(f"A message of {name} is damaged: {error}.") from error

    return decode


def _simplify(value: Any) -> Any:
    """Convert what the library read to dicts, lists, arrays and plain values."""
    if isinstance(value, list):
        if value and isinstance(value[0], int | float):
            return np.array(value)
        return [_simplify(element) for element in value]
    if hasattr(value, "_full_text"):
        return {name: _simplify(getattr(value, name)) for name in value.__slots__}
    return value


# ---- CDR -----------------------------------------------------------------------------------------


def _write(body: bytearray, kind: str, value: Any) -> None:
    """Write a number, a text, or all fields of a message."""
    if kind in PACKERS:
        packer = PACKERS[kind]
        padding = b"\x00" * (-len(body) % packer.size)
        body += padding + packer.pack(value)
    elif kind == "string":
        _write_text(body, value)
    else:
        _write_fields(body, kind, value)


def _write_text(body: bytearray, text: Any) -> None:
    if not isinstance(text, str):
        raise TypeError(f"a text is needed, got {type(text).__name__}")
    content = text.encode()
    _write(body, "uint32", len(content) + 1)
    body += content + b"\x00"


def _write_fields(body: bytearray, kind: str, message: Content) -> None:
    fields = _fields(kind)
    if isinstance(message, Mapping):
        values = message
    else:
        values = dict(zip((field.name for field in fields), message, strict=True))
    for field in fields:
        try:
            if field.size is None:
                _write(body, field.kind, values[field.name])
            else:
                _write_array(body, field, values[field.name])
        except (KeyError, TypeError, struct.error) as error:
            raise BadArgument(kind, f"must have a valid `{field.name}`: {error}") from error


def _write_array(body: bytearray, field: _Field, values: Any) -> None:
    """Write an array; numbers are written as one block."""
    is_number = field.kind in FORMATS
    if is_number:
        dtype = "<" + FORMATS[field.kind]
        if isinstance(values, bytes):
            values = np.frombuffer(values, dtype)
        else:
            values = np.asarray(values, dtype)
    if field.size and len(values) != field.size:
        raise TypeError(f"{field.size} values are needed, got {len(values)}")
    if not field.size:
        _write(body, "uint32", len(values))
    if not is_number:
        for element in values:
            _write(body, field.kind, element)
    elif len(values):  # an empty array needs no alignment
        padding = b"\x00" * (-len(body) % values.itemsize)
        body += padding + values.tobytes()
