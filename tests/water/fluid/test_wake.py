"""The street behind a swimmer: its circulation, its momentum, its own motion, and where its vortices are left."""

from dataclasses import replace

import numpy as np
import pytest
from flow_laws import check_derivatives, check_incompressible
from hypothesis import given, strategies as st

from laticauda.water.fluid.wake import Wake, find_circulation, flux_of_street

PLACE = st.floats(-2.0, 2.0)
WAKE = Wake(
    speed=0.25,
    period=1.0,
    width=0.16,
    circulation=0.03,
    core=0.03,
    viscosity=1e-5,
    direction=0.4,
    x=0.3,
    phase=0.7,
    pairs=6,
    mean=(0.02, -0.05, 0.0),
)
LONG = replace(
    WAKE, pairs=100, viscosity=0.0, core=0.01, direction=0.0, x=0.0, mean=(0.0, 0.0, 0.0)
)
MIDDLE = -0.5 * LONG.pairs * LONG.spacing
"""x at which the ends of the long street are far away [m]."""


def circulation(flow, low, high, t=0.0):
    """Integral of the velocity around the rectangle between two corners, counter-clockwise [m^2/s]."""
    share = (np.arange(2000) + 0.5) / 2000
    (x_0, y_0), (x_1, y_1) = low, high
    x = x_0 + (x_1 - x_0) * share
    y = y_0 + (y_1 - y_0) * share
    along_x = np.mean(flow.motion(x, y_0, 0.0, t).u - flow.motion(x, y_1, 0.0, t).u)
    along_y = np.mean(flow.motion(x_1, y, 0.0, t).v - flow.motion(x_0, y, 0.0, t).v)
    return along_x * (x_1 - x_0) + along_y * (y_1 - y_0)


def places_of_left_row(t):
    """Where the vortices of the long street's left row are, near its middle: where its water turns most."""
    x = np.linspace(MIDDLE - 1.6 * LONG.spacing, MIDDLE + 1.6 * LONG.spacing, 8001)
    turning = -LONG.felt(x, 0.5 * LONG.width, 0.0, t).s_z
    inner = turning[1:-1]
    is_peak = (inner > turning[:-2]) & (inner > turning[2:]) & (inner > 0.5 * turning.max())
    return x[1:-1][is_peak]


@given(x=PLACE, y=PLACE, t=st.floats(0.0, 20.0))
def test_a_wake_neither_makes_nor_loses_water_and_its_derivatives_are_those_of_its_velocity(
    x, y, t
):
    check_incompressible(WAKE, x, y, -0.3, t)
    check_derivatives(WAKE, x, y, -0.3, t)


def test_around_one_vortex_the_circulation_is_its_own_and_around_a_pair_there_is_none():
    half = 0.5 * LONG.spacing
    x = places_of_left_row(0.0)[0]
    row, far = 0.5 * LONG.width, 1.5
    one = circulation(LONG, (x - 0.4 * half, 0.0), (x + 0.4 * half, 2.0 * row))
    pair = circulation(LONG, (x - 0.5 * half, -far), (x + 1.5 * half, far))
    assert one == pytest.approx(-LONG.circulation, rel=1e-6)
    assert pair == pytest.approx(0.0, abs=1e-6 * LONG.circulation)


def test_far_away_there_is_the_circulation_of_at_most_one_vortex_and_on_average_none():
    wake = replace(WAKE, mean=(0.0, 0.0, 0.0))
    times = np.arange(16) / 16 * wake.period
    around_all = [circulation(wake, (-40.0, -40.0), (40.0, 40.0), t) for t in times]
    assert np.max(np.abs(around_all)) < 1.01 * wake.circulation
    assert np.mean(around_all) == pytest.approx(0.0, abs=1e-4 * wake.circulation)


def test_the_vortices_drive_each_other_at_the_speed_at_which_they_move_and_are_the_stated_spacing_apart():
    places = places_of_left_row(0.0)
    moved = places_of_left_row(0.2)
    assert np.diff(places) == pytest.approx(LONG.spacing, rel=1e-3)
    assert moved[0] - places[0] == pytest.approx(-0.2 * LONG.drift, rel=0.02)
    # At a vortex its own velocity is 0, so what moves it there is all the others.
    felt = LONG.motion(places[1], 0.5 * LONG.width, 0.0, 0.0)
    assert -felt.u == pytest.approx(LONG.drift, rel=0.02)


