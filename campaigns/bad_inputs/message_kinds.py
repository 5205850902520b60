"""Odd fields of the messages to `laticauda serve`."""

import contextlib
import io
import json
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from bad_inputs import odd, surface
from bad_inputs.attempt import (
    ACCEPTED,
    PATIENCE,
    REFUSED,
    STOPPED,
    Answer,
    Case,
    fault,
    stopped_after,
)
from laticauda.connect import Session

GREETING: dict[str, Any] = {"do": "reset", "robot": "mamba-fin", "joints": "servo"}
"""A good message, before the bad one."""
GOOD_FIELDS: dict[str, dict[str, Any]] = {
    "reset": {},
    "step": {"duration": 0.05},
    "set": {},
    "get": {},
    "run": {"duration": 0.2},
}
"""What a request of each kind needs."""


def messages(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Odd values in every field of every request, and fields that no request has."""
    targets = surface.find_fields()
    for target in odd.draw_in_turn(rng, targets):
        yield attack_field(target, rng.choice(odd.JSON_VALUES))


def attack_field(target: surface.FieldTarget, value: Any) -> Case:
    """Return the input in which a field of a request has an odd value.

    Args:
        target: The field.
        value: The value.
    """
    message = {"do": target.request, **GOOD_FIELDS.get(target.request, {})}
    inner = message
    for name in target.path[:-1]:
        inner[name] = {}
        inner = inner[name]
    inner[target.path[-1]] = value
    line = json.dumps(message).encode()

    def attack() -> Answer:
        return judge_message(line, target)

    return Case("messages", line.decode()[:200], attack)


def judge_message(line: bytes, target: surface.FieldTarget) -> Answer:
    """Send a message in a session: it is answered in finite numbers or refused by name, and the session goes on.

    Args:
        line: The message.
        target: Its odd field.
    """
    session = Session()
    err = io.StringIO()
    with contextlib.redirect_stderr(err):
        session.answer(json.dumps(GREETING).encode())
        try:
            with stopped_after(PATIENCE):
                answer = _read_answer(session.answer(line))
        except KeyboardInterrupt:
            return STOPPED
        afterwards = _read_answer(session.answer(b'{"do": "get"}'))
    if err.getvalue().strip():
        return fault(err.getvalue().strip()[-500:])
    if "error" in afterwards:
        return fault(f"the session does not go on: {afterwards['error']}")
    if "error" not in answer:
        return ACCEPTED
    names = (
        *target.path,
        *(name.removesuffix("_deg").removesuffix("_deg_s") for name in target.path),
        "`",
        "finite",
    )
    if not any(name in answer["error"] for name in names):
        return fault(f"names nothing: {answer['error']}")
    return REFUSED


def _read_answer(line: bytes) -> dict[str, Any]:
    """Return an answer, which has to be strict JSON."""
    if not line.endswith(b"\n") or line.count(b"\n") != 1:
        raise AssertionError(f"no line: {line[:200]!r}")
    return json.loads(line, parse_constant=_refuse_constant)


def _refuse_constant(word: str) -> None:
    raise ArithmeticError(f"{word} in an answer")
