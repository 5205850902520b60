"""Common parts of the chapters of the paper's report: templates, and references to figures."""

from collections.abc import Sequence
from functools import cache, partial
from typing import Any

from laticauda.motion.gaits import GAIT_WORDS
from laticauda.show.reports import Chapter, load_templates


@cache
def load_paper_templates() -> Any:
    """Return the Jinja2 environment that renders the paper's templates.

    Raises:
        MissingExtra: If Jinja2 is not installed.
    """
    environment = load_templates("laticauda.paper.report")
    environment.filters |= {"cm": _format_centimeters, "figs": format_figure_numbers}
    environment.globals["words"] = GAIT_WORDS
    return environment


build_paper_chapter = partial(Chapter, templates=load_paper_templates)
"""A chapter of the paper's report."""


def format_figure_numbers(numbers: Sequence[int]) -> str:
    """Format numbers of figures, consecutive ones as a range: "Figs. 12, 14 to 16 and 18".

    Args:
        numbers: At least one number, in ascending order.
    """
    ranges = [_format_range(range_) for range_ in _split_into_ranges(numbers)]
    *first_ranges, last_range = ranges
    text = last_range
    if first_ranges:
        text = f"{', '.join(first_ranges)} and {last_range}"
    if len(numbers) == 1:
        return f"Fig. {text}"
    return f"Figs. {text}"


def _split_into_ranges(numbers: Sequence[int]) -> list[list[int]]:
    """Return the numbers divided into runs of consecutive ones."""
    ranges: list[list[int]] = []
    for number in numbers:
        if ranges and number == ranges[-1][-1] + 1:
            ranges[-1].append(number)
        else:
            ranges.append([number])
    return ranges


def _format_range(numbers: Sequence[int]) -> str:
    if len(numbers) == 1:
        return f"{numbers[0]}"
    return f"{numbers[0]} to {numbers[-1]}"


def _format_centimeters(length: float | None) -> str:
    if length is None:
        return "unknown"
    return f"{100.0 * length:.2g} cm"
