"""Operating a robot: what it reports, where it is, and what happened.

Names are imported when they are first used: the estimators load a filter library, the recordings another one.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from laticauda.operate.estimate import Estimate, Mount
    from laticauda.operate.estimation import Estimator, EstimatorState
    from laticauda.operate.kinematic import KinematicEstimator, KinematicState
    from laticauda.operate.noise import Noise
    from laticauda.operate.samples import Event, JointSample, PoseSample, PowerReading, ReferenceSample

_WHERE = {
    "Estimate": "estimate",
    "Estimator": "estimation",
    "EstimatorState": "estimation",
    "Event": "samples",
    "JointSample": "samples",
    "KinematicEstimator": "kinematic",
    "KinematicState": "kinematic",
    "Mount": "estimate",
    "Noise": "noise",
    "PoseSample": "samples",
    "PowerReading": "samples",
    "ReferenceSample": "samples",
}

__all__ = [
    "Estimate",
    "Estimator",
    "EstimatorState",
    "Event",
    "JointSample",
    "KinematicEstimator",
    "KinematicState",
    "Mount",
    "Noise",
    "PoseSample",
    "PowerReading",
    "ReferenceSample",
]


def __getattr__(name: str) -> Any:
    if name not in _WHERE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"laticauda.operate.{_WHERE[name]}"), name)
