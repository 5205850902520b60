"""Whole experiments: many trials, and what they say together."""

from laticauda.studies.best import best, count_failed
from laticauda.studies.dataset import to_dataset, write_netcdf
from laticauda.studies.efficiency import Case, EfficiencyStudy, SweepResult, run_efficiency
from laticauda.studies.paper import (
    GAIT_WORDS,
    PARAMETERS,
    Coefficients,
    EfficiencySettings,
    Group,
    SweepSettings,
    efficiency_settings,
)
from laticauda.studies.parameters import Parameter, parameters
from laticauda.studies.sampling import Grid, Rows, Samples
from laticauda.studies.scores import Score, mape, scores
from laticauda.studies.sweep import Sweep, open_sweep, run_sweep
from laticauda.studies.table1 import FinGain, Maximum, fin_gains, maxima

__all__ = [
    "GAIT_WORDS",
    "PARAMETERS",
    "Case",
    "Coefficients",
    "EfficiencySettings",
    "EfficiencyStudy",
    "FinGain",
    "Grid",
    "Group",
    "Maximum",
    "Parameter",
    "Rows",
    "Samples",
    "Score",
    "Sweep",
    "SweepResult",
    "SweepSettings",
    "best",
    "count_failed",
    "efficiency_settings",
    "fin_gains",
    "mape",
    "maxima",
    "open_sweep",
    "parameters",
    "run_efficiency",
    "run_sweep",
    "scores",
    "to_dataset",
    "write_netcdf",
]
