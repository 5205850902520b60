"""Where all joints are prescribed, a kernel of their own does what the general one does."""

from dataclasses import replace

import numpy as np
import pytest
from chains import FORMS, random_robot, random_water
from hypothesis import example, given, settings, strategies as st

import laticauda as lc
from laticauda.compiling.lane_types import dual_row
from laticauda.models.planar import rows
from laticauda.models.planar.batch import STEP, WIDTH, aligned
from laticauda.models.planar.model import RUN, RUN_PRESCRIBED, PlanarPlant, specialize
from laticauda.robot import Thruster
from laticauda.water.fluid.laws import TotalSpeedDrag
from laticauda.water.fluid.uniform import LinearShear

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.2, phase_shift=0.7, offset=0.1)
COMMAND = lc.Command(gait=GAIT)
WATER = lc.load_water("paper-lateral")
TOLERANCE = 1e-12


def rows_of_random_state(rng: np.random.Generator, plant: PlanarPlant) -> np.ndarray:
    """Return the rows of a plant that moves and bends in any way."""
    start = lc.Start(velocity=rng.uniform(-0.5, 0.5), heading=rng.uniform(-3.0, 3.0))
    gait = lc.lateral_undulation(
        amplitude=rng.uniform(0.1, 1.0),
        frequency=rng.uniform(0.5, 6.0),
        phase_shift=rng.uniform(-1.0, 1.0),
        offset=rng.uniform(-0.3, 0.3),
    )
    command = lc.Command(gait=gait)
    S = plant.rows(plant.init(start, command), command)
    S[rows.HEADING_RATE] = rng.uniform(-3.0, 3.0)
    S[rows.PHASE] = rng.uniform(-3.0, 3.0)
    S[rows.TIME] = rng.uniform(0.0, 2.0)
    # The filters of the generator have not yet settled.
    S[rows.PHASE + 1 : rows.OFFSET_RATE + 1] += rng.uniform(
        -0.2, 0.2, rows.OFFSET_RATE - rows.PHASE
    )
    return S


def march(
    name: str, plant: PlanarPlant, S: np.ndarray, n_steps: int, width: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """Return rows and log after some steps by the kernel of this name."""
    run = getattr(specialize(width, plant.law), name)
    S = S.copy()
    log = np.zeros((1 + n_steps, plant.layout.sample_size, *S.shape[1:]), S.dtype)
    if S.ndim == 1 and width == 1:
        log = log[..., np.newaxis]
    n_samples = run(S, *plant.layout.chain, False, n_steps, plant.dt, 1, log)
    assert n_samples == 1 + n_steps
    return S, log


def assert_close(actual: np.ndarray, expected: np.ndarray, tolerance: float = TOLERANCE) -> None:
    """Compare numbers of one kind, by the largest of them."""
    scale = np.abs(expected).max()
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=tolerance * scale)


def size_of_torques(general: np.ndarray, joints: np.ndarray) -> np.ndarray:
    """Return by what the torques of joints are rounded: the sizes of the moments that they are the sum of.

    Inertia of all bodies ahead and the loads on them may all but balance each other, and what is left be
    smaller than the rounding of either.
    """
    size = np.abs(general[joints + rows.P0])
    for inertia, acceleration in (
        (rows.A00, rows.LINK_ACCELERATION),
        (rows.A01, rows.QX),
        (rows.A02, rows.QY),
    ):
        size = size + np.abs(general[joints + inertia] * general[joints + acceleration])
    return size


@example(seed=26014803, form="classic", is_total=True, is_still=False)
@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from(FORMS), st.booleans(), st.booleans())
def test_an_evaluation_gives_what_the_general_recursion_gives(seed, form, is_total, is_still):
    rng = np.random.default_rng(seed)
    robot = random_robot(rng, int(rng.integers(1, 12)))
    law = TotalSpeedDrag(beta=0.4, gamma=0.9) if is_total else None
    water = random_water(rng, form, law=law)
    if is_still:
        water = replace(water, current=(0.0, 0.0))
    plant = PlanarPlant(robot=robot, environment=water)
    assert plant.run_name == RUN_PRESCRIBED
    S = rows_of_random_state(rng, plant)
    general, _ = march(RUN, plant, S, 0)
    own, _ = march(RUN_PRESCRIBED, plant, S, 0)
    # The heading's is the mean of those of the links, and may be near 0 between large ones.
    links = rows.HEADER_ROWS + rows.BODY_ROWS * np.arange(plant.layout.n_bodies)
    largest_turn = np.abs(general[links + rows.LINK_ACCELERATION]).max()
    difference = own[rows.HEADING_ACCELERATION] - general[rows.HEADING_ACCELERATION]
    assert abs(difference) <= TOLERANCE * largest_turn
    assert_close(own[rows.AX : rows.AY + 1], general[rows.AX : rows.AY + 1])
    joints = rows.HEADER_ROWS + rows.BODY_ROWS * np.arange(1, plant.layout.n_bodies)
    if joints.size:
        size = size_of_torques(general, joints)
        torque_difference = own[joints + rows.TORQUE] - general[joints + rows.TORQUE]
        assert np.abs(torque_difference).max() <= TOLERANCE * size.max()
        powers = slice(rows.POWER_ABSOLUTE, rows.POWER_ELECTRICAL + 1)
        largest_power = np.sum(size * np.abs(general[joints + rows.RATE]))
        assert np.abs(own[powers] - general[powers]).max() <= TOLERANCE * largest_power


