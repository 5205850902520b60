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
from typing import NamedTuple

from _jobs import JOBS, Answers, Job, harm, lay, prepare

ENDS = ("one line and 130", "done", "the signal")
COLUMNS = ("command", "moments", *ENDS, "longest_s", "faults")
ANSWERS = Answers(Path(__file__).with_suffix(".csv"), COLUMNS, tuple(JOBS))
IN_GOOD_ORDER = {"operate", "identify", "lab", "cockpit", "serve"}
SERVED = 2.0
"""Time of a server's life in which it is stopped [s]."""
SECOND = (None, None, 0.0, 0.02, 0.3)
"""When the second Ctrl-C follows; None: never [s]."""
AT_ONCE = 3.0
"""Time in which a busy computer does something at once [s]."""


@dataclass
class Tally:
    """What became of a command at all moments."""

    ends: dict[str, int] = field(default_factory=lambda: dict.fromkeys(ENDS, 0))
    """How often it ended in each way."""
    longest: float = 0.0
    """Time until the end at most [s]."""
    faults: list[str] = field(default_factory=list[str])


class Life(NamedTuple):
    """A command that is not stopped."""

    duration: float
    """How long it takes [s]."""
    lines: list[str]
    """What it says on standard error."""


def lines(text: str) -> list[str]:
    """What was said, without bars, without what the terminal does with Ctrl-C, and without numbers."""
    plain = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", text.replace("^C", ""))
    parts = [re.sub(r"[\d.]+", "#", part).strip() for part in re.split(r"[\r\n]", plain)]
    return [part for part in parts if part and "|" not in part]


def run_undisturbed(job: Job, folder: Path) -> Life:
    """Run a command to its end; a server until it serves, and `SERVED` longer."""
    lay(folder, job)
    running = job.start(folder)
    running.wait_for(1)
    begin = time.monotonic()
    if job.is_server:
        running.wait_for(2)
        duration = time.monotonic() - begin + SERVED
        running.interrupt()
        status, text = running.end()
    else:
        status, text = running.end()
        duration = time.monotonic() - begin
    assert status == 0, f"{job.words} does not come to its end: {text}"
    return Life(duration, lines(text))


def stop(
    name: str, folder: Path, after: float, again: float | None, usual: list[str], tally: Tally
) -> None:
    """Stop a command.

    Args:
        name: Of the command.
        folder: Where it runs.
        after: The moment, since the program has begun [s].
        again: When the second Ctrl-C follows; None: never [s].
        usual: What it says if it is not stopped.
        tally: What became of it is added here.
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
    status, text = running.end()
    delay = running.ended - pressed
    n_lines = sum(line not in usual for line in lines(text))
    is_in_good_order = name in IN_GOOD_ORDER
    end = {130: "one line and 130", 0: "done", -signal.SIGINT: "the signal"}.get(status, "")
    is_one_line_missing = end == "one line and 130" and n_lines != 1
    says_too_much = n_lines > 1 and not is_in_good_order
    fault = harm(folder / "out", older, job, is_whole=False)
    if re.search("Traceback|Exception ignored|Warning|Error", text):
        fault = "a traceback"
    elif not end and not is_in_good_order:
        fault = f"status {status}"
    elif is_one_line_missing or says_too_much:
        fault = f"{n_lines} lines"
    elif end == "the signal" and again is not None and delay > AT_ONCE:
        fault = f"{delay:.0f} s after the second Ctrl-C"
    elif n_processes := running.left_over():
        fault = f"{n_processes} processes are left"
    tally.ends[end or "done"] += 1
    tally.longest = max(tally.longest, delay)
    if fault:
        tally.faults.append(f"{fault} (at {after:.2f} s, again {again}): {text.strip()[-2000:]}")


def stop_at_moments(name: str, folder: Path, moments: int, seed: int = 0) -> Tally:
    """Stop a command at moments that lie all over its life, at random within equal parts of it."""
    chance = random.Random(f"{name} {seed}")
    tally = Tally()
    life = run_undisturbed(JOBS[name], folder)
    for k in range(moments):
        after = (k + chance.random()) / moments * life.duration
        again = chance.choice(SECOND)
        stop(name, folder, after, again, life.lines, tally)
    return tally


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
            tally = stop_at_moments(name, Path(scratch), options.moments)
            n_faults += len(tally.faults)
            print(
                name,
                tally.ends,
                f"{tally.longest:.1f} s",
                f"{len(tally.faults)} faults",
                sep=" | ",
                flush=True,
            )
            for fault in tally.faults:
                print("    " + fault.replace("\n", "\n    "), flush=True)
            row = (*tally.ends.values(), f"{tally.longest:.1f}", len(tally.faults))
            ANSWERS.keep(name, options.moments, *row)
    sys.exit(n_faults > 0)


if __name__ == "__main__":
    main()
