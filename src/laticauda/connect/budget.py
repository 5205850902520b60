"""Memory limits per client and for all clients together: logs, answers being read, and machine code.

Writing a number as text temporarily takes a hundred bytes, and a step needs several copies of its
samples. Large operations therefore wait for a lock, so that only one runs at a time.
"""

import threading
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace

from laticauda.robot import Water
from laticauda.scenarios import Scenario
from laticauda.values.errors import BadArgument

MOST_NUMBERS = 2_000_000  # in one answer: about 40 MB of text
MOST_KINDS = 12  # kinds of moving water that a server compiles
LARGE = 100_000  # numbers, or bytes of a request


@dataclass(frozen=True, kw_only=True)
class Budget:
    """Memory limits of a client, and the lock for operations that temporarily need more."""

    logged: int = 24_000_000
    """Maximum number of values in the log, and in the samples of one request; 8 bytes each [-]."""
    answered: int = 6_400_000
    """Maximum number of values in the answer being read, at most `MOST_NUMBERS`; about 20 bytes each [-]."""
    kinds: set[tuple[object, ...]] = field(default_factory=set[tuple[object, ...]])
    """Kinds of moving water, with their laws, that have been compiled; about 30 MB each, at most `MOST_KINDS`."""
    turn: AbstractContextManager[object] = field(default_factory=threading.RLock)
    """Lock held during a large operation, so that only one runs at a time."""

    def shared(self, clients: int) -> "Budget":
        """Return the share of one of several clients; they all share the lock."""
        answered = min(self.answered // clients, MOST_NUMBERS)
        return replace(self, logged=self.logged // clients, answered=answered)

    def check_kind(self, scenario: Scenario) -> None:
        """Reject a current whose machine code would exceed `MOST_KINDS`.

        Args:
            scenario: Scenario of the run.

        Raises:
            ValueError: If the current is one kind too many.
        """
        water, model = scenario.environment, scenario.model
        if isinstance(water, Water) and water.flow:
            kind = (
                type(model),
                type(model.joints),
                type(water.drag),
                *dict.fromkeys(map(type, water.flow.parts)),
            )
            if kind not in self.kinds and len(self.kinds) >= MOST_KINDS:
                rule = f"must be of a kind that this server has compiled: its limit of {MOST_KINDS} kinds is reached"
                raise BadArgument("current", rule)
            self.kinds.add(kind)

    def turn_for(self, size: int) -> AbstractContextManager[object]:
        """Return the lock for a large operation, or a null context for a small one.

        Args:
            size: Number of values that the operation holds, or of bytes in a request.
        """
        return self.turn if size > LARGE else nullcontext()
