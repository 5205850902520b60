import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from laticauda.robot import CaudalFin, Joint
from laticauda.robot.bending import hinge_rule

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
def test_stiffness_and_damping_are_those_of_the_length_that_a_hinge_stands_for(n, rigidity, damping, length):
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
        ({"n_hinges": 1}, r"`flexural_rigidity` must be given in N m\^2 for a fin with `n_hinges` > 0, got None\."),
        ({"n_hinges": 7, "flexural_rigidity": 1.0}, r"`n_hinges` must be between 0 and 6, got 7\."),
        ({"n_hinges": -1}, r"`n_hinges` must be a whole number >= 0, got -1"),
        ({"flexural_rigidity": 0.0}, r"`flexural_rigidity` must be > 0 N m\^2, got 0"),
        ({"bending_damping": -1.0}, r"`bending_damping` must be >= 0 N m\^2 s, got -1"),
        ({"joint": "yaw"}, r"`joint` must be of class Joint, got str"),
        ({"joint": Joint(axis="pitch")}, r"`joint.axis` must be `yaw`: the fin is upright, got `pitch`\."),
    ],
)
def test_a_fin_that_cannot_be_is_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        CaudalFin(**changes)
