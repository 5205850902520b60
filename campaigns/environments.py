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

STORED, ROOT = Path(__file__).with_suffix(".csv"), Path(__file__).parent.parent
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

def known(name):
    return re.sub("[-_.]+", "-", name).lower()

def needed(name, extras, found):
    found.add((known(name), *extras))
    for requirement in map(Requirement, importlib.metadata.requires(name) or ()):
        marker = requirement.marker
        wanted = marker is None or any(marker.evaluate({"extra": extra}) for extra in extras or ("",))
        if wanted and (known(requirement.name), *requirement.extras) not in found:
            needed(requirement.name, sorted(requirement.extras), found)
    return {name for name, *_ in found}

def files(name):
    for file in importlib.metadata.files(name) or ():
        yield file.locate()
        if file.suffix == ".py":
            yield importlib.util.cache_from_source(file.locate())

def size(names):
    found = {os.path.realpath(file) for name in names for file in files(name)}
    return sum(512 * os.stat(file).st_blocks for file in found if os.path.exists(file)) / 1e6

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
        file = next(folder.glob("laticauda-*.whl"))
        with zipfile.ZipFile(file) as archive:
            (name,) = (name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
            metadata = HeaderParser().parsestr(archive.read(name).decode())
        requirements: dict[str, list[str]] = {}
        for line in metadata.get_all("Requires-Dist") or []:
            requirement, _, marker = line.partition(";")
            extra = re.search(r"extra == ['\"](\w+)", marker)
            requirements.setdefault(extra[1] if extra else "", []).append(requirement.strip())
        del requirements["all"]
        return cls(file, requirements)

    def wanted(self) -> list[str]:
        """It, and by itself whatever `[all]` requires: the oldest of what others require would be too old for them."""
        groups = [group for extra, group in self.requirements.items() if extra not in OUTSIDE]
        groups.append(
            [requirement for requirement in BESIDE["dependencies"] if requirement != "laticauda"]
        )
        return [str(self.file), *sorted({requirement for group in groups for requirement in group})]


class Environment:
    """A new one, with nothing in it.

    Args:
        folder: Where it will be.
        python: What it is made by.
        uv: The program that installs.
    """

    def __init__(self, folder: Path, python: str, uv: str) -> None:
        subprocess.run([python, "-m", "venv", "--without-pip", str(folder)], check=True)
        self.folder, self.bin, self._uv = folder, folder / "bin", uv
        self._variables = {
            name: value for name, value in os.environ.items() if not name.startswith("PYTHON")
        }
        self._variables |= {
            "NUMBA_CACHE_DIR": str(folder / "numba"),
            "PATH": f"{self.bin}{os.pathsep}{os.environ['PATH']}",
        }

    def install(self, *requirements: str, resolution: str = "highest") -> None:
        """Install from wheels, compiled as pip does it.

        Args:
            requirements: What.
            resolution: Which versions, in uv's words.
        """
        words = [
            self._uv,
            "pip",
            "install",
            "--quiet",
            "--compile-bytecode",
            "--only-binary",
            ":all:",
        ]
        words += ["--python", str(self.bin / "python"), "--resolution", resolution]
        subprocess.run([*words, *requirements], check=True)

    def _run(self, *words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(
            [str(self.bin / words[0]), *words[1:]],
            env=self._variables,
            cwd=cwd,
            capture_output=True,
            text=True,
        )
        if done.returncode:
            print(done.stdout[-20_000:], done.stderr[-5_000:], sep="\n", file=sys.stderr)
        return done

    def swim(self) -> str:
        """What the program says when it does what it is for."""
        done = self._run("laticauda", *SWIM.split(), cwd=self.folder)
        return (
            f"{json.loads(done.stdout)['forward_velocity']:.4f} m/s"
            if done.returncode == 0
            else "fails"
        )

    def test(self, words: list[str], *, strict: bool) -> str:
        """How the tests end, without their time.

        Args:
            words: Files and options.
            strict: Whether a warning is an error.
        """
        options = [
            "-q",
            "-p",
            "no:cacheprovider",
            "-m",
            "not slow",
            *([] if strict else ["-o", "filterwarnings="]),
        ]
        done = self._run("python", "-m", "pytest", *options, *words, cwd=ROOT)
        ends = re.findall(
            r"^\W*(\d+ (?:passed|failed|error).*?) in [\d.]+s", done.stdout, re.MULTILINE
        )
        return ends[-1] if ends else f"exit status {done.returncode}"

    def weights(self, extras: list[str]) -> dict[str, str]:
        """MB of the plain package with what it needs, of all, and of what each extra adds.

        Args:
            extras: Their names.
        """
        done = self._run("python", "-c", WEIGHTS, *extras, cwd=self.folder)
        done.check_returncode()
        return {name: f"{size:.0f} MB" for name, size in json.loads(done.stdout).items()}


def installer(folder: Path) -> str:
    """The program uv, found or installed.

    Args:
        folder: Where it is put if it is missing.
    """
    if found := shutil.which("uv"):
        return found
    subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
    subprocess.run(
        [str(folder / "bin" / "python"), "-m", "pip", "install", "-qq", "uv"], check=True
    )
    return str(folder / "bin" / "uv")


def starts(python: str) -> bool:
    """Whether a Python is there, and not only its name."""
    return (
        bool(shutil.which(python))
        and subprocess.run([python, "-c", ""], capture_output=True).returncode == 0
    )


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
        uv, wheel = installer(folder / "uv"), Wheel.built(folder)
        sizes: dict[str, str] = {}
        for python in pythons:
            for resolution in resolutions:
                one = Environment(folder / "one", python, uv)
                one.install(*wheel.wanted(), resolution=RESOLUTIONS[resolution])
                if resolution == "newest" and not sizes:
                    sizes = one.weights(
                        [extra for extra in wheel.requirements if extra and extra not in OUTSIDE]
                    )
                one.install(*TOOLS)
                yield f"{python}, {resolution}: swim", one.swim()
                yield (
                    f"{python}, {resolution}: tests",
                    one.test(tests, strict=resolution == "newest"),
                )
                shutil.rmtree(one.folder)
        for extra in weigh:
            one = Environment(folder / "one", pythons[0], uv)
            one.install(f"{wheel.file}[{extra}]")
            sizes[extra] = one.weights([extra])[extra]
            shutil.rmtree(one.folder)
        yield from ((f"size of {extra}", size) for extra, size in sizes.items())


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
    args = parser.parse_args()
    before, bad = stored(), False
    found = [python for python in args.pythons if starts(python)]
    print(f"Not here: {', '.join({*args.pythons} - {*found}) or 'nothing'}.")
    now: dict[str, str] = {}
    for case, answer in answers(
        found, [args.only] if args.only else [*RESOLUTIONS], args.weigh, args.tests
    ):
        print(f"{case:30} {answer:50} {before.get(case, '')}", flush=True)
        now[case] = answer
        bad |= "fail" in answer or "error" in answer or "exit" in answer
    if args.write:
        with STORED.open("w", newline="", encoding="utf-8") as lines:
            csv.writer(lines, lineterminator="\n").writerows(
                [("case", "answer"), *sorted((before | now).items())]
            )
    sys.exit(bad)


if __name__ == "__main__":
    main()
