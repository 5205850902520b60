"""Laws, envelopes, flows and scenes by name: one that comes with laticauda, or MODULE:CLASS of the user's own."""

import sys
from collections.abc import Sequence
from importlib import import_module
from typing import TypeVar

from laticauda import robot
from laticauda.cli.flags import BadFlag, accept_objects
from laticauda.cli.tables import parse_numbers
from laticauda.values import BadArgument, Extensible, LaticaudaError, as_sentence, codec, name_of
from laticauda.water.fluid import Flow

Member = TypeVar("Member", bound=Extensible)

CURRENT_FORM = "a preset or a file and NAME=NUMBER ..., such as swell height=0.2"
CURRENT_METAVAR = "NAME|PATH [NAME=NUMBER ...]"


def import_law(name: str, option: str) -> str:
    """Return the name of a law or an envelope; only MODULE:CLASS is ever imported.

    Args:
        name: Name that was typed.
        option: Field of the option, for messages.

    Raises:
        ValueError: If there is no such class.
    """
    module, colon, class_name = name.partition(":")
    if not colon:
        return name
    if "" not in sys.path:  # as for `python -m`: users' own files are in the current folder
        sys.path.insert(0, "")
    try:
        return name_of(getattr(import_module(module), class_name))
    except (ImportError, AttributeError) as error:
        raise BadArgument(option, f"must be a name or MODULE:CLASS, got {name}: {error}") from None


def find_member(base: type[Member], name: str, option: str) -> Member:
    """Return an instance of a subclass of `base`, given by name or as MODULE:CLASS, with its default values.

    Args:
        base: Base class of drag laws, envelopes or the like.
        name: Name that was typed.
        option: Field of the option, for messages.

    Raises:
        ValueError: If there is no such member.
    """
    try:
        return base.named(import_law(name, option))()
    except TypeError:
        rule = f"must be one whose numbers all have defaults, got {name}"
        raise BadArgument(option, rule) from None
    except BadArgument as error:
        raise BadArgument(option, error.rule) from None


def parse_current(typed: Sequence[str]) -> Flow:
    """Return the flow that was typed: a preset, a file or MODULE:CLASS, then NAME=VALUE for its other numbers.

    Args:
        typed: Words that were typed; an angle under its name with ``-deg``.

    Raises:
        BadFlag: If there is no such flow, or it has no such number.
    """
    name, *assignments = typed
    try:
        flow = _load_flow(name)
        return codec.updated(flow, _parse_changes(assignments))
    except codec.BadKey as error:
        raise BadFlag(f"--current {name}: {error}") from None
    except BadArgument as error:
        raise BadFlag(error.sentence_about("--current")) from None
    except LaticaudaError as error:
        raise BadFlag(as_sentence(f"--current: {error}")) from None


def _load_flow(name: str) -> Flow:
    if ":" in name:
        return find_member(Flow, name, "current")
    return robot.load_current(name)


def _parse_changes(assignments: Sequence[str]) -> dict[str, float]:
    """Return numbers of a flow by name; whole numbers are ints, as in files."""
    changes: dict[str, float] = {}
    for text in assignments:
        assignment = parse_numbers("current", text, CURRENT_FORM)
        (number,) = assignment.numbers
        if number.is_integer():
            number = int(number)
        changes[assignment.name.replace("-", "_")] = number
    return changes


accept_objects(Flow, CURRENT_METAVAR, parse_current)