@pytest.mark.parametrize("current", [(0.0, 0.0), (0.1, -0.05)])
@pytest.mark.parametrize("robot", ["mamba", "amphibot"])
def test_a_run_ends_where_that_of_the_general_recursion_ends(robot, current):
    plant = lc.build_plant(robot, replace(WATER, current=current))
    S = plant.rows(plant.init(lc.Start(velocity=0.1), COMMAND), COMMAND)
    _, general = march(RUN, plant, S, 600)
    _, own = march(RUN_PRESCRIBED, plant, S, 600)
    assert_close(own, general)


def test_derivatives_are_those_of_the_general_recursion():
    plant = lc.build_plant("mamba", WATER)
    S = plant.rows(plant.init(lc.Start(), COMMAND), COMMAND)
    rng = np.random.default_rng(1)
    # Lane k moves every eighth row, so that all parameters are perturbed, but not all at once.
    in_lane = np.arange(S.size)[:, np.newaxis] % WIDTH == np.arange(WIDTH)
    slopes = rng.normal(size=(S.size, WIDTH)) * S[:, np.newaxis] * in_lane
    # Shares of the mass always add up to 1.
    shares = rows.HEADER_ROWS + rows.BODY_ROWS * np.arange(plant.layout.n_bodies) + rows.MASS_SHARE
    slopes[shares] -= slopes[shares].mean(axis=0)
    # A current of 0 has a derivative, too.
    slopes[rows.CURRENT_X] = 1.0
    flat = aligned((S.size,), dual_row(WIDTH, 1))
    flat["value"] = S[:, np.newaxis]
    flat["slopes"][:, 0] = STEP * slopes
    logs = [march(name, plant, flat, 40, WIDTH)[1] for name in (RUN, RUN_PRESCRIBED)]
    (general, general_slope), (own, own_slope) = ((log["value"], log["slopes"]) for log in logs)
    assert_close(own, general)
    assert np.abs(general_slope[-1, rows.X - rows.TIME]).min() > 0.1 * STEP
    for general_of_row, own_of_row in zip(
        general_slope.swapaxes(0, 1), own_slope.swapaxes(0, 1), strict=True
    ):
        assert_close(own_of_row, general_of_row, 1e-11)


def test_a_lane_in_still_water_does_not_see_a_current_in_another_lane():
    still = lc.build_plant("mamba", WATER)
    flowing = lc.build_plant("mamba", replace(WATER, current=(0.2, 0.1)))
    columns = [plant.rows(plant.init(lc.Start(), COMMAND), COMMAND) for plant in (still, flowing)]
    together = np.ascontiguousarray(np.stack([columns[0], *[columns[1]] * 7], axis=1))
    alone = np.ascontiguousarray(np.stack([columns[0]] * 8, axis=1))
    _, log_together = march(RUN_PRESCRIBED, still, together, 40, WIDTH)
    _, log_alone = march(RUN_PRESCRIBED, still, alone, 40, WIDTH)
    assert log_together[:, :, 0].tobytes() == log_alone[:, :, 0].tobytes()


def test_what_the_kernel_of_prescribed_joints_lacks_goes_by_the_general_one():
    thruster = Thruster(link=0, thrust=1.0)
    pushed = replace(lc.load_robot("mamba").planar(), thrusters=(thruster,))
    sheared = replace(WATER, current=LinearShear(speed=0.1))
    assert lc.build_plant("mamba", WATER).run_name == RUN_PRESCRIBED
    for plant in (
        lc.build_plant("mamba", WATER, joints="pd"),
        lc.build_plant("mamba-fin", WATER),
        lc.build_plant(pushed, WATER),
        lc.build_plant("mamba", sheared),
    ):
        assert plant.run_name == RUN
        assert plant.kernels_of(WIDTH).run is getattr(
            specialize(WIDTH, plant.law, plant.joints, plant.flow.kinds), RUN
        )
