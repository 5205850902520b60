from dataclasses import replace
from math import radians

import pytest

import laticauda as lc
from laticauda.studies import Optimization, describe_limits, name_limits, optimize

GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)
SLOW = lc.lateral_undulation(amplitude_deg=10, frequency_deg_s=30, phase_shift_deg=40)


def scenario(gait: lc.Gait, **changes: str) -> lc.Scenario:
    return lc.build_scenario("mamba-fin", gait, 40.0, **changes)


def test_a_slow_gait_comes_to_no_limit():
    assert name_limits(scenario(SLOW, parameters="mamba-identified")) == []
    assert describe_limits([scenario(SLOW, parameters="mamba-identified")]) == ""


def test_joints_that_follow_whatever_it_takes_come_to_the_limit_of_the_servos():
    assert name_limits(scenario(GAIT)) == ["servos"]


def test_joints_with_a_speed_loop_come_to_their_top_speed():
    identified = scenario(GAIT, parameters="mamba-identified")
    assert name_limits(identified) == ["servos' top speed"]
    assert describe_limits([identified, scenario(GAIT), identified]) == "servos' top speed, servos"


def limiting(limit_deg: float, gait: lc.Gait) -> str:
    """What Mamba comes to first with any motor and this limit of its joints."""
    mamba = lc.load_robot("mamba")
    joints = tuple(
        replace(joint, limit=radians(limit_deg), actuator=replace(joint.actuator, stated=False))
        for joint in mamba.joints
    )
    return lc.swim(replace(mamba, joints=joints), gait, 20.0).feasibility.limited_by


def test_wide_gaits_come_to_the_angles_of_the_joints_or_to_other_links():
    wide = lc.lateral_undulation(amplitude_deg=89, frequency_deg_s=30, phase_shift_deg=40)
    assert limiting(31.0, GAIT) == "joint angles"
    assert limiting(170.0, wide) == "links that touch"


@pytest.mark.filterwarnings("ignore::laticauda.values.errors.UnitWarning")
def test_a_run_that_blows_up_comes_to_no_limit():
    hopeless = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=20000, phase_shift_deg=40)
    assert name_limits(scenario(hopeless)) == []


def test_a_point_of_a_front_may_lie_at_the_end_of_a_range():
    bounds = {"gait.amplitude": (0.2, 0.21), "gait.frequency": (0.3, 2.0)}
    sought = Optimization(
        scenario=scenario(SLOW, parameters="mamba-identified"),
        bounds=bounds,
        objectives="forward_velocity",
    )
    front = optimize(sought, budget=24, population=12, seed=1)
    moved = replace(front, values=front.values * 0.0 + (0.21, 1.0))
    assert moved.limits(0) == ["range of the amplitude"]
