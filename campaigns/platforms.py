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
DURATION, INTERVAL = 30.0, 0.05  # s
BOUND = 1e-12  # m, rad, m/s, N m and J
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
    words = RUNNERS.get(platform)
    if words is None:
        return "a Mac"
    if words and shutil.which(words[0]) is None:
        return words[0]
    return "" if len(words) < 3 or Path(words[2]).exists() else words[2]


def driver(platform: str, folder: Path) -> str:
    """The program in C for a platform."""
    program = folder / f"drive-{platform}.exe"
    subprocess.run(
        [*find_compiler(PLATFORMS[platform]), "-O2", str(DRIVER), "-o", str(program)], check=True
    )
    return str(program)


def error(scenario: lc.Scenario, platform: str, fmu: Path, program: str) -> float:
    """Largest difference between an FMU's library that swims and `lc.swim`."""
    folder = fmu.with_suffix("")
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder)
    root = fromstring((folder / "modelDescription.xml").read_bytes())
    number = {
        one.attrib["name"]: int(one.attrib["valueReference"]) for one in root.iter("ScalarVariable")
    }
    one = PLATFORMS[platform]
    library = (
        folder
        / "binaries"
        / one.fmi2_folder
        / f"{root.attrib['modelName']}{one.system.library_ending}"
    )
    words = [*RUNNERS[platform], program, str(library), root.attrib["guid"], str(len(number))]
    own = {"WINEPREFIX": str(fmu.parent / "wine"), "WINEDEBUG": "-all"}
    done = subprocess.run(
        [*words, str(round(DURATION / INTERVAL))],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, **own},
    )
    found = np.array([line.split() for line in done.stdout.splitlines()], dtype=float)
    trial = lc.swim(scenario, sample_interval=INTERVAL)
    worst = [np.abs(found[:, number["mechanical_work"]] - trial.work[:, 0]).max()]
    for name in VECTORS:
        columns = [
            i for variable, i in number.items() if variable.startswith((f"{name}[", f"{name}."))
        ]
        worst.append(np.abs(found[:, columns] - getattr(trial, name)).max())
    return float(max(worst))


def answers(platforms: list[str]) -> Iterator[Answer]:
    """All cases on all platforms; on a platform that cannot be run, the error is not a number."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        programs = {one: driver(one, folder) for one in platforms if not missing(one)}
        for k, (case, scenario) in enumerate(cases().items()):
            fmu = folder / f"case{k}.fmu"
            export_fmu(fmu, scenario, platform=platforms)
            for one in platforms:
                worst = error(scenario, one, fmu, programs[one]) if one in programs else math.nan
                yield Answer(platform=one, case=case, error=worst)
        yield Answer(
            platform="aarch64", case=IN_C, error=in_c(folder) if "aarch64" in programs else math.nan
        )


def in_c(folder: Path) -> float:
    """How far the program of the page on `export c` ends from the same run in Python [m, rad]."""
    (code,) = re.findall(
        r'^```c title="main.c"\n(.*?)^```$',
        PAGE.read_text(encoding="utf-8"),
        re.MULTILINE | re.DOTALL,
    )
    (folder / "main.c").write_text(code, encoding="utf-8")
    gait, water = replace(GAIT, frequency=math.radians(90)), lc.load_water("paper-lateral")
    export_c(folder / "snake.h", "mamba-fin", gait, static=True, platform="aarch64")
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", "aarch64-linux-musl"]
    subprocess.run([*zig, "main.c", "libsnake.a", "-o", "main"], cwd=folder, check=True)
    done = subprocess.run(
        [RUNNERS["aarch64"][0], "./main"], cwd=folder, capture_output=True, text=True, check=True
    )
    body: Any = lc.build_plant(lc.load_robot("mamba-fin"), replace(water, normal_drag=1.5))
    gait = replace(gait, amplitude=0.5)
    state = body.init(lc.Start(), Command(gait=gait))
    for k in range(600):
        now = Command(gait=gait if k < 200 else replace(gait, offset=0.1))
        state, _, _ = body.march(state, now, INTERVAL, INTERVAL)
    seen = body.observe(state)
    return max(
        abs(float(a) - b)
        for a, b in zip(done.stdout.split(), (*seen.center_of_mass, seen.heading), strict=True)
    )


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
    platforms = [one.name for one in PLATFORMS.values() if one.fmi2_folder]
    kept = {(one.platform, one.case): one.error for one in stored()} if STORED.exists() else {}
    found: list[Answer] = []
    for one in answers(platforms):
        lacks = missing(one.platform)
        words = f"linked, not run: it would take {lacks}" if lacks else f"{one.error:.1e}"
        before = kept.get((one.platform, one.case), math.nan)
        print(f"{one.platform:14} {one.case:24} {words} (stored: {before:.1e})", flush=True)
        found.append(one)
    if settings.write:
        with STORED.open("w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, ["platform", "case", "error"], lineterminator="\n")
            table.writeheader()
            table.writerows({**asdict(one), "error": f"{one.error:.1e}"} for one in found)
    return 0 if all(one.error < BOUND or missing(one.platform) for one in found) else 1


if __name__ == "__main__":
    sys.exit(main())
