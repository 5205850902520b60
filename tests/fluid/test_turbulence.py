"""Synthetic turbulence: no divergence, its spectrum, its variance, its seed."""

import numpy as np
import pytest
from flow_laws import check_derivatives, check_incompressible
from hypothesis import given
from hypothesis import strategies as st

from laticauda.fluid.turbulence import Turbulence

PLACE = st.floats(-20.0, 20.0)
FLOW = Turbulence(intensity=0.05, mean=(0.2, -0.1, 0.0), evolution=1.0, seed=4)


@given(x=PLACE, y=PLACE, z=PLACE, t=st.floats(0.0, 100.0))
def test_water_is_neither_made_nor_lost_and_the_derivatives_are_those_of_the_velocity(x, y, z, t):
    check_incompressible(FLOW, x, y, z, t)
    check_derivatives(FLOW, x, y, z, t)


def test_the_spectrum_falls_with_the_power_5_3_between_the_largest_and_the_smallest_eddies():
    k, energy = [], []
    for seed in range(40):
        for mode in Turbulence(seed=seed, modes=64).parts:
            k.append((mode.k_x**2 + mode.k_y**2 + mode.k_z**2) ** 0.5)
            energy.append(0.25 * (mode.a_x**2 + mode.a_y**2 + mode.a_z**2))
    low, high = 2.0 * np.pi / 4.0, 2.0 * np.pi / 0.4
    assert low <= min(k)
    assert max(k) <= high
    edges = np.geomspace(low, high, 13)
    held, _ = np.histogram(k, edges, weights=energy)
    slope = np.polyfit(np.log(np.sqrt(edges[1:] * edges[:-1])), np.log(held / np.diff(edges)), 1)[0]
    assert slope == pytest.approx(-5.0 / 3.0, rel=0.05)


def test_the_spectrum_along_a_line_falls_so_too():
    # Of the velocity along the line: E_11 = 1/2 int_k^inf E(q) / q (1 - k^2 / q^2) dq, cut at the smallest eddies.
    n, length, spectra = 1024, 60.0, []
    x = np.linspace(0.0, length, n, endpoint=False)
    for seed in range(200):
        u = Turbulence(largest=12.0, smallest=0.2, modes=64, seed=seed).motion(x, 0.0, 0.0, 0.0).u
        spectra.append(np.abs(np.fft.rfft(u * np.hanning(n))) ** 2)
    k, mean = 2.0 * np.pi * np.fft.rfftfreq(n, length / n), np.mean(spectra, axis=0)
    own = (k > 1.0) & (k < 8.0)
    slope = np.polyfit(np.log(k[own]), np.log(mean[own]), 1)[0]
    assert slope == pytest.approx(-5.0 / 3.0, rel=0.08)


def test_each_component_of_the_velocity_has_the_stated_variance_over_seeds():
    flows = [Turbulence(intensity=0.05, seed=seed, modes=48) for seed in range(1500)]
    # Over all places a mode's component has the mean square a^2 / 2.
    found = np.array([[sum(m.a_x**2 for m in f.parts), sum(m.a_z**2 for m in f.parts)] for f in flows])
    assert 0.5 * found.mean(axis=0) == pytest.approx(0.05**2, rel=0.02)
    at_random = np.array([flow.motion(3.0, -2.0, 1.0, 5.0)[:3] for flow in flows])
    assert np.mean(at_random**2) == pytest.approx(0.05**2, rel=0.06)  # 4500 numbers: 2 % is one standard deviation


def test_frozen_turbulence_is_carried_along_by_the_mean_velocity():
    flow = Turbulence(mean=(0.3, 0.1, 0.0), seed=1)
    assert flow.motion(1.0 + 0.3 * 7.0, 2.0 + 0.1 * 7.0, 0.5, 7.0)[:3] == pytest.approx(
        flow.motion(1.0, 2.0, 0.5, 0.0)[:3], abs=1e-12
    )
    moved = Turbulence(mean=(0.3, 0.1, 0.0), seed=1, evolution=1.0)
    assert moved.motion(3.1, 2.7, 0.5, 7.0)[:3] != pytest.approx(moved.motion(1.0, 2.0, 0.5, 0.0)[:3], abs=1e-3)


def test_a_seed_gives_the_same_water_again_and_another_seed_other_water():
    assert Turbulence(seed=3).parts == Turbulence(seed=3).parts
    assert Turbulence(seed=3).parts != Turbulence(seed=4).parts


def test_eddies_the_smallest_of_which_are_the_largest_are_refused():
    with pytest.raises(ValueError, match=r"`smallest` must be < 4 m, the largest eddies, got 5"):
        Turbulence(smallest=5.0)
