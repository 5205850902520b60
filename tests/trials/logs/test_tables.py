"""Tables of somebody's log: what counts as a number."""

import numpy as np
import pytest

from laticauda.values import tables


def test_what_is_infinite_was_not_measured_and_what_is_absurd_is_refused():
    table = tables.Table(
        columns={"a": np.array([1.0, np.inf, -np.inf]), "b": np.array([1.0, 1e300])}
    )
    np.testing.assert_array_equal(table["a"], [1.0, np.nan, np.nan])
    with pytest.raises(ValueError, match=r"Column `b` must hold numbers up to 1e\+30, got 1e\+300"):
        table["b"]
