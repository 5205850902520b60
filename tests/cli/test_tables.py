import math

import pytest
from hypothesis import given, strategies as st

from laticauda.cli.tables import (
    align_columns,
    format_figure,
    format_number,
    format_percent,
    spell_with_underscores,
)


def test_columns_are_aligned():
    assert align_columns([("a", "1"), ("bcd", "22")], right=(1,)) == "a     1\nbcd  22"


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.14764, "0.1476"),
        (9.377, "9.377"),
        (106.63, "106.6"),
        (123456.7, "123457"),
        (0.0, "0"),
        (4e-9, "0"),
        (-1.853, "-1.853"),
        (math.inf, "-"),
        (math.nan, "-"),
    ],
)
def test_numbers_have_four_digits(value, shown):
    assert format_number(value) == shown


@given(st.floats(min_value=1e-5, max_value=1e9))
def test_a_shown_number_is_near_its_value(value):
    assert float(format_number(value)) == pytest.approx(value, rel=6e-4)
    assert float(format_number(-value)) == pytest.approx(-value, rel=6e-4)


def test_angles_are_read_in_degrees():
    assert format_figure(math.pi, "rad") == ("180.0", "deg")
    assert format_figure(1.0, "rad/s") == ("57.30", "deg/s")
    assert format_figure(None, "m/s") == ("-", "m/s")


def test_differences_have_a_sign():
    assert format_percent(2.48) == "+2.5 %"
    assert format_percent(-2.48) == "-2.5 %"
    assert format_percent(None) == "-"


@pytest.mark.parametrize(
    ("typed", "name"),
    [
        ("water.normal-drag", "water.normal_drag"),
        (
            "eel_like.robot.module[3].section.half-height",
            "eel_like.robot.module[3].section.half_height",
        ),
        ("run-1.water.normal-drag", "run-1.water.normal_drag"),
        ("robot.module[-1].mass", "robot.module[-1].mass"),
        ("drag-x", "drag-x"),
    ],
)
def test_dashes_of_a_number_are_underscores_and_those_of_a_trial_stay(typed: str, name: str):
    assert spell_with_underscores(typed) == name
