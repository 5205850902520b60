"""Maneuver that identifies the averaged model: one gait, with offsets held one after the other."""

import math
from collections.abc import Mapping

from laticauda.motion.gaits import Gait
from laticauda.robot import Robot
from laticauda.scenarios import SHORTEST_INTERVAL, Command, Controller, Observation
from laticauda.values import BadArgument, option, quantity, value_class

OFFSETS = tuple(math.radians(degrees) for degrees in (0.0, 5.0, -10.0, 15.0, -5.0, 0.0))
"""Usual offsets [rad]: to both sides, small and large.

The last one is zero, so that the end of the turn is visible.
"""


@value_class
class OffsetSteps(Controller[int]):
    """Open-loop controller that steers by a list of offsets, logged among the trial's signals.

    Raises:
        ValueError: If a field is out of its range.
    """

    gait: Gait = option("Gait that is steered")
    offsets: tuple[float, ...] = quantity(
        "rad", "Offsets in order; the last one is kept", default=OFFSETS
    )
    interval: float = quantity(
        "s", "Time for which each is held", default=12.0, ge=SHORTEST_INTERVAL
    )

    def __post_init__(self) -> None:
        """Check every field once."""
        if not self.offsets:
            raise BadArgument("offsets", "must hold at least one offset in rad, got none")

    @property
    def duration(self) -> float:
        """Duration of the whole list [s]."""
        return self.interval * len(self.offsets)

    def init(self) -> int:
        """Return the number of offsets commanded so far: none."""
        return 0

    def step(self, state: int, observation: Observation) -> tuple[int, Command]:
        """Command the next offset, regardless of the `observation`; `state` counts the offsets.

        Args:
            state: Number of offsets commanded so far.
            observation: Ignored.
        """
        last = len(self.offsets) - 1
        offset = self.offsets[min(state, last)]
        return state + 1, Command(gait=self.gait, offset=offset)

    def signals(self, state: int) -> Mapping[str, float]:
        """Return the offset held in `state`, for the log.

        Args:
            state: Number of offsets commanded so far.
        """
        n_commanded = min(state, len(self.offsets))
        return {"offset": self.offsets[n_commanded - 1]}

    def check(self, robot: Robot) -> None:
        """Accept every `robot`: a joint beyond its limit ends the run.

        Args:
            robot: Any robot.
        """
