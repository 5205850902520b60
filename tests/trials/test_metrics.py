import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from laticauda.robot import load_robot, load_water
from laticauda.robot.hydrodynamics import link_coefficients
from laticauda.trials import metrics
from laticauda.water.fluid.laws import PolynomialDrag

ANGLES = st.floats(-3.0, 3.0)
RATES = st.floats(-0.2, 0.2)
SPEEDS = ("forward_velocity", "steady_velocity", "path_speed", "speed_through_water")
OTHERS = (
    "mean_power",
    "cost_of_transport",
    "joules_per_meter",
    "quasi_propulsive_efficiency",
    "strouhal_number",
)


@given(speed=st.floats(0.01, 1.0), direction=ANGLES)
def test_all_speeds_of_a_constant_velocity_are_that_speed(make_trial, speed, direction):
    trial = make_trial(speed=speed, direction=direction)
    for name in SPEEDS:
        assert getattr(trial, name) == pytest.approx(speed, rel=1e-9)
    assert trial.course == pytest.approx(direction)
    assert trial.turning_rate == pytest.approx(0.0, abs=1e-9)
    assert trial.sideslip == pytest.approx(0.0, abs=1e-6)


@settings(max_examples=30)
@given(turning_rate=RATES, direction=ANGLES, x=st.floats(-50.0, 50.0), y=st.floats(-50.0, 50.0))
def test_where_and_which_way_a_run_goes_changes_none_of_its_figures(
    make_trial, turning_rate, direction, x, y
):
    here = make_trial(turning_rate=turning_rate)
    there = make_trial(turning_rate=turning_rate, direction=direction, origin=(x, y))
    for name in (*SPEEDS, *OTHERS):
        assert getattr(there, name) == pytest.approx(getattr(here, name), rel=1e-7)
    for name in ("turning_rate", "sideslip"):
        assert getattr(there, name) == pytest.approx(getattr(here, name), abs=1e-8)
    turned = there.course - here.course - direction
    assert math.cos(turned) == pytest.approx(1.0)


@settings(max_examples=30)
@given(turning_rate=RATES)
def test_a_mirrored_run_turns_the_other_way_at_the_same_speed(make_trial, turning_rate):
    left, right = (
        make_trial(turning_rate=turning_rate),
        make_trial(turning_rate=turning_rate, mirrored=True),
    )
    for name in ("turning_rate", "sideslip", "course"):
        assert getattr(right, name) == pytest.approx(-getattr(left, name), abs=1e-9)
    for name in (*SPEEDS, *OTHERS):
        assert getattr(right, name) == pytest.approx(getattr(left, name), rel=1e-9)


@settings(max_examples=30)
@given(turning_rate=RATES)
def test_the_turning_rate_is_free_of_the_gaits_ripple(make_trial, turning_rate):
    for ripple in (0.0, 0.5):
        assert make_trial(turning_rate=turning_rate, ripple=ripple).turning_rate == pytest.approx(
            turning_rate, abs=1e-7
        )


@given(
    steps=st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)), min_size=1, max_size=20)
)
def test_no_path_is_shorter_than_the_straight_line(steps):
    path = np.concatenate((np.zeros((1, 2)), np.cumsum(np.array(steps), axis=0)))
    time = np.arange(float(len(path)))
    assert (
        metrics.forward_velocity(time, path)
        <= metrics.path_speed(time, path) * (1.0 + 1e-12) + 1e-150
    )  # squares underflow


def test_on_a_circle_the_straight_line_is_the_chord(make_trial):
    trial = make_trial(turning_rate=0.1, speed=0.2)
    assert trial.forward_velocity == pytest.approx(2.0 * 0.2 / 0.1 * math.sin(0.05 * 30.0) / 30.0)
    assert trial.path_speed == pytest.approx(0.2, rel=1e-5)


def test_the_steady_velocity_does_not_see_the_start(make_trial):
    trial = make_trial(speed=0.2)
    start = 0.3 * np.exp(-trial.time / 1.0)
    late = dataclasses.replace(
        trial,
        center_of_mass=trial.center_of_mass + np.stack((start, 0.0 * start), axis=1),
        center_of_mass_velocity=trial.center_of_mass_velocity
        - np.stack((start, 0.0 * start), axis=1),
    )
    assert late.forward_velocity < 0.195
    assert late.steady_velocity == pytest.approx(0.2, rel=1e-5)


def test_the_steady_velocity_does_not_see_the_gaits_ripple(make_trial):
    trial = make_trial(speed=0.2)
    omega = trial.gait.frequency
    ripple = 0.05 * np.stack((np.sin(omega * trial.time), np.cos(omega * trial.time)), axis=1)
    rate = (
        0.05 * omega * np.stack((np.cos(omega * trial.time), -np.sin(omega * trial.time)), axis=1)
    )
    rough = dataclasses.replace(
        trial,
        center_of_mass=trial.center_of_mass + ripple,
        center_of_mass_velocity=trial.center_of_mass_velocity + rate,
    )
    assert rough.steady_velocity == pytest.approx(0.2, rel=1e-7)


