"""Does any command harm an older file when the disk is full, when it may not write, or when it is killed?

Every command that writes runs over older files of the names of its own, which hold something else:
    full        on a file system without room
    read-only   in a folder that may not be written
    file        over files that may not be written
    killed      ended by SIGKILL at a random moment, then run again

Of each file that was there either the older bytes remain or, where it was killed, all of the new.
Under the first three the program ends with one line that names the place and with status 2; nothing
is left beside the files, also not once a killed command has run again. Sweeps and optimizations
find half of their work in the folder, which stays; operations find a trial of their name, but no
recording, which they would not replace.

    python campaigns/full_disk.py              # as root, on Linux: file systems are mounted, rights given up
    python campaigns/full_disk.py --moments 8  # more moments

The answer is in full_disk.csv; the tests run a slice. Here the disk is bad from the beginning; one
that fails in the middle of writing is in failing_disk.py. Ctrl-C is in interruptions.py.
"""

import argparse
import contextlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Generator, Sequence
from pathlib import Path

from _jobs import WRITERS, Answers, Job, harm, lay, prepare

FAULTS = ("full", "read-only", "file", "killed")
ANSWERS = Answers(Path(__file__).with_suffix(".csv"), ("command", *FAULTS), tuple(WRITERS))
ROOM = 1 << 20
"""Size of the file system that is full [B]."""
GOOD = {"kept", "no such file"}


@contextlib.contextmanager
def fault_at(out: Path, fault: str) -> Generator[None]:
    """Have a fault of the disk there."""
    if fault == "full":
        with full_file_system(out):
            yield
    elif fault == "read-only":
        folders = [path for path in (out, *out.rglob("*")) if path.is_dir()]
        with permissions(folders, meanwhile=0o555, afterward=0o755):
            yield
    else:
        files = [path for path in out.rglob("*") if not path.is_dir()]
        with permissions(files, meanwhile=0o444, afterward=0o644):
            yield


@contextlib.contextmanager
def full_file_system(out: Path) -> Generator[None]:
    """Have a folder on a file system of its own, without room; afterward it has what was left there."""
    aside = out.with_name("aside")
    rest = out / "rest"
    out.rename(aside)
    out.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={ROOM}", "tmpfs", str(out)], check=True)
    try:
        shutil.copytree(aside, out, dirs_exist_ok=True)
        with contextlib.suppress(OSError), rest.open("wb", buffering=0) as file:
            while file.write(b"x" * 4096):
                pass
        yield
        rest.unlink()
        shutil.rmtree(aside)
        shutil.copytree(out, aside)
    finally:
        subprocess.run(["umount", str(out)], check=True)
    out.rmdir()
    aside.rename(out)


@contextlib.contextmanager
def permissions(paths: Sequence[Path], *, meanwhile: int, afterward: int) -> Generator[None]:
    """Give files or folders other permissions."""
    for path in paths:
        path.chmod(meanwhile)
    try:
        yield
    finally:
        for path in paths:
            path.chmod(afterward)


def rubbish(out: Path) -> str:
    """What a writer left behind."""
    names: list[str] = []
    for path in out.rglob("*"):
        if path.name.startswith(".") or path.name.endswith(".partial"):
            names.append(str(path.relative_to(out)))
    return ", ".join(sorted(names))


def complaint(text: str) -> str:
    """What is wrong with what was said; "" if nothing is."""
    if "Traceback" in text or "Exception ignored" in text:
        return "a traceback: " + text.strip().splitlines()[-1]
    lines = re.findall("^laticauda: (?!.*(?:compil|filmed))", text, re.MULTILINE)
    if len(lines) > 1:
        return f"{len(lines)} lines"
    return ""


def on_disk(job: Job, folder: Path, fault: str) -> str:
    """What a command does on a disk with a fault: "kept", or what was wrong."""
    out = folder / "out"
    older = lay(folder, job)
    with fault_at(out, fault):
        status, text = job.fork(folder, is_bound=fault != "full").end()
    wrong = harm(out, older, job, is_whole=True) or complaint(text) or rubbish(out)
    if wrong:
        return wrong
    if status not in expected_statuses(job, fault):
        return f"status {status}"
    if re.search(r"\bout\b", text) is None:
        return f"names no place: {text.strip()}"
    return "kept"


def expected_statuses(job: Job, fault: str) -> tuple[int, ...]:
    """With what a command may end."""
    if "operate" not in job.words:
        return (2,)
    # A robot that stopped swam, too, and beside a file of its name it takes the next one.
    if fault == "file":
        return (0, 1, 2)
    return (1, 2)


def kill(job: Job, folder: Path, after: float) -> str:
    """What is left of files when a command is killed, and what it does then: "kept", or what was wrong.

    Args:
        job: The command.
        folder: Where it runs.
        after: The moment, since it has begun [s].
    """
    out = folder / "out"
    older = lay(folder, job)
    running = job.fork(folder)
    time.sleep(after)
    running.kill()
    running.end()
    if running.left_over():
        return "a process of it is left"
    wrong = harm(out, older, job, is_whole=False)
    if wrong:
        return wrong
    (out / "run.mcap").unlink(missing_ok=True)  # as the program asks for
    status, text = job.fork(folder).end()
    if rubbish(out):
        return rubbish(out)
    if status:
        return f"status {status} when run again: {text.strip()}"
    return "kept"


def answer(command: str, fault: str, folder: Path, moments: int, seed: int = 0) -> str:
    """What became of a command under a fault: "kept", or the first thing that was wrong."""
    job = WRITERS[command]
    if fault == "full" and not can_mount():
        return "not tried"
    if fault != "killed":
        return on_disk(job, folder, fault)
    lay(folder, job)
    running = job.fork(folder)
    begin = time.monotonic()
    status, text = running.end()
    if status != 0:
        return f"it does not run: {text.strip()}"
    duration = time.monotonic() - begin
    chance = random.Random(f"{command} {fault} {seed}")
    for _ in range(moments):
        outcome = kill(job, folder, chance.uniform(0.0, duration))
        if outcome != "kept":
            return outcome
    return "kept"


def can_mount() -> bool:
    """Whether file systems can be mounted here."""
    with tempfile.TemporaryDirectory() as name:
        mount = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", name], capture_output=True
        )
        return mount.returncode == 0 and subprocess.run(["umount", name]).returncode == 0


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--moments", type=int, default=1)
    parser.add_argument("--only", nargs="*", default=list(WRITERS))
    parser.add_argument("--faults", nargs="*", default=list(FAULTS))
    options = parser.parse_args()
    is_good = True
    with tempfile.TemporaryDirectory() as name:
        prepare(Path(name))
        for command in options.only:
            row = {
                fault: answer(command, fault, Path(name), options.moments)
                for fault in options.faults
            }
            print(command, *row.values(), sep=" | ", flush=True)
            ANSWERS.keep(command, *map(row.get, FAULTS))
            is_good = is_good and GOOD.issuperset(row.values())
    sys.exit(not is_good)


if __name__ == "__main__":
    main()
