"""What does the first `laticauda swim` cost after an installation, and where does it run at all?

A wheel is built and installed into new environments. In turns: the first swim with empty caches,
and the same of an installation without the wheel's kernels, whose caches are full. Then the same
command without a home, as another user who may write nowhere, from an archive (refused by name),
and under other Pythons. And what the first second goes into.

    python campaigns/cold_start.py            # beside the stored answer; what is missing here is said, and left out
    python campaigns/cold_start.py --write    # writes cold_start.csv
    python campaigns/cold_start.py --pythons python3.12 python3.13

Takes three minutes, and some more per further Python, which gets all packages from the index. Times
are those of the processor, the least of several; another user is tried by root only, for others the
environment is made read-only.
"""

import argparse
import contextlib
import csv
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

STORED = Path(__file__).with_suffix(".csv")
ROOT = Path(__file__).parent.parent
SWIM = (
    "swim --robot mamba --gait lateral-undulation "
    "--amplitude-deg 30 --frequency-deg-s 130 --phase-shift-deg 40 --json"
)
LIMITS = {"first swim": 2.5}
"""Of what is measured as multiples of the command whose kernels are there."""
WORKS = "works"
WORKS_AND_SAYS_SO = f"{WORKS}, and says so"
REFUSED = "refused by name"
NOBODY = 65534
"""Number of a user who owns nothing."""
FAMILIES = {
    "Python": "(?!)",
    "NumPy": "numpy",
    "Numba": "numba|llvmlite",
    "other packages": "(?!laticauda)",
    "laticauda": r"laticauda(?!_)",  # but for kernels' own modules
}
"""What is imported, by names that match."""
OTHERS = ("python3.11", "python3.12", "python3.13", "python3.14")


class Answer(NamedTuple):
    """What came out of a case."""

    case: str
    answer: str
    """A ratio, a share, or a word."""


def build(folder: Path) -> Path:
    """The wheel of these sources, by an environment of its own for the build."""
    options = ["-qq", "--no-deps", "--wheel-dir", str(folder)]
    subprocess.run([sys.executable, "-m", "pip", "wheel", *options, str(ROOT)], check=True)
    return next(folder.glob("laticauda-*.whl"))


def install(
    wheel: Path, folder: Path, python: str = sys.executable, *, borrow: bool = True
) -> Path:
    """A new environment with the wheel; returns its folder of programs.

    Args:
        wheel: Of the package.
        folder: Of the environment.
        python: Whose it is.
        borrow: Whether all else comes from the packages of the Python that runs this.
    """
    subprocess.run([python, "-m", "venv", "--without-pip", str(folder)], check=True)
    pip = [sys.executable, "-m", "pip", "--python", str(folder / "bin" / "python")]
    options = ["-qq"]
    if borrow:
        options += ["--no-deps", "--no-index"]
    subprocess.run([*pip, "install", *options, str(wheel)], check=True)
    if borrow:  # only now, or pip would find it installed
        (packages,) = folder.glob("lib/python*/site-packages")
        (packages / "borrowed.pth").write_text(sysconfig.get_path("purelib") + "\n")
    return folder / "bin"


def processor_time() -> float:
    """Of all programs that were started and have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Swim(NamedTuple):
    """What the command did."""

    seconds: float
    """Time of the processor [s]."""
    facts: dict[str, Any]
    """What it printed."""
    warnings: str


def swim(programs: Path, cache: Path | None, **changes: Any) -> Swim:
    """Run the command once.

    Args:
        programs: Of the environment.
        cache: Of compiled code; None: where the program finds a place.
        changes: Of `subprocess.run`.
    """
    environment = {"PATH": os.environ["PATH"], "HOME": "/dev/null"}
    if cache is not None:
        environment["NUMBA_CACHE_DIR"] = str(cache)
    command = [str(programs / "laticauda"), *SWIM.split()]
    before = processor_time()
    process = subprocess.run(
        command, env=environment, cwd="/", capture_output=True, text=True, check=True, **changes
    )
    return Swim(processor_time() - before, json.loads(process.stdout), process.stderr)


def costs(with_kernels: Path, without: Path, folder: Path, rounds: int) -> list[Answer]:
    """The first swim, with and without the wheel's kernels, as multiples of the one that finds all compiled."""
    full_cache = folder / "full"
    compiling = swim(without, full_cache)
    seconds_of_first: list[float] = []
    seconds_of_later: list[float] = []
    for k in range(rounds):
        first = swim(with_kernels, folder / f"empty{k}")
        assert first.facts == compiling.facts, "the wheel's kernels give other numbers"
        later = swim(without, full_cache)
        seconds_of_first.append(first.seconds)
        seconds_of_later.append(later.seconds)
    least = min(seconds_of_later)
    return [
        Answer("first swim", f"{min(seconds_of_first) / least:.2f}"),
        Answer("first swim without the wheel's kernels", f"{compiling.seconds / least:.1f}"),
    ]


