"""The digital twin: it foresees turns, the filter lives without it, and a recording can make it again."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tank.operate.tank import campaign, perfect, swimming

import laticauda as lc
from laticauda.control.estimation import Estimator, JointSample, PoseSample, ReferenceSample
from laticauda.control.estimation.digital_twin import check_plant, start_twin, step_twin
from laticauda.control.estimation.filter_state import PastStep
from laticauda.control.estimation.state_vector import JOINTS
from laticauda.models.planar.model import PlanarPlant
from laticauda.tank.operate.recording.messages import content_of
from laticauda.water.fluid.uniform import LinearShear

BODY = lc.build_plant(lc.load_robot("mamba"), lc.load_water("paper-lateral"), joints="servo")


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
    drifting = lc.build_plant(
        BODY.robot, replace(BODY.environment, current=(0.2, -0.1)), joints="servo"
    )
    here, there = start_twin(BODY, np.zeros(8)), start_twin(drifting, np.zeros(8))
    for k in range(
        2500
    ):  # one begins at rest in the water, the other on the ground: the first seconds differ
        here = step_twin(BODY, here, waves(0.01 * k), None, 0.0, 0.01)
        there = step_twin(drifting, there, waves(0.01 * k), None, 0.0, 0.01)
    assert np.linalg.norm(here.center_of_mass - there.center_of_mass) > 1.0
    assert (there.along, there.across, there.turn) == pytest.approx(
        (here.along, here.across, here.turn), abs=2e-6
    )


def test_coupling_brings_the_twins_joints_to_those_that_the_sensors_see():
    apart = []
    for coupling in (0.0, 1.0):
        twin, joint = start_twin(BODY, np.zeros(8)), np.full(8, 0.2)
        for _ in range(200):
            twin = step_twin(BODY, twin, np.zeros(8), joint, coupling, 0.01)
        apart.append(np.abs(twin.joint_angle - joint).max())
    assert apart[0] == pytest.approx(0.2, abs=0.01) and apart[1] == pytest.approx(0.1, abs=0.01)


def test_with_the_right_twin_a_gap_in_a_turn_is_bridged(turning):
    arrivals, _ = campaign().sense(turning, perfect(), 0)
    gap = [item for item in arrivals if not (isinstance(item[1], PoseSample) and item[0] > 5.0)]
    off = []
    for plant in (BODY, None):
        _, estimate = last(Estimator(robot=turning.robot, plant=plant), gap, 6.0)
        k = round(estimate.time / 0.01)
        off.append(np.linalg.norm(estimate.center_of_mass - turning.center_of_mass[k]))
        if plant is BODY:
            assert estimate.heading == pytest.approx(turning.heading[k], abs=math.radians(0.6))
            assert estimate.heading_rate == pytest.approx(turning.heading_rate[k], abs=0.05)
            assert estimate.center_of_mass_velocity == pytest.approx(
                turning.center_of_mass_velocity[k], abs=0.01
            )
    assert off[0] < 0.004 and off[0] < 0.5 * off[1]


def test_a_twin_that_knows_the_robots_speed_tells_it_from_a_current():
    moving = swimming(duration=8.0, current=(0.03, 0.05))
    arrivals, _ = campaign().sense(moving, campaign().Sensors(between=math.inf), 1)
    _, alone = last(Estimator(robot=moving.robot, backlash=campaign().BACKLASH), arrivals)
    _, told = last(
        Estimator(robot=moving.robot, backlash=campaign().BACKLASH, plant=BODY), arrivals
    )
    assert told.current_std < 0.7 * alone.current_std
    assert told.current == pytest.approx(np.array([0.03, 0.05]), abs=0.02)


class Exploding(PlanarPlant):
    """A plant that diverges after 3 s."""

    def advance(self, *of, **how):
        end = super().advance(*of, **how)
        return end._replace(failure="diverged") if self.observe(end.state).time > 3.0 else end


def test_a_twin_that_diverges_is_given_up_and_the_filter_goes_on_without_it():
    trial = swimming()
    arrivals, _ = campaign().sense(trial, campaign().Sensors(between=math.inf), 2)
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
        state = estimator.step(
            state, PoseSample(time=0.01 * k, position=np.zeros(3), rotation=np.eye(3))
        )
        assert (state.latest.twin is not None) == (k < 100) or 90 < k < 140
    assert state.latest.twin_failed
    assert np.abs(estimator.estimate(state).center_of_mass_velocity).max() < 0.05


def test_without_references_a_plant_changes_nothing():
    trial = swimming()
    arrivals, _ = campaign().sense(trial, campaign().Sensors(), 3)
    bare = [item for item in arrivals if not isinstance(item[1], ReferenceSample)]
    _, one = last(Estimator(robot=trial.robot), bare, 4.0)
    _, two = last(Estimator(robot=trial.robot, plant=BODY), bare, 4.0)
    for before, after in zip(content_of(one), content_of(two), strict=True):
        assert np.array_equal(before, after)


def test_samples_may_come_out_of_order_beside_a_twin_too():
    trial = swimming()
    arrivals, _ = campaign().sense(trial, campaign().Sensors(), 3)
    chosen = [item for item in arrivals if item[0] <= 3.0]
    ordered = sorted(chosen, key=lambda item: item[1].time)
    mixed = sorted(
        chosen,
        key=lambda item: (
            item[1].time + (0.03 * math.sin(1e3 * item[1].time) if item[1].time > 1.0 else 0.0)
        ),
    )
    (state, one), (other, two) = (
        last(Estimator(robot=trial.robot, plant=BODY), items) for items in (ordered, mixed)
    )
    assert state.n_late == other.n_late == 0
    assert two.center_of_mass == pytest.approx(one.center_of_mass, abs=1e-9)
    assert two.heading == pytest.approx(one.heading, abs=1e-9)


def test_what_cannot_be_the_twin_is_refused():
    robot, water = BODY.robot, BODY.environment
    with pytest.raises(ValueError, match=r"`plant` must be of class Plant, got int\."):
        Estimator(robot=robot, plant=3)
    with pytest.raises(
        ValueError, match=r"`plant` must have 8 joints, all of them yaw joints, got 9\."
    ):
        Estimator(
            robot=robot,
            plant=lc.build_plant(lc.load_robot("mamba-modules").planar(), water, joints="servo"),
        )
    with pytest.raises(
        ValueError, match=r"`plant` must have joints that follow references, `pd` or `servo`, got"
    ):
        Estimator(robot=robot, plant=lc.build_plant(robot, water))
    with pytest.raises(
        ValueError,
        match=r"`swim_speed` must be None with a `plant`, which determines it, got 0\.1\.",
    ):
        Estimator(robot=robot, plant=BODY, swim_speed=0.1)
    with pytest.raises(ValueError, match=r"`coupling` must be >= 0, got -1"):
        Estimator(robot=robot, plant=BODY, coupling=-1.0)


def held(angle: float = 0.2) -> np.ndarray:
    return np.full(8, angle)


def test_a_twin_begins_at_rest_and_straight_at_the_origin():
    twin = start_twin(BODY, held())
    assert twin.center_of_mass.tolist() == twin.velocity.tolist() == [0.0, 0.0]
    assert (twin.heading, twin.rate, twin.astray, twin.along, twin.across, twin.turn) == (0.0,) * 6
    assert twin.joint_angle == pytest.approx(np.zeros(8), abs=0.2)


@pytest.mark.parametrize("current", [(0.0, 0.0), (0.2, -0.1)])
def test_what_it_foresees_is_its_way_through_the_water_in_the_axes_that_it_had(current):
    body = lc.build_plant(BODY.robot, replace(BODY.environment, current=current), joints="servo")
    before = start_twin(body, waves(0.0))
    for k in range(150):
        twin = step_twin(body, before, waves(0.01 * k), None, 0.0, 0.01)
        assert twin is not None
        if k > 100:
            drift = np.array(current)
            way = complex(*(twin.center_of_mass - before.center_of_mass - 0.01 * drift)) * np.exp(
                -1j * before.heading
            )
            assert complex(twin.along, twin.across) == pytest.approx(way, abs=1e-12)
            assert twin.turn == pytest.approx(twin.heading - before.heading, abs=1e-15)
            state = body.observe(twin.plant)
            assert twin.velocity == pytest.approx(state.center_of_mass_velocity - drift, abs=1e-12)
            assert twin.center_of_mass == pytest.approx(state.center_of_mass)
            assert (twin.heading, twin.rate) == (state.heading, state.heading_rate)
            assert twin.joint_angle.tolist() == state.joint_angle.tolist()
        before = twin
    assert abs(twin.turn) > 1e-4 and abs(twin.along) > 1e-4


def test_references_are_pulled_by_what_the_sensors_see_beside_the_twin():
    twin = start_twin(BODY, held(0.0))
    pulled = step_twin(BODY, twin, held(0.0), twin.joint_angle + 0.1, 0.5, 0.05)
    asked = step_twin(BODY, twin, held(0.05), None, 0.5, 0.05)
    assert pulled.joint_angle == pytest.approx(asked.joint_angle, abs=1e-12)
    assert np.abs(asked.joint_angle).max() > 1e-4


def test_a_twin_may_be_astray_for_a_second_and_comes_back_at_once():
    twin, times = start_twin(BODY, held(0.0)), []
    at_zero = replace(twin, joint_angle=np.zeros(8))
    assert step_twin(BODY, at_zero, held(0.0), held(0.5), 0.0, 0.01).astray == 0.0
    assert step_twin(BODY, at_zero, held(0.0), held(-0.501), 0.0, 0.01).astray == 0.01
    for _ in range(4):
        twin = step_twin(BODY, twin, held(0.0), np.append(np.full(7, 0.0), 0.7), 0.0, 0.25)
        times.append(twin.astray)
    assert times == [0.25, 0.5, 0.75, 1.0]
    assert step_twin(BODY, twin, held(0.0), held(-0.7), 0.0, 0.25) is None
    assert step_twin(BODY, twin, held(0.0), held(0.0), 0.0, 0.25).astray == 0.0
    assert step_twin(BODY, twin, held(0.0), None, 0.0, 0.25).astray == 0.0


class Told(PlanarPlant):
    """A plant that says another speed than it has."""

    def observe(self, state):
        speed, rate = SAID[-1]
        return replace(
            super().observe(state), center_of_mass_velocity=np.array(speed), heading_rate=rate
        )


SAID: list[tuple[tuple[float, float], float]] = []


@pytest.mark.parametrize(
    ("speed", "rate", "is_sane"),
    [
        ((9.99, -9.99), 49.9, True),
        ((10.0, 0.0), 0.0, False),
        ((0.0, -10.0), 0.0, False),
        ((0.0, 0.0), 50.0, False),
        ((0.0, 0.0), -50.0, False),
        ((math.nan, 0.0), 0.0, False),
    ],
)
def test_a_twin_beyond_ten_meters_or_fifty_radians_per_second_has_diverged(speed, rate, is_sane):
    SAID.append((speed, rate))
    told = Told(robot=BODY.robot, environment=BODY.environment, settings=BODY.settings)
    assert (
        step_twin(told, start_twin(told, held()), held(), None, 0.0, 0.01) is not None
    ) == is_sane


FINNED = lc.load_robot("mamba-fin")
DRIVEN = replace(FINNED, caudal_fin=replace(FINNED.caudal_fin, joint=lc.robot.Joint()))


def test_a_driven_fin_goes_to_its_reference_and_a_robot_without_one_takes_none():
    body = lc.build_plant(DRIVEN, lc.load_water("paper-eel"), joints="servo")
    turns = []
    for fin in ((), (0.4,), (0.4, 9.0)):
        twin = start_twin(body, held(0.0))
        for _ in range(20):
            twin = step_twin(body, twin, held(0.0), None, 0.0, 0.02, fin=fin)
        turns.append(twin.turn)
    assert turns[1] == turns[2] != turns[0]
    one, two = (
        step_twin(BODY, start_twin(BODY, held()), held(), None, 0.0, 0.02, fin=fin)
        for fin in ((), (0.4,))
    )
    assert one.along == two.along and one.turn == two.turn


def test_a_twin_has_as_many_yaw_joints_as_its_robot_and_in_space_no_others():
    check_plant(None, BODY.robot)
    check_plant(BODY, BODY.robot)
    built = lc.load_robot("mamba-modules")
    check_plant(lc.build_plant(built.planar(), BODY.environment, joints="servo"), built)
    space = lc.build_plant(built, BODY.environment, model="spatial", joints="servo")
    with pytest.raises(
        ValueError, match=r"`plant` must have 9 joints, all of them yaw joints, got 18\."
    ):
        check_plant(space, built)
    pd = lc.build_plant(BODY.robot, BODY.environment, joints="pd")
    check_plant(pd, BODY.robot)


def test_of_a_twin_in_space_the_motion_in_the_plane_counts():
    body = lc.build_plant(BODY.robot, BODY.environment, model="spatial", joints="servo")
    check_plant(body, BODY.robot)
    twin = start_twin(body, held(0.0))
    for k in range(5):
        twin = step_twin(body, twin, waves(0.05 * k), None, 0.0, 0.05)
    assert twin.center_of_mass.shape == twin.velocity.shape == (2,)
    now = body.observe(twin.plant)
    assert twin.velocity == pytest.approx(now.center_of_mass_velocity[:2])
    assert twin.center_of_mass == pytest.approx(now.center_of_mass[:2])


def beside(angle: float = 0.3) -> tuple[Estimator, object]:
    """An estimator with a twin, after its first frame and references, at 0.1 s."""
    estimator = Estimator(robot=BODY.robot, plant=BODY)
    state = estimator.init()
    for sample in (
        ReferenceSample(time=0.0, angle=held(angle), frequency=1.0),
        JointSample(time=0.1, angle=held(0.05)),
        PoseSample(time=0.1, position=np.array([1.0, 2.0, 0.0]), rotation=np.eye(3)),
    ):
        state = estimator.step(state, sample)
    return estimator, state


def test_the_filter_takes_what_the_twin_foresees_step_by_step():
    estimator, state = beside()
    now = state.latest
    assert now.twin is not None and not now.twin_failed
    known, twin, lagged = now.posterior, now.twin, None
    later = estimator.step(state, ReferenceSample(time=0.2, angle=held(-0.1), frequency=1.0)).latest
    lagged = later.lagged
    for _ in range(2):
        twin = step_twin(BODY, twin, now.reference, lagged + known.mean[JOINTS::2], 1.0, 0.05)
        mean, f, q = estimator.twin_model.step(known.mean, lagged, 1.0, 0.05, twin)
        known = known.predict(mean, f, q)
    assert later.posterior.mean == pytest.approx(known.mean, abs=1e-12)
    np.testing.assert_allclose(later.posterior.covariance, known.covariance, rtol=1e-9, atol=1e-15)
    assert later.twin.center_of_mass == pytest.approx(twin.center_of_mass, abs=1e-12)
    found = estimator.estimate(state)
    velocity, turning = estimator.twin_model.rates(
        now.posterior.mean, now.lagged, now.lagged_rate, 1.0, now.twin
    )
    assert found.center_of_mass_velocity == pytest.approx(
        velocity
    ) and found.heading_rate == pytest.approx(turning)


def test_references_start_the_twin_once_and_what_explains_the_motion_is_open_then():
    estimator = Estimator(robot=BODY.robot, plant=BODY)
    state = estimator.init()
    for sample in (
        JointSample(time=0.0, angle=held(0.0)),
        PoseSample(time=0.0, position=np.zeros(3), rotation=np.eye(3)),
    ):
        state = estimator.step(state, sample)
    assert state.latest.twin is None
    after = estimator.step(state, ReferenceSample(time=0.0, angle=held(0.1)))
    first = start_twin(BODY, held(0.1))
    assert after.latest.twin.joint_angle.tolist() == first.joint_angle.tolist()
    expected = estimator.twin_model.reset_motion(state.latest.posterior)
    assert np.array_equal(after.latest.posterior.covariance, expected.covariance)
    again = estimator.step(after, ReferenceSample(time=0.0, angle=held(0.3)))
    assert (
        again.latest.twin is after.latest.twin and again.latest.posterior is after.latest.posterior
    )
    failed = replace(state.latest, twin_failed=True)
    left = estimator.step(
        replace(state, history=(PastStep(None, failed),)),
        ReferenceSample(time=0.0, angle=held(0.3)),
    )
    assert left.latest.twin is None and left.latest.posterior is failed.posterior


def test_without_its_twin_the_filter_goes_on_as_one_that_never_had_it():
    estimator, state = beside()
    gone = replace(
        state.latest, twin=replace(state.latest.twin, astray=0.99, joint_angle=held(2.0))
    )
    after = estimator.step(
        replace(state, history=(PastStep(None, gone),)),
        JointSample(time=0.12, angle=held(math.nan)),
    )
    assert after.latest.twin is None and after.latest.twin_failed
    expected = estimator.model.reset_motion(gone.posterior)
    mean, f, q = estimator.model.step(expected.mean, after.latest.lagged, 1.0, 0.02)
    np.testing.assert_allclose(after.latest.posterior.mean, mean, rtol=1e-9, atol=1e-12)
    whole = expected.predict(mean, f, q).covariance
    np.testing.assert_allclose(after.latest.posterior.covariance, whole, rtol=1e-9, atol=1e-12)


def test_flowing_water_is_the_filters_affair_and_not_the_twins():
    water = replace(BODY.environment, current=LinearShear())
    estimator = Estimator(robot=BODY.robot, plant=lc.build_plant(BODY.robot, water, joints="servo"))
    assert estimator.plant.environment == water.still
    steady = replace(BODY.environment, current=(0.1, 0.0))
    kept = Estimator(robot=BODY.robot, plant=lc.build_plant(BODY.robot, steady, joints="servo"))
    assert kept.plant.environment == steady
