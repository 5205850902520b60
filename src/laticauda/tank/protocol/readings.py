"""Readings of the robot's own sensors: datagrams of JSON, from the robot to whoever subscribes.

A subscriber sends `SUBSCRIBE` once a second. Each time it gets the list of sensors, and then, as
datagrams of their own, their readings. These are numbered per sensor, so that lost ones are noticed.
"""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, cast

PORT = 22224
"""Port of our own."""
SUBSCRIBE = b'{"subscribe":1}'
"""What a subscriber sends, the version of the protocol."""
SUBSCRIBE_INTERVAL = 1.0
"""Time between two of these [s, wall clock]."""
SUBSCRIPTION_TIME = 3.5
"""Time after the last of these during which readings are sent [s, wall clock]."""
LARGEST_DATAGRAM = 65_507
"""Bytes of a datagram at most."""
MOST_SENSORS = 256
"""Sensors of a robot at most."""


@dataclass(frozen=True, kw_only=True)
class SensorList:
    """The sensors of a robot."""

    session: str
    """Name of what sends, new at every start: then numbers and times begin anew."""
    columns: Mapping[str, tuple[str, ...]]
    """Names of the values of each sensor, by its name."""


@dataclass(frozen=True, kw_only=True)
class SentReading:
    """One reading, as it was sent."""

    session: str
    """See `SensorList`."""
    sensor: str
    """Name of the sensor."""
    number: int
    """How many readings of this sensor were sent before."""
    time: float
    """When it was measured, on the clock of the robot [s]."""
    values: tuple[float, ...]
    """Its values in the order of the columns, nan where there is none."""


def encode_list(sensors: SensorList) -> bytes:
    """Return the datagram of a list of sensors.

    Args:
        sensors: The list.
    """
    columns = {name: list(names) for name, names in sensors.columns.items()}
    return _encode({"session": sensors.session, "sensors": columns})


def encode_reading(reading: SentReading) -> bytes:
    """Return the datagram of a reading; nan is null there.

    Args:
        reading: The reading.
    """
    values = [value if math.isfinite(value) else None for value in reading.values]
    return _encode(
        {
            "session": reading.session,
            "sensor": reading.sensor,
            "number": reading.number,
            "time": reading.time,
            "values": values,
        }
    )


def _encode(content: Mapping[str, object]) -> bytes:
    return json.dumps(content, separators=(",", ":")).encode()


def decode_datagram(datagram: bytes) -> SensorList | SentReading | None:
    """Return what is in a datagram; None if it is neither a list of sensors nor a reading.

    Args:
        datagram: Its bytes, which may be anything.
    """
    try:
        content: object = json.loads(datagram)
    except (ValueError, RecursionError):
        return None
    if not isinstance(content, dict):
        return None
    fields = cast("dict[str, Any]", content)
    if not isinstance(fields.get("session"), str):
        return None
    if "sensors" in fields:
        return _decode_list(fields)
    return _decode_reading(fields)


def _decode_list(fields: Mapping[str, Any]) -> SensorList | None:
    sensors = fields["sensors"]
    if not isinstance(sensors, dict):
        return None
    named_columns = cast("dict[str, object]", sensors)
    if len(named_columns) > MOST_SENSORS:
        return None
    columns: dict[str, tuple[str, ...]] = {}
    for name, listed in named_columns.items():
        if not isinstance(listed, list):
            return None
        names = cast("list[object]", listed)
        if not all(isinstance(column, str) for column in names):
            return None
        columns[name] = tuple(map(str, names))
    return SensorList(session=fields["session"], columns=columns)


def _decode_reading(fields: Mapping[str, Any]) -> SentReading | None:
    sensor = fields.get("sensor")
    number = fields.get("number")
    time = _decode_number(fields.get("time"))
    listed = fields.get("values")
    if not isinstance(sensor, str) or type(number) is not int or number < 0:
        return None
    if time is None or not math.isfinite(time) or not isinstance(listed, list):
        return None
    values: list[float] = []
    for content in cast("list[object]", listed):
        value = math.nan if content is None else _decode_number(content)
        if value is None:
            return None
        values.append(value)
    return SentReading(
        session=fields["session"], sensor=sensor, number=number, time=time, values=tuple(values)
    )


def _decode_number(content: object) -> float | None:
    """Return a number; None if it is none, or too large."""
    if type(content) not in (int, float):
        return None
    try:
        return float(cast("float", content))
    except OverflowError:
        return None
