"""Does any bad input end in a traceback, a hang, a figure that is not finite, or a message that names nothing?

A seed draws inputs of each kind, and each is tried in a process of its own with 6 GB more than its
parent and 60 s of a core. What is refused has to be refused in one sentence that names the place;
what is accepted has to come to finite figures, or to a run that says that it diverged; and no
warning of numpy may reach the shell. What there is to attack is read from the package itself, see
`bad_inputs/surface.py`: a new option, field of a message or public function needs no line here.

    calls        odd arguments of every public function and class
    values       numbers at the ends of every declared quantity
    messages     odd values in every field of every message to `serve`
    flags        odd words behind every option of every command
    paths        devices, pipes and folders in the place of files
    texts        nested and odd TOML and JSON
    lists        lists of points of a sweep
    columns      column maps and logs
    tasks        identification tasks
    exports      robots with odd names, for other programs
    robots       robots and waters with numbers of any size
    damaged      trials, flows and scenes with random damage
    folders      folders of sweeps and optimizations with random damage
    damage       every file that is read, flipped, zeroed or cut at every 97th byte
    environment  closed streams, narrow terminals, pipes as outputs, limits, languages, missing folders
    plausible    what is wrong and looks right, and true robots

    python campaigns/bad_input.py                    # ten new seeds, which are printed and kept
    python campaigns/bad_input.py --seed 3 4         # these seeds, those of an earlier run, for instance
    python campaigns/bad_input.py --only calls --count 500

The answer is in bad_input.csv, a row for each kind and seed. A run that was stopped goes on where it
was with its seeds; `--new` forgets the rows. The tests run a slice.

Last answer (2 shared cores, 2026-11-29; ten new seeds, four inputs of each of the 16 kinds): 1 405
inputs and damaged places, 495 refused by name, 117 accepted, 23 ended by their limit of time, 5 other
values from files that have no checksum, 0 faults.
"""

import argparse
import importlib
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from _rows import append_row, stored
from bad_inputs import (
    call_kinds,
    command_kinds,
    damage_kinds,
    environment_kinds,
    file_kinds,
    message_kinds,
    pantry,
    plausible_kinds,
)
from bad_inputs.attempt import Answer, Case, attempt

from laticauda.cli import app

ANSWERS = Path(__file__).with_suffix(".csv")
N_SEEDS = 10
COUNT = 20
"""Inputs of each kind and seed."""

Kind = Callable[[random.Random, Path], Iterator[Case]]
KINDS: Mapping[str, Kind] = {
    kind.__name__: kind
    for kind in (
        call_kinds.calls,
        call_kinds.values,
        message_kinds.messages,
        command_kinds.flags,
        command_kinds.paths,
        command_kinds.texts,
        command_kinds.lists,
        command_kinds.columns,
        command_kinds.tasks,
        command_kinds.exports,
        command_kinds.robots,
        file_kinds.damaged,
        file_kinds.folders,
        damage_kinds.damage,
        environment_kinds.environment,
        plausible_kinds.plausible,
    )
}


@dataclass(frozen=True)
class Row:
    """What came of the inputs of one kind and one seed."""

    kind: str
    seed: int
    inputs: int
    refused: int
    accepted: int
    stopped: int
    differs: int
    faults: int


def prepare() -> None:
    """Import what every process would import, and compile what all need."""
    for command in app.COMMANDS.values():
        module, _, _ = command.location.partition(":")
        importlib.import_module(f".{module}", "laticauda.cli")
    pantry.swim_trial(0.1)


def draw(kind: str, seed: int, count: int, folder: Path) -> Iterator[Case]:
    """Yield inputs of a kind.

    Args:
        kind: Of `KINDS`.
        seed: Of everything random.
        count: How many.
        folder: The folder of good files.
    """
    cases = KINDS[kind](random.Random(f"{kind} {seed}"), folder)
    for _, case in zip(range(count), cases, strict=False):
        yield case


def try_kind(kind: str, seed: int, count: int, folder: Path) -> tuple[Row, list[str]]:
    """Return what came of inputs of a kind, and its faults in words.

    Args:
        kind: Of `KINDS`.
        seed: Of everything random.
        count: How many inputs.
        folder: The folder of good files.
    """
    verdicts: Counter[str] = Counter()
    n_inputs = 0
    faults: list[str] = []
    for case in draw(kind, seed, count, folder):
        answer = attempt(case)
        verdicts[answer.verdict] += 1
        n_inputs += answer.n_inputs
        if answer.verdict == "fault":
            faults.append(describe(case, answer))
            print(faults[-1], flush=True)
    row = Row(
        kind=kind,
        seed=seed,
        inputs=n_inputs,
        refused=verdicts["refused"],
        accepted=verdicts["accepted"],
        stopped=verdicts["stopped"],
        differs=verdicts["differs"],
        faults=len(faults),
    )
    return row, faults


def describe(case: Case, answer: Answer) -> str:
    """Return a fault in words that every terminal can print.

    Args:
        case: The input.
        answer: What came of it.
    """
    return f"[{case.kind}] {case.shown[:200]!a}\n    {answer.detail[-500:]!a}"


def read_rows() -> list[Row]:
    """Return the rows of the last answer."""
    return stored(ANSWERS, Row)


def keep_row(row: Row) -> None:
    """Add a row to the answer.

    Args:
        row: The row.
    """
    append_row(ANSWERS, row)


def choose_seeds(typed: Sequence[int]) -> list[int]:
    """Return the seeds that were typed; otherwise those of a run that was stopped, or new ones.

    Args:
        typed: Seeds that were typed.
    """
    if typed:
        return list(typed)
    seeds_of_last = list(dict.fromkeys(row.seed for row in read_rows()))
    first = random.SystemRandom().randrange(10**6)
    new_seeds = range(first, first + N_SEEDS - len(seeds_of_last))
    return [*seeds_of_last, *new_seeds]


def main() -> int:
    """Try inputs of every kind and seed that the answer does not have yet; return 1 if there was a fault."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, nargs="+", default=[])
    parser.add_argument("--count", type=int, default=COUNT)
    parser.add_argument("--only", nargs="+", default=list(KINDS), choices=list(KINDS))
    parser.add_argument("--new", action="store_true", help="forget the rows of the last answer")
    options = parser.parse_args()
    if options.new:
        ANSWERS.unlink(missing_ok=True)
    seeds = choose_seeds(options.seed)
    print("seeds", *seeds, flush=True)
    done = {(row.kind, row.seed) for row in read_rows()}
    jobs = [(kind, seed) for seed in seeds for kind in options.only if (kind, seed) not in done]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        prepare()
        pantry.fill_pantry(folder)
        pantry.fill_slow_pantry(folder)
        for kind, seed in jobs:
            begin = time.monotonic()
            row, _ = try_kind(kind, seed, options.count, folder)
            keep_row(row)
            seconds = time.monotonic() - begin
            print(*asdict(row).values(), f"{seconds:.0f} s", file=sys.stderr, flush=True)
    return 1 if any(row.faults for row in read_rows()) else 0


if __name__ == "__main__":
    sys.exit(main())
