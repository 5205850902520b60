"""Does the extra `spatial` live beside the other users of MuJoCo, each in a fresh environment of its own?

Installs laticauda[spatial] with each by pip, looks that the library that runs is the one that is
imported, and runs `campaigns/strangers.py` there. dm_control 1.0.50 does not work with MuJoCo 4, so
it gets 3.17.

Last answer, of 2026-11-22 (each ran the script to its end):

    mujoco                 4.0.0, no broken requirements
    gymnasium[mujoco]      4.0.0, no broken requirements
    mujoco-warp            4.0.0, no broken requirements
    dm-control mujoco<4    3.17.0, no broken requirements
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parent.parent
NEIGHBOURS = (["mujoco"], ["gymnasium[mujoco]"], ["mujoco-warp"], ["dm-control", "mujoco<4"])
PROBE = """
import mujoco
from laticauda.water.mujoco import native
assert native.library().mj_version() == mujoco.mj_version()
print(mujoco.__version__)
"""


def main() -> None:
    """One environment after the other; a failure ends it."""
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    for packages in NEIGHBOURS:
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, "-m", "venv", folder], check=True)
            python = str(Path(folder, "bin", "python"))
            subprocess.run(
                [python, "-m", "pip", "install", "--quiet", f"{ROOT}[spatial]", *packages],
                check=True,
            )
            for line in (
                ["-m", "pip", "check"],
                ["-c", PROBE],
                [str(ROOT / "campaigns" / "strangers.py")],
            ):
                done = subprocess.run(
                    [python, *line], check=True, capture_output=True, text=True, env=clean
                )
                print(" ".join(packages), done.stdout.strip(), sep=": ", flush=True)


if __name__ == "__main__":
    main()
