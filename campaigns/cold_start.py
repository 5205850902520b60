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
from pathlib import Path
from typing import Any, NamedTuple

STORED, ROOT = Path(__file__).with_suffix(".csv"), Path(__file__).parent.parent
SWIM = (
    "swim --robot mamba --gait lateral-undulation "
    "--amplitude-deg 30 --frequency-deg-s 130 --phase-shift-deg 40 --json"
)
LIMITS = {"first swim": 2.5}
"""Of what is measured as multiples of the command whose kernels are there."""
WORKS, REFUSED = "works", "refused by name"
NOBODY = 65534
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
    words = [
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "-qq",
        "--no-deps",
        "--wheel-dir",
        str(folder),
        str(ROOT),
    ]
    subprocess.run(words, check=True)
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
    pip = [
        sys.executable,
        "-m",
        "pip",
        "--python",
        str(folder / "bin" / "python"),
        "install",
        "-qq",
    ]
    subprocess.run([*pip, *(["--no-deps", "--no-index"] if borrow else []), str(wheel)], check=True)
    if borrow:  # only now, or pip would find it installed
        (packages,) = folder.glob("lib/python*/site-packages")
        (packages / "borrowed.pth").write_text(sysconfig.get_path("purelib") + "\n")
    return folder / "bin"


def processor_time() -> float:
    """Of all programs that were started and have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def swim(programs: Path, cache: Path | None, **changes: Any) -> tuple[float, dict[str, Any], str]:
    """The command once: seconds of the processor, what it says, and its warnings.

    Args:
        programs: Of the environment.
        cache: Of compiled code; None: where the program finds a place.
        changes: Of `subprocess.run`.
    """
    own = {"PATH": os.environ["PATH"], "HOME": "/dev/null"}
    own |= {} if cache is None else {"NUMBA_CACHE_DIR": str(cache)}
    words = [str(programs / "laticauda"), *SWIM.split()]
    before = processor_time()
    done = subprocess.run(
        words, env=own, cwd="/", capture_output=True, text=True, check=True, **changes
    )
    return processor_time() - before, json.loads(done.stdout), done.stderr


def costs(with_kernels: Path, without: Path, folder: Path, rounds: int) -> list[Answer]:
    """The first swim, with and without the wheel's kernels, as multiples of the one that finds all compiled."""
    full = folder / "full"
    compiling, said, _ = swim(without, full)
    first: list[float] = []
    later: list[float] = []
    for k in range(rounds):
        now, same, _ = swim(with_kernels, folder / f"empty{k}")
        assert same == said, "the wheel's kernels give other numbers"
        first.append(now)
        later.append(swim(without, full)[0])
    return [
        Answer("first swim", f"{min(first) / min(later):.2f}"),
        Answer("first swim without the wheel's kernels", f"{compiling / min(later):.1f}"),
    ]


def spent(*words: str) -> float:
    """Seconds of the processor that a command takes, the least of three."""
    found: list[float] = []
    for _ in range(3):
        before = processor_time()
        subprocess.run(words, capture_output=True, check=True, cwd="/")
        found.append(processor_time() - before)
    return min(found)


def first_second(*words: str) -> dict[str, float]:
    """Where the time of a program in Python goes: its modules are imported one family after the other, then it is run.

    Args:
        words: The command.
    """
    python, *arguments = words
    done = subprocess.run(
        [python, "-X", "importtime", *arguments],
        capture_output=True,
        text=True,
        check=True,
        cwd="/",
    )
    names = re.findall(r"^import time: +\d+ \| +\d+ \| +([\w.]+)", done.stderr, re.MULTILINE)
    # The command looks for no garbage while it imports.
    imports, shares, last = "import gc, importlib, contextlib\ngc.disable()\n", {}, 0.0
    for family, own in FAMILIES.items():
        mine = [name for name in names if re.match(own, name)]
        names = [name for name in names if name not in mine]
        imports += "".join(
            f"with contextlib.suppress(ImportError): importlib.import_module({one!r})\n"
            for one in mine
        )
        now = spent(python, "-c", imports)
        shares[family], last = now - last, now
    whole = spent(*words)
    shares["kernels, swimming, printing"] = whole - last
    return {family: time / whole for family, time in shares.items()}


