"""What is known of a run that is not the answer to a scenario: one that was measured, or steered by hand."""

import math
from collections.abc import Mapping
from typing import Any, cast

import numpy as np

from laticauda.errors import BadArgument
from laticauda.gaits import Gait
from laticauda.quantities import option, value
from laticauda.robot import Environment, Robot
from laticauda.scenarios.models import Model, settings_of


@value
class Experiment:
    """A run that cannot be run again: of a real robot, of the tank, of a page where something was changed.

    Raises:
        ValueError: If a note is no text or number.
    """

    robot: Robot = option("What swam")
    gait: Gait | None = option("What the joints were asked for; None where no gait was", default=None)
    environment: Environment = option("What it swam or crawled in")
    model: Model | None = option("By which model it was simulated; None: it was not", default=None)
    notes: Mapping[str, Any] = option(
        "What else is known of how the run was made: texts and numbers by name", default_factory=dict[str, Any]
    )

    def __post_init__(self) -> None:
        """Check what its type does not tell."""
        if not isinstance(self.notes, Mapping):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise BadArgument("notes", f"must map names to values, got {type(self.notes).__name__}")
        notes = {name: _plain(name, note) for name, note in self.notes.items() if note is not None}
        object.__setattr__(self, "notes", notes)

    @property
    def settings(self) -> Mapping[str, str | float | bool | None]:
        """The model and the notes in texts and numbers, for people."""
        return {**({} if self.model is None else settings_of(self.model)), **self.notes}

    @property
    def lacks(self) -> str:
        """What a scenario has and this has not, in words."""
        missing = ["what decided its commands", "where it began", *(["a model"] if self.model is None else [])]
        return f"{', '.join(missing[:-1])} and {missing[-1]}"


def _plain(name: str, note: Any) -> str | float:
    """A note as plain data that a file can hold."""
    plain = cast(object, note.item() if isinstance(note, np.generic) else note)
    if isinstance(plain, float) and math.isnan(plain):
        raise BadArgument(f"notes[{name!r}]", "must not be nan")
    if not isinstance(plain, str | float | int):
        raise BadArgument(f"notes[{name!r}]", f"must be a text, number or truth value, got {type(plain).__name__}")
    return plain
