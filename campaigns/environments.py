"""Does laticauda work with the oldest and the newest packages that it allows, on every Python here? And its weight?

A wheel is built, and goes for each Python into two new environments with all that `[all]` has: in
one, every package that `pyproject.toml` names, or that of `plugins/laticauda-gym`, is the oldest
that it allows and that has a wheel for that Python, in the other the newest. There the program
swims, and the tests that touch those packages run against the wheel; old packages may warn of newer
ones. In the first of the newest, every extra is weighed.

    python campaigns/environments.py                                  # beside the stored answer
    python campaigns/environments.py --write                          # writes environments.csv
    python campaigns/environments.py --weigh export                   # the large one, too
    python campaigns/environments.py --pythons python3.12 --only lowest --tests tests/trials/logs -x

Pythons are those called python3.11 to python3.14 that start. The package `uv` resolves and
installs; where it is missing, it is installed into the temporary folder. An environment takes five
minutes, most of it the tests.
"""

import argparse
import csv
import itertools
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from collections.abc import Iterator
from email.parser import HeaderParser
from pathlib import Path
from typing import NamedTuple

STORED = Path(__file__).with_suffix(".csv")
ROOT = Path(__file__).parent.parent
PYTHONS = [f"python3.{minor}" for minor in (11, 12, 13, 14)]
RESOLUTIONS = {"lowest": "lowest-direct", "newest": "highest"}
OUTSIDE = ("export",)
"""Extras that `[all]` has not."""
SWIM = (
    "swim --robot mamba --gait lateral-undulation "
    "--amplitude-deg 30 --frequency-deg-s 130 --phase-shift-deg 40 --json"
)
TOOLS = [
    "beartype>=0.20,<0.24",
    "cantools>=45,<46",
    "cma",
    "hypothesis>=6.130,<7",
    "pytest>=8.3,<10",
    "ziglang>=0.17,<0.18",
]
"""What the tests need beside the package."""
TESTS = """
tests/cli/test_app.py tests/cli/test_swim.py tests/cli/test_sweep.py tests/cli/test_optimize.py tests/studies
tests/show/cockpit/test_pages.py tests/compiling/test_lanes.py tests/control/mpc/test_predictive.py
plugins/laticauda-gym/tests tests/show/figures/test_swim.py tests/identify/test_uncertainty.py tests/trials/logs
tests/water/mujoco/test_water.py tests/tank/operate/drivers tests/show/reports/test_page.py
tests/models/simulate/test_reference_numbers.py tests/trials
""".split()
"""Those that touch other packages."""
BESIDE = tomllib.loads((ROOT / "plugins/laticauda-gym/pyproject.toml").read_text(encoding="utf-8"))[
    "project"
]
"""A distribution whose tests are among them, and use nothing more of it than its sources."""
WEIGHTS = """
import importlib.metadata, importlib.util, json, os, re, sys
from packaging.requirements import Requirement

def normal_name(name):
    return re.sub("[-_.]+", "-", name).lower()

def is_needed(requirement, extras):
    marker = requirement.marker
    return marker is None or any(marker.evaluate({"extra": extra}) for extra in extras or ("",))

def needed(name, extras, visited):
    visited.add((normal_name(name), *extras))
    for requirement in map(Requirement, importlib.metadata.requires(name) or ()):
        is_new = (normal_name(requirement.name), *requirement.extras) not in visited
        if is_new and is_needed(requirement, extras):
            needed(requirement.name, sorted(requirement.extras), visited)
    return {name for name, *_ in visited}

def files(name):
    for file in importlib.metadata.files(name) or ():
        yield file.locate()
        if file.suffix == ".py":
            yield importlib.util.cache_from_source(file.locate())

def size(names):
    paths = {os.path.realpath(file) for name in names for file in files(name)}
    return sum(512 * os.stat(path).st_blocks for path in paths if os.path.exists(path)) / 1e6

plain = needed("laticauda", (), set())
weights = {"plain": size(plain), "all": size(needed("laticauda", ("all",), set()))}
weights |= {extra: size(needed("laticauda", (extra,), set()) - plain) for extra in sys.argv[1:]}
print(json.dumps(weights))
"""
"""Run in an environment: MB of files, compiled ones too; of an extra, what it adds to the plain package."""


