"""Unknowns resolved: names looked up in the measurements, and everything filled in that was left open."""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from jaxtyping import Bool

from laticauda.errors import BadArgument, nearest
from laticauda.identify.unknowns import NUISANCE, ResolvedUnknown, Unknown, size_of
from laticauda.scenarios import Scenario
from laticauda.simulate.numbers import Parameter, changed, look_up, parameters, value_of

RANGE = 100.0  # a number on a log scale may be so many times its start, or its start so many times it
_HALVINGS = 60


def split_name(
    unknown: Unknown, scopes: Sequence[set[str]], known: Sequence[Mapping[str, Parameter]]
) -> tuple[str, str]:
    """The scope of an unknown's name and the rest.

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
    raise AssertionError


def _refuse(name: str, known: Sequence[Mapping[str, Parameter]], whose: str) -> None:
    every = {key: parameter for names in known for key, parameter in names.items()}
    try:
        look_up(name, every, "parameters")
    except BadArgument as err:
        _, near, hint = err.rule.partition("; the nearest are ")
        words = near + hint or nearest(name, tuple(NUISANCE))
        raise BadArgument("parameters", f"must name numbers {whose}, got {name!r}{words}") from None


def known_numbers(scenarios: Sequence[Scenario]) -> list[dict[str, Parameter]]:
    """The numbers that each scenario has, by name; the same dictionary for what is alike."""
    made: dict[object, dict[str, Parameter]] = {}
    keys = [(id(scenario.robot), id(scenario.environment)) for scenario in scenarios]
    for key, scenario in zip(keys, scenarios, strict=True):
        if key not in made:
            made[key] = parameters(scenario, each=True) | NUISANCE
    return [made[key] for key in keys]


def dependence(
    split: Sequence[tuple[str, str]], scopes: Sequence[set[str]], known: Sequence[Mapping[str, Parameter]]
) -> Bool[np.ndarray, "n_measurements n_unknowns"]:
    """Which measurements depend on which unknowns.

    Where a number is looked for in general and for some, the general one leaves those alone.

    Args:
        split: By unknown, its scope and its name without that.
        scopes: By measurement, what it may be called.
        known: By measurement, the numbers that it has.

    Raises:
        ValueError: If two unknowns are the same number of a measurement.
    """
    moves = np.array(
        [
            [name in numbers and (not scope or scope in mine) for scope, name in split]
            for mine, numbers in zip(scopes, known, strict=True)
        ]
    ).reshape(len(known), len(split))
    for k, (scope, name) in enumerate(split):
        for j, (other_scope, other) in enumerate(split):
            if j != k and other == name and scope and not other_scope:
                moves[:, j] &= ~moves[:, k]
    for k, (scope, name) in enumerate(split):
        twice = [j for j, (_, other) in enumerate(split) if j != k and other == name and any(moves[:, j] & moves[:, k])]
        if twice:
            raise BadArgument(
                "parameters",
                f"must say once per measurement what `{name}` is for, got both `{scope}` and `{split[twice[0]][0]}`",
            )
    return moves


def resolve(
    unknown: Unknown,
    scope: str,
    name: str,
    scenarios: Sequence[Scenario],
    known: Sequence[Mapping[str, Parameter]],
    applies: np.ndarray,
) -> ResolvedUnknown:
    """An unknown with everything filled in."""
    if not applies.any():
        raise BadArgument("parameters", f"must leave something to `{unknown.name}`: more special ones take all of it")
    first = int(np.argmax(applies))
    scenario, parameter = scenarios[first], known[first][name]
    if name.startswith("gait."):
        rule = f"must not be of the gait, which is what was asked for, got `{unknown.name}`"
        raise BadArgument("parameters", f"{rule}; what the joints make of it is the actuator's, `robot.joint.actuator`")
    if parameter.is_whole:
        raise BadArgument("parameters", f"must be numbers that may change a little, got `{unknown.name}`, a count")
    _check_tied(unknown, name, scenarios, known, applies)
    start = unknown.start
    if start is None:
        start = 0.0 if name in NUISANCE else value_of(name, scenario, argument="parameters")
        start = start if unknown.lower is None else max(start, unknown.lower)
        start = start if unknown.upper is None else min(start, unknown.upper)
    is_allowed = _rule(name, scenario, unknown.tied)
    for end, value in (("start", start), ("lower", unknown.lower), ("upper", unknown.upper)):
        if value is not None:
            is_allowed(value, f"`{end}` of `{unknown.name}` must be in the range of the field, got {value:g}")
    may_be_less = name in NUISANCE or _is_allowed(is_allowed, -1e-9 * max(1.0, abs(start)))
    positive_only = start > 0.0 and not may_be_less and unknown.lower != 0.0
    is_log = unknown.scale == "log" if unknown.scale else positive_only
    if is_log and start <= 0.0:
        raise BadArgument(f"start` of `{unknown.name}", f"must be > 0 on a log scale, got {start:g}")
    low, high = (start / RANGE, start * RANGE) if is_log else (-math.inf if may_be_less else 0.0, math.inf)
    lower = _end(is_allowed, start, low) if unknown.lower is None else unknown.lower
    upper = _end(is_allowed, start, high) if unknown.upper is None else unknown.upper
    return ResolvedUnknown(
        name=unknown.name,
        scope=scope,
        parameter=parameter,
        start=start,
        lower=lower,
        upper=upper,
        prior=unknown.prior,
        is_log=is_log,
        size=1.0 if is_log else size_of(unknown, parameter.unit, start),
        tied=unknown.tied,
    )


def with_tied(scenario: Scenario, name: str, value: float, tied: Mapping[str, float]) -> dict[str, float]:
    """The value of an unknown, and of all that follow it.

    Args:
        scenario: What the measurement has without the identification.
        name: Of the unknown, without its scope.
        value: Of it.
        tied: Powers of what follows it, by name.
    """
    if not tied:
        return {name: value}
    factor = value / value_of(name, scenario)
    others = {other: value_of(other, scenario) * factor**power for other, power in tied.items()}
    return {name: value, **others}


def _check_tied(
    unknown: Unknown,
    name: str,
    scenarios: Sequence[Scenario],
    known: Sequence[Mapping[str, Parameter]],
    applies: np.ndarray,
) -> None:
    """Refuse ties that no measurement can have."""
    if not unknown.tied:
        return
    where = f"`tied` of `{unknown.name}`"
    for scenario, numbers, is_one in zip(scenarios, known, applies, strict=True):
        if not is_one:
            continue
        for other in unknown.tied:
            if other not in numbers or other == name or other in NUISANCE or numbers[other].is_whole:
                raise ValueError(f"{where} must name other numbers of robot and water, got {other!r}.")
        if name in NUISANCE or value_of(name, scenario, argument="parameters") <= 0.0:
            raise ValueError(f"{where} must follow a number that is greater than 0.")


def _rule(name: str, scenario: Scenario, tied: Mapping[str, float]) -> Callable[[float, str], None]:
    """What raises a ValueError if a value is out of the range of its field."""

    def check(value: float, words: str) -> None:
        if name not in NUISANCE:
            try:
                changed(scenario, with_tied(scenario, name, value, tied))
            except (ValueError, ArithmeticError) as err:
                raise ValueError(f"{words}: {err}") from None

    return check


def _is_allowed(check: Callable[[float, str], None], value: float) -> bool:
    try:
        check(value, "")
    except ValueError:
        return False
    return True


def _end(check: Callable[[float, str], None], inside: float, end: float) -> float:
    """The farthest value towards `end` that the field allows."""
    reach = math.copysign(1e6 * max(1.0, abs(inside)), end) if math.isinf(end) else end
    if _is_allowed(check, reach):
        return end
    good, bad = inside, reach
    for _ in range(_HALVINGS):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if _is_allowed(check, middle) else (good, middle)
    return good
