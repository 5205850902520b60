"""A slice of campaigns/full_disk.py, and what its stored answer says."""

import pytest
from campaign_scripts import campaign

full_disk = campaign("full_disk")
CASE = "export mjcf"


def test_no_command_harmed_an_older_file():
    kept = full_disk.ANSWERS.read()
    assert list(kept) == list(full_disk.WRITERS)
    assert {row[fault] for row in kept.values() for fault in full_disk.FAULTS} == {"kept"}


@pytest.mark.parametrize("fault", ["full", "read-only", "file", "killed"])
def test_an_older_file_stays_on_a_bad_disk_and_when_its_writer_is_killed(fault: str, tmp_path):
    if fault != "killed" and not full_disk.can_mount():
        pytest.skip("needs root on Linux")
    assert full_disk.answer(CASE, fault, tmp_path, moments=1) == "kept"