class Wheel(NamedTuple):
    """The package as it is installed."""

    file: Path
    requirements: dict[str, list[str]]
    """By extra; "" is what all have."""

    @classmethod
    def built(cls, folder: Path) -> "Wheel":
        """Of these sources.

        Args:
            folder: Where it is put.
        """
        options = ["-qq", "--no-deps", "--wheel-dir", str(folder)]
        subprocess.run([sys.executable, "-m", "pip", "wheel", *options, str(ROOT)], check=True)
        file = next(folder.glob("laticauda-*.whl"))
        with zipfile.ZipFile(file) as archive:
            (name,) = (name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
            metadata = HeaderParser().parsestr(archive.read(name).decode())
        requirements: dict[str, list[str]] = {}
        for line in metadata.get_all("Requires-Dist") or []:
            requirement, _, marker = line.partition(";")
            match = re.search(r"extra == ['\"](\w+)", marker)
            extra = ""
            if match:
                extra = match[1]
            requirements.setdefault(extra, []).append(requirement.strip())
        del requirements["all"]
        return cls(file, requirements)

    def to_install(self) -> list[str]:
        """It, and by itself whatever `[all]` requires: the oldest of what others require would be too old for them."""
        requirements = set(BESIDE["dependencies"]) - {"laticauda"}
        for extra, requirements_of_extra in self.requirements.items():
            if extra not in OUTSIDE:
                requirements.update(requirements_of_extra)
        return [str(self.file), *sorted(requirements)]


class Environment:
    """A new one, with nothing in it.

    Args:
        folder: Where it will be.
        python: What it is made by.
        uv: The program that installs.
    """

    def __init__(self, folder: Path, python: str, uv: str) -> None:
        subprocess.run([python, "-m", "venv", "--without-pip", str(folder)], check=True)
        self.folder = folder
        self.bin = folder / "bin"
        self._uv = uv
        self._variables = {
            name: value for name, value in os.environ.items() if not name.startswith("PYTHON")
        }
        self._variables["NUMBA_CACHE_DIR"] = str(folder / "numba")
        self._variables["PATH"] = f"{self.bin}{os.pathsep}{os.environ['PATH']}"

    def install(self, *requirements: str, resolution: str = "highest") -> None:
        """Install from wheels, compiled as pip does it.

        Args:
            requirements: What.
            resolution: Which versions, in uv's words.
        """
        options = ["--quiet", "--compile-bytecode", "--only-binary", ":all:"]
        options += ["--python", str(self.bin / "python"), "--resolution", resolution]
        subprocess.run([self._uv, "pip", "install", *options, *requirements], check=True)

    def _run(self, program: str, *words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
        process = subprocess.run(
            [str(self.bin / program), *words],
            env=self._variables,
            cwd=cwd,
            capture_output=True,
            text=True,
        )
        if process.returncode:
            print(process.stdout[-20_000:], process.stderr[-5_000:], sep="\n", file=sys.stderr)
        return process

    def swim(self) -> str:
        """What the program says when it does what it is for."""
        process = self._run("laticauda", *SWIM.split(), cwd=self.folder)
        if process.returncode != 0:
            return "fails"
        return f"{json.loads(process.stdout)['forward_velocity']:.4f} m/s"

    def test(self, words: list[str], *, strict: bool) -> str:
        """How the tests end, without their time.

        Args:
            words: Files and options.
            strict: Whether a warning is an error.
        """
        options = ["-q", "-p", "no:cacheprovider", "-m", "not slow"]
        if not strict:
            options += ["-o", "filterwarnings="]
        process = self._run("python", "-m", "pytest", *options, *words, cwd=ROOT)
        last_line = r"^\W*(\d+ (?:passed|failed|error).*?) in [\d.]+s"
        summaries = re.findall(last_line, process.stdout, re.MULTILINE)
        if not summaries:
            return f"exit status {process.returncode}"
        return summaries[-1]

    def weights(self, extras: list[str]) -> dict[str, str]:
        """MB of the plain package with what it needs, of all, and of what each extra adds.

        Args:
            extras: Their names.
        """
        process = self._run("python", "-c", WEIGHTS, *extras, cwd=self.folder)
        process.check_returncode()
        return {name: f"{size:.0f} MB" for name, size in json.loads(process.stdout).items()}


def installer(folder: Path) -> str:
    """The program uv, found or installed.

    Args:
        folder: Where it is put if it is missing.
    """
    uv = shutil.which("uv")
    if uv:
        return uv
    subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
    python = str(folder / "bin" / "python")
    subprocess.run([python, "-m", "pip", "install", "-qq", "uv"], check=True)
    return str(folder / "bin" / "uv")


def starts(python: str) -> bool:
    """Whether a Python is there, and not only its name."""
    if not shutil.which(python):
        return False
    return subprocess.run([python, "-c", ""], capture_output=True).returncode == 0


def answers(
    pythons: list[str], resolutions: list[str], weigh: list[str], tests: list[str]
) -> Iterator[tuple[str, str]]:
    """Every case with what came out of it.

    Args:
        pythons: Those that start.
        resolutions: Of `RESOLUTIONS`.
        weigh: Extras that `[all]` has not, to be weighed.
        tests: Words for pytest.
    """
    with tempfile.TemporaryDirectory(prefix="laticauda-environments-") as name:
        folder = Path(name)
        uv = installer(folder / "uv")
        wheel = Wheel.built(folder)
        extras = [extra for extra in wheel.requirements if extra and extra not in OUTSIDE]
        sizes: dict[str, str] = {}
        for python, resolution in itertools.product(pythons, resolutions):
            environment = Environment(folder / "environment", python, uv)
            environment.install(*wheel.to_install(), resolution=RESOLUTIONS[resolution])
            if resolution == "newest" and not sizes:
                sizes = environment.weights(extras)
            environment.install(*TOOLS)
            case = f"{python}, {resolution}"
            yield f"{case}: swim", environment.swim()
            yield f"{case}: tests", environment.test(tests, strict=resolution == "newest")
            shutil.rmtree(environment.folder)
        for extra in weigh:
            environment = Environment(folder / "environment", pythons[0], uv)
            environment.install(f"{wheel.file}[{extra}]")
            sizes[extra] = environment.weights([extra])[extra]
            shutil.rmtree(environment.folder)
        for extra, size in sizes.items():
            yield f"size of {extra}", size


def stored() -> dict[str, str]:
    """The last answer that was written, by case."""
    if not STORED.exists():
        return {}
    with STORED.open(newline="", encoding="utf-8") as lines:
        return {row["case"]: row["answer"] for row in csv.DictReader(lines)}


def main() -> None:
    """Print each answer beside the stored one; exit status 1 if something fails."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--pythons", nargs="+", default=PYTHONS)
    parser.add_argument("--only", choices=RESOLUTIONS, help="one of the two kinds")
    parser.add_argument(
        "--weigh",
        nargs="*",
        default=[],
        choices=OUTSIDE,
        help="extras to be weighed beside the others",
    )
    parser.add_argument(
        "--write", action="store_true", help=f"into {STORED.name}, beside what other Pythons gave"
    )
    parser.add_argument(
        "--tests",
        nargs=argparse.REMAINDER,
        default=TESTS,
        help="other words for pytest; the last option",
    )
    options = parser.parse_args()
    pythons = [python for python in options.pythons if starts(python)]
    print(f"Not here: {', '.join({*options.pythons} - {*pythons}) or 'nothing'}.")
    resolutions = list(RESOLUTIONS)
    if options.only:
        resolutions = [options.only]
    answers_before = stored()
    answers_now: dict[str, str] = {}
    for case, answer in answers(pythons, resolutions, options.weigh, options.tests):
        print(f"{case:30} {answer:50} {answers_before.get(case, '')}", flush=True)
        answers_now[case] = answer
    if options.write:
        rows = sorted((answers_before | answers_now).items())
        with STORED.open("w", newline="", encoding="utf-8") as lines:
            csv.writer(lines, lineterminator="\n").writerows([("case", "answer"), *rows])
    sys.exit(any(map(is_failure, answers_now.values())))


def is_failure(answer: str) -> bool:
    return "fail" in answer or "error" in answer or "exit" in answer


if __name__ == "__main__":
    main()
