"""Incidence of the trailing edge, and what is said of a thrust outside its law."""

import dataclasses
import math

import numpy as np
import pytest

import laticauda as lc
from laticauda.cli.first_screen import first_screen
from laticauda.cli.report import describe_trial, facts_of_trial
from laticauda.models.simulate import figure_intervals
from laticauda.robot import CaudalFin, Section, load_ground
from laticauda.trials import describe_edge, thrust_error
from laticauda.trials.edge import edge_aspect

FISH = lc.load_robot("tendon-fish")
# Its modules are as low as rods, so nothing is ahead of its fin.
RODS = tuple(
    dataclasses.replace(m, section=Section(half_height=0.01, half_width=0.01)) for m in FISH.modules
)
BROAD_FISH = dataclasses.replace(
    FISH,
    caudal_fin=CaudalFin(length=0.0365, height=0.203, opening_length=0.0, density=1350.0),
    modules=(*RODS[:5], FISH.modules[5]),
)
GAIT = lc.lateral_undulation(amplitude=0.35, frequency=5.0, phase_shift=0.5)


@pytest.fixture(scope="module")
def fish():
    water = dataclasses.replace(lc.load_water("paper-lateral"), added_mass_form="kirchhoff")
    broad = dataclasses.replace(water, trailing_edge="elongated")
    return lc.swim(BROAD_FISH, GAIT, 6.0, environment=broad)


def test_an_edge_that_is_shifted_to_and_fro_meets_the_flow_at_the_angle_of_its_speeds(make_trial):
    straight = make_trial(ripple=0.0)
    omega = straight.gait.frequency
    for angle in (0.1, 0.6, 1.2):
        swing = 0.15 * math.tan(angle) / omega
        wave = omega * straight.time
        shift = swing * np.stack((0.0 * wave, np.sin(wave)), axis=1)
        rate = swing * omega * np.stack((0.0 * wave, np.cos(wave)), axis=1)
        shifted = dataclasses.replace(
            straight,
            center_of_mass=straight.center_of_mass + shift,
            center_of_mass_velocity=straight.center_of_mass_velocity + rate,
        )
        assert shifted.edge_incidence == pytest.approx(angle, rel=1e-3)


def test_the_edge_of_a_body_that_only_turns_moves_with_its_lever(make_trial):
    for robot in (lc.load_robot("mamba"), lc.load_robot("mamba-fin")):
        turning = make_trial(robot=robot, ripple=0.0, speed=0.15, turning_rate=0.1)
        lever = 0.5 * robot.length
        if robot.caudal_fin is not None:
            at_tail = 0.5 * robot.length + 0.5 * robot.caudal_fin.length
            lever += robot.caudal_fin.length - robot.caudal_fin.mass * at_tail / robot.mass
        # All links have the heading, which is the course of the center of mass.
        assert turning.edge_incidence == pytest.approx(math.atan(0.1 * lever / 0.15), rel=1e-3)


def test_a_current_that_carries_the_robot_changes_nothing(make_trial):
    water = lc.load_water("paper-lateral")
    still = make_trial(environment=water)
    moving = make_trial(environment=dataclasses.replace(water, current=(0.1, -0.3)))
    drift = np.outer(moving.time, (0.1, -0.3))
    carried = dataclasses.replace(
        moving,
        center_of_mass=moving.center_of_mass + drift,
        center_of_mass_velocity=moving.center_of_mass_velocity + np.array([0.1, -0.3]),
    )
    assert carried.edge_incidence == pytest.approx(still.edge_incidence, rel=1e-9)


def test_there_is_no_incidence_on_ground_or_of_two_samples(make_trial):
    on_ground = make_trial(environment=load_ground("viscous"))
    with pytest.raises(ValueError, match="must be water for an incidence; on ground there is none"):
        _ = on_ground.edge_incidence
    with pytest.raises(ValueError, match="`time` must have at least 3 samples for an incidence"):
        _ = make_trial(duration=1.0, dt=1.0).edge_incidence
    assert thrust_error(on_ground) is None


def test_a_law_of_slender_fins_says_that_it_drives_a_broad_fin_too_well(fish):
    error = thrust_error(fish)
    assert error is not None
    assert error.highest == pytest.approx(2.52, rel=0.02)
    sentence = describe_edge(fish)
    assert sentence == (
        "The thrust of the edge is outside its law and may be 3.5 times too high: that law is for "
        "slender fins, and this one is 5.56 times as high as long."
    )
    assert sentence in " ".join(first_screen(fish).split())
    assert sentence in " ".join(describe_trial(fish).split())
    assert facts_of_trial(fish)["outside_law"] == sentence
    assert fish.summary()["edge_incidence"] == fish.edge_incidence


def test_slender_fins_and_bodies_are_within_the_law_at_any_incidence():
    for robot in ("mamba", "mamba-fin", "amphibot"):
        trial = lc.swim(robot, GAIT, 6.0, environment="textbook")
        assert trial.edge_incidence > math.radians(20.0)
        assert describe_edge(trial) == ""
        assert facts_of_trial(trial)["outside_law"] == ""


def test_a_fin_without_an_edge_and_a_robot_in_the_tank_have_no_error_of_thrust(fish, make_trial):
    bare = dataclasses.replace(fish.environment, trailing_edge="none")
    assert thrust_error(lc.swim(FISH, GAIT, 2.0, environment=bare)) is None
    measured = make_trial(robot=FISH, environment=fish.environment)
    assert thrust_error(measured) is None


def test_the_error_of_the_thrust_widens_the_interval_of_a_speed_downward_only(fish):
    intervals = {"water.normal_drag": (1.7, 1.8)}
    low, high = figure_intervals(fish, intervals)["forward_velocity"]
    speed = fish.forward_velocity
    assert low == pytest.approx(speed / 3.52, rel=0.02)
    assert speed <= high < 1.1 * speed
    assert figure_intervals(fish, intervals)["duration"] == pytest.approx((6.0, 6.0))


def test_an_open_opening_is_no_part_of_the_plate():
    fin = lc.load_robot("mamba-fin")
    assert edge_aspect(fin) == pytest.approx(0.09 / 0.38)
    assert edge_aspect(lc.load_robot("amphibot")) == pytest.approx(0.055 / 0.6755)
