"""Conversations keep to the schema, and what does not keep to it is refused."""

import json

import jsonschema
import pytest

import laticauda as lc
from laticauda.connect import Session, message_schema

SCHEMA = message_schema()
HOW = {
    name: jsonschema.Draft202012Validator({"$ref": f"#/$defs/{name}", "$defs": SCHEMA["$defs"]})
    for name in SCHEMA["$defs"]
}


@pytest.fixture
def ask():
    session = Session({"mine": lc.load_robot("chain", 5)})

    def ask(request, **fields):
        message = {"do": request, **fields}
        answer = json.loads(session.answer(json.dumps(message).encode()))
        refused = "error" in answer
        HOW["refusal" if refused else f"{request}_answer"].validate(answer)
        if not refused:
            HOW[request].validate(message)
        return answer

    return ask


def test_the_schema_is_one():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def test_a_conversation_keeps_to_the_schema_in_both_directions(ask):
    gait = {"kind": "eel_like", "amplitude_deg": 30, "frequency_deg_s": 100, "pitch": None}
    answers = [
        ask("reset", robot="mamba-fin", joints="servo", gait=gait, current=[0.1, 0], id=[7]),
        ask("step", duration=0.05, references=[0.1] * 8, enabled=[True] * 8, protocol=1),
        ask("set", references=None, enabled=[], current="turbulence"),
        ask("set", current={"kind": "turbulence", "modes": 6, "mean": [0.1, 0, 0]}),
        ask("get"),
        ask("get", series="time", since=0.01),
        ask("get", series=["joint_torque", "electrical_work", "work"]),
        ask(
            "run",
            duration=1.0,
            series=["time"],
            coefficients={"drag": {"kind": "polynomial-drag", "linear": False}},
        ),
        ask(
            "reset",
            robot="mine",
            joints={"kind": "pd"},
            root=None,
            offset=0.1,
            center_of_mass=[1.0, 2.0],
        ),
        ask("step", duration=0.1, references=[0.0] * 4),
    ]
    assert not any("error" in answer for answer in answers), answers
    assert answers[0]["id"] == [7]


@pytest.mark.parametrize(
    ("request_", "fields"),
    [
        ("step", {"duration": -1}),
        ("step", {}),
        ("step", {"duration": 0.1, "speed": 3}),
        ("reset", {"heading_deg": 10}),
        ("reset", {"model": "walk"}),
        ("reset", {"n_links": 0}),
        ("reset", {"gait": {"amplitude": 9}}),
        ("reset", {"gait": {"amplitude_deg": 900}}),
        ("reset", {"coefficients": {"normal_drag": "much"}}),
        ("reset", {"center_of_mass": [1.0]}),
        ("get", {"series": 3}),
        ("run", {"protocol": 2}),
    ],
)
def test_what_does_not_keep_to_the_schema_is_refused(ask, request_, fields):
    assert not HOW[request_].is_valid({"do": request_, **fields})
    ask("reset")
    assert "error" in ask(request_, **fields)
