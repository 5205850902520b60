"""Studies of many trials: sweeps and searches, and their combined results."""

from laticauda.packaging import lazy_exports
from laticauda.studies.averaged import averaged_model as averaged_model
from laticauda.studies.optimization import Front as Front, unbeaten as unbeaten
from laticauda.studies.optimization import OBJECTIVES as OBJECTIVES, SPEED_POWER as SPEED_POWER
from laticauda.studies.optimization import Optimization as Optimization
from laticauda.studies.optimize import optimize as optimize
from laticauda.studies.sampling import Grid as Grid, Rows as Rows, Samples as Samples
from laticauda.studies.store import open_sweep as open_sweep
from laticauda.studies.sweep import Sweep as Sweep
from laticauda.studies.store import (
    best as best,
    count_failed as count_failed,
    run_sweep as run_sweep,
)

__getattr__, __dir__, __all__ = lazy_exports()
