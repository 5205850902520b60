"""What a thread of a GPU takes, which must not rise; no GPU is needed to find it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SOURCES = Path(__file__).parents[1] / "src"
MOST_REGISTERS = 255
MOST_STACK = 136
"""What a kernel for all kinds of joints took when this was first looked at [B].

Today's takes 88, by ptxas 13.5; statements in another order change this by some tens.
"""


def test_a_thread_with_prescribed_joints_takes_no_more_of_a_gpu_than_it_did():
    pytest.importorskip("numba_cuda", reason="numba-cuda is not installed")
    path = os.pathsep.join([str(SOURCES), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, "-m", "laticauda_cuda.registers", "prescribed"],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    if "There is no `ptxas`" in done.stderr:
        pytest.skip("ptxas is not installed: pip install './plugins/laticauda-cuda[ptx]'")
    assert done.returncode == 0, done.stderr
    name, registers, stack = done.stdout.splitlines()[1].split()
    assert name == "prescribed"
    assert int(registers) <= MOST_REGISTERS
    assert int(stack) <= MOST_STACK
