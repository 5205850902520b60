"""The digital twin: it foresees turns, the filter lives without it, and a recording can make it again."""

import math
from dataclasses import replace

import numpy as np
import pytest
from operate.tank import campaign, perfect, swimming

import laticauda as lc
from laticauda.estimation import Estimator, JointSample, PoseSample, ReferenceSample
from laticauda.estimation.digital_twin import start_twin, step_twin
from laticauda.operate.recording.entries import content_of
from laticauda.planar.model import PlanarPlant

BODY = lc.plant(lc.load_robot("mamba"), lc.load_water("paper-lateral"), joints="servo")


@pytest.fixture(scope="module")
def turning():
    """A robot that gets into path following, 6 s."""
    case = campaign().CASES[0]
    return campaign().truth(case, 6.0)


def last(estimator, arrivals, until=math.inf):
    state = estimator.init()
    for arrival, sample in arrivals:
        if arrival <= until:
            state = estimator.step(state, sample)
    return state, estimator.estimate(state)


def waves(t):
    return 0.5 * np.sin(2.2 * t + 0.7 * np.arange(8)) + 0.1


def test_what_the_twin_does_in_its_own_axes_does_not_depend_on_where_it_is_nor_on_a_current():
    drifting = lc.plant(BODY.robot, replace(BODY.environment, current=(0.2, -0.1)), joints="servo")
    here, there = start_twin(BODY, np.zeros(8)), start_twin(drifting, np.zeros(8))
    for k in range(2500):  # one begins at rest in the water, the other on the ground: the first seconds differ
        here = step_twin(BODY, here, waves(0.01 * k), None, 0.0, 0.01)
        there = step_twin(drifting, there, waves(0.01 * k), None, 0.0, 0.01)
    assert np.linalg.norm(here.center_of_mass - there.center_of_mass) > 1.0
    assert (there.along, there.across, there.turn) == pytest.approx((here.along, here.across, here.turn), abs=2e-6)


def test_coupling_brings_the_twins_joints_to_those_that_the_sensors_see():
    apart = []
    for coupling in (0.0, 1.0):
        twin, joint = start_twin(BODY, np.zeros(8)), np.full(8, 0.2)
        for _ in range(200):
            twin = step_twin(BODY, twin, np.zeros(8), joint, coupling, 0.01)
        apart.append(np.abs(twin.joint_angle - joint).max())
    assert apart[0] == pytest.approx(0.2, abs=0.01) and apart[1] == pytest.approx(0.1, abs=0.01)


def test_with_the_right_twin_a_gap_in_a_turn_is_bridged(turning):
    arrivals, _ = campaign().sensed(turning, perfect(), 0)
    gap = [item for item in arrivals if not (isinstance(item[1], PoseSample) and item[0] > 5.0)]
    off = []
    for plant in (BODY, None):
        _, estimate = last(Estimator(robot=turning.robot, plant=plant), gap, 6.0)
        k = round(estimate.time / 0.01)
        off.append(np.linalg.norm(estimate.center_of_mass - turning.center_of_mass[k]))
        if plant is BODY:
            assert estimate.heading == pytest.approx(turning.heading[k], abs=math.radians(0.6))
            assert estimate.heading_rate == pytest.approx(turning.heading_rate[k], abs=0.05)
            assert estimate.center_of_mass_velocity == pytest.approx(turning.center_of_mass_velocity[k], abs=0.01)
    assert off[0] < 0.004 and off[0] < 0.5 * off[1]


def test_a_twin_that_knows_the_robots_speed_tells_it_from_a_current():
    moving = swimming(duration=8.0, current=(0.03, 0.05))
    arrivals, _ = campaign().sensed(moving, campaign().Sensors(between=math.inf), 1)
    _, alone = last(Estimator(robot=moving.robot, backlash=campaign().BACKLASH), arrivals)
    _, told = last(Estimator(robot=moving.robot, backlash=campaign().BACKLASH, plant=BODY), arrivals)
    assert told.current_std < 0.7 * alone.current_std
    assert told.current == pytest.approx(np.array([0.03, 0.05]), abs=0.02)


