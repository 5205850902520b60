import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from laticauda.tank.operate.procedure.calibration import (
    CalibrationFailed,
    measure_joint_zeros,
    measure_marker_yaw,
)
from laticauda.tank.operate.procedure.stillness import Pose, StillnessRule, watch_stillness


def turned(yaw: float) -> np.ndarray:
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def test_joint_zeros_are_the_median_of_what_a_straight_robot_reports():
    angle = np.array([[0.01, -0.02], [0.011, np.nan], [9.0, -0.02]])
    assert measure_joint_zeros(angle, largest=0.1).tolist() == [0.011, -0.02]


def test_a_robot_that_is_not_straight_and_a_silent_module_are_named():
    with pytest.raises(
        CalibrationFailed,
        match=r"module 2 reports 11\.5 deg, more than 5\.0; lay the robot straight",
    ):
        measure_joint_zeros(np.array([[0.0, 0.2]]), largest=math.radians(5))
    with pytest.raises(CalibrationFailed, match="module 1 did not report its angle"):
        measure_joint_zeros(np.array([[np.nan, 0.0]]), largest=0.1)


@given(st.floats(-3.1, 3.1), st.floats(-3.1, 3.1))
def test_the_marker_bodys_yaw_is_found_whatever_the_heading(yaw, heading):
    rotation = np.stack([turned(heading + yaw + noise) for noise in (-0.01, 0.0, 0.01)])
    found = measure_marker_yaw(rotation, heading=heading)
    assert math.cos(found - yaw) == pytest.approx(1.0, abs=1e-9)


def test_without_a_frame_there_is_no_yaw():
    with pytest.raises(CalibrationFailed, match="the motion capture did not see it"):
        measure_marker_yaw(np.zeros((0, 3, 3)), heading=0.0)


def test_still_is_only_who_is_still_for_long_enough_and_noise_is_no_motion():
    noise = np.random.default_rng(0)
    rule = StillnessRule(speed=0.01, rate=0.02, duration=1.0)

    def answers(speed: float, rate: float) -> list[bool]:
        seen, found = (), []
        for k in range(150):
            t = 0.01 * k
            x, y, heading = noise.normal(0.0, [0.001, 0.001, 0.002]).tolist()
            pose = Pose(x + speed * t, y, heading + rate * t)
            seen, is_still = watch_stillness(seen, t, pose, rule)
            found.append(is_still)
        return found

    assert not any(answers(0.0, 0.0)[:90])
    assert all(answers(0.0, 0.0)[105:])
    assert not any(answers(0.02, 0.0))
    assert not any(answers(0.0, -0.04))
