"""A slice of the golden set: what was recorded before the house was rebuilt is still what runs give."""

import campaign_scripts
import numpy as np
import pytest

golden = campaign_scripts.campaign("golden")
RUNS = ("mamba", "fin trailing edge servo", "driven elastic fin pd", "follow line", "batch")


@pytest.mark.parametrize("name", RUNS)
def test_a_run_logs_what_it_logged_before_the_rebuild(name):
    stored = np.load(golden.STORE)
    run = golden.scenarios()[name]()
    for key, values in golden.series(run):
        # Another processor rounds differently in the last digits; bit for bit is what the campaign
        # looks at.
        assert golden.distance(stored[f"{name}: {key}"], values) < 1e-9, key


def test_the_golden_set_holds_thirty_runs():
    assert (
        len({key.split(": ")[0] for key in np.load(golden.STORE).files})
        == len(golden.scenarios())
        == 30
    )
