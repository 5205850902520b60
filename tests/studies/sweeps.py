"""Small sweeps for the tests, and the campaign whose slice they run."""

import importlib.util
from pathlib import Path
from types import ModuleType
from typing import Any

import laticauda as lc
from laticauda.studies import Grid, Sweep

ROOT = Path(__file__).parent.parent.parent
GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
AMPLITUDE = [0.3, 0.5, 0.7]
DRAG = [1.0, 1.5, 2.0, 2.5]


def small(**changes: Any) -> Sweep:
    """Twelve trials of one second."""
    points = Grid(values={"gait.amplitude": AMPLITUDE, "water.normal_drag": DRAG})
    return Sweep(**{"robot": lc.load_robot("mamba"), "gait": GAIT, "duration": 1.0, "points": points, **changes})


def campaign(name: str) -> ModuleType:
    """A script of campaigns/ as a module."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "campaigns" / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
