"""Sums that are the same to the last bit under every Python."""

import operator
from collections.abc import Iterable
from functools import reduce


def add_up(numbers: Iterable[float]) -> float:
    """Return the sum of numbers, added one after the other.

    The built-in `sum` corrects rounding errors from Python 3.12 on, so that masses, and every trial
    with them, would differ in their last digits from those of Python 3.11.

    Args:
        numbers: The numbers; without any, the sum is 0.
    """
    return reduce(operator.add, numbers, 0.0)