def least_time(*words: str) -> float:
    """Seconds of the processor that a command takes, the least of three."""
    seconds: list[float] = []
    for _ in range(3):
        before = processor_time()
        subprocess.run(words, capture_output=True, check=True, cwd="/")
        seconds.append(processor_time() - before)
    return min(seconds)


def first_second(*words: str) -> dict[str, float]:
    """Where the time of a program in Python goes: its modules are imported one family after the other, then it is run.

    Args:
        words: The command.
    """
    python, *arguments = words
    process = subprocess.run(
        [python, "-X", "importtime", *arguments],
        capture_output=True,
        text=True,
        check=True,
        cwd="/",
    )
    line = r"^import time: +\d+ \| +\d+ \| +([\w.]+)"
    modules = re.findall(line, process.stderr, re.MULTILINE)
    # The command looks for no garbage while it imports.
    imports = "import gc, importlib, contextlib\ngc.disable()\n"
    seconds: dict[str, float] = {}
    total = 0.0
    for family, pattern in FAMILIES.items():
        of_family = [module for module in modules if re.match(pattern, module)]
        modules = [module for module in modules if module not in of_family]
        for module in of_family:
            imports += "with contextlib.suppress(ImportError): "
            imports += f"importlib.import_module({module!r})\n"
        total_with_family = least_time(python, "-c", imports)
        seconds[family] = total_with_family - total
        total = total_with_family
    whole = least_time(*words)
    seconds["kernels, swimming, printing"] = whole - total
    return {part: time / whole for part, time in seconds.items()}


def elsewhere(with_kernels: Path, without: Path, folder: Path) -> list[Answer]:
    """Where little can be written, or nothing is a folder."""
    no_home = swim(with_kernels, None)
    with writing_nowhere(folder) as user:
        ready = swim(with_kernels, None, **user)
        compiling = swim(without, None, **user)
    answer_of_compiling = compiling.warnings
    if compiling.warnings.count("compiled kernels are kept in ") == 1:
        answer_of_compiling = WORKS_AND_SAYS_SO
    return [
        Answer("no home", works_silently(no_home)),
        Answer("may write nowhere", works_silently(ready)),
        Answer("may write nowhere, and compiles", answer_of_compiling),
    ]


@contextlib.contextmanager
def writing_nowhere(folder: Path) -> Iterator[dict[str, Any]]:
    """Who runs a command that may not write there: another user, or this one, for whom the folder is read-only."""
    if os.geteuid() == 0:
        yield {"user": NOBODY, "group": NOBODY, "extra_groups": []}
        return
    for path in [*folder.rglob("*"), folder]:
        path.chmod(path.stat().st_mode & ~0o222)
    try:
        yield {}
    finally:
        for path in [folder, *folder.rglob("*")]:
            path.chmod(path.stat().st_mode | 0o200)


def works_silently(swim: Swim) -> str:
    """That it works, or what it says of kernels."""
    if "kernels" in swim.warnings:
        return swim.warnings
    return WORKS


