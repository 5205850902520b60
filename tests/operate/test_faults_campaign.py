"""A slice of campaigns/operate_faults.py: whatever goes wrong, the robot comes to a safe stop and the log is whole."""

from pathlib import Path

import campaign_scripts
import pytest


@pytest.fixture(scope="module")
def faults():
    return campaign_scripts.campaign("operate_faults")


@pytest.mark.parametrize("seed", [3, 11, 19])
def test_an_operation_with_random_faults_ends_safely_and_its_log_is_complete(faults, seed: int, tmp_path: Path):
    outcome = faults.run_one(seed, tmp_path, rate=25.0, duration=3.0)
    assert not outcome.wrong
    assert outcome.state in ("idle", "fault")
