"""Co-simulation messages: one JSON object per line, and the fields that each kind of request may have."""

import json
import math
from collections.abc import Mapping
from typing import Any, NoReturn, TypeAlias, cast

from laticauda import scenarios

PROTOCOL_VERSION = 1
"""Increases when the answer to an accepted message changes; new fields do not count."""
MESSAGE_BYTES = 1 << 20
"""Maximum length of a request in bytes, including its line ending."""

Message: TypeAlias = Mapping[str, Any]
"""Fields of a request or an answer, by name."""

LIST_FIELDS = ("references", "enabled", "thrusts", "deflections")
"""Fields that hold one value for each drive."""
COMMAND_FIELDS = ("gait", "offset", "pitch_offset", *LIST_FIELDS, "current")
"""Fields that `step` and `set` change."""
CHOICE_FIELDS = tuple(scenarios.Choice.__dataclass_fields__)
"""Fields that name robot, water and so on."""
MODEL_FIELDS = ("joints", "dt", "ramp", "offset_bandwidth", "root", "sensors", "places")
"""Fields of the model that a message may change."""
START_FIELDS = ("center_of_mass", "heading", "depth", "pitch", "roll")
"""Fields of the initial state."""
SCENARIO_FIELDS = (
    *dict.fromkeys((*CHOICE_FIELDS, *MODEL_FIELDS, *START_FIELDS)),
    "sample_interval",
    "coefficients",
    *COMMAND_FIELDS,
)
"""Fields of a message from which a world is created."""
COMMON_FIELDS = ("do", "id", "protocol", "token")
"""Fields of all requests."""
REQUEST_FIELDS: Mapping[str, tuple[str, ...]] = {
    "reset": SCENARIO_FIELDS,
    "step": ("duration", *COMMAND_FIELDS),
    "set": COMMAND_FIELDS,
    "get": ("series", "since"),
    "run": ("duration", "series", *SCENARIO_FIELDS),
}
"""Fields of each kind of request, in addition to `COMMON_FIELDS`."""
LOAD_FIELDS = ("joint_angle_ref", "joint_torque", "work", "electrical_work")
"""Quantities of the last sample that an answer contains in addition to the observation."""


def read_message(line: bytes) -> dict[str, Any]:
    """Parse the request in a line.

    Args:
        line: The line, without its line ending.

    Raises:
        ValueError: If the line is not a JSON object, or contains a number that is not finite.
    """
    try:
        text = line.decode("utf-8")
        message = json.loads(text, parse_constant=_reject_number, parse_float=_read_finite_number)
    except UnicodeDecodeError:
        raise ValueError(
            "A message must be one line of JSON in UTF-8, got bytes that are not text."
        ) from None
    except RecursionError:
        raise ValueError(
            "A message must be one line of JSON, got brackets that are nested too deeply."
        ) from None
    except json.JSONDecodeError as error:
        raise ValueError(f"A message must be one line of JSON; it is not: {error}.") from None
    if not isinstance(message, dict):
        raise ValueError(
            f"A message must be a JSON object with the field `do`, got {type(message).__name__}."
        )
    return cast("dict[str, Any]", message)


def _reject_number(text: str) -> NoReturn:
    raise ValueError(f"A message must hold finite numbers only, got {text}.")


def _read_finite_number(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        _reject_number(text)
    return number


def write_message(message: Message) -> bytes:
    """Encode an answer as one line, including the line ending."""
    text = json.dumps(message, default=_to_json, allow_nan=False, separators=(",", ":"))
    return text.encode() + b"\n"


def _to_json(value: Any) -> Any:
    """Return arrays and numbers of NumPy as lists and numbers."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} cannot be written as JSON")
