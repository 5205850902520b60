"""Whole experiments: many trials, and what they say together."""

from laticauda.studies.best import best, count_failed
from laticauda.studies.beyond import BeyondSettings, BeyondStudy, run_beyond
from laticauda.studies.beyond_dataset import beyond_dataset, write_beyond_netcdf
from laticauda.studies.claims import Claim, Misprint, claims, misprints
from laticauda.studies.curved import CurvedRun, CurvedSettings
from laticauda.studies.dataset import to_dataset, write_netcdf
from laticauda.studies.drift import DriftRun, DriftSettings
from laticauda.studies.efficiency import Case, EfficiencyStudy, SweepResult, run_efficiency
from laticauda.studies.following_dataset import following_dataset, write_following_netcdf
from laticauda.studies.following_run import FollowingRun
from laticauda.studies.following_settings import (
    FollowingGroup,
    HeldOut,
    PathFollowingSettings,
    path_following_settings,
)
from laticauda.studies.front import Front, hypervolume, unbeaten
from laticauda.studies.links import Doubling, LinksRun, LinksSettings, LinksStudy, run_links
from laticauda.studies.optimize import optimize
from laticauda.studies.paper import (
    PARAMETERS,
    Coefficients,
    EfficiencySettings,
    Group,
    SweepSettings,
    efficiency_settings,
)
from laticauda.studies.parity import (
    Parity,
    ParityCase,
    ParitySettings,
    ParityStudy,
    parity,
    parity_cases,
    run_parity,
)
from laticauda.studies.path_following import (
    FollowingCase,
    HeldOutRun,
    PathFollowingStudy,
    run_path_following,
)
from laticauda.studies.problem import OBJECTIVES, SPEED_POWER, Problem
from laticauda.studies.repeats import Repeat, load_repeats
from laticauda.studies.sampling import Grid, Rows, Samples
from laticauda.studies.scores import Score, scores
from laticauda.studies.side_trials import SideSettings, SideTrials, run_side_trials
from laticauda.studies.stability import BEHAVIORS, Loops, StabilityMap, StabilitySettings, StabilityStudy, run_stability
from laticauda.studies.stability_dataset import stability_dataset, write_stability_netcdf
from laticauda.studies.sweep import Sweep
from laticauda.studies.sweep_run import open_sweep, run_sweep
from laticauda.studies.swimmers import Steering, Swimmer, swimmers
from laticauda.studies.table1 import FinGain, Maximum, fin_gains, maxima
from laticauda.studies.table2 import (
    FinChange,
    MeterCost,
    Prediction,
    fin_changes,
    following_scores,
    meter_costs,
    null_predictions,
    simulated,
)
from laticauda.studies.turning import TurningCurve, TurningSettings

__all__ = [
    "BEHAVIORS",
    "OBJECTIVES",
    "PARAMETERS",
    "SPEED_POWER",
    "BeyondSettings",
    "BeyondStudy",
    "Case",
    "Claim",
    "Coefficients",
    "CurvedRun",
    "CurvedSettings",
    "Doubling",
    "DriftRun",
    "DriftSettings",
    "EfficiencySettings",
    "EfficiencyStudy",
    "FinChange",
    "FinGain",
    "FollowingCase",
    "FollowingGroup",
    "FollowingRun",
    "Front",
    "Grid",
    "Group",
    "HeldOut",
    "HeldOutRun",
    "LinksRun",
    "LinksSettings",
    "LinksStudy",
    "Loops",
    "Maximum",
    "MeterCost",
    "Misprint",
    "Parity",
    "ParityCase",
    "ParitySettings",
    "ParityStudy",
    "PathFollowingSettings",
    "PathFollowingStudy",
    "Prediction",
    "Problem",
    "Repeat",
    "Rows",
    "Samples",
    "Score",
    "SideSettings",
    "SideTrials",
    "StabilityMap",
    "StabilitySettings",
    "StabilityStudy",
    "Steering",
    "Sweep",
    "SweepResult",
    "SweepSettings",
    "Swimmer",
    "TurningCurve",
    "TurningSettings",
    "best",
    "beyond_dataset",
    "claims",
    "count_failed",
    "efficiency_settings",
    "fin_changes",
    "fin_gains",
    "following_dataset",
    "following_scores",
    "hypervolume",
    "load_repeats",
    "maxima",
    "meter_costs",
    "misprints",
    "null_predictions",
    "open_sweep",
    "optimize",
    "parity",
    "parity_cases",
    "path_following_settings",
    "run_beyond",
    "run_efficiency",
    "run_links",
    "run_parity",
    "run_path_following",
    "run_side_trials",
    "run_stability",
    "run_sweep",
    "scores",
    "simulated",
    "stability_dataset",
    "swimmers",
    "to_dataset",
    "unbeaten",
    "write_beyond_netcdf",
    "write_following_netcdf",
    "write_netcdf",
    "write_stability_netcdf",
]
