"""Laws of the angles."""

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, strategies as st
from patience import LONG

from laticauda.values.angles import wrap_to_pi

angles = st.floats(-1e6, 1e6)


@given(angles)
def test_a_wrapped_angle_lies_in_the_half_open_range(angle: float):
    assert -np.pi <= wrap_to_pi(angle) < np.pi


@given(angles)
def test_wrapping_keeps_the_direction(angle: float):
    wrapped = wrap_to_pi(angle)
    # The float 2 pi is off by 2.4e-16, once for every turn that is taken away.
    assert np.cos(wrapped) == pytest.approx(np.cos(angle), abs=1e-9)
    assert np.sin(wrapped) == pytest.approx(np.sin(angle), abs=1e-9)


@given(angles)
def test_wrapping_twice_changes_nothing(angle: float):
    assert wrap_to_pi(wrap_to_pi(angle)) == wrap_to_pi(angle)


@given(st.floats(-np.pi, np.pi, exclude_max=True))
def test_an_angle_in_range_is_left_alone(angle: float):
    assert wrap_to_pi(angle) == angle


@pytest.mark.parametrize(
    ("angle", "expected"),
    [
        (np.pi, -np.pi),
        (-np.pi, -np.pi),
        (3.0 * np.pi, -np.pi),
        (np.nextafter(np.pi, 0.0), np.nextafter(np.pi, 0.0)),
        (np.nextafter(-np.pi, -4.0), np.nextafter(np.pi, 0.0)),
    ],
)
def test_the_edges_of_the_range(angle: float, expected: float):
    assert wrap_to_pi(angle) == expected


def test_an_array_is_wrapped_element_by_element():
    angles = np.array([[0.0, 4.0], [-4.0, np.nan]])
    expected = np.array([[0.0, 4.0 - 2.0 * np.pi], [2.0 * np.pi - 4.0, np.nan]])
    np.testing.assert_array_equal(wrap_to_pi(angles), expected)


def test_a_number_in_gives_a_python_number_out():
    assert type(wrap_to_pi(np.float64(4.0))) is float


@given(angles)
def test_one_angle_is_wrapped_as_an_array_of_them(angle: float):
    assert wrap_to_pi(angle) == wrap_to_pi(np.array([angle]))[0]


def test_what_is_no_angle_stays_nan():
    assert np.isnan(wrap_to_pi(float("nan")))


def test_what_is_no_rotation_is_refused():
    # In a process without the type checker of the tests, as users have it.
    code = """
import numpy as np
from laticauda.values.angles import to_quaternion
for rotation in ({"x": 1}, None, np.eye(2)):
    try:
        to_quaternion(rotation)
    except ValueError as error:
        print(error)
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=LONG
    )
    assert done.stdout.splitlines() == [
        "`rotation` must be an array of numbers, got dict of object.",
        "`rotation` must be an array of numbers, got NoneType of object.",
        "`rotation` must be a matrix of 3 x 3 numbers, got (2, 2).",
    ]
