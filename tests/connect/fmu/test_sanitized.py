"""A slice of campaigns/fmu_sanitized.py: the C code of an FMU under the address and undefined-behaviour sanitizers."""

import pytest
from campaign_scripts import campaign

sanitized = campaign("fmu_sanitized")


@pytest.mark.skipif(not sanitized.is_possible(), reason="needs gcc on Linux")
@pytest.mark.parametrize("version", sanitized.VERSIONS)
def test_calls_in_any_order_touch_no_memory_but_their_own(version: str, tmp_path):
    told = sanitized.called(version, 1000, 7, tmp_path)
    assert told.startswith("1000 calls, ")
    assert told.endswith(" 0 unknown answers")
