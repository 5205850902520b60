import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from laticauda.control import IntegralLineOfSight, LineOfSight, PathFrame, StraightLine
from laticauda.values.angles import wrap_to_pi

ANGLE = st.floats(-10.0, 10.0)
DELTA = st.floats(0.05, 10.0)


def beside(error, angle=0.0):
    return PathFrame(
        along_track_distance=0.0,
        cross_track_error=error,
        path_tangential_angle=wrap_to_pi(angle),
        curvature=0.0,
        remaining=math.inf,
    )


def heading_ref(law, frame, heading=0.0):
    return law.step(law.init(), frame, heading, 0.0, False)[1]


@given(angle=ANGLE, delta=DELTA, x=st.floats(-20, 20), y=st.floats(-20, 20), heading=ANGLE)
def test_line_of_sight_points_at_the_look_ahead_point(angle, delta, x, y, heading):
    line = StraightLine(angle=angle)
    frame = line.locate(None, np.array([x, y]))[1]
    aim = line.points(np.array([frame.along_track_distance + delta]))[0]
    asked = heading_ref(LineOfSight(look_ahead_distance=delta), frame, heading)
    assert wrap_to_pi(asked - math.atan2(aim[1] - y, aim[0] - x)) == pytest.approx(0.0, abs=1e-9)


def test_along_the_x_axis_it_is_the_papers_equation():
    law = LineOfSight(look_ahead_distance=0.18)
    assert heading_ref(law, beside(1.7352)) == pytest.approx(-math.atan(1.7352 / 0.18))


@given(error=st.floats(-20, 20), angle=ANGLE, heading=ANGLE)
def test_the_heading_asked_for_is_within_half_a_turn_of_the_present_one(error, angle, heading):
    asked = heading_ref(LineOfSight(look_ahead_distance=1.0), beside(error, angle), heading)
    assert abs(asked - heading) <= math.pi + 1e-12


@given(error=st.floats(-20, 20), delta=DELTA, dt=st.floats(0, 1), state=st.floats(-5, 5))
def test_both_laws_are_odd_in_the_error(error, delta, dt, state):
    law = IntegralLineOfSight(look_ahead_distance=delta, integral_gain=0.12)
    one = law.step(state, beside(error), 0.0, dt, False)
    other = law.step(-state, beside(-error), 0.0, dt, False)
    assert other == pytest.approx((-one[0], -one[1]))


@given(error=st.floats(-20, 20), delta=DELTA)
def test_without_gain_the_integral_law_is_line_of_sight(error, delta):
    law = IntegralLineOfSight(look_ahead_distance=delta, integral_gain=0.0)
    asked = law.step(3.0, beside(error), 0.0, 0.1, False)[1]
    assert asked == heading_ref(LineOfSight(look_ahead_distance=delta), beside(error))


def test_the_integral_grows_as_its_law_says():
    law = IntegralLineOfSight(look_ahead_distance=2.0, integral_gain=0.5)
    state = law.init()
    for _ in range(10_000):
        state, asked = law.step(state, beside(0.3), 0.0, 1e-3, False)
    # z = e + sigma y: z' = sigma Delta e / (z^2 + Delta^2), so z^3/3 + Delta^2 z grows by sigma
    # Delta e t.
    z = 0.3 + 0.5 * state
    assert z**3 / 3 + 4 * z - (0.3**3 / 3 + 4 * 0.3) == pytest.approx(
        0.5 * 2.0 * 0.3 * 10.0, rel=1e-3
    )
    assert asked == pytest.approx(-math.atan(z / 2.0))


@given(error=st.floats(-20, 20), state=st.floats(-5, 5))
def test_the_integral_rests_while_the_offset_saturates(error, state):
    law = IntegralLineOfSight(look_ahead_distance=1.62, integral_gain=0.12)
    assert law.step(state, beside(error), 0.0, 0.5, True)[0] == state


def test_far_away_the_integral_hardly_grows():
    law = IntegralLineOfSight(look_ahead_distance=1.0, integral_gain=0.1)
    assert law.step(0.0, beside(50.0), 0.0, 1.0, False)[0] < 0.03
    assert law.step(0.0, beside(1.0), 0.0, 1.0, False)[0] == 0.5


@pytest.mark.parametrize("distance", [0.0, -1.0, 0])
def test_a_look_ahead_distance_that_is_not_positive_is_refused(distance):
    message = rf"`look_ahead_distance` must be > 0 m, got {distance}\."
    with pytest.raises(ValueError, match=message):
        LineOfSight(look_ahead_distance=distance)
    with pytest.raises(ValueError, match=message):
        IntegralLineOfSight(look_ahead_distance=distance, integral_gain=0.1)


def test_other_bad_numbers_are_refused():
    with pytest.raises(
        ValueError, match="`look_ahead_distance` must be a finite number in m, got nan"
    ):
        LineOfSight(look_ahead_distance=math.nan)
    with pytest.raises(ValueError, match=r"`integral_gain` must be >= 0 m/s, got -0\.1"):
        IntegralLineOfSight(look_ahead_distance=1.0, integral_gain=-0.1)
