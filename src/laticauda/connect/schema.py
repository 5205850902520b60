"""JSON Schema of the co-simulation messages, generated from the classes that declare their fields.

The schema gives the type, unit and range of each field, but not which fields are compatible: the
server may reject a message that conforms to the schema, and rejects every message that does not.
"""

import types
from collections.abc import Mapping
from typing import Any, Literal, TypeAlias, Union, get_args, get_origin, get_type_hints

from laticauda import scenarios
from laticauda.connect import messages
from laticauda.motion.gaits import Gait
from laticauda.robot import Water
from laticauda.scenarios.interfaces import Observation, Start
from laticauda.trials import FIGURES
from laticauda.values import quantities
from laticauda.values.extensions import Extensible
from laticauda.values.quantities import Quantity
from laticauda.values.series import SERIES, Series

Schema: TypeAlias = dict[str, Any]
DIALECT = "https://json-schema.org/draft/2020-12/schema"
NULL: Schema = {"type": "null"}
TEXT: Schema = {"type": "string"}
NUMBERS: Schema = {"type": "array", "items": {"type": ["number", "null", "array"]}}
PLAIN: Mapping[Any, str] = {
    bool: "boolean",
    int: "integer",
    str: "string",
    float: "number",
    type(None): "null",
}
DECLARED = (
    scenarios.Scenario,
    scenarios.Spatial,
    Start,
    messages.InitialMessageState,
    scenarios.Choice,
)
"""Classes whose fields are top-level fields of a message; for a repeated name, the later class takes precedence."""
OWN: Mapping[str, Schema] = {
    "id": {},
    "protocol": {"const": messages.PROTOCOL_VERSION},
    "token": TEXT,
    "duration": {"type": "number", "exclusiveMinimum": 0, "description": "Duration [s]"},
    "since": {"type": "number", "description": "Only samples after this time [s]"},
    "series": {
        "anyOf": [TEXT, {"type": "array", "items": TEXT}],
        "description": "Names of quantities",
    },
}
"""Fields of requests that no class declares."""
ABOUT = {
    "protocol": "integer",
    "version": "string",
    "robot": "string",
    "n_links": "integer",
    "n_joints": "integer",
}


def message_schema() -> Schema:
    """Return the schema of all messages, with `$defs` for each kind of request and its answer."""
    found = {do: _request(do) for do in messages.REQUESTS} | {
        f"{do}_answer": one for do, one in _answers().items()
    }
    found["refusal"] = _object({"error": TEXT}, "error")
    title = f"Messages of laticauda serve, version {messages.PROTOCOL_VERSION}"
    return {
        "$schema": DIALECT,
        "title": title,
        "anyOf": [{"$ref": f"#/$defs/{name}"} for name in found],
        "$defs": found,
    }


def _request(do: str) -> Schema:
    known: dict[str, Schema] = {}
    for kind in DECLARED:
        known |= _fields(kind)
    law = _fields(scenarios.Spatial)["joints"]
    known |= {
        "joints": law,
        "gait": _part(Gait),
        "coefficients": _part(Water),
        **OWN,
        "do": {"const": do},
    }
    fields = {name: known[name] for name in (*messages.COMMON, *messages.REQUESTS[do])}
    return _object(fields, "do", *(["duration"] if do == "step" else []))


def _answers() -> dict[str, Schema]:
    observation = {name: _seen(hint) for name, hint in get_type_hints(Observation).items()}
    seen = {
        "observation": _object(observation, *observation),
        **{name: _logged(SERIES[name]) for name in messages.LOADS},
    }
    about = {name: {"type": kind} for name, kind in ABOUT.items()}
    about |= {"link_length": NUMBERS, "settings": {"type": "object"}}
    series = {"series": {"type": "object", "additionalProperties": NUMBERS}}
    figures = {
        one.name: {"type": ["number", "null"], "description": f"{one.title} [{one.unit}]"}
        for one in FIGURES
    }
    summary = {
        "type": "object",
        "properties": figures,
        "required": ["status", "succeeded", *figures],
    }
    command = {"command": {"type": "object"}}
    log = {**series, "dropped": {"type": "integer", "minimum": 0}}
    return {
        "reset": _object({**seen, **about}, "observation", *about),
        "step": _object(seen, "observation"),
        "set": _object(command, "command"),
        "get": {
            "anyOf": [
                _object(log, *log),
                _object({**seen, **about, **command}, "observation", *about, *command),
            ]
        },
        "run": _object({"figures": summary, **series}, "figures"),
    }


def _object(fields: Mapping[str, Schema], *required: str) -> Schema:
    known = {"id": {}, **fields}
    return {
        "type": "object",
        "properties": known,
        "required": list(required),
        "additionalProperties": False,
    }


def _logged(one: Series) -> Schema:
    kind = {"type": "number"} if one.dimensions == ("time",) else NUMBERS
    return {**kind, "description": f"{one.text} [{one.units}]"}


def _seen(hint: Any) -> Schema:
    if type(None) in get_args(hint):
        return {"anyOf": [NUMBERS, NULL]}
    return {"type": "number"} if hint is float else NUMBERS


def _part(kind: type) -> Schema:
    """Return the schema of a partial update: any fields of a class, and for a gait also its `kind`."""
    fields = _fields(kind) | {"kind": TEXT}
    return {
        "anyOf": [{"type": "object", "properties": fields, "additionalProperties": False}, NULL]
    }


def _fields(kind: type) -> dict[str, Schema]:
    """Return the schemas of a class's fields by name, including the names of angles in degrees."""
    hints, texts, numbers = (
        quantities.hints_of(kind),
        quantities.texts_of(kind),
        quantities.quantities_of(kind),
    )
    found = {name: _field(hint, texts[name], numbers.get(name)) for name, hint in hints.items()}
    for name, plain in quantities.degrees_of(kind).items():
        found[name] = _field(hints[plain], texts[plain], numbers[plain].in_degrees)
    return found


def _field(hint: Any, text: str, declared: Quantity | None) -> Schema:
    unit = f" [{declared.unit or '-'}]" if declared else ""
    choices = {
        str(one): one for one in (*_choices(hint, declared), NULL)
    }  # null is equivalent to omitting the field
    return {"anyOf": list(choices.values()), "description": text + unit}


def _choices(hint: Any, declared: Quantity | None) -> list[Schema]:
    """Return the schemas that a value of this type may match in JSON."""
    base, inner = get_origin(hint) or hint, get_args(hint)
    if base in (types.UnionType, Union):
        return [one for kind in inner for one in _choices(kind, declared)]
    if base is Literal:
        return [{"enum": sorted({form for one in inner for form in (one, one.replace("_", "-"))})}]
    if base is tuple:
        items = {"anyOf": _choices(inner[0], declared)}
        if inner[-1] is not ...:
            return [
                {"type": "array", "items": items, "minItems": len(inner), "maxItems": len(inner)}
            ]
        return [{"type": "array", "items": items}, items]  # a number stands for an array of one
    if base in (float, int) and declared is not None:
        low, high = declared.ends
        return [{"type": PLAIN[base], "minimum": low, "maximum": high}]
    if base in PLAIN:
        return [{"type": PLAIN[base]}]
    if isinstance(base, type) and Extensible in base.__bases__:
        group: Any = base
        kinds = {
            "kind": {"type": "string", "examples": list(group.names())}
        }  # extensions may add more
        return [TEXT, {"type": "object", "properties": kinds}]
    return [{"type": "object"}]