def test_sideslip_is_course_minus_heading_also_across_the_half_turn(make_trial):
    for heading in (0.0, 3.1, -3.1):
        trial = make_trial(direction=heading)
        drift = 0.3  # to its left
        cos, sin = math.cos(drift), math.sin(drift)
        rotation = np.array([[cos, -sin], [sin, cos]])
        crabbing = dataclasses.replace(
            trial,
            center_of_mass=trial.center_of_mass @ rotation.T,
            center_of_mass_velocity=trial.center_of_mass_velocity @ rotation.T,
        )
        assert crabbing.sideslip == pytest.approx(0.3, abs=1e-6)


def test_the_strouhal_number_of_a_tail_of_known_swing(make_trial):
    still_body = make_trial(ripple=0.0)
    for swing in (0.01, 0.1):
        # A robot that is shifted sideways as a whole, to and fro, has a tail that moves by just
        # that much.
        omega = still_body.gait.frequency
        shift = (
            0.5 * swing * np.stack((0.0 * still_body.time, np.sin(omega * still_body.time)), axis=1)
        )
        rate = (
            0.5
            * swing
            * omega
            * np.stack((0.0 * still_body.time, np.cos(omega * still_body.time)), axis=1)
        )
        swinging = dataclasses.replace(
            still_body,
            center_of_mass=still_body.center_of_mass + shift,
            center_of_mass_velocity=still_body.center_of_mass_velocity + rate,
        )
        assert swinging.strouhal_number == pytest.approx(swing / 2.5 / 0.15, rel=1e-3)


def test_a_fin_carries_the_trailing_edge_further_out(make_trial):
    bare, finned = make_trial(), make_trial(robot=load_robot("mamba-fin"))
    assert finned.strouhal_number > 1.2 * bare.strouhal_number


def test_costs_are_power_over_weight_and_speed():
    assert metrics.cost_of_transport(power=10.0, weight=100.0, speed=0.5) == pytest.approx(0.2)
    assert metrics.joules_per_meter(power=10.0, speed=0.5) == pytest.approx(20.0)


def test_the_weight_in_water_is_that_of_the_displaced_water(make_trial):
    trial = make_trial()
    volume = 9 * math.pi * 0.055 * 0.05 * 0.18
    assert metrics.carried_weight(trial.robot, trial.environment) == pytest.approx(
        1000.0 * 9.81 * volume
    )
    assert trial.cost_of_transport == pytest.approx(3.0 / (1000.0 * 9.81 * volume * 0.15))


def test_the_linear_share_of_the_drag_at_the_papers_speed():
    water = load_water("paper-lateral")
    assert metrics.linear_drag_share(water, 0.15) == pytest.approx(0.87, abs=0.001)
    assert metrics.linear_drag_share(load_water("paper-vortex"), 0.15) == 0.0
    assert (
        metrics.linear_drag_share(
            dataclasses.replace(water, drag=PolynomialDrag(quadratic=False)), 0.15
        )
        == 1.0
    )
    with pytest.raises(ValueError, match="The water must have drag"):
        metrics.linear_drag_share(
            dataclasses.replace(water, drag=PolynomialDrag(linear=False, quadratic=False)), 0.15
        )


@given(speed=st.floats(0.0, 2.0))
def test_towing_drag_is_the_sum_over_links_and_fin_strips(speed):
    water = load_water("paper-lateral")
    for name in ("mamba", "mamba-fin"):
        robot = load_robot(name)
        link = link_coefficients(robot, water)
        c_t = np.sum(link.c_t) + (np.sum(link.fin.c_t) if link.fin is not None else 0.0)
        assert metrics.towing_drag(robot, water, speed) == pytest.approx(
            c_t * speed * (1.0 + speed)
        )
    vortex = load_water("paper-vortex")
    c_t = np.sum(link_coefficients(load_robot("mamba"), vortex).c_t)
    assert metrics.towing_drag(load_robot("mamba"), vortex, speed) == pytest.approx(c_t * speed**2)


def test_efficiency_is_towing_power_over_mechanical_power(make_trial):
    trial = make_trial()
    drag = metrics.towing_drag(trial.robot, trial.environment, 0.15)
    assert trial.quasi_propulsive_efficiency == pytest.approx(drag * 0.15 / 3.0)


@pytest.mark.parametrize(
    "figure", ["cost_of_transport", "joules_per_meter", "course", "sideslip", "strouhal_number"]
)
def test_a_robot_that_stands_still_has_no_cost_per_meter_and_no_course(make_trial, figure):
    with pytest.raises(ValueError, match=r"The robot must (move|travel)"):
        getattr(make_trial(speed=0.0), figure)


def test_joints_that_do_no_work_have_no_efficiency(make_trial):
    trial = make_trial(work=np.zeros((1501, 3)))
    with pytest.raises(
        ValueError, match=r"`mechanical_power` must be > 0 W for an efficiency, got 0"
    ):
        _ = trial.quasi_propulsive_efficiency


def test_a_log_of_one_sample_has_no_speed(make_trial):
    trial = make_trial(duration=0.0)
    for name in (
        "duration",
        "forward_velocity",
        "path_speed",
        "mean_power",
        "steady_velocity",
        "turning_rate",
    ):
        with pytest.raises(ValueError, match="`time` must"):
            getattr(trial, name)


def test_one_cycle_has_no_slope(make_trial):
    with pytest.raises(
        ValueError, match="at least two gait cycles after the transient for a turning rate"
    ):
        _ = make_trial(duration=13.0).turning_rate
    assert make_trial(duration=15.1, turning_rate=0.1).turning_rate == pytest.approx(0.1, abs=1e-6)
