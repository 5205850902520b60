"""The trailing edge of a plate of finite span: its functions, its limits, and that it never gives energy."""

import numpy as np
import pytest
from derivatives import check_complex_steps
from scipy.special import hankel2

from laticauda.water.fluid.edges import (
    TABLE,
    Plate,
    PlateFunctions,
    broad_plate,
    build_plate,
    finite_span,
    plate_functions,
    slender_plate,
)

PRINTED = {  # of the note that the law comes from: h/c, and k, k_s, k_r, x_ac/c of a rectangular plate
    0.08: (0.958, 1.000, 0.882, 0.021),
    0.24: (0.879, 0.997, 0.697, 0.059),
    0.5: (0.757, 0.985, 0.495, 0.110),
    1.0: (0.579, 0.929, 0.307, 0.167),
    2.0: (0.378, 0.787, 0.170, 0.209),
    3.0: (0.277, 0.667, 0.117, 0.225),
    4.0: (0.218, 0.575, 0.090, 0.232),
    5.56: (0.163, 0.470, 0.065, 0.238),
    8.0: (0.117, 0.365, 0.046, 0.242),
    16.0: (0.060, 0.210, 0.023, 0.246),
}
ASPECTS = np.geomspace(1e-3, 1e3, 600)


def plate_of(functions, *, mass_per_length=5.0, chord=0.3, height=0.2):
    return build_plate(functions, mass_per_length=mass_per_length, chord=chord, height=height)


@pytest.mark.parametrize("aspect", PRINTED)
def test_the_functions_are_those_that_were_printed(aspect):
    assert plate_functions(aspect) == pytest.approx(PRINTED[aspect], rel=0.015, abs=0.002)


def test_the_functions_meet_their_table():
    for aspect, functions in TABLE:
        assert plate_functions(aspect) == pytest.approx(functions, rel=1e-12)


def test_the_functions_are_smooth_and_monotone_and_keep_going_where_the_table_ends():
    values = np.array([plate_functions(aspect) for aspect in ASPECTS])
    falling = values[:, :3]
    assert np.all(np.diff(falling, axis=0) < 0.0)
    assert np.all(np.diff(values[:, 3]) > 0.0)
    relative = np.diff(np.log(values), axis=0)
    assert np.abs(np.diff(relative, axis=0)).max() < 3e-3


@pytest.mark.parametrize("aspect", [1e-9, 1e9])
def test_far_beyond_the_table_the_functions_are_their_limits(aspect):
    limit = slender_plate() if aspect < 1.0 else broad_plate(aspect)
    assert plate_functions(aspect) == pytest.approx(limit, rel=1e-7, abs=1e-8)


def test_a_slender_plate_has_the_wake_force_of_lighthill_at_its_edge():
    rng = np.random.default_rng(1)
    plate = plate_of(slender_plate())
    u, w, turning, memory = rng.normal(size=(4, 500))
    shed = np.where(u > 0.0, 5.0, 0.0)
    f_t, f_n, moment, _ = finite_span(u, w, turning, memory, *plate)
    np.testing.assert_allclose(f_t, 0.5 * shed * w * w, atol=1e-12, rtol=1e-12)
    np.testing.assert_allclose(f_n, -shed * u * w, atol=1e-12, rtol=1e-12)
    np.testing.assert_allclose(moment, 0.0, atol=1e-12)  # about the edge


def test_a_broad_plate_has_the_lift_of_theodorsen_and_the_suction_of_garrick():
    rho, c, h = 1000.0, 0.01, 1e4
    functions = broad_plate(h / c)
    plate = plate_of(functions, mass_per_length=rho * np.pi * h**2 / 4.0, chord=c, height=h)
    u, w, turning, memory = 0.7, 0.2, 3.0, -0.1
    y = plate.instant * w + (1.0 - plate.instant) * memory
    f_t, f_n, _, _ = finite_span(u, w, turning, memory, *plate)
    assert plate.instant == pytest.approx(0.5, rel=1e-5)
    assert f_n == pytest.approx(-2.0 * np.pi * rho * 0.5 * c * u * y * h, rel=1e-12)
    # The strips' own force along the plate is part of the suction: M w theta' at mid-chord.
    at_middle = w + 0.25 * c * turning
    suction = (f_t + plate.added_mass * at_middle * turning) / h
    garrick = 2.0 * np.pi * rho * 0.5 * c * (y + 0.25 * c * turning) ** 2
    assert suction == pytest.approx(garrick, rel=1e-4)


