"""Operating a robot: what it reports, where it is, and what happened.

Names are imported when they are first used: the estimators load a filter library, the recordings another one.
"""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.operate.belief import EstimatorState as EstimatorState
    from laticauda.operate.estimate import Estimate as Estimate, Mount as Mount
    from laticauda.operate.estimation import Estimator as Estimator
    from laticauda.operate.kinematic import KinematicEstimator as KinematicEstimator, KinematicState as KinematicState
    from laticauda.operate.noise import Noise as Noise
    from laticauda.operate.onlooker import Onlooker as Onlooker
    from laticauda.operate.operation_log import (
        Decision as Decision,
        OperationLog as OperationLog,
        read_operation as read_operation,
    )
    from laticauda.operate.recording import Header as Header, OperationRecorder as OperationRecorder
    from laticauda.operate.replay import (
        Rerun as Rerun,
        rerun_controller as rerun_controller,
        rerun_estimator as rerun_estimator,
        trial_of as trial_of,
    )
    from laticauda.operate.samples import (
        Event as Event,
        JointSample as JointSample,
        PoseSample as PoseSample,
        PowerReading as PowerReading,
        ReferenceSample as ReferenceSample,
    )

__getattr__, __dir__, __all__ = lazy_exports()
