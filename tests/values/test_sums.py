"""Sums that do not depend on the Python."""

from laticauda.values import add_up


def test_numbers_are_added_one_after_the_other_under_every_python():
    assert add_up([0.1] * 10) == 0.9999999999999999  # Python 3.12's own `sum` says 1.0
    assert add_up(iter([])) == 0.0
    assert add_up([1, 2]) == 3.0
