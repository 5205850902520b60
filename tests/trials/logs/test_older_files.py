"""Files of the first layout are refused by name, with what to do."""

from pathlib import Path

import pytest

from laticauda.trials.logs import load_trial

OLDER = Path(__file__).parents[2] / "data" / "trials-0.1.0"
LIBRARIES = {"nc": "netCDF4", "mcap": "mcap", "parquet": "pyarrow", "mat": "scipy"}


@pytest.mark.parametrize("ending", LIBRARIES)
def test_a_trial_of_the_first_layout_is_refused_in_every_format(ending):
    pytest.importorskip(LIBRARIES[ending])
    rule = (
        "it has format 1, but this version of laticauda reads format 2: "
        r"read it with the one that wrote it, 0\.1\.0 of 2026-01-02\.$"
    )
    with pytest.raises(ValueError, match=rule):
        load_trial(OLDER / f"trial.{ending}")
