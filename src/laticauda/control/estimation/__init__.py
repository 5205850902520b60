"""State estimation: position and motion of the robot from joint samples and motion-capture frames.

- samples: what comes in, where the markers sit, and what comes out
- kinematics: the baseline, as in the paper, without a filter
- filter: the filter; filter_state: its state and noise; state_vector: what it estimates;
  motion_model: how that moves and what is measured of it
- digital_twin: a plant that runs beside the filter and predicts the motion
- learning: a twin that learns the water and names faults; learning_state: its settings, memory and
  results; stretches: the robot's motion compared with the twin's
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.control.estimation.digital_twin import TwinState as TwinState
    from laticauda.control.estimation.filter import Estimator as Estimator
    from laticauda.control.estimation.filter_state import (
        EstimatorState as EstimatorState,
        FilterState as FilterState,
        Noise as Noise,
    )
    from laticauda.control.estimation.kinematics import (
        KinematicEstimator as KinematicEstimator,
        KinematicState as KinematicState,
    )
    from laticauda.control.estimation.learning import Learner as Learner
    from laticauda.control.estimation.learning_state import (
        Learned as Learned,
        LearnerState as LearnerState,
        Learning as Learning,
    )
    from laticauda.control.estimation.motion_model import MotionModel as MotionModel
    from laticauda.control.estimation.samples import (
        Estimate as Estimate,
        JointSample as JointSample,
        Mount as Mount,
        PoseSample as PoseSample,
        ReferenceSample as ReferenceSample,
        Sample as Sample,
        StateEstimator as StateEstimator,
        Offset as Offset,
        Status as Status,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.control.estimation.digital_twin": ["TwinState"],
        "laticauda.control.estimation.filter": ["Estimator"],
        "laticauda.control.estimation.filter_state": ["EstimatorState", "FilterState", "Noise"],
        "laticauda.control.estimation.kinematics": ["KinematicEstimator", "KinematicState"],
        "laticauda.control.estimation.learning": ["Learner"],
        "laticauda.control.estimation.learning_state": ["Learned", "LearnerState", "Learning"],
        "laticauda.control.estimation.motion_model": ["MotionModel"],
        "laticauda.control.estimation.samples": [
            "Estimate",
            "JointSample",
            "Mount",
            "PoseSample",
            "ReferenceSample",
            "Sample",
            "StateEstimator",
        ],
    },
    plain={
        "laticauda.control.estimation.samples": ["Offset", "Status"],
    },
)
