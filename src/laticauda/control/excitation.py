"""A maneuver from which the averaged model is fitted: one gait, and offsets that are held one after the other."""

import math
from collections.abc import Mapping

from laticauda.errors import BadArgument
from laticauda.gaits import Gait
from laticauda.interfaces import Command, Controller, Observation
from laticauda.quantities import option, quantity, value
from laticauda.robot import Robot

# To both sides, small and large; ends without, so that the turn can be seen to end.
OFFSETS = tuple(math.radians(degrees) for degrees in (0.0, 5.0, -10.0, 15.0, -5.0, 0.0))


@value
class OffsetSteps(Controller[int]):
    """A controller that looks at nothing and steers by a list; the trial keeps the offset among its signals.

    Raises:
        ValueError: If a field is out of its range.
    """

    gait: Gait = option("What swims")
    offsets: tuple[float, ...] = quantity("rad", "One after the other, the last one from then on", default=OFFSETS)
    interval: float = quantity("s", "How long each is held", default=12.0, gt=0.0)

    def __post_init__(self) -> None:
        """Check every field once."""
        if not self.offsets:
            raise BadArgument("offsets", "must hold at least one offset in rad, got none")

    @property
    def duration(self) -> float:
        """Of the whole list [s]."""
        return self.interval * len(self.offsets)

    def init(self) -> int:
        """How many offsets were asked for: none."""
        return 0

    def step(self, state: int, observation: Observation) -> tuple[int, Command]:
        """The next offset, whatever the `observation` is; `state` counts them."""
        offset = self.offsets[min(state, len(self.offsets) - 1)]
        return state + 1, Command(gait=self.gait, offset=offset)

    def signals(self, state: int) -> Mapping[str, float]:
        """The offset that is held in `state`, for the log."""
        return {"offset": self.offsets[min(state, len(self.offsets)) - 1]}

    def check(self, robot: Robot) -> None:
        """Every `robot` will do: a joint beyond its limit ends the run."""
