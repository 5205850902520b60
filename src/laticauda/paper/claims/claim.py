"""What a claim is: what the paper says, what was found here, and a verdict by a stated rule."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

Verdict = Literal["holds", "holds in part", "does not hold", "not tested here"]
Finding = tuple[str, Verdict]
"""What was found, and what follows from it."""

MINUS = "\N{MINUS SIGN}"


@dataclass(frozen=True, kw_only=True)
class Claim:
    """One statement of the paper, and what became of it."""

    key: str
    """Short and unique, for references."""
    theme: str
    """What it is about, in a word or two."""
    where: str
    """The section of the paper, and its table or figure."""
    paper: str
    """What the paper says, in our words with its numbers."""
    found: str
    """The numbers that bear on it, from the paper's tables and from the simulation, with the joint law."""
    rule: str
    """When it counts as holding; of several parts all must be met, and in part means that some are."""
    verdict: Verdict
    """What follows from the rule and the numbers."""


@dataclass(frozen=True, kw_only=True)
class Statement:
    """A claim before it is judged."""

    key: str
    """As in `Claim`."""
    where: str
    """As in `Claim`."""
    paper: str
    """As in `Claim`."""
    rule: str
    """As in `Claim`."""
    needs: tuple[str, ...] = ()
    """Which studies it is judged by: efficiency, following, links, side, parity."""
    judge: Callable[..., Finding]
    """From these studies, in this order, to the finding."""


def verdict(*parts: bool) -> Verdict:
    """The verdict on a claim of these parts: all must be met.

    Args:
        parts: Whether each is met.
    """
    return "holds" if all(parts) else "holds in part" if any(parts) else "does not hold"


# ---- words ---------------------------------------------------------------------------------------------------------


def percent(value: float, form: str = "+.0f") -> str:
    """A change as text.

    Args:
        value: [%].
        form: As in `format`.
    """
    return f"{signed(value, form)} %"


def signed(value: float, form: str) -> str:
    """A number as text, with a real minus sign; what rounds to zero has no sign.

    Args:
        value: Any number.
        form: As in `format`.
    """
    text = format(value, form)
    if float(text) == 0.0:
        text = text.lstrip("+-")
    return text.replace("-", MINUS)


def spread(values: Iterable[float], form: str = "+.0f", unit: str = "%") -> str:
    """From the smallest to the largest of several values, as text.

    Args:
        values: At least one.
        form: As in `format`.
        unit: What they are in.
    """
    known = [*values]
    return f"{signed(min(known), form)} to {signed(max(known), form)} {unit}"


def share(values: Sequence[bool]) -> str:
    """How many of them, as text: "3 of 9".

    Args:
        values: Whether each is.
    """
    return f"{sum(values)} of {len(values)}"
