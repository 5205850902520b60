"""What clients may have in memory, each and all together: their logs, the answers that they read, machine code.

Text takes a hundred bytes for a number while it is made, and a step several copies of its samples: whoever works on
something large waits for the turn, so that there is one such thing at a time.
"""

import threading
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace

from laticauda.errors import BadArgument
from laticauda.robot import Water
from laticauda.scenarios import Scenario

MOST_NUMBERS = 2_000_000  # in one answer: some 40 MB of text
MOST_KINDS = 12  # of moving water that a server compiles
LARGE = 100_000  # numbers, or bytes of a request


@dataclass(frozen=True, kw_only=True)
class Budget:
    """What a client may have in memory, and whose turn it is to have more for a moment."""

    logged: int = 24_000_000
    """Numbers in its log, and in the samples of one request: 8 bytes each [-]."""
    answered: int = 6_400_000
    """Numbers in the answer that it reads, and `MOST_NUMBERS` at most: some 20 bytes each [-]."""
    kinds: set[tuple[object, ...]] = field(default_factory=set[tuple[object, ...]])
    """Of moving water with its laws, for which there is machine code: some 30 MB each, `MOST_KINDS` at most."""
    turn: AbstractContextManager[object] = field(default_factory=threading.RLock)
    """Held by whoever works on something large; one at a time does."""

    def shared(self, clients: int) -> "Budget":
        """The part of one of several clients, who take turns."""
        answered = min(self.answered // clients, MOST_NUMBERS)
        return replace(self, logged=self.logged // clients, answered=answered)

    def check_kind(self, scenario: Scenario) -> None:
        """Refuse a current whose machine code would be one too many.

        Args:
            scenario: Of the run.

        Raises:
            ValueError: If so.
        """
        water, model = scenario.environment, scenario.model
        if isinstance(water, Water) and water.flow:
            kind = (type(model), type(model.joints), type(water.drag), *dict.fromkeys(map(type, water.flow.parts)))
            if kind not in self.kinds and len(self.kinds) >= MOST_KINDS:
                rule = f"must be of a kind that this server has compiled: it has its {MOST_KINDS}, each with other laws"
                raise BadArgument("current", rule)
            self.kinds.add(kind)

    def turn_for(self, size: int) -> AbstractContextManager[object]:
        """Wait for the turn, if something is large.

        Args:
            size: How many numbers it holds, or bytes of a request.
        """
        return self.turn if size > LARGE else nullcontext()
