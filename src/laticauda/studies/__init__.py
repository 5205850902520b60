"""Many trials: sweeps and searches, and what they say together."""

from laticauda.studies.best import best, count_failed
from laticauda.studies.front import Front, hypervolume, unbeaten
from laticauda.studies.optimize import optimize
from laticauda.studies.problem import OBJECTIVES, SPEED_POWER, Problem
from laticauda.studies.sampling import Grid, Rows, Samples
from laticauda.studies.sweep import Sweep
from laticauda.studies.sweep_run import open_sweep, run_sweep

__all__ = [
    "OBJECTIVES",
    "SPEED_POWER",
    "Front",
    "Grid",
    "Problem",
    "Rows",
    "Samples",
    "Sweep",
    "best",
    "count_failed",
    "hypervolume",
    "open_sweep",
    "optimize",
    "run_sweep",
    "unbeaten",
]
