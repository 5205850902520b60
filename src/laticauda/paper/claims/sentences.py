"""Sentences that tell the numbers of a claim: templates in `claims.toml`, and their filters."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np

from laticauda.paper.report.chapter import load_paper_templates
from laticauda.show.reports import format_number


def fill_in(template: str, numbers: Mapping[str, Any]) -> str:
    """Return the text of a template, with single spaces.

    Args:
        template: Text with references to the numbers.
        numbers: Numbers of all studies, by the names that the template uses.
    """
    text = _compile_template(template).render(numbers)
    return " ".join(text.split())


@cache
def _compile_template(template: str) -> Any:
    environment = load_paper_templates().overlay(autoescape=False)
    environment.filters = {**environment.filters, **FILTERS}
    return environment.from_string(template)


# ---- filters that return text --------------------------------------------------------------------


def format_percent(value: float, form: str = "+.0f") -> str:
    """Format a change in percent.

    Args:
        value: Change [%].
        form: Format of the number, as Python's `format` takes it.
    """
    return f"{format_number(value, form)} %"


def format_spread(values: Sequence[float], form: str = "+.0f", unit: str = "%") -> str:
    """Format the range from the smallest to the largest of several values.

    Args:
        values: At least one value.
        form: Format of the numbers, as Python's `format` takes it.
        unit: Unit of the values.
    """
    return f"{format_number(min(values), form)} to {format_number(max(values), form)} {unit}"


def format_reached(value: float, unit: str) -> str:
    """Format a time or a distance to reach the path; infinite if it is not reached."""
    if math.isfinite(value):
        return f"{value:.2f} {unit}"
    return "(not reached in all cases)"


def format_count(flags: Sequence[bool]) -> str:
    """Format how many of several statements are true: "3 of 4"."""
    return f"{sum(flags)} of {len(flags)}"


# ---- filters that compare with a limit -----------------------------------------------------------


def find_exceeding(values: Sequence[float], limit: float) -> list[bool]:
    """Return for each value whether it is larger than the limit."""
    return [value > limit for value in values]


def find_reaching(values: Sequence[float], limit: float) -> list[bool]:
    """Return for each value whether it is the limit or larger."""
    return [value >= limit for value in values]


def find_reaching_at_most(values: Sequence[float], limit: float) -> list[bool]:
    """Return for each value whether it is the limit or smaller."""
    return [value <= limit for value in values]


def find_falling(changes: Sequence[float]) -> list[bool]:
    """Return for each change whether it is negative."""
    return [change < 0.0 for change in changes]


FILTERS: Mapping[str, Callable[..., Any]] = {
    "exceeding": find_exceeding,
    "falling": find_falling,
    "median": np.median,
    "percent": format_percent,
    "reached": format_reached,
    "reaching": find_reaching,
    "reaching_at_most": find_reaching_at_most,
    "shares": format_count,
    "spread": format_spread,
}
"""Filters of the templates in `claims.toml`, in addition to those of all reports."""
