"""Volume and centroid under a flat surface, against a dense grid of points; no jumps."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from laticauda.mujoco_water.hydrostatics import BOX, CYLINDER, ELLIPSOID, wetted

SHAPES = {"ellipsoid": ELLIPSOID, "cylinder": CYLINDER, "box": BOX}
HALF = (0.3, 0.1, 0.07)


def by_points(shape: str, up: np.ndarray, depth: float) -> tuple[float, np.ndarray]:
    """Share and centroid by counting the points of a grid."""
    axis = (np.arange(80) + 0.5) / 40.0 - 1.0
    grid = np.stack(np.meshgrid(axis, axis, axis), axis=-1).reshape(-1, 3)
    if shape == "ellipsoid":
        grid = grid[np.sum(grid**2, axis=1) <= 1.0]
    elif shape == "cylinder":
        grid = grid[np.sum(grid[:, 1:] ** 2, axis=1) <= 1.0]
    grid = grid * np.array(HALF)
    under = grid @ up <= depth
    return float(np.mean(under)), grid[under].mean(axis=0) if np.any(under) else np.zeros(3)


def direction(seed: int) -> np.ndarray:
    up = np.random.default_rng(seed).normal(size=3)
    return up / np.linalg.norm(up)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("up", [(0, 0, 1.0), (0, 0, -1.0), (0, 1.0, 0), (1.0, 0, 0), *(direction(s) for s in range(4))])
@pytest.mark.parametrize("relative_depth", [-0.6, -0.2, 0.0, 0.3, 0.8])
def test_share_and_centroid_are_those_of_the_body(shape: str, up, relative_depth: float):
    up = np.asarray(up, dtype=float)
    depth = relative_depth * float(np.sum(np.abs(up) * HALF))
    share, *centroid = wetted(SHAPES[shape], *HALF, *up, depth)
    expected, middle = by_points(shape, up, depth)
    # Slices of an eighth of the length are smoothed: about a hundredth of the volume.
    assert share == pytest.approx(expected, abs=0.004 if shape == "ellipsoid" else 0.02)
    np.testing.assert_allclose(
        share * np.array(centroid), expected * middle, atol=(0.002 if shape == "ellipsoid" else 0.02) * HALF[0]
    )


@pytest.mark.parametrize("shape", SHAPES)
def test_a_covered_body_is_whole_and_a_dry_one_is_nothing(shape: str):
    for seed in range(20):
        assert wetted(SHAPES[shape], *HALF, *direction(seed), 1.0) == pytest.approx((1.0, 0.0, 0.0, 0.0), abs=1e-15)
        assert wetted(SHAPES[shape], *HALF, *direction(seed), -1.0) == (0.0, 0.0, 0.0, 0.0)


@given(st.sampled_from(sorted(SHAPES)), st.integers(0, 1000), st.floats(-1.2, 1.2))
def test_nothing_jumps_and_deeper_is_wetter(shape: str, seed: int, relative_depth: float):
    up, step = direction(seed), 1e-7
    depth = relative_depth * float(np.sum(np.abs(up) * HALF))
    here = np.array(wetted(SHAPES[shape], *HALF, *up, depth))
    lower = np.array(wetted(SHAPES[shape], *HALF, *up, depth + step))
    assert lower[0] >= here[0] - 1e-14
    moment_here, moment_lower = here[0] * here[1:], lower[0] * lower[1:]
    np.testing.assert_allclose(lower[0], here[0], atol=1e-4)
    np.testing.assert_allclose(moment_lower, moment_here, atol=1e-4 * HALF[0])


@given(st.sampled_from(sorted(SHAPES)), st.integers(0, 1000), st.floats(-1.0, 1.0))
def test_upside_down_the_dry_part_is_the_wet_part(shape: str, seed: int, relative_depth: float):
    up = direction(seed)
    depth = relative_depth * float(np.sum(np.abs(up) * HALF))
    share, *centroid = wetted(SHAPES[shape], *HALF, *up, depth)
    other, *opposite = wetted(SHAPES[shape], *HALF, *-up, -depth)
    assert share + other == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(share * np.array(centroid), -other * np.array(opposite), atol=1e-9)
