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
    cases = [currents.Case(run.water, run.law, run.seed) for run in currents.stored()]
    for water in currents.WATERS:
        assert sum(case.water == water for case in cases) == 5 * currents.SEEDS
    assert len(set(cases)) == len(cases) == 660
    assert set(cases) == set(currents.cases())


@pytest.mark.parametrize("law", ["LOS", currents.OBSERVED])
def test_a_run_in_a_uniform_current_is_that_of_the_stored_answer(law):
    (stored_run,) = [
        run for run in currents.stored() if (run.water, run.law, run.seed) == ("uniform", law, 3)
    ]
    again = asdict(currents.run("uniform", law, 3))
    for name, value in asdict(stored_run).items():
        if isinstance(value, float):
            np.testing.assert_allclose(again[name], value, rtol=1e-2, atol=1e-4, err_msg=name)
