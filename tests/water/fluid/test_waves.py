"""Waves: what theory says of the motion below a surface that is a cosine, and of the sums that are seas."""

import math
from dataclasses import replace

import numpy as np
import pytest
from flow_laws import check_derivatives, check_incompressible
from hypothesis import given, strategies as st

import laticauda as lc
from laticauda.robot import Current, load_robot, load_water
from laticauda.values.codec import decode, encode
from laticauda.water.fluid.flow import rows_of
from laticauda.water.fluid.waves import BAND, GRAVITY, STEEPEST, Sea, Waves

PLACE = st.floats(-3.0, 3.0)
DEPTH = st.floats(0.05, 20.0) | st.just(math.inf)
GAIT = lc.Gait(amplitude=0.5, frequency=2.2, phase_shift=0.7)


def waves(period, depth, share, **rest):
    """Regular waves with a share of the height at which they break."""
    low = Waves(height=1e-9, period=period, depth=depth)
    k = low.parts[0].k
    return Waves(
        height=share * STEEPEST * 2.0 * math.pi / k * math.tanh(k * depth),
        period=period,
        depth=depth,
        **rest,
    )


SOME = st.builds(
    waves,
    period=st.floats(0.3, 8.0),
    depth=DEPTH,
    share=st.floats(0.01, 1.0),
    direction=PLACE,
    phase=PLACE,
)


@given(waves=SOME, x=PLACE, y=PLACE, down=st.floats(0.01, 0.99), t=st.floats(0.0, 20.0))
def test_water_below_waves_is_not_made_nor_lost_nor_turned_and_derivatives_are_those_of_the_velocity(
    waves, x, y, down, t
):
    z = -down * min(waves.depth, 3.0)
    check_incompressible(waves, x, y, z, t)
    check_derivatives(waves, x, y, z, t)
    felt, size = waves.felt(x, y, z, t), waves.height * waves.omega * waves.parts[0].k
    assert (felt.s_x, felt.s_y, felt.s_z) == pytest.approx(
        (0.0, 0.0, 0.0), abs=1e-13 * (1.0 + size)
    )


@given(waves=SOME, x=PLACE, y=PLACE, t=st.floats(0.0, 20.0))
def test_the_surface_moves_with_the_water_in_it_bears_no_pressure_and_the_bed_lets_none_through(
    waves, x, y, t
):
    step = 1e-4 / waves.omega
    before, after = (waves.motion(x, y, 0.0, t + one).elevation for one in (-step, step))
    rate = (after - before) / (2.0 * step)
    assert waves.motion(x, y, 0.0, t).w == pytest.approx(
        rate, abs=1e-6 * waves.height * waves.omega
    )
    # Bernoulli along the surface, linear: rho u_t = -p_x, and p = rho g elevation at the mean
    # level.
    k, found = waves.parts[0], waves.motion(x, y, 0.0, t)
    across = (
        waves.motion(x + 1e-4 / k.k, y, 0.0, t).elevation
        - waves.motion(x - 1e-4 / k.k, y, 0.0, t).elevation
    )
    slope = 0.5e4 * k.k * across
    assert found.u_t == pytest.approx(-GRAVITY * slope, abs=1e-6 * GRAVITY * k.k * waves.height)
    if waves.depth < math.inf:
        below = waves.motion(x, y, -waves.depth, t)
        assert below.w == pytest.approx(
            0.0, abs=1e-13 * waves.height * waves.omega / math.tanh(k.bed)
        )
        assert waves.motion(x, y, -2.0 * waves.depth, t)[:15] == below[:15]


@given(waves=SOME, x=PLACE, y=PLACE, z=st.floats(0.0, 2.0), t=st.floats(0.0, 20.0))
def test_in_crests_all_is_as_at_the_mean_level(waves, x, y, z, t):
    assert waves.motion(x, y, z, t) == waves.motion(x, y, 0.0, t)


