import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, example, given, strategies as st
from scipy.integrate import quad

from laticauda.control import Polyline, Spline, StraightLine
from laticauda.values.angles import wrap_to_pi

COORDINATE = st.floats(-20.0, 20.0)
POINT = st.tuples(COORDINATE, COORDINATE)
ANGLE = st.floats(-7.0, 7.0)


@st.composite
def waypoints(draw, least=2, most=7, turn=2.0):
    """Points with room between neighbors, that never turn back sharply: a path that somebody could mean."""
    x, y, angle = 0.0, 0.0, draw(ANGLE)
    points = [(x, y)]
    for _ in range(draw(st.integers(least - 1, most - 1))):
        step = draw(st.floats(0.5, 8.0))
        angle += draw(st.floats(-turn, turn))
        x, y = x + step * math.cos(angle), y + step * math.sin(angle)
        points.append((x, y))
    return tuple(points)


def located(path, position):
    return path.locate(path.init(), np.array(position, dtype=float))[1]


@given(point=POINT, angle=ANGLE, along=st.floats(-50.0, 50.0), left=st.floats(-50.0, 50.0))
def test_a_line_tells_how_far_along_and_how_far_to_the_left(point, angle, along, left):
    line = StraightLine(point=point, angle=angle)
    x, y = line.points(np.array([along]))[0] + left * np.array([-math.sin(angle), math.cos(angle)])
    frame = located(line, (x, y))
    assert frame.along_track_distance == pytest.approx(along, abs=1e-9)
    assert frame.cross_track_error == pytest.approx(left, abs=1e-9)
    assert frame.path_tangential_angle == wrap_to_pi(angle)
    assert (frame.curvature, frame.remaining) == (0.0, math.inf)


def test_a_position_in_space_is_seen_from_above():
    for path in (
        StraightLine(),
        Polyline(waypoints=((0, 0), (9, 0))),
        Spline(waypoints=((0, 0), (9, 0))),
    ):
        frame = located(path, (2.0, 0.5, -3.0))
        assert (frame.along_track_distance, frame.cross_track_error) == pytest.approx((2.0, 0.5))


@given(corners=waypoints(), position=POINT)
def test_the_error_of_a_first_leg_is_the_distance_to_its_line(corners, position):
    frame = located(Polyline(waypoints=corners[:2]), position)
    (x, y), (to_x, to_y) = corners[:2]
    ahead = np.array([to_x - x, to_y - y]) / math.hypot(to_x - x, to_y - y)
    offset = np.array(position) - (x, y)
    assert abs(frame.cross_track_error) == pytest.approx(
        np.linalg.norm(offset - (offset @ ahead) * ahead), abs=1e-9
    )


@given(
    corners=waypoints(turn=1.5), share=st.floats(0.0, 1.0)
)  # in a sharper turn the corner must be passed first
def test_a_robot_that_walks_a_polyline_sees_no_error_and_its_own_way(corners, share):
    path = Polyline(waypoints=corners)
    progress = path.init()
    for along in np.linspace(0.0, share * path.length, 100):
        progress, frame = path.locate(progress, path.points(np.array([along]))[0])
        assert frame.cross_track_error == pytest.approx(0.0, abs=1e-9)
        assert frame.along_track_distance == pytest.approx(along, abs=1e-9)
        assert frame.remaining == pytest.approx(path.length - along, abs=1e-9)


def test_a_leg_ends_at_its_acceptance_distance_or_when_it_is_passed():
    corners = ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0))
    for acceptance_distance, last in ((0.0, 4.0), (0.5, 3.5)):
        path = Polyline(waypoints=corners, acceptance_distance=acceptance_distance)
        assert path.locate(0, np.array([last - 1e-6, 0.0]))[0] == 0
        assert path.locate(0, np.array([last + 1e-6, 0.0]))[0] == 1
        # Far beside the waypoint: passed all the same.
        progress, frame = path.locate(0, np.array([4.1, -3.0]))
        assert progress == 1
        assert frame.path_tangential_angle == pytest.approx(math.pi / 2)


