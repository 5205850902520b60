"""Volume and centroid under a flat surface, against quadrature over Sobol's points; no jumps."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.spatial.transform import Rotation
from scipy.stats import qmc

from laticauda.water.mujoco.hydrostatics import BOX, CYLINDER, ELLIPSOID, wetted, wetting

SHAPES = {"ellipsoid": ELLIPSOID, "cylinder": CYLINDER, "box": BOX}
HALF = (0.3, 0.1, 0.07)


@cache
def points(shape: str) -> np.ndarray:
    """Spread evenly over the body."""
    cube = 2.0 * qmc.Sobol(3, seed=1).random_base2(18) - 1.0
    round_axes = {"box": cube[:, :0], "cylinder": cube[:, 1:], "ellipsoid": cube}[shape]
    return cube[np.sum(round_axes**2, axis=1) <= 1.0] * np.array(HALF)


def by_points(shape: str, up: np.ndarray, depth: float) -> tuple[float, np.ndarray]:
    """Share and moment by counting points."""
    spread = points(shape)
    under = spread @ up <= depth
    return float(np.mean(under)), spread[under].sum(axis=0) / len(spread)


def direction(seed: int) -> np.ndarray:
    up = np.random.default_rng(seed).normal(size=3)
    return up / np.linalg.norm(up)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(
    "up", [(0, 0, 1.0), (0, 0, -1.0), (0, 1.0, 0), (1.0, 0, 0), *(direction(s) for s in range(4))]
)
@pytest.mark.parametrize("relative_depth", [-0.6, -0.2, 0.0, 0.3, 0.8])
def test_share_and_centroid_are_those_of_the_body(shape: str, up, relative_depth: float):
    up = np.asarray(up, dtype=float)
    depth = relative_depth * float(np.sum(np.abs(up) * HALF))
    share, *centroid = wetted(SHAPES[shape], HALF, up, depth)
    expected, moment = by_points(shape, up, depth)
    assert share == pytest.approx(expected, abs=0.001)
    np.testing.assert_allclose(share * np.array(centroid), moment, atol=0.001 * HALF[0])


@pytest.mark.parametrize("shape", SHAPES)
@given(st.integers(0, 1000), st.floats(-1.0, 1.0), st.booleans())
def test_the_rate_of_the_share_is_its_change_with_time(
    shape: str, seed: int, relative_depth: float, still: bool
):
    rng, dt = np.random.default_rng(seed), 1e-5
    up = direction(seed)
    turning, sinking = (0.0 if still else 1.0) * rng.normal(size=3), rng.normal()
    depth = relative_depth * float(np.sum(np.abs(up) * HALF))
    now = wetted(SHAPES[shape], HALF, up, depth)[0]
    before, after = (
        wetted(
            SHAPES[shape], HALF, Rotation.from_rotvec(-turning * t).apply(up), depth + sinking * t
        )[0]
        for t in (-dt, dt)
    )
    rate = wetting(now, SHAPES[shape], HALF, tuple(up), depth, tuple(turning), sinking, 1e-7)
    assert rate == pytest.approx((after - before) / (2.0 * dt), abs=1e-3)


@pytest.mark.parametrize("shape", SHAPES)
@given(st.integers(0, 1000), st.floats(-1.0, 1.0))
def test_the_lift_s_moment_is_the_slope_of_its_energy(shape: str, seed: int, relative_depth: float):
    """The same potential gives share, moment and so the work of turning: energy is kept whatever the body does."""
    up, dt = direction(seed), 1e-5
    turning = np.random.default_rng(seed + 1).normal(size=3)
    depth = relative_depth * float(np.sum(np.abs(up) * HALF))

    def energy(t: float) -> float:  # of what is displaced, per rho g V
        z = Rotation.from_rotvec(-turning * t).apply(up)
        share, *center = wetted(SHAPES[shape], HALF, z, depth)
        return share * (depth - z @ center)

    share, *center = wetted(SHAPES[shape], HALF, up, depth)
    torque = share * np.cross(center, up)
    assert -(energy(dt) - energy(-dt)) / (2.0 * dt) == pytest.approx(
        torque @ turning, abs=1e-4 * HALF[0]
    )


@pytest.mark.parametrize("shape", SHAPES)
def test_a_covered_body_is_whole_and_a_dry_one_is_nothing(shape: str):
    for seed in range(20):
        assert wetted(SHAPES[shape], HALF, direction(seed), 1.0) == pytest.approx(
            (1.0, 0.0, 0.0, 0.0), abs=1e-15
        )
        assert wetted(SHAPES[shape], HALF, direction(seed), -1.0) == (0.0, 0.0, 0.0, 0.0)


@given(st.sampled_from(sorted(SHAPES)), st.integers(0, 1000), st.floats(-1.2, 1.2))
def test_nothing_jumps_and_deeper_is_wetter(shape: str, seed: int, relative_depth: float):
    up, step = direction(seed), 1e-7
    depth = relative_depth * float(np.sum(np.abs(up) * HALF))
    here = np.array(wetted(SHAPES[shape], HALF, up, depth))
    lower = np.array(wetted(SHAPES[shape], HALF, up, depth + step))
    assert lower[0] >= here[0] - 1e-14
    moment_here, moment_lower = here[0] * here[1:], lower[0] * lower[1:]
    np.testing.assert_allclose(lower[0], here[0], atol=1e-4)
    np.testing.assert_allclose(moment_lower, moment_here, atol=1e-4 * HALF[0])


@given(st.sampled_from(sorted(SHAPES)), st.integers(0, 1000), st.floats(-1.0, 1.0))
def test_upside_down_the_dry_part_is_the_wet_part(shape: str, seed: int, relative_depth: float):
    up = direction(seed)
    depth = relative_depth * float(np.sum(np.abs(up) * HALF))
    share, *centroid = wetted(SHAPES[shape], HALF, up, depth)
    other, *opposite = wetted(SHAPES[shape], HALF, -up, -depth)
    assert share + other == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(share * np.array(centroid), -other * np.array(opposite), atol=1e-9)
