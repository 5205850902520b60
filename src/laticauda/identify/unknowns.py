"""Unknowns to identify: numbers of robot, water or measurement setup, with their ranges and priors."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Literal, NoReturn, cast

from laticauda.models.simulate.numbers import (
    Parameter,
    change_parameters,
    list_parameters,
    suggest_names,
    value_of,
)
from laticauda.scenarios import Scenario
from laticauda.values.checks import (
    check_finite,
    check_label,
    check_not_empty,
    check_positive,
    show_value,
    suggest_nearest,
)
from laticauda.values.errors import BadArgument
from laticauda.values.quantities import Check, check_items, option, quantity, value_class

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

Numbered = tuple[Scenario, Mapping[str, Parameter]]
"""Scenario of a measurement, and the numbers that it has."""

_SIZES = {"m/s": 0.1, "rad": 0.1, "m": 0.1, "W": 10.0}
RANGE = 100.0  # factor by which a number on a log scale may exceed its start or fall below it
_HALVINGS = 60


def numbers_by_name(what: str) -> Check:
    """Return the check of a table of numbers.

    Args:
        what: What each number is, for messages.
    """

    def check(name: str, given: Any) -> dict[str, float]:
        if not isinstance(given, Mapping):
            raise BadArgument(name, f"must be a table of name = {what}, got {show_value(given)}")
        table = cast("Mapping[str, object]", given)
        return {key: check_finite(f"{name}.{key}", number) for key, number in table.items()}

    return check


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
        "Powers p of numbers tied to it: if it changes to k times its value, they change to k^p times theirs",
        default_factory=dict[str, float],
        check=numbers_by_name("power"),
    )

    def __post_init__(self) -> None:
        """Check the fields against each other."""
        if self.prior is not None:
            check_positive(f"sd of the prior` of `{self.name}", self.prior[1])
        low, high = (
            (-math.inf if self.lower is None else self.lower),
            (math.inf if self.upper is None else self.upper),
        )
        if low >= high:
            raise BadArgument(
                f"lower` of `{self.name}", f"must be < its `upper` of {high:g}, got {low:g}"
            )
        if self.scale == "log" and self.lower is not None and self.lower <= 0.0:
            raise BadArgument(
                f"lower` of `{self.name}", f"must be > 0 on a log scale, got {self.lower:g}"
            )
        if self.start is not None and not low <= self.start <= high:
            raise BadArgument(
                f"start` of `{self.name}",
                f"must be between {low:g} and {high:g}, got {self.start:g}",
            )


@dataclass(frozen=True, kw_only=True)
class ResolvedUnknown:
    """An unknown with all fields filled in, and its coordinate in the search: x = log q, or q itself."""

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
    prior: tuple[float, float] | None = None
    """Mean and standard deviation of the prior."""
    is_log: bool
    """Whether x is the logarithm of the value."""
    size: float
    """Size of a large change of x: 1 on a log scale."""
    tied: Mapping[str, float] = field(default_factory=dict[str, float])
    """Powers of the numbers that follow it, by name."""

    @property
    def ends(self) -> tuple[float, float]:
        """Coordinates of the ends of its range; may be infinite."""
        low, high = (
            -math.inf if self.is_log and end <= 0.0 else self.x(end)
            for end in (self.lower, self.upper)
        )
        return low, high

    def x(self, value: float) -> float:
        """Return the coordinate of a value."""
        return math.log(value) if self.is_log else value

    def value(self, x: float) -> float:
        """Return the value of a coordinate, inside its range regardless of rounding."""
        return min(max(math.exp(x) if self.is_log else x, self.lower), self.upper)

    def slope(self, value: float) -> float:
        """Return dq/dx."""
        return value if self.is_log else 1.0


def as_unknowns(
    parameters: Sequence["str | Unknown"] | Mapping[str, tuple[float, float]],
) -> tuple[Unknown, ...]:
    """Convert names, unknowns, or a mapping from names to ranges to unknowns.

    Args:
        parameters: At least one, with different names.

    Raises:
        ValueError: If there is none, or a name occurs twice.
    """

    def unknown(name: str, item: Any) -> Unknown:
        return item if isinstance(item, Unknown) else Unknown(name=check_label(name, item))

    if isinstance(parameters, Mapping):
        found = [
            Unknown(name=name, lower=low, upper=high) for name, (low, high) in parameters.items()
        ]
    else:
        found = check_items(unknown, "a list of names", (), "parameters", parameters)
    check_not_empty("parameters", found, "number to identify")
    names = [unknown.name for unknown in found]
    for name in names:
        if names.count(name) > 1:
            raise BadArgument(
                "parameters", f"must name every number once, got `{name}` {names.count(name)} times"
            )
    return tuple(found)


# ---- looking up names in the measurements, and filling in what was left open ---------------------


def split_name(
    unknown: Unknown, scopes: Sequence[set[str]], known: Sequence[Mapping[str, Parameter]]
) -> tuple[str, str]:
    """Split the name of an unknown into its scope and the rest.

    Raises:
        ValueError: If no measurement has such a number.
    """
    name = unknown.name
    if any(name in names for names in known):
        return "", name
    for scope in sorted({scope for some in scopes for scope in some}, key=len, reverse=True):
        rest = name.removeprefix(f"{scope}.")
        if rest != name:
            mine = [names for some, names in zip(scopes, known, strict=True) if scope in some]
            if not any(rest in names for names in mine):
                _refuse(rest, mine, f"for `{scope}`")
            return scope, rest
    _refuse(name, known, "of the measurements' robot and water")


def _refuse(name: str, known: Sequence[Mapping[str, Parameter]], whose: str) -> NoReturn:
    every = {key: parameter for names in known for key, parameter in names.items()}
    hint = suggest_names(name, every) or suggest_nearest(name, tuple(NUISANCE))
    raise BadArgument("parameters", f"must name numbers {whose}, got {name!r}{hint}")


def known_numbers(scenarios: Sequence[Scenario]) -> list[dict[str, Parameter]]:
    """Return the numbers of each scenario by name; one dictionary for those with the same robot and environment."""
    made: dict[object, dict[str, Parameter]] = {}
    keys = [(id(scenario.robot), id(scenario.environment)) for scenario in scenarios]
    for key, scenario in zip(keys, scenarios, strict=True):
        if key not in made:
            made[key] = list_parameters(scenario, each=True) | NUISANCE
    return [made[key] for key in keys]


def resolve(unknown: Unknown, scope: str, name: str, seen: Sequence[Numbered]) -> ResolvedUnknown:
    """Fill in all fields of an unknown.

    Args:
        unknown: Unknown as requested.
        scope: Scope of the unknown.
        name: Name without the scope.
        seen: Scenarios and numbers of the measurements that depend on it.
    """
    if not seen:
        raise BadArgument(
            "parameters",
            f"must leave measurements for `{unknown.name}`: more specific ones take all",
        )
    scenario, parameter = seen[0][0], seen[0][1][name]
    if name.startswith("gait."):
        rule = f"must not be of the gait, which was commanded, got `{unknown.name}`"
        raise BadArgument(
            "parameters", f"{rule}; how the joints follow it depends on `robot.joint.actuator`"
        )
    if parameter.is_whole:
        raise BadArgument(
            "parameters", f"must be numbers that can vary slightly, got `{unknown.name}`, a count"
        )
    _check_tied(unknown, name, seen)
    start = unknown.start
    if start is None:
        start = 0.0 if name in NUISANCE else value_of(name, scenario, argument="parameters")
        start = start if unknown.lower is None else max(start, unknown.lower)
        start = start if unknown.upper is None else min(start, unknown.upper)
    refusal = partial(_refusal, name, scenario, unknown.tied)
    for end, at in (("start", start), ("lower", unknown.lower), ("upper", unknown.upper)):
        if at is not None and (why := refusal(at)):
            raise BadArgument(
                f"{end}` of `{unknown.name}", f"must be in its range, got {at:g}: {why.rstrip('.')}"
            )
    may_be_less = name in NUISANCE or not refusal(-1e-9 * max(1.0, abs(start)))
    positive_only = start > 0.0 and not may_be_less and unknown.lower != 0.0
    is_log = unknown.scale == "log" if unknown.scale else positive_only
    if is_log and start <= 0.0:
        raise BadArgument(
            f"start` of `{unknown.name}", f"must be > 0 on a log scale, got {start:g}"
        )
    low, high = (
        (start / RANGE, start * RANGE) if is_log else (-math.inf if may_be_less else 0.0, math.inf)
    )
    own_size = max(abs(start), unknown.prior[1] if unknown.prior else 0.0) or _SIZES.get(
        parameter.unit, 1.0
    )
    lower = _end(refusal, start, low) if unknown.lower is None else unknown.lower
    upper = _end(refusal, start, high) if unknown.upper is None else unknown.upper
    return ResolvedUnknown(
        name=unknown.name,
        scope=scope,
        parameter=parameter,
        start=start,
        lower=lower,
        upper=upper,
        prior=unknown.prior,
        is_log=is_log,
        size=1.0 if is_log else unknown.size or own_size,
        tied=unknown.tied,
    )


def with_tied(
    scenario: Scenario, name: str, value: float, tied: Mapping[str, float]
) -> dict[str, float]:
    """Return the value of an unknown and of all numbers tied to it, by name.

    Args:
        scenario: Scenario of the measurement, without identified values.
        name: Name of the unknown, without its scope.
        value: Value of the unknown.
        tied: Powers of the tied numbers, by name.
    """
    if not tied:
        return {name: value}
    factor = value / value_of(name, scenario)
    others = {other: value_of(other, scenario) * factor**power for other, power in tied.items()}
    return {name: value, **others}


def _check_tied(unknown: Unknown, name: str, seen: Sequence[Numbered]) -> None:
    """Reject ties that no measurement can have."""
    where = f"`tied` of `{unknown.name}`"
    for scenario, numbers in seen if unknown.tied else ():
        for other in unknown.tied:
            if (
                other not in numbers
                or other == name
                or other in NUISANCE
                or numbers[other].is_whole
            ):
                raise ValueError(
                    f"{where} must name other numbers of robot and water, got {other!r}."
                )
        if name in NUISANCE or value_of(name, scenario, argument="parameters") <= 0.0:
            raise ValueError(f"{where} must follow a number that is greater than 0.")


def _refusal(name: str, scenario: Scenario, tied: Mapping[str, float], value: float) -> str:
    """Return why a value is out of the range of its field; "" if it is not."""
    if name not in NUISANCE:
        try:
            change_parameters(scenario, with_tied(scenario, name, value, tied))
        except (ValueError, ArithmeticError) as err:
            return str(err)
    return ""


def _end(refusal: Callable[[float], str], inside: float, end: float) -> float:
    """Return the farthest value toward `end` that the field allows."""
    reach = math.copysign(1e6 * max(1.0, abs(inside)), end) if math.isinf(end) else end
    if not refusal(reach):
        return end
    good, bad = inside, reach
    for _ in range(_HALVINGS):
        middle = 0.5 * (good + bad)
        good, bad = (good, middle) if refusal(middle) else (middle, bad)
    return good
