"""Path following in numbers: circles, depths, and a depth that is held by a robot lighter than its water."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

import laticauda as lc
from laticauda.control import Circle, Following, PathFollowing, SpatialPathFollowing
from laticauda.values.angles import wrap_to_pi

GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(130), phase_shift=math.radians(40)
)


@given(
    st.tuples(st.floats(-5, 5), st.floats(-5, 5)),
    st.floats(0.3, 4.0),
    st.sampled_from((1.0, -1.0)),
    st.floats(-3.1, 3.1),
    st.floats(-0.2, 0.2),
)
def test_a_circle_tells_how_far_around_and_how_far_to_the_left(center, radius, side, begin, left):
    circle = Circle(center=center, radius=radius, turns=3.0 * side)
    progress = circle.init()
    for swept in np.linspace(0.0, 12.0, 60):
        angle = begin + side * swept
        away = radius - side * left
        at = np.array(center) + away * np.array((math.cos(angle), math.sin(angle)))
        progress, frame = circle.locate(progress, at)
        assert frame.along_track_distance == pytest.approx(radius * swept, abs=1e-9)
        assert frame.cross_track_error == pytest.approx(left, abs=1e-9)
        assert wrap_to_pi(
            frame.path_tangential_angle - (angle + side * math.pi / 2)
        ) == pytest.approx(0.0, abs=1e-9)
        assert frame.curvature == side / radius
        assert frame.remaining == pytest.approx(
            max(6.0 * math.pi * radius - radius * swept, 0.0), abs=1e-9
        )


def test_a_depth_makes_a_path_one_in_space():
    assert isinstance(Following().controller(GAIT), PathFollowing)
    held = Following(path_depth=(1.2,)).controller(GAIT)
    assert isinstance(held, SpatialPathFollowing)
    assert held.profile.points(np.array([0.0, 7.0])).tolist() == [[0.0, -1.2], [7.0, -1.2]]
    legs = Following(waypoints=((0, 0), (3, 0), (3, 4)), path_depth=(0.5, 1.0, 0.8)).controller(
        GAIT
    )
    assert isinstance(legs, SpatialPathFollowing)
    heights = [
        legs.profile.locate(i, np.array([at, 0.0]))[1]
        for i, at in ((0, -0.5), (1, 2.9), (2, 6.9), (3, 7.5))
    ]
    assert [round(frame.path_tangential_angle, 6) for frame in heights] == [
        0.0,
        round(math.atan2(-0.5, 3.0), 6),
        round(math.atan2(0.2, 4.0), 6),
        0.0,
    ]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"waypoints": ((0, 0), (1, 0)), "path_depth": (1.0, 2.0, 3.0)},
            "`path_depth` must be one depth, or 2: one",
        ),
        ({"path_depth": (1.0, 2.0)}, "`path_depth` must be one depth"),
        (
            {"circle": (0, 0, 1, 1), "waypoints": ((0, 0), (1, 0))},
            "`circle` must not be given with `waypoints`",
        ),
        ({"circle": (0, 0, 0, 1)}, "`radius` must be > 0 m"),
        ({"circle": (0, 0, 1, 0)}, "`turns` must not be 0"),
    ],
)
def test_numbers_that_make_no_path_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        Following(**changes)


def test_the_integral_holds_the_depth_of_a_robot_that_is_lighter_than_water():
    robot, water = lc.load_robot("mamba-modules"), lc.load_water("paper-lateral")  # 1 % lighter
    body, start = lc.build_plant(robot, water, model="spatial"), lc.Start(depth=0.9)
    off = {}
    for sigma in (0.0, Following().climb_integral_gain):
        controller = Following(path_depth=(1.0,), climb_integral_gain=sigma).controller(GAIT)
        trial = lc.run(body, controller, 60.0, start=start)
        off[sigma] = float(np.mean(trial.signals["height_error"][trial.time > 50.0]))
    assert off[0.0] > 0.03  # too high, for good
    assert abs(off[Following().climb_integral_gain]) < 0.01


def test_a_robot_without_pitch_joints_follows_no_depth():
    controller = Following(path_depth=(1.0,)).controller(GAIT)
    with pytest.raises(
        ValueError, match="`robot` must have pitch joints for a path in space, got `mamba`"
    ):
        controller.check(lc.load_robot("mamba"))
    with pytest.raises(ValueError, match=r"`robot` must have pitch joints .*`mamba-modules`"):
        lc.swim(replace(lc.load_robot("mamba-modules")), controller, 1.0)
