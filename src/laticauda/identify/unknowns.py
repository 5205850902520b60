"""Unknowns to identify: numbers of robot, water or measurement setup, with their ranges and priors.

An `Unknown` is what the user asks for, and may leave fields open. `laticauda.identify.resolving`
finds it in the measurements and fills it in, which makes a `ResolvedUnknown`.

A search moves coordinates x: the logarithm of a value q on a log scale, q itself on a linear one.

Unknowns have different units. They are compared in units of their sizes: a size is a large change
of the coordinate, one after which the robot would swim quite differently. On a log scale it is 1, a
change by the factor e; on a linear one it is the value itself, or what is usual for its unit.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, cast

from laticauda.models.simulate import Parameter
from laticauda.values import (
    BadArgument,
    Check,
    check_finite,
    check_items,
    check_label,
    check_not_empty,
    check_positive,
    option,
    quantity,
    show_value,
    value_class,
)

NUISANCE = {
    parameter.name: parameter
    for parameter in (
        Parameter(
            name="measured.heading_offset", unit="rad", title="What the tracker adds to the heading"
        ),
        Parameter(
            name="measured.offset_x", unit="m", title="Tracked point ahead of the center of mass"
        ),
        Parameter(
            name="measured.offset_y",
            unit="m",
            title="Tracked point to the left of the center of mass",
        ),
        Parameter(
            name="measured.power_offset", unit="W", title="What the meter adds to the mean power"
        ),
        Parameter(name="start.x", unit="m", title="Where the trial begins: x"),
        Parameter(name="start.y", unit="m", title="Where the trial begins: y"),
        Parameter(name="start.heading", unit="rad", title="Heading at the begin"),
        Parameter(name="start.velocity", unit="m/s", title="Speed at the begin, along the heading"),
    )
}
"""Nuisance parameters: those of the measurement rather than of robot and water."""
SIMULATED = ("start.heading", "start.velocity")
"""Nuisance parameters on which a run depends; the others change only what is seen of it."""


KNOWN_FROM_PRIOR = 0.5
"""Share of the prior's variance that is left above which a value is known from the prior [-]."""


def name_field(field_name: str, owner: str) -> str:
    """Return how messages name a field of one of several: `time` of `trial 1`.

    `BadArgument` puts a name in backticks. Those inside this one close the field and open the
    owner.

    Args:
        field_name: Name of the field.
        owner: Name of the measurement or unknown.
    """
    return f"{field_name}` of `{owner}"


class Prior(NamedTuple):
    """Normal distribution of what is known of a value without the measurements."""

    mean: float
    """Most probable value, in the unit of the unknown."""
    sd: float
    """Standard deviation, in the same unit."""


def numbers_by_name(meaning: str) -> Check:
    """Return the check of a table of numbers.

    Args:
        meaning: What each number is, for messages.
    """

    def check_table(name: str, content: Any) -> dict[str, float]:
        if not isinstance(content, Mapping):
            rule = f"must be a table of name = {meaning}, got {show_value(content)}"
            raise BadArgument(name, rule)
        table = cast("Mapping[str, object]", content)
        return {key: check_finite(f"{name}.{key}", number) for key, number in table.items()}

    return check_table


@value_class
class Unknown:
    """A number to be identified.

    The fit fills in fields that are None: the start from the robot and water of the measurements,
    the scale (log for a number that is greater than 0 and can never be negative), the range (a
    hundredth to a hundred times the start on a log scale, as far as the field allows), and the size
    (the value, or a tenth of m, rad or m/s).

    Numbers that are `tied`, by name without the scope, follow it: if this number is k times its
    value in the measurements, a number with power p is k^p times its own. -1 keeps a product
    constant: a gear's torque and speed.

    Raises:
        ValueError: If a field is out of its range, or fields contradict each other.
    """

    name: str = option(
        "As in a sweep or in `NUISANCE`; for one group: `eel_like.water.normal_drag`",
        check=check_label,
    )
    start: float | None = quantity("", "Value at which the search starts", default=None)
    lower: float | None = quantity("", "Smallest value", default=None)
    upper: float | None = quantity("", "Largest value", default=None)
    prior: tuple[float, float] | None = quantity(
        "", "Mean and standard deviation of the prior", default=None
    )
    scale: Literal["log", "linear"] | None = option(
        "log: relative errors and steps; linear: absolute", default=None
    )
    size: float | None = quantity(
        "", "A large change; None: its value, or 0.1 m, rad, m/s", default=None, gt=0.0
    )
    tied: Mapping[str, float] = option(
        "Powers p of numbers tied to it: if it changes to k times its value, "
        "they change to k^p times theirs",
        default_factory=dict[str, float],
        check=numbers_by_name("power"),
    )

    def __post_init__(self) -> None:
        """Check the fields against each other."""
        if self.prior is not None:
            check_positive(name_field("sd of the prior", self.name), self.prior[1])
        lower = -math.inf
        if self.lower is not None:
            lower = self.lower
        upper = math.inf
        if self.upper is not None:
            upper = self.upper
        if lower >= upper:
            rule = f"must be < its `upper` of {upper:g}, got {lower:g}"
            raise BadArgument(name_field("lower", self.name), rule)
        if self.scale == "log" and self.lower is not None and self.lower <= 0.0:
            rule = f"must be > 0 on a log scale, got {self.lower:g}"
            raise BadArgument(name_field("lower", self.name), rule)
        if self.start is not None and not lower <= self.start <= upper:
            rule = f"must be between {lower:g} and {upper:g}, got {self.start:g}"
            raise BadArgument(name_field("start", self.name), rule)


