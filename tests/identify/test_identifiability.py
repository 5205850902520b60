import numpy as np
import pytest
from hypothesis import given, strategies as st
from identify.trials import speeds

from laticauda.identify.identifiability import (
    Spectrum,
    analyze_identifiability,
    compute_deviations,
)
from laticauda.identify.problem import make_problem

NAMES = ["water.tangential_friction", "water.normal_drag", "water.added_mass"]
UNKNOWNS = make_problem(speeds(2), NAMES).unknowns


def seen(jacobian):
    rows = np.array(jacobian, dtype=float)
    return analyze_identifiability(rows.T @ rows, UNKNOWNS)


@given(st.lists(st.lists(st.floats(-5, 5), min_size=3, max_size=3), min_size=4, max_size=8))
def test_deviations_are_those_of_the_inverse(rows):
    information = np.array(rows).T @ np.array(rows) + np.eye(3)
    expected = np.sqrt(np.diag(np.linalg.inv(information)))
    np.testing.assert_allclose(
        compute_deviations(Spectrum(*np.linalg.eigh(information))), expected, rtol=1e-6
    )


def test_a_ratio_that_is_seen_leaves_the_scale_unseen():
    found = seen([[9, -9, 0], [0, 9, -9]])
    assert [direction.is_seen for direction in found.directions] == [True, True, False]
    assert np.all(np.isinf(found.deviations))
    worst = found.directions[-1]
    assert worst.deviation == np.inf
    np.testing.assert_allclose(worst.weights, np.full(3, 3**-0.5))
    assert worst.name.startswith("the common scale of `water.")
    assert found.words == (f"The data do not see {worst.name}.",)


def test_what_hardly_takes_part_in_an_unseen_direction_moves_no_further_than_its_range_lets_it():
    turned = np.array([[1.0, 0.0, 1e-3], [0.0, 1.0, 0.0], [-1e-3, 0.0, 1.0]])
    turned /= np.linalg.norm(turned, axis=0)
    found = compute_deviations(
        Spectrum(np.array([4.0, 9.0, 0.0]), turned), np.array([5.0, 5.0, 5.0])
    )
    assert found == pytest.approx([0.5, 1.0 / 3.0, np.inf], rel=1e-4)
    assert np.all(np.isinf(compute_deviations(Spectrum(np.array([4.0, 9.0, 0.0]), turned))[[0, 2]]))
    within = seen([[9, 0, 0], [0, 9, 0], [0, 9e-3, 0]] @ turned.T)
    assert found.shape == within.deviations.shape and np.isfinite(within.deviations[0])


def test_a_product_is_named_by_its_powers():
    assert seen([[9, 9, 0], [0, 0, 9]]).unseen[0].name in (
        "the ratio `water.tangential_friction` / `water.normal_drag`",
        "the ratio `water.normal_drag` / `water.tangential_friction`",
    )


def test_one_number_that_is_not_seen_leaves_the_others_alone():
    found = seen([[4, 0, 0], [0, 5, 0]])
    assert found.without_effect == ("water.added_mass",)
    assert found.deviations == pytest.approx([0.25, 0.2, np.inf])
    assert found.unseen[0].name == "`water.added_mass`"
