"""Rules of claims: each part of a rule is a condition that numbers of a study must meet.

In `claims.toml` a part is `{ of = "study.number", at_most = 10.0 }`: the path to one or several
numbers, and one of `RULES` with its limit. With `each` in place of `of`, every number is a part of
its own.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.paper.claims.table import Entry
from laticauda.paper.measured import PRINTED_TO

Values = Float[np.ndarray, " n_values"]
Ends = Sequence[float]
"""Smallest and largest value of a range."""


def are_at_most(values: Values, limit: float) -> bool:
    """Return whether no value exceeds the limit."""
    return bool(np.all(values <= limit))


def are_at_least(values: Values, limit: float) -> bool:
    """Return whether all values reach the limit."""
    return bool(np.all(values >= limit))


def are_below(values: Values, limit: float) -> bool:
    """Return whether all values are smaller than the limit."""
    return bool(np.all(values < limit))


def are_above(values: Values, limit: float) -> bool:
    """Return whether all values are larger than the limit."""
    return bool(np.all(values > limit))


def are_within(values: Values, ends: Ends) -> bool:
    """Return whether all values lie in a range."""
    return bool(np.all((values >= ends[0]) & (values <= ends[1])))


def is_any_above(values: Values, limit: float) -> bool:
    """Return whether at least one value is larger than the limit."""
    return bool(np.any(values > limit))


def are_most_below(values: Values, limit: float) -> bool:
    """Return whether more than half of the values are smaller than the limit."""
    return bool(2 * np.sum(values < limit) > values.size)


def is_median_at_least(values: Values, limit: float) -> bool:
    """Return whether the median reaches the limit."""
    return bool(np.median(values) >= limit)


def do_span(values: Values, ends: Ends) -> bool:
    """Return whether the values span a range, as precisely as the paper prints its ends."""
    extremes = [values.min(), values.max()]
    return bool(np.allclose(extremes, ends, rtol=0.0, atol=PRINTED_TO))


RULES: Mapping[str, Callable[[Values, Any], bool]] = {
    "at_most": are_at_most,
    "at_least": are_at_least,
    "below": are_below,
    "above": are_above,
    "within": are_within,
    "any_above": is_any_above,
    "most_below": are_most_below,
    "median_at_least": is_median_at_least,
    "spans": do_span,
}
"""Conditions on the numbers of a part of a rule, by their names in `claims.toml`."""


def check_parts(entry: Entry, numbers: Mapping[str, Any]) -> list[bool]:
    """Return for each part of a claim's rule whether the numbers meet it.

    Args:
        entry: Claim in `claims.toml`.
        numbers: Numbers of all studies, by the names that the table uses.
    """
    parts_met: list[bool] = []
    for part in entry.get("parts", ()):
        parts_met += check_part(part, numbers)
    return parts_met


def check_part(part: Mapping[str, Any], numbers: Mapping[str, Any]) -> list[bool]:
    """Return whether the numbers of a part meet it: together or, if it says `each`, one by one.

    Args:
        part: Path to the numbers, and the rule.
        numbers: Numbers of all studies, by the names that the table uses.
    """
    (name,) = (name for name in part if name in RULES)
    is_met = RULES[name]
    limit = part[name]
    if "each" in part:
        values = _find_values(part["each"], numbers)
        column = values[:, np.newaxis]
        return [is_met(value, limit) for value in column]
    values = _find_values(part["of"], numbers)
    return [is_met(values, limit)]


def _find_values(path: str, numbers: Mapping[str, Any]) -> Values:
    """Return the numbers at a path such as "efficiency.gains.eel_like.measured"."""
    content: Any = numbers
    for name in path.split("."):
        content = content[name]
    return np.atleast_1d(np.array(content, dtype=float))
