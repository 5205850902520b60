"""Is anything lost when a job of any kind is killed?

Question: sweeps, optimizations, identifications, the paper's reproduction and operations are killed
by SIGKILL at random moments of their work, 100 times in all, and run again: are the results the
same, bit for bit, as those of a job that nobody killed, and does every process of it end? A
recording of an operation cannot be the same: it has to be readable, and to be the beginning of a
whole one.

    python campaigns/kills.py                           # 100 kills, and the answer to kills.csv
    python campaigns/kills.py --kills 2 --only operate  # fewer

A job is killed once to three times in a row before it may come to its end. Sweeps and optimizations
go on where they were; identifications and reproductions begin anew, over what is there. The tests
run a slice. More kills of sweeps and optimizations, before single file operations and of workers
too, are in sweep_kills.py and optimize_kills.py.
"""

import argparse
import hashlib
import random
import shutil
import signal
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from _jobs import WRITERS, Answers, Job, prepare

REPRODUCE = WRITERS["reproduce"]
JOBS: dict[str, Job] = {
    "sweep": replace(WRITERS["sweep"], words=WRITERS["sweep"].words.replace("60:300", "60:1500")),
    "optimize": WRITERS["optimize"],
    "identify": replace(
        WRITERS["identify"], words=WRITERS["identify"].words.replace("--starts 1", "--starts 2")
    ),
    "reproduce": replace(REPRODUCE, words=REPRODUCE.words.replace("--workers 2", "--workers 1")),
    "reproduce, by two workers": REPRODUCE,
    "operate": Job(words="recorded 3.0"),
}
KILLS = {name: 20 for name in JOBS} | {"reproduce": 15, "reproduce, by two workers": 5}
SAME = {name: "the same bits" for name in JOBS} | {
    "operate": "readable, the beginning of a whole one"
}
ANSWERS = Answers(
    Path(__file__).with_suffix(".csv"), ("job", "kills", "ends", "result"), tuple(JOBS)
)


def contents(folder: Path) -> dict[str, str]:
    """Digests of all files that a job has written."""
    found = sorted(file for file in (folder / "out").rglob("*") if file.is_file())
    return {
        str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in found
    }


def is_beginning(folder: Path, whole: Path) -> bool:
    """Whether a recording that broke off is readable, and is the beginning of a whole one."""
    from laticauda.tank.operate.recording.log import read_operation
    from laticauda.values.errors import LaticaudaError

    file = folder / "out" / "run.mcap"
    if not file.exists() or file.stat().st_size == 0:  # it had not begun
        return True
    try:
        found = read_operation(file).entries
    except LaticaudaError as error:  # its header was not yet written
        return "header" in str(error) or "empty" in str(error)
    return repr(found) == repr(read_operation(whole / "out" / "run.mcap").entries[: len(found)])


def emptied(folder: Path) -> Path:
    """The folder, with nothing in its folder `out`."""
    shutil.rmtree(folder / "out", ignore_errors=True)
    (folder / "out").mkdir()
    return folder


def finished(job: Job, folder: Path) -> float:
    """Run a job to its end; returns how long it took from its beginning [s]."""
    running = job.fork(folder, is_cut=True)
    begun = time.monotonic()
    status, told = running.end()
    assert status == 0, f"{job.words} does not come to its end: {told}"
    return time.monotonic() - begun


def killed(name: str, kills: int, scratch: Path, seed: int = 0) -> tuple[int, int, str]:
    """Kill a job so often.

    Args:
        name: Of the job.
        kills: How often it is hit at work.
        scratch: A folder for it.
        seed: Of the moments.

    Returns:
        How many kills hit it, how often it came to its end after some, and what was lost; "" if
        nothing was.
    """
    job, chance = JOBS[name], random.Random(f"{name} {seed}")
    whole, broken = scratch / f"{name}-whole", scratch / f"{name}-broken"
    for folder in (whole, broken):
        shutil.copytree(scratch / "inputs", folder)
    finished(job, emptied(whole))  # imports
    took = finished(job, emptied(whole))
    expected = contents(whole)
    hits = ends = 0
    while hits < kills:
        emptied(broken)
        for _ in range(1 if name == "operate" else chance.randint(1, 3)):
            running = job.fork(broken, is_cut=True)
            time.sleep(chance.uniform(0.0, took))
            running.kill()
            is_hit = running.end()[0] == -signal.SIGKILL
            hits += is_hit
            if running.left_over():
                return hits, ends, "a process of it is left"
            if name == "operate" and not is_beginning(broken, whole):
                return hits, ends, "the recording is another one"
            if not is_hit or hits == kills:
                break
        if name != "operate":
            finished(job, broken)
            ends += 1
            if (found := contents(broken)) != expected:
                return hits, ends, f"others: {sorted(dict(found.items() ^ expected.items()))}"
    return hits, ends, ""


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--kills", type=int, help="of each job, in place of 100 in all")
    parser.add_argument("--only", nargs="*", default=list(JOBS))
    options = parser.parse_args()
    is_good = True
    with tempfile.TemporaryDirectory() as scratch:
        (Path(scratch) / "inputs").mkdir()
        prepare(Path(scratch) / "inputs")
        for name in options.only:
            hits, ends, lost = killed(name, options.kills or KILLS[name], Path(scratch))
            print(name, hits, ends, lost or SAME[name], sep=" | ", flush=True)
            ANSWERS.keep(name, hits, ends, lost or SAME[name])
            is_good = is_good and not lost
    sys.exit(not is_good)


if __name__ == "__main__":
    main()
