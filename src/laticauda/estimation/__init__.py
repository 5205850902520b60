"""State estimation: position and motion of the robot from joint samples and motion-capture frames."""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.estimation.digital_twin import TwinState as TwinState
    from laticauda.estimation.filter import Estimator as Estimator
    from laticauda.estimation.filter_state import (
        EstimatorState as EstimatorState,
        FilterState as FilterState,
    )
    from laticauda.estimation.filter_state import Noise as Noise
    from laticauda.estimation.kinematics import KinematicEstimator as KinematicEstimator
    from laticauda.estimation.kinematics import KinematicState as KinematicState
    from laticauda.estimation.learning import (
        Learned as Learned,
        Learner as Learner,
        LearnerState as LearnerState,
    )
    from laticauda.estimation.learning import Learning as Learning
    from laticauda.estimation.motion_model import MotionModel as MotionModel
    from laticauda.estimation.samples import (
        Estimate as Estimate,
        Mount as Mount,
        StateEstimator as StateEstimator,
    )
    from laticauda.estimation.samples import JointSample as JointSample, PoseSample as PoseSample
    from laticauda.estimation.samples import ReferenceSample as ReferenceSample, Sample as Sample

__getattr__, __dir__, __all__ = lazy_exports()
