"""State estimation: where the robot is and how it moves, from joint samples and motion-capture frames."""

from laticauda.estimation.digital_twin import Displacement, TwinState
from laticauda.estimation.samples import Estimate, Mount, StateEstimator
from laticauda.estimation.filter import Estimator
from laticauda.estimation.filter_state import EstimatorState, FilterState
from laticauda.estimation.kinematics import KinematicEstimator, KinematicState
from laticauda.estimation.motion_model import MotionModel
from laticauda.estimation.filter_state import Noise
from laticauda.estimation.samples import JointSample, PoseSample, ReferenceSample, Sample

__all__ = [
    "Displacement",
    "Estimate",
    "Estimator",
    "EstimatorState",
    "FilterState",
    "JointSample",
    "KinematicEstimator",
    "KinematicState",
    "MotionModel",
    "Mount",
    "Noise",
    "PoseSample",
    "ReferenceSample",
    "Sample",
    "StateEstimator",
    "TwinState",
]
