"""Compiles the kernels of single runs into a wheel, where what they need is at hand; else there are none in it."""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SCRIPT = """
import sys
from pathlib import Path
sys.path[:0] = sys.argv[2:]
import laticauda as lc
from laticauda.compiling import ready
gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
scenarios = [lc.build_scenario(robot, gait) for robot in ("mamba", "amphibot")]
scenarios += [lc.build_scenario("mamba", gait, environment=lc.load_ground(name)) for name in ("viscous", "coulomb")]
for scenario in scenarios:
    plant = lc.build_plant(scenario)
    plant.march(plant.init(lc.Start(), lc.Command(gait=gait)), lc.Command(gait=gait), 1.0, 0.1)
    ready.keep(plant.kernels_of(1).run, Path(sys.argv[1]))
"""


class ReadyKernels(BuildHookInterface):
    """Of a wheel; of nothing else."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile in a process of its own, for a family of processors."""
        if version == "editable":
            return
        self.folder = folder = Path(tempfile.mkdtemp(prefix="laticauda-ready-"))
        own = {
            "NUMBA_CACHE_DIR": str(folder / "cache"),
            "NUMBA_CPU_NAME": "x86-64-v3",
            "NUMBA_CPU_FEATURES": "",
        }
        # Not by PYTHONPATH: where pip's own Python has these sources installed to be edited, its
        # isolation drops them.
        paths = [str(Path(self.root, "src")), *filter(None, sys.path)]
        done = subprocess.run(
            [sys.executable, "-c", SCRIPT, str(folder), *paths], env={**os.environ, **own}
        )
        if done.returncode:
            self.app.display_warning("no kernels in this wheel: the first run will compile them")
        for one in folder.glob("*.code"):
            build_data["force_include"][str(one)] = f"laticauda/compiling/ready/{one.name}"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Leave nothing behind."""
        if version != "editable":
            shutil.rmtree(self.folder)
