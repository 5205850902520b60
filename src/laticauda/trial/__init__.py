"""The `Trial`, the time-stamped log of one run: its figures, its files, comparisons, and what the paper measured."""

from laticauda.trial.column_files import load_column_map
from laticauda.trial.column_maps import ColumnMap
from laticauda.trial.compare import ComparedFigure, compare
from laticauda.trial.cycles import CycleMean
from laticauda.trial.files import FORMATS, load_trial
from laticauda.trial.joining import joined
from laticauda.trial.mcap import Recorder
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
from laticauda.trial.recording import Logged, Recording, open_recording, read_messages
from laticauda.trial.summary import FIGURES, Figure
from laticauda.trial.trial import FORCE_COMPONENTS, Trial

__all__ = [
    "FIGURES",
    "FORCE_COMPONENTS",
    "FORMATS",
    "GAIT_WORDS",
    "ColumnMap",
    "ComparedFigure",
    "CycleMean",
    "Figure",
    "Logged",
    "MeasuredPathFollowing",
    "MeasuredTrial",
    "Recorder",
    "Recording",
    "Trial",
    "compare",
    "efficiency_trials",
    "group_name",
    "joined",
    "load_column_map",
    "load_trial",
    "measured_counterpart",
    "measured_setting",
    "measured_trial",
    "open_recording",
    "path_following_trials",
    "read_messages",
]
