"""A slice of campaigns/interruptions.py, and what its stored answer says."""

import shutil
import sys

import pytest
from campaign_scripts import campaign

interruptions = campaign("interruptions")


def test_ctrl_c_ended_every_command_as_it_should():
    found = interruptions.ANSWERS.read()
    assert list(found) == list(interruptions.JOBS)
    assert all(int(row["moments"]) >= 10 and row["faults"] == "0" for row in found.values())


@pytest.mark.skipif(
    sys.platform != "linux" or shutil.which("setsid") is None, reason="needs a terminal of its own"
)
def test_ctrl_c_in_a_terminal_ends_a_command_with_one_line_and_leaves_older_files_whole(tmp_path):
    assert interruptions.stop_at_moments("export mjcf", tmp_path, 2).faults == []
