"""The `Trial`, the time-stamped log of one run: its figures, its Dataset, comparisons, and what the paper measured."""

from laticauda.trial.compare import ComparedFigure, compare
from laticauda.trial.contents import FORCE_COMPONENTS
from laticauda.trial.cycles import CycleMean
from laticauda.trial.figures import FIGURES, Figure
from laticauda.trial.formats import Format
from laticauda.trial.joining import joined
from laticauda.trial.measured import (
    GAIT_WORDS,
    MeasuredPathFollowing,
    MeasuredTrial,
    efficiency_trials,
    group_name,
    measured_counterpart,
    measured_setting,
    measured_trial,
    path_following_trials,
)
from laticauda.trial.trial import Trial

__all__ = [
    "FIGURES",
    "FORCE_COMPONENTS",
    "GAIT_WORDS",
    "ComparedFigure",
    "CycleMean",
    "Figure",
    "Format",
    "MeasuredPathFollowing",
    "MeasuredTrial",
    "Trial",
    "compare",
    "efficiency_trials",
    "group_name",
    "joined",
    "measured_counterpart",
    "measured_setting",
    "measured_trial",
    "path_following_trials",
]
