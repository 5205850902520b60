"""One control of the page: a quantity that can be set, and what its label and its hint say."""

from collections.abc import Callable
from typing import Any, NamedTuple

from laticauda.robot import Water
from laticauda.scenarios import Scenario
from laticauda.show.cockpit.changes import Changes
from laticauda.values import texts_of


class Control(NamedTuple):
    """One quantity that can be set."""

    handle: Any
    """Handle of the control on the page."""
    read: Callable[[Scenario], Any]
    """Returns the value that it shows for a scenario."""
    change: Callable[[Any], Changes]
    """Returns the changes that result from setting it to a value."""


def spell_out(name: str) -> str:
    """Return the name that the page shows."""
    return name.replace("_", " ")


def read_hint(declaring_class: type, field: str, unit: str = "") -> str:
    """Return the text of a field's declaration, with the unit used on the page."""
    text = texts_of(declaring_class)[field]
    if not unit:
        return text
    return f"{text} [{unit}]"


def read_water(scenario: Scenario) -> Water:
    """Return the water of a scenario, which every scenario on a page has."""
    assert isinstance(scenario.environment, Water)
    return scenario.environment
