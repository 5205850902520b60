import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from identify.trials import speeds

from laticauda.identify.identifiability import deviations, identifiability
from laticauda.identify.problem import make_problem

NAMES = ["water.tangential_friction", "water.normal_drag", "water.added_mass"]
UNKNOWNS = make_problem(speeds(2), NAMES).unknowns


def seen(jacobian):
    rows = np.array(jacobian, dtype=float)
    return identifiability(rows.T @ rows, UNKNOWNS)


@given(st.lists(st.lists(st.floats(-5, 5), min_size=3, max_size=3), min_size=4, max_size=8))
def test_deviations_are_those_of_the_inverse(rows):
    information = np.array(rows).T @ np.array(rows) + np.eye(3)
    expected = np.sqrt(np.diag(np.linalg.inv(information)))
    np.testing.assert_allclose(deviations(*np.linalg.eigh(information)), expected, rtol=1e-6)


def test_a_ratio_that_is_seen_leaves_the_scale_unseen():
    found = seen([[9, -9, 0], [0, 9, -9]])
    assert [direction.is_seen for direction in found.directions] == [True, True, False]
    assert np.all(np.isinf(found.sigma))
    worst = found.directions[-1]
    assert worst.sigma == np.inf
    np.testing.assert_allclose(worst.weights, np.full(3, 3**-0.5))
    assert worst.name.startswith("the common scale of `water.")
    assert found.words == (f"The data do not see {worst.name}.",)


def test_a_product_is_named_by_its_powers():
    assert seen([[9, 9, 0], [0, 0, 9]]).unseen[0].name in (
        "the ratio `water.tangential_friction` / `water.normal_drag`",
        "the ratio `water.normal_drag` / `water.tangential_friction`",
    )


def test_one_number_that_is_not_seen_leaves_the_others_alone():
    found = seen([[4, 0, 0], [0, 5, 0]])
    assert found.without_effect == ("water.added_mass",)
    assert found.sigma == pytest.approx([0.25, 0.2, np.inf])
    assert found.unseen[0].name == "`water.added_mass`"
