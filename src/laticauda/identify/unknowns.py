"""What is identified: a number of robot, water or measuring set-up, with its range and what is known of it before."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, cast

from laticauda.errors import BadArgument, finite, instance, label, positive, shown
from laticauda.quantities import Check, option, quantity, value
from laticauda.simulate.numbers import Parameter

NUISANCE: dict[str, Parameter] = {
    parameter.name: parameter
    for parameter in (
        Parameter(name="measured.heading_offset", unit="rad", title="What the tracker adds to the heading"),
        Parameter(name="measured.offset_x", unit="m", title="Tracked point ahead of the center of mass"),
        Parameter(name="measured.offset_y", unit="m", title="Tracked point to the left of the center of mass"),
        Parameter(name="measured.power_offset", unit="W", title="What the meter adds to the mean power"),
        Parameter(name="start.x", unit="m", title="Where the trial begins: x"),
        Parameter(name="start.y", unit="m", title="Where the trial begins: y"),
        Parameter(name="start.heading", unit="rad", title="Heading at the begin"),
        Parameter(name="start.velocity", unit="m/s", title="Speed at the begin, along the heading"),
    )
}
"""Nuisance parameters: what a measurement brings besides robot and water."""
SIMULATED = ("start.heading", "start.velocity")
"""Those that a run depends on; the others change what is seen of it."""

_SIZES = {"m/s": 0.1, "rad": 0.1, "m": 0.1, "W": 10.0}


def numbers_by_name(what: str) -> Check:
    """The check of a table of numbers.

    Args:
        what: What each of them is, for messages.
    """

    def check(name: str, given: Any) -> dict[str, float]:
        if not isinstance(given, Mapping):
            raise BadArgument(name, f"must be a table of name = {what}, got {shown(given)}")
        table = cast("Mapping[str, object]", given)
        return {key: finite(f"{name}.{key}", number) for key, number in table.items()}

    return check


@value
class Unknown:
    """A number to be identified.

    What is None is filled in by the fit: the start from the robot and water of the measurements, the scale (log for a
    number that is greater than 0 and can never be less), the range (a hundredth to a hundred times the start on a log
    scale, as far as the field allows it), and the size (what it is, or a tenth of m, rad or m/s).

    Numbers that are `tied` follow it, by name without the scope: where this one is k times what the measurements have,
    one with the power p is k^p times that. -1 keeps the product of two: a gear's torque and speed.

    Raises:
        ValueError: If a field is out of its range, or they contradict each other.
    """

    name: str = option("As in a sweep, or of `NUISANCE`; for some only: `eel_like.water.normal_drag`", check=label)
    start: float | None = quantity("", "Where the search begins", default=None)
    lower: float | None = quantity("", "Least value", default=None)
    upper: float | None = quantity("", "Greatest value", default=None)
    prior: tuple[float, float] | None = quantity("", "Mean and deviation of what is known before", default=None)
    scale: Literal["log", "linear"] | None = option("log: errors and steps are shares of it; linear", default=None)
    size: float | None = quantity("", "A large change on a linear scale", default=None, gt=0.0)
    tied: Mapping[str, float] = option(
        "Powers of numbers that follow it", default_factory=dict[str, float], check=numbers_by_name("power")
    )

    def __post_init__(self) -> None:
        """Check what goes together."""
        if self.prior is not None:
            positive(f"sd of the prior` of `{self.name}", self.prior[1])
        low, high = (-math.inf if self.lower is None else self.lower), (math.inf if self.upper is None else self.upper)
        if low >= high:
            raise BadArgument(f"lower` of `{self.name}", f"must be < its `upper` of {high:g}, got {low:g}")
        if self.scale == "log" and self.lower is not None and self.lower <= 0.0:
            raise BadArgument(f"lower` of `{self.name}", f"must be > 0 on a log scale, got {self.lower:g}")
        if self.start is not None and not low <= self.start <= high:
            raise BadArgument(f"start` of `{self.name}", f"must be between {low:g} and {high:g}, got {self.start:g}")


@dataclass(frozen=True, kw_only=True)
class ResolvedUnknown:
    """An unknown with everything filled in, and what the search calls it: x = log q, or q itself."""

    name: str
    """In full, with what it is for."""
    scope: str = ""
    """The gait, group or measurement that it is for; "" for all."""
    parameter: Parameter
    """Name without the scope, unit and title."""
    start: float
    """Where the search begins."""
    lower: float = -math.inf
    """Least value; may be -inf."""
    upper: float = math.inf
    """Greatest value; may be inf."""
    prior: tuple[float, float] | None = None
    """Mean and standard deviation."""
    is_log: bool
    """Whether x is its logarithm."""
    size: float
    """What is a large change of x: 1 on a log scale."""
    tied: Mapping[str, float] = field(default_factory=dict[str, float])
    """Powers of the numbers that follow it, by name."""

    @property
    def ends(self) -> tuple[float, float]:
        """Coordinates of the ends of its range; may be infinite."""
        low, high = (-math.inf if self.is_log and end <= 0.0 else self.x(end) for end in (self.lower, self.upper))
        return low, high

    def x(self, value: float) -> float:
        """The coordinate of a value."""
        return math.log(value) if self.is_log else value

    def value(self, x: float) -> float:
        """The value of a coordinate, inside its range whatever rounding does."""
        return min(max(math.exp(x) if self.is_log else x, self.lower), self.upper)

    def slope(self, value: float) -> float:
        """dq/dx."""
        return value if self.is_log else 1.0


def as_unknowns(parameters: Sequence["str | Unknown"] | Mapping[str, tuple[float, float]]) -> tuple[Unknown, ...]:
    """Names, unknowns, or a mapping from names to ranges as unknowns.

    Args:
        parameters: At least one, no name twice.

    Raises:
        ValueError: If there is none, or a name twice.
    """
    if isinstance(parameters, str):
        raise BadArgument("parameters", f"must be a list of names, got the text {parameters!r}")
    if isinstance(parameters, Mapping):
        found = [Unknown(name=name, lower=low, upper=high) for name, (low, high) in parameters.items()]
    else:
        for item in parameters:
            instance("parameters", item, str, Unknown)
        found = [item if isinstance(item, Unknown) else Unknown(name=item) for item in parameters]
    if not found:
        raise BadArgument("parameters", "must name at least one number to identify, got none")
    names = [unknown.name for unknown in found]
    for name in names:
        if names.count(name) > 1:
            raise BadArgument("parameters", f"must name every number once, got `{name}` {names.count(name)} times")
    return tuple(found)


def size_of(unknown: Unknown, unit: str, start: float) -> float:
    """What a large change of a number on a linear scale is: its own size, if it is not 0.

    Args:
        unknown: That may say so itself.
        unit: Of the number.
        start: Where the search begins.
    """
    if unknown.size is not None:
        return unknown.size
    spread = unknown.prior[1] if unknown.prior else 0.0
    return max(abs(start), spread) or _SIZES.get(unit, 1.0)