@given(period=st.floats(0.1, 60.0), depth=DEPTH)
def test_length_period_and_depth_obey_the_dispersion_relation_both_ways(period, depth):
    one = Waves(height=1e-9, period=period, depth=depth)
    k = one.parts[0].k
    assert one.omega**2 == pytest.approx(GRAVITY * k * math.tanh(k * depth), rel=1e-12)
    other = Waves(height=1e-9, length=2.0 * math.pi / k, depth=depth)
    assert other.omega == pytest.approx(one.omega, rel=1e-12)
    assert replace(one, length=2.0 * math.pi / k) == replace(other, period=period)
    assert k >= one.omega**2 / GRAVITY * (1.0 - 1e-12)  # none is longer than in deep water


@given(period=st.floats(0.5, 4.0), depth=DEPTH, down=st.floats(0.1, 0.9), direction=PLACE)
def test_small_waves_carry_the_water_around_ellipses_of_the_known_half_axes(
    period, depth, down, direction
):
    waves = Waves(height=1e-6, period=period, depth=depth, direction=direction)
    k, z, n = waves.parts[0].k, -down * min(depth, 3.0), 400
    t = np.arange(n) * period / n
    u, v, w = np.array([waves.motion(0.0, 0.0, z, one)[:3] for one in t]).T
    along = u * math.cos(direction) + v * math.sin(direction)
    across, high = (
        np.abs(np.exp(2j * np.pi * t / period) @ one) * 2.0 / n / waves.omega for one in (along, w)
    )
    if k * depth > 300.0:
        expected = math.exp(k * z), math.exp(k * z)
    else:
        expected = (
            math.cosh(k * (z + depth)) / math.sinh(k * depth),
            math.sinh(k * (z + depth)) / math.sinh(k * depth),
        )
    assert (across, high) == pytest.approx((0.5e-6 * expected[0], 0.5e-6 * expected[1]), rel=1e-9)


@pytest.mark.parametrize("spectrum", ["jonswap", "pierson-moskowitz"])
def test_a_sea_has_its_significant_height_and_over_seeds_its_spectrum(spectrum):
    seas = [
        Sea(significant_height=0.2, peak_period=2.0, spectrum=spectrum, seed=k) for k in range(300)
    ]
    parts = [part for sea in seas for part in sea.parts]
    variance = sum(0.5 * part.amplitude**2 for part in parts) / len(seas)
    assert 4.0 * math.sqrt(variance) == pytest.approx(0.2, rel=1e-12)
    edges = np.linspace(*BAND, 51) * math.pi
    found, _ = np.histogram([part.omega for part in parts], edges)
    middle = 0.5 * (edges[1:] + edges[:-1])
    gamma = 3.3 if spectrum == "jonswap" else 1.0
    peak = np.exp(
        -((middle / math.pi - 1.0) ** 2) / (2.0 * np.where(middle > math.pi, 0.09, 0.07) ** 2)
    )
    density = middle**-5.0 * np.exp(-1.25 * (math.pi / middle) ** 4) * gamma**peak
    density *= len(parts) / density.sum()
    assert np.abs(found - density).max() < 0.05 * density.max()
    assert middle[found.argmax()] == pytest.approx(math.pi, rel=0.08)


def test_the_surface_of_a_sea_varies_as_its_significant_height_says_and_is_that_of_its_seed():
    sea = Sea(significant_height=0.2, peak_period=2.0, seed=5, spread=0.4)
    t = np.linspace(0.0, 2000.0, 20001)
    assert 4.0 * np.std(sea.motion(0.0, 0.0, 0.0, t).elevation) == pytest.approx(0.2, rel=0.03)
    assert sea.parts == Sea(significant_height=0.2, peak_period=2.0, seed=5, spread=0.4).parts
    assert sea.parts != replace(sea, seed=6).parts


