"""What a step of a task is, for arrays with one entry per robot, and what is seen of it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from laticauda.planar.school import Motion

Numbers = Float[np.ndarray, " n"]


@dataclass(frozen=True, kw_only=True)
class Range:
    """A quantity that goes from one value to another: an action from -1 to 1, or what an episode draws."""

    name: str
    """Of an action as in `Command` and `Gait`; of a start as in `Start`, `x` and `y` for the center of mass."""
    low: float
    """[SI]."""
    high: float
    """[SI]."""


@dataclass(frozen=True, kw_only=True)
class Step:
    """What happened in one interval; at the start of an episode both motions are the same."""

    drawn: Mapping[str, Numbers]
    """What the episodes drew, by name."""
    before: Motion
    """At the begin of the interval."""
    after: Motion
    """At its end."""
    interval: float
    """[s]."""

    @property
    def power(self) -> Numbers:
        """Mean over the interval [W]."""
        return (self.after.work - self.before.work) / self.interval

    @cached_property
    def velocity(self) -> tuple[Numbers, Numbers]:
        """Over ground at the end, along the heading and to the left of it [m/s]."""
        return in_body_axes(self.after, self.after.velocity_x, self.after.velocity_y)


@dataclass(frozen=True, kw_only=True)
class Sight:
    """One number of an observation."""

    name: str
    """What it is."""
    of: Callable[[Step], Numbers]
    """Itself, after a step [SI]."""
    unit: float = 1.0
    """What is seen as 1 [SI]."""


HEADING_RATE = Sight(name="heading_rate", of=lambda step: step.after.heading_rate)
ALONG = Sight(name="velocity_along", of=lambda step: step.velocity[0], unit=0.1)
ACROSS = Sight(name="velocity_across", of=lambda step: step.velocity[1], unit=0.1)
PHASE = (
    Sight(name="sin_phase", of=lambda step: np.sin(step.after.phase)),
    Sight(name="cos_phase", of=lambda step: np.cos(step.after.phase)),
)


def in_body_axes(motion: Motion, x: Numbers, y: Numbers) -> tuple[Numbers, Numbers]:
    """A vector in world axes, seen along the heading and to the left of it."""
    c, s = np.cos(motion.heading), np.sin(motion.heading)
    return c * x + s * y, c * y - s * x


def log_square(value: Numbers, tolerance: float) -> Numbers:
    """ln(1 + (x/a)^2): (x/a)^2 for small x; from there on ten times the distance costs 4.6 more, wherever it is [-]."""
    return np.log1p((value / tolerance) ** 2)