@pytest.mark.parametrize(("width", "circulation"), [(0.16, 0.03), (0.05, 0.03), (0.3, 0.1)])
def test_the_momentum_that_passes_a_plane_across_the_street_is_that_of_von_karmans_formula(
    width, circulation
):
    # As seen from the leader, and averaged over one spacing: speed times momentum, and the pressure.
    # Its slope across is -a_y of water in which the whole pattern drifts; at the ends it is Bernoulli's.
    street = replace(LONG, width=width, circulation=circulation, core=0.006)
    middle = -0.5 * street.pairs * street.spacing
    x = middle + np.arange(24)[:, np.newaxis] / 24 * street.spacing
    end = 0.5 * width + 1.5 * street.spacing
    y = np.linspace(-end, end, 3001)
    water = street.motion(x, y, 0.0, 0.0)
    backward = -water.u
    from_inside = (water.u + street.drift) * water.v_x + water.v * water.v_y
    at_end = street.drift * backward[:, 0] - 0.5 * (water.u[:, 0] ** 2 + water.v[:, 0] ** 2)
    passing = np.trapezoid((street.speed + backward) * backward + y * from_inside, y, axis=1)
    # What flows back outside a street that ends somewhere flows past this plane, too.
    return_flow = 2.0 * end * (street.speed + street.drift) * np.mean(backward[:, 0])
    flux = np.mean(passing + 2.0 * end * at_end) - return_flow
    assert flux == pytest.approx(street.momentum_flux, rel=0.015)


def test_vortices_are_where_the_tail_turned_clockwise_on_the_left():
    still = replace(WAKE, viscosity=0.0, mean=(0.0, 0.0, 0.0), direction=0.0)
    turn = (0.25 - still.phase / (2.0 * np.pi)) * still.period
    # Half a period later it has grown, and moved back by its own drift.
    t = turn + 0.5 * still.period
    x = still.x + still.speed * turn - still.drift * 0.5 * still.period
    turning = still.felt(x, 0.5 * still.width, 0.0, t).s_z
    around = still.felt(x + np.array([-0.01, 0.01]), 0.5 * still.width, 0.0, t).s_z
    assert turning < 0.0
    assert np.all(np.abs(around) < np.abs(turning))
    assert turning == pytest.approx(-0.5 * still.circulation / (np.pi * still.core**2), rel=0.01)
    assert still.motion(x, 0.0, 0.0, t).u < 0.0


def test_a_wake_in_a_current_is_the_same_wake_carried_along():
    still = replace(WAKE, mean=(0.0, 0.0, 0.0))
    x, y, t = 0.2, -0.3, 3.3
    carried = WAKE.motion(x + 0.02 * t, y - 0.05 * t, 0.0, t)
    assert carried[:3] == pytest.approx(
        np.add(still.motion(x, y, 0.0, t)[:3], WAKE.mean), abs=1e-12
    )


def test_the_circulation_is_that_with_which_the_street_carries_a_momentum():
    flux = flux_of_street(0.25, 1.0, 0.16, 0.03)
    assert find_circulation(flux, 0.25, 1.0, 0.16) == pytest.approx(0.03, rel=1e-9)
    assert find_circulation(1e-9, 0.25, 1.0, 0.16) == pytest.approx(1e-9 / 0.16, rel=1e-3)


def test_a_momentum_that_no_street_of_the_width_carries_is_refused():
    with pytest.raises(
        ValueError, match=r"`thrust` must be less: no street 0.02 m wide carries that much momentum"
    ):
        find_circulation(1.0, 0.25, 1.0, 0.02)


def test_cores_that_reach_into_the_next_vortex_are_refused():
    with pytest.raises(
        ValueError, match=r"`core` must be <= 0.1\d* m, half the way to the next vortex, got 0.2"
    ):
        replace(WAKE, core=0.2)
