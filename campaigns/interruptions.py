"""What does Ctrl-C do, at any moment of any command?

Question: every command runs in a terminal, where Ctrl-C reaches all its processes, and is stopped
at moments from its first import to its exit; half of the time a second Ctrl-C follows. It has to
end with one line and status 130, and with older files whole; or, if its work was done, with 0; a
second Ctrl-C ends it at once, as the signal does. Servers, operations and identifications end in
good order instead, with 0 or with what they have found. No process may be left, no other line may
be said.

    python campaigns/interruptions.py                        # all, and the answer to interruptions.csv
    python campaigns/interruptions.py --moments 3 --only swim

Moments are counted from where the program takes the signal: in the 0.05 s before that Python itself
is starting, and Ctrl-C is answered by Python. The tests run a slice. The stored times until the end
are those of a computer with ten times as much to do as it has cores for.
"""

import argparse
import random
import re
import shutil
import signal
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

from _jobs import JOBS, Answers, Job, harm, lay, prepare

ENDS = ("one line and 130", "done", "the signal")
COLUMNS = ("command", "moments", *ENDS, "longest_s", "faults")
ANSWERS = Answers(Path(__file__).with_suffix(".csv"), COLUMNS, tuple(JOBS))
IN_GOOD_ORDER = {"operate", "identify", "lab", "cockpit", "serve"}
SERVED = 2.0  # of a server's life [s]
SECOND = (None, None, 0.0, 0.02, 0.3)  # when the second Ctrl-C follows; None: never [s]
AT_ONCE = 3.0  # on a busy computer [s]


@dataclass
class Found:
    """What became of a command."""

    ends: dict[str, int] = field(default_factory=lambda: dict.fromkeys(ENDS, 0))
    longest: float = 0.0
    faults: list[str] = field(default_factory=list[str])


def lines(told: str) -> list[str]:
    """What was said, without bars, without what the terminal does with Ctrl-C, and without numbers."""
    plain = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", told.replace("^C", ""))
    parts = [re.sub(r"[\d.]+", "#", part).strip() for part in re.split(r"[\r\n]", plain)]
    return [part for part in parts if part and "|" not in part]


def undisturbed(job: Job, folder: Path) -> tuple[float, list[str]]:
    """How long a command takes, and what it says on standard error."""
    lay(folder, job)
    running = job.start(folder)
    running.wait_for(1)
    begun = time.monotonic()
    if job.is_server:
        running.wait_for(2)
        begun -= SERVED
        took = time.monotonic() - begun
        running.interrupt()
        status, told = running.end()
    else:
        status, told = running.end()
        took = time.monotonic() - begun
    assert status == 0, f"{job.words} does not come to its end: {told}"
    return took, lines(told)


def stopped(
    name: str, folder: Path, after: float, again: float | None, usual: list[str], found: Found
) -> None:
    """Stop a command.

    Args:
        name: Of the command.
        folder: Where it runs.
        after: The moment, since the program has begun [s].
        again: When the second Ctrl-C follows; None: never [s].
        usual: What it says if it is not stopped.
        found: What became of it is added here.
    """
    job = JOBS[name]
    older = lay(folder, job)
    running = job.start(folder)
    running.wait_for(1)
    time.sleep(after)
    running.interrupt()
    if again is not None:
        time.sleep(again)
        running.interrupt()
    pressed = time.monotonic()
    status, told = running.end()
    took = running.ended - pressed
    said = [line for line in lines(told) if line not in usual]
    kind = {130: "one line and 130", 0: "done", -signal.SIGINT: "the signal"}.get(status, "")
    wrong = harm(folder / "out", older, job, is_whole=False)
    if re.search("Traceback|Exception ignored|Warning|Error", told):
        wrong = "a traceback"
    elif not kind and name not in IN_GOOD_ORDER:
        wrong = f"status {status}"
    elif (kind == "one line and 130" and len(said) != 1) or (
        len(said) > 1 and name not in IN_GOOD_ORDER
    ):
        wrong = f"{len(said)} lines"
    elif kind == "the signal" and again is not None and took > AT_ONCE:
        wrong = f"{took:.0f} s after the second Ctrl-C"
    elif n := running.left_over():
        wrong = f"{n} processes are left"
    found.ends[kind or "done"] += 1
    found.longest = max(found.longest, took)
    if wrong:
        found.faults.append(f"{wrong} (at {after:.2f} s, again {again}): {told.strip()[-2000:]}")


def swept(name: str, folder: Path, moments: int, seed: int = 0) -> Found:
    """Stop a command at moments that lie all over its life, at random within equal parts of it."""
    chance, found = random.Random(f"{name} {seed}"), Found()
    took, usual = undisturbed(JOBS[name], folder)
    for k in range(moments):
        stopped(
            name,
            folder,
            (k + chance.random()) / moments * took,
            chance.choice(SECOND),
            usual,
            found,
        )
    return found


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--moments", type=int, default=10)
    parser.add_argument("--only", nargs="*", default=list(JOBS))
    options = parser.parse_args()
    n_faults = 0
    with tempfile.TemporaryDirectory() as scratch:
        prepare(Path(scratch))
        for name in options.only:
            shutil.rmtree(Path(scratch) / "out", ignore_errors=True)
            found = swept(name, Path(scratch), options.moments)
            n_faults += len(found.faults)
            print(
                name,
                found.ends,
                f"{found.longest:.1f} s",
                f"{len(found.faults)} faults",
                sep=" | ",
                flush=True,
            )
            for fault in found.faults:
                print("    " + fault.replace("\n", "\n    "), flush=True)
            row = (*found.ends.values(), f"{found.longest:.1f}", len(found.faults))
            ANSWERS.keep(name, options.moments, *row)
    sys.exit(n_faults > 0)


if __name__ == "__main__":
    main()
