"""Many trials: sweeps and searches, and what they say together."""

from laticauda.studies.averaged import averaged_model
from laticauda.studies.front import Front, hypervolume, unbeaten
from laticauda.studies.optimization import OBJECTIVES, SPEED_POWER, Optimization
from laticauda.studies.optimize import optimize
from laticauda.studies.sampling import Grid, Rows, Samples
from laticauda.studies.store import open_sweep
from laticauda.studies.sweep import Sweep
from laticauda.studies.sweep_run import best, count_failed, run_sweep

__all__ = [
    "OBJECTIVES",
    "SPEED_POWER",
    "Front",
    "Grid",
    "Optimization",
    "Rows",
    "Samples",
    "Sweep",
    "averaged_model",
    "best",
    "count_failed",
    "hypervolume",
    "open_sweep",
    "optimize",
    "run_sweep",
    "unbeaten",
]
