"""Find unknowns in the measurements by name, and fill in what the user left open.

A name may begin with a scope (a kind of gait, a group or a measurement): the number is then
identified for the measurements of that scope alone.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import NamedTuple, NoReturn

from laticauda.identify.unknowns import (
    NUISANCE,
    Prior,
    ResolvedUnknown,
    Unknown,
    name_field,
)
from laticauda.models.simulate import Parameter, change_parameters, suggest_names, value_of
from laticauda.models.simulate.numbers import ScenarioParameters, list_parameters
from laticauda.scenarios import Scenario
from laticauda.values import BadArgument, suggest_nearest

RANGE = 100.0
"""Factor by which a number on a log scale may exceed its start or fall below it [-]."""
_SIZE_BY_UNIT = {"m/s": 0.1, "rad": 0.1, "m": 0.1, "W": 10.0}
"""A large change of a number that is 0 and has no prior, by its unit; 1 for all other units."""
_SMALLEST_CHANGE = 1e-9
"""How far below 0 a number is tried to see whether it can be negative, per start [-]."""
_FARTHEST = 1e6
"""Factor on the start beyond which no end of an infinite range is tried [-]."""
_HALVINGS = 60
"""Halvings of the interval in which a field's limit lies: down to rounding."""

Refusal = Callable[[float], str]
"""Function that returns why a value is out of the range of its field; "" if it is not."""


class ScopedName(NamedTuple):
    """Name of an unknown, taken apart."""

    scope: str
    """Gait, group or measurement to which it applies; "" for all."""
    name: str
    """Name of the number, without the scope."""


class NumberedScenario(NamedTuple):
    """Scenario of a measurement, and the numbers that it has."""

    scenario: Scenario
    """The scenario."""
    numbers: Mapping[str, Parameter]
    """Its numbers, and those of the measurement itself, by name."""


def split_name(
    unknown: Unknown, scopes: Sequence[set[str]], numbers: Sequence[Mapping[str, Parameter]]
) -> ScopedName:
    """Split the name of an unknown into its scope and the rest.

    Args:
        unknown: Unknown as requested.
        scopes: Scopes to which each measurement belongs.
        numbers: Numbers of each measurement, by name.

    Raises:
        ValueError: If no measurement has such a number.
    """
    full_name = unknown.name
    if any(full_name in of_measurement for of_measurement in numbers):
        return ScopedName(scope="", name=full_name)
    for scope in sorted(set[str]().union(*scopes), key=len, reverse=True):
        name = full_name.removeprefix(f"{scope}.")
        if name == full_name:
            continue
        in_scope = [
            of_measurement
            for own_scopes, of_measurement in zip(scopes, numbers, strict=True)
            if scope in own_scopes
        ]
        if not any(name in of_measurement for of_measurement in in_scope):
            _refuse_name(name, in_scope, f"for `{scope}`")
        return ScopedName(scope=scope, name=name)
    _refuse_name(full_name, numbers, "of the measurements' robot and water")


def _refuse_name(name: str, numbers: Sequence[Mapping[str, Parameter]], whose: str) -> NoReturn:
    all_numbers: dict[str, Parameter] = {}
    hint = ""
    for of_measurement in numbers:
        all_numbers |= of_measurement
        if isinstance(of_measurement, ScenarioParameters):
            hint = hint or of_measurement.explain_items(name)
    hint = hint or suggest_names(name, all_numbers) or suggest_nearest(name, tuple(NUISANCE))
    raise BadArgument("parameters", f"must name numbers {whose}, got {name!r}{hint}")


def body_key(scenario: Scenario) -> tuple[int, int]:
    """Return a key that is the same for scenarios that share robot and environment as objects.

    Objects, not values, decide: `laticauda.models.simulate.batch_scenarios.runs_of` builds one plant for all
    scenarios that hold the same objects, and comparing whole robots would be slow. Whoever uses the
    key holds the scenarios as long as the keys.
    """
    return id(scenario.robot), id(scenario.environment)