def archived(with_kernels: Path, folder: Path) -> Answer:
    """From a zipapp."""
    (packages,) = with_kernels.parent.glob("lib/python*/site-packages")
    with zipfile.ZipFile(folder / "swim.pyz", "w") as archive:
        archive.writestr("__main__.py", "from laticauda.cli.app import main\nmain()\n")
        for path in (packages / "laticauda").rglob("*.*"):
            archive.write(path, path.relative_to(packages))
    command = [str(with_kernels / "python"), "-I", str(folder / "swim.pyz"), *SWIM.split()]
    process = subprocess.run(command, capture_output=True, text=True)
    is_named = "laticauda must be installed in a folder" in process.stderr
    if process.returncode != 0 and is_named:
        return Answer("from an archive", REFUSED)
    return Answer("from an archive", process.stderr)


def under(python: str, folder: Path) -> Answer:
    """Another Python: built by it, installed with all packages from the index, and swum."""
    case = f"Python {re.findall(r'3[.]1[0-9]', python)[-1]}"
    if shutil.which(python) is None:
        return Answer(case, "left out: it is not here")
    try:
        programs = install(ROOT, folder, python, borrow=False)
        return Answer(case, works_silently(swim(programs, None)))
    except subprocess.CalledProcessError as error:
        return Answer(case, f"left out: {error}")


def runnable_by_all() -> str:
    """A Python of this version that another user can run, too; else this one."""
    name = "python{}.{}".format(*sys.version_info)
    for place in (os.path.realpath(sys.executable), f"/usr/bin/{name}", f"/usr/local/bin/{name}"):
        program = Path(place)
        if program.exists() and all(map(is_open_to_all, (program, *program.parents))):
            return place
    return sys.executable


def is_open_to_all(path: Path) -> bool:
    """Whether any user may read and enter or run it."""
    return path.stat().st_mode & 0o005 == 0o005


def stored() -> dict[str, str]:
    """The answer that is kept, by cases."""
    with STORED.open(newline="", encoding="utf-8") as file:
        return {row["case"]: row["answer"] for row in csv.DictReader(file)}


def main() -> int:
    """Do it, and say what came out; 1 if something is beyond its limit, or does not work."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write cold_start.csv")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--pythons", nargs="*", default=OTHERS)
    settings = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        answers = ask_all(folder, settings.rounds, settings.pythons)
    answers_before: dict[str, str] = {}
    if STORED.exists():
        answers_before = stored()
    for case, answer in answers:
        print(f"{case:40} {answer}   (stored: {answers_before.get(case, 'nothing')})")
    if settings.write:
        with STORED.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows([Answer._fields, *answers])
    bad = bad_cases(answers)
    print("; ".join(bad) or "all as it should be")
    return 1 if bad else 0


def ask_all(folder: Path, rounds: int, pythons: Sequence[str]) -> list[Answer]:
    """The answers to all questions."""
    wheel = build(folder)
    python = runnable_by_all()
    with_kernels = install(wheel, folder / "with", python)
    without = install(wheel, folder / "without", python)
    for ready in without.parent.glob("lib/python*/site-packages/laticauda/models/planar/ready"):
        shutil.rmtree(ready)
    answers = costs(with_kernels, without, folder, rounds)
    command = [str(with_kernels / "python"), str(with_kernels / "laticauda"), *SWIM.split()]
    for part, share in first_second(*command).items():
        answers.append(Answer(f"share of it: {part}", f"{100.0 * share:.0f} %"))
    answers += elsewhere(with_kernels, without, folder / "with")
    answers.append(archived(with_kernels, folder))
    for k, other_python in enumerate(pythons):
        answers.append(under(other_python, folder / f"under-{k}"))
    return answers


def bad_cases(answers: Sequence[Answer]) -> list[str]:
    """Cases that are beyond their limit, or do not work."""
    bad: list[str] = []
    for case, answer in answers:
        is_number_or_left_out = re.match(r"\d|left out", answer)
        if answer not in (WORKS, WORKS_AND_SAYS_SO, REFUSED) and not is_number_or_left_out:
            bad.append(case)
    answer_of_case = dict(answers)
    return bad + [case for case, limit in LIMITS.items() if float(answer_of_case[case]) > limit]


if __name__ == "__main__":
    sys.exit(main())
