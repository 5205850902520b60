import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from laticauda.robot import CaudalFin, Joint, PectoralFin, Tether, Thruster, load_robot
from laticauda.robot.effectors import hinge_rule

RHO = 1000.0


@pytest.mark.parametrize(
    ("opening", "mass", "inertia"), [("open", 2.42, 0.610), ("closed", 3.18, 0.654)]
)
def test_mambas_fin_has_the_known_added_mass_and_inertia_about_the_tail_joint(
    opening, mass, inertia
):
    fin = CaudalFin(opening=opening)
    per_length = RHO * math.pi * (0.5 * fin.height) ** 2  # C_A = 1
    assert per_length == pytest.approx(6.36, abs=0.005)
    length = (
        load_robot("mamba-fin").modules[0].length
    )  # the tail joint is that far ahead of the root
    near = fin.opening_length if fin.opening == "open" else 0.0
    assert per_length * (fin.length - near) == pytest.approx(mass, abs=0.005)
    assert per_length * ((length + fin.length) ** 3 - (length + near) ** 3) / 3.0 == pytest.approx(
        inertia, abs=6e-4
    )


def test_the_preset_carries_the_default_fin_with_the_plates_added_mass():
    assert load_robot("mamba-fin").caudal_fin == CaudalFin(added_mass=1.0)


def test_the_fin_floats_in_fresh_water_by_default():
    fin = CaudalFin()
    assert fin.mass == pytest.approx(RHO * 0.5 * 0.09 * 0.005)
    assert fin.mass == pytest.approx(RHO * fin.volume)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"length": 0.1}, r"`opening_length` must be < 0\.1 m, the `length`, got 0\.12\."),
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


counts = st.integers(1, 6)


@given(counts)
def test_hinges_stand_inside_the_plate_in_order_and_for_no_more_than_its_length(n):
    place, share = np.array(hinge_rule(n)).T
    assert np.all(np.diff([0.0, *place, 1.0]) > 0.0)
    assert np.all(share > 0.0) and share.sum() < 1.0


@given(counts, st.integers(0, 11))
def test_the_energy_of_a_moment_that_vanishes_at_a_free_end_is_exact(n, degree):
    # The integral of (1 - s)^4 (1 - s)^degree is 1 / (degree + 5).
    place, share = np.array(hinge_rule(n)).T
    found = share @ (1.0 - place) ** (4 + degree)
    assert (found == pytest.approx(1.0 / (degree + 5), rel=1e-12)) == (degree <= 2 * n - 1)


@given(counts, st.floats(1e-3, 1e3), st.floats(0.0, 1.0), st.floats(0.2, 2.0))
def test_stiffness_and_damping_are_those_of_the_length_that_a_hinge_stands_for(
    n, rigidity, damping, length
):
    fin = CaudalFin(length=length, n_hinges=n, flexural_rigidity=rigidity, bending_damping=damping)
    for hinge in fin.hinges:
        assert hinge.stiffness * hinge.length == pytest.approx(rigidity)
        assert hinge.damping * hinge.length == pytest.approx(damping)


@given(st.integers(0, 6))
def test_the_pieces_are_the_plate(n):
    fin = CaudalFin(n_hinges=n, flexural_rigidity=1.0)
    assert len(fin.pieces) == n + 1 and len(fin.hinges) == n
    assert sum(piece.mass for piece in fin.pieces) == pytest.approx(fin.mass)
    assert sum(piece.length for piece in fin.pieces) == pytest.approx(fin.length)
    assert [piece.begin for piece in fin.pieces[1:]] == [hinge.position for hinge in fin.hinges]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"n_hinges": 1},
            r"`flexural_rigidity` must be given in N m\^2 for a fin with `n_hinges` > 0, got None\.",
        ),
        ({"n_hinges": 7, "flexural_rigidity": 1.0}, r"`n_hinges` must be between 0 and 6, got 7\."),
        ({"n_hinges": -1}, r"`n_hinges` must be a whole number >= 0, got -1"),
        ({"flexural_rigidity": 0.0}, r"`flexural_rigidity` must be > 0 N m\^2, got 0"),
        ({"bending_damping": -1.0}, r"`bending_damping` must be >= 0 N m\^2 s, got -1"),
        ({"joint": "yaw"}, r"`joint` must be of class Joint, got str"),
        (
            {"joint": Joint(axis="pitch")},
            r"`joint.axis` must be `yaw`: the fin is upright, got `pitch`\.",
        ),
    ],
)
def test_a_fin_that_cannot_be_is_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        CaudalFin(**changes)
