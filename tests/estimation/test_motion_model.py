"""The motion model: derivatives against differences, and noise against the law that two steps make a longer one."""

import numpy as np
import pytest

import laticauda as lc
from laticauda.estimation import Mount
from laticauda.estimation.digital_twin import TwinState
from laticauda.estimation.motion_model import JOINTS, MotionModel

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
    return MotionModel(robot=lc.load_robot("mamba"), mount=mount, has_twin=has_twin, swim_speed=swim_speed)


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
    ("motion", "moved"), [(model(), None), (model(swim_speed=0.2), None), (model(has_twin=True), FORESEEN)]
)
@pytest.mark.parametrize("frequency", [0.0, 2.0])
def test_the_derivative_of_a_step_is_that_of_its_differences(motion, moved, frequency):
    mean, reference = somewhere(motion, 1)
    transition = motion.step(mean, reference, frequency, 0.01, moved)[1]
    by_differences = differences(lambda at: motion.step(at, reference, frequency, 0.01, moved)[0], mean)
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
