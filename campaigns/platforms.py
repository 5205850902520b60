"""Do FMUs for other platforms swim as Python does?

Question: one FMU for all platforms is written here. A small program in C (platforms.c) loads the
library of each, lets it swim 30 s of Mamba, and prints all variables after every 0.05 s. How far is
that from `lc.swim`? And the program of the page on `export c`, linked for Linux on ARM into one
file that needs nothing?

    python campaigns/platforms.py           # beside the stored answer; what is missing here is said, and left out
    python campaigns/platforms.py --write   # writes platforms.csv

Linux on ARM runs under qemu, Windows under Wine:
`apt-get install qemu-user libc6-arm64-cross wine`. macOS is linked, and cannot be run here. The
first library for Windows takes minutes: Zig builds the C library for it.
"""

import argparse
import csv
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import fromstring

import numpy as np

import laticauda as lc
from laticauda.connect import export_c, export_fmu
from laticauda.connect.native.linking import find_compiler
from laticauda.connect.native.platforms import PLATFORMS
from laticauda.scenarios.interfaces import Command
from laticauda.values.quantities import quantity, value_class
from laticauda.values.scalars import magnitude
from laticauda.water.fluid import DragLaw

STORED = Path(__file__).with_suffix(".csv")
DRIVER = Path(__file__).with_suffix(".c")
GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(130), phase_shift=math.radians(40)
)
DURATION = 30.0
"""Duration of the swims [s]."""
INTERVAL = 0.05
"""Time between two samples [s]."""
BOUND = 1e-12
"""Difference of a number at most [SI]."""
PAGE = Path(__file__).parent.parent / "docs" / "how-to" / "c-library.md"
IN_C = "the program in C"
RUNNERS = {
    "linux64": (),
    "aarch64": ("qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"),
    "win64": ("wine",),
}
VECTORS = (
    "center_of_mass",
    "center_of_mass_velocity",
    "link_angle",
    "joint_angle",
    "joint_angle_ref",
    "joint_torque",
)


@value_class
class Washed(DragLaw):
    """A law of one's own: drag along the body sees some of the sideways speed."""

    wash: float = quantity(
        "", "Share of the sideways speed that the drag along sees", ge=0.0, default=0.2
    )

    def __call__(self, v_t: Any, v_n: Any, across: Any, rate: Any, element: Any) -> Any:
        """Loads on an element."""
        f_t = -element.c_t * v_t * (magnitude(v_t) + self.wash * across)
        return f_t, -element.c_n * v_n * magnitude(v_n), -element.lambda_3 * magnitude(rate) * rate


@dataclass(frozen=True, kw_only=True)
class Answer:
    """How near one platform comes."""

    platform: str
    case: str
    error: float
    """Largest difference of any of the numbers at any time; SI units."""


def cases() -> dict[str, lc.Scenario]:
    """What swims: in each, another part of the kernels works."""
    plain = lc.build_scenario("mamba-fin", GAIT, DURATION)
    washed = replace(lc.load_water("paper-lateral"), drag=Washed())
    return {
        "prescribed joints": plain,
        "servos": lc.build_scenario("mamba-fin", GAIT, DURATION, joints="servo"),
        "a drag law of one's own": lc.build_scenario("mamba", GAIT, DURATION, environment=washed),
    }


def missing(platform: str) -> str:
    """What is not here to run a library for a platform; nothing if all is."""
    runner = RUNNERS.get(platform)
    if runner is None:
        return "a Mac"
    if runner and shutil.which(runner[0]) is None:
        return runner[0]
    if "-L" in runner and not Path(runner[-1]).exists():
        return runner[-1]
    return ""


def driver(platform: str, folder: Path) -> str:
    """The program in C for a platform."""
    program = folder / f"drive-{platform}.exe"
    compiler = find_compiler(PLATFORMS[platform])
    subprocess.run([*compiler, "-O2", str(DRIVER), "-o", str(program)], check=True)
    return str(program)


