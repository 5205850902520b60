import math

import pytest

from laticauda.robot import CaudalFin, PectoralFin, Tether, Thruster, load_robot

RHO = 1000.0


@pytest.mark.parametrize(("opening", "mass", "inertia"), [("open", 2.42, 0.610), ("closed", 3.18, 0.654)])
def test_mambas_fin_has_the_known_added_mass_and_inertia_about_the_tail_joint(opening, mass, inertia):
    fin = CaudalFin(opening=opening)
    per_length = RHO * math.pi * (0.5 * fin.height) ** 2  # C_A = 1
    assert per_length == pytest.approx(6.36, abs=0.005)
    length = load_robot("mamba-fin").modules[0].length  # the tail joint is that far ahead of the root
    near = fin.opening_length if fin.opening == "open" else 0.0
    assert per_length * (fin.length - near) == pytest.approx(mass, abs=0.005)
    assert per_length * ((length + fin.length) ** 3 - (length + near) ** 3) / 3.0 == pytest.approx(inertia, abs=6e-4)


def test_the_preset_carries_the_default_fin_with_the_plates_added_mass():
    assert load_robot("mamba-fin").caudal_fin == CaudalFin(added_mass=1.0)


def test_the_fin_floats_in_fresh_water_by_default():
    fin = CaudalFin()
    assert fin.mass == pytest.approx(RHO * 0.5 * 0.09 * 0.005)
    assert fin.mass == pytest.approx(RHO * fin.volume)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"length": 0.1}, r"`opening_length` must be < 0\.1 m, the fin's `length`, got 0\.12\."),
        ({"opening_length": 0.5}, r"`opening_length` must be < 0\.5 m"),
        ({"opening_length": -0.1}, r"`opening_length` must be >= 0 m"),
        ({"opening": "ajar"}, r"`opening` must be one of `open`, `closed`, got 'ajar'"),
        ({"n_strips": 0}, r"`n_strips` must be a whole number >= 1, got 0"),
        ({"n_strips": 8.0}, r"`n_strips` must be a whole number >= 1, got 8\.0"),
        ({"height": math.nan}, r"`height` must be a finite number in m"),
        ({"added_mass": -1.0}, r"`added_mass` must be >= 0, got"),
    ],
)
def test_a_caudal_fin_refuses(changes, message):
    with pytest.raises(ValueError, match=message):
        CaudalFin(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"link": -1}, r"`link` must be a whole number >= 0, got -1"),
        ({"link": "head"}, r"`link` must be a whole number >= 0, got 'head'"),
        ({"thrust": math.inf}, r"`thrust` must be a finite number in N"),
        ({"angle": "90"}, r"`angle` must be a number in rad"),
    ],
)
def test_a_thruster_refuses(changes, message):
    with pytest.raises(ValueError, match=message):
        Thruster(**{"link": 0, "thrust": 1.0, **changes})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"area": 0.0}, r"`area` must be > 0 m\^2"),
        ({"stall_angle": 2.0}, r"`stall_angle` must be between 0 and 1\.5708 rad"),
        ({"lift_slope": -1.0}, r"`lift_slope` must be >= 0 1/rad"),
        ({"parasitic_drag": -1.0}, r"`parasitic_drag` must be >= 0"),
        ({"stall_sharpness": 0.0}, r"`stall_sharpness` must be > 0"),
    ],
)
def test_a_pectoral_fin_refuses(changes, message):
    with pytest.raises(ValueError, match=message):
        PectoralFin(**{"link": 0, "area": 0.01, "lift_slope": 3.0, "stall_angle": 0.4, **changes})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"drag": -0.1}, r"`drag` must be >= 0 kg/m"),
        ({"force": (1.0,)}, r"`force` must be two numbers in N, got 1 of them"),
        ({"force": 1.0}, r"`force` must be two numbers in N, got 1\.0"),
        ({"force": "12"}, r"`force` must be two numbers"),
        ({"force": (0.0, math.nan)}, r"`force\[1\]` must be a finite number in N"),
    ],
)
def test_a_tether_refuses(changes, message):
    with pytest.raises(ValueError, match=message):
        Tether(**changes)


def test_a_list_becomes_a_tuple_of_floats():
    assert Tether(force=[1, 2]) == Tether(force=(1.0, 2.0))
