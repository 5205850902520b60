"""Guests can be taken out: the rest of a copy imports and swims."""

import shutil
import subprocess
import sys

import pytest
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
import importlib, pkgutil
import laticauda as lc
for found in pkgutil.walk_packages(lc.__path__, "laticauda."):
    if not found.name.endswith("__main__") and found.name not in {left_out}:
        importlib.import_module(found.name)
gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
print(lc.swim(lc.load_robot("mamba"), gait, duration=1.0).forward_velocity > 0.0, lc.__path__[0])
"""
LEFT_OUT = {
    "laticauda.cli.follow_planned",  # the command of a guest
    "laticauda.cli.film",  # likewise
    "laticauda.cli.inverse",
    "laticauda.cli.mission",
    *(
        f"laticauda.models.planar.{name}"
        for name in ("adjoint", "driven", "drives", "loads", "prescribed", "recursion", "stepping")
    ),
    *(f"laticauda.models.spatial.{name}" for name in ("drives", "stepping")),
    "laticauda.models.simulate.harvest",
    "laticauda.water.mujoco.law_entry",
}
"""Modules that are not imported by themselves: the templates are loaded by `compiling.templates` alone."""


@pytest.mark.slow
@pytest.mark.parametrize("folders", GUESTS.values(), ids=GUESTS)
def test_without_a_guest_the_rest_imports_and_swims(folders, tmp_path):
    package = shutil.copytree(ROOT / "src" / "laticauda", tmp_path / "laticauda")
    for folder in folders:
        shutil.rmtree(package / folder)
    done = subprocess.run(
        [sys.executable, "-c", CODE.format(left_out=LEFT_OUT)],
        cwd=tmp_path,
        env={"PYTHONPATH": str(tmp_path), "PATH": ""},
        capture_output=True,
        text=True,
    )
    assert done.stdout.split() == ["True", str(package)], done.stderr[-2000:]