def test_a_leg_that_was_done_is_not_taken_up_again():
    path = Polyline(waypoints=((0.0, 0.0), (4.0, 0.0), (4.0, 4.0)))
    assert path.locate(1, np.array([0.0, 0.0]))[0] == 1


def test_the_last_leg_goes_straight_on():
    frame = located(Polyline(waypoints=((0.0, 0.0), (4.0, 0.0))), (6.0, 1.0))
    assert (frame.along_track_distance, frame.cross_track_error, frame.remaining) == (6.0, 1.0, 0.0)


@given(corners=waypoints())
def test_a_spline_passes_through_its_points_with_a_unit_tangent(corners):
    path = Spline(waypoints=corners)
    lengths = np.array(path.lengths)
    np.testing.assert_allclose(path.points(lengths), corners, atol=1e-8)
    s = np.linspace(0.0, path.length, 50)[1:-1]
    step = 1e-5
    tangent = (path.points(s + step) - path.points(s - step)) / (2.0 * step)
    np.testing.assert_allclose(np.linalg.norm(tangent, axis=1), 1.0, atol=1e-4)
    assert lengths[0] == 0.0
    assert np.all(np.diff(lengths) > 0.0)


@given(corners=waypoints(most=5))
def test_the_length_of_a_spline_is_that_of_a_numerical_integration(corners):
    path = Spline(waypoints=corners)
    curve = path.curve

    def speed(u):
        return float(np.linalg.norm(curve.derivatives(np.array([u]))[1]))

    pieces = [
        quad(speed, *ends, epsabs=1e-10, epsrel=1e-10, limit=200)[0]
        for ends in pairwise(curve.knots)
    ]
    np.testing.assert_allclose(np.diff(path.lengths), pieces, rtol=1e-7)


@given(corners=waypoints(), position=POINT)
@example(
    corners=((0.0, 0.0), (3.0167649748995418, 1.64806621706116)), position=(3.0, 2.0)
)  # behind its end
def test_the_error_of_a_spline_is_the_distance_to_its_nearest_point(corners, position):
    path = Spline(waypoints=corners)
    frame = located(path, position)
    s = np.linspace(0.0, path.length, 4001)
    distance = np.linalg.norm(path.points(s) - position, axis=1)
    # At an end the robot may be before or behind it; elsewhere it is right beside the nearest
    # point.
    outside = max(-frame.along_track_distance, frame.along_track_distance - path.length, 0.0)
    spacing = path.length / 4000.0
    found = math.hypot(frame.cross_track_error, outside)
    assert found <= np.min(distance) + 1e-9
    assert found >= np.min(distance) - spacing


@given(corners=waypoints(), share=st.floats(0.05, 0.95), left=st.floats(-1.0, 1.0))
def test_a_position_beside_a_spline_is_found_again_when_it_is_tracked(corners, share, left):
    path = Spline(waypoints=corners)
    s = share * path.length
    on_it = path.locate(s, path.points(np.array([s]))[0])[1]
    assume(abs(on_it.curvature * left) < 0.5)  # nearer than the center of the curve
    angle = on_it.path_tangential_angle
    x, y = path.points(np.array([s]))[0] + left * np.array([-math.sin(angle), math.cos(angle)])
    progress, frame = path.locate(s, np.array([x, y]))
    assume(abs(progress - s) < 0.1 * path.length)  # not nearer to a neighboring bend
    assert frame.along_track_distance == pytest.approx(s, abs=1e-6)
    assert frame.cross_track_error == pytest.approx(left, abs=1e-6)


def test_a_spline_that_crosses_itself_is_followed_through_the_crossing():
    path = Spline(waypoints=((0, 0), (4, 0), (6, 2), (4, 4), (2, 2), (2, -4)))
    progress = path.init()
    for along in np.arange(0.0, path.length, 0.05):
        progress, frame = path.locate(progress, path.points(np.array([along]))[0])
        assert frame.along_track_distance == pytest.approx(along, abs=1e-6)


