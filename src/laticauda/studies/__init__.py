"""Studies of many trials: sweeps and searches, and their combined results."""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports
from laticauda.studies.optimize import optimize as optimize  # at once: a module has its name

if TYPE_CHECKING:
    from laticauda.studies.averaged import averaged_model as averaged_model
    from laticauda.studies.optimization import (
        Front as Front,
        OBJECTIVES as OBJECTIVES,
        Optimization as Optimization,
        SPEED_POWER as SPEED_POWER,
        pareto_front as pareto_front,
    )
    from laticauda.studies.sampling import Grid as Grid, Rows as Rows, Samples as Samples
    from laticauda.studies.store import (
        best_points as best_points,
        count_failed as count_failed,
        open_sweep as open_sweep,
        run_sweep as run_sweep,
    )
    from laticauda.studies.sweep import Sweep as Sweep

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.studies.averaged": ["averaged_model"],
        "laticauda.studies.optimization": [
            "Front",
            "OBJECTIVES",
            "Optimization",
            "SPEED_POWER",
            "pareto_front",
        ],
        "laticauda.studies.sampling": ["Grid", "Rows", "Samples"],
        "laticauda.studies.store": ["best_points", "count_failed", "open_sweep", "run_sweep"],
        "laticauda.studies.sweep": ["Sweep"],
    },
    own=["optimize"],
    renamed={"best": "best_points", "unbeaten": "pareto_front"},
)
