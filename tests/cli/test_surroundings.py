"""A process that somebody has started oddly: one sentence and the right status, no traceback, no waiting."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from patience import LONG

PROGRAM = f"{sys.executable} -m laticauda"


def run_in_shell(line: str, **settings: str) -> subprocess.CompletedProcess[str]:
    """Run what a shell would, in which LATICAUDA stands for the program."""
    return subprocess.run(
        ["sh", "-c", line.replace("LATICAUDA", PROGRAM)],
        capture_output=True,
        text=True,
        timeout=LONG,
        env={**os.environ, **settings},
    )


pytestmark = pytest.mark.skipif(os.name != "posix", reason="no such shell")


@pytest.mark.parametrize("words", ["--version", "robots", "swim --duration 0.5"])
def test_a_closed_output_is_said(words):
    done = run_in_shell(f"LATICAUDA {words} >&-")
    assert done.returncode == 2
    assert done.stderr == (
        "laticauda: standard output is closed; if nobody is to see it, send it to /dev/null.\n"
    )


@pytest.mark.parametrize(
    ("line", "status"),
    [
        ("LATICAUDA robots 2>&-", 0),
        ("LATICAUDA robots <&-", 0),
        ("LATICAUDA robots --no-such-option 2>&-", 2),
        ("LATICAUDA robots --no-such-option 2>/dev/full", 2),
        ("LATICAUDA no-such-command 2>/dev/full", 2),
        ("LATICAUDA robots >&- 2>&-", 2),
        ("LATICAUDA robots <&- >&- 2>&-", 2),
        ("LATICAUDA robots >/dev/full", 2),
        ("LATICAUDA robots >/dev/full 2>/dev/full", 2),
    ],
)
def test_closed_and_full_streams_change_no_status(line, status):
    done = run_in_shell(line)
    assert done.returncode == status
    assert "Traceback" not in done.stderr


def test_what_is_said_on_a_closed_stream_gets_into_no_other():
    done = run_in_shell("LATICAUDA no-such-command 2>&-")
    assert (done.returncode, done.stdout) == (2, "")


@pytest.mark.parametrize("words", ["--help", "swim --help", "trial --help"])
def test_the_help_ends_in_a_terminal_of_one_column(words):
    done = run_in_shell(f"LATICAUDA {words}", COLUMNS="1")
    assert done.returncode == 0, done.stderr
    assert "usage" in done.stdout


def test_a_pipe_is_no_file_for_results(tmp_path: Path):
    os.mkfifo(tmp_path / "run.nc")
    done = run_in_shell(f"LATICAUDA swim --duration 0.5 --save {tmp_path}/run.nc")
    assert done.returncode == 2
    assert re.fullmatch(
        r"laticauda: --save must be a file, got the pipe \S+run\.nc\.\n", done.stderr
    )


@pytest.mark.skipif(sys.platform != "linux", reason="address space is limited otherwise")
def test_too_little_memory_is_said_before_a_library_waits_for_more_forever():
    done = run_in_shell("ulimit -v 400000; LATICAUDA swim --duration 0.5")
    assert done.returncode == 2
    assert done.stderr == (
        "laticauda: this process may use 390 MiB of memory; "
        "it needs 512 MiB: raise the limit (`ulimit -v`).\n"
    )


def test_a_compiler_that_is_switched_off_is_said():
    done = run_in_shell("LATICAUDA swim --duration 0.5", NUMBA_DISABLE_JIT="1")
    assert done.returncode == 2
    assert done.stderr == (
        "laticauda: NUMBA_DISABLE_JIT is set, but kernels must be compiled: unset it.\n"
    )


def test_a_variable_that_the_compiler_cannot_read_is_said_in_one_line():
    # Moving water, because usual runs do not need the compiler.
    done = run_in_shell("LATICAUDA swim --duration 0.5 --current shear", NUMBA_NUM_THREADS="x")
    assert done.returncode == 0
    lines = [line for line in done.stderr.splitlines() if not line.startswith("compiling")]
    assert lines == [
        "laticauda: Environment variable 'NUMBA_NUM_THREADS' is defined but its associated value "
        "'x' could not be parsed. Numba goes on without it."
    ]


def test_an_encoding_that_other_processes_do_not_expect_costs_no_traceback():
    done = run_in_shell(
        "LATICAUDA swim --duration 0.1 --model spatial >/dev/null", PYTHONIOENCODING="utf-16"
    )
    assert done.returncode == 0
    assert "Traceback" not in done.stderr.replace("\0", "")
