"""JSON Schema of the co-simulation messages, generated from the classes that declare their fields.

The schema gives the type, unit and range of each field, but not which fields are compatible: the
server may reject a message that conforms to the schema, and rejects every message that does not.
"""

import dataclasses
import types
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias, Union, get_args, get_origin, get_type_hints

from laticauda import scenarios
from laticauda.connect import messages
from laticauda.connect.decoding import InitialMessageState
from laticauda.motion.gaits import Gait
from laticauda.robot import Water
from laticauda.scenarios import Observation, Start
from laticauda.trials import FIGURES, LOAD_FIGURES, Trial
from laticauda.values import SERIES, Extensible, Quantity, Series, quantities

Schema: TypeAlias = dict[str, Any]
DIALECT = "https://json-schema.org/draft/2020-12/schema"
NULL: Schema = {"type": "null"}
TEXT: Schema = {"type": "string"}
OBJECT: Schema = {"type": "object"}
NUMBERS: Schema = {"type": "array", "items": {"type": ["number", "null", "array"]}}
"""An array of numbers with any number of axes."""
JSON_TYPES: Mapping[Any, str] = {
    bool: "boolean",
    int: "integer",
    str: "string",
    float: "number",
    type(None): "null",
}
"""Types in JSON, by those of Python."""
DECLARING_CLASSES = (
    scenarios.Scenario,
    scenarios.Spatial,
    Start,
    InitialMessageState,
    scenarios.Choice,
)
"""Classes whose fields are top-level fields of a message; for a repeated name, the later class takes precedence."""
READING: Schema = {
    "type": "object",
    "properties": {
        "time": {"type": ["number", "null"], "description": "When it was measured [s]"},
        "values": NUMBERS,
        "is_new": {"type": "boolean", "description": "Whether it arrived at this instant"},
    },
    "required": ["time", "values", "is_new"],
    "additionalProperties": False,
}
"""What a sensor told last; null where there is nothing to tell."""
WARNINGS: Schema = {
    "type": "array",
    "items": TEXT,
    "description": "What is accepted and hardly meant; left out if nothing is",
}
"""Field of answers with a sentence for each number that is probably in another unit."""
UNDECLARED_FIELDS: Mapping[str, Schema] = {
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
ROBOT_FIELDS: Mapping[str, Schema] = {
    "protocol": {"type": "integer"},
    "version": TEXT,
    "robot": TEXT,
    "n_links": {"type": "integer"},
    "n_joints": {"type": "integer"},
    "link_length": NUMBERS,
    "settings": OBJECT,
}
"""Fields of answers that describe the server and the robot."""


def message_schema() -> Schema:
    """Return the schema of all messages, with `$defs` for each kind of request and its answer."""
    definitions = {request: _request_schema(request) for request in messages.REQUEST_FIELDS}
    for request, answer_schema in _answer_schemas().items():
        definitions[f"{request}_answer"] = answer_schema
    definitions["refusal"] = _object_schema({"error": TEXT}, required=["error"])
    return {
        "$schema": DIALECT,
        "title": f"Messages of laticauda serve, version {messages.PROTOCOL_VERSION}",
        "anyOf": [{"$ref": f"#/$defs/{name}"} for name in definitions],
        "$defs": definitions,
    }


def _request_schema(request: str) -> Schema:
    all_fields: dict[str, Schema] = {}
    for declaring_class in DECLARING_CLASSES:
        all_fields |= _class_fields(declaring_class)
    all_fields["joints"] = _class_fields(scenarios.Spatial)["joints"]
    all_fields["gait"] = _update_schema(Gait)
    all_fields["coefficients"] = _update_schema(Water)
    all_fields |= UNDECLARED_FIELDS
    all_fields["do"] = {"const": request}
    names = (*messages.COMMON_FIELDS, *messages.REQUEST_FIELDS[request])
    fields = {name: all_fields[name] for name in names}
    required = ["do"]
    if request == "step":
        required.append("duration")
    return _object_schema(fields, required=required)


def _answer_schemas() -> dict[str, Schema]:
    """Return the schemas of answers, by request."""
    state = {"observation": _observation_schema()}
    for name in messages.LOAD_FIELDS:
        state[name] = _series_schema(SERIES[name])
    state["warnings"] = WARNINGS
    series: Schema = {"type": "object", "additionalProperties": NUMBERS}
    command = {"command": OBJECT, "warnings": WARNINGS}
    log = {"series": series, "dropped": {"type": "integer", "minimum": 0}}
    description = {**state, **ROBOT_FIELDS, **command}
    figures = {"figures": _figures_schema(), "series": series, "warnings": WARNINGS}
    return {
        "reset": _object_schema({**state, **ROBOT_FIELDS}, required=["observation", *ROBOT_FIELDS]),
        "step": _object_schema(state, required=["observation"]),
        "set": _object_schema(command, required=["command"]),
        "get": {
            "anyOf": [
                _object_schema(log, required=[*log]),
                _object_schema(description, required=["observation", *ROBOT_FIELDS, "command"]),
            ]
        },
        "run": _object_schema(figures, required=["figures"]),
    }


def _observation_schema() -> Schema:
    hints = get_type_hints(Observation)
    fields: dict[str, Schema] = {}
    for field in dataclasses.fields(Observation):
        fields[field.name] = _observed_schema(hints[field.name])
    fields["readings"] = {"type": "object", "additionalProperties": READING}
    return _object_schema(fields, required=[*fields])


def _observed_schema(hint: Any) -> Schema:
    """Return the schema of a field of an observation, of this type."""
    if type(None) in get_args(hint):
        return {"anyOf": [NUMBERS, NULL]}
    if hint is float:
        return {"type": "number"}
    return NUMBERS


def _figures_schema() -> Schema:
    """Return the schema of a trial's summary."""
    figures: dict[str, Schema] = {}
    for figure in FIGURES:
        description = f"{figure.title} [{figure.unit}]"
        figures[figure.name] = {"type": ["number", "null"], "description": description}
    required = ["status", "succeeded", *figures]
    for name in LOAD_FIGURES:  # of trials with loads
        figure = getattr(Trial, name)
        figures[name] = {"type": "number", "description": f"{figure.title} [{figure.unit}]"}
    return {"type": "object", "properties": figures, "required": required}


def _series_schema(series: Series) -> Schema:
    """Return the schema of one sample of a quantity."""
    description = f"{series.text} [{series.units}]"
    if series.dimensions == ("time",):
        return {"type": "number", "description": description}
    return {**NUMBERS, "description": description}


def _object_schema(fields: Mapping[str, Schema], *, required: Sequence[str]) -> Schema:
    """Return the schema of an object with these fields and an `id`."""
    return {
        "type": "object",
        "properties": {"id": {}, **fields},
        "required": list(required),
        "additionalProperties": False,
    }


def _update_schema(updated_class: type) -> Schema:
    """Return the schema of a partial update: any fields of a class, and for a gait also its `kind`."""
    fields = _class_fields(updated_class) | {"kind": TEXT}
    update = {"type": "object", "properties": fields, "additionalProperties": False}
    return {"anyOf": [update, NULL]}


def _class_fields(declaring_class: type) -> dict[str, Schema]:
    """Return the schemas of a class's fields by name, including the names of angles in degrees."""
    hints = quantities.hints_of(declaring_class)
    texts = quantities.texts_of(declaring_class)
    declared_quantities = quantities.quantities_of(declaring_class)
    fields: dict[str, Schema] = {}
    for name, hint in hints.items():
        fields[name] = _field_schema(hint, texts[name], declared_quantities.get(name))
    for name, field in quantities.display_names_of(declaring_class).items():
        in_display_unit = declared_quantities[field].in_display_unit
        fields[name] = _field_schema(hints[field], texts[field], in_display_unit)
    return fields


def _field_schema(hint: Any, text: str, declared: Quantity | None) -> Schema:
    """Return the schema of a field, each choice once; null is equivalent to omitting the field."""
    distinct_choices: list[Schema] = []
    for choice in (*_choices_of_type(hint, declared), NULL):
        if choice not in distinct_choices:
            distinct_choices.append(choice)
    description = text
    if declared is not None:
        description = f"{text} [{declared.unit or '-'}]"
    return {"anyOf": distinct_choices, "description": description}


def _choices_of_type(hint: Any, declared: Quantity | None) -> list[Schema]:
    """Return the schemas that a value of this type may match in JSON."""
    base_type = get_origin(hint) or hint
    arguments = get_args(hint)
    if base_type in (types.UnionType, Union):
        choices: list[Schema] = []
        for member in arguments:
            choices.extend(_choices_of_type(member, declared))
        return choices
    if base_type is Literal:
        return [{"enum": _spellings(arguments)}]
    if base_type is tuple:
        return _choices_of_tuple(arguments, declared)
    if base_type in (float, int) and declared is not None:
        low, high = declared.ends
        return [{"type": JSON_TYPES[base_type], "minimum": low, "maximum": high}]
    if base_type in JSON_TYPES:
        return [{"type": JSON_TYPES[base_type]}]
    if isinstance(base_type, type) and Extensible in base_type.__bases__:
        return _choices_of_extensible(base_type)
    return [OBJECT]


def _spellings(names: Sequence[str]) -> list[str]:
    """Return names with underscores and with hyphens, sorted."""
    spellings: set[str] = set()
    for name in names:
        spellings.add(name)
        spellings.add(name.replace("_", "-"))
    return sorted(spellings)


def _choices_of_tuple(element_types: Sequence[Any], declared: Quantity | None) -> list[Schema]:
    """Return an array of fixed length; or one of any length, for which a number stands if it has one element."""
    items = {"anyOf": _choices_of_type(element_types[0], declared)}
    array: Schema = {"type": "array", "items": items}
    if element_types[-1] is ...:
        return [array, items]
    n_elements = len(element_types)
    return [{**array, "minItems": n_elements, "maxItems": n_elements}]


def _choices_of_extensible(base_class: Any) -> list[Schema]:
    """Return a name, or an object with a `kind`; extensions may add more kinds than the examples."""
    kind = {"type": "string", "examples": list(base_class.names())}
    return [TEXT, {"type": "object", "properties": {"kind": kind}}]
