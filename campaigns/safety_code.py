"""Is every branch of the safety code gone through by the tests that stand next to it?

Question: supervisor, limits, verdict, recording and protocol decide whether a robot is stopped in
time and a run is right. Which of their statements and branches does no test of theirs run? None may
be left, and no line is excluded but what stands under `if TYPE_CHECKING`.

    python campaigns/safety_code.py                # measure, write safety_code.csv, print what is not run
    python campaigns/safety_code.py --only verdict # files whose path holds this, by their own tests; nothing is written

It is measured by coverage.py, branches too, also in the program that writes a recording. Whether a
test would notice if a line said something else is the question of mutants.py. The tests run a
slice.

Last answer (2 shared cores, 2026-11-30; 100 s): all of 2971 statements and 664 branches in 35
files.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).parents[1]
STORED = Path(__file__).with_suffix(".csv")
TESTS = {
    "tank/operate/safety": ("tests/tank/operate/safety",),
    "tank/operate/verdict": ("tests/tank/operate/test_verdict.py",),
    "tank/operate/recording": ("tests/tank/operate/recording",),
    "tank/protocol": ("tests/tank/protocol",),
}
"""The safety code, in laticauda, and its tests."""


class Row(NamedTuple):
    """What the tests leave of a file."""

    file: str
    statements: int
    branches: int
    not_run: str
    """Numbers of lines; "all" if nothing of it was imported."""
    branches_not_taken: str
    """As FROM->TO, by lines."""


SETTINGS = """
[run]
branch = true
parallel = true
patch = subprocess
data_file = {data}
source_dirs = {source}
[report]
exclude_lines =
    if TYPE_CHECKING:
"""


def files_of(part: str) -> list[Path]:
    """The source files of a part."""
    path = ROOT / "src" / "laticauda" / part
    if path.suffix:
        return [path]
    return sorted(path.glob("*.py"))


class Coverage:
    """The program coverage.py, with its settings and data in a folder.

    Args:
        folder: The folder.
    """

    def __init__(self, folder: Path) -> None:
        self._settings = folder / "settings"
        source = ROOT / "src" / "laticauda"
        self._settings.write_text(SETTINGS.format(data=folder / "data", source=source))
        path = f"{ROOT / 'src'}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
        # With CI, hypothesis draws the same every time.
        self._environment = {**os.environ, "PYTHONPATH": path, "CI": "1"}

    def call(self, verb: str, *arguments: str) -> None:
        """Call it.

        Raises:
            RuntimeError: If it fails.
        """
        program = [sys.executable, "-m", "coverage"]
        command = [*program, verb, f"--rcfile={self._settings}", *arguments]
        process = subprocess.run(
            command, cwd=ROOT, env=self._environment, capture_output=True, text=True
        )
        if process.returncode:
            output = f"{process.stdout[-3000:]}\n{process.stderr[-3000:]}"
            raise RuntimeError(f"{' '.join(command)}\n{output}")


def measure(parts: Sequence[str], *, tests: Sequence[str] = ()) -> list[Row]:
    """Run the tests of some parts, or others, under coverage.py; a row for every file.

    Raises:
        RuntimeError: If a test fails.
    """
    files: list[Path] = []
    tests_of_parts: list[str] = []
    for part in parts:
        files += files_of(part)
        tests_of_parts += TESTS[part]
    with tempfile.TemporaryDirectory() as folder:
        coverage = Coverage(Path(folder))
        report = Path(folder) / "report.json"
        pytest = ["-m", "pytest", "-q", "-p", "no:cacheprovider"]
        coverage.call("run", *pytest, *(tests or tests_of_parts))
        coverage.call("combine", "-q")
        coverage.call("json", "-q", "-o", str(report), f"--include={','.join(map(str, files))}")
        reports = json.loads(report.read_text())["files"]
    report_of_file = {Path(name).resolve(): report for name, report in reports.items()}
    return [row_of(file, report_of_file.get(file.resolve())) for file in files]


def row_of(file: Path, report: dict[str, Any] | None) -> Row:
    """What coverage.py says of a file; None: nothing of it was imported."""
    name = str(file.relative_to(ROOT))
    if report is None:
        return Row(name, 0, 0, "all", "all")
    branches = [f"{begin}->{end}" for begin, end in report["missing_branches"]]
    return Row(
        file=name,
        statements=report["summary"]["num_statements"],
        branches=report["summary"]["num_branches"],
        not_run=" ".join(map(str, report["missing_lines"])),
        branches_not_taken=" ".join(branches),
    )


def stored() -> list[dict[str, str]]:
    """The last answer."""
    with STORED.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", default="", help="part of a path")
    options = parser.parse_args()
    rows = measure([part for part in TESTS if options.only in part])
    if not options.only:
        with STORED.open("w", newline="", encoding="utf-8") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(Row._fields)
            table.writerows(rows)
    for row in rows:
        line = f"{row.file:<52} {row.statements:>4} statements {row.branches:>4} branches   "
        line += f"{row.not_run} {row.branches_not_taken}"
        print(line.rstrip())
    n_statements = sum(row.statements for row in rows)
    n_branches = sum(row.branches for row in rows)
    n_in_full = sum(not row.not_run and not row.branches_not_taken for row in rows)
    print(
        f"{n_statements} statements, {n_branches} branches; "
        f"{n_in_full} of {len(rows)} files are run in full"
    )
    return int(n_in_full < len(rows))


if __name__ == "__main__":
    sys.exit(main())
