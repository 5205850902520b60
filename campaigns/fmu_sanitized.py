"""Does the C code of an FMU touch memory that is not its own, or do what C leaves undefined?

The code of FMUs of FMI 2.0 and 3.0 is built with gcc's address and undefined-behaviour sanitizers
(leaks too), and a program in C, built alike, calls it at random: three instances in any order of
states, references that are none, numbers that are none, states kept, restored, packed, damaged, cut
and unpacked. The first report ends the program.

    python campaigns/fmu_sanitized.py                  # 100 000 calls, half of them to each

The tests run a slice of it.

Last answer (gcc 12, x86-64):
    FMI 2.0: 50000 calls, 1615 steps, 21095 refused, 0 unknown answers, 0 reports
    FMI 3.0: 50000 calls, 942 steps, 22548 refused, 0 unknown answers, 0 reports
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import laticauda as lc
from laticauda.connect import export_fmu

DRIVER = Path(__file__).with_suffix(".c")
GCC = "gcc -g -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=all"
VERSIONS = ("2.0", "3.0")
TOKEN = re.compile(r'(?:guid|instantiationToken)="([^"]+)"')


def is_possible() -> bool:
    """Whether there is a compiler with sanitizers."""
    return shutil.which("gcc") is not None and sys.platform == "linux"


def called(version: str, calls: int, seed: int, folder: Path) -> str:
    """Call an FMU so often: what the program says at its end.

    Raises:
        RuntimeError: If a sanitizer has something to report; with its words.
    """
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
    fmu, before = folder / "robot.fmu", os.environ.get("CC")
    os.environ["CC"] = GCC
    try:
        export_fmu(fmu, lc.build_scenario("mamba", gait, 1.0), fmi=version)
    finally:
        os.environ.pop("CC")
        if before is not None:
            os.environ["CC"] = before
    with zipfile.ZipFile(fmu) as archive:
        (name,) = (one for one in archive.namelist() if one.endswith(".so"))
        (folder / "robot.so").write_bytes(archive.read(name))
        found = TOKEN.search(archive.read("modelDescription.xml").decode())
    assert found is not None
    driver = folder / "driver"
    subprocess.run([*GCC.split(), str(DRIVER), "-o", str(driver), "-ldl", "-lm"], check=True)
    words = [str(driver), str(folder / "robot.so"), found[1], version, str(calls), str(seed)]
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode != 0 or done.stderr:
        raise RuntimeError(
            f"FMI {version}, seed {seed}, status {done.returncode}:\n{done.stderr[-6000:]}"
        )
    return done.stdout.strip()


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--calls", type=int, default=50_000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if not is_possible():
        print("needs gcc on Linux")
        return
    for version in VERSIONS:
        with tempfile.TemporaryDirectory() as folder:
            told = called(version, options.calls, options.seed, Path(folder))
            print(f"    FMI {version}: {told}, 0 reports", flush=True)


if __name__ == "__main__":
    main()
