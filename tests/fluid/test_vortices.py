"""Vortices and the street behind a cylinder."""

import math

import numpy as np
import pytest
from flow_laws import check_derivatives, check_incompressible
from hypothesis import given
from hypothesis import strategies as st

from laticauda.fluid.vortices import ROWS_APART, KarmanStreet, LambOseen

PLACE = st.floats(-2.0, 2.0)
VORTICES = {
    "lamb-oseen": LambOseen(circulation=-0.2, core=0.3, y=0.2, velocity_y=0.1, viscosity=1e-3),
    "street": KarmanStreet(direction=0.4, phase=0.3),
}


@pytest.mark.parametrize("flow", VORTICES.values(), ids=VORTICES)
@given(x=PLACE, y=PLACE, t=st.floats(0.0, 20.0))
def test_water_around_vortices_is_not_made_nor_lost_and_its_derivatives_are_those_of_its_velocity(flow, x, y, t):
    check_incompressible(flow, x, y, -0.3, t)
    check_derivatives(flow, x, y, -0.3, t)


def test_far_from_its_core_a_vortex_is_that_of_its_circulation_and_turns_no_small_body():
    felt = LambOseen(circulation=0.6, core=0.1).felt(0.0, 2.0, 0.0, 0.0)
    assert felt.u == pytest.approx(-0.6 / (4.0 * math.pi), rel=1e-12)
    assert felt.s_z == pytest.approx(0.0, abs=1e-12)
    assert felt.a_y == pytest.approx(-(felt.u**2) / 2.0)


def test_the_middle_of_a_vortex_turns_as_a_solid_body():
    assert LambOseen(circulation=0.6, core=0.1).felt(0.0, 0.0, 0.0, 0.0).s_z == pytest.approx(0.3 / (math.pi * 0.01))


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
        return along[1:-1][(spin[1:-1] > spin[:-2]) & (spin[1:-1] > spin[2:]) & (spin[1:-1] > 0.5 * spin.max())]

    first, then = centers(10.0), centers(10.8)
    assert np.diff(first) == pytest.approx(street.spacing, rel=0.01)
    assert (then[then > first[1]][0] - first[1]) / 0.8 == pytest.approx(street.street_speed * 0.25, rel=0.01)


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
    assert street.motion(center, row, 0.0, times[0]).u == pytest.approx(street.street_speed * street.speed, rel=0.01)


def test_vortices_that_would_overlap_are_refused():
    with pytest.raises(ValueError, match=r"`core` must be <= 0.43, half the way between vortices, got 0.5"):
        KarmanStreet(strouhal=1.0, core=0.5)
