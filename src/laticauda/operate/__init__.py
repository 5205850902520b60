"""Operating a robot: what it reports, where it is, and what happened.

Names are imported when they are first used: the estimators load a filter library, the recordings another one.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from laticauda.operate.belief import EstimatorState
    from laticauda.operate.estimate import Estimate, Mount
    from laticauda.operate.estimation import Estimator
    from laticauda.operate.kinematic import KinematicEstimator, KinematicState
    from laticauda.operate.noise import Noise
    from laticauda.operate.onlooker import Onlooker
    from laticauda.operate.operation_log import Decision, OperationLog, read_operation
    from laticauda.operate.recording import Header, OperationRecorder
    from laticauda.operate.replay import Rerun, rerun_controller, rerun_estimator, trial_of
    from laticauda.operate.samples import Event, JointSample, PoseSample, PowerReading, ReferenceSample

_WHERE = {
    "Decision": "operation_log",
    "Estimate": "estimate",
    "Estimator": "estimation",
    "EstimatorState": "belief",
    "Event": "samples",
    "Header": "recording",
    "JointSample": "samples",
    "KinematicEstimator": "kinematic",
    "KinematicState": "kinematic",
    "Mount": "estimate",
    "Noise": "noise",
    "Onlooker": "onlooker",
    "OperationLog": "operation_log",
    "OperationRecorder": "recording",
    "PoseSample": "samples",
    "PowerReading": "samples",
    "ReferenceSample": "samples",
    "Rerun": "replay",
    "read_operation": "operation_log",
    "rerun_controller": "replay",
    "rerun_estimator": "replay",
    "trial_of": "replay",
}

__all__ = [
    "Decision",
    "Estimate",
    "Estimator",
    "EstimatorState",
    "Event",
    "Header",
    "JointSample",
    "KinematicEstimator",
    "KinematicState",
    "Mount",
    "Noise",
    "Onlooker",
    "OperationLog",
    "OperationRecorder",
    "PoseSample",
    "PowerReading",
    "ReferenceSample",
    "Rerun",
    "read_operation",
    "rerun_controller",
    "rerun_estimator",
    "trial_of",
]


def __getattr__(name: str) -> Any:
    if name not in _WHERE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"laticauda.operate.{_WHERE[name]}"), name)
