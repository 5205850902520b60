"""Phases of a mission, and the conditions under which it goes from one to another."""

import math

from laticauda.missions.behaviours.behaviour import AnyBehaviour
from laticauda.missions.estimate import Estimate
from laticauda.values import (
    BadArgument,
    Extensible,
    check_label,
    option,
    quantity,
    value_class,
)
from laticauda.values.angles import wrapped


@value_class
class Condition(Extensible, group="conditions"):
    """Base of conditions of transitions. One of one's own is a subclass with `is_met` and `words`."""

    @property
    def words(self) -> str:
        """What is so if it is met, for logs and diagrams."""
        raise NotImplementedError

    def is_met(self, estimate: Estimate) -> bool:
        """Return whether it is met.

        Args:
            estimate: What the robot believes.
        """
        raise NotImplementedError


def _silence_of(estimate: Estimate, sensor: str) -> float:
    """Return for how long a sensor has told nothing new; infinite if it never told anything [s]."""
    return estimate.silence.get(sensor, math.inf)


@value_class
class SensorSilent(Condition):
    """A sensor has told nothing new for some time."""

    sensor: str = option("Its name")
    longer_than: float = quantity("s", "For how long", gt=0.0, default=5.0)

    @property
    def words(self) -> str:
        """See `Condition`."""
        return f"{self.sensor} silent for {self.longer_than:g} s"

    def is_met(self, estimate: Estimate) -> bool:
        """Return whether `estimate` meets it."""
        return _silence_of(estimate, self.sensor) > self.longer_than


@value_class
class SensorHeard(Condition):
    """A sensor tells something again."""

    sensor: str = option("Its name")
    within: float = quantity("s", "How long ago at most", gt=0.0, default=1.0)

    @property
    def words(self) -> str:
        """See `Condition`."""
        return f"{self.sensor} heard"

    def is_met(self, estimate: Estimate) -> bool:
        """Return whether `estimate` meets it."""
        return _silence_of(estimate, self.sensor) <= self.within


@value_class
class BatteryLow(Condition):
    """The battery has less than a share, and what the way home takes."""

    share: float = quantity("", "Share that must be left", ge=0.0, le=1.0, default=0.2)
    share_per_meter: float = quantity(
        "1/m", "Share that is added for every meter from home", ge=0.0, default=0.0
    )
    home: tuple[float, float] = quantity("m", "x and y of home", default=(0.0, 0.0))

    @property
    def words(self) -> str:
        """See `Condition`."""
        if self.share_per_meter == 0.0:
            return f"battery below {100.0 * self.share:g} %"
        return f"battery below {100.0 * self.share:g} % and the way home"

    def is_met(self, estimate: Estimate) -> bool:
        """Return whether `estimate` meets it."""
        if estimate.battery is None:
            return False
        distance = estimate.distance_to(self.home)
        return estimate.battery < self.share + self.share_per_meter * distance


@value_class
class PositionUnsure(Condition):
    """The standard deviation of the position is larger than a limit."""

    limit: float = quantity("m", "The limit", gt=0.0, default=2.0)

    @property
    def words(self) -> str:
        """See `Condition`."""
        return f"position unsure by {self.limit:g} m"

    def is_met(self, estimate: Estimate) -> bool:
        """Return whether `estimate` meets it."""
        return estimate.position_std > self.limit


@value_class
class Captured(Condition):
    """The head is at the latch of a dock, as far as the robot itself can tell: by its beacon and its heading."""

    radius: float = quantity(
        "m", "Distance of the beacon from the head at most", gt=0.0, default=0.35
    )
    heading: float = quantity("rad", "Direction in which the dock is swum into", default=0.0)
    tolerance: float = quantity(
        "rad", "How far the body may point aside", gt=0.0, default=math.radians(50.0)
    )
    beacon: str = option("Name of the acoustic position", default="beacon")
    within: float = quantity("s", "How long ago the beacon was heard at most", gt=0.0, default=2.0)

    @property
    def words(self) -> str:
        """See `Condition`."""
        return f"beacon within {self.radius:g} m"

    def is_met(self, estimate: Estimate) -> bool:
        """Return whether `estimate` meets it."""
        if estimate.beacon_distance is None or estimate.beacon_distance > self.radius:
            return False
        is_heard = _silence_of(estimate, self.beacon) <= self.within
        return is_heard and abs(wrapped(estimate.heading - self.heading)) <= self.tolerance


@value_class
class Touched(Condition):
    """Something presses on the body, as its contact sensor tells: the end of a dock, or an obstacle."""

    force: float = quantity("N", "Force at least", gt=0.0, default=0.5)

    @property
    def words(self) -> str:
        """See `Condition`."""
        return f"touched by {self.force:g} N"

    def is_met(self, estimate: Estimate) -> bool:
        """Return whether `estimate` meets it."""
        return estimate.contact_force is not None and estimate.contact_force >= self.force


@value_class
class Transition:
    """A condition under which another phase begins."""

    when: Condition = option("The condition")
    to: str = option("Name of the phase that begins")
    except_in: tuple[str, ...] = option(
        "For transitions of a whole mission: phases in which it does not count", default=()
    )


@value_class
class Phase:
    """A row of the table of a mission: what the robot does, and what ends it."""

    name: str = option("Its name", check=check_label)
    behaviour: AnyBehaviour = option("What the robot does")
    done: str | None = option("Phase that begins when the behaviour is done", default=None)
    failed: str | None = option("Phase that begins when it has failed", default=None)
    time_limit: float = quantity("s", "Longest time in this phase", gt=0.0, default=math.inf)
    late: str | None = option("Phase that begins after the longest time", default=None)
    transitions: tuple[Transition, ...] = option("Further reasons to end it", default=())
    avoids: bool = option(
        "Whether the robot turns away from what the sonar sees too near ahead", default=True
    )
    depth: float | None = quantity(
        "m", "Depth that is held by the pitch joints; None: it is not steered", default=None
    )

    def __post_init__(self) -> None:
        """Reject a time limit after which nothing happens, and a phase after no time limit."""
        if self.late is None and math.isfinite(self.time_limit):
            rule = "must be left out, or `late` must name the phase that begins after it"
            raise BadArgument("time_limit", f"{rule}, got {self.time_limit:g} s")
        if self.late is not None and math.isinf(self.time_limit):
            rule = "must be given together with `time_limit`, which has none here"
            raise BadArgument("late", f"{rule}, got {self.late!r}")
