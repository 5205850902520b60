import os
import signal
import subprocess
import sys

import pytest

from laticauda.trials.logs import Recorder, open_recording
from laticauda.values.errors import StorageFailed

pytest.importorskip("mcap.reader", reason="the package mcap is not installed")

KILLED = """
import os, signal, sys
from laticauda.trials.logs import Recorder

recorder = Recorder(sys.argv[1], chunk_seconds=0.1)
for i in range(257):
    recorder.scalar("/x", 0.01 * i, float(i))
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_program_that_is_killed_loses_the_open_chunk_and_no_more(tmp_path):
    path = tmp_path / "run.mcap"
    done = subprocess.run([sys.executable, "-c", KILLED, str(path)], check=False)
    assert done.returncode == -signal.SIGKILL
    recording = open_recording(path)
    assert recording.lost.startswith("run.mcap is not intact: it is truncated")
    found = [one.content["data"] for one in recording.messages()]
    assert found == list(range(len(found)))
    assert 257 - 11 <= len(found) <= 257


def test_a_recording_never_replaces_another_unless_asked_to(tmp_path):
    path = tmp_path / "run.mcap"
    with Recorder(path) as recorder:
        recorder.scalar("/x", 0.0, 1.0)
    with pytest.raises(StorageFailed, match=r"Cannot write .*run.mcap: file exists"):
        Recorder(path)
    Recorder(path, overwrite=True).close()
    assert open_recording(path).topics == {}


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")
def test_a_full_disk_is_said(tmp_path):
    recorder = Recorder("/dev/full", overwrite=True)
    with pytest.raises(StorageFailed, match="no space left"):
        recorder.event(0.0, "leak")
    with pytest.raises(StorageFailed, match="no space left"):
        recorder.close()
