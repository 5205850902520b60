"""Is anything taken for whole that a failing disk left half written?

Question: while a command writes, its disk fails: after a random number of bytes every write, fsync
and rename in the folder of the output gives an input/output error, or says that there is no room.
Does the command say so in one sentence that names the place, and end with status 2 (an operation
with 1, if the robot swam)? Does every older file remain as it was, unless the new one is whole? And
does the same command, on a disk that is well again, end as if nothing had happened: with the same
bits, where its files hold no date?

    python campaigns/failing_disk.py              # 10 moments and both errors for each command
    python campaigns/failing_disk.py --moments 1 --only swim

The disk is a library that is loaded before all others (failing_disk.c); it needs Linux and a C
compiler. A disk that is full from the beginning, or read-only, is in full_disk.py. The answer is in
failing_disk.csv; the tests run a slice.
"""

import argparse
import ctypes
import errno
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from _jobs import WRITERS, Answers, Job, harm, lay, prepare
from full_disk import complaint, rubbish
from kills import contents

SHIM = "DISK_SHIM"
"""Variable of the environment with the path of the library, once it is loaded."""
ERRORS = {"io": errno.EIO, "room": errno.ENOSPC}
COMMANDS = ("swim", "sweep", "optimize", "identify", "reproduce", "operate")
DATED = ("swim", "operate")
"""Commands whose files state when they were written."""
ANSWERS = Answers(
    Path(__file__).with_suffix(".csv"), ("command", "moments", "failed", "result"), COMMANDS
)
GOOD = "kept"


def find_compiler() -> list[str] | None:
    """The command of a C compiler, if there is one."""
    found = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    return [found] if found and sys.platform == "linux" else None


def load_shim(scratch: Path) -> None:
    """Become the same program with the library loaded; returns if it already is, or if nothing can be compiled."""
    compiler = find_compiler()
    if SHIM in os.environ or compiler is None:
        return
    library = scratch / "failing_disk.so"
    source = Path(__file__).with_suffix(".c")
    words = [*compiler, "-shared", "-fPIC", "-O1", "-o", str(library), str(source), "-ldl"]
    subprocess.run(words, check=True)
    environment = {**os.environ, SHIM: str(library), "LD_PRELOAD": str(library)}
    os.execve(sys.executable, [sys.executable, *sys.argv], environment)


@contextmanager
def failing(folder: Path, after: int, number: int) -> Generator[None]:
    """Have the disk fail for programs that are started meanwhile."""
    path = os.path.realpath(folder)
    disk = ctypes.CDLL(os.environ[SHIM])
    variables = {"DISK_FOLDER": path, "DISK_BYTES": str(after), "DISK_ERRNO": str(number)}
    os.environ |= variables  # of programs that it starts
    disk.set_disk(path.encode(), ctypes.c_longlong(after), number)  # of forks
    try:
        yield
    finally:
        disk.set_disk(b"", ctypes.c_longlong(0), 0)
        for name in variables:
            del os.environ[name]


def size_of(folder: Path) -> int:
    """Bytes in all files of a folder."""
    return sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())


def answer_once(command: str, job: Job, folder: Path, after: int, number: int) -> tuple[bool, str]:
    """Whether the disk failed at work, and "kept", or what was wrong.

    Args:
        command: Name of the job.
        job: The job.
        folder: A folder that `prepare` has filled.
        after: Bytes after which the disk fails.
        number: Number of the error.
    """
    out = folder / "out"
    older = lay(folder, job)
    with failing(out, after, number):
        running = job.fork(folder)
    status, told = running.end()
    if status == 0:
        return False, GOOD
    wrong = complaint(told) or harm(out, older, job, is_whole=False) or rubbish(out)
    if not wrong and status not in ((1, 2) if command == "operate" else (2,)):
        wrong = f"status {status}"
    if not wrong and "out" not in told:
        wrong = f"names no place: {told.strip()}"
    return True, wrong or GOOD


def run_again(command: str, job: Job, folder: Path, whole: dict[str, str]) -> str:
    """What the same command does on a disk that is well: "kept", or what was wrong."""
    (folder / "out" / "run.mcap").unlink(missing_ok=True)  # as the program asks for
    status, told = job.fork(folder).end()
    if status:
        return f"status {status} when run again: {told.strip()}"
    if command not in DATED and contents(folder) != whole:
        return "others when run again"
    return rubbish(folder / "out") or GOOD


def answer(command: str, folder: Path, moments: int, seed: int = 0) -> tuple[int, int, str]:
    """How often the disk was to fail, how often it did at work, and "kept", or the first thing that was wrong."""
    job, chance = WRITERS[command], random.Random(f"{command} {seed}")
    lay(folder, job)
    before = size_of(folder / "out")
    status, told = job.fork(folder).end()
    if status:
        return 0, 0, f"it does not run: {told.strip()}"
    whole = contents(folder)
    most = max(size_of(folder / "out") - before, 1 << 14)
    failed = tried = 0
    for _ in range(moments):
        for number in ERRORS.values():
            tried += 1
            has_failed, result = answer_once(command, job, folder, chance.randrange(most), number)
            failed += has_failed
            if result == GOOD:
                result = run_again(command, job, folder, whole)
            if result != GOOD:
                return tried, failed, result
    return tried, failed, GOOD


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--moments", type=int, default=10)
    parser.add_argument("--only", nargs="*", default=list(COMMANDS))
    options = parser.parse_args()
    is_good = True
    with tempfile.TemporaryDirectory() as name:
        if find_compiler() is None:
            print("not tried: it needs Linux and a C compiler")
            return
        load_shim(Path(tempfile.mkdtemp()))
        prepare(Path(name))
        for command in options.only:
            tried, failed, result = answer(command, Path(name), options.moments)
            print(command, tried, failed, result, sep=" | ", flush=True)
            ANSWERS.keep(command, tried, failed, result)
            is_good = is_good and result == GOOD
    sys.exit(not is_good)


if __name__ == "__main__":
    main()
