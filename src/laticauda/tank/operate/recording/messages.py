"""Entries as messages of a recording, bit for bit, and back; events are messages of another kind.

Each class of entries has a topic, and a ROS type with one field for each of its own: numbers as
float64, commands and mappings as JSON, and everything else as an array of float64. Only classes
that come with the package, or that this process knows, are ever constructed from a file.
"""

import json
import math
from collections.abc import Mapping
from typing import Any, cast, get_args

import numpy as np

from laticauda.control.estimation import (
    Estimate,
    JointSample,
    Learned,
    PoseSample,
    ReferenceSample,
    Status,
)
from laticauda.scenarios import interfaces
from laticauda.tank.operate.recording.entries import Decision, PowerReading, SensorSample
from laticauda.tank.operate.recording.timing import Tick
from laticauda.trials.logs import ros2
from laticauda.values import codec, hints_of

TOPICS: Mapping[str, type[Any]] = {
    "/sample/pose": PoseSample,
    "/sample/joints": JointSample,
    "/sample/references": ReferenceSample,
    "/sample/power": PowerReading,
    "/sample/sensor": SensorSample,
    "/estimate": Estimate,
    "/command": Decision,
    "/loop/tick": Tick,
    "/learned": Learned,
}
"""Topics of the entries that are messages of their own type, with the fields of their class."""
TOPIC_OF = {entry_class: topic for topic, entry_class in TOPICS.items()}
JSON_TYPES = (interfaces.Command, Mapping[str, float], tuple[str, ...])
"""Python types of the fields that are kept as JSON."""
ROS_TYPES = {
    float: "float64",
    float | None: "float64",
    str: "string",
    Status: "string",
    **dict.fromkeys(JSON_TYPES, "string"),
}
"""ROS types of fields by their Python types; all others are arrays."""


NOT_RECORDED = ("energy", "readings")
"""Fields of an `Estimate` that only a simulated robot fills."""


def _recorded_fields(entry_class: type[Any]) -> dict[str, Any]:
    """Return the types of the fields of a class that are recorded, by name."""
    hints = hints_of(entry_class)
    return {name: hint for name, hint in hints.items() if name not in NOT_RECORDED}


def ros_type_of(entry_class: type[Any]) -> str:
    """Return the ROS type of the entries of a class."""
    return f"laticauda_msgs/{entry_class.__name__}"


def _define_ros_type(entry_class: type[Any]) -> str:
    """Return the definition of a ROS type: a line for each field."""
    definition = ""
    for name, hint in _recorded_fields(entry_class).items():
        ros_type = ROS_TYPES.get(hint, "float64[]")
        definition += f"{ros_type} {name}\n"
    return definition


for _entry_class in TOPIC_OF:
    ros2.DEFINITIONS[ros_type_of(_entry_class)] = _define_ros_type(_entry_class)


def content_of(entry: Any) -> list[Any]:
    """Return the content of an entry's message, field by field."""
    entry_class = cast("type[Any]", type(entry))
    return [
        _encode_field(getattr(entry, name), hint)
        for name, hint in _recorded_fields(entry_class).items()
    ]


def entry_of(topic: str, content: Mapping[str, Any]) -> Any:
    """Return the entry in a message.

    Args:
        topic: Topic of the message.
        content: Content of the message, by field.

    Raises:
        KeyError: If a field is missing.
        BadKey: If a text in it is invalid.
        ValueError: If it is not a valid entry.
    """
    entry_class = TOPICS[topic]
    fields = {
        name: _decode_field(name, content[name], hint)
        for name, hint in _recorded_fields(entry_class).items()
    }
    return entry_class(**fields)


def _encode_field(value: Any, hint: Any) -> Any:
    """Return a field as it stands in a message; None becomes nan, or an empty array."""
    if value is None:
        return math.nan if hint in ROS_TYPES else ()
    if hint in JSON_TYPES:
        return json.dumps(codec.encode(value))
    if hint in ROS_TYPES:
        return value
    return value.ravel()


def _decode_field(name: str, content: Any, hint: Any) -> Any:
    """Return a field of an entry from what stands in a message."""
    may_be_none = type(None) in get_args(hint)
    if hint in JSON_TYPES:
        return codec.decode(hint, json.loads(content), name)
    if hint in ROS_TYPES:
        is_nan = content != content
        return None if is_nan and may_be_none else content
    values = np.array(content, dtype=np.float64)
    if not values.size and may_be_none:
        return None
    if name == "rotation" and values.size:
        return values.reshape((3, 3))
    return values.reshape(-1)
