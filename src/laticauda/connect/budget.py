"""Memory limits per client and for all clients together: logs, answers being read, and machine code.

Writing a number as text temporarily takes a hundred bytes, and a step needs several copies of its
samples. Large operations therefore wait for a lock, so that only one runs at a time.
"""

import threading
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace

from laticauda.robot import Water
from laticauda.scenarios import Scenario
from laticauda.values import BadArgument

MOST_NUMBERS = 2_000_000
"""Numbers in one answer at most: about 40 MB of text [-]."""
MOST_KINDS = 12
"""Kinds of moving water that a server compiles at most [-]."""
LARGE_OPERATION = 100_000
"""Numbers of an operation, or bytes of a request, above which it needs the lock [-]."""

FlowKind = tuple[object, ...]
"""What a world's machine code depends on: classes of model, joints and drag, and of the parts of the current."""


@dataclass(frozen=True, kw_only=True)
class Budget:
    """Memory limits of a client, and the lock for operations that temporarily need more."""

    max_logged: int = 24_000_000
    """Maximum number of values in the log, and in the samples of one request; 8 bytes each [-]."""
    max_answered: int = 6_400_000
    """Maximum number of values in the answer being read, at most `MOST_NUMBERS`; about 20 bytes each [-]."""
    compiled_kinds: set[FlowKind] = field(default_factory=set[FlowKind])
    """Kinds of moving water that have been compiled; about 30 MB each, at most `MOST_KINDS`."""
    lock: AbstractContextManager[object] = field(default_factory=threading.RLock)
    """Lock held during a large operation, so that only one runs at a time."""

    def share_among(self, n_clients: int) -> "Budget":
        """Return the share of one of several clients; they all share the lock.

        Args:
            n_clients: Number of clients.
        """
        return replace(
            self,
            max_logged=self.max_logged // n_clients,
            max_answered=min(self.max_answered // n_clients, MOST_NUMBERS),
        )

    def check_current(self, scenario: Scenario) -> None:
        """Reject a current whose machine code would exceed `MOST_KINDS`.

        Args:
            scenario: Scenario of the run.

        Raises:
            ValueError: If the current is one kind too many.
        """
        water = scenario.environment
        if not isinstance(water, Water) or not water.flow:
            return
        model = scenario.model
        classes_of_parts = dict.fromkeys(type(part) for part in water.flow.parts)
        kind = (type(model), type(model.joints), type(water.drag), *classes_of_parts)
        if kind not in self.compiled_kinds and len(self.compiled_kinds) >= MOST_KINDS:
            raise BadArgument(
                "current",
                "must be of a kind that this server has compiled: "
                f"its limit of {MOST_KINDS} kinds is reached",
            )
        self.compiled_kinds.add(kind)

    def lock_for(self, size: int) -> AbstractContextManager[object]:
        """Return the lock for a large operation, or a null context for a small one.

        Args:
            size: Number of values that the operation holds, or of bytes in a request.
        """
        if size > LARGE_OPERATION:
            return self.lock
        return nullcontext()
