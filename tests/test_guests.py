"""Guests can be taken out: the rest of a copy imports and swims."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from kernels import copy_source
from test_house import ROOT

GUESTS = {
    "paper": ["paper"],
    "films": ["film"],
    "missions": ["missions"],
    "cockpit": ["show/cockpit"],
    "exports": ["connect/fmu", "connect/native", "connect/web"],
    "model-predictive control": ["control/mpc"],
}
CODE = """
import importlib, os, pkgutil, sys

def import_all():
    import laticauda as lc
    for found in pkgutil.walk_packages(lc.__path__, "laticauda."):
        if not found.name.endswith("__main__") and found.name not in {left_out}:
            importlib.import_module(found.name)
    return lc

import_all()
for copy in sys.argv[1:]:
    if os.fork() > 0:
        os.wait()
        continue
    for name in [name for name in sys.modules if name.partition(".")[0] == "laticauda"]:
        del sys.modules[name]
    sys.path.insert(0, copy)
    lc = import_all()
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
    swims = lc.swim(lc.load_robot("mamba"), gait, duration=1.0).forward_velocity > 0.0
    print(swims, lc.__path__[0], flush=True)
    os._exit(0)
"""
"""Imports all of the package and what it needs, and then once more all of each copy, in a process of its own.

What the package needs takes longest, and is loaded once for all copies.
"""
LEFT_OUT = {
    "laticauda.cli.follow_planned",  # the command of a guest
    "laticauda.cli.film",  # likewise
    "laticauda.cli.inverse",
    "laticauda.cli.mission",
    *(
        f"laticauda.models.planar.{name}"
        for name in (
            "adjoint",
            "adjoint_references",
            "driven",
            "drives",
            "kept_run",
            "loads",
            "prescribed",
            "recursion",
            "stepping",
        )
    ),
    *(f"laticauda.models.spatial.{name}" for name in ("driven", "drives", "stepping")),
    "laticauda.models.simulate.harvest",
    "laticauda.water.mujoco.law_entry",
}
"""Modules that are not imported by themselves: the templates are loaded by `compiling.templates` alone."""


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="processes cannot be forked")
def test_without_a_guest_the_rest_imports_and_swims(tmp_path):
    copies = {name: tmp_path / name for name in GUESTS}
    for name, folders in GUESTS.items():
        package = copies[name] / "laticauda"
        shutil.copytree(ROOT / "src" / "laticauda", package, copy_function=copy_source)
        for folder in folders:
            shutil.rmtree(package / folder)
    done = subprocess.run(
        [sys.executable, "-c", CODE.format(left_out=LEFT_OUT), *copies.values()],
        cwd=tmp_path,
        env={"PYTHONPATH": str(ROOT / "src"), "PATH": ""},
        capture_output=True,
        text=True,
    )
    swim = {Path(line.removeprefix("True ")).parent.name for line in done.stdout.splitlines()}
    assert GUESTS.keys() - swim == set(), done.stderr[-2000:]
