"""Averaging theory (viscous limit, uniform amplitude): v ~ alpha^2 omega k_delta, and where k_delta peaks."""

from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.robot import Ground, load_robot, load_water
from laticauda.water.fluid.laws import PolynomialDrag, ViscousFriction

VISCOUS = replace(
    load_water("paper-lateral"),
    drag=PolynomialDrag(quadratic=False),
    added_mass=0.0,
    added_inertia=0.0,
)


def k_delta(n, delta, envelope=None):
    """sum_ij a_ij g_i g_j sin((j-i) delta) with a = A D^T (D D^T)^-1."""
    A = np.eye(n - 1, n) + np.eye(n - 1, n, 1)
    D = np.eye(n - 1, n) - np.eye(n - 1, n, 1)
    a = A @ D.T @ np.linalg.inv(D @ D.T)
    g = np.ones(n - 1) if envelope is None else np.array(envelope)
    i = np.arange(n - 1)
    return float(np.sum(a * np.outer(g, g) * np.sin((i[np.newaxis] - i[:, np.newaxis]) * delta)))


def steady_speed(amplitude, frequency, phase_shift, n=9, environment=VISCOUS):
    gait = lc.lateral_undulation(amplitude=amplitude, frequency=frequency, phase_shift=phase_shift)
    return lc.swim(
        load_robot("mamba", n_links=n), gait, duration=40.0, environment=environment
    ).steady_velocity


@pytest.mark.parametrize(("n", "lateral", "eel"), [(9, 27, 30), (10, 24, 27)])
def test_k_delta_peaks_where_the_theory_says(n, lateral, eel):
    degrees = np.arange(5, 80)
    growing = [(n - i) / (n + 1) for i in range(1, n)]
    assert degrees[np.argmax([k_delta(n, np.deg2rad(d)) for d in degrees])] == lateral
    assert degrees[np.argmax([k_delta(n, np.deg2rad(d), growing) for d in degrees])] == eel


def test_speed_grows_with_the_square_of_a_small_amplitude():
    small, larger = steady_speed(0.03, 2.0, 0.6), steady_speed(0.06, 2.0, 0.6)
    assert np.log2(larger / small) == pytest.approx(2.0, abs=0.02)


def test_speed_grows_in_proportion_to_the_frequency_where_drag_dominates():
    light = replace(VISCOUS, tangential_friction=3.0, normal_drag=20.0)
    slow, fast = (steady_speed(0.05, w, 0.6, environment=light) for w in (1.0, 2.0))
    assert np.log2(fast / slow) == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize(("n", "lateral"), [(9, 27), (10, 24)])
def test_the_simulated_speed_peaks_at_the_phase_shift_of_k_delta_where_drag_dominates(n, lateral):
    # Anisotropic viscous friction with little mass to it: the setting of the theory.
    ground = Ground(name="viscous", friction=ViscousFriction(), tangential=5.0, normal=50.0)
    robot = load_robot("mamba", n_links=n)

    def speed(degree):
        gait = lc.lateral_undulation(amplitude=0.05, frequency=1.0, phase_shift=np.deg2rad(degree))
        return lc.swim(
            robot, gait, duration=40.0, environment=ground, sample_interval=0.1
        ).steady_velocity

    degrees = np.arange(lateral - 6, lateral + 7, 1)
    peak = degrees[np.argmax([speed(d) for d in degrees])]
    assert abs(peak - lateral) <= 2