def elsewhere(with_kernels: Path, without: Path, folder: Path) -> list[Answer]:
    """Where little can be written, or nothing is a folder."""
    found = [Answer("no home", _quiet(swim(with_kernels, None)[2]))]
    is_root = os.geteuid() == 0
    if not is_root:
        for path in [*folder.rglob("*"), folder]:
            path.chmod(path.stat().st_mode & ~0o222)
    own: Any = {"user": NOBODY, "group": NOBODY, "extra_groups": []} if is_root else {}
    try:
        found.append(Answer("may write nowhere", _quiet(swim(with_kernels, None, **own)[2])))
        said = swim(without, None, **own)[2]
        told = said.count("compiled kernels are kept in ") == 1
        found.append(
            Answer("may write nowhere, and compiles", f"{WORKS}, and says so" if told else said)
        )
    finally:
        for path in [folder, *folder.rglob("*")] if not is_root else []:
            path.chmod(path.stat().st_mode | 0o200)
    return found


def _quiet(said: str) -> str:
    return WORKS if "kernels" not in said else said


def archived(with_kernels: Path, folder: Path) -> Answer:
    """From a zipapp."""
    (packages,) = with_kernels.parent.glob("lib/python*/site-packages")
    with zipfile.ZipFile(folder / "swim.pyz", "w") as archive:
        archive.writestr("__main__.py", "from laticauda.cli.app import main\nmain()\n")
        for path in (packages / "laticauda").rglob("*.*"):
            archive.write(path, path.relative_to(packages))
    words = [str(with_kernels / "python"), "-I", str(folder / "swim.pyz"), *SWIM.split()]
    done = subprocess.run(words, capture_output=True, text=True)
    is_named = done.returncode != 0 and "laticauda must be installed in a folder" in done.stderr
    return Answer("from an archive", REFUSED if is_named else done.stderr)


def under(python: str, folder: Path) -> Answer:
    """Another Python: built by it, installed with all packages from the index, and swum."""
    case = f"Python {re.findall(r'3[.]1[0-9]', python)[-1]}"
    if shutil.which(python) is None:
        return Answer(case, "left out: it is not here")
    try:
        programs = install(ROOT, folder, python, borrow=False)
        said = swim(programs, None)[2]
    except subprocess.CalledProcessError as error:
        return Answer(case, f"left out: {error}")
    return Answer(case, _quiet(said))


def runnable_by_all() -> str:
    """A Python of this version that another user can run, too; else this one."""
    name = "python{}.{}".format(*sys.version_info)
    for place in (os.path.realpath(sys.executable), f"/usr/bin/{name}", f"/usr/local/bin/{name}"):
        if all(
            path.stat().st_mode & 0o005 == 0o005
            for path in (Path(place), *Path(place).parents)
            if path.exists()
        ):
            if Path(place).exists():
                return place
    return sys.executable


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
        wheel, python = build(folder), runnable_by_all()
        with_kernels, without = (
            install(wheel, folder / one, python) for one in ("with", "without")
        )
        for ready in without.parent.glob("lib/python*/site-packages/laticauda/models/planar/ready"):
            shutil.rmtree(ready)
        found = costs(with_kernels, without, folder, settings.rounds)
        shares = first_second(
            str(with_kernels / "python"), str(with_kernels / "laticauda"), *SWIM.split()
        )
        found += [
            Answer(f"share of it: {one}", f"{100.0 * share:.0f} %") for one, share in shares.items()
        ]
        found += [
            *elsewhere(with_kernels, without, folder / "with"),
            archived(with_kernels, folder),
        ]
        found += [under(one, folder / f"under-{k}") for k, one in enumerate(settings.pythons)]
    kept = stored() if STORED.exists() else {}
    for case, answer in found:
        print(f"{case:40} {answer}   (stored: {kept.get(case, 'nothing')})")
    if settings.write:
        with STORED.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows([Answer._fields, *found])
    good = (WORKS, f"{WORKS}, and says so", REFUSED)
    bad = [
        one.case
        for one in found
        if one.answer not in good and not re.match(r"\d|left out", one.answer)
    ]
    bad += [case for case, limit in LIMITS.items() if float(dict(found)[case]) > limit]
    print("; ".join(bad) or "all as it should be")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
