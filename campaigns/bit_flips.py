"""Is a wrong bit in a stored file noticed?

Question: one random bit of one random file is flipped, and the file is read as a user reads it. Is
the damage named in a sentence, or is every value that is read the same as before? And if the job
can go on from what is stored, does it end with the same bits as without the damage?

    sweep        any file of the folder of a sweep of 7 200 points; every tenth time the same sweep is
                 then run again (every time in the first three rows)
    trial        a saved trial (.nc)
    trial, mcap  the same as an MCAP file
    recording    a recording of an operation
    optimize     the checkpoint of an optimization, from which it goes on
    identify     fit.json, from which predictions are made

    python campaigns/bit_flips.py                  # what bit_flips.csv does not have yet: 3 000 flips, 15 minutes
    python campaigns/bit_flips.py --only recording

A file for people to edit has no checksum, or no edit would be accepted: parameters.toml and other
TOML files, front.csv. Of them nothing is asked here. The answer is in bit_flips.csv, a row for every
hundred flips; the tests run a slice.

Last answer (2 shared cores, 2026-11-29), 3 000 flips, none silent:
    sweep        1500 flips, 1498 named,  2 changed nothing; 420 of 420 that were run again: the same bits
    trial         300 flips,  300 named
    trial, mcap   300 flips,  283 named, 17 changed nothing
    recording     300 flips,  295 named,  5 changed nothing
    optimize      300 flips,  279 named, 21 changed nothing
    identify      300 flips,  300 named
"""

import argparse
import random
import shutil
import sys
import tempfile
import warnings
from collections.abc import Callable
from contextlib import chdir, redirect_stdout
from dataclasses import dataclass
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
from _program import recorded
from _rows import go_on, stored

import laticauda as lc
from laticauda.studies import Front, Grid, Optimization, Sweep, open_sweep, optimize, run_sweep
from laticauda.values import LaticaudaError

ANSWERS = Path(__file__).with_suffix(".csv")
FLIPS = 100
"""Flips of a row."""
RESUMED_EVERY = 10
"""Of so many flips, one job goes on with what is damaged."""
ROWS = {"sweep": 15} | dict.fromkeys(
    ("trial", "trial, mcap", "recording", "optimize", "identify"), 3
)
"""Rows of each kind."""
FAST = next((place for place in ("/dev/shm",) if Path(place).is_dir()), None)
"""Where files are quickly written and removed; None: where temporary files are."""
GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)


class Named(Exception):
    """The reader said that something is damaged, without an error."""


@dataclass(frozen=True)
class Row:
    """What became of a hundred flips."""

    fault: str
    """Kind of what was damaged."""
    seed: int
    """Of the flips."""
    flips: int
    named: int
    """Damage that a sentence named."""
    unchanged: int
    """All that was read was the same."""
    silent: int
    """Something else was read, and nobody said so."""
    unnamed: int
    """An error that is not a sentence of laticauda."""
    resumed: int
    """Jobs that went on, and ended with the same bits."""
    otherwise: int
    """Jobs that went on and ended otherwise, or not at all although they should."""


@dataclass(frozen=True)
class Subject:
    """Something stored."""

    place: Path
    """A file, or a folder of files."""
    read: Callable[[Path], Any]
    """Reads all of it, and raises a ValueError or LaticaudaError if something is damaged."""
    resume: Callable[[Path], Any] | None = None
    """Goes on with it, however damaged it is; returns what `read` does. None: nothing goes on."""


# ---- what is stored ------------------------------------------------------------------------------


def sweep_of(counts: tuple[int, int, int]) -> Sweep:
    """A sweep over a grid of so many points along each axis."""
    values = {
        "gait.amplitude": np.linspace(0.2, 0.8, counts[0]),
        "gait.frequency": np.linspace(1.5, 2.6, counts[1]),
        "water.normal_drag": np.linspace(1.0, 2.0, counts[2]),
    }
    return Sweep(scenario=lc.build_scenario("mamba", GAIT, 2.0), points=Grid(values=values))