def test_the_curvature_of_a_spline_is_that_of_its_circle():
    angle = np.linspace(0.0, math.pi, 30)
    path = Spline(waypoints=2.0 * np.stack((np.cos(angle), np.sin(angle)), axis=1))
    middle = path.points(np.array([0.5 * path.length]))[0]
    frame = located(path, 0.9 * middle)
    assert frame.curvature == pytest.approx(0.5, rel=1e-3)
    assert frame.cross_track_error == pytest.approx(
        0.2, rel=1e-3
    )  # inside a left-hand bend is left
    assert path.length == pytest.approx(2.0 * math.pi, rel=1e-3)


@given(corners=waypoints(least=3), share=st.floats(0.0, 1.0))
def test_curvature_and_direction_of_a_spline_do_not_jump(corners, share):
    path = Spline(waypoints=corners)
    for at in path.lengths:
        near = path.points(np.array([at - 1e-7, at + 1e-7]))
        before, after = (path.locate(at, point)[1] for point in near)
        assert after.curvature == pytest.approx(
            before.curvature, abs=1e-3 + 1e-3 * abs(before.curvature)
        )
        turn = wrap_to_pi(after.path_tangential_angle - before.path_tangential_angle)
        assert turn == pytest.approx(0.0, abs=1e-3)


def test_a_spline_goes_straight_on_at_both_ends():
    path = Spline(waypoints=((0, 0), (2, 1), (4, 0)))
    (before, behind), angle = (
        path.points(np.array([-1.0, path.length + 1.0])),
        located(path, (0, 0)),
    )
    assert math.hypot(*before) == pytest.approx(1.0)
    frame = located(path, before)
    assert frame.along_track_distance == pytest.approx(-1.0)
    assert (frame.curvature, frame.cross_track_error) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert frame.path_tangential_angle == pytest.approx(angle.path_tangential_angle)
    frame = located(path, behind)
    assert frame.along_track_distance == pytest.approx(path.length + 1.0)
    assert frame.remaining == 0.0


def test_a_spline_through_two_points_is_the_line_between_them():
    assert located(
        Spline(waypoints=((0, 0), (3, 4))), (3, 4)
    ).along_track_distance == pytest.approx(5.0)


@pytest.mark.parametrize("path", [Polyline, Spline])
@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([(0.0, 0.0)], r"`waypoints` must hold at least 2 points, got 1\."),
        ([], r"`waypoints` must hold at least 2 points, got 0\."),
        (
            [(0, 0), (1, 0), (1, 0)],
            r"`waypoints\[2\]` must differ from the point before it, got \(1\.0, 0\.0\) twice\.",
        ),
        ([(0, 0), (math.nan, 0)], r"`waypoints\[1\]\[0\]` must be a finite number in m, got nan\."),
        ([(0, 0), (1, math.inf)], r"`waypoints\[1\]\[1\]` must be a finite number in m, got inf\."),
        ([(0, 0), (1, 2, 3)], r"`waypoints\[1\]` must be two numbers in m, got 3 of them"),
        ([(0, 0), 4], r"`waypoints\[1\]` must be two numbers in m, got 4"),
        ("0,0 1,1", "`waypoints` must be a list of two numbers in m, got '0,0 1,1'"),
        (3, "`waypoints` must be a list of two numbers in m, got 3"),
    ],
)
def test_waypoints_that_make_no_path_are_refused(path, points, message):
    with pytest.raises(ValueError, match=message):
        path(waypoints=points)


def test_what_cannot_be_followed_is_refused():
    with pytest.raises(
        ValueError, match=r"with a direction everywhere, but it turns on the spot at \(1, 0\)"
    ):
        Spline(waypoints=((0, 0), (1, 0), (0, 0)))
    with pytest.raises(ValueError, match="`acceptance_distance` must be >= 0 m, got -1"):
        Polyline(waypoints=((0, 0), (1, 0)), acceptance_distance=-1)
    with pytest.raises(ValueError, match="`angle` must be a finite number in rad, got nan"):
        StraightLine(angle=math.nan)
    with pytest.raises(ValueError, match=r"`point\[1\]` must be a finite number in m, got inf"):
        StraightLine(point=(0.0, math.inf))
