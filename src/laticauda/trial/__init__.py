"""The `Trial`, the time-stamped log of one run: its figures, its Dataset, comparisons, and what was measured."""

from laticauda.trial.several import ComparedFigure, compare
from laticauda.trial.contents import FORCE_COMPONENTS
from laticauda.trial.cycles import CycleMean
from laticauda.trial.trial import Figure
from laticauda.trial.formats import Format
from laticauda.trial.several import joined
from laticauda.trial.measured import (
    MeasuredTrial,
    MeasuredTrials,
    all_measured,
    measured_counterpart,
    measured_setting,
)
from laticauda.trial.trial import FIGURES, Trial

__all__ = [
    "FIGURES",
    "FORCE_COMPONENTS",
    "ComparedFigure",
    "CycleMean",
    "Figure",
    "Format",
    "MeasuredTrial",
    "MeasuredTrials",
    "Trial",
    "all_measured",
    "compare",
    "joined",
    "measured_counterpart",
    "measured_setting",
]
