"""Small sweeps for the tests."""

from pathlib import Path
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
    given = {"robot": "mamba", "motion": GAIT, "duration": 1.0, **changes}
    points = given.pop("points", points)
    return Sweep(scenario=lc.build_scenario(**given), points=points)
