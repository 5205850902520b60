"""A maneuver from which the averaged model is fitted: one gait, and offsets that are held one after the other."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from laticauda.errors import finite, positive
from laticauda.gaits import Gait
from laticauda.interfaces import Command, Controller, Observation
from laticauda.robot import Robot

# To both sides, small and large; ends without, so that the turn can be seen to end.
OFFSETS = tuple(math.radians(degrees) for degrees in (0.0, 5.0, -10.0, 15.0, -5.0, 0.0))


@dataclass(frozen=True, kw_only=True)
class OffsetSteps(Controller[int]):
    """A controller that looks at nothing and steers by a list; the trial keeps the offset among its signals.

    Raises:
        ValueError: If a field is out of its range.
    """

    gait: Gait
    """What swims."""
    offsets: tuple[float, ...] = OFFSETS
    """One after the other, the last one from then on [rad]."""
    interval: float = 12.0
    """How long each is held [s]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        if not self.offsets:
            raise ValueError("`offsets` must hold at least one offset in rad, got none.")
        offsets = tuple(finite(f"offsets[{i}]", value, "rad") for i, value in enumerate(self.offsets))
        object.__setattr__(self, "offsets", offsets)
        object.__setattr__(self, "interval", positive("interval", self.interval, "s"))

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

    @property
    def settings(self) -> Mapping[str, str | float]:
        """How it was made, for the trial's record."""
        return {"offsets": repr(self.offsets), "control_interval": self.interval}

    def check(self, robot: Robot) -> None:
        """Every `robot` will do: a joint beyond its limit ends the run."""