def store_sweep(scratch: Path, counts: tuple[int, int, int] = (20, 20, 18)) -> Subject:
    """A stored sweep, in eight regions."""
    sweep = sweep_of(counts)

    def resume(place: Path) -> Any:
        run_sweep(sweep, place, threads=1)
        return everything_in(open_sweep(place))

    run_sweep(sweep, scratch / "sweep", region_size=max(1, sweep.n_trials // 8))
    return Subject(scratch / "sweep", lambda place: everything_in(open_sweep(place)), resume)


def everything_in(dataset: Any) -> Any:
    """All values and attributes of a Dataset, comparable."""
    variables = {
        str(name): (
            variable.dims,
            str(variable.dtype),
            variable.to_numpy().tobytes(),
            repr(variable.attrs),
        )
        for name, variable in dataset.variables.items()
    }
    return variables, repr(dataset.attrs)


def store_trial(scratch: Path, suffix: str = ".nc") -> Subject:
    """A saved trial."""
    place = scratch / f"trial{suffix}"
    lc.swim("mamba", GAIT, 3.0).save(place)
    return Subject(place, lambda file: everything_in(lc.load_trial(file).to_dataset()))


def store_recording(scratch: Path) -> Subject:
    """A recording of an operation."""
    from laticauda.tank.operate.recording.log import read_operation

    def read(file: Path) -> Any:
        found = read_operation(file)
        if found.lost:
            raise Named(found.lost)
        return repr((found.header, found.version, found.notes, found.entries, found.epoch))

    recorded(scratch, 2.0)
    return Subject(scratch / "run.mcap", read)


def store_optimum(scratch: Path) -> Subject:
    """The checkpoint of an optimization."""
    sought = Optimization(
        scenario=lc.build_scenario("mamba", GAIT, 2.0),
        bounds={"gait.amplitude": (0.2, 2.0), "gait.phase_shift": (0.2, 1.2)},
    )

    def go_on(place: Path) -> Any:
        front: Front = optimize(sought, place, budget=80, population=20, seed=5, threads=1)
        return everything_in(front.to_dataset())

    go_on(scratch / "optimum")
    return Subject(scratch / "optimum", go_on)


def store_identification(scratch: Path) -> Subject:
    """The file fit.json of an identification."""
    from laticauda import cli
    from laticauda.identify import load_basis

    for k in range(3):
        gait = lc.lateral_undulation(amplitude=0.4 + 0.1 * k, frequency=2.3, phase_shift=0.7)
        lc.swim("mamba", gait, 4.0).save(scratch / f"run-{k}.nc")
    words = (
        "identify run-0.nc run-1.nc run-2.nc --parameters water.normal_drag --robot mamba "
        "--measured forward_velocity=0.004 --starts 1 --quick --threads 1 --output out"
    )
    with chdir(scratch), redirect_stdout(StringIO()):
        assert cli.main(words.split()) == 0
    (scratch / "fit").mkdir()
    shutil.copy(scratch / "out" / "fit.json", scratch / "fit")
    return Subject(scratch / "fit", lambda folder: repr(load_basis(folder).to_table()))


STORES: dict[str, Callable[[Path], Subject]] = {
    "sweep": store_sweep,
    "trial": store_trial,
    "trial, mcap": lambda scratch: store_trial(scratch, ".mcap"),
    "recording": store_recording,
    "optimize": store_optimum,
    "identify": store_identification,
}


# ---- flips ---------------------------------------------------------------------------------------


@cache
def subject_of(fault: str) -> tuple[Subject, Any]:
    """What is stored, made once, and what is read of it while it is intact."""
    subject = STORES[fault](Path(tempfile.mkdtemp()))
    return subject, subject.read(subject.place)


def copy_anew(place: Path, target: Path) -> None:
    """Copy a file or a folder over what there is."""
    if place.is_dir():
        shutil.rmtree(target, ignore_errors=True)
        shutil.copytree(place, target)
    else:
        shutil.copy(place, target)


def flip(place: Path, chance: random.Random) -> tuple[Path, bytes]:
    """Flip a bit of a file: first a file is drawn, then a byte of it; returns the file, and what it held."""
    files = [place]
    if place.is_dir():
        files = sorted(file for file in place.rglob("*") if file.is_file())
    file = chance.choice(files)
    before = file.read_bytes()
    content = bytearray(before)
    content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)
    file.write_bytes(content)
    return file, before


def outcome_of(read: Callable[[Path], Any], place: Path, expected: Any) -> str:
    """What became of reading: "named", "unchanged", "silent" or "unnamed"."""
    try:
        found = read(place)
    except (ValueError, LaticaudaError, Named) as error:
        words = str(error)
        is_sentence = words and "\n" not in words and "Traceback" not in words
        return "named" if is_sentence else "unnamed"
    except Exception as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr, flush=True)
        return "unnamed"
    return "unchanged" if found == expected else "silent"


def flip_many(fault: str, seed: int, flips: int = FLIPS) -> Row:
    """Flip bits, one at a time, and count what becomes of them."""
    warnings.simplefilter("ignore")
    subject, expected = subject_of(fault)
    chance = random.Random(f"{fault} {seed}")
    counts = dict.fromkeys(("named", "unchanged", "silent", "unnamed", "resumed", "otherwise"), 0)
    with tempfile.TemporaryDirectory() as scratch:
        damaged = Path(scratch) / subject.place.name
        copy_anew(subject.place, damaged)
        for number in range(flips):
            file, before = flip(damaged, chance)
            counts[outcome_of(subject.read, damaged, expected)] += 1
            if subject.resume is None or number % RESUMED_EVERY:
                file.write_bytes(before)
                continue
            is_same = outcome_of(subject.resume, damaged, expected) == "unchanged"
            counts["resumed" if is_same else "otherwise"] += 1
            copy_anew(subject.place, damaged)
    return Row(fault, seed, flips, **counts)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", nargs="*", default=list(ROWS))
    options = parser.parse_args()
    jobs = [(fault, seed) for fault in options.only for seed in range(ROWS[fault])]
    with tempfile.TemporaryDirectory(dir=FAST) as scratch:
        tempfile.tempdir = scratch  # workers are forks, and have it too
        go_on(ANSWERS, Row, jobs, flip_many)
        tempfile.tempdir = None
    rows: list[Row] = stored(ANSWERS, Row)
    for fault in ROWS:
        of_kind = [row for row in rows if row.fault == fault]
        total = {
            name: sum(getattr(row, name) for row in of_kind)
            for name in ("flips", "named", "unchanged", "silent", "unnamed", "resumed", "otherwise")
        }
        print(fault, *(f"{n} {name}" for name, n in total.items() if n), sep=", ")
    sys.exit(any(row.silent or row.unnamed or row.otherwise for row in rows))


if __name__ == "__main__":
    main()