@dataclass(frozen=True, kw_only=True)
class ResolvedUnknown:
    """An unknown with all fields filled in; its coordinate in the search is x = log q, or q."""

    name: str
    """Full name, with the scope."""
    scope: str = ""
    """Gait, group or measurement to which it applies; "" for all."""
    parameter: Parameter
    """Name (without the scope), unit and title."""
    start: float
    """Value at which the search starts."""
    lower: float = -math.inf
    """Smallest value; may be -inf."""
    upper: float = math.inf
    """Largest value; may be inf."""
    prior: Prior | None = None
    """Mean and standard deviation of the prior."""
    is_log: bool
    """Whether x is the logarithm of the value."""
    size: float
    """Size of a large change of x: 1 on a log scale."""
    tied: Mapping[str, float] = field(default_factory=dict[str, float])
    """Powers of the numbers that follow it, by name."""

    def is_known_from_prior(self, sigma: float) -> bool:
        """Return whether a value is hardly better known than by its prior alone.

        Args:
            sigma: Standard deviation of the value, given data and prior.
        """
        if self.prior is None:
            return False
        return sigma**2 > KNOWN_FROM_PRIOR * self.prior.sd**2

    @property
    def is_start(self) -> bool:
        """Whether it is where, or how fast, a single trial began."""
        return self.parameter.name.startswith("start.")

    @property
    def ends(self) -> tuple[float, float]:
        """Coordinates of the ends of its range; may be infinite."""
        return self._coordinate_of_end(self.lower), self._coordinate_of_end(self.upper)

    def _coordinate_of_end(self, end: float) -> float:
        if self.is_log and end <= 0.0:
            return -math.inf
        return self.x(end)

    def x(self, value: float) -> float:
        """Return the coordinate of a value."""
        if self.is_log:
            return math.log(value)
        return value

    def value(self, x: float) -> float:
        """Return the value of a coordinate, inside its range regardless of rounding."""
        value = x
        if self.is_log:
            value = math.exp(x)
        return min(max(value, self.lower), self.upper)

    def slope(self, value: float) -> float:
        """Return dq/dx."""
        if self.is_log:
            return value
        return 1.0


def as_unknowns(
    parameters: Sequence["str | Unknown"] | Mapping[str, tuple[float, float]],
) -> tuple[Unknown, ...]:
    """Convert names, unknowns, or a mapping from names to ranges to unknowns.

    Args:
        parameters: At least one, with different names.

    Raises:
        ValueError: If there is none, or a name occurs twice.
    """
    unknowns = _unknowns_of(parameters)
    check_not_empty("parameters", unknowns, "number to identify")
    names = [unknown.name for unknown in unknowns]
    for name in names:
        if names.count(name) > 1:
            rule = f"must name every number once, got `{name}` {names.count(name)} times"
            raise BadArgument("parameters", rule)
    return unknowns


def _unknowns_of(
    parameters: Sequence["str | Unknown"] | Mapping[str, tuple[float, float]],
) -> tuple[Unknown, ...]:
    if isinstance(parameters, Mapping):
        ranges = parameters.items()
        return tuple(Unknown(name=name, lower=low, upper=high) for name, (low, high) in ranges)
    return check_items(_as_unknown, "a list of names", (), "parameters", parameters)


def _as_unknown(argument: str, name: Any) -> Unknown:
    if isinstance(name, Unknown):
        return name
    return Unknown(name=check_label(argument, name))