def list_numbers(scenarios: Sequence[Scenario]) -> list[Mapping[str, Parameter]]:
    """Return the numbers of each scenario by name; one mapping for those with the same body.

    Args:
        scenarios: Scenarios of the measurements.
    """
    numbers_by_body: dict[tuple[int, int], Mapping[str, Parameter]] = {}
    for scenario in scenarios:
        key = body_key(scenario)
        if key not in numbers_by_body:
            numbers_by_body[key] = list_parameters(scenario) | NUISANCE
    return [numbers_by_body[body_key(scenario)] for scenario in scenarios]


def resolve(
    unknown: Unknown, scoped_name: ScopedName, dependents: Sequence[NumberedScenario]
) -> ResolvedUnknown:
    """Fill in all fields of an unknown.

    Args:
        unknown: Unknown as requested.
        scoped_name: Its name, taken apart.
        dependents: Scenarios and numbers of the measurements that depend on it.

    Raises:
        ValueError: If it cannot be identified, or a field is out of its range.
    """
    if not dependents:
        rule = f"must leave measurements for `{unknown.name}`: more specific ones take all"
        raise BadArgument("parameters", rule)
    name = scoped_name.name
    scenario = dependents[0].scenario
    parameter = dependents[0].numbers[name]
    _check_can_vary(unknown, parameter)
    _check_tied(unknown, name, dependents)
    start = _start_of(unknown, name, scenario)
    refusal = partial(_refusal, name, scenario, unknown.tied)
    _check_values_are_allowed(unknown, start, refusal)
    may_be_negative = name in NUISANCE or _allows_negative(refusal, start)
    is_log = _is_on_log_scale(unknown, start, may_be_negative)
    low, high = _usual_range(start, is_log, may_be_negative)
    lower, upper = unknown.lower, unknown.upper
    if lower is None:
        lower = _farthest_allowed(refusal, start, low)
    if upper is None:
        upper = _farthest_allowed(refusal, start, high)
    prior = None
    if unknown.prior is not None:
        prior = Prior(*unknown.prior)
    return ResolvedUnknown(
        name=unknown.name,
        scope=scoped_name.scope,
        parameter=parameter,
        start=start,
        lower=lower,
        upper=upper,
        prior=prior,
        is_log=is_log,
        size=_size_of(unknown, parameter, start, is_log),
        tied=unknown.tied,
    )


def is_of_gait(name: str) -> bool:
    """Return whether a number is one of the gait.

    Args:
        name: Name of the number, without its scope.
    """
    return name.startswith("gait.")


def _check_can_vary(unknown: Unknown, parameter: Parameter) -> None:
    """Reject numbers of the commanded gait as a whole, and counts."""
    if is_of_gait(parameter.name) and "[" not in parameter.name:
        rule = f"must not be of the gait, which was commanded, got `{unknown.name}`"
        hint = "how the joints follow it depends on `robot.joint.actuator`"
        of_joints = "single joints may move otherwise: `gait.amplitude[4]`, `gait.phase[2]`"
        raise BadArgument("parameters", f"{rule}; {hint}, and {of_joints}")
    if parameter.is_whole:
        rule = f"must be numbers that can vary slightly, got `{unknown.name}`, a count"
        raise BadArgument("parameters", rule)


def _start_of(unknown: Unknown, name: str, scenario: Scenario) -> float:
    """Return where the search starts: as requested, or the measurements' value, in the range."""
    if unknown.start is not None:
        return unknown.start
    start = 0.0
    if name not in NUISANCE:
        start = value_of(name, scenario, argument="parameters")
    if unknown.lower is not None:
        start = max(start, unknown.lower)
    if unknown.upper is not None:
        start = min(start, unknown.upper)
    return start


