"""A slice of campaigns/failing_disk.py, and what its stored answer says."""

import subprocess
import sys

import pytest
from campaign_scripts import FOLDER, campaign

failing_disk = campaign("failing_disk")


def test_nothing_that_a_failing_disk_left_was_taken_for_whole():
    rows = failing_disk.ANSWERS.read()
    assert list(rows) == list(failing_disk.COMMANDS)
    assert {row["result"] for row in rows.values()} == {failing_disk.GOOD}
    assert all(int(row["failed"]) > 0 for row in rows.values())


SLICE = """
import os, sys, tempfile
from pathlib import Path
sys.path.insert(0, {folder!r})
import failing_disk
from _jobs import Job

failing_disk.load_shim(Path(tempfile.mkdtemp()))
folder = Path({scratch!r})
failing_disk.WRITERS["export mjcf"] = Job(
    words="export mjcf --output out/robot.xml", files=("robot.xml",)
)
print(failing_disk.answer("export mjcf", folder, moments=1))
"""


@pytest.mark.skipif(failing_disk.find_compiler() is None, reason="needs Linux and a C compiler")
def test_an_older_file_stays_on_a_disk_that_fails(tmp_path):
    script = tmp_path / "slice.py"
    script.write_text(SLICE.format(folder=str(FOLDER), scratch=str(tmp_path / "work")))
    (tmp_path / "work").mkdir()
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True)
    assert "'kept')" in done.stdout, done.stderr