@pytest.mark.parametrize("spread", [0.1, 0.5, 1.2])
def test_the_directions_of_a_sea_have_their_standard_deviation(spread):
    sea = Sea(components=1000, spread=spread, direction=0.7)
    turned = [(part.k_x + 1j * part.k_y) / part.k * np.exp(-0.7j) for part in sea.parts]
    # Circular: sqrt(2 (1 - R)) with R the mean of the cosine.
    assert math.sqrt(2.0 * (1.0 - np.mean(turned).real)) == pytest.approx(spread, rel=0.1)
    assert abs(np.mean(turned).imag) < 0.1


def test_runs_in_seas_side_by_side_are_those_of_each_alone_and_a_sea_goes_through_files():
    water = replace(load_water("paper-lateral"), depth=0.3)
    seas = [
        Sea(significant_height=0.05, peak_period=1.5, spread=0.3, components=4, seed=k)
        for k in range(3)
    ]
    scenarios = [
        lc.build_scenario(load_robot("mamba"), GAIT, 2.0, environment=replace(water, current=one))
        for one in seas
    ]
    together = lc.swim_many(scenarios).center_of_mass
    for scenario, end in zip(scenarios, together, strict=True):
        assert lc.swim(scenario).center_of_mass[-1] == pytest.approx(end, abs=1e-13)
    assert decode(lc.Water, encode(scenarios[1].environment)) == scenarios[1].environment
    assert decode(Current, {"kind": "waves", "height": 0.1, "length": 3.0}) == Waves(
        height=0.1, length=3.0
    )
    # In the plane, depth factors are numbers of their own.
    level, found = rows_of(seas[0], -0.3), seas[0].motion(0.4, 0.5, -0.3, 0.7)
    parts = [part.at_height(-0.3).motion(0.4, 0.5, 9.0, 0.7) for part in seas[0].parts]
    assert np.sum(parts, axis=0) == pytest.approx(np.array(found), abs=1e-15)
    assert level.counts == (4,)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            {"period": 1.0, "length": 3.0},
            r"`length` must be 1.561 m, as follows from the period, got 3",
        ),
        ({"period": 2.0, "depth": 0.2, "length": 6.2}, r"`length` must be 2.7\d* m"),
        ({"height": 2.0}, r"`height` must be <= 0.8868 m, where waves 6.245 m long break, got 2"),
        (
            {"depth": 0.05},
            r"`height` must be <= 0.0438\d m, where waves 1.389 m long break, got 0.1",
        ),
        ({"depth": -1.0}, r"`depth` must be > 0 m"),
        ({"period": 0.0}, r"`period` must be > 0 s"),
    ],
)
def test_waves_that_cannot_be_are_refused_with_the_limit(settings, message):
    with pytest.raises(ValueError, match=message):
        Waves(**settings)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"significant_height": 2.0}, r"`significant_height` must be <= 0.8868 m"),
        ({"depth": 0.0}, r"`depth` must be > 0 m"),
        ({"components": 0}, r"`components` must be a whole number >= 1"),
        ({"spectrum": "square"}, r"`spectrum` must be"),
    ],
)
def test_a_sea_that_cannot_be_is_refused_with_the_limit(settings, message):
    with pytest.raises(ValueError, match=message):
        Sea(**settings)


@pytest.mark.parametrize(
    ("period", "highest"), [(1.0, 0.1041), (2.0, 0.4163), (8.0, 6.66), (11.5, 11.01), (16.0, 15.98)]
)
def test_a_sea_steeper_than_those_of_nature_is_warned_of(period, highest):
    Sea(significant_height=0.99 * highest, peak_period=period)
    with pytest.warns(UserWarning, match="is more than seas with a peak period of .* s reach"):
        Sea(significant_height=1.01 * highest, peak_period=period)


def test_a_robot_below_the_bed_of_its_waves_is_refused():
    water, waves = load_water("paper-lateral"), Waves(height=0.05, period=1.5, depth=0.9)
    assert replace(water, current=waves, depth=0.9).depth == 0.9
    for current in (waves, Waves() + waves):
        with pytest.raises(
            ValueError, match=r"`depth` must be <= 0.9 m, the bed depth of its flow, got 1.5"
        ):
            replace(water, current=current, depth=1.5)