def test_an_edge_never_gives_energy_whatever_moves_it():
    rng = np.random.default_rng(2)
    n = 10_000
    aspect = np.exp(rng.uniform(np.log(0.02), np.log(50.0), n))
    chord = np.exp(rng.uniform(np.log(0.01), np.log(2.0), n))
    plates = np.array(
        [
            plate_of(plate_functions(a), chord=c, height=a * c)
            for a, c in zip(aspect, chord, strict=True)
        ]
    ).T
    u, w, turning, memory = rng.normal(size=(4, n)) * np.exp(rng.normal(size=(4, n)))
    f_t, f_n, moment, memory_rate = finite_span(u, w, turning, memory, *plates)
    lift_mass, _, _, _, instant, _, lag = plates
    stored = lift_mass * lag * instant * memory * memory_rate
    power = f_t * u + f_n * w + moment * turning
    size = np.abs(f_t * u) + np.abs(f_n * w) + np.abs(moment * turning) + np.abs(stored)
    assert np.all(power + stored <= 1e-12 * size)
    assert np.all(power[u <= 0.0] == 0.0)


def test_an_edge_of_any_added_mass_and_lever_such_as_behind_a_body_gives_no_energy_either():
    rng = np.random.default_rng(3)
    n = 10_000
    lift_share = rng.uniform(0.01, 1.0, n)
    plates = Plate(
        lift_mass=np.exp(rng.normal(size=n)),
        added_mass=np.exp(rng.normal(size=n)),
        lever=rng.normal(size=n),
        suction=1.0 - 0.5 * lift_share,
        instant=1.0 / (2.0 - lift_share),
        cap=np.where(rng.uniform(size=n) < 0.5, 1e9, rng.uniform(0.02, 1.0, n)),
        lag=np.exp(rng.normal(size=n)),
    )
    u, w, turning, memory = rng.normal(size=(4, n)) * np.exp(rng.normal(size=(4, n)))
    f_t, f_n, moment, memory_rate = finite_span(u, w, turning, memory, *plates)
    stored = plates.lift_mass * plates.lag * plates.instant * memory * memory_rate
    power = f_t * u + f_n * w + moment * turning
    size = np.abs(f_t * u) + np.abs(f_n * w) + np.abs(moment * turning) + np.abs(stored)
    assert np.all(power + stored <= 1e-12 * size)


def test_the_derivatives_of_the_edge_are_those_of_its_formula():
    plate = plate_of(PlateFunctions(0.6, 0.9, 0.3, 0.17))
    for ahead in (0.4, -0.4):
        check_complex_steps(finite_span, (ahead, 0.2, -1.5, 0.1, *plate))


def lag_error(lag_in_chords):
    """Return the largest error of a state relative to Theodorsen's function, for omega c/2u of .1 to 2."""
    k = np.linspace(0.1, 2.0, 200)
    theodorsen = hankel2(1, k) / (hankel2(1, k) + 1j * hankel2(0, k))
    state = 0.5 + 0.5 / (1.0 + 2j * k * lag_in_chords)
    return np.max(np.abs(state - theodorsen) / np.abs(theodorsen))


def test_the_lag_of_a_broad_plate_is_theodorsens_within_what_the_page_says():
    lags = [plate_of(plate_functions(a), chord=1.0, height=a).lag for a in (8.0, 16.0, 1000.0)]
    errors = [lag_error(lag) for lag in lags]
    assert errors == pytest.approx([0.139, 0.082, 0.083], abs=0.002)