def _allows_negative(refusal: Refusal, start: float) -> bool:
    """Return whether a field takes negative values.

    A number may be any field of robot and water, and some rules hold between fields: only building
    them says what is allowed. A value just below 0 is allowed exactly if negative ones are.
    """
    just_below_zero = -_SMALLEST_CHANGE * max(1.0, abs(start))
    return not refusal(just_below_zero)


def _check_values_are_allowed(unknown: Unknown, start: float, refusal: Refusal) -> None:
    """Reject a start or a range that robot or water cannot have."""
    values = {"start": start, "lower": unknown.lower, "upper": unknown.upper}
    for field_name, value in values.items():
        if value is None:
            continue
        reason = refusal(value)
        if reason:
            rule = f"must be in its range, got {value:g}: {reason.rstrip('.')}"
            raise BadArgument(name_field(field_name, unknown.name), rule)


def _is_on_log_scale(unknown: Unknown, start: float, may_be_negative: bool) -> bool:
    """Return whether the logarithm is searched: as requested, or for positive numbers."""
    if unknown.scale:
        is_log = unknown.scale == "log"
    else:
        is_log = start > 0.0 and not may_be_negative and unknown.lower != 0.0
    if is_log and start <= 0.0:
        rule = f"must be > 0 on a log scale, got {start:g}"
        raise BadArgument(name_field("start", unknown.name), rule)
    return is_log


def _usual_range(start: float, is_log: bool, may_be_negative: bool) -> tuple[float, float]:
    """Return the range of an unknown for which none was requested."""
    if is_log:
        return start / RANGE, start * RANGE
    if may_be_negative:
        return -math.inf, math.inf
    return 0.0, math.inf


def _size_of(unknown: Unknown, parameter: Parameter, start: float, is_log: bool) -> float:
    """Return the size of a large change of the coordinate."""
    if is_log:
        return 1.0
    prior_sd = 0.0
    if unknown.prior is not None:
        prior_sd = unknown.prior[1]
    usual_size = max(abs(start), prior_sd) or _SIZE_BY_UNIT.get(parameter.unit, 1.0)
    return unknown.size or usual_size


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
    values = {name: value}
    if not tied:
        return values
    factor = value / value_of(name, scenario)
    for tied_name, power in tied.items():
        values[tied_name] = value_of(tied_name, scenario) * factor**power
    return values


def _check_tied(unknown: Unknown, name: str, dependents: Sequence[NumberedScenario]) -> None:
    """Reject ties that no measurement can have."""
    if not unknown.tied:
        return
    argument = name_field("tied", unknown.name)
    for dependent in dependents:
        for tied_name in unknown.tied:
            if tied_name == name or not _can_be_tied(tied_name, dependent.numbers):
                rule = f"must name other numbers of robot and water, got {tied_name!r}"
                raise BadArgument(argument, rule)
        if name in NUISANCE or value_of(name, dependent.scenario, argument="parameters") <= 0.0:
            raise BadArgument(argument, "must follow a number that is greater than 0")


def _can_be_tied(name: str, numbers: Mapping[str, Parameter]) -> bool:
    return name in numbers and name not in NUISANCE and not numbers[name].is_whole


def _refusal(name: str, scenario: Scenario, tied: Mapping[str, float], value: float) -> str:
    """Return why a value is out of the range of its field; "" if it is not."""
    if name in NUISANCE:
        return ""
    try:
        change_parameters(scenario, with_tied(scenario, name, value, tied))
    except (ValueError, ArithmeticError) as error:
        return str(error)
    return ""


def _farthest_allowed(refusal: Refusal, allowed: float, end: float) -> float:
    """Return the farthest value toward `end` that the field allows, from one that it allows."""
    farthest = end
    if math.isinf(end):
        farthest = math.copysign(_FARTHEST * max(1.0, abs(allowed)), end)
    if not refusal(farthest):
        return end
    refused = farthest
    for _ in range(_HALVINGS):
        middle = 0.5 * (allowed + refused)
        if refusal(middle):
            refused = middle
        else:
            allowed = middle
    return allowed