class Exploding(PlanarPlant):
    """A plant that diverges after 3 s."""

    def march(self, state, command, duration, sample_interval, *, link_forces=False):
        then, log, trouble = super().march(state, command, duration, sample_interval)
        return then, log, "diverged" if log.time[-1] > 3.0 else trouble


def test_a_twin_that_diverges_is_given_up_and_the_filter_goes_on_without_it():
    trial = swimming()
    arrivals, _ = campaign().sensed(trial, campaign().Sensors(between=math.inf), 2)
    body = Exploding(robot=BODY.robot, environment=BODY.environment, settings=BODY.settings)
    estimator = Estimator(robot=trial.robot, backlash=campaign().BACKLASH, plant=body)
    state, estimate = last(estimator, arrivals)
    assert state.latest.twin is None and state.latest.twin_failed
    k = round(estimate.time / 0.01)
    assert estimate.center_of_mass == pytest.approx(trial.center_of_mass[k], abs=0.006)
    assert estimate.heading == pytest.approx(trial.heading[k], abs=math.radians(1.0))


def test_a_twin_whose_joints_are_elsewhere_is_given_up():
    estimator = Estimator(robot=BODY.robot, plant=BODY, coupling=0.0)
    state = estimator.init()
    for k in range(300):
        state = estimator.step(state, ReferenceSample(time=0.01 * k, angle=np.full(8, 0.8)))
        state = estimator.step(state, JointSample(time=0.01 * k, angle=np.zeros(8)))  # limp
        state = estimator.step(state, PoseSample(time=0.01 * k, position=np.zeros(3), rotation=np.eye(3)))
        assert (state.latest.twin is not None) == (k < 100) or 90 < k < 140
    assert state.latest.twin_failed
    assert np.abs(estimator.estimate(state).center_of_mass_velocity).max() < 0.05


def test_without_references_a_plant_changes_nothing():
    trial = swimming()
    arrivals, _ = campaign().sensed(trial, campaign().Sensors(), 3)
    bare = [item for item in arrivals if not isinstance(item[1], ReferenceSample)]
    _, one = last(Estimator(robot=trial.robot), bare, 4.0)
    _, two = last(Estimator(robot=trial.robot, plant=BODY), bare, 4.0)
    for before, after in zip(content_of(one), content_of(two), strict=True):
        assert np.array_equal(before, after)


def test_samples_may_come_out_of_order_beside_a_twin_too():
    trial = swimming()
    arrivals, _ = campaign().sensed(trial, campaign().Sensors(), 3)
    chosen = [item for item in arrivals if item[0] <= 3.0]
    ordered = sorted(chosen, key=lambda item: item[1].time)
    mixed = sorted(
        chosen, key=lambda item: item[1].time + (0.03 * math.sin(1e3 * item[1].time) if item[1].time > 1.0 else 0.0)
    )
    (state, one), (other, two) = (last(Estimator(robot=trial.robot, plant=BODY), items) for items in (ordered, mixed))
    assert state.n_late == other.n_late == 0
    assert two.center_of_mass == pytest.approx(one.center_of_mass, abs=1e-9)
    assert two.heading == pytest.approx(one.heading, abs=1e-9)


def test_what_cannot_be_the_twin_is_refused():
    robot, water = BODY.robot, BODY.environment
    with pytest.raises(ValueError, match=r"`plant` must be of class Plant, got int\."):
        Estimator(robot=robot, plant=3)
    with pytest.raises(ValueError, match=r"`plant` must have 8 joints, all of them yaw joints, got 9\."):
        Estimator(robot=robot, plant=lc.plant(lc.load_robot("mamba-modules").planar(), water, joints="servo"))
    with pytest.raises(ValueError, match=r"`plant` must have joints that follow references, `pd` or `servo`, got"):
        Estimator(robot=robot, plant=lc.plant(robot, water))
    with pytest.raises(ValueError, match=r"`swim_speed` must be None beside a `plant`, which knows it, got 0\.1\."):
        Estimator(robot=robot, plant=BODY, swim_speed=0.1)
    with pytest.raises(ValueError, match=r"`coupling` must be >= 0, got -1"):
        Estimator(robot=robot, plant=BODY, coupling=-1.0)
