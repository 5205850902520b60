"""Runs of an operation by fault and seed, as rows of a CSV file that every call goes on with: for other campaigns."""

import csv
import functools
import multiprocessing
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any


def stored(path: Path, kind: Any) -> list[Any]:
    """The rows in a file, each an object of a class whose fields are numbers or texts."""
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return [read_row(cells, kind) for cells in csv.DictReader(file)]


def read_row(cells: Mapping[str, str], kind: Any) -> Any:
    """The object that the cells of a row stand for."""
    values: dict[str, Any] = {}
    for field in fields(kind):
        type_of_field: Any = field.type
        values[field.name] = type_of_field(cells[field.name])
    return kind(**values)


def go_on(
    path: Path,
    kind: Any,
    jobs: Iterable[tuple[str, int]],
    run_one: Callable[[str, int], Any],
    workers: int = 1,
) -> list[Any]:
    """The rows in a file, after the jobs, fault and seed, that it has not yet; each is kept as soon as it is done.

    With several workers rows stay in the order of the jobs; what a worker is ahead is lost when it
    is stopped.
    """
    rows = stored(path, kind)
    finished = {(row.fault, row.seed) for row in rows}
    left = [job for job in jobs if job not in finished]
    with multiprocessing.Pool(workers) as pool:
        for row in pool.imap(functools.partial(_run_job, run_one), left):
            append_row(path, row)
            rows.append(row)
            values = [value for name, value in asdict(row).items() if name != "fault"]
            print(row.fault or "good", *values, file=sys.stderr, flush=True)
    return rows


def append_row(path: Path, entry: Any) -> None:
    """Add a row, an object of a dataclass, to a file; a new file gets its header first."""
    row = asdict(entry)
    is_new = not path.exists()
    with path.open("a", newline="") as file:
        writer = csv.DictWriter(file, list(row), lineterminator="\n")
        if is_new:
            writer.writeheader()
        writer.writerow(row)


def _run_job(run_one: Callable[[str, int], Any], job: tuple[str, int]) -> Any:
    return run_one(*job)