def error(scenario: lc.Scenario, platform: str, fmu: Path, program: str) -> float:
    """Largest difference between an FMU's library that swims and `lc.swim`."""
    folder = fmu.with_suffix("")
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder)
    root = fromstring((folder / "modelDescription.xml").read_bytes())
    column_of = {
        variable.attrib["name"]: int(variable.attrib["valueReference"])
        for variable in root.iter("ScalarVariable")
    }
    target = PLATFORMS[platform]
    library_name = f"{root.attrib['modelName']}{target.system.library_ending}"
    library = folder / "binaries" / target.fmi2_folder / library_name
    n_samples = round(DURATION / INTERVAL)
    arguments = [str(library), root.attrib["guid"], str(len(column_of)), str(n_samples)]
    process = subprocess.run(
        [*RUNNERS[platform], program, *arguments],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "WINEPREFIX": str(fmu.parent / "wine"), "WINEDEBUG": "-all"},
    )
    rows = [line.split() for line in process.stdout.splitlines()]
    outputs = np.array(rows, dtype=float)
    trial = lc.swim(scenario, sample_interval=INTERVAL)
    errors = [np.abs(outputs[:, column_of["mechanical_work"]] - trial.work[:, 0]).max()]
    for name in VECTORS:
        columns = [
            column
            for variable, column in column_of.items()
            if variable.startswith((f"{name}[", f"{name}."))
        ]
        errors.append(np.abs(outputs[:, columns] - getattr(trial, name)).max())
    return float(max(errors))


def answers(platforms: list[str]) -> Iterator[Answer]:
    """All cases on all platforms; on a platform that cannot be run, the error is not a number."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        programs = {
            platform: driver(platform, folder) for platform in platforms if not missing(platform)
        }
        for k, (case, scenario) in enumerate(cases().items()):
            fmu = folder / f"case{k}.fmu"
            export_fmu(fmu, scenario, platform=platforms)
            for platform in platforms:
                largest_error = math.nan
                if platform in programs:
                    largest_error = error(scenario, platform, fmu, programs[platform])
                yield Answer(platform=platform, case=case, error=largest_error)
        error_in_c = math.nan
        if "aarch64" in programs:
            error_in_c = in_c(folder)
        yield Answer(platform="aarch64", case=IN_C, error=error_in_c)


def in_c(folder: Path) -> float:
    """How far the program of the page on `export c` ends from the same run in Python [m, rad]."""
    page = PAGE.read_text(encoding="utf-8")
    block = r'^```c title="main.c"\n(.*?)^```$'
    (code,) = re.findall(block, page, re.MULTILINE | re.DOTALL)
    (folder / "main.c").write_text(code, encoding="utf-8")
    gait, water = replace(GAIT, frequency=math.radians(90)), lc.load_water("paper-lateral")
    export_c(folder / "snake.h", "mamba-fin", gait, static=True, platform="aarch64")
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", "aarch64-linux-musl"]
    subprocess.run([*zig, "main.c", "libsnake.a", "-o", "main"], cwd=folder, check=True)
    emulator, *_ = RUNNERS["aarch64"]
    process = subprocess.run(
        [emulator, "./main"], cwd=folder, capture_output=True, text=True, check=True
    )
    end_in_c = np.array(process.stdout.split(), dtype=float)
    plant: Any = lc.build_plant(lc.load_robot("mamba-fin"), replace(water, normal_drag=1.5))
    straight = Command(gait=replace(gait, amplitude=0.5))
    turning = Command(gait=replace(gait, amplitude=0.5, offset=0.1))
    state = plant.init(lc.Start(), straight)
    for command, n_steps in ((straight, 200), (turning, 400)):
        for _ in range(n_steps):
            state, _, _ = plant.march(state, command, INTERVAL, INTERVAL)
    observation = plant.observe(state)
    end = np.array([*observation.center_of_mass, observation.heading])
    return float(np.max(np.abs(end_in_c - end)))


def stored() -> list[Answer]:
    """The answer that is kept."""
    with STORED.open(newline="", encoding="utf-8") as file:
        rows = [*csv.DictReader(file)]
    return [
        Answer(platform=row["platform"], case=row["case"], error=float(row["error"]))
        for row in rows
    ]


def main() -> int:
    """Run it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--write", action="store_true", help="write platforms.csv")
    settings = parser.parse_args()
    platforms = [platform.name for platform in PLATFORMS.values() if platform.fmi2_folder]
    errors_before: dict[tuple[str, str], float] = {}
    if STORED.exists():
        errors_before = {(answer.platform, answer.case): answer.error for answer in stored()}
    all_answers: list[Answer] = []
    for answer in answers(platforms):
        result = f"{answer.error:.1e}"
        if missing(answer.platform):
            result = f"linked, not run: it would take {missing(answer.platform)}"
        before = errors_before.get((answer.platform, answer.case), math.nan)
        print(f"{answer.platform:14} {answer.case:24} {result} (stored: {before:.1e})", flush=True)
        all_answers.append(answer)
    if settings.write:
        with STORED.open("w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, ["platform", "case", "error"], lineterminator="\n")
            table.writeheader()
            for answer in all_answers:
                table.writerow({**asdict(answer), "error": f"{answer.error:.1e}"})
    bad = [
        answer
        for answer in all_answers
        if not answer.error < BOUND and not missing(answer.platform)
    ]
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
