"""The motion model: derivatives against differences, and noise against the law that two steps make a longer one."""

import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.control.estimation import Mount
from laticauda.control.estimation.digital_twin import TwinState
from laticauda.control.estimation.filter_state import Gaussian
from laticauda.control.estimation.motion_model import MotionModel
from laticauda.control.estimation.state_vector import (
    ACROSS_GAIN,
    HEADING_GAIN,
    JOINTS,
    RIPPLE,
    RIPPLES,
    SLIP,
    TURN,
    VX,
    VY,
    H,
    R,
    S,
    U,
    X,
    Y,
)
from laticauda.robot.kinematics import Posture, link_angles

STEP = 1e-6
FORESEEN = TwinState(
    plant=None,
    center_of_mass=np.zeros(2),
    velocity=np.zeros(2),
    heading=0.0,
    rate=0.0,
    joint_angle=np.zeros(8),
    along=0.003,
    across=-0.001,
    turn=0.02,
)


def model(has_twin: bool = False, swim_speed: float | None = None) -> MotionModel:
    mount = Mount(module=2, offset=(0.03, -0.02), angle=0.1)
    return MotionModel(
        robot=lc.load_robot("mamba"), mount=mount, has_twin=has_twin, swim_speed=swim_speed
    )


def somewhere(motion: MotionModel, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A mean and the joints' references, both far from zero in all of their parts."""
    chance = np.random.default_rng(seed)
    return chance.uniform(-0.5, 0.5, motion.size), chance.uniform(-0.5, 0.5, motion.n_joints)


def differences(function, mean: np.ndarray) -> np.ndarray:
    columns = []
    for i in range(mean.size):
        shift = np.zeros(mean.size)
        shift[i] = STEP
        columns.append((function(mean + shift) - function(mean - shift)) / (2.0 * STEP))
    return np.stack(columns, axis=1)


@pytest.mark.parametrize(
    ("motion", "moved"),
    [(model(), None), (model(swim_speed=0.2), None), (model(has_twin=True), FORESEEN)],
)
@pytest.mark.parametrize("frequency", [0.0, 2.0])
def test_the_derivative_of_a_step_is_that_of_its_differences(motion, moved, frequency):
    mean, reference = somewhere(motion, 1)
    transition = motion.step(mean, reference, frequency, 0.01, moved)[1]
    by_differences = differences(
        lambda at: motion.step(at, reference, frequency, 0.01, moved)[0], mean
    )
    np.testing.assert_allclose(transition, by_differences, atol=1e-5)


def test_the_derivative_of_the_pose_is_that_of_its_differences():
    motion = model()
    mean, reference = somewhere(motion, 2)

    def pose(at: np.ndarray) -> np.ndarray:
        place, heading, _ = motion.pose(at, reference)
        return np.array([*place, heading])

    np.testing.assert_allclose(motion.pose(mean, reference)[2], differences(pose, mean), atol=1e-8)


def test_the_derivative_of_the_marker_is_that_of_its_differences():
    motion = model()
    mean, reference = somewhere(motion, 3)
    by_differences = differences(lambda at: motion.marker(at, reference)[0], mean)
    np.testing.assert_allclose(motion.marker(mean, reference)[1], by_differences, atol=1e-8)


@pytest.mark.parametrize("motion", [model(), model(swim_speed=0.2), model(has_twin=True)])
def test_the_noise_of_two_steps_is_that_of_one_of_twice_the_length(motion):
    """Of whatever is not turned by the gait's phase: there, the noise of a step is that of its end."""
    mean, reference = np.zeros(motion.size), np.zeros(motion.n_joints)
    _, f, once = motion.step(mean, reference, 0.0, 0.02)
    _, _, twice = motion.step(mean, reference, 0.0, 0.04)
    at = np.array([*range(2, 10), *range(JOINTS, motion.size)])
    composed = (f @ once @ f.T + once)[np.ix_(at, at)]
    np.testing.assert_allclose(twice[np.ix_(at, at)], composed, rtol=1e-9, atol=1e-18)


def placed(*, seed: int = 4, has_twin: bool = False, swim_speed: float | None = None):
    """A model, a mean and references, and the parts of the mean by name."""
    motion = model(has_twin, swim_speed)
    mean, reference = somewhere(motion, seed)
    return motion, mean, reference


def through_water(mean: np.ndarray, bend: float, heading: float) -> complex:
    """The velocity of the smooth motion, as a complex number."""
    return complex(mean[U], mean[S] + mean[SLIP] * bend) * np.exp(1j * heading)


@pytest.mark.parametrize("frequency", [0.0, 2.0])
def test_a_step_carries_the_smooth_motion_through_the_water_and_the_water_along(frequency):
    motion, mean, reference = placed()
    dt = 0.03
    bend = float(np.mean(reference + mean[JOINTS::2]))
    after, _, _ = motion.step(mean, reference, frequency, dt)
    turning = mean[R] + mean[TURN] * bend
    way = dt * (
        through_water(mean, bend, mean[H] + 0.5 * dt * turning) + complex(mean[VX], mean[VY])
    )
    assert complex(*after[[X, Y]]) - complex(*mean[[X, Y]]) == pytest.approx(way)
    assert after[H] - mean[H] == pytest.approx(dt * turning)
    assert after[[VX, VY, R, TURN, SLIP, U]] == pytest.approx(mean[[VX, VY, R, TURN, SLIP, U]])
    assert after[HEADING_GAIN] == pytest.approx(mean[HEADING_GAIN])
    assert after[ACROSS_GAIN] == pytest.approx(mean[ACROSS_GAIN])
    assert after[S] == pytest.approx(mean[S] * math.exp(-dt / 6.0))  # of `sway_time`
    assert after[JOINTS::2] == pytest.approx(mean[JOINTS::2] + dt * mean[JOINTS + 1 :: 2])
    assert after[JOINTS + 1 :: 2] == pytest.approx(mean[JOINTS + 1 :: 2])


def test_a_step_beside_a_twin_goes_the_twins_way_in_the_robots_own_axes():
    motion, mean, reference = placed(has_twin=True)
    dt = 0.03
    bend = float(np.mean(reference + mean[JOINTS::2]))
    after, _, _ = motion.step(mean, reference, 2.0, dt, FORESEEN)
    turning = mean[R] + mean[TURN] * FORESEEN.turn / dt
    middle = mean[H] + 0.5 * (dt * turning + FORESEEN.turn)
    way = dt * (through_water(mean, bend, middle) + complex(mean[VX], mean[VY]))
    way += complex(FORESEEN.along, FORESEEN.across) * np.exp(1j * (mean[H] + 0.5 * dt * turning))
    assert complex(*after[[X, Y]]) - complex(*mean[[X, Y]]) == pytest.approx(way)
    assert after[H] - mean[H] == pytest.approx(dt * turning + FORESEEN.turn)
    assert after[U] == pytest.approx(mean[U] * math.exp(-dt / 10.0))


@pytest.mark.parametrize(("frequency", "target"), [(0.0, 0.0), (0.5, 0.3)])
def test_a_known_speed_is_come_to_within_seconds_and_forgotten_when_the_gait_stands_still(
    frequency, target
):
    motion, mean, reference = placed(swim_speed=0.3)
    fade = math.exp(-0.5 / 4.0)
    after, _, q = motion.step(mean, reference, frequency, 0.5)
    assert after[U] == pytest.approx(target + fade * (mean[U] - target))
    assert q[U, U] == pytest.approx(0.01**2 * (1.0 - fade**2))  # in the end, `swim_speed_std`


@pytest.mark.parametrize(("frequency", "memory"), [(0.0, 0.3), (0.5, 100.0)])
def test_a_ripple_turns_by_the_gaits_phase_and_fades_at_once_when_the_gait_stands_still(
    frequency, memory
):
    motion, mean, reference = placed()
    dt = 0.05
    after, _, q = motion.step(mean, reference, frequency, dt)
    pointers = [
        (0, 1),
        (0, 3),
        (1, 1),
        (1, 2),
        (2, 1),
        (2, 2),
    ]  # of heading, along, across: their harmonics
    assert list(RIPPLES) == pointers
    for i, (kind, harmonic) in enumerate(pointers):
        at = RIPPLE + 2 * i
        turned = complex(*mean[at : at + 2]) * np.exp(1j * harmonic * frequency * dt - dt / memory)
        assert complex(*after[at : at + 2]) == pytest.approx(turned)
        walk = (0.0033 if kind == 0 else 0.006) / harmonic if frequency else 0.0
        assert q[at, at] == q[at + 1, at + 1] == pytest.approx(walk**2 * dt)


def by_name(motion: MotionModel, values: np.ndarray) -> dict[str, object]:
    """A vector's parts; of those that are many, the one that all of them are."""
    found: dict[str, object] = {name: values[at] for name, at in PLACES.items()}
    for name, at in (("heading_gain", HEADING_GAIN), ("across_gain", ACROSS_GAIN)):
        (found[name],) = set(values[at].tolist())
    (found["ripple"],) = set(values[RIPPLE:JOINTS].tolist())
    (found["joint"],), (found["joint_rate"],) = (
        set(values[JOINTS::2].tolist()),
        set(values[JOINTS + 1 :: 2].tolist()),
    )
    return found


PLACES = {
    "x": X,
    "y": Y,
    "u": U,
    "s": S,
    "vx": VX,
    "vy": VY,
    "h": H,
    "r": R,
    "turn": TURN,
    "slip": SLIP,
}
FIRST = {
    **{
        "x": 0.05,
        "y": 0.05,
        "u": 0.1,
        "s": 0.01,
        "vx": 0.1,
        "vy": 0.1,
        "h": 0.05,
        "r": 0.1,
        "turn": 0.5,
        "slip": 0.2,
    },
    **{
        "heading_gain": 1.0,
        "across_gain": 0.1,
        "ripple": 0.0,
        "joint": 2.0 * math.radians(0.3),
        "joint_rate": 0.5,
    },
}
"""Standard deviations at first, in the units of each."""
BESIDE = {"u": 0.02, "turn": 0.05, "slip": 0.02, "heading_gain": 0.1, "across_gain": 0.01}


@pytest.mark.parametrize("has_twin", [False, True])
def test_what_is_known_at_first_is_the_pose_of_the_frame_and_that_speeds_are_small(has_twin):
    motion = model(has_twin)
    place, deviation, rate = np.array([1.0, 2.0]), np.arange(8) / 10.0, np.arange(8) / -5.0
    first = motion.initial(place, 0.7, deviation, rate)
    assert first.mean[[X, Y, H]].tolist() == [1.0, 2.0, 0.7]
    assert first.mean[JOINTS::2].tolist() == deviation.tolist()
    assert first.mean[JOINTS + 1 :: 2].tolist() == rate.tolist()
    rest = np.setdiff1d(np.arange(JOINTS), [X, Y, H])
    assert not first.mean[rest].any()
    assert np.array_equal(first.covariance, np.diag(np.diag(first.covariance)))
    expected = {name: one**2 for name, one in (FIRST | (BESIDE if has_twin else {})).items()}
    assert by_name(motion, np.diag(first.covariance)) == pytest.approx(expected)


def test_when_models_change_pose_current_and_joints_stay_and_what_explains_the_motion_is_open_again():
    motion = model()
    chance = np.random.default_rng(5)
    root = chance.normal(size=(motion.size, motion.size))
    before = Gaussian(mean=chance.normal(size=motion.size), covariance=root @ root.T)
    after = motion.reset_motion(before)
    opened = np.array([U, S, R, TURN, SLIP, *range(10, JOINTS)])
    kept = np.setdiff1d(np.arange(motion.size), opened)
    assert after.mean[kept].tolist() == before.mean[kept].tolist() and not after.mean[opened].any()
    assert np.array_equal(
        after.covariance[np.ix_(kept, kept)], before.covariance[np.ix_(kept, kept)]
    )
    fresh = np.diag(motion.initial(np.zeros(2), 0.0, np.zeros(8), np.zeros(8)).covariance)[opened]
    assert np.array_equal(after.covariance[np.ix_(opened, opened)], np.diag(fresh))
    assert (
        not after.covariance[np.ix_(opened, kept)].any()
        and not after.covariance[np.ix_(kept, opened)].any()
    )


@pytest.mark.parametrize(("has_twin", "speed"), [(False, None), (True, None)])
def test_the_noise_of_a_step_is_that_of_the_settings(has_twin, speed):
    motion = model(has_twin, speed)
    dt = 0.04
    _, _, q = motion.step(np.zeros(motion.size), np.zeros(8), 0.0, dt)
    noise, places = motion.noise, np.arange(JOINTS, motion.size, 2)
    expected = np.zeros_like(q)
    for at, density in (
        (U, noise.surge), (X, noise.position_walk), (Y, noise.position_walk), (VX, noise.current_walk),
        (VY, noise.current_walk), (TURN, noise.turn_gain), (SLIP, noise.slip_gain),
        *((10 + i, noise.heading_gain) for i in range(4)), *((14 + i, noise.across_gain) for i in range(4)),
    ):  # fmt: skip
        expected[at, at] = density**2 * dt
    expected[S, S] = noise.sway**2 * (1.0 - math.exp(-2.0 * dt / noise.sway_time))
    if has_twin:
        expected[U, U] = 0.02**2 * (1.0 - math.exp(-2.0 * dt / 10.0))
    for at, density in ((H, noise.turning), *((int(k), noise.joint_acceleration) for k in places)):
        block = density**2 * np.array([[dt**3 / 3.0, dt**2 / 2.0], [dt**2 / 2.0, dt]])
        expected[at : at + 2, at : at + 2] = block
    np.testing.assert_allclose(q, expected, rtol=1e-12)


def test_the_marker_is_where_kinematics_has_it():
    motion, mean, reference = placed()
    place, heading, _ = motion.pose(mean, reference)
    angle = reference + mean[JOINTS::2]
    theta = link_angles(angle, angle=0.0)
    theta += heading - theta.mean()
    link = Posture(motion.chain, place, theta).link_centers[2]
    c, s = math.cos(theta[2]), math.sin(theta[2])
    offset = np.array([0.03 * c + 0.02 * s, 0.03 * s - 0.02 * c])
    found, _ = motion.marker(mean, reference)
    assert found == pytest.approx([*(link + offset), theta[2]])
    assert heading + motion.spread @ angle == pytest.approx(theta)
    assert (motion.link, motion.n_joints, motion.size) == (2, 8, JOINTS + 16)
    assert (RIPPLE, JOINTS) == (18, 30)  # behind ten numbers and two times four gains; six pointers


def test_the_pose_is_the_smooth_motion_with_ripples_and_what_bending_adds():
    motion, mean, reference = placed()
    angle = reference + mean[JOINTS::2]
    place = (np.arange(8) + 0.5) / 8
    bending = np.array([np.mean(np.cos(math.pi * k * place) * angle) for k in range(4)])
    ripple = mean[RIPPLE:JOINTS:2]  # two of heading, along and across
    along, across = ripple[2] + ripple[3], ripple[4] + ripple[5] + mean[ACROSS_GAIN] @ bending
    found, heading, _ = motion.pose(mean, reference)
    assert complex(*found) == pytest.approx(
        complex(*mean[[X, Y]]) + complex(along, across) * np.exp(1j * mean[H])
    )
    assert heading == pytest.approx(mean[H] + ripple[0] + ripple[1] + mean[HEADING_GAIN] @ bending)


@pytest.mark.parametrize("has_twin", [False, True])
def test_velocity_and_heading_rate_are_those_of_the_pose_as_it_steps_on(has_twin):
    """A law: what `rates` says is what `step` and `pose` do, over a very short step, ripples that do not fade."""
    motion = replace(model(has_twin), ripple_memory=1e9)
    mean, reference = somewhere(motion, 6)
    rate, dt, frequency = np.linspace(-0.4, 0.5, 8), 1e-6, 2.0
    twin = None
    if has_twin:
        forward, turning, heading = np.array([0.2, -0.05]), 0.3, 0.4
        own = complex(*forward) * np.exp(-1j * heading) * dt  # in the twin's own axes
        numbers = {"along": own.real, "across": own.imag, "turn": turning * dt}
        twin = replace(FORESEEN, velocity=forward, rate=turning, heading=heading, **numbers)
    velocity, turned = motion.rates(mean, reference, rate, frequency, twin)
    after, _, _ = motion.step(mean, reference, frequency, dt, twin)
    after[S], after[U] = mean[S], mean[U]
    before, heading, _ = motion.pose(mean, reference)
    then, later, _ = motion.pose(after, reference + dt * rate)
    assert velocity == pytest.approx((then - before) / dt, rel=1e-4, abs=1e-5)
    assert turned == pytest.approx((later - heading) / dt, rel=1e-4, abs=1e-5)


def test_a_robot_with_one_joint_bends_in_two_ways_at_most():
    mamba = lc.load_robot("mamba").planar()
    motion = MotionModel(robot=replace(mamba, modules=mamba.modules[:2], joints=mamba.joints[:1]))
    assert motion.modes == pytest.approx(np.array([[1.0], [0.0], [-1.0], [0.0]]), abs=1e-15)


def test_a_robot_without_joints_has_neither_bending_nor_spread():
    stiff = lc.load_robot("mamba").planar()
    stiff = replace(stiff, modules=stiff.modules[:1], joints=())
    motion = MotionModel(robot=stiff)
    assert (motion.n_joints, motion.size, motion.has_twin) == (0, JOINTS, False)
    assert motion.spread.shape == (1, 0) and motion.modes.shape == (4, 0)
    place, heading, _ = motion.pose(np.arange(JOINTS) / 10.0, np.zeros(0))
    assert np.isfinite([*place, heading]).all()
