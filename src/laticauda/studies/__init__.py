"""Whole experiments: many trials, and what they say together."""

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
from laticauda.studies.parity import Parity, ParityCase, parity, parity_cases
from laticauda.studies.scores import Score, mape, scores
from laticauda.studies.table1 import FinGain, Maximum, fin_gains, maxima

__all__ = [
    "GAIT_WORDS",
    "PARAMETERS",
    "Case",
    "Coefficients",
    "EfficiencySettings",
    "EfficiencyStudy",
    "FinGain",
    "Group",
    "Maximum",
    "Parity",
    "ParityCase",
    "Score",
    "SweepResult",
    "SweepSettings",
    "efficiency_settings",
    "fin_gains",
    "mape",
    "maxima",
    "parity",
    "parity_cases",
    "run_efficiency",
    "scores",
    "to_dataset",
    "write_netcdf",
]
