"""Makes the library of kernels (`laticauda.models.planar.kernel_library`) where a C compiler is at hand."""

import subprocess
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SCRIPT = """
import sys
sys.path[:0] = sys.argv[1:]
from laticauda.connect.native.kernel_library import main
main()
"""
FOLDER = "laticauda/models/planar/ready"
"""Folder of the library, in the sources and in a wheel."""


class ReadyKernels(BuildHookInterface):
    """Makes the library beside the sources, for an editable installation, and puts it into a wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Make the library in a process of its own, which compiles for a family of processors."""
        sources = Path(self.root, "src")
        # Not by PYTHONPATH: where pip's own Python has these sources installed to be edited, its
        # isolation drops them.
        paths = [str(sources), *filter(None, sys.path)]
        done = subprocess.run([sys.executable, "-c", SCRIPT, *paths])
        if done.returncode:
            self.app.display_warning("no library of kernels: the first run will compile them")
        if version == "editable":
            return
        for file in (sources / FOLDER).glob("kernels.*"):
            build_data["force_include"][str(file)] = f"{FOLDER}/{file.name}"
