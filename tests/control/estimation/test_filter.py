"""The filter: exact on exact data, blind to the choice of axes, sure of what it should be sure of, deaf to nonsense."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tank.operate.tank import campaign, perfect, swimming

import laticauda as lc
from laticauda.control.estimation import (
    Estimate,
    Estimator,
    JointSample,
    Noise,
    PoseSample,
    ReferenceSample,
)


def last(estimator, arrivals, until=math.inf) -> tuple[object, Estimate]:
    state = estimator.init()
    for arrival, sample in arrivals:
        if arrival <= until:
            state = estimator.step(state, sample)
    estimate = estimator.estimate(state)
    assert estimate is not None
    return state, estimate


def turned(sample, angle, shift):
    """The same sample in other world axes."""
    if not isinstance(sample, PoseSample):
        return sample
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return replace(
        sample,
        position=turn @ sample.position + np.array([*shift, 0.0]),
        rotation=turn @ sample.rotation,
    )


@pytest.fixture(scope="module")
def noisy():
    trial = swimming()
    arrivals, dropped = campaign().sense(trial, campaign().Sensors(), 3)
    return trial, arrivals, dropped


def test_nothing_is_known_before_the_first_frame_and_the_joints():
    estimator = Estimator(robot=lc.load_robot("mamba"))
    state = estimator.init()
    assert estimator.estimate(state) is None
    state = estimator.step(state, PoseSample(time=0.0, position=np.zeros(3), rotation=np.eye(3)))
    assert estimator.estimate(state) is None
    state = estimator.step(state, JointSample(time=0.0, angle=np.zeros(8)))
    state = estimator.step(state, PoseSample(time=0.01, position=np.zeros(3), rotation=np.eye(3)))
    assert estimator.estimate(state) is not None


def test_exact_data_give_the_exact_motion():
    trial = swimming()
    arrivals, dropped = campaign().sense(trial, replace(perfect(), latency=0.0), 0)
    sharp = Noise(position=1e-5, yaw=1e-5, joint=1e-5)
    estimates, _ = campaign().estimate(
        Estimator(robot=trial.robot, noise=sharp), arrivals, trial.time
    )
    off = campaign().errors(trial, estimates, dropped).always
    assert off[0] < 0.02 and off[1] < 0.01  # mm, deg
    k = 900
    assert estimates[k].joint_angle == pytest.approx(trial.joint_angle[k], abs=1e-3)
    assert estimates[k].joint_rate == pytest.approx(trial.joint_rate[k], abs=0.03)
    assert estimates[k].center_of_mass_velocity == pytest.approx(
        trial.center_of_mass_velocity[k], abs=0.01
    )
    assert estimates[k].heading_rate == pytest.approx(trial.heading_rate[k], abs=0.03)
    assert estimates[k].link_angle == pytest.approx(trial.link_angle[k], abs=1e-3)


def test_the_choice_of_world_axes_does_not_matter(noisy):
    _, arrivals, _ = noisy
    estimator = Estimator(robot=lc.load_robot("mamba"))
    angle, shift = 2.5, (3.0, -7.0)
    _, here = last(estimator, arrivals, 4.0)
    _, there = last(
        estimator, [(arrival, turned(sample, angle, shift)) for arrival, sample in arrivals], 4.0
    )
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    assert there.center_of_mass == pytest.approx(
        turn @ here.center_of_mass + np.array(shift), abs=1e-8
    )
    assert there.center_of_mass_velocity == pytest.approx(
        turn @ here.center_of_mass_velocity, abs=1e-8
    )
    assert math.remainder(there.heading - here.heading - angle, 2.0 * math.pi) == pytest.approx(
        0.0, abs=1e-8
    )
    assert there.joint_angle == pytest.approx(here.joint_angle, abs=1e-9)
    assert there.center_of_mass_std == pytest.approx(here.center_of_mass_std, rel=1e-6)


def test_the_heading_goes_on_beyond_half_a_turn():
    estimator = Estimator(robot=lc.load_robot("mamba"))
    state = estimator.init()
    for k in range(800):
        now, yaw = 0.01 * k, 0.01 * k
        c, s = math.cos(yaw), math.sin(yaw)
        state = estimator.step(state, JointSample(time=now, angle=np.zeros(8)))
        rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        state = estimator.step(
            state, PoseSample(time=now, position=np.array([c, s, 0.0]), rotation=rotation)
        )
    estimate = estimator.estimate(state)
    assert estimate.heading == pytest.approx(7.99, abs=0.03)
    assert estimate.heading_rate == pytest.approx(1.0, abs=0.1)


def _shuffled(time: float) -> float:
    """When a sample is handed over: in order for the first second, so that both begin with the same."""
    return time if time < 1.0 else time + 0.03 * math.sin(1e3 * time)


def test_samples_may_come_late_and_out_of_order(noisy):
    _, arrivals, _ = noisy
    estimator = Estimator(robot=lc.load_robot("mamba"))
    chosen = [item for item in arrivals if item[0] <= 3.0]
    ordered = sorted(chosen, key=lambda item: (item[1].time, isinstance(item[1], PoseSample)))
    mixed = sorted(chosen, key=lambda item: _shuffled(item[1].time))
    (state, one), (other, two) = last(estimator, ordered), last(estimator, mixed)
    assert state.n_late == other.n_late == 0
    assert two.center_of_mass == pytest.approx(one.center_of_mass, abs=1e-9)
    assert two.heading == pytest.approx(one.heading, abs=1e-9)


def test_estimates_in_between_change_nothing_and_are_gone_on_from_where_the_next_sample_comes(
    noisy, monkeypatch
):
    _, arrivals, _ = noisy
    estimator = Estimator(robot=lc.load_robot("mamba"))
    chosen = [sample for at, sample in arrivals if at <= 1.0]
    plain = asked = estimator.init()
    for sample in chosen:
        plain = estimator.step(plain, sample)
    n_predictions, before = [], Estimator._advance
    monkeypatch.setattr(
        Estimator, "_advance", lambda *given: n_predictions.append(1) or before(*given)
    )
    for sample in chosen:
        estimator.estimate(asked, sample.time)
        n_predictions.clear()
        is_next = sample.time > asked.latest.time and asked.latest.posterior is not None
        asked = estimator.step(asked, sample)
        assert not (is_next and n_predictions)
    for name in ("mean", "covariance"):
        one, other = (getattr(state.latest.posterior, name) for state in (plain, asked))
        np.testing.assert_array_equal(one, other)


def test_samples_that_come_too_late_are_left_out_and_counted(noisy):
    _, arrivals, _ = noisy
    estimator = Estimator(robot=lc.load_robot("mamba"), horizon=0.05)
    state, before = last(estimator, arrivals, 2.0)
    late = estimator.step(state, JointSample(time=1.0, angle=np.ones(8)))
    assert late.n_late == state.n_late + 1
    after = estimator.estimate(late)
    assert np.array_equal(after.center_of_mass, before.center_of_mass) and after.time == before.time


def test_a_reflection_is_worth_as_much_as_a_lost_frame(noisy):
    _, arrivals, _ = noisy
    estimator = Estimator(robot=lc.load_robot("mamba"))
    until = 5.0
    astray, lost, count = [], [], 0
    for k, (arrival, sample) in enumerate(arrivals):
        if isinstance(sample, PoseSample) and arrival > 1.0 and k % 40 < 3:
            count += arrival <= until
            far = sample.position + np.array([0.4, -0.3, 0.0])
            astray.append((arrival, replace(sample, position=far)))
            continue
        astray.append((arrival, sample))
        lost.append((arrival, sample))
    (with_them, one), (without, two) = last(estimator, astray, until), last(estimator, lost, until)
    assert count > 5 and with_them.n_outliers - without.n_outliers == count
    assert one.center_of_mass == pytest.approx(two.center_of_mass, abs=1e-9)
    assert one.heading == pytest.approx(two.heading, abs=1e-9)


def test_a_frame_with_a_bad_residual_is_not_believed(noisy):
    _, arrivals, _ = noisy
    estimator = Estimator(robot=lc.load_robot("mamba"))
    state, estimate = last(estimator, arrivals, 2.0)
    frame = PoseSample(
        time=estimate.time, position=np.array([9.0, 9.0, 0.0]), rotation=np.eye(3), residual=0.02
    )
    assert estimator.step(state, frame).n_outliers == state.n_outliers + 1


def test_the_filter_gives_in_when_every_frame_contradicts_it(noisy):
    _, arrivals, _ = noisy
    estimator = Estimator(robot=lc.load_robot("mamba"))
    moved = [
        (arrival, turned(sample, 0.0, (1.0, 0.5)) if arrival > 2.0 else sample)
        for arrival, sample in arrivals
        if arrival <= 4.0
    ]
    _, here = last(estimator, arrivals, 4.0)
    _, there = last(estimator, moved)
    assert there.center_of_mass == pytest.approx(
        here.center_of_mass + np.array([1.0, 0.5]), abs=0.02
    )


def test_without_frames_it_says_that_it_bridges_and_then_that_the_robot_is_lost(noisy):
    _, arrivals, _ = noisy
    estimator = Estimator(robot=lc.load_robot("mamba"))
    state, estimate = last(estimator, arrivals, 2.0)
    stds = []
    for ahead, status in ((0.0, "tracking"), (0.5, "bridging"), (2.0, "lost")):
        found = estimator.estimate(state, estimate.time + ahead)
        assert found.status == status
        stds.append(found.center_of_mass_std)
    assert stds == sorted(stds)
    assert estimator.estimate(state).center_of_mass_std == stds[0]  # asking changes nothing


def test_a_dead_module_is_taken_for_what_its_reference_says(noisy):
    trial, arrivals, _ = noisy
    estimator = Estimator(robot=trial.robot, backlash=campaign().BACKLASH)
    silent = []
    for arrival, sample in arrivals:
        if isinstance(sample, JointSample) and arrival > 2.0:
            angle = sample.angle.copy()
            angle[3] = math.nan
            sample = replace(sample, angle=angle)
        silent.append((arrival, sample))
    _, estimate = last(estimator, silent, 6.0)
    k = int(np.searchsorted(trial.time, estimate.time))
    others = np.delete(np.arange(8), 3)
    assert estimate.joint_angle[others] == pytest.approx(trial.joint_angle[k][others], abs=0.02)
    assert np.isfinite(estimate.center_of_mass).all()


def test_a_joint_that_insists_on_another_angle_is_believed():
    estimator = Estimator(robot=lc.load_robot("mamba"))
    state = estimator.init()
    for k in range(60):
        angle = np.zeros(8)
        angle[2] = 0.5 if k > 30 else 0.0
        state = estimator.step(state, JointSample(time=0.01 * k, angle=angle))
        state = estimator.step(
            state, PoseSample(time=0.01 * k, position=np.zeros(3), rotation=np.eye(3))
        )
        if k == 32:  # for the second time
            assert abs(estimator.estimate(state).joint_angle[2]) < 0.02
    assert estimator.estimate(state).joint_angle[2] == pytest.approx(0.5, abs=0.02)


def test_it_knows_how_far_off_it_is():
    found = []
    trial = swimming()
    for seed in range(2):
        arrivals, _ = campaign().sense(trial, campaign().Sensors(between=5.0), seed)
        estimates, _ = campaign().estimate(
            Estimator(robot=trial.robot, backlash=campaign().BACKLASH), arrivals[:], trial.time
        )
        found.append(campaign().consistency(trial, estimates))
    place, heading = np.mean(found, axis=0)
    assert 0.1 < place < 1.5 and 0.05 < heading < 1.5


def test_turning_tells_a_current_from_the_robots_own_speed_and_a_known_speed_does_so_at_once():
    still = swimming(duration=15.0)
    moving = swimming(duration=15.0, current=(0.03, 0.05))
    arrivals, _ = campaign().sense(moving, campaign().Sensors(between=math.inf), 1)
    speed = still.steady_velocity
    _, ignorant = last(Estimator(robot=moving.robot, backlash=campaign().BACKLASH), arrivals)
    _, told = last(
        Estimator(robot=moving.robot, backlash=campaign().BACKLASH, swim_speed=speed), arrivals
    )
    assert ignorant.current_std > 0.03  # a straight run: along the course it cannot be told
    assert told.current_std < 0.5 * ignorant.current_std
    assert told.current == pytest.approx(np.array([0.03, 0.05]), abs=0.02)


def test_joints_may_come_with_or_without_the_pitch_ones():
    robot = lc.load_robot("mamba-modules")
    estimator = Estimator(robot=robot)
    assert estimator.model.n_joints == 9
    both = np.arange(18) / 100.0
    yaw = both[[joint.axis == "yaw" for joint in robot.joints]]
    pose = PoseSample(time=0.0, position=np.zeros(3), rotation=np.eye(3))
    states = [
        estimator.step(estimator.init(), JointSample(time=0.0, angle=angle))
        for angle in (both, yaw)
    ]
    one, two = (estimator.estimate(estimator.step(state, pose)) for state in states)
    assert np.array_equal(one.link_angle, two.link_angle)
    with pytest.raises(
        ValueError, match=r"`angle` must hold 18 numbers, one per joint of the robot, got 7\."
    ):
        estimator.step(estimator.init(), JointSample(time=0.0, angle=np.zeros(7)))


def test_references_fit_the_robot_too():
    estimator = Estimator(robot=lc.load_robot("mamba"))
    with pytest.raises(
        ValueError, match=r"`angle` must hold 8 numbers, one per joint of the robot, got 3\."
    ):
        estimator.step(estimator.init(), ReferenceSample(time=0.0, angle=np.zeros(3)))


@pytest.mark.parametrize(
    ("setting", "value", "message"),
    [
        ("gate", 0.0, r"`gate` must be > 0, got 0\.0\."),
        ("backlash", -0.1, r"`backlash` must be >= 0 rad, got -0\.1\."),
        ("horizon", -1.0, r"`horizon` must be >= 0 s, got -1\.0\."),
        ("patience", 0, r"`patience` must be a whole number >= 1, got 0\."),
    ],
)
def test_settings_out_of_range_are_refused(setting, value, message):
    with pytest.raises(ValueError, match=message):
        Estimator(robot=lc.load_robot("mamba"), **{setting: value})
