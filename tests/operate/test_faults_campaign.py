"""A slice of campaigns/operate_faults.py: whatever goes wrong, the robot comes to a safe stop and the log is whole."""

import importlib.util
import sys
from pathlib import Path

import pytest

FILE = Path(__file__).parents[2] / "campaigns" / "operate_faults.py"


@pytest.fixture(scope="module")
def faults():
    spec = importlib.util.spec_from_file_location("operate_faults", FILE)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["operate_faults"] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("seed", [3, 11, 19])
def test_an_operation_with_random_faults_ends_safely_and_its_log_is_complete(faults, seed: int, tmp_path: Path):
    outcome = faults.run_one(seed, tmp_path, rate=25.0, duration=3.0)
    assert not outcome.wrong
    assert outcome.state in ("idle", "fault")
