"""A slice of campaigns/kills.py, and what its stored answer says; sweeps and optimizations have slices of their own."""

import pytest
from campaign_scripts import campaign

kills = campaign("kills")


def test_a_hundred_kills_lost_nothing():
    found = kills.ANSWERS.read()
    assert {name: row["result"] for name, row in found.items()} == kills.SAME
    assert {name: int(row["kills"]) for name, row in found.items()} == kills.KILLS
    assert sum(kills.KILLS.values()) >= 100


def test_the_recording_of_an_operation_that_is_killed_is_the_beginning_of_a_whole_one(
    tmp_path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setitem(kills.JOBS, "operate", kills.Job(words="recorded 1.0"))
    (tmp_path / "inputs").mkdir()
    assert kills.killed("operate", 1, tmp_path) == (1, 0, "")
