"""Vortices and the street behind a cylinder; turbulence: no divergence, its spectrum, its variance, its seed."""

import math

import numpy as np
import pytest
from flow_laws import check_derivatives, check_incompressible
from hypothesis import given, strategies as st

from laticauda.water.fluid.eddies import ROWS_APART, KarmanStreet, LambOseen, Turbulence

PLACE = st.floats(-2.0, 2.0)
FAR = st.floats(-20.0, 20.0)
VORTICES = {
    "lamb-oseen": LambOseen(circulation=-0.2, core=0.3, y=0.2, velocity_y=0.1, viscosity=1e-3),
    "street": KarmanStreet(direction=0.4, phase=0.3),
}
TURBULENCE = Turbulence(intensity=0.05, mean=(0.2, -0.1, 0.0), evolution=1.0, seed=4)


@pytest.mark.parametrize("flow", VORTICES.values(), ids=VORTICES)
@given(x=PLACE, y=PLACE, t=st.floats(0.0, 20.0))
def test_water_around_vortices_is_not_made_nor_lost_and_its_derivatives_are_those_of_its_velocity(
    flow, x, y, t
):
    check_incompressible(flow, x, y, -0.3, t)
    check_derivatives(flow, x, y, -0.3, t)


def test_far_from_its_core_a_vortex_is_that_of_its_circulation_and_turns_no_small_body():
    felt = LambOseen(circulation=0.6, core=0.1).felt(0.0, 2.0, 0.0, 0.0)
    assert felt.u == pytest.approx(-0.6 / (4.0 * math.pi), rel=1e-12)
    assert felt.s_z == pytest.approx(0.0, abs=1e-12)
    assert felt.a_y == pytest.approx(-(felt.u**2) / 2.0)


def test_the_middle_of_a_vortex_turns_as_a_solid_body():
    assert LambOseen(circulation=0.6, core=0.1).felt(0.0, 0.0, 0.0, 0.0).s_z == pytest.approx(
        0.3 / (math.pi * 0.01)
    )


def test_a_lamb_oseen_vortex_obeys_the_equation_of_its_vorticity():
    flow, d, nu = LambOseen(circulation=0.6, core=0.2, viscosity=2e-3), 1e-3, 2e-3

    def vorticity(x, y, t):
        return 2.0 * flow.felt(x, y, 0.0, t).s_z

    x, y, t = 0.15, 0.1, 3.0
    rate = (vorticity(x, y, t + d) - vorticity(x, y, t - d)) / (2.0 * d)
    near = sum(vorticity(x + a, y + b, t) for a, b in ((d, 0), (-d, 0), (0, d), (0, -d)))
    assert rate == pytest.approx(nu * (near - 4.0 * vorticity(x, y, t)) / d**2, rel=1e-4)


def test_a_street_has_the_strouhal_number_the_spacing_and_the_speed_that_it_states():
    street = KarmanStreet(speed=0.25, diameter=0.2, pairs=12)
    x, rows = 0.5 * street.pairs * street.spacing, 0.5 * ROWS_APART * street.spacing
    times = np.arange(0.0, 40.0 / street.frequency, 0.01)
    across = street.motion(x, 0.0, 0.0, times).v
    crossings = times[1:][(across[1:] >= 0.0) & (across[:-1] < 0.0)]
    frequency = (crossings.size - 1) / (crossings[-1] - crossings[0])
    assert frequency * 0.2 / 0.25 == pytest.approx(0.2, rel=0.01)

    def centers(t):  # of the vortices of one row: where the vorticity is largest
        along = np.linspace(x - 2.2 * street.spacing, x + 2.2 * street.spacing, 4001)
        spin = -street.felt(along, rows, 0.0, t).s_z
        return along[1:-1][
            (spin[1:-1] > spin[:-2]) & (spin[1:-1] > spin[2:]) & (spin[1:-1] > 0.5 * spin.max())
        ]

    first, then = centers(10.0), centers(10.8)
    assert np.diff(first) == pytest.approx(street.spacing, rel=0.01)
    assert (then[then > first[1]][0] - first[1]) / 0.8 == pytest.approx(
        street.street_speed * 0.25, rel=0.01
    )


def test_the_vortices_of_a_street_drive_each_other_at_the_speed_at_which_it_moves():
    street = KarmanStreet(pairs=60)
    middle = 0.5 * street.pairs * street.spacing
    own = street.circulation
    times = np.linspace(0.0, 1.0 / street.frequency, 400, endpoint=False)
    # At a vortex its own velocity is 0, so what moves it there is all the others and the stream.
    row = 0.5 * ROWS_APART * street.spacing
    along = np.linspace(middle, middle + street.spacing, 2001)
    spin = -street.felt(along, row, 0.0, times[0]).s_z
    center = along[np.argmax(spin)]
    assert own > 0.0
    assert street.motion(center, row, 0.0, times[0]).u == pytest.approx(
        street.street_speed * street.speed, rel=0.01
    )


def test_vortices_that_would_overlap_are_refused():
    with pytest.raises(
        ValueError, match=r"`core` must be <= 0.43, half the vortex spacing, got 0.5"
    ):
        KarmanStreet(strouhal=1.0, core=0.5)


@given(x=FAR, y=FAR, z=FAR, t=st.floats(0.0, 100.0))
def test_water_is_neither_made_nor_lost_and_the_derivatives_are_those_of_the_velocity(x, y, z, t):
    check_incompressible(TURBULENCE, x, y, z, t)
    check_derivatives(TURBULENCE, x, y, z, t)


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
    # Of the velocity along the line: E_11 = 1/2 int_k^inf E(q) / q (1 - k^2 / q^2) dq, cut at the
    # smallest eddies.
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
    found = np.array(
        [[sum(m.a_x**2 for m in f.parts), sum(m.a_z**2 for m in f.parts)] for f in flows]
    )
    assert 0.5 * found.mean(axis=0) == pytest.approx(0.05**2, rel=0.02)
    at_random = np.array([flow.motion(3.0, -2.0, 1.0, 5.0)[:3] for flow in flows])
    assert np.mean(at_random**2) == pytest.approx(
        0.05**2, rel=0.06
    )  # 4500 numbers: 2 % is one standard deviation


def test_frozen_turbulence_is_carried_along_by_the_mean_velocity():
    flow = Turbulence(mean=(0.3, 0.1, 0.0), seed=1)
    assert flow.motion(1.0 + 0.3 * 7.0, 2.0 + 0.1 * 7.0, 0.5, 7.0)[:3] == pytest.approx(
        flow.motion(1.0, 2.0, 0.5, 0.0)[:3], abs=1e-12
    )
    moved = Turbulence(mean=(0.3, 0.1, 0.0), seed=1, evolution=1.0)
    assert moved.motion(3.1, 2.7, 0.5, 7.0)[:3] != pytest.approx(
        moved.motion(1.0, 2.0, 0.5, 0.0)[:3], abs=1e-3
    )


def test_a_seed_gives_the_same_water_again_and_another_seed_other_water():
    assert Turbulence(seed=3).parts == Turbulence(seed=3).parts
    assert Turbulence(seed=3).parts != Turbulence(seed=4).parts


def test_eddies_the_smallest_of_which_are_the_largest_are_refused():
    with pytest.raises(ValueError, match=r"`smallest` must be < `largest` = 4 m, got 5"):
        Turbulence(smallest=5.0)
