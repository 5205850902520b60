"""A slice of campaigns/bit_flips.py, and what its stored answer says."""

import pytest
from campaign_scripts import campaign

bit_flips = campaign("bit_flips")


def test_no_wrong_bit_passed_unnoticed():
    rows = bit_flips.stored(bit_flips.ANSWERS, bit_flips.Row)
    assert {row.fault for row in rows} >= {"sweep", "trial", "trial, mcap", "recording"}
    for row in rows:
        assert row.named + row.unchanged == row.flips
        assert (row.silent, row.unnamed, row.otherwise) == (0, 0, 0)


@pytest.mark.parametrize("fault", ["sweep", "trial", "recording", "optimize"])
def test_a_wrong_bit_is_named_or_changes_nothing(
    fault: str, tmp_path, monkeypatch: pytest.MonkeyPatch
):
    small = {"sweep": lambda scratch: bit_flips.store_sweep(scratch, (2, 3, 2))}
    monkeypatch.setitem(bit_flips.STORES, fault, small.get(fault, bit_flips.STORES[fault]))
    monkeypatch.setattr(bit_flips.tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(bit_flips, "RESUMED_EVERY", 5)
    bit_flips.subject_of.cache_clear()
    row = bit_flips.flip_many(fault, seed=0, flips=10)
    assert row.named + row.unchanged == 10
    assert row.resumed == (2 if fault == "sweep" else 0)
    assert row.otherwise == 0
