"""Depth keeping: the offset of the pitch joints by which a phase of a mission holds its depth."""

import math
from dataclasses import dataclass

from laticauda.missions.estimate import Estimate
from laticauda.values import quantity, value_class


@dataclass(frozen=True, kw_only=True)
class DepthState:
    """What depth keeping remembers."""

    time: float
    """When the depth was last seen to change [s]."""
    depth: float
    """The depth then [m]."""
    sink_rate: float = 0.0
    """How fast it sinks, averaged [m/s]."""
    offset: float = 0.0
    """Offset of the pitch joints, positive down [rad]."""


@value_class
class DepthKeeping:
    """Holds a depth by the depth gauge alone: it sinks or rises at a rate that makes up the error.

    An offset of the pitch joints bends the body downward or upward, so that its pitch changes as
    long as there is one; no sensor of the pitch is needed.
    """

    settling: float = quantity("s", "Time in which an error is made up", gt=0.0, default=8.0)
    max_slope: float = quantity(
        "", "Largest sink rate, as a share of the swim speed", gt=0.0, le=1.0, default=0.3
    )
    swim_speed: float = quantity("m/s", "Speed through the water", gt=0.0, default=0.2)
    gain: float = quantity("", "Offset per error of the slope", gt=0.0, default=0.5)
    max_offset: float = quantity(
        "rad", "Largest offset to either side", gt=0.0, default=math.radians(8.0)
    )
    averaging: float = quantity(
        "s", "Time over which the sink rate is averaged", gt=0.0, default=2.0
    )

    def step(self, state: DepthState | None, depth: float, estimate: Estimate) -> DepthState | None:
        """Return the state with the offset after an estimate; None while no depth is known.

        Args:
            state: The state before; None: there was none.
            depth: The depth that is to be held [m].
            estimate: What the robot believes.
        """
        if estimate.depth is None:
            return state
        if state is None:
            state = DepthState(time=estimate.time, depth=estimate.depth)
        elapsed = estimate.time - state.time
        sink_rate = state.sink_rate
        if elapsed > 0.0:
            share = min(elapsed / self.averaging, 1.0)
            sink_rate += share * ((estimate.depth - state.depth) / elapsed - sink_rate)
        slope_ref = (depth - estimate.depth) / (self.settling * self.swim_speed)
        slope_ref = min(max(slope_ref, -self.max_slope), self.max_slope)
        offset = self.gain * (slope_ref - sink_rate / self.swim_speed)
        return DepthState(
            time=estimate.time,
            depth=estimate.depth,
            sink_rate=sink_rate,
            offset=min(max(offset, -self.max_offset), self.max_offset),
        )
