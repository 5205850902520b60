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

ROOT = Path(__file__).parents[1]
STORED = Path(__file__).with_suffix(".csv")
TESTS = {
    "tank/operate/safety": ("tests/tank/operate/safety",),
    "tank/operate/verdict": ("tests/tank/operate/test_verdict.py",),
    "tank/operate/recording": ("tests/tank/operate/recording",),
    "tank/protocol": ("tests/tank/protocol",),
}
"""The safety code, in laticauda, and its tests."""
COLUMNS = ("file", "statements", "branches", "not_run", "branches_not_taken")
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
    return [path] if path.suffix else sorted(path.glob("*.py"))


def measured(
    parts: Sequence[str], *, tests: Sequence[str] = ()
) -> list[tuple[str, int, int, str, str]]:
    """Run the tests of some parts, or others, under coverage.py; a row for every file.

    Raises:
        RuntimeError: If a test fails.
    """
    chosen = tests or [test for part in parts for test in TESTS[part]]
    with tempfile.TemporaryDirectory() as folder:
        settings, data, told = (Path(folder) / name for name in ("settings", "data", "told.json"))
        settings.write_text(SETTINGS.format(data=data, source=ROOT / "src" / "laticauda"))
        path = f"{ROOT / 'src'}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
        surroundings = {
            **os.environ,
            "PYTHONPATH": path,
            "CI": "1",
        }  # hypothesis then draws the same every time

        def coverage(*words: str) -> str:
            command = [
                sys.executable,
                "-m",
                "coverage",
                words[0],
                f"--rcfile={settings}",
                *words[1:],
            ]
            done = subprocess.run(
                command, cwd=ROOT, env=surroundings, capture_output=True, text=True
            )
            if done.returncode:
                raise RuntimeError(
                    f"{' '.join(command)}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
                )
            return done.stdout

        coverage("run", "-m", "pytest", "-q", "-p", "no:cacheprovider", *chosen)
        coverage("combine", "-q")
        files = [file for part in parts for file in files_of(part)]
        coverage("json", "-q", "-o", str(told), f"--include={','.join(map(str, files))}")
        found = {
            Path(name).resolve(): one for name, one in json.loads(told.read_text())["files"].items()
        }
    rows = list[tuple[str, int, int, str, str]]()
    for file in files:
        one = found.get(file.resolve())
        if one is None:  # nothing of it was imported
            rows.append((str(file.relative_to(ROOT)), 0, 0, "all", "all"))
            continue
        lines = " ".join(map(str, one["missing_lines"]))
        branches = " ".join(f"{a}->{b}" for a, b in one["missing_branches"])
        summary = one["summary"]
        rows.append(
            (
                str(file.relative_to(ROOT)),
                summary["num_statements"],
                summary["num_branches"],
                lines,
                branches,
            )
        )
    return rows


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
    rows = measured([part for part in TESTS if options.only in part])
    if not options.only:
        with STORED.open("w", newline="", encoding="utf-8") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(COLUMNS)
            table.writerows(rows)
    for name, statements, branches, lines, ways in rows:
        print(
            f"{name:<52} {statements:>4} statements {branches:>4} branches   {lines} {ways}".rstrip()
        )
    n, n_branches = (sum(row[i] for row in rows) for i in (1, 2))
    left = [row for row in rows if row[3] or row[4]]
    print(
        f"{n} statements, {n_branches} branches; {len(rows) - len(left)} of {len(rows)} files are run in full"
    )
    return int(bool(left))


if __name__ == "__main__":
    sys.exit(main())
