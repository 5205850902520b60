"""The stored answer of campaigns/currents.py: what the docs say of it, and one of its runs anew."""

from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
from campaign_scripts import campaign

currents = campaign("currents")
PAGE = Path(__file__).parent.parent / "docs/theory/moving-water.md"


def test_the_tables_of_the_page_are_those_of_the_stored_answer():
    page = PAGE.read_text(encoding="utf-8")
    for table in currents.tables(currents.stored()).split("\n\n"):
        assert table in page


def test_every_law_swam_every_water_from_every_seed():
    found = [(one.water, one.law, one.seed) for one in currents.stored()]
    for water in currents.WATERS:
        assert sum(case[0] == water for case in found) == 5 * currents.SEEDS
    assert len(set(found)) == len(found) == 660


@pytest.mark.parametrize("law", ["LOS", currents.OBSERVED])
def test_a_run_in_a_uniform_current_is_that_of_the_stored_answer(law):
    (kept,) = (
        one for one in currents.stored() if (one.water, one.law, one.seed) == ("uniform", law, 3)
    )
    again = asdict(currents.run("uniform", law, 3))
    for name, value in asdict(kept).items():
        if isinstance(value, float):
            np.testing.assert_allclose(again[name], value, rtol=1e-2, atol=1e-4, err_msg=name)
